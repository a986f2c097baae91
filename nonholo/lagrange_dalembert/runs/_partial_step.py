r"""States within a step of the discrete map: after a fraction s of it, by the step of length s h from the same state.

With momentum p at the place q the velocity w of the part solves $P_{sh}(q, w) = p + \sum_j\mu_j A^j(q)$, $F_{sh} = 0$,
next to the velocity v of the whole step. The whole step from its end begins with the momentum $P^+_{sh}(q, w)$.
"""

import dataclasses
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.results import Outcome
from nonholo.base.types import Array, Float
from nonholo.lagrange_dalembert._precision import in_double
from nonholo.lagrange_dalembert._room import equations_of, places
from nonholo.lagrange_dalembert.runs._simulate import orbit_of, set_out

_ROWS = 32  # states of one call, one after another: the bits of each do not depend on the others


def after_parts(discrete: Any, states: Any, fractions: Float[np.ndarray, "K"]) -> Any:
    """Return what is reached from states of an orbit; NaN where there is no such step, or none from there."""
    system, h, count = discrete.system, np.float64(discrete.time_step), len(states)
    x, v = places(system, states.configuration, states.time), states.body_velocity
    given = [_padded(rows) for rows in (fractions, x, v, states.momentum)]
    parts = [
        in_double(_moved, system, h, np.int64(min(_ROWS, count - i)), *(rows[i : i + _ROWS] for rows in given))
        for i in range(0, count, _ROWS)
    ]
    ends, ahead = (np.concatenate(column)[:count] for column in zip(*parts, strict=True)) if parts else (x, v)
    impulses = np.empty((0, system.constraints))
    reached = orbit_of(system, h, [ends, ahead, impulses], 0, 1, Outcome.successful)
    step = states.step + fractions.astype(np.int64)
    return dataclasses.replace(reached, time=states.time + fractions * h, step=step)


def _padded(rows: np.ndarray) -> np.ndarray:
    """Return rows up to a multiple of those of one call, the others zero."""
    return np.concatenate([rows, np.zeros((-len(rows) % _ROWS, *rows.shape[1:]))])


def _moved(system: Any, h: Array, count: Array, fractions: Array, x: Array, v: Array, p: Array) -> tuple[Array, Array]:
    """Return the places after parts of steps, and the velocities of the whole steps that begin there."""
    equations = equations_of(system)

    def leg(carry: tuple[Array, Array, Array], length: Array) -> tuple[tuple[Array, Array, Array], tuple]:
        begin, near, p = carry
        (_, w, _), _, code = set_out(system, length, begin, near, p)
        after = equations.ahead(system, begin, w, length), w, equations.momenta(system, begin, w, length)[1]
        return after, (begin, w, code)

    def one(carry: tuple[Array, Array, Array]) -> tuple[Array, Array, Array]:
        i, places, velocities = carry
        _, (begins, w, codes) = jax.lax.scan(leg, (x[i], v[i], p[i]), jnp.stack([fractions[i] * h, h]))
        end = jnp.where(codes[0] == 0, begins[1], jnp.nan)
        return i + 1, places.at[i].set(end), velocities.at[i].set(jnp.where(jnp.all(codes == 0), w[1], jnp.nan))

    return jax.lax.while_loop(lambda c: c[0] < count, one, (jnp.asarray(0), x, v))[1:]
