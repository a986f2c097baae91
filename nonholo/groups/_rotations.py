r"""Rotations of n-dimensional space and their skew-symmetric logarithms; coordinates of so(n)."""

import numpy as np
import scipy  # its parts load on first use

from nonholo.base import numerics
from nonholo.base.checks import error
from nonholo.base.numerics import exponential_increment, identity_like, inverse_cayley, of_skew, principal_logarithm
from nonholo.base.types import Array, Float, Int

_ENTRY = 1e3  # more than any entry of a matrix that is a rotation to whatever rounding
_MODERATE = -0.5  # cosine of the angle, 120 degrees, up to which tan(angle / 2) loses no digits

_LARGE = 1e3  # lengths from which on it is asked whether one plane turns
_ONE_PLANE = 4e-15  # what other planes may turn, and what may slide across, relative to it


def cayley_increment(X: Float[np.ndarray, "... n n"]) -> Float[np.ndarray, "... n n"]:
    r"""Return $(I - Y)^{-1}(I + Y) - I$, $Y = X/2$, accurate up to half-turns of one plane.

    There Y is large, and the linear equations lose the planes that do not turn. If only one does, $Y^3 = -\tau Y$,
    $\tau = \frac12|Y|^2$, and the increment is $2(Y + Y^2)/(1 + \tau)$.
    """
    unit, inverse, one = _one_plane(X)
    if not one.any():
        return numerics.cayley_increment(X)
    formula = 2 * (inverse * unit + unit @ unit) / (1 + inverse * inverse)
    return np.where(one, formula, numerics.cayley_increment(np.where(one, 0.0, X)))


def motion_cayley_increment(X: Float[np.ndarray, "... N N"]) -> Float[np.ndarray, "... N N"]:
    r"""Return `cayley_increment` of motions, X with a last column v, as accurate.

    If one plane turns, and $v = v_\parallel + v_\perp$ along and across it, the position is
    $(I - Y)^{-1}v = v_\perp + (v_\parallel + Yv)/(1 + \tau)$. Near half-turns v may be as large as Y: what rounding
    leaves of $v_\perp$ where v slides along the plane would then hide the rest.
    """
    turn, v = X[..., :-1, :-1], X[..., :-1, -1:]
    unit, inverse, one = _one_plane(turn)
    one &= np.isfinite(_norm(v))
    if not one.any():
        return numerics.cayley_increment(X)
    formula, image = np.zeros_like(X), unit @ v
    across = v + unit @ image
    across = np.where(_norm(across) < _ONE_PLANE * _norm(v), 0.0, across)
    formula[..., :-1, :-1] = cayley_increment(turn)
    formula[..., :-1, -1:] = across + inverse * (inverse * (v - across) + image) / (1 + inverse * inverse)
    return np.where(one, formula, numerics.cayley_increment(np.where(one, 0.0, X)))


