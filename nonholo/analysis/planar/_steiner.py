r"""The momentum locus of a top, n = 3: a Steiner surface, from its three quadratic forms.

$$ \tfrac h2 (P_{13}, P_{23}, P_{12}) = (z^T Q_1 z, z^T Q_2 z, z^T Q_3 z), \qquad z^T z = 1. $$

The symmetric matrices S with $\mathrm{tr}\,S = \mathrm{tr}\,Q_iS = 0$ form a pencil $\langle S_1, S_2\rangle$; all
geometry of the surface is in it. Matrices here are sizes of one: momenta are divided by the size of the body.
"""

import dataclasses

import numpy as np

from nonholo.base.types import Float

_FLAT = 1e-10  # singular value of the four forms below which they are dependent
_REAL = 1e-7  # imaginary part below which a root of the cubic of the pencil is a real one, perhaps double
_ROWS, _COLUMNS = [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]  # of the entries of a symmetric matrix
_WEIGHTS = np.sqrt([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])


@dataclasses.dataclass(frozen=True, eq=False)
class SteinerSurface:
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
        free = self._without_squares()
        columns = [_mixed(X, X) / 2, _mixed(X, first), _mixed(X, second)]
        return np.linalg.det(np.stack([_vector(column) @ free.T for column in columns], axis=-1))

    def double_lines(self) -> Float[np.ndarray, "L 2 3"]:
        r"""Return the pinch points at the two ends of each real double segment.

        A singular $S = \mu(uu^T - vv^T)$ of the pencil says that $\cos\varphi\,u + \sin\varphi\,v$ and the vector with
        sine and cosine exchanged have one momentum, $u^TQ_iu + \sin 2\varphi\,u^TQ_iv$: a segment.
        """
        if self.is_flat:
            return np.empty((0, 2, 3))
        ends = []
        for u, v in self._pairs():
            center, half = ((u @ self.forms) @ w for w in (u, v))
            ends.append([center - half, center + half])
        return np.array(ends).reshape(-1, 2, 3) @ np.linalg.inv(self.to_forms).T

    def triple_point(self) -> Float[np.ndarray, "3"] | None:
        """Return the point where three real double lines meet; None if only one is real."""
        pairs = self._pairs()
        if self.is_flat or len(pairs) < 3:
            return None
        normals = [np.cross(u, v) for u, v in pairs[:2]]
        common = np.cross(normals[0], normals[1])
        common /= np.linalg.norm(common)
        return np.linalg.inv(self.to_forms) @ ((common @ self.forms) @ common)

    def _pairs(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return the vectors u and v of the singular matrices of the pencil."""
        return [(vectors[:, 2], vectors[:, 0]) for _, vectors in map(np.linalg.eigh, _singular(self.pencil))]

    def _without_squares(self) -> Float[np.ndarray, "3 6"]:
        first, second = self.pencil
        squares = [_mixed(first, first) / 2, _mixed(first, second), _mixed(second, second) / 2]
        return np.linalg.svd(np.stack([_vector(square) for square in squares], axis=-1))[0][:, 3:].T


def steiner_surface(
    inertia: Float[np.ndarray, "2 2"],
    coupling: Float[np.ndarray, "2"],
    frame: Float[np.ndarray, "3 3"],
    time_step: float,
) -> SteinerSurface:
    r"""Return the surface of the forms $z_0Bz + sz^\perp$ and $z_0s - z^\perp\cdot Bz$, $s = c\cdot z^\perp$."""
    (b11, b12), (_, b22) = inertia
    c1, c2 = coupling
    forms = np.array(
        [
            [[0, b11, b12], [b11, 0, -c2], [b12, -c2, 2 * c1]],
            [[0, b12, b22], [b12, 2 * c2, -c1], [b22, -c1, 0]],
            [[0, c2, -c1], [c2, -2 * b12, b11 - b22], [-c1, b11 - b22, 2 * b12]],
        ]
    )
    size = np.linalg.norm(forms, 2, axis=(1, 2)).max() / 2
    unscaled = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]) @ frame.T
    return SteinerSurface(forms / (2 * size), _pencil(forms / (2 * size)), unscaled * time_step / (2 * size))


def _pencil(forms: Float[np.ndarray, "3 3 3"]) -> Float[np.ndarray, "m 3 3"]:
    _, values, rows = np.linalg.svd(_four(forms))
    return _matrix(rows[np.count_nonzero(values > _FLAT) :])


def _singular(pencil: Float[np.ndarray, "2 3 3"]) -> list[np.ndarray]:
    """Return the real singular matrices of a pencil; the basis is turned so that none is at infinity."""
    turns = np.pi * np.arange(7) / 7
    turned = [np.cos(a) * pencil[1] + np.sin(a) * pencil[0] for a in turns]
    best = turns[np.argmax(np.abs(np.linalg.det(turned)))]
    base = np.cos(best) * pencil[0] - np.sin(best) * pencil[1]
    step = np.cos(best) * pencil[1] + np.sin(best) * pencil[0]
    adjugates = [_mixed(S, S) / 2 for S in (base, step)]
    middle = (np.trace(adjugates[1] @ base), np.trace(adjugates[0] @ step))
    roots = np.roots([np.linalg.det(step), *middle, np.linalg.det(base)])
    return [base + t.real * step for t in roots if abs(t.imag) <= _REAL * (1 + abs(t))]


def _four(forms: Float[np.ndarray, "3 3 3"]) -> Float[np.ndarray, "4 6"]:
    return _vector(np.concatenate([np.eye(3)[None], forms]))


def _mixed(X: np.ndarray, Y: np.ndarray) -> np.ndarray:
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
