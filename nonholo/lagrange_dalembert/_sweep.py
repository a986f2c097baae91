"""A continuous motion of this room: its solve, and the orbit of it. Imported on first use: diffrax loads slowly."""

import functools
from collections.abc import Callable
from typing import Any, NamedTuple, TypeVar

import jax
import numpy as np

from nonholo.base.numerics.time_sweep import padded, reached, sweep
from nonholo.base.results import Outcome, OutcomeError
from nonholo.base.types import Array
from nonholo.lagrange_dalembert._precision import in_double

OrbitT = TypeVar("OrbitT")
State = tuple[Array, Array]
"""Configuration and velocity."""


class Motion(NamedTuple):
    """Functions of a system for a solver, each of the system and configuration and velocity.

    Attributes:
        rate: The rate of change of a state.
        projected: The state on the constraint next to a state.
        decode: Momenta, forces of constraint, energies and residuals of many states, compiled.
    """

    rate: Callable[[Any, State], State]
    projected: Callable[[Any, State], State]
    decode: Callable[[Any, Array, Array], tuple[Array, ...]]


def flowed(
    kind: Callable[..., OrbitT],
    motion: Motion,
    system: Any,
    first: State,
    time: np.ndarray,
    errors: tuple[float, float],
) -> OrbitT:
    """Return the orbit of a kind from a checked state; raise with every good state if the solver gives up."""
    rest, good = in_double(_sweep, motion, system, first, padded(time), errors)
    rows = reached(first, rest, good, len(time))
    count = len(rows[0])
    columns = (x[:count] for x in in_double(motion.decode, system, *map(padded, rows)))
    outcome = Outcome.successful if count == len(time) else Outcome.not_converged
    orbit = kind(time[:count], rows[0], None, rows[1], *columns, outcome)
    if outcome != Outcome.successful:
        rtol, atol = errors
        where = f"Flow from time {time[count - 1]:g} to {time[count]:g} (rtol {rtol:g}, atol {atol:g})"
        raise OutcomeError(outcome, where, orbit)
    return orbit


@functools.partial(jax.jit, static_argnums=(0, 1))
def _sweep(motion: Motion, system: Any, state: State, times: Array, errors: tuple[Array, Array]) -> tuple[State, Array]:
    def settled(current: State) -> State:
        return motion.projected(system, current)

    return sweep(lambda _, current: motion.rate(system, settled(current)), settled, state, times, errors)
