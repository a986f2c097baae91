"""The principal root of a system of equations, for JAX: continuation from zero, then Newton's method."""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp

from nonholo.base.results import Outcome
from nonholo.base.types import Array, Float

_FIRST = 0.25  # first continuation step, in s
_SMALLEST = 1e-7  # continuation step, relative to s, below which the branch is given up
_CORRECTIONS = 8  # of Newton's method at each continuation step
_LAST = 20  # of Newton's method at the end, to rounding
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
    end, folded, jumped = jax.lax.stop_gradient(_continue(residual, *path))
    y = jax.lax.custom_root(lambda y: residual(y, target), end.iterate, lambda _, found: found, _solve_linear)
    converged = end.converged & jnp.all(jnp.isfinite(y)) & jnp.all(jnp.isfinite(target))
    certain = converged & (jnp.asarray(False) if certified is None else certified(y, target))
    code = jnp.where(jumped, int(Outcome.branch_unverified), int(Outcome.successful))
    beyond = jumped & (jnp.sum(end.root**2) > _FAR**2)
    code = jnp.where(converged | beyond, code, int(Outcome.not_converged))
    code = jnp.where(folded, int(Outcome.no_real_branch), code)
    code = jnp.where(jnp.all(jnp.isfinite(target)), code, int(Outcome.nonfinite))
    return y, jnp.where(certain, int(Outcome.successful), code)


def _solve_linear(function: Callable[[Array], Array], value: Array) -> Array:
    return jnp.linalg.solve(jax.jacfwd(function)(value), value)


class _Path(NamedTuple):
    """The continuation: the last root with its s, and Newton's method on the way to the next one.

    Attributes:
        s: How far the root has been followed.
        size: Step of s that is being tried.
        root: y at s.
        tangent: Its derivative with respect to s.
        now: Jacobian determinant at s.
        start: Jacobian determinant at zero.
        guess: Where Newton's method started.
        iterate: Where it is.
        count: How many corrections it has made; -1 where the path begins, at a root.
        converged: Whether the last ones, at s = 1 from wherever the path ended, have come to rest.
    """

    s: Array
    size: Array
    root: Array
    tangent: Array
    now: Array
    start: Array
    guess: Array
    iterate: Array
    count: Array
    converged: Array


def _continue(residual: Residual, begun: tuple[Array, Array], target: Array) -> tuple[_Path, Array, Array]:
    """Return the end of the path, where its last root is corrected at s = 1, and whether it met a fold or was lost.

    Beginning, path and end are one loop, so that the residual and its derivatives are compiled once.
    """
    one, (root, before) = jnp.ones((), target.dtype), begun
    evaluate = _evaluation(residual, before, target)
    eps, least = float(jnp.finfo(target.dtype).eps), jnp.finfo(target.dtype).tiny * 1e3

    def is_unfinished(path: _Path) -> Array:
        return (path.s < 1) & (path.size > jnp.maximum(_SMALLEST * path.s, least))

    def advance(path: _Path) -> _Path:
        first, last = path.count < 0, ~is_unfinished(path)
        ahead = jnp.where(first, 0.0, jnp.where(last, 1.0, jnp.minimum(path.s + path.size, 1.0)))
        det, missed, correction, tangent = evaluate(path.iterate, ahead)
        found = path.iterate - correction
        done = jnp.sum(correction**2) <= eps * (1 + jnp.sum(found**2))
        moved, off = jnp.sum((found - path.root) ** 2), jnp.sum((found - path.guess) ** 2)
        near = ((off <= 0.01 * moved) | (moved < 1e-6)) & (moved <= _JUMP**2 * (1 + jnp.sum(path.root**2)) ** 2)
        arrived = ~last & ~first & done & near & (det * path.now > 0)
        ended = ~last & (first | done | (path.count == _CORRECTIONS) | ~jnp.all(jnp.isfinite(found)))
        root, reached = jnp.where(arrived, found, path.root), arrived | first
        tangent = jnp.where(reached, tangent, path.tangent)
        s, now = jnp.where(reached, ahead, path.s), jnp.where(reached, det, path.now)
        size = jnp.where(reached, 2 * path.size, jnp.where(ended, path.size / 4, path.size))
        following = path._replace(s=s, size=size, root=root, tangent=tangent, now=now)
        guess = jnp.where(is_unfinished(following), root + jnp.minimum(size, 1 - s) * tangent, root)
        at_rest = jnp.all(jnp.abs(missed) < eps**0.65) & jnp.all(jnp.abs(correction) < eps**0.65 * (1 + jnp.abs(found)))
        return following._replace(
            start=jnp.where(first, det, path.start),
            guess=jnp.where(ended, guess, path.guess),
            iterate=jnp.where(ended, guess, found),
            count=jnp.where(ended, 0, path.count + 1),
            converged=last & at_rest,
        )

    zero, finite = 0 * one, jnp.all(jnp.isfinite(target))
    nothing, no = jnp.zeros_like(root), jnp.asarray(False)
    begin = _Path(zero, _FIRST / 2 * one, root, nothing, zero, zero, root, root, jnp.asarray(-1), no)
    end = jax.lax.while_loop(
        lambda path: (is_unfinished(path) | (~path.converged & (path.count < _LAST))) & finite, advance, begin
    )
    lost = end.s < 1
    far = jnp.sum(end.root**2) > _FAR**2  # where the determinant vanishes without a fold
    folded = lost & ~far & (jnp.abs(end.now) < _NEAR_FOLD * jnp.abs(end.start))
    return end, folded, lost & ~folded


def _evaluation(residual: Residual, before: Array, target: Array) -> Callable[[Array, Array], tuple[Array, ...]]:
    """Return the function of y and s that gives Jacobian determinant, residual, Newton correction and tangent."""

    def values(y: Array, s: Array) -> tuple[Array, Array]:
        missed = residual(y, before + s * (target - before))
        return missed, missed

    def evaluate(y: Array, s: Array) -> tuple[Array, Array, Array, Array]:
        (slope, rate), missed = jax.jacfwd(values, argnums=(0, 1), has_aux=True)(y, s)
        solved = jnp.linalg.solve(slope, jnp.stack([missed, -rate], axis=1))
        return jnp.linalg.det(slope), missed, solved[:, 0], solved[:, 1]

    return evaluate
