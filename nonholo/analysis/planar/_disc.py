r"""Displacements of a top, n = 3, as a disc: unit vectors $(z_0, z_1, z_2)$ up to sign, the projective plane.

They are the quaternions of the displacements; z lies in the direction of turning, z_0 = 0 is the angle pi.

The momentum locus of a top, n = 3: a Steiner surface, from its three quadratic forms.

$$ \tfrac h2 (P_{13}, P_{23}, P_{12}) = (z^T Q_1 z, z^T Q_2 z, z^T Q_3 z), \qquad z^T z = 1. $$

The symmetric matrices S with $\mathrm{tr}\,S = \mathrm{tr}\,Q_iS = 0$ form a pencil $\langle S_1, S_2\rangle$; all
geometry of the surface is in it. Matrices here are sizes of one: momenta are divided by the size of the body.

Energy levels on the projective plane of displacements of a top, in polar coordinates, are arcs over intervals of
directions, the two solutions of a quadratic, joined where they meet: an arc ends in a fold, where it continues as the
other solution, or on the equator, where its mirror image begins.

With $z = \sqrt\rho\,u(\varphi)$, $b = u\cdot Bu$, $\sigma = c\cdot u^\perp$ and $\kappa = 1 - \sigma^2/D$ the level is
$b(\rho - \kappa\rho^2) = e$, $e = h^2E/2$, on $0 \le \rho \le 1$.
"""

import itertools
from typing import NamedTuple

import numpy as np

from nonholo.analysis.planar._base import EQUATOR, FOLD, Arc, HalfPlanes, PlanarBody
from nonholo.base.types import Array, Float

_SAME_MIDDLE = 1e-8  # angle below which two middles of arcs are one


class Place(NamedTuple):
    """An arc on one side of the equator, 1 or -1, and the sense in which it is run through."""

    arc: Arc
    side: int
    sense: int

    def following(self, arcs: list[Arc]) -> "Place":
        """Return what continues the curve: the sense is reversed at every end."""
        arc = self.arc
        if not arc.ends:
            return self
        end, direction = (arc.ends[1], arc.stop) if self.sense > 0 else (arc.ends[0], arc.start)
        if end == EQUATOR:
            return Place(arc, -self.side, -self.sense)
        others = [a for a in arcs if a.sign == -arc.sign and a.ends]
        other = min(others, key=lambda a: _apart(direction, a.stop if self.sense > 0 else a.start), default=arc)
        return Place(other, self.side, -self.sense)

    def is_same(self, other: "Place") -> bool:
        """Return whether both are the same displacements, full turns and the sense apart: one arc, or its antipode."""
        arc, that, turn = self.arc, other.arc, 0.0 if self.side == other.side else np.pi
        middles = (arc.start + arc.stop) / 2, (that.start + that.stop) / 2 + turn
        return arc.sign == that.sign and (not arc.ends or _apart(*middles) < _SAME_MIDDLE)


def _apart(x: float, y: float) -> float:
    """Return the angle between two directions."""
    return abs((x - y + np.pi) % (2 * np.pi) - np.pi)


