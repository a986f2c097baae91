"""The blade of a sleigh in the plane, whatever the axes of its body."""

import dataclasses

import numpy as np

from nonholo.analysis.planar import Strip
from nonholo.base.types import Float
from nonholo.groups import SE
from nonholo.orbit import Orbit


@dataclasses.dataclass(frozen=True, eq=False)
class Blade:
    """The axes of a blade, and what they carry.

    All points of the line across the blade move along it; the contact point is the one nearest to the origin of body
    coordinates.

    Attributes:
        frame: The axes at the contact point, the first along the blade, as seen from the user's frame.
        center: The center of mass (a, b) in these axes.
        mass: m.
        inertia: J, about the center of mass.
    """

    frame: Float[np.ndarray, "3 3"]
    center: Float[np.ndarray, "2"]
    mass: float
    inertia: float

    def poses(self, orbit: Orbit) -> Float[np.ndarray, "K 3 3"]:
        """Return the axes in the plane."""
        return orbit.configuration @ self.frame

    def contact(self, orbit: Orbit) -> Float[np.ndarray, "K 2"]:
        """Return the contact points in the plane."""
        return self.poses(orbit)[:, :2, 2]

    def heading(self, orbit: Orbit) -> Float[np.ndarray, "K"]:
        """Return the angle of the blade in the plane, full turns counted."""
        return orbit.heading + np.arctan2(self.frame[1, 0], self.frame[0, 0])

    def speed(self, orbit: Orbit) -> Float[np.ndarray, "K"]:
        """Return the velocity of the contact point along the blade."""
        return orbit.body_velocity @ SE(2).adjoint(SE(2).inverse(self.frame))[1]


def blade_of(strip: Strip) -> Blade:
    """Return the blade of a sleigh."""
    across = (SE(2).inverse(strip.frame) @ [0.0, 0.0, 1.0])[1]  # the origin of body coordinates
    shift = np.eye(3)
    shift[1, 2] = across
    return Blade(strip.frame @ shift, np.array([strip.arm, -across]), strip.mass, strip.inertia)
