"""The principal root of a system of equations, for JAX: continuation from zero, then Newton's method."""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
import optimistix

from nonholo._results import Outcome
from nonholo._types import Array, Float

_FIRST = 0.25  # first continuation step, in s
_SMALLEST = 1e-7  # continuation step, relative to s, below which the branch is given up
_CORRECTIONS = 8  # of Newton's method
_JUMP = 0.2  # a continuation step that moves y further than this, relative to 1 + |y|^2, is not trusted
_NEAR_FOLD = 1e-2  # of the Jacobian determinant at zero, where a continuation that stops has met a fold
_FAR = 1e3  # size of y where a chart of the displacements ends: an angle of 179.9 degrees

Residual = Callable[[Array, Array], Array]


def principal_root(
    residual: Residual,
    target: Float[Array, "k"],
    unknowns: int,
    certified: Callable[[Array, Array], Array] | None = None,
) -> tuple[Float[Array, "m"], Array]:
    r"""Solve residual(y, target) = 0 for the root that (0, 0) reaches along s target, 0 <= s <= 1.

    The steps in s shrink where the corrector moves far from the tangent or the sign of the Jacobian determinant would
    change, at a fold. Derivatives are those of the implicit function, not of the iteration.

    Args:
        residual: A function of y and the momenta, zero at (0, 0).
        target: The momenta.
        unknowns: Number m of components of y.
        certified: Tells of a root whether it is certainly the principal one, whatever the continuation saw.

    Returns:
        The root and the outcome as an integer array.
    """
    nothing = jnp.zeros(unknowns, target.dtype), jnp.zeros_like(target)
    return followed_root(residual, nothing, target, certified)


def followed_root(
    residual: Residual,
    start: tuple[Float[Array, "m"], Float[Array, "k"]],
    target: Float[Array, "k"],
    certified: Callable[[Array, Array], Array] | None = None,
) -> tuple[Float[Array, "m"], Array]:
    """Solve residual(y, target) = 0 for the root that a given one reaches while the momenta move straight to target.

    As `principal_root`, from a start of the caller's: a root and its momenta.
    """
    path = jax.lax.stop_gradient((start, target))
    guess, folded, jumped = jax.lax.stop_gradient(_continue(residual, *path))
    tolerance = float(jnp.finfo(guess.dtype).eps) ** 0.65
    solution = optimistix.root_find(
        residual, optimistix.Newton(rtol=tolerance, atol=tolerance), guess, target, max_steps=20, throw=False
    )
    y = solution.value
    finite = jnp.all(jnp.isfinite(y)) & jnp.all(jnp.isfinite(target))
    converged = (solution.result == optimistix.RESULTS.successful) & finite
    certain = converged & (jnp.asarray(False) if certified is None else certified(y, target))
    code = jnp.where(jumped, int(Outcome.branch_unverified), int(Outcome.successful))
    beyond = jumped & (jnp.sum(guess**2) > _FAR**2)
    code = jnp.where(converged | beyond, code, int(Outcome.not_converged))
    code = jnp.where(folded, int(Outcome.no_real_branch), code)
    code = jnp.where(jnp.all(jnp.isfinite(target)), code, int(Outcome.nonfinite))
    return y, jnp.where(certain, int(Outcome.successful), code)


class _Path(NamedTuple):
    """The continuation: the last root with its s, and Newton's method on the way to the next one.

    Attributes:
        s: How far the root has been followed.
        size: Step of s that is being tried.
        root: y at s.
        tangent: Its derivative with respect to s.
        now: Jacobian determinant at s.
        guess: Where Newton's method started.
        iterate: Where it is.
        count: How many corrections it has made.
    """

    s: Array
    size: Array
    root: Array
    tangent: Array
    now: Array
    guess: Array
    iterate: Array
    count: Array


def _continue(residual: Residual, begun: tuple[Array, Array], target: Array) -> tuple[Array, Array, Array]:
    """Return the root at s = 1, or the last one that was reached, and whether it met a fold or was lost."""
    one, (root, before) = jnp.ones((), target.dtype), begun
    least = jnp.finfo(target.dtype).tiny * 1e3

    def evaluate(y: Array, s: Array) -> tuple[Array, Array, Array]:
        missed, rate = jax.jvp(lambda s: residual(y, before + s * (target - before)), (s,), (one,))
        slope = jax.jacfwd(residual)(y, before + s * (target - before))
        solved = jnp.linalg.solve(slope, jnp.stack([missed, -rate], axis=1))
        return jnp.linalg.det(slope), solved[:, 0], solved[:, 1]

    def going(path: _Path) -> Array:
        return (path.s < 1) & (path.size > jnp.maximum(_SMALLEST * path.s, least))

    def advance(path: _Path) -> _Path:
        ahead = jnp.minimum(path.s + path.size, 1.0)
        det, correction, tangent = evaluate(path.iterate, ahead)
        found = path.iterate - correction
        done = jnp.sum(correction**2) <= jnp.finfo(target.dtype).eps * (1 + jnp.sum(found**2))
        moved, off = jnp.sum((found - path.root) ** 2), jnp.sum((found - path.guess) ** 2)
        near = ((off <= 0.01 * moved) | (moved < 1e-6)) & (moved <= _JUMP**2 * (1 + jnp.sum(path.root**2)) ** 2)
        arrived = done & near & (det * path.now > 0)
        ended = done | (path.count == _CORRECTIONS) | ~jnp.all(jnp.isfinite(found))
        root, tangent = (jnp.where(arrived, x, y) for x, y in ((found, path.root), (tangent, path.tangent)))
        s, now = jnp.where(arrived, ahead, path.s), jnp.where(arrived, det, path.now)
        size = jnp.where(arrived, 2 * path.size, jnp.where(ended, path.size / 4, path.size))
        guess = jnp.where(ended, root + jnp.minimum(size, 1 - s) * tangent, path.guess)
        iterate = jnp.where(ended, guess, found)
        return _Path(s, size, root, tangent, now, guess, iterate, jnp.where(ended, 0, path.count + 1))

    start, _, tangent = evaluate(root, 0 * one)
    guess = root + _FIRST * tangent
    begin = _Path(0 * one, _FIRST * one, root, tangent, start, guess, guess, jnp.asarray(0))
    finite = jnp.all(jnp.isfinite(target))
    end = jax.lax.while_loop(lambda path: going(path) & finite, advance, begin)
    lost = end.s < 1
    folded = lost & (jnp.abs(end.now) < _NEAR_FOLD * jnp.abs(start))
    return end.root, folded, lost & ~folded
