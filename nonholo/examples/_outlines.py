"""Parts of bodies as they look from above, in body axes."""

import numpy as np

from nonholo.base.types import Array, Float


def wheel(
    place: tuple[float, float], diameter: float, angle: Array | float = 0.0, width: float = 0.3
) -> Float[np.ndarray, "4 2"]:
    """Return a wheel at a place that rolls along a direction, its width in parts of its diameter."""
    corners = diameter / 2 * np.array([[-1.0, -width], [1.0, -width], [1.0, width], [-1.0, width]])
    return np.array(place) + corners @ turn(angle)


def pair(
    place: tuple[float, float], half_width: float, diameter: float, angle: Array | float = 0.0
) -> list[Float[np.ndarray, "P 2"]]:
    """Return an axle and its two wheels, turned together."""
    ends = np.array(place) + np.array([[0.0, -half_width], [0.0, half_width]]) @ turn(angle)
    return [ends, *(wheel(end, diameter, angle) for end in ends)]


def turn(angle: Array | float) -> Float[np.ndarray, "2 2"]:
    """Return the matrix that turns rows."""
    return np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
