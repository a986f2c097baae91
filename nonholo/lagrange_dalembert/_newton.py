r"""The next velocity: Newton's method from an extrapolated guess, then continuation where that is not trusted.

Solves $P(q, v) = p + \sum_j \mu_j A^j(q)$, $F(q, v) = 0$ for (v, mu). A root counts only if the corrections shrank
and the scaled matrix kept the sign of its determinant; a change of sign is a fold.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from nonholo.base.results import Outcome
from nonholo.base.types import Array
from nonholo.kernels import CONTRACTION, ITERATIONS, SINGULAR, TOLERANCE
from nonholo.lagrange_dalembert import _equations as equations
from nonholo.lagrange_dalembert._equations import Scaled, bordered_matrix

_ROUNDING = 1e-15  # of a place
_SMALLEST = 2.0**-20  # of the path; below it the continuation is given up
_NEAR_FOLD = 0.05  # of the regularity at the start of the path, where a continuation that stops has met a fold


class Root(NamedTuple):
    """A velocity, the impulse of constraint, and the trust in both."""

    velocity: Array
    multipliers: Array
    converged: Array
    sign: Array  # of the determinant of the scaled matrix
    regularity: Array  # reciprocal Frobenius norm of its inverse


class _Path(NamedTuple):
    """The progress along the path of a root.

    Attributes:
        count: Number of attempts.
        s: The part of the residual at the start that has been taken away.
        stride: Step of s that is tried next.
        root: The root at s.
        regularity: That at the start.
        elsewhere: Whether the guess led to a root, though not to one that counts.
    """

    count: Array
    s: Array
    stride: Array
    root: Root
    regularity: Array
    elsewhere: Array


def orientation(system: Any, q: Array, v: Array, h: Array) -> tuple[Array, Array]:
    """Return the sign of the determinant of the scaled regularity matrix and its least singular value."""
    matrix, _, _ = newton_matrix(system, q, v, h, equations.mass_matrix(system, q, v))
    return jnp.sign(jnp.linalg.det(matrix)), jnp.linalg.svd(matrix, compute_uv=False)[-1]


def solve(system: Any, h: Array, q: Array, p: Array, near: Array, guess: Array, sign: Array) -> tuple[Array, ...]:
    """Return velocity, multipliers and outcome of the root with this orientation next to `near`.

    Where forces balance at rest velocities are rounding errors, and so are corrections: they are compared with what the
    rounding of a place does to the momentum, too.
    """
    unknown, tangent = of_step(system, q, p, near, h), q.at[-1].set(0.0) if system.is_driven else q
    _, slope = jax.jvp(lambda x: equations.momenta(system, x, near, h)[0], (q,), (tangent,))
    masses = jnp.abs(jnp.diag(equations.mass_matrix(system, q, near)))
    rounding = _ROUNDING / TOLERANCE * jnp.abs(slope) / jnp.where(masses == 0, 1.0, masses)
    rounding = rounding if unknown.rounding is None else rounding + unknown.rounding
    return root(unknown._replace(rounding=rounding), near, guess, sign)


class Equations(NamedTuple):
    r"""The equations $P(v) = p + \sum_j \mu_j A^j$, F(v) = 0.

    Attributes:
        matrix: Maps a velocity to their scaled matrix, its units, and the values (P, F).
        rows: A.
        p: The momentum.
        rounding: By what the rounding of a place moves the velocity of a step to a holonomic constraint, over
            `TOLERANCE`: Newton's corrections of short steps, and of short parts of steps, do not become smaller.
    """

    matrix: Callable[[Array], tuple[Array, Scaled, tuple[Array, Array]]]
    rows: Array
    p: Array
    rounding: Array | None = None

    def in_units(self, v: Array, multipliers: Array, offset: Array) -> tuple[Array, Array, Scaled, Array]:
        """Return the scaled matrix, what the scaled equations less an offset lack, units and the size of velocities."""
        n, (matrix, units, values) = len(self.p), self.matrix(v)
        residual = equations.balance(values, self.p, multipliers, self.rows) - offset
        scaled_residual = jnp.concatenate([residual[:n] * units.velocity, residual[n:] / units.constraints])
        size = jnp.linalg.norm(v / units.velocity) + jnp.linalg.norm(self.p * units.velocity)
        if self.rounding is not None:
            size = size + jnp.linalg.norm(self.rounding / units.velocity)
        return matrix, scaled_residual, units, size

    def correction(self, v: Array, multipliers: Array, offset: Array) -> tuple[Array, Array, Array, Array, Array]:
        """Return Newton's correction of both, its relative size, the orientation and the regularity."""
        n, (matrix, scaled_residual, units, scale) = len(self.p), self.in_units(v, multipliers, offset)
        factors, pivots = jax.scipy.linalg.lu_factor(matrix)
        inverse = jax.scipy.linalg.lu_solve((factors, pivots), jnp.eye(len(scaled_residual)))
        step = -(inverse @ scaled_residual)
        swaps = jnp.sum(pivots != jnp.arange(len(scaled_residual)))
        sign = jnp.prod(jnp.sign(jnp.diag(factors))) * (1 - 2 * (swaps % 2))
        size = jnp.linalg.norm(step[:n])
        relative = jnp.where(size == 0, 0.0, size / scale)
        return step[:n] * units.velocity, step[n:] / units.forms, relative, sign, 1 / jnp.linalg.norm(inverse)


