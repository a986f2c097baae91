"""States of rest and steady motions near a guess, by Newton's method on the linear equations."""

import dataclasses
from typing import Any

import numpy as np

from nonholo.analysis.linearization._linearize import Linearization, linearize, local_motion
from nonholo.analysis.linearization._reduction import reduced
from nonholo.base.checks import error
from nonholo.base.types import Float, Inexact
from nonholo.discrete import Discretization

_MOST = 50  # corrections
_CLOSE = 1e-13  # of a state, for the last one
_RANK = 1e-10  # of the largest singular value
_STABLE = 1e-7  # of the largest eigenvalue: rounding moves double ones by its root


@dataclasses.dataclass(frozen=True, eq=False)
class SteadyMotion:
    """A state of rest, or a motion whose velocity stays, and what happens beside it.

    Attributes:
        configuration: Where it is, or passes.
        body_velocity: Its velocity; of a map that of its steps.
        linearization: The linear equations beside it.
    """

    configuration: Float[np.ndarray, "..."]
    body_velocity: Float[np.ndarray, "n"]
    linearization: Linearization

    @property
    def rates(self) -> Inexact[np.ndarray, "d"] | None:
        """Eigenvalues of the flow; None of a map."""
        return self.linearization.eigenvalues if self.linearization.time_step is None else None

    @property
    def multipliers(self) -> Inexact[np.ndarray, "d"] | None:
        """Eigenvalues of a step of a map; None of a flow."""
        return None if self.linearization.time_step is None else self.linearization.eigenvalues

    @property
    def is_stable(self) -> bool:
        """Whether no eigenvalue grows: no small disturbance does so exponentially."""
        values = self.linearization.eigenvalues
        growth = np.real(values) if self.multipliers is None else np.abs(values) - 1
        return bool(np.all(growth <= _STABLE * np.abs(values).max(initial=0.0)))


def steady_motion(system: Any, configuration: Any, body_velocity: Any) -> SteadyMotion:
    """Return the steady motion near a state: each correction is the shortest one of the states that matter."""
    where, state = "equilibria(configuration=...)", (configuration, body_velocity)
    sought = system.system if isinstance(system, Discretization) else system  # the map rests where the flow does
    for _ in range(_MOST):
        local, shifted = local_motion("equilibria", sought, *state)
        if not np.isfinite(local.slope[0]).all():
            got = f"none at {local.state.tolist()}"
            raise error(where, "have a finite linearization", got, "Guess closer to an equilibrium.")
        found = reduced(local)
        change = found.directions @ np.linalg.pinv(found.matrix, rcond=_RANK) @ local.change[0][found.states]
        state = shifted(-change[: local.places], -change[local.places :])
        if np.abs(change).max(initial=0.0) <= _CLOSE * (1 + np.abs(local.state).max()):
            if not found.is_steady:
                break
            return SteadyMotion(*state, linearize(system, configuration=state[0], body_velocity=state[1]))
    got = f"none, after corrections that lead to {np.asarray(state[0]).tolist()}"
    raise error(where, "be near a steady motion", got, "Guess closer to one.")
