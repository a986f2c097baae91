r"""The values of a step with any constraint: linear sections of its displacement variety.

Along the variety S the momenta $hP_i(W) = \mathrm{tr}(E_i^*(W - I)\mathbb{J})$ are linear in the entries of W. So the
values over k momenta are the points of S on a linear subspace of codimension k: there are at most $\deg S$, the number
of points on a general one, and every isolated one is the end of a path from those.

Reference: docs/theory/branches.md, "Any rows".
"""

import dataclasses
import functools
from typing import Any, ClassVar, TypeAlias, cast

import numpy as np

from nonholo.base.checks import error
from nonholo.base.numerics import applied
from nonholo.base.types import Array, Bool, Float, Inexact
from nonholo.discrete._discretization import Discretization, as_discretization
from nonholo.discrete._scheme import free_rows, matrix_legendre
from nonholo.discrete.branching._equations import FAR, Equations, Frame, frame_of, has_frame
from nonholo.discrete.branching._roots import by_loops, distinct, disturb, follow_all, roots_of
from nonholo.discrete.routes import make_route
from nonholo.groups import AbstractMatrixGroup

_ROWS, _RANK = 5, 4  # of matrices and of constraints that are tried
_REMEDY = "Only the principal branch is computed (`simulate`)."
_DETOURS = 2  # by which paths are followed again
_STRIDE = 100.0  # by which general momenta grow at once
_RIDGE = 1e-16  # relative, of triangles of least squares, lest they be singular
_LINEAR = 1e-8  # relative bend of the sum of all points, whose subspace is moved in parallel


@dataclasses.dataclass(frozen=True, eq=False)
class Section(Equations):
    r"""The equations $W W^{-1} = I$, $(W - W^{-1})/2 \in \mathfrak{d}$, k linear ones; points are 1 and W - I.

    Attributes:
        sections: The variety.
        slices: Coefficients of the entries, which add up to the target.
    """

    sections: Any = None
    slices: Any = None
    parameters: ClassVar[tuple[str, ...]] = ("slices", "target")
    is_balanced: ClassVar[bool] = False  # type: ignore[override]

    @property
    def count(self) -> int:
        """Number of points over general momenta of this body."""
        return len(self.sections.generic[1])

    @property
    def most(self) -> int:
        """Number of points of a general section of the variety, its degree."""
        return len(_witness(self.sections.group, self.sections.directions.tobytes())[1])

    @property
    def slides(self) -> Bool[np.ndarray, "m"]:
        """Which coordinates of a point are lengths."""
        columns = np.arange(self.slices.shape[1]) % self.sections.group.size
        return np.append(False, self.sections.group.is_affine & (columns == self.sections.group.size - 1))

    @property
    def horizon(self) -> Float[np.ndarray, "m"]:
        """Sizes of coordinates that count as infinite."""
        return np.full(1 + self.slices.shape[1], FAR * max(1.0, np.abs(self.target).max()))

    def starts(self) -> Inexact[np.ndarray, "B m"]:
        """Return no approximate roots: they are followed."""
        return self.points([])

    def around(self) -> tuple[Equations, Inexact[np.ndarray, "B m"]]:
        """Return the problem of general momenta of the same size and its roots."""
        generic, points = self.sections.generic
        while np.abs(self.target).max() > _STRIDE * np.abs(generic.target).max():
            larger = dataclasses.replace(generic, target=_STRIDE * generic.target)
            generic, points = larger, follow_all(larger, generic, points)
        return generic, points

    def residual(self, x: Inexact[Array, "... m"]) -> tuple[Inexact[Array, "... e"], Inexact[Array, "... e"]]:
        """Return the equations, the last one that of the first coordinate, and the sizes of their terms."""
        w, W, back = x[..., 1:], *self.sections.matrices(x)
        plain = np.eye(W.shape[-1])
        sections = applied(self.slices, w) - self.target
        rows = [_flat(W @ back - plain), self.sections.forbidden((W - back) / 2), sections, x[..., :1] - 1]
        size, along = np.abs(W), np.abs(self.sections.directions)
        back_size = np.maximum(np.abs(back), np.abs(self.sections.inverse(size)))  # of terms that may cancel
        whole = _flat(size + back_size)
        sizes = [_flat(size @ back_size + plain), whole + applied(along.T, applied(along, whole))]
        sizes += [applied(np.abs(self.slices), np.abs(w)) + np.abs(self.target), np.abs(x[..., :1]) + 1]
        return np.concatenate(rows, axis=-1), np.concatenate(sizes, axis=-1)

    def slope(self, x: Inexact[Array, "... m"]) -> Inexact[Array, "... e m"]:
        """Return the derivative of the residual."""
        W, back = (each[..., None, :, :] for each in self.sections.matrices(x))
        dW, dback = self.sections.moves(x)
        e, (k, m) = W.shape[-1] ** 2, self.slices.shape
        J = np.zeros((*x.shape[:-1], 2 * e + k + 1, m + 1), dtype=np.result_type(x, self.slices))
        J[..., :e, 1:] = np.swapaxes(_flat(dW @ back + W @ dback), -1, -2)
        J[..., e : 2 * e, 1:] = np.swapaxes(self.sections.forbidden((dW - dback) / 2), -1, -2)
        J[..., 2 * e : -1, 1:], J[..., -1, 0] = self.slices, 1
        return J

    def solve(self, x: Inexact[Array, "... m"], right: Inexact[Array, "... e"]) -> Inexact[Array, "... m"]:
        """Return the move that changes the residual most nearly by the right-hand side."""
        Q, R = np.linalg.qr(self.slope(x))
        ridge = _RIDGE * np.abs(R).max((-2, -1), keepdims=True) * np.eye(x.shape[-1])
        return np.linalg.solve(R + ridge, np.swapaxes(Q.conj(), -1, -2) @ right[..., None])[..., 0]

    def regularity(self, x: Inexact[Array, "... m"]) -> Float[np.ndarray, "..."]:
        """Return the least singular value of the derivative of the momenta along S, one at the identity."""
        k, (_, back) = len(self.target), self.sections.matrices(x)
        along = np.swapaxes(np.linalg.svd(self.slope(x)[..., : -k - 1, 1:])[2][..., -k:, :].conj(), -1, -2)
        dW, _ = self.sections.moves(x)
        R = np.linalg.qr(np.swapaxes(_flat(back[..., None, :, :] @ dW), -1, -2) @ along)[1]
        return np.linalg.svd((self.slices @ along) @ np.linalg.inv(R), compute_uv=False)[..., -1]