def of_step(system: Any, q: Array, p: Array, near: Array, h: Array) -> Equations:
    """Return the equations of a step from q with a momentum, in the units of the velocity `near`."""
    kinetic = equations.mass_matrix(system, q, near)
    rounding = None if system.holonomic is None else _ROUNDING / TOLERANCE * jnp.abs(q[: system.dimension]) / h
    return Equations(lambda v: newton_matrix(system, q, v, h, kinetic), equations.forms(system, q), p, rounding)


def newton_matrix(system: Any, q: Array, v: Array, h: Array, kinetic: Array) -> tuple[Array, Scaled, tuple[Array, ...]]:
    """Return the scaled regularity matrix of a step, its units, and P and F at the step."""

    def values(w: Array) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        both = equations.momenta(system, q, w, h)[0], equations.discrete_constraints(system, q, w, h)
        return both, both

    (mass, below), momentum_and_constraint = jax.jacfwd(values, has_aux=True)(v)
    matrix, units = bordered_matrix(mass, equations.forms(system, q), below, kinetic)
    return matrix, units, momentum_and_constraint


def of_node(system: Any, q: Array, p: Array, _near: Array, _h: Array) -> Equations:
    """Return the equations of the velocity that belongs to a momentum."""

    def matrix_at(v: Array) -> tuple[Array, Scaled, tuple[Array, Array]]:
        values = equations.momentum(system, q, v), equations.constraint(system, q, v)
        return *equations.acceleration_matrix(system, q, v), values

    return Equations(matrix_at, equations.forms(system, q), p)


def root(system: Equations, near: Array, guess: Array, sign: Array) -> tuple[Array, Array, Array]:
    r"""Solve equations; return velocity, multipliers and outcome.

    A loop of attempts, so that they are compiled once: from the guess; at `near`, which is the root of the
    equations less their residual there; then along $R(x) = (1 - s) R(x_0)$ from s = 0 to 1.
    """
    none = jnp.zeros(len(system.rows))
    offset = equations.balance(system.matrix(near)[2], system.p, none, system.rows)

    def attempt(path: _Path) -> _Path:
        fast, first = path.count == 0, path.count == 1
        ahead = jnp.where(first, 0.0, jnp.where(fast, 1.0, jnp.minimum(path.s + path.stride, 1.0)))
        begin = jnp.where(fast, guess, path.root.velocity)
        # The offset need not be finite, if the guess leads to a root.
        left = jnp.where(ahead == 1, 0.0, (1 - ahead) * offset)
        trial = _newton(system, begin, path.root.multipliers, left)
        good = trial.converged & (trial.sign == sign) & ~first
        best = jax.tree.map(lambda new, old: jnp.where(good, new, old), trial, path.root)
        stride = jnp.where(good, 2 * path.stride, path.stride / 2)
        return _Path(
            path.count + 1,
            jnp.where(good, ahead, path.s),
            jnp.where(fast | first, path.stride, stride),
            best._replace(regularity=jnp.where(first, trial.regularity, best.regularity)),
            jnp.where(first, trial.regularity, path.regularity),
            jnp.where(fast, trial.converged, path.elsewhere),
        )

    zero, one, no = jnp.zeros(()), jnp.ones(()), jnp.asarray(False)
    start = _Path(jnp.asarray(0), zero, 0.25 * one, Root(near, none, no, zero, one), one, no)
    path = jax.lax.while_loop(lambda path: (path.s < 1) & (path.stride > _SMALLEST), attempt, start)
    finite = (path.count == 1) | (jnp.all(jnp.isfinite(offset)) & jnp.isfinite(path.regularity))
    singular = path.root.regularity < SINGULAR
    is_folded = (path.root.regularity < _NEAR_FOLD * path.regularity) | singular
    code = jnp.where(path.elsewhere, int(Outcome.branch_unverified), int(Outcome.not_converged))
    code = jnp.where(is_folded, int(Outcome.no_real_branch), code)
    code = jnp.where((path.s == 1) & ~singular, int(Outcome.successful), code)
    return path.root.velocity, path.root.multipliers, jnp.where(finite, code, int(Outcome.nonfinite))


def _newton(system: Equations, v: Array, multipliers: Array, offset: Array) -> Root:
    def body(carry: tuple[Array, Array, Root]) -> tuple[Array, Array, Root]:
        i, before, root = carry
        dv, dm, size, sign, regularity = system.correction(root.velocity, root.multipliers, offset)
        is_small = size <= TOLERANCE
        contracts = (i == 0) | (size <= CONTRACTION * before)
        after = Root(root.velocity + dv, root.multipliers + dm, is_small, sign, regularity)
        return jnp.where(contracts | is_small, i + 1, ITERATIONS), size, after

    zero = jnp.zeros(())
    start = (jnp.asarray(0), zero, Root(v, multipliers, jnp.asarray(False), zero, zero))
    return jax.lax.while_loop(lambda c: (c[0] < ITERATIONS) & ~c[2].converged, body, start)[2]
