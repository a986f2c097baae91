r"""Exponential, logarithm and relatives of matrices and stacks of matrices, for NumPy and JAX; functions of angles.

Increments ($e^X - I$ instead of $e^X$) keep their relative accuracy near the identity. Even functions of an angle are
functions of its square, smooth at zero: there a polynomial replaces the quotient, and the branch that is not taken
gets a harmless argument, so that derivatives stay finite.
"""

import functools
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from nonholo.base.types import Array, Float

_TERMS = 16  # of the series for norms below 1/2
_DOUBLINGS = 20  # of traced matrices: norms up to 500,000, as in jax.scipy.linalg.expm
_ROOT_ITERATIONS = 16  # enough for angles up to 3.14 and stretches up to exp(12) of one square root
_NODES, _WEIGHTS = (half[12:] for half in np.polynomial.legendre.leggauss(24))  # exact to rounding for |K| <= 1


def identity_like(X: Float[Array, "... N N"]) -> Float[Array, "N N"]:
    """Return the identity matrix of the size, type and array namespace of `X`."""
    return X.__array_namespace__().eye(X.shape[-1], dtype=X.dtype)


def integrated_exponential(X: Float[Array, "... N N"]) -> Float[Array, "... N N"]:
    r"""Return $\varphi_1(X) = \int_0^1 e^{sX}ds = \sum_k X^k/(k+1)!$, for singular $X$ too.

    Series of $X/2^s$ and s doublings, in NumPy of all matrices together.

    Example:
        >>> X = np.diag([1.0, 0.0])
        >>> np.diag(integrated_exponential(X)).round(8)  # e - 1 and 1
        array([1.71828183, 1.        ])
    """
    return _by_doubling(X) if isinstance(X, np.ndarray) else _by_doubling_in_loops(X)


def exponential_increment(X: Float[Array, "... N N"]) -> Float[Array, "... N N"]:
    r"""Return $e^X - I = \varphi_1(X)X$ without the subtraction."""
    return integrated_exponential(X) @ X


def _by_doubling(X: np.ndarray) -> np.ndarray:
    """Halve until the norm is below 1/2; then phi(2 Y) = phi(Y) (I + E / 2), E = phi(Y) Y, and E(2 Y) = E (2 I + E)."""
    norm = np.max(np.abs(X).sum(axis=-1), initial=0.0)
    doublings = max(0, math.frexp(norm)[1] + 1) if math.isfinite(norm) else 0
    Y, eye = np.ldexp(X, -doublings), identity_like(X)
    phi = eye + Y / _TERMS
    for k in range(_TERMS - 1, 1, -1):
        phi = eye + Y @ phi / k
    E = phi @ Y
    for _ in range(doublings):
        phi, E = phi + phi @ E / 2, 2 * E + E @ E
    return phi


def _by_doubling_in_loops(X: Array) -> Array:
    """Return the same of traced matrices, NaN for too large ones; loops compile faster than the fractions of `expm`."""
    import jax.numpy as jnp
    from jax.lax import fori_loop, stop_gradient

    norm = stop_gradient(jnp.max(jnp.sum(jnp.abs(X), axis=-1, keepdims=True), axis=-2, keepdims=True))
    doublings = jnp.maximum(0, jnp.frexp(norm)[1] + 1)
    Y, eye = X / 2.0 ** doublings.astype(X.dtype), identity_like(X)
    phi = fori_loop(0, _TERMS - 2, lambda i, phi: eye + Y @ phi / (_TERMS - 1 - i), eye + Y / _TERMS)

    def double(i: Array, state: tuple[Array, Array]) -> tuple[Array, Array]:
        phi, E = state
        return jnp.where(i < doublings, phi + phi @ E / 2, phi), jnp.where(i < doublings, 2 * E + E @ E, E)

    return jnp.where(doublings > _DOUBLINGS, jnp.nan, fori_loop(0, _DOUBLINGS, double, (phi, phi @ Y))[0])


def solve(A: Float[Array, "... N N"], B: Float[Array, "... N N"]) -> Float[Array, "... N N"]:
    r"""Return $A^{-1}B$ of matrices or stacks of one shape; NaN where A is singular, as JAX has it.

    In NumPy a result that is not finite though the matrices are comes with the RuntimeWarning of 0/0.

    Example:
        >>> with np.errstate(invalid="ignore"):
        ...     solve(np.array([[[2.0]], [[0.0]]]), np.ones((2, 1, 1))).ravel()
        array([0.5, nan])
    """
    if not isinstance(A, np.ndarray):
        return A.__array_namespace__().linalg.solve(A, B)
    try:
        X = np.linalg.solve(A, B)
    except np.linalg.LinAlgError:  # one singular matrix spoils the whole stack
        return np.stack([solve(*each) for each in zip(A, B, strict=True)]) if A.ndim > 2 else B * np.divide(0.0, 0.0)
    if not np.isfinite(X).all() and np.isfinite(A).all() and np.isfinite(B).all():
        np.divide(0.0, 0.0)
    return X


