"""A group of the user's, from a basis of its Lie algebra of matrices.

Whether matrices span a Lie algebra, and one that preserves a bilinear form: then $W^{-1} = G^{-1}W^TG$.
"""

import dataclasses
import functools

import numpy as np

from nonholo.base import numerics
from nonholo.base.checks import array, assign, error
from nonholo.base.types import Array, Float
from nonholo.groups._base import AbstractMatrixGroup, coordinates_of

_REPRODUCED = 1e-8  # relative error of exp(log(g)) beyond which there is no logarithm
_KNOWN = 1e-12  # of 1 / (|g| |g^-1|), above which the sign of a determinant is no rounding error
_HALVINGS = 3  # square roots before the integral of the logarithm: eigenvalues up to exp(16)

_CLOSED = 1e-10  # relative; a basis or a form typed with ten digits is taken as meant


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class MatrixGroup(AbstractMatrixGroup):
    r"""The connected group of matrices whose Lie algebra is spanned by a basis; coordinates are its coefficients.

    The compact pose is the matrix row by row, never corrected; random elements are exponentials of standard normal
    coordinates. `log` is the principal logarithm: it exists if no eigenvalue is real and negative.

    With a form the group is "quadratic": $g^TGg = G$, its inverse is $G^{-1}g^TG$, a mass tensor may be given to
    `LLSystem`, and the discrete map conserves the energy (docs/theory/energy-theorem.md).

    Args:
        basis: Matrices $E_1, \dots, E_{dim}$, linearly independent, with every commutator in their span.
        form: G, a nondegenerate (N, N) matrix, symmetric, antisymmetric or neither, with $x^TG + Gx = 0$ for every
            $x$ of the algebra, which must also contain every $x^3$: SO(p, q), Sp(2n), U(p, q).

    Raises:
        ValueError: The basis is not finite, dependent, or a commutator leaves its span (named with its distance); the
            form is degenerate or not preserved, or cubes leave the algebra, as those of SU(p, q), p + q > 2.

    Example:
        The Heisenberg group, $[E_1, E_2] = E_3$:

        >>> heisenberg = MatrixGroup([np.eye(3, k=1) * [0, 1, 0], np.eye(3, k=1) * [0, 0, 1], np.eye(3, k=2)])
        >>> heisenberg.exp(np.array([1.0, 1.0, 0.0]))
        array([[1. , 1. , 0.5],
               [0. , 1. , 1. ],
               [0. , 0. , 1. ]])

        SL(2, R), the matrices of determinant one:

        >>> sl2 = MatrixGroup([[[1, 0], [0, -1]], [[0, 1], [0, 0]], [[0, 0], [1, 0]]])
        >>> sl2
        MatrixGroup(dim=3, N=2)
        >>> sl2.bracket(np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]))
        array([0., 2., 0.])

        The Lorentz group SO(2, 1):

        >>> G = np.diag([1.0, 1.0, -1.0])
        >>> lorentz = MatrixGroup(G @ SO(3).basis, form=G)
        >>> lorentz.inverse(lorentz.exp([0.0, 1.0, 0.0])).round(3)
        array([[ 1.543,  0.   , -1.175],
               [ 0.   ,  1.   ,  0.   ],
               [-1.175,  0.   ,  1.543]])
    """

    basis: Array
    form: Array | None = None

    def __post_init__(self) -> None:
        basis = checked_basis("MatrixGroup(basis=...)", self.basis)
        dim, size, _ = basis.shape
        assign(self, basis=basis, dim=dim, size=size, pose_size=size * size)
        if self.form is not None:
            assign(self, form=checked_form("MatrixGroup(form=...)", self.basis, self.form))

    def __repr__(self) -> str:
        return f"MatrixGroup(dim={self.dim}, N={self.size}{'' if self.form is None else ', with a form'})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, MatrixGroup) and self._content == other._content

    def __hash__(self) -> int:
        return hash(self._content)

    @functools.cached_property
    def _content(self) -> tuple:
        return self.basis.shape, self.basis.tobytes(), None if self.form is None else self.form.tobytes()

    @property
    def has_drift(self) -> bool:  # type: ignore[override]
        """Whether poses that grow leave the group by rounding, which is known where there is a form."""
        return self.form is not None

    @functools.cached_property
    def has_cayley(self) -> bool:
        """Whether the Cayley map stays in the group: with a form, or by trying random elements of the algebra."""
        if self.has_skew_part:
            return True
        X = self.hat(np.random.default_rng(0).normal(size=(4, self.dim)))
        X = X / np.abs(X).sum(axis=-1).max()
        return bool(np.all(self.residual(np.eye(self.size) + numerics.cayley_increment(X)) < _REPRODUCED))

    def exp_increment(self, x: Float[Array, "... dim"]) -> Float[Array, "... N N"]:
        """Return `exp(x)` minus the identity, without cancellation."""
        return numerics.exponential_increment(self.hat(x))

    def log(self, g: Float[Array, "... N N"]) -> Float[Array, "... dim"]:
        """Return the coordinates of the principal logarithm.

        Raises:
            ValueError: There is no real principal logarithm, or it lies outside the algebra (NumPy; nothing is checked
                in traced code).
        """
        g = self._matrix(g)
        if not isinstance(g, np.ndarray):
            return self.vee(numerics.principal_logarithm(g, _HALVINGS))
        where, X = f"{self!r}.log(g=...)", _checked_logarithm(g)
        is_missing = np.isnan(X).any(axis=(-2, -1)) & np.isfinite(g).all(axis=(-2, -1))
        if np.any(is_missing):
            got = f"eigenvalues {np.linalg.eigvals(g[is_missing][0]).round(6).tolist()}"
            raise error(where, "have a real principal logarithm", got, "Split g into factors nearer to the identity.")
        x = self.vee(X)
        gap = np.abs(X - self.hat(x)).max(axis=(-2, -1), initial=0.0)
        if np.any(gap > _REPRODUCED * (1 + np.abs(X).max(axis=(-2, -1), initial=0.0))):
            got = f"a matrix whose logarithm is {np.nanmax(gap):.3g} away from the algebra"
            raise error(where, "lie in the group", got, "Build it with `exp`.")
        return x

    def cayley_increment(self, x: Float[Array, "... dim"]) -> Float[Array, "... N N"]:
        """Return `cayley(x)` minus the identity.

        Raises:
            ValueError: The Cayley map leaves this group.
        """
        if not self.has_cayley:
            where = f"{self!r}.cayley"
            raise error(where, "stay in the group", "an algebra whose Cayley map leaves it", "Use `exp` or `retract`.")
        return numerics.cayley_increment(self.hat(x))

    def inverse(self, g: Float[Array, "... N N"]) -> Float[Array, "... N N"]:
        """Return the inverse matrix."""
        g = self._matrix(g)
        return numerics.inverse_of(g) if self.form is None else self.form_adjoint(g)

    def residual(self, g: Float[Array, "... N N"]) -> Float[Array, "..."]:
        """Return the distance of the logarithm from the algebra; infinite where there is no logarithm (JAX: undefined).

        With a form: the residual of g* g = I relative to |g*| |g|, or the distance of (g - g*)/2 from the algebra
        relative to |g|, whichever is larger; 2 for a negative determinant. Other components of the group are not
        distinguished.
        """
        g = self._matrix(g)
        xp = g.__array_namespace__()
        if self.form is not None:
            adjoint = self.form_adjoint(g)
            size, other = (xp.maximum(xp.max(abs(X), axis=(-2, -1), keepdims=True), 1) for X in (g, adjoint))
            g, adjoint, eye = g / size, adjoint / other, numerics.identity_like(g) / size / other
            K = (g - adjoint * (other / size)) / 2
            worst = xp.maximum(abs(adjoint @ g - eye), abs(K - self.hat(self.vee(K))))
            is_negative = (eye[..., 0, 0] > _KNOWN) & (xp.linalg.det(g) < 0)
            return xp.where(is_negative, 2.0, xp.max(worst, axis=(-2, -1)))
        X = _checked_logarithm(g) if isinstance(g, np.ndarray) else numerics.principal_logarithm(g, _HALVINGS)
        gap = xp.max(abs(X - self.coordinates.matrix(self.coordinates.vector(X))), axis=(-2, -1))
        return xp.where(xp.isnan(gap), xp.inf, gap)

    def angle(self, x: Float[Array, "... dim"]) -> Float[Array, "..."]:
        """Return the largest imaginary part of an eigenvalue of `hat(x)`."""
        X = self.hat(x)
        xp = X.__array_namespace__()
        return xp.max(abs(xp.imag(xp.linalg.eigvals(X))), axis=-1)


