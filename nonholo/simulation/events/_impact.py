r"""Impacts: the momentum is reflected where the function of an event becomes zero, in the metric of the energy.

An ideal wall gives the body an impulse along $\nu = n|_\mathfrak{d}$, the derivative of the gap along admissible
directions. With the inertia B along the constraint the gap grows at the rate $\nu\cdot B^{-1}r$.
"""

import dataclasses
from typing import Any

import numpy as np

from nonholo.base.calls import numbers_of
from nonholo.base.checks import array, error, number, shown
from nonholo.base.types import Float
from nonholo.orbit import Orbit, turned_near
from nonholo.systems import Forced, Gravity


@dataclasses.dataclass(frozen=True, eq=False)
class Impact:
    r"""The reset of an `Event` whose function is a gap: where it becomes zero the body hits a wall without friction.

    The momentum r along the constraint, with inertia B, is reflected along $\nu = n|_\mathfrak{d}$,

    $$ r^+ = r - (1 + e)\,\frac{\nu\cdot B^{-1}r}{\nu\cdot B^{-1}\nu}\,\nu, \qquad
       \nu\cdot B^{-1}r^+ = -e\,\nu\cdot B^{-1}r. $$

    So the constraint holds after it, and with restitution $e = 1$ the kinetic energy is the same, whatever n is; in
    general it falls by $\tfrac12(1 - e^2)(\nu\cdot B^{-1}r)^2/(\nu\cdot B^{-1}\nu)$. In a discrete map the step is cut
    there: the part of it that leads to the wall, the reflection, then the part of the length that is left, in which
    there may be more impacts. `orbit.events[name].states` are the states before the impacts, `.after` those after them.

    Reference: [brogliato-1999], Newton's rule in the kinetic metric; docs/theory/parts-of-a-step.md for the map.

    Args:
        normal: n, in the direction in which the gap grows: a spatial vector, the gap being that of the body's `point`
            from a plane across it; or a function from a configuration (N, N) to the derivatives (dim,) of the gap
            along body directions. By default these are taken from the function of the event by central differences of
            order 6, whose error is about 1e-13 of what it changes by over one radian or one unit of length.
        restitution: e, from 0 to 1.
        point: The point of the body that touches, n body coordinates; by default their origin. Only with a vector.

    Raises:
        ValueError: A normal of another kind, a restitution beyond 0 and 1, a point without a vector.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=0.5, a=0.3), 0.05)
        >>> wall = nh.Event(lambda states: 1.0 - states.position[:, 0], name="wall", reset=nh.Impact())
        >>> orbit = nh.simulate(sleigh, body_velocity=(0.1, 1.0, 0.0), steps=100, events=[wall])
        >>> hits = orbit.events["wall"]
        >>> hits.time.round(3), hits.states.energy.round(12) == hits.after.energy.round(12)
        (array([1.]), array([ True]))
    """

    normal: Any = None
    restitution: Any = 1.0
    point: Any = None

    def __post_init__(self) -> None:
        bounce = number("Impact(restitution=...)", self.restitution)
        if not 0 <= bounce <= 1:
            raise error("Impact(restitution=...)", "be from 0 to 1", f"{bounce}", "1 keeps the energy, 0 the least.")
        object.__setattr__(self, "restitution", float(bounce))
        if self.normal is None or callable(self.normal):
            if self.point is not None:
                raise error("Impact(point=...)", "come with a spatial vector", shown(self.normal), "Leave it out.")
            return
        remedy = "Pass n spatial coordinates, a function of the configuration, or nothing."
        normal = array("Impact(normal=...)", self.normal, (None,), remedy)
        if not np.any(normal):
            raise error("Impact(normal=...)", "be no zero vector", shown(self.normal), remedy)
        given = np.zeros_like(normal) if self.point is None else self.point
        point = array("Impact(point=...)", given, normal.shape, "Pass as many numbers as the normal has.")
        object.__setattr__(self, "normal", normal)
        object.__setattr__(self, "point", point)

    @property
    def has_plane(self) -> bool:
        """Whether the normal is a spatial vector."""
        return self.point is not None

    def check(self, where: str, system: Any) -> None:
        """Refuse a vector that is none of the space of a system, and differences for a body without matrices."""
        group = system.group
        if self.has_plane and len(self.point) != group.size - group.is_affine:
            got = f"{len(self.point)} numbers for {group}"
            raise error(where, "have a normal of the space", got, "Pass a vector of the space that points move in.")
        if self.normal is None and system.is_wide:
            raise error(where, "have a normal", f"none for {type(system).__name__}", "Pass a function.")

    def covector(self, gap: Any, states: Orbit) -> Float[np.ndarray, "dim"]:
        """Return n at a state; `gap` gives the values of the event at states."""
        system, g = states.system, states.configuration[0]
        if self.has_plane:
            return Gravity(self.normal, self.point).covector(system.group, g)
        if callable(self.normal):
            return numbers_of("Impact(normal=...)", self.normal, (system.group.dim,), "Return a body covector.", g)
        inside = system if system.forces is None else system.forces.system
        return -Forced(inside, lambda pose: gap(_placed(states, pose))[0]).potential_force(g)

    def struck(self, where: str, gap: Any, states: Orbit, direction: int) -> Orbit | None:
        """Return a state after an impact; None where the motion is not toward the wall, or cannot be.

        Args:
            where: The event, for messages.
            gap: Gives the values of the event at states.
            states: One state, at the wall.
            direction: That of the gap on the way through the wall.
        """
        system, g, r = states.system, states.configuration[0], states.restricted_momentum[0]
        nu = system.restrict_at(self.covector(gap, states), g)
        push = system.restricted_velocity(nu, g)
        rate = push @ r
        if not rate * direction > 0:
            self._check_direction(where, gap, states)
            return None
        change = system.to_canonical(-(1 + self.restitution) * rate / (push @ nu) * nu)
        return dataclasses.replace(states, reduced_momentum=states.reduced_momentum + change)

    def _check_direction(self, where: str, gap: Any, states: Orbit) -> None:
        """Refuse a normal that points where the gap falls; a motion along the wall may only graze it."""
        if self.normal is None or states.system.is_wide:
            return
        if self.covector(gap, states) @ Impact().covector(gap, states) < 0:
            got, remedy = f"its opposite at time {states.time[0]:.17g}", "Pass the other direction."
            raise error(where, "have the normal in whose direction the function grows", got, remedy)


def _placed(states: Orbit, g: Float[np.ndarray, "N N"]) -> Orbit:
    """Return a state at another pose."""
    pose = states.system.group.pose_from_matrix(g @ states.system.frame)[None]
    turned = None if states.turned is None else turned_near(states.turned, pose)
    return dataclasses.replace(states, canonical_pose=pose, turned=turned)