def inverse_of(A: Float[Array, "... N N"]) -> Float[Array, "... N N"]:
    """Return the inverse, as `solve`."""
    return solve(A, A.__array_namespace__().broadcast_to(identity_like(A), A.shape))


def cayley_increment(X: Float[Array, "... N N"]) -> Float[Array, "... N N"]:
    r"""Return $(I - X/2)^{-1}(I + X/2) - I = (I - X/2)^{-1}X$ without the subtraction."""
    return solve(identity_like(X) - X / 2, X)


def inverse_cayley(W: Float[Array, "... N N"]) -> Float[Array, "... N N"]:
    r"""Return $K = (W + I)^{-1}(W - I)$, the matrix with $W = (I - K)^{-1}(I + K)$."""
    eye = identity_like(W)
    return solve(W + eye, W - eye)


def principal_logarithm(W: Float[Array, "... N N"], halvings: int) -> Float[Array, "... N N"]:
    r"""Return the logarithm of matrices without eigenvalues on the negative real axis; smooth at the identity.

    With $K = (W + I)^{-1}(W - I)$ one has $\log W = 2\,\mathrm{artanh}\,K$. Each halving replaces $W$ by its square
    root, $K$ by $K(I + \sqrt{I - K^2})^{-1}$; then $\mathrm{artanh}\,K = \int_0^1 K(I - t^2K^2)^{-1}dt$ by Gauss's
    formula. One halving is exact to rounding for angles up to 3.14 and eigenvalues up to about exp(4), each further one
    for twice that logarithm. Nothing is checked: compare the exponential of the result.
    """
    xp, eye = W.__array_namespace__(), identity_like(W)
    K = _repeat(lambda K: solve(eye + _square_root(eye - K @ K), K), halvings, inverse_cayley(W))
    nodes, weights = xp.asarray(_NODES, dtype=W.dtype), xp.asarray(_WEIGHTS, dtype=W.dtype)
    squares = (nodes * nodes)[:, None, None] * (K @ K)[..., None, :, :]
    terms = solve(eye - squares, xp.broadcast_to(K[..., None, :, :], squares.shape))
    return 2.0 ** (halvings + 1) * xp.sum(weights[:, None, None] * terms, axis=-3)


def _square_root(A: Array) -> Array:
    """The iteration of Denman and Beavers in product form, whose rounding errors do not grow."""
    eye = identity_like(A)

    def improve(state: tuple[Array, Array]) -> tuple[Array, Array]:
        root, product = state
        inverse = inverse_of(product)
        return root @ (eye + inverse) / 2, eye / 2 + (product + inverse) / 4

    return _repeat(improve, _ROOT_ITERATIONS, (A, A))[0]


def _repeat(function: Callable[[Any], Any], times: int, state: Any) -> Any:
    """Return what a function makes of arrays after this many calls; JAX compiles it once."""
    if isinstance(state, np.ndarray) or (isinstance(state, tuple) and isinstance(state[0], np.ndarray)):
        return functools.reduce(lambda x, _: function(x), range(times), state)
    from jax.lax import fori_loop

    return fori_loop(0, times, lambda _, x: function(x), state)


