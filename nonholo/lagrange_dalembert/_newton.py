r"""The next velocity: Newton's method from an extrapolated guess, then continuation where that is not trusted.

Solves $P(q, v) = p + \sum_j \mu_j A^j(q)$, $F(q, v) = 0$ for (v, mu). A root counts only if the corrections shrank
and the scaled matrix kept the sign of its determinant; a change of sign is a fold.
"""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp

from nonholo._results import Outcome
from nonholo._types import Array
from nonholo.lagrange_dalembert._equations import Scaled, forms, kinetic_matrix, newton_matrix
from nonholo.lagrange_dalembert._system import LagrangeDAlembert

_ITERATIONS = 12
_TOLERANCE = 1e-10  # of the last correction, which is still applied: what is left is its square
_CONTRACTION = 0.5
_SMALLEST = 2.0**-20  # of the path; below it the continuation is given up
_SINGULAR = 6e-8  # a few square roots of the rounding unit: no nearer to a fold can a computed root come
_NEAR_FOLD = 0.05  # of the regularity at the start of the path, where a continuation that stops has met a fold


class Root(NamedTuple):
    """A velocity, the impulse of constraint, and how far both can be trusted."""

    velocity: Array
    multipliers: Array
    converged: Array
    sign: Array  # of the determinant of the scaled matrix
    regularity: Array  # reciprocal Frobenius norm of its inverse


Matrix = Callable[[Array], tuple[Array, Scaled, tuple[Array, Array]]]
"""Maps a velocity to the scaled matrix of the equations, its units, and the values (P, F)."""

Correction = Callable[[Array, Array, Array], tuple[Array, Array, Array, Array, Array]]


def orientation(system: LagrangeDAlembert, q: Array, v: Array, h: Array) -> tuple[Array, Array]:
    """Return the sign of the determinant of the scaled regularity matrix and its least singular value."""
    matrix, _, _ = newton_matrix(system, q, v, h, kinetic_matrix(system, q, v))
    return jnp.sign(jnp.linalg.det(matrix)), jnp.linalg.svd(matrix, compute_uv=False)[-1]


def solve(
    system: LagrangeDAlembert, h: Array, q: Array, p: Array, near: Array, guess: Array, sign: Array
) -> tuple[Array, Array, Array]:
    """Return velocity, multipliers and outcome of the root with this orientation next to `near`."""
    kinetic = kinetic_matrix(system, q, near)
    return root(lambda v: newton_matrix(system, q, v, h, kinetic), forms(system, q), p, near, guess, sign)


def root(matrix: Matrix, rows: Array, p: Array, near: Array, guess: Array, sign: Array) -> tuple[Array, Array, Array]:
    """Solve P = p + multipliers @ rows, F = 0; return velocity, multipliers and outcome."""
    correction, offset = _correction(matrix, rows, p, near)
    none = jnp.zeros((rows.shape[0],))
    fast = _newton(correction, guess, none, jnp.zeros_like(offset))
    trusted = fast.converged & (fast.sign == sign)

    def kept() -> tuple[Array, Array, Array]:
        return fast.velocity, fast.multipliers, jnp.where(fast.regularity < _SINGULAR, int(Outcome.no_real_branch), 0)

    def followed() -> tuple[Array, Array, Array]:
        return _continue(correction, offset, near, none, sign, fast.converged)

    return jax.lax.cond(trusted, kept, followed)


def _correction(matrix_at: Matrix, rows: Array, p: Array, near: Array) -> tuple[Correction, Array]:
    """Return the Newton correction of the equations less an offset, and the residual at the velocity `near`."""
    s, n = rows.shape

    def residual(P: Array, F: Array, multipliers: Array) -> Array:
        return jnp.concatenate([P - p - multipliers @ rows, F])

    def correct(v: Array, multipliers: Array, offset: Array) -> tuple[Array, Array, Array, Array, Array]:
        matrix, units, (P, F) = matrix_at(v)
        missed = residual(P, F, multipliers) - offset
        scaled = jnp.concatenate([missed[:n] * units.velocity, missed[n:] / units.constraints])
        factors, pivots = jax.scipy.linalg.lu_factor(matrix)
        inverse = jax.scipy.linalg.lu_solve((factors, pivots), jnp.eye(len(scaled)))
        step = -(inverse @ scaled)
        swaps = jnp.sum(pivots != jnp.arange(len(scaled)))
        sign = jnp.prod(jnp.sign(jnp.diag(factors))) * (1 - 2 * (swaps % 2))
        size = jnp.linalg.norm(step[:n])
        scale = jnp.linalg.norm(v / units.velocity) + jnp.linalg.norm(p * units.velocity)
        relative = jnp.where(size == 0, 0.0, size / scale)
        regularity = 1 / jnp.linalg.norm(inverse)
        return step[:n] * units.velocity, step[n:] / units.forms, relative, sign, regularity

    _, _, (P, F) = matrix_at(near)
    return correct, residual(P, F, jnp.zeros(s))


def _newton(correction: Correction, v: Array, multipliers: Array, offset: Array) -> Root:
    def body(carry: tuple[Array, Array, Root]) -> tuple[Array, Array, Root]:
        i, before, root = carry
        dv, dm, size, sign, regularity = correction(root.velocity, root.multipliers, offset)
        done = size <= _TOLERANCE
        going = (i == 0) | (size <= _CONTRACTION * before)
        after = Root(root.velocity + dv, root.multipliers + dm, done, sign, regularity)
        return jnp.where(going | done, i + 1, _ITERATIONS), size, after

    zero = jnp.zeros(())
    start = (jnp.asarray(0), zero, Root(v, multipliers, jnp.asarray(False), zero, zero))
    return jax.lax.while_loop(lambda c: (c[0] < _ITERATIONS) & ~c[2].converged, body, start)[2]


def _continue(
    correction: Correction, offset: Array, v: Array, multipliers: Array, sign: Array, elsewhere: Array
) -> tuple[Array, Array, Array]:
    r"""Follow $R(x) = (1 - s) R(x_0)$ from s = 0 to 1, and say what ended the path if it does not arrive."""

    def body(carry: tuple[Array, Array, Root]) -> tuple[Array, Array, Root]:
        s, stride, root = carry
        ahead = jnp.minimum(s + stride, 1.0)
        found = _newton(correction, root.velocity, root.multipliers, (1 - ahead) * offset)
        good = found.converged & (found.sign == sign)
        kept = jax.tree.map(lambda new, old: jnp.where(good, new, old), found, root)
        return jnp.where(good, ahead, s), jnp.where(good, 2 * stride, stride / 2), kept

    first = correction(v, multipliers, offset)
    start = Root(v, multipliers, jnp.asarray(True), first[3], first[4])
    s, _, end = jax.lax.while_loop(
        lambda c: (c[0] < 1) & (c[1] > _SMALLEST), body, (jnp.zeros(()), jnp.asarray(0.25), start)
    )
    finite = jnp.all(jnp.isfinite(offset)) & jnp.isfinite(first[4])
    folded = (end.regularity < _NEAR_FOLD * first[4]) | (end.regularity < _SINGULAR)
    code = jnp.where(elsewhere, int(Outcome.branch_unverified), int(Outcome.not_converged))
    code = jnp.where(folded, int(Outcome.no_real_branch), code)
    code = jnp.where((s == 1) & ~(end.regularity < _SINGULAR), int(Outcome.successful), code)
    return end.velocity, end.multipliers, jnp.where(finite, code, int(Outcome.nonfinite))
