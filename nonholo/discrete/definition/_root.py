"""The principal root of a system of equations, for JAX: continuation from zero, then Newton's method."""

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.results import Outcome
from nonholo.base.traced import implicit
from nonholo.base.types import Array, Float

_FIRST = 0.25  # first continuation step, in s
_SMALLEST = 1e-7  # continuation step, relative to s, below which the branch is given up
_CORRECTIONS = 8  # of Newton's method at each continuation step
_LAST = 20  # of Newton's method at the end, to rounding
_JUMP = 0.2  # a continuation step that moves y further than this, relative to 1 + |y|^2, is not trusted
_NEAR_FOLD = 1e-2  # of the Jacobian determinant at zero, where a continuation that stops has met a fold
_NOWHERE = 0.3  # y of a root that was not found
_FAR = 1e3  # size of y where a chart of the displacements ends: an angle of 179.9 degrees

Residual = Callable[[Array, Array], Array]
Certificate = Callable[[Array, Array], Array]
Root = tuple[Float[Array, "m"], Float[Array, "k"]]
"""A root and its target."""
Guess = Float[Array, "m"] | None


def principal_root(
    residual: Residual, target: Array, unknowns: int, certificate: Certificate | None = None, guess: Guess = None
) -> tuple[Float[Array, "m"], Array]:
    r"""Solve residual(y, target) = 0 for the root that (0, 0) reaches along s target, 0 <= s <= 1.

    The steps in s shrink where the corrector moves far from the tangent or the sign of the Jacobian determinant would
    change, at a fold. Derivatives are those of the implicit function, not of the iteration.

    Args:
        residual: A function of y and the momenta, zero at (0, 0).
        target: The momenta.
        unknowns: Number m of components of y.
        certificate: Whether a root is certainly the principal one, by the root alone.
        guess: Where Newton's method may look first; what it finds there needs the certificate.

    Returns:
        The root and the outcome as an integer array. Where that is not successful the root is any finite number, with
        some finite derivative along all that the residual depends on.
    """
    nothing = jnp.zeros(unknowns, target.dtype), jnp.zeros_like(target)
    return followed_root(residual, nothing, target, certificate, guess)


def followed_root(
    residual: Residual, start: Root, target: Array, certificate: Certificate | None = None, guess: Guess = None
) -> tuple[Float[Array, "m"], Array]:
    """Solve residual(y, target) = 0 for the root that a given one reaches while the momenta move straight to target.

    As `principal_root`, from a start of the caller's: a root and its momenta.
    """
    residual, numbers = jax.closure_convert(residual, *start)
    certificate, facts = jax.closure_convert(certificate or (lambda _y, _m: jnp.asarray(False)), *start)
    return _search(residual, certificate, numbers, facts, start, target, guess)


@functools.partial(jax.custom_jvp, nondiff_argnums=(0, 1))
def _search(
    residual: Any, certificate: Any, numbers: list[Array], facts: list[Array], start: Root, target: Array, guess: Any
) -> tuple[Array, Array]:
    """Return where the search ends, and its outcome; what the functions are made of stands in `numbers` and `facts`."""

    def is_certain(y: Array, m: Array) -> Array:
        return certificate(y, m, *facts)

    end, at_fold, is_lost = _continue(lambda y, m: residual(y, m, *numbers), start, target, guess, is_certain)
    y = end.iterate
    converged = end.converged & jnp.all(jnp.isfinite(y)) & jnp.all(jnp.isfinite(target))
    code = jnp.where(is_lost, int(Outcome.branch_unverified), int(Outcome.successful))
    beyond = is_lost & (jnp.sum(end.root**2) > _FAR**2)
    code = jnp.where(converged | beyond, code, int(Outcome.not_converged))
    code = jnp.where(at_fold, int(Outcome.no_real_branch), code)
    code = jnp.where(jnp.all(jnp.isfinite(target)), code, int(Outcome.nonfinite))
    code = jnp.where(converged & is_certain(y, target), int(Outcome.successful), code)
    return jnp.where(code == 0, y, _NOWHERE), code


@_search.defjvp
def _implicit(residual: Any, certificate: Any, primals: Any, tangents: Any) -> tuple[Any, Any]:
    """Return the derivative of the implicit function at the root, which does not depend on the search."""
    y, code = _search(residual, certificate, *primals)
    numbers, _, start, target, _ = primals
    finite = jnp.all(jnp.isfinite(target))
    at, rates = jnp.where(finite, target, start[1]), jnp.where(finite, tangents[3], 0.0)
    y, change = implicit(residual, y, (at, *numbers), (rates, *tangents[0]), lambda *system: _solve(*system)[1])
    return (y, code), (change, np.zeros(code.shape, jax.dtypes.float0))


def _solve(matrix: Float[Array, "m m"], values: Float[Array, "m j"]) -> tuple[Array, Float[Array, "m j"]]:
    """Return the determinant and the solutions; two unknowns need no library, which would be called at each step."""
    if len(matrix) != 2:
        return jnp.linalg.det(matrix), jnp.linalg.solve(matrix, values)
    (a, b), (c, d) = matrix
    det, (first, second) = a * d - b * c, values
    return det, jnp.stack([d * first - b * second, a * second - c * first]) / det