def of_skew(X: Float[np.ndarray, "... n n"], function: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    r"""Return a function f of skew-symmetric matrices with eigenvalues $\pm i\theta$, real if $f(\bar z) = \bar f(z)$.

    `function` takes $\theta$ and returns $f(i\theta)$. The error is rounding of the largest value for all angles,
    because the eigenvectors are orthonormal. NumPy only: eigenvectors have no derivative where angles coincide.

    Example:
        >>> of_skew(np.array([[0.0, -np.pi], [np.pi, 0.0]]), lambda angle: np.exp(1j * angle)).round(12) + 0.0
        array([[-1.,  0.],
               [ 0., -1.]])
    """
    angles, V = np.linalg.eigh(-1j * X)
    return np.real((V * function(angles)[..., None, :]) @ np.conj(np.swapaxes(V, -1, -2)))


def block_diagonal(blocks: list[Array]) -> Float[Array, "... N N"]:
    """Return the square matrices with these square blocks on the diagonal, zeros elsewhere.

    Example:
        >>> block_diagonal([np.eye(1), np.full((2, 2), 3.0)])
        array([[1., 0., 0.],
               [0., 3., 3.],
               [0., 3., 3.]])
    """
    xp, size, start, rows = blocks[0].__array_namespace__(), sum(block.shape[-1] for block in blocks), 0, []
    for block in blocks:
        before = xp.zeros((*block.shape[:-1], start), dtype=block.dtype)
        start += block.shape[-1]
        after = xp.zeros((*block.shape[:-1], size - start), dtype=block.dtype)
        rows.append(xp.concatenate([before, block, after], axis=-1))
    return xp.concatenate(rows, axis=-2)


_SMALL = 1e-3  # squared angle below which the truncated series are exact to rounding


def sinc(square: Float[Array, "..."]) -> Float[Array, "..."]:
    r"""Return $\sin\theta/\theta$ for $\theta^2$ = `square`.

    Example:
        >>> import numpy as np
        >>> float(sinc(np.float64(0.0))), round(float(sinc(np.float64(np.pi**2))), 12)
        (1.0, 0.0)
    """
    return _switch(square, lambda xp, angle: xp.sin(angle) / angle, (-1 / 6, 1 / 120, -1 / 5040))


def versine(square: Float[Array, "..."]) -> Float[Array, "..."]:
    r"""Return $(1 - \cos\theta)/\theta^2$ for $\theta^2$ = `square`, as half a squared sinc of the half angle."""
    half = sinc(square / 4)
    return half * half / 2


def half_cotangent(square: Float[Array, "..."]) -> Float[Array, "..."]:
    r"""Return $(\theta/2)\cot(\theta/2)$ for $\theta^2$ = `square` (zero at $\theta = \pi$)."""

    def quotient(xp: Array, angle: Array) -> Array:
        return angle / 2 * xp.cos(angle / 2) / xp.sin(angle / 2)

    return _switch(square, quotient, (-1 / 12, -1 / 720, -1 / 30240))


def _switch(square: Array, quotient: Array, series: tuple[float, float, float]) -> Array:
    xp = square.__array_namespace__()
    small = square < _SMALL
    angle = xp.sqrt(xp.where(small, math.pi**2 / 4, square))
    first, second, third = series
    return xp.where(small, 1 + square * (first + square * (second + square * third)), quotient(xp, angle))


# |B_2k| / (2k)!, k = 1 .. 10: exact to rounding for angles up to 1
_SERIES = (
    1 / 12,
    1 / 720,
    1 / 30240,
    1 / 1209600,
    1 / 47900160,
    691 / 1307674368000,
    1 / 74724249600,
    3617 / 10670622842880000,
    43867 / 5109094217170944000,
    174611 / 802857662698291200000,
)


def cotangent_deficit(square: Float[Array, "..."]) -> Float[Array, "..."]:
    r"""Return $(1 - (\theta/2)\cot(\theta/2))/\theta^2$ for $\theta^2$ = `square`, smooth at zero.

    Example:
        >>> import numpy as np
        >>> float(12 * cotangent_deficit(np.float64(0.0)))
        1.0
    """
    xp = square.__array_namespace__()
    small = square < 1
    inside, outside = xp.where(small, square, 0.0), xp.where(small, 4.0, square)
    series = 0.0 * inside
    for coefficient in reversed(_SERIES):
        series = coefficient + inside * series
    return xp.where(small, series, (1 - half_cotangent(outside)) / outside)


def real_eigenspaces(matrix: Float[np.ndarray, "3 3"], rounding: float) -> tuple[Float[np.ndarray, "_ 3"], ...]:
    r"""Return orthonormal rows for each real eigenspace of a matrix of order three, eigenvalues in ascending order.

    Eigenvalues count as one where a change of the entries by about `rounding` makes them one: those of a defective
    matrix come apart by its root, and are then real or complex by chance. A block N with trace 0 has one eigenvalue if
    $N^m = 0$, that is if the other coefficients of its characteristic polynomial vanish.

    Example:
        >>> defective = np.array([[2.0, 1.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 5.0]])
        >>> [np.abs(space).tolist() for space in real_eigenspaces(defective, 1e-14)]
        [[[1.0, 0.0, 0.0]], [[0.0, 0.0, 1.0]]]
    """
    mean = _mean(matrix)
    if _is_nilpotent(_less(matrix, mean), rounding):
        return (_kernel(_less(matrix, mean), rounding),)
    values, left = np.linalg.eig(matrix.T)
    simple = sorted((float(value.real), i) for i, value in enumerate(values) if value.imag == 0)
    for value, i in simple:
        across = np.linalg.svd(np.real(left[None, :, i]))[2][1:]  # spans the plane of the other two eigenvalues
        block = across @ matrix @ across.T
        mean = _mean(block)
        if _is_nilpotent(_less(block, mean), rounding):
            spaces = _kernel(_less(matrix, mean), rounding), _kernel(_less(matrix, value), 0.0)
            return spaces if mean < value else spaces[::-1]
    return tuple(_kernel(_less(matrix, value), 0.0) for value, _ in simple)


def _less(matrix: Float[np.ndarray, "m m"], value: float) -> Float[np.ndarray, "m m"]:
    return matrix - value * np.eye(len(matrix))


def _mean(block: Float[np.ndarray, "m m"]) -> float:
    return float(np.trace(block)) / len(block)


def _is_nilpotent(block: Float[np.ndarray, "m m"], rounding: float) -> bool:
    """Return whether the eigenvalues of a block with trace 0 are all zero, up to a change of its entries."""
    size = np.linalg.norm(block)
    squares = abs(np.trace(block @ block)) / 2
    return bool(squares <= rounding * size and abs(np.linalg.det(block)) <= rounding * size ** (len(block) - 1))


def _kernel(matrix: Float[np.ndarray, "3 3"], rounding: float) -> Float[np.ndarray, "_ 3"]:
    """Return what a singular matrix takes to zero: at least one row."""
    _, sizes, rows = np.linalg.svd(matrix)
    return rows[-max(1, int(np.sum(sizes <= rounding))) :]