def _flat(X: Array) -> Array:
    return X.reshape(*X.shape[:-2], X.shape[-2] * X.shape[-1])


@dataclasses.dataclass(frozen=True, eq=False)
class Sections:
    """The way from a system to the linear sections of its variety.

    Attributes:
        group: The group.
        stretch: What entries of W - I are multiplied by, for the body's unit of length.
        directions: Orthonormal matrices that span the constraint subspace.
        slices: Their components of the inverse inertia times hP, by the entries of W - I.
        units: The same components of momenta.
        discrete: The discretization of the system; None of no special one.
    """

    group: AbstractMatrixGroup
    stretch: Float[np.ndarray, "N N"]
    directions: Float[np.ndarray, "k N*N"]
    slices: Float[np.ndarray, "k m"]
    units: Float[np.ndarray, "k k"]
    discrete: Any = None

    def equations(self, momentum: Inexact[np.ndarray, "k"]) -> Section:
        """Return the equations for canonical restricted momenta, multiplied by the time step."""
        return self.section(self.slices, self.units @ momentum)

    def section(self, slices: Inexact[Array, "k m"], target: Inexact[Array, "k"]) -> Section:
        """Return the equations of a linear section."""
        none = np.zeros(len(target))
        return Section(none, none, target, sections=self, slices=slices)

    def increment(self, x: Inexact[Array, "... m"]) -> Inexact[Array, "... N N"]:
        """Return the canonical displacements minus the identity."""
        N = self.group.size
        rows = x[..., 1:].reshape(*x.shape[:-1], free_rows(self.group), N)
        X = np.zeros((*x.shape[:-1], N, N), dtype=x.dtype)
        X[..., : rows.shape[-2], :] = rows
        return X / self.stretch

    def point(self, W: Inexact[np.ndarray, "N N"]) -> Inexact[np.ndarray, "m"]:
        """Return the value nearest to a canonical displacement among those over its momenta."""
        w = _flat(((W - self.group.identity) * self.stretch)[: free_rows(self.group)])
        values = [root.point for root in roots_of(self.section(self.slices, self.slices @ w))]
        return min(values, key=lambda x: np.linalg.norm(x[1:] - w), default=np.full(1 + len(w), np.nan))

    @functools.cached_property
    def _units(self) -> tuple[Float[np.ndarray, "m N N"], Float[np.ndarray, "N N"], Float[np.ndarray, "N N"]]:
        """How W moves with each entry, in the unit of length; G and its inverse."""
        m, G = self.slices.shape[1], np.eye(self.group.size) if self.group.form is None else self.group.form
        return self.increment(np.eye(m, m + 1, k=1)) * self.stretch, G, np.linalg.inv(G)

    def matrices(self, x: Inexact[Array, "... m"]) -> tuple[Array, Array]:
        """Return displacements and their inverses as polynomials of the entries, in the unit of length."""
        W = self.increment(x) * self.stretch + np.eye(self.group.size)
        return W, self.inverse(W)

    def moves(self, x: Inexact[Array, "... m"]) -> tuple[Array, Array]:
        """Return how displacements and their inverses move with the entries."""
        dW = self._units[0]
        W = self.matrices(x)[0][..., None, :, :]
        return dW, (self.inverse(W + dW) - self.inverse(W - dW)) / 2  # of quadratic polynomials exact

    def inverse(self, W: Array) -> Array:
        """Return what is the inverse of W if that is a displacement."""
        _, G, inverse = self._units
        back = inverse @ np.swapaxes(W, -1, -2) @ G
        if self.group.is_affine:
            back[..., :-1, -1:], back[..., -1, :-1] = -back[..., :-1, :-1] @ W[..., :-1, -1:], 0
        return back

    def forbidden(self, X: Array) -> Array:
        """Return what of matrices lies across the constraint subspace."""
        x = _flat(X)
        return x - applied(self.directions.T, applied(self.directions, x))

    @functools.cached_property
    def generic(self) -> tuple[Section, Inexact[np.ndarray, "B m"]]:
        """The problem of general complex momenta of this body and its roots."""
        (start, points), rng = _witness(self.group, self.directions.tobytes()), np.random.default_rng(1)
        generic = self.section(self.slices, disturb(start, rng).target)
        ends = follow_all(generic, start, points)
        for _ in range(_DETOURS):
            if len(ends) < len(points):  # some lead to infinity, others may be lost
                middle = disturb(start, rng)
                around = follow_all(generic, middle, follow_all(middle, start, points))
                ends = distinct(generic, np.concatenate([ends, around]))
        return generic, ends


