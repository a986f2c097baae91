"""The principal root of a system of equations, for JAX: continuation from zero, then Newton's method."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
import optimistix

from nonholo._results import Outcome
from nonholo._types import Array, Float

_SUBSTEPS = 16
_CORRECTIONS = 5
_JUMP = 0.25  # a continuation step that moves y further than this, relative to 1 + |y|^2, is not trusted

Residual = Callable[[Array, Array], Array]


def principal_root(
    residual: Residual,
    target: Float[Array, "k"],
    unknowns: int,
    certified: Callable[[Array, Array], Array] | None = None,
) -> tuple[Float[Array, "m"], Array]:
    r"""Solve residual(y, target) = 0 for the root that (0, 0) reaches along s target, 0 <= s <= 1.

    The sign of the Jacobian determinant is watched along the way: a change is a fold. Derivatives are those of the
    implicit function, not of the iteration.

    Args:
        residual: A function of y and the momenta, zero at (0, 0).
        target: The momenta.
        unknowns: Number m of components of y.
        certified: Tells of a root whether it is certainly the principal one, whatever the continuation saw.

    Returns:
        The root and the outcome as an integer array.
    """
    guess, folded, jumped = jax.lax.stop_gradient(_continue(residual, jax.lax.stop_gradient(target), unknowns))
    tolerance = float(jnp.finfo(guess.dtype).eps) ** 0.65
    solution = optimistix.root_find(
        residual, optimistix.Newton(rtol=tolerance, atol=tolerance), guess, target, max_steps=20, throw=False
    )
    y = solution.value
    finite = jnp.all(jnp.isfinite(y)) & jnp.all(jnp.isfinite(target))
    converged = (solution.result == optimistix.RESULTS.successful) & finite
    certain = converged & (jnp.asarray(False) if certified is None else certified(y, target))
    code = jnp.where(jumped, int(Outcome.branch_unverified), int(Outcome.successful))
    code = jnp.where(converged, code, int(Outcome.not_converged))
    code = jnp.where(folded, int(Outcome.no_real_branch), code)
    code = jnp.where(jnp.all(jnp.isfinite(target)), code, int(Outcome.nonfinite))
    return y, jnp.where(certain, int(Outcome.successful), code)


def _continue(residual: Residual, target: Array, unknowns: int) -> tuple[Array, Array, Array]:
    def slope(y: Array, s: Array) -> Array:
        return jax.jacfwd(residual)(y, s * target)

    def follow(y: Array, s: Array) -> tuple[Array, tuple[Array, Array]]:
        def correct(_: Array, z: Array) -> Array:
            return z - jnp.linalg.solve(slope(z, s), residual(z, s * target))

        z = jax.lax.fori_loop(0, _CORRECTIONS, correct, y)
        return z, (jnp.linalg.det(slope(z, s)), jnp.sum((z - y) ** 2) / (1 + jnp.sum(z * z)) ** 2)

    start = jnp.zeros(unknowns, target.dtype)
    steps = jnp.arange(1, _SUBSTEPS + 1, dtype=target.dtype) / _SUBSTEPS
    y, (determinants, moves) = jax.lax.scan(follow, start, steps)
    orientation = jnp.sign(jnp.linalg.det(slope(start, jnp.zeros_like(steps[0]))))
    folded = jnp.any(~(determinants * orientation > 0))
    return y, folded, jnp.any(~(moves < _JUMP**2))
