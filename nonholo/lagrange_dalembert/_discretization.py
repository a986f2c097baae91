"""The discrete map in coordinates: a system with a time step, and its run."""

import dataclasses
from typing import Any

import numpy as np

from nonholo.lagrange_dalembert import _start
from nonholo.lagrange_dalembert._equations import momenta, momentum
from nonholo.lagrange_dalembert._map import AbstractLagrangeDAlembertMap
from nonholo.lagrange_dalembert._orbit import CoordinateOrbit
from nonholo.lagrange_dalembert._precision import in_double
from nonholo.lagrange_dalembert._system import LagrangeDAlembert
from nonholo.orbit import First
from nonholo.systems import Start


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

    def first(self, start: Start, *, posed: bool) -> First:
        """Return the checked momentum, place and velocity of a start."""
        del posed
        system, h, owner = self.system, np.float64(self.time_step), start.owner
        q = _start.point(owner, system, start.configuration)
        _start.consistent(system, q, h)
        if start.name == "momentum":
            p, v = _start.velocity_of_momentum(owner, system, q, start.value)
        elif start.name == "displacement":
            v = _start.velocity_of_displacement(system, q, start.value, h)
            p = in_double(momenta, system, q, v, h)[0]
        else:
            v = _start.velocity(owner, system, q, start.value)
            p = in_double(momentum, system, q, v)
        return First((p, q, v))
