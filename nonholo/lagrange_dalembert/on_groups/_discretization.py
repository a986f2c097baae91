"""The discrete map on a group: a system with a time step, and its run."""

import dataclasses
from collections.abc import Iterator
from typing import Any

import numpy as np

from nonholo.base.types import Float
from nonholo.lagrange_dalembert._motion import CoordinateMotion
from nonholo.lagrange_dalembert._orbit import GroupOrbit
from nonholo.lagrange_dalembert._start import fixed_time_step
from nonholo.lagrange_dalembert.on_groups import _start as start
from nonholo.lagrange_dalembert.on_groups._system import GroupLagrangeDAlembert
from nonholo.lagrange_dalembert.runs import (
    CoordinateRun,
    Start,
    after_parts,
    checked_block,
    checked_counts,
    first_state,
    iterated,
    simulated,
)
from nonholo.systems import AbstractCoordinateDiscretization, one_start


@dataclasses.dataclass(frozen=True, eq=False)
class GroupDiscretization(CoordinateMotion, AbstractCoordinateDiscretization):
    """A discretized `GroupLagrangeDAlembert`, made by its `discretize`.

    Attributes:
        system: What moves.
        time_step: h.

    Example:
        >>> from nonholo.lagrange_dalembert import GroupLagrangeDAlembert, mass_tensor_lagrangian
        >>> free = GroupLagrangeDAlembert(nh.SO(3), mass_tensor_lagrangian(nh.SO(3), np.eye(3)), None)
        >>> free.discretize(0.5).time_step
        0.5
    """

    system: GroupLagrangeDAlembert
    time_step: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "time_step", fixed_time_step(self.time_step))

    def simulate(
        self,
        *,
        configuration: Any = None,
        steps: int,
        body_velocity: Any = None,
        displacement: Any = None,
        momentum: Any = None,
        save_every: int = 1,
        throw: bool = True,
        progress: bool = False,
    ) -> GroupOrbit:
        r"""Run the discrete map.

        $$ P(W_{k+1}) - \mathrm{Ad}^*_{W_k}P(W_k) = \sum_j\lambda_j a^j(g_{k+1}), \qquad F(g_{k+1}, W_{k+1}) = 0,
           \qquad g_{k+1} = g_k W_k . $$

        The map may be multivalued. Each step takes the root next to the last one, extrapolated; it is trusted if
        Newton's corrections shrink and no determinant changes its sign, and otherwise followed from the last step by
        continuation. Where the matrix of the equations is singular to rounding the run ends (`no_real_branch`).

        A velocity $\omega_0$ sets out with $P(W_0) = \partial l/\partial\omega + \sum_j\mu_j a^j(g_0)$ (second order),
        a momentum with itself in place of $\partial l/\partial\omega$.

        Args:
            configuration: $g_0$, a matrix of the group; the identity by default.
            steps: Number of steps N; unthinned orbits have N + 1 states.
            body_velocity: Start with this velocity, which must satisfy the constraint.
            displacement: Start with $W_0$, which must satisfy the discrete constraint.
            momentum: Start with this body momentum; only its action on admissible velocities counts.
            save_every: Steps between saved states.
            throw: Raise if the run cannot continue; otherwise return the good steps and the outcome.
            progress: Show a progress bar on standard error.

        Raises:
            ValueError: A bad argument, before any work.
            OutcomeError: With `throw`, the run could not continue; the error's `orbit` holds every good step.

        Example:
            >>> from nonholo.lagrange_dalembert import GroupLagrangeDAlembert, mass_tensor_lagrangian
            >>> free = GroupLagrangeDAlembert(nh.SO(3), mass_tensor_lagrangian(nh.SO(3), np.eye(3)), None)
            >>> orbit = free.discretize(0.5).simulate(momentum=(0.0, 0.0, 2.0), steps=4)  # 4 sin(angle)/2 = 2 * 0.5
            >>> print(orbit.body_velocity[-1].round(9) / np.pi * 6)
            [0. 0. 2.]
        """
        system, h = self.system, np.float64(self.time_step)
        steps, every = checked_counts(steps, save_every, 2 * (system.group.identity.size + system.group.dim))
        starts = {"body_velocity": body_velocity, "displacement": displacement, "momentum": momentum}
        first = self.start(configuration, **starts)
        return simulated(GroupOrbit, system, h, first, steps, every, throw, progress)

    def iterate(
        self,
        *,
        configuration: Any = None,
        steps: int,
        block_steps: int | None = None,
        body_velocity: Any = None,
        displacement: Any = None,
        momentum: Any = None,
        save_every: int = 1,
        throw: bool = True,
        progress: bool = False,
    ) -> Iterator[GroupOrbit]:
        """Run the map of `simulate`, and give its orbit block by block, in bounded memory.

        The blocks together are the orbit of `simulate`, bit for bit; see `CoordinateDiscretization.iterate`.
        """
        starts = {"body_velocity": body_velocity, "displacement": displacement, "momentum": momentum}
        system, h = self.system, np.float64(self.time_step)
        steps, every = checked_counts(steps, save_every, 0)
        rows = self.rows_of_block(block_steps, every)
        first = self.start(configuration, **starts)
        return iterated(GroupOrbit, system, h, first, steps, every, rows, throw, progress)

    def start(self, configuration: Any, **starts: Any) -> Start:
        """Return the checked state at the start of a run, the orientation to keep and the outcome so far."""
        return _first(self.system, np.float64(self.time_step), configuration, starts)

    def run(self, every: int) -> CoordinateRun:
        """Return what computes blocks of a run that keeps one in `every` states."""
        return CoordinateRun(self, every)

    def rows_of_block(self, block_steps: Any, save_every: int) -> int:
        """Return the saved states of a block of `iterate`, refused where memory cannot hold them."""
        return checked_block(block_steps, save_every, 2 * (self.system.group.identity.size + self.system.group.dim))

    def after_parts(self, states: GroupOrbit, fractions: Float[np.ndarray, "K"]) -> GroupOrbit:
        r"""Return what is reached from states after parts of the steps that begin there.

        After a fraction s that is the step of length s h from the same configuration and momentum: the definition of
        the map itself, with another time step.

        Args:
            states: States of an orbit of this map.
            fractions: Numbers in (0, 1), one for each.
        """
        return after_parts(GroupOrbit, self, states, fractions)


def _first(system: GroupLagrangeDAlembert, h: Any, configuration: Any, starts: dict[str, Any]) -> Start:
    given = one_start("simulate", **starts)
    value, g = starts[given], start.pose("simulate", system, configuration)
    start.consistent(system, g, h)
    if given == "displacement":
        v, p = start.of_displacement(system, g, value, h)
    elif given == "momentum":
        v, p = start.of_momentum("simulate", system, g, value)
    else:
        v, p = start.of_velocity("simulate", system, g, value)
    return first_state(system, h, g, v, p)