class _Path(NamedTuple):
    """The continuation: the last root with its s, and Newton's method on the way to the next one.

    Attributes:
        s: The parameter up to which the root has been followed.
        size: Step of s that is being tried.
        root: y at s.
        tangent: Its derivative with respect to s.
        now: Jacobian determinant at s.
        start: Jacobian determinant at zero.
        guess: Where Newton's method started.
        iterate: Where it is.
        count: How many corrections it has made; -1 where the path begins, at a root.
        converged: Whether the last ones, at s = 1 from wherever the path ended, have come to rest.
        trial: Whether it has not begun: Newton's method looks at a guess first.
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
    trial: Array


def _continue(
    residual: Residual, known_root: Root, target: Array, guess: Array | None, is_certain: Certificate
) -> tuple[_Path, Array, Array]:
    """Return the end of the path, where its last root is corrected at s = 1, and whether it met a fold or was lost.

    Beginning, path and end are one loop, so that the residual and its derivatives are compiled once.
    """
    one, (root, before) = jnp.ones((), target.dtype), known_root
    evaluate = _evaluation(residual, before, target)
    eps = float(jnp.finfo(target.dtype).eps)

    def advance(path: _Path) -> _Path:
        first, last = path.count < 0, ~_is_unfinished(path)
        ahead = jnp.where(first, 0.0, jnp.where(last, 1.0, jnp.minimum(path.s + path.size, 1.0)))
        det, correction, tangent = evaluate(path.iterate, ahead)
        y = path.iterate - correction
        is_small = jnp.sum(correction**2) <= eps * (1 + jnp.sum(y**2))
        move, off = jnp.sum((y - path.root) ** 2), jnp.sum((y - path.guess) ** 2)
        near = ((off <= 0.01 * move) | (move < 1e-6)) & (move <= _JUMP**2 * (1 + jnp.sum(path.root**2)) ** 2)
        arrives = ~last & ~first & is_small & near & (det * path.now > 0)
        ends = ~last & (first | is_small | (path.count == _CORRECTIONS) | ~jnp.all(jnp.isfinite(y)))
        root, is_root = jnp.where(arrives, y, path.root), arrives | first
        here, before = (ahead, det, tangent), (path.s, path.now, path.tangent)
        s, now, tangent = (jnp.where(is_root, x, old) for x, old in zip(here, before, strict=True))
        size = jnp.where(is_root, 2 * path.size, jnp.where(ends, path.size / 4, path.size))
        following = path._replace(s=s, size=size, root=root, tangent=tangent, now=now)
        ahead = jnp.where(_is_unfinished(following), root + jnp.minimum(size, 1 - s) * tangent, root)
        at_rest = jnp.all(jnp.abs(correction) < eps**0.65 * (1 + jnp.abs(y)))  # momenta have any unit
        following = following._replace(
            start=jnp.where(first, det, path.start),
            guess=jnp.where(ends, ahead, path.guess),
            iterate=jnp.where(ends, ahead, y),
            count=jnp.where(ends, 0, path.count + 1),
            converged=last & at_rest,
        )
        return following if guess is None else _unless_it_failed(following, begin, is_certain(y, target))

    def is_open(path: _Path) -> Array:
        return jnp.all(jnp.isfinite(target)) & (_is_unfinished(path) | (~path.converged & (path.count < _LAST)))

    zero = 0 * one
    nothing, no = jnp.zeros_like(root), jnp.asarray(False)
    begin = _Path(zero, _FIRST / 2 * one, root, nothing, zero, zero, root, root, jnp.asarray(-1), no, no)
    first = begin if guess is None else begin._replace(s=one, iterate=guess, count=jnp.asarray(0), trial=~no)
    end = jax.lax.while_loop(is_open, advance, first)
    return end, *_verdict(end)


def _is_unfinished(path: _Path) -> Array:
    least = jnp.finfo(path.s.dtype).tiny * 1e3
    return (path.s < 1) & (path.size > jnp.maximum(_SMALLEST * path.s, least))


def _unless_it_failed(path: _Path, begin: _Path, certain: Array) -> _Path:
    """Return the path, or its beginning where Newton's method failed from a guess."""
    over = (path.count > _CORRECTIONS) | path.converged | ~jnp.all(jnp.isfinite(path.iterate))
    fails = path.trial & over & ~(path.converged & certain)
    return jax.tree.map(lambda new, old: jnp.where(fails, new, old), begin, path)


def _verdict(end: _Path) -> tuple[Array, Array]:
    """Return whether a path has met a fold, or was lost."""
    is_lost = end.s < 1
    far = jnp.sum(end.root**2) > _FAR**2  # where the determinant vanishes without a fold
    at_fold = is_lost & ~far & (jnp.abs(end.now) < _NEAR_FOLD * jnp.abs(end.start))
    return at_fold, is_lost & ~at_fold


def _evaluation(residual: Residual, before: Array, target: Array) -> Callable[[Array, Array], tuple[Array, ...]]:
    """Return the function of y and s that gives Jacobian determinant, Newton correction and tangent."""

    def values(y: Array, s: Array) -> tuple[Array, Array]:
        gap = residual(y, before + s * (target - before))
        return gap, gap

    def evaluate(y: Array, s: Array) -> tuple[Array, Array, Array]:
        (slope, rate), gap = jax.jacfwd(values, argnums=(0, 1), has_aux=True)(y, s)
        det, solutions = _solve(slope, jnp.stack([gap, -rate], axis=1))
        return det, solutions[:, 0], solutions[:, 1]

    return evaluate
