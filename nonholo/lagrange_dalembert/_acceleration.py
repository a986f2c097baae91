r"""Accelerations and forces of constraint of the continuous equations, and the work that changes the energy.

Along a motion $\dot E = f\cdot v + \lambda\cdot b - \partial L/\partial t$: the power of the force, that of moving
constraints $A v = b$ (of driven joints what their motors give), and what a Lagrangian of the time adds.
"""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import error
from nonholo.base.types import Array, Float
from nonholo.lagrange_dalembert import _equations
from nonholo.lagrange_dalembert._equations import solve_bordered
from nonholo.lagrange_dalembert._room import equations_of, in_double, places

_ROWS = 1024  # states whose powers are computed at once: one size, one compilation


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


def work(orbit: Any) -> Float[np.ndarray, "K"]:
    """Return the work on a driven system along an orbit since its first state, by the trapezoidal rule."""
    system, time, h = orbit.system, orbit.time, np.diff(orbit.time)
    x, p = places(system, orbit.configuration, time), orbit.momentum
    if system.table is not None:
        if orbit.lacks_forces:
            got = f"steps {orbit.step[:3].tolist()} ... with a force for each step"
            raise error("Orbit.work", "know every step", got, "Run with save_every=1.")
        rows = system.table.acting(orbit.step)
        before, after = _powers(system, x, p, rows), _powers(system, x, p, np.roll(rows, 1, axis=0))
    else:
        before = after = _powers(system, x, p, np.zeros_like(p))
    return np.concatenate([np.zeros(min(1, len(time))), np.cumsum(h * (before[:-1] + after[1:]) / 2)])


def _powers(system: Any, *columns: Float[np.ndarray, "K n"]) -> Float[np.ndarray, "K"]:
    """Return the power on each state: of places, momenta and rows of a table."""
    missing = -len(columns[0]) % _ROWS
    padded = [np.concatenate([rows, np.repeat(rows[-1:], missing, axis=0)]) for rows in columns]
    blocks = zip(*(rows.reshape(-1, _ROWS, rows.shape[1]) for rows in padded), strict=True)
    return np.concatenate([np.empty(0), *(in_double(_power, system, *block) for block in blocks)])[: len(columns[0])]


def _power(system: Any, x: Array, p: Array, row: Array) -> Array:
    def one(x: Array, p: Array, row: Array) -> Array:
        v = _equations.inverse_legendre(system, x, p)
        force = row + _equations.applied(system, x, v)
        moved = _equations.forms(system, x) @ v - _equations.constraint(system, x, v)
        changed = jax.grad(_equations.lagrangian, argnums=1)(system, x, v)[-1]
        return force @ v + acceleration(system, x, v, row)[1] @ moved - changed

    return jax.vmap(one)(x, p, jnp.asarray(row))