def _checked_logarithm(g: np.ndarray) -> np.ndarray:
    """Return principal logarithms, NaN where the exponential does not lead back."""
    with np.errstate(all="ignore"):
        X = numerics.principal_logarithm(g, _HALVINGS)
        image = numerics.identity_like(g) + numerics.exponential_increment(X)
        miss = np.abs(image - g).max(axis=(-2, -1), keepdims=True, initial=0.0)
        size = np.abs(g).max(axis=(-2, -1), keepdims=True, initial=1.0)
        return np.where(miss <= _REPRODUCED * size, X, np.nan)


def checked_basis(where: str, basis: Array) -> Float[np.ndarray, "dim N N"]:
    """Return the basis as a read-only array, refused if it does not span a Lie algebra of square matrices."""
    basis = array(where, basis, (None, None, None), "Pass the basis as an array of shape (dim, N, N).")
    if basis.shape[0] == 0 or basis.shape[1] != basis.shape[2]:
        raise error(where, "hold square matrices", f"shape {basis.shape}", "Pass an array of shape (dim, N, N).")
    lengths = np.linalg.norm(basis, axis=(1, 2), keepdims=True)
    if not np.all(lengths > 0):
        got = f"a zero matrix at index {int(np.argmin(lengths))}"
        raise error(where, "be linearly independent", got, "Leave it out.")
    unit = basis / lengths
    values = np.linalg.svd(unit.reshape(len(basis), -1), compute_uv=False)
    rank = int(np.sum(values > _CLOSED * values[0]))
    if rank < len(basis):
        got = f"{len(basis)} matrices of rank {rank}"
        raise error(where, "be linearly independent", got, "Leave out matrices that the others span.")
    products = unit[:, None] @ unit[None]
    brackets = products - np.swapaxes(products, 0, 1)
    coordinates = coordinates_of(unit)
    gap = np.linalg.norm(brackets - coordinates.matrix(coordinates.vector(brackets)), axis=(2, 3))
    if gap.max() > _CLOSED:
        i, j = (int(k) for k in np.unravel_index(gap.argmax(), gap.shape))
        got = f"the bracket of matrices {i} and {j}, which leaves the span by {gap[i, j]:.3g} (both scaled to length 1)"
        raise error(where, "span a Lie algebra", got, "Add the missing brackets to the basis, or check its entries.")
    return array(where, basis + 0.0, basis.shape)  # without negative zeros: equal bases have equal bytes