class DiscLevel(NamedTuple):
    """The level e of a top with restricted inertia B and coupling c."""

    B: Float[np.ndarray, "2 2"]
    c: Float[np.ndarray, "2"]
    e: float

    def over(self, direction: float) -> Float[np.ndarray, "m 3"]:
        """Return the points over a direction, the inner one first."""
        angle = np.array([direction])
        points = [self._points(sign, angle, 1) for sign in (-1, 1) if self._valid(sign, direction)]
        return np.concatenate([np.empty((0, 3)), *points])

    def components(self, count: int) -> tuple[Float[np.ndarray, "K 3"], ...]:
        """Return the connected curves, lifted to the sphere, one of each antipodal pair.

        Arcs beyond the first half turn are copies of the others.
        """
        arcs = [arc for sign in (-1, 1) for arc in self._arcs(sign)]
        curves, past = [], []
        for arc in arcs:
            place, pieces = Place(arc, 1, 1), []
            while not any(place.is_same(other) for other in past):
                pieces.append(place)
                past.append(place)
                place = place.following(arcs)
            if pieces:
                runs = [self._points(arc.sign, arc.directions(count), side)[::sense] for arc, side, sense in pieces]
                curves.append(np.concatenate([runs[0], *(run[1:] for run in runs[1:])]))
                curves[-1][-1] = curves[-1][0]  # equal but for the square root of rounding
        return tuple(curves)

    def _arcs(self, sign: int) -> list[Arc]:
        breaks = [(angle, FOLD) for angle in self._folds()]
        breaks += [(angle, EQUATOR) for angle in self._crossings(sign)]
        if not breaks:
            whole = all(self._valid(sign, angle) for angle in (0.0, 1.0, 2.0, 3.0))
            return [Arc(sign, 0.0, 2 * np.pi)] if whole else []
        breaks.sort()
        around = [(angle + turn, kind) for turn in (0.0, np.pi, 2 * np.pi) for angle, kind in breaks]
        pairs = list(itertools.pairwise(around))[: 2 * len(breaks)]
        return [Arc(sign, p, q, (s, t)) for (p, s), (q, t) in pairs if self._valid(sign, (p + q) / 2)]

    def _shape(self, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        u = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        b = np.einsum("...i,ij,...j->...", u, self.B, u)
        kappa = 1 - (u @ self._normal) ** 2 / np.linalg.det(self.B)
        return u, b, kappa

    @property
    def _normal(self) -> Float[np.ndarray, "2"]:
        return np.array([self.c[1], -self.c[0]])

    def _size(self, sign: int, angle: np.ndarray) -> np.ndarray:
        """Return rho: the smaller solution, or the larger one; infinity where that one has passed it."""
        _, b, kappa = self._shape(angle)
        root = np.sqrt(np.maximum(1 - 4 * kappa * self.e / b, 0.0))
        if sign < 0:
            return 2 * self.e / (b * (1 + root))
        return np.divide(1 + root, 2 * kappa, out=np.full_like(b, np.inf), where=kappa > 0)

    def _points(self, sign: int, angle: np.ndarray, side: int) -> Float[np.ndarray, "K 3"]:
        u, rho = self._shape(angle)[0], np.minimum(self._size(sign, angle), 1.0)
        return np.concatenate([side * np.sqrt(1 - rho)[..., None], np.sqrt(rho)[..., None] * u], axis=-1)

    def _valid(self, sign: int, angle: float) -> bool:
        _, b, kappa = self._shape(np.array(angle))
        return bool(b >= 4 * kappa * self.e and self._size(sign, np.array([angle]))[0] <= 1)

    def _folds(self) -> list[float]:
        """Return the directions, modulo pi, where b = 4 kappa e: the zeros of a quadratic form."""
        n = self._normal
        form = self.B - 4 * self.e * (np.eye(2) - np.outer(n, n) / np.linalg.det(self.B))
        (low, high), vectors = np.linalg.eigh(form)
        if low >= 0 or high <= 0:
            return []
        half = np.arctan2(np.sqrt(-low), np.sqrt(high))
        zeros = (vectors @ [np.cos(half), side * np.sin(half)] for side in (1, -1))
        return [float(np.arctan2(v[1], v[0]) % np.pi) for v in zeros]

    def _crossings(self, sign: int) -> list[float]:
        r"""Return the directions, modulo pi, where one solution is 1, $b\sigma^2 = De$, a quartic in the tangent."""
        (b11, b12), (_, b22) = self.B
        n1, n2 = self._normal
        product = np.convolve([b22, 2 * b12, b11], [n2 * n2, 2 * n1 * n2, n1 * n1])
        quartic = product - np.linalg.det(self.B) * self.e * np.array([1.0, 0.0, 2.0, 0.0, 1.0])
        roots = np.roots(quartic)
        angles = [float(np.arctan(t.real) % np.pi) for t in roots if abs(t.imag) <= 1e-9 * (1 + abs(t))]
        return [angle for angle in angles if (self._shape(np.array(angle))[2] >= 0.5) == (sign > 0)]


_FLAT = 1e-10  # singular value of the four forms below which they are dependent
_REAL = 1e-7  # imaginary part below which a root of the cubic of the pencil is a real one, perhaps double
_ROWS, _COLUMNS = [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]  # of the entries of a symmetric matrix
_WEIGHTS = np.sqrt([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])


class SteinerSurface(NamedTuple):
    """The forms of a top, its pencil, and how momenta are expressed in them.

    Attributes:
        forms: Q_1, Q_2, Q_3.
        pencil: S_1, S_2, orthonormal; more of them if the surface is flat.
        to_forms: Matrix that takes momenta in the user's frame to values of the forms.
    """

    forms: Float[np.ndarray, "3 3 3"]
    pencil: Float[np.ndarray, "m 3 3"]
    to_forms: Float[np.ndarray, "3 3"]

    @property
    def is_flat(self) -> bool:
        """Whether the locus lies in a plane, as for a balanced body with two equal moments."""
        return len(self.pencil) > 2

    def implicit(self, momentum: Float[np.ndarray, "... 3"]) -> Float[np.ndarray, "..."]:
        r"""Return the polynomial: of degree four, or one if the surface is flat.

        m is on the surface if a matrix X with $\mathrm{tr}X = 1$, $\mathrm{tr}\,Q_iX = m_i$ has rank one:
        $\mathrm{adj}(X_0(m) + aS_1 + bS_2) = 0$. These are six equations, linear in $1, a, b$ and in
        $a^2, ab, b^2$; three combinations are free of the latter, and their determinant is the quartic.
        """
        m = momentum @ self.to_forms.T
        four = np.concatenate([np.ones((*m.shape[:-1], 1)), m], axis=-1)
        if self.is_flat:
            return four @ np.linalg.svd(_four(self.forms))[0][:, -1]
        X = _matrix(four @ np.linalg.pinv(_four(self.forms)).T)
        first, second = self.pencil
        squares = [_bilinear(first, first) / 2, _bilinear(first, second), _bilinear(second, second) / 2]
        free = np.linalg.svd(np.stack([_vector(square) for square in squares], axis=-1))[0][:, 3:].T
        columns = [_bilinear(X, X) / 2, _bilinear(X, first), _bilinear(X, second)]
        return np.linalg.det(np.stack([_vector(column) @ free.T for column in columns], axis=-1))

    def double_lines(self) -> Float[np.ndarray, "L 2 3"]:
        r"""Return the pinch points at the two ends of each real double segment.

        A singular $S = \mu(uu^T - vv^T)$ of the pencil says that $\cos\varphi\,u + \sin\varphi\,v$ and the vector with
        sine and cosine exchanged have one momentum, $u^TQ_iu + \sin 2\varphi\,u^TQ_iv$: a segment.
        """
        if self.is_flat:
            return np.empty((0, 2, 3))
        segments = [((u @ self.forms) @ u, (u @ self.forms) @ v) for u, v in self._pairs()]
        ends = [[center - half, center + half] for center, half in segments]
        return np.array(ends).reshape(-1, 2, 3) @ np.linalg.inv(self.to_forms).T

    def triple_point(self) -> Float[np.ndarray, "3"] | None:
        """Return the point where three real double lines meet; None if only one is real."""
        pairs = self._pairs()
        if self.is_flat or len(pairs) < 3:
            return None
        common = np.cross(np.cross(*pairs[0]), np.cross(*pairs[1]))  # of their normals
        common /= np.linalg.norm(common)
        return np.linalg.inv(self.to_forms) @ ((common @ self.forms) @ common)

    def _pairs(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return the vectors u and v of the real singular matrices of the pencil.

        Its basis is turned so that none of them is at infinity.
        """
        first, second = self.pencil[:2]
        turns = np.pi * np.arange(7) / 7
        best = turns[np.argmax(np.abs(np.linalg.det([np.cos(a) * second + np.sin(a) * first for a in turns])))]
        base = np.cos(best) * first - np.sin(best) * second
        step = np.cos(best) * second + np.sin(best) * first
        adjugates = [_bilinear(S, S) / 2 for S in (base, step)]
        middle = (np.trace(adjugates[1] @ base), np.trace(adjugates[0] @ step))
        roots = np.roots([np.linalg.det(step), *middle, np.linalg.det(base)])
        matrices = (base + t.real * step for t in roots if abs(t.imag) <= _REAL * (1 + abs(t)))
        return [(vectors[:, 2], vectors[:, 0]) for _, vectors in map(np.linalg.eigh, matrices)]


def _four(forms: Float[np.ndarray, "3 3 3"]) -> Float[np.ndarray, "4 6"]:
    return _vector(np.concatenate([np.eye(3)[None], forms]))


def _bilinear(X: np.ndarray, Y: np.ndarray) -> np.ndarray:
    """Return the symmetric bilinear form that is twice the adjugate where X = Y."""
    tx, ty = (np.trace(Z, axis1=-2, axis2=-1)[..., None, None] for Z in (X, Y))
    product = X @ Y
    both = np.trace(product, axis1=-2, axis2=-1)[..., None, None]
    return product + np.swapaxes(product, -1, -2) - tx * Y - ty * X + (tx * ty - both) * np.eye(3)


def _vector(S: Float[np.ndarray, "... 3 3"]) -> Float[np.ndarray, "... 6"]:
    """Return a symmetric matrix as a vector with the same scalar product."""
    return _WEIGHTS * S[..., _ROWS, _COLUMNS]


def _matrix(v: Float[np.ndarray, "... 6"]) -> Float[np.ndarray, "... 3 3"]:
    """Return the symmetric matrix of a vector."""
    S = np.empty((*v.shape[:-1], 3, 3))
    S[..., _ROWS, _COLUMNS] = S[..., _COLUMNS, _ROWS] = v / _WEIGHTS
    return S


class Disc(PlanarBody):
    """The displacements of a top, by coordinates that cover all of them, the angle pi included."""

    blade = None

    @property
    def inertia(self) -> Float[np.ndarray, "2 2"]:
        """B."""
        return self.form.stiffness_matrix

    @property
    def coupling(self) -> Float[np.ndarray, "2"]:
        """The vector c."""
        return np.asarray(self.form.coupling)

    def displacement(self, points: Float[np.ndarray, "... 3"]) -> Float[np.ndarray, "... 3 3"]:
        """Return the rotations with these quaternions."""
        z0, z1, z2 = np.moveaxis(points, -1, 0)
        rows = (
            (1 - 2 * z1 * z1, -2 * z1 * z2, 2 * z0 * z1),
            (-2 * z1 * z2, 1 - 2 * z2 * z2, 2 * z0 * z2),
            (-2 * z0 * z1, -2 * z0 * z2, 2 * z0 * z0 - 1),
        )
        return self.frame @ np.stack([np.stack(row, axis=-1) for row in rows], axis=-2) @ self.frame.T

    def points(self, displacement: Float[np.ndarray, "... 3 3"]) -> Float[np.ndarray, "... 3"]:
        """Return z from the columns of z z^T, the longest of which is nowhere small; its largest component positive."""
        W = self.frame.T @ displacement @ self.frame
        outer = np.empty_like(W)
        outer[..., 0, 0] = (1 + W[..., 2, 2]) / 2
        outer[..., 0, 1:] = outer[..., 1:, 0] = W[..., :2, 2] / 2
        outer[..., 1:, 1:] = (np.eye(2) - W[..., :2, :2]) / 2
        largest = np.argmax(np.diagonal(outer, axis1=-2, axis2=-1), axis=-1)
        column = np.take_along_axis(outer, largest[..., None, None], axis=-1)[..., 0]
        return column / np.linalg.norm(column, axis=-1, keepdims=True)

    def mesh(self, rows: int) -> tuple[Float[np.ndarray, "R C 2"], Float[np.ndarray, "R C 3"]]:
        """Return step angles, 0 to pi, with directions of z, and the points."""
        directions = np.linspace(0, 2 * np.pi, 2 * rows + 1)
        angle, direction = np.meshgrid(np.linspace(0, np.pi, rows), directions, indexing="ij")
        z0, size = np.cos(angle / 2), np.sin(angle / 2)
        points = np.stack([z0, size * np.cos(direction), size * np.sin(direction)], axis=-1)
        return np.stack([angle, direction], axis=-1), points

    def area_factor(self, points: Float[np.ndarray, "... 3"]) -> tuple[Float[Array, "..."], Float[Array, "..."]]:
        r"""Return the even and the odd part, under inversion, of the area factor of W -> hr on the sphere.

        Folds are its zeros. Up to a constant it is

        $$ f = D z_0(z_0^2 - |z|^2) + 2z_0\,(c\cdot z^\perp)^2 \; - \; c\cdot Bz + 2(c\cdot z)(z\cdot Bz). $$
        """
        B, c, z0, z = self.inertia, self.coupling, points[..., 0], points[..., 1:]
        square, across = (z * z).sum(axis=-1), z[..., 0] * c[1] - z[..., 1] * c[0]
        even = z0 * (np.linalg.det(B) * (z0 * z0 - square) + 2 * across * across)
        return even, 2 * (z @ c) * np.einsum("...i,ij,...j->...", z, B, z) - z @ (B @ c)

    def sides(self, points: Float[np.ndarray, "... 3"]) -> tuple[HalfPlanes, Float[Array, "..."]]:
        r"""Return $(s, Q) = (c\cdot z^\perp, -c\cdot Bz)$ and the weight $\Lambda = Dz_0$, with $z_0 \ge 0$.

        The side of the momentum is $2s\,(\Lambda + Q)$ before the step and $2s\,(\Lambda - Q)$ after it.
        """
        points = np.where(points[..., :1] < 0, -points, points)
        z0, z = points[..., 0], points[..., 1:]
        sides = HalfPlanes(_quarter_turned(z) @ self.coupling, -z @ (self.inertia @ self.coupling))
        return sides, np.linalg.det(self.inertia) * z0

    def sides_of_momenta(self, restricted: Float[np.ndarray, "... 2"]) -> HalfPlanes:
        r"""Return $\bigl((Bc)\cdot r^\perp, -c\cdot r\bigr)$."""
        r = restricted @ self.to_rows.T
        return HalfPlanes(_quarter_turned(r) @ (self.inertia @ self.coupling), -r @ self.coupling)

    def level(self, energy: float) -> DiscLevel:
        """Return the level in polar coordinates of z."""
        return DiscLevel(self.inertia, self.coupling, energy / 2)

    def surface(self, time_step: float) -> SteinerSurface:
        r"""Return the surface of the forms $z_0Bz + sz^\perp$ and $z_0s - z^\perp\cdot Bz$, $s = c\cdot z^\perp$."""
        (b11, b12), (_, b22) = self.inertia
        c1, c2 = self.coupling
        first = [[0, b11, b12], [b11, 0, -c2], [b12, -c2, 2 * c1]]
        second = [[0, b12, b22], [b12, 2 * c2, -c1], [b22, -c1, 0]]
        third = [[0, c2, -c1], [c2, -2 * b12, b11 - b22], [-c1, b11 - b22, 2 * b12]]
        forms = np.array([first, second, third])
        size = np.linalg.norm(forms, 2, axis=(1, 2)).max() / 2
        axes = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]) @ self.frame.T
        _, values, rows = np.linalg.svd(_four(forms / (2 * size)))
        pencil = _matrix(rows[np.count_nonzero(values > _FLAT) :])
        return SteinerSurface(forms / (2 * size), pencil, axes * time_step / (2 * size))


def _quarter_turned(z: Float[np.ndarray, "... 2"]) -> Float[np.ndarray, "... 2"]:
    return np.stack([-z[..., 1], z[..., 0]], axis=-1)