def _one_plane(X: Float[np.ndarray, "... n n"]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    r"""Return $Y/\sqrt\tau$, $1/\sqrt\tau$, and whether Y is large and turns one plane alone."""
    length = _norm(X) / np.sqrt(2)
    large = (length > _LARGE) & np.isfinite(length)
    unit, inverse = X / np.maximum(length, _LARGE), 2 / np.maximum(length, _LARGE)
    if not large.any():
        return unit, inverse, large
    one = np.abs(unit @ unit @ unit + unit).max(axis=(-2, -1), keepdims=True) < _ONE_PLANE
    return unit, inverse, one & large


def _norm(A: Float[np.ndarray, "... n m"]) -> Float[np.ndarray, "... 1 1"]:
    """Return Frobenius norms of matrices, whose squares may overflow."""
    unit = np.ldexp(0.5, np.frexp(np.abs(A).max(axis=(-2, -1), keepdims=True))[1])
    return unit * np.linalg.norm(A / unit, axis=(-2, -1), keepdims=True)


def planes(n: int) -> tuple[Int[np.ndarray, "dim 2"], Int[np.ndarray, "dim 2"], Float[np.ndarray, "dim 2"]]:
    r"""Return rows, columns and values of the entries of the basis of so(n).

    It is $e_i\wedge e_j = e_ie_j^T - e_je_i^T$, i < j in lexicographic order; for n = 3 the axes, whose matrices are
    $-e_2\wedge e_3$, $e_1\wedge e_3$, $-e_1\wedge e_2$.
    """
    i, j = (np.array([1, 0, 0]), np.array([2, 2, 1])) if n == 3 else np.triu_indices(n, 1)
    sign = np.array([-1.0, 1.0, -1.0]) if n == 3 else np.ones(len(i))
    return np.stack([i, j], axis=1), np.stack([j, i], axis=1), np.stack([sign, -sign], axis=1)


def exp_increment(X: Float[Array, "... n n"]) -> Float[Array, "... n n"]:
    r"""Return $e^X - I$ of skew-symmetric matrices."""
    return of_skew(X, lambda angle: np.expm1(1j * angle)) if isinstance(X, np.ndarray) else exponential_increment(X)


def logarithm(R: Float[Array, "... n n"], where: str) -> Float[Array, "... n n"]:
    """Return the skew-symmetric logarithm of rotations with the smallest angles.

    NumPy: accurate for every angle; pairs of eigenvalues -1 become half turns of planes. JAX: for angles up to 3.14.

    Raises:
        ValueError: A matrix is not a rotation (NumPy).
    """
    if not isinstance(R, np.ndarray):
        return principal_logarithm(R, halvings=1)
    flat = R.reshape(-1, *R.shape[-2:])
    result = np.full(flat.shape, np.nan)
    finite = np.flatnonzero(np.isfinite(flat).all(axis=(1, 2)))
    if np.abs(flat[finite]).max(initial=0.0) > _ENTRY:
        got = f"an entry {np.abs(flat[finite]).max():g}"
        raise error(where, "be a rotation", got, "Use a rotation, built by `exp` or `cayley`.")
    least_cosine = np.linalg.eigvalsh((flat[finite] + flat[finite].mT) / 2)[:, 0]
    moderate = finite[least_cosine > _MODERATE]
    K = inverse_cayley(flat[moderate])  # tan(angle / 2), to relative precision near the identity
    result[moderate] = of_skew((K - K.mT) / 2, lambda tangent: 2j * np.arctan(tangent))
    for k in finite[least_cosine <= _MODERATE]:
        result[k] = _schur_logarithm(flat[k], where)
    return result.reshape(R.shape)


def _schur_logarithm(R: np.ndarray, where: str) -> np.ndarray:
    """The real Schur form of a rotation has blocks of one or two rows; those of one row hold 1 or -1."""
    T, Z = scipy.linalg.schur(R, output="real")[:2]
    X, n = np.zeros_like(R), len(R)
    first = np.flatnonzero(np.diag(T, -1))  # rows of pairs
    cosine, sine = (T[first, first] + T[first + 1, first + 1]) / 2, (T[first + 1, first] - T[first, first + 1]) / 2
    X[first + 1, first] = np.arctan2(sine, cosine)
    alone = np.setdiff1d(np.arange(n), np.concatenate([first, first + 1]))
    flips = alone[np.diag(T)[alone] < 0]
    if len(flips) % 2:
        raise error(where, "have determinant +1", "a reflection", "Use a rotation, built by `exp` or `cayley`.")
    X[flips[1::2], flips[::2]] = np.pi
    return Z @ (X - X.T) @ Z.T


def nearest(R: Float[Array, "... n n"]) -> Float[Array, "... n n"]:
    """Return the orthogonal polar factor of matrices that are rotations up to gathered rounding errors.

    Two steps of Newton and Schulz: a defect d becomes about d**4.
    """
    for _ in range(2):
        R = R @ (3 * identity_like(R) - R.mT @ R) / 2
    return R


def residual(R: Float[Array, "... n n"]) -> Float[Array, "..."]:
    """Return the largest entry of R R^T - I; for reflections at least 2, the distance of -1 from 1."""
    xp = R.__array_namespace__()
    defect = xp.max(abs(R @ R.mT - identity_like(R)), axis=(-2, -1))
    return xp.maximum(defect, 1 - xp.sign(xp.linalg.det(R)))


def random(n: int, rng: np.random.Generator) -> Float[np.ndarray, "n n"]:
    """Draw a uniform rotation: the QR factor with positive diagonal of normal numbers, reflections turned."""
    Q, U = np.linalg.qr(rng.normal(size=(n, n)))
    Q = Q * np.sign(np.diag(U))
    Q[:, 0] *= np.sign(np.linalg.det(Q))
    return Q
