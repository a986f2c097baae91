"""Accelerations and forces of constraint of the continuous equations, and the vector field."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import error, is_traced, number, trailing
from nonholo.base.types import Array, Float
from nonholo.lagrange_dalembert._equations import solve_bordered
from nonholo.lagrange_dalembert._room import equations_of, in_double

_PROJECTIONS, _NEAR = 50, 1e-14  # corrections of a place, at most, and what the last one may be beside it
_REMEDY = "Pass the configuration, row by row, then the velocity."


def acceleration(system: Any, q: Array, v: Array, extra: Any = 0.0) -> tuple[Array, Array]:
    r"""Return the rate of v and the forces $\lambda$, from the equations and $\tfrac{d}{dt}(A v - b) = 0$.

    Args:
        system: What moves.
        q: Where it is.
        v: Its velocity.
        extra: A force beside those of the system: of a table the row that acts.
    """
    equations = equations_of(system)
    _, turned = jax.jvp(lambda x: equations.constraint(system, x, v), (q,), (equations.rate(system, q, v),))
    return bordered_solution(system, q, v, equations.force(system, q, v) + extra, -turned)


def bordered_solution(system: Any, q: Array, v: Array, force: Array, off: Array) -> tuple[Array, Array]:
    r"""Solve $M x - A^T\lambda$ = force, A x = off."""
    matrix, units = equations_of(system).acceleration_matrix(system, q, v)
    return solve_bordered(matrix, units, force, off)


def admissible_velocity(system: Any, q: Array, v: Array) -> Array:
    """Return the admissible velocity next to one in the kinetic energy."""
    return v - bordered_solution(system, q, v, jnp.zeros_like(v), equations_of(system).constraint(system, q, v))[0]


def nearest_place(system: Any, x: Array) -> Array:
    r"""Return the admissible place y next to x in the kinetic energy at x; NaN where none is reached.

    $M(y - x) = D\Phi(y)^T\lambda$, $\Phi(y) = 0$, by Newton's method from x.
    """
    equations, n, first = equations_of(system), system.dimension, system.velocity_constraints
    M = equations.kinetic_matrix(system, x, jnp.zeros(n))

    def missed(z: Array) -> Array:
        y = x.at[:n].add(z[:n])
        across = z[n:] @ equations.forms(system, y)[first:]
        return jnp.concatenate([M @ z[:n] - across, equations.place_residual(system, y)])

    def correct(carry: tuple[Array, Array, Array]) -> tuple[Array, Array, Array]:
        count, z, _ = carry
        step = jnp.linalg.solve(jax.jacfwd(missed)(z), -missed(z))
        after = z + step
        return count + 1, after, jnp.linalg.norm(step[:n]) / (jnp.linalg.norm(x) + jnp.linalg.norm(after[:n]))

    def goes_on(carry: tuple[Array, Array, Array]) -> Array:
        return (carry[0] < _PROJECTIONS) & (carry[2] > _NEAR)

    start = jnp.asarray(0), jnp.zeros(n + system.constraints - first), jnp.asarray(jnp.inf)
    _, z, size = jax.lax.while_loop(goes_on, correct, start)
    return jnp.where(size <= _NEAR, x.at[:n].add(z[:n]), jnp.nan)


def refuse_table(owner: str, system: Any) -> None:
    """Refuse forces that belong to steps."""
    if system.is_driven and system.table is not None:
        remedy = "Discretize the system, or pass a function of time."
        raise error(f"{owner}(system=...)", "have forces at times", "one force for each step", remedy)


def vector_field(system: Any) -> Callable[[Array, Float[Array, "size"]], Float[Array, "size"]]:
    """Return the equations of motion as a function (time, state) -> derivative; `nonholo.vector_field` says of what."""
    equations_of(system)  # refused by the system of a store without functions
    refuse_table("vector_field", system)
    size = int(np.prod(system.shapes[0]) + np.prod(system.shapes[1]))

    def derivative(time: Array, state: Float[Array, "size"]) -> Float[Array, "size"]:
        now = number("vector_field(...)(time=...)", time)
        rows = trailing("vector_field(...)(state=...)", state, (size,), _REMEDY, real=True)
        if is_traced(now) or is_traced(rows):
            return _derivative(system.bound(*system.parameters.values()), now, rows)
        return in_double(_derivative, system, now, rows)

    return derivative


def _derivative(system: Any, time: Array, state: Float[Array, "... size"]) -> Float[Array, "... size"]:
    equations, (pose, _) = equations_of(system), system.shapes

    def one(row: Array) -> Array:
        q, v = jnp.split(row, [int(np.prod(pose))])
        x = jnp.append(q, time) if system.is_driven else q.reshape(pose)
        moved = jnp.ravel(equations.rate(system, x, v))[: len(q)]
        return jnp.concatenate([moved, acceleration(system, x, v)[0]])

    return one(state) if state.ndim == 1 else jax.lax.map(one, state.reshape(-1, state.shape[-1])).reshape(state.shape)