def checked_form(where: str, basis: Float[np.ndarray, "dim N N"], form: Array) -> Float[np.ndarray, "N N"]:
    r"""Return G as a read-only array, refused unless the energy theorem holds on the group of the basis.

    G must be nondegenerate, $x^TG + Gx = 0$ on the algebra, and $x^3$ must stay in it: then so does
    $(W - W^{-1})/2$, see docs/theory/energy-theorem.md.
    """
    size = basis.shape[-1]
    form = array(where, form, (size, size), f"Pass the ({size}, {size}) matrix G of the form that the group preserves.")
    values = np.linalg.svd(form, compute_uv=False)
    if not values[-1] > _CLOSED * values[0]:
        got = f"singular values from {values[0]:.3g} to {values[-1]:.3g}"
        raise error(where, "be nondegenerate", got, "Leave it out: without it W^-1 is not linear in W.")
    unit = basis / np.linalg.norm(basis, axis=(1, 2), keepdims=True)
    residuals = np.abs(unit.mT @ (form / values[0]) + (form / values[0]) @ unit).max(axis=(1, 2))
    if residuals.max() > _CLOSED:
        worst = int(residuals.argmax())
        got = f"a residual of {residuals[worst]:.3g} at matrix {worst} of the basis (both scaled to length 1)"
        raise error(where, "satisfy x^T G + G x = 0 on the algebra", got, "Pass the form that the group preserves.")

    coordinates = coordinates_of(unit)  # that x^3 stays in the algebra is a polynomial identity, tried on random x
    X = coordinates.matrix(np.random.default_rng(0).normal(size=(4, len(unit))) / np.sqrt(len(unit)))
    cubes = X @ X @ X
    gap = np.abs(cubes - coordinates.matrix(coordinates.vector(cubes))).max()
    if gap > _CLOSED * np.abs(cubes).max():
        requirement = "be that of a group whose algebra contains (W - W^-1)/2"
        got = f"an algebra that a cube leaves by {gap / np.abs(cubes).max():.3g} of its size"
        raise error(where, requirement, got, "Pass the whole algebra of the form: U(p, q), not SU(p, q).")
    return array(where, form + 0.0, form.shape)
