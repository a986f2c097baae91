"""The discrete map on a group: a system with a time step, and its run."""

import dataclasses
from typing import Any

import numpy as np

from nonholo.lagrange_dalembert._orbit import GroupOrbit
from nonholo.lagrange_dalembert.on_groups import _start
from nonholo.lagrange_dalembert.on_groups._system import GroupLagrangeDAlembert
from nonholo.lagrange_dalembert.runs import AbstractLagrangeDAlembertMap, Start, first_state
from nonholo.systems import one_start


@dataclasses.dataclass(frozen=True, eq=False)
class GroupDiscretization(AbstractLagrangeDAlembertMap[GroupOrbit]):
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
        starts = {"body_velocity": body_velocity, "displacement": displacement, "momentum": momentum}
        return self._simulated(steps, save_every, throw, progress, configuration, **starts)

    def start(self, configuration: Any, **starts: Any) -> Start:
        """Return the checked state at the start of a run, the orientation to keep and the outcome so far."""
        system, h = self.system, np.float64(self.time_step)
        given = one_start("simulate", **starts)
        value, g = starts[given], _start.pose("simulate", system, configuration)
        _start.consistent(system, g, h)
        if given == "displacement":
            v, p = _start.of_displacement(system, g, value, h)
        elif given == "momentum":
            v, p = _start.of_momentum("simulate", system, g, value)
        else:
            v, p = _start.of_velocity("simulate", system, g, value)
        return first_state(system, h, g, v, p)