@functools.lru_cache(maxsize=64)
def _witness(group: AbstractMatrixGroup, data: bytes) -> tuple[Section, Inexact[np.ndarray, "B m"]]:
    """Return a general linear section of a variety and its points, which loops of sections join to the identity."""
    directions, rng = np.frombuffer(data).reshape(-1, group.size**2), np.random.default_rng(0)
    k, m = len(directions), group.size * free_rows(group)
    sections = Sections(group, np.ones(group.identity.shape), directions, np.zeros((k, m)), np.eye(k))
    still = sections.section(np.zeros((k, m)), np.zeros(k))
    generic = disturb(still, rng)
    through = dataclasses.replace(generic, target=np.zeros(k))
    seed = follow_all(generic, through, np.eye(1, m + 1, dtype=complex))
    is_whole = functools.partial(_is_whole, generic)
    points = by_loops(generic, seed, lambda: disturb(still, rng), is_whole)
    if not is_whole(points):
        raise RuntimeError(f"Loops found {len(points)} points of a general section of the variety, which are not all.")
    return generic, points


def _is_whole(generic: Section, points: Inexact[np.ndarray, "B m"]) -> bool:
    """Return whether the sum of the points moves on a line with the last subspace: then they are all, else not."""
    sums = [points.sum(axis=0)]
    for s in (1, 2):
        target = generic.target + s * np.eye(len(generic.target))[-1]
        ahead = follow_all(dataclasses.replace(generic, target=target), generic, points)
        if len(ahead) != len(points):
            return False
        sums.append(ahead.sum(axis=0))
    return bool(np.abs(sums[0] - 2 * sums[1] + sums[2]).max() <= _LINEAR * np.abs(sums).max())


AnyFrame: TypeAlias = Frame | Sections


def frame_for(owner: str, value: Any) -> AnyFrame:
    """Return the frame of a discretization whose branches are known, or refuse it."""
    where = f"{owner}(discrete=...)"
    discrete = as_discretization(where, value)
    if has_frame(discrete):
        return frame_of(where, discrete)
    system, route = discrete.system, make_route(discrete, "matrix")
    if route.name != "matrix" or system.is_spatial:
        requirement = "have a mass tensor, a constraint fixed in the body, difference 'matrix' and constraint 'skew'"
        got = f"{type(system).__name__}, difference {discrete.difference!r}, constraint {discrete.constraint!r}"
        raise error(where, requirement, got, _REMEDY)
    if system.group.size > _ROWS or not 1 <= system.rank <= _RANK:
        requirement = f"have matrices of at most {_ROWS} rows and a constraint of rank 1 to {_RANK}"
        raise error(where, requirement, f"{system.group.size} rows and rank {system.rank}", _REMEDY)
    return _sections(discrete)


@functools.lru_cache(maxsize=64)
def _sections(discrete: Discretization) -> Sections:
    system, unit = discrete.system.canonical, cast(Any, make_route(discrete, "matrix")).body.unit
    group, E, n = system.group, system.constraint_subspace, free_rows(system.group)
    shrink = np.where(np.arange(group.size) < n, 1 / unit, 1.0)
    stretch = np.outer(shrink, 1 / shrink)
    Q, R = np.linalg.qr((group.hat(E) * stretch).reshape(len(E), -1).T)
    units = R @ np.linalg.inv(system.constrained_inertia)
    entries = np.eye(group.size * n, group.size**2).reshape(-1, *stretch.shape) / stretch
    momenta = matrix_legendre(group, system.homogeneous_mass_tensor, entries, "left") @ E.T
    return Sections(group, stretch, Q.T, units @ momenta.T, units, discrete)
