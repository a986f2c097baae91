"""The discrete map on a group: a system with a time step, and its run."""

import dataclasses

import numpy as np

from nonholo.lagrange_dalembert._map import AbstractLagrangeDAlembertMap
from nonholo.lagrange_dalembert._orbit import GroupOrbit
from nonholo.lagrange_dalembert.on_groups import _start
from nonholo.lagrange_dalembert.on_groups._system import GroupLagrangeDAlembert
from nonholo.orbit import First
from nonholo.systems import Start


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

    def first(self, start: Start, *, posed: bool) -> First:
        """Return the checked momentum, pose and velocity of a start."""
        del posed
        system, h, owner = self.system, np.float64(self.time_step), start.owner
        g = _start.pose(owner, system, start.configuration)
        _start.consistent(system, g, h)
        if start.name == "displacement":
            v, p = _start.of_displacement(system, g, start.value, h)
        elif start.name == "momentum":
            v, p = _start.of_momentum(owner, system, g, start.value)
        else:
            v, p = _start.of_velocity(owner, system, g, start.value)
        return First((p, g, v))
