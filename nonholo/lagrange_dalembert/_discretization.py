"""The discrete map in coordinates: a system with a time step, and its run."""

import dataclasses
from typing import Any

import numpy as np

from nonholo.lagrange_dalembert import _start
from nonholo.lagrange_dalembert._equations import momenta, momentum
from nonholo.lagrange_dalembert._orbit import CoordinateOrbit
from nonholo.lagrange_dalembert._precision import in_double
from nonholo.lagrange_dalembert._system import LagrangeDAlembert
from nonholo.lagrange_dalembert.runs import AbstractLagrangeDAlembertMap, Start, first_state
from nonholo.systems import one_start


@dataclasses.dataclass(frozen=True, eq=False)
class CoordinateDiscretization(AbstractLagrangeDAlembertMap[CoordinateOrbit]):
    """A discretized system in coordinates, made by `nonholo.discretize`.

    Attributes:
        system: What moves.
        time_step: h.

    Example:
        >>> from nonholo.lagrange_dalembert import CoordinateDiscretization, LagrangeDAlembert
        >>> CoordinateDiscretization(LagrangeDAlembert(lambda q, v: v @ v, None, dimension=2), 0.5).time_step
        0.5
    """

    system: LagrangeDAlembert
    time_step: float

    def simulate(
        self,
        *,
        configuration: Any,
        steps: int,
        body_velocity: Any = None,
        displacement: Any = None,
        momentum: Any = None,
        save_every: int = 1,
        throw: bool = True,
        progress: bool = False,
    ) -> CoordinateOrbit:
        r"""Run the discrete Lagrange-d'Alembert map.

        $$ D_1 L_d(q_k, q_{k+1}) + D_2 L_d(q_{k-1}, q_k) = -\sum_j \lambda_j A^j(q_k), \qquad F(q_k, q_{k+1}) = 0. $$

        The map may be multivalued. Each step takes the root next to the last one, extrapolated; it is trusted if
        Newton's corrections shrink and no determinant changes its sign, and otherwise followed from the last step by
        continuation. Where the matrix of the equations is singular to rounding the run ends (`no_real_branch`).

        A velocity $v_0$ sets out with $-D_1 L_d(q_0, q_1) = \partial L/\partial v + \sum_j \mu_j A^j(q_0)$ (second
        order), a momentum with itself in place of $\partial L/\partial v$.

        Args:
            configuration: $q_0$.
            steps: Number of steps N; unthinned orbits have N + 1 states.
            body_velocity: Start with this velocity, which must satisfy the constraint.
            displacement: Start with $q_1 - q_0$, which must satisfy the discrete constraint.
            momentum: Start with this momentum; only its action on admissible velocities counts.
            save_every: Steps between saved states.
            throw: Raise if the run cannot continue; otherwise return the good steps and the outcome.
            progress: Show a progress bar on standard error.

        Raises:
            ValueError: A bad argument, before any work.
            OutcomeError: With `throw`, the run could not continue; the error's `orbit` holds every good step.

        Example:
            >>> from nonholo.lagrange_dalembert import LagrangeDAlembert
            >>> free = LagrangeDAlembert(lambda q, v: v @ v / 2, None, dimension=2).discretize(0.5)
            >>> free.simulate(configuration=(0, 0), body_velocity=(1, 2), steps=2).configuration
            array([[0. , 0. ],
                   [0.5, 1. ],
                   [1. , 2. ]])
        """
        starts = {"body_velocity": body_velocity, "displacement": displacement, "momentum": momentum}
        return self._simulated(steps, save_every, throw, progress, configuration, **starts)

    def regularity(self, q: Any, q_next: Any) -> float:
        """Return the smallest singular value of the scaled regularity matrix of a step; zero at a fold.

        Args:
            q: Configuration.
            q_next: The next configuration.

        Raises:
            ValueError: A wrong shape, or a value that is not finite.

        Example:
            >>> from nonholo.lagrange_dalembert import LagrangeDAlembert
            >>> free = LagrangeDAlembert(lambda q, v: 3 * v @ v, None, dimension=2)
            >>> round(free.discretize(0.5).regularity((0, 0), (1, 2)), 12)
            1.0
        """
        return self.system.regularity(q, q_next, time_step=self.time_step)

    def start(self, configuration: Any, **starts: Any) -> Start:
        """Return the checked state at the start of a run, the orientation to keep and the outcome so far."""
        system, h = self.system, np.float64(self.time_step)
        q = _start.point("simulate", system, configuration)
        _start.consistent(system, q, h)
        given = one_start("simulate", **starts)
        if given == "displacement":
            v = _start.velocity_of_displacement(system, q, starts["displacement"], h)
            return first_state(system, h, q, v, in_double(momenta, system, q, v, h)[0])
        if given == "momentum":
            p, v = _start.velocity_of_momentum("simulate", system, q, starts["momentum"])
            return first_state(system, h, q, v, p)
        v = _start.velocity("simulate", system, q, starts["body_velocity"])
        return first_state(system, h, q, v, in_double(momentum, system, q, v))
