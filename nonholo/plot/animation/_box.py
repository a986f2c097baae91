"""A body in space as a box, seen in parallel projection. No mechanics but its mass, center and mass tensor."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb

from nonholo.base.types import Float
from nonholo.plot import theme
from nonholo.plot.parts import View

_THINNEST = 0.12  # of the drawn box, over its longest side
_LIGHT = np.array([-0.4, 0.6, 0.7]) / np.linalg.norm([-0.4, 0.6, 0.7])  # right, up, toward the eye
_NORMALS = np.concatenate([np.eye(3), -np.eye(3)])


class Box(NamedTuple):
    """A uniform box that is fixed in a body.

    Attributes:
        half: Its half sides.
        axes: Its axes in the body, in columns.
        center: Its center in the body.
    """

    half: Float[np.ndarray, "3"]
    axes: Float[np.ndarray, "3 3"]
    center: Float[np.ndarray, "3"]

    def corners(self, g: Float[np.ndarray, "N N"]) -> Float[np.ndarray, "6 4 3"]:
        """Return the corners of its faces in space, in a pose of SO(3) or SE(3)."""
        inside = np.array([_face(self.half, normal) for normal in _NORMALS]) @ self.axes.T + self.center
        return inside @ g[:3, :3].T + (g[:3, 3] if len(g) == 4 else 0.0)

    def way_out(self, direction: Float[np.ndarray, "3"]) -> float:
        """Return how many times a vector, in body axes, goes from the center to the surface."""
        size = np.abs(self.axes.T @ direction)
        ways = np.divide(self.half, size, out=np.full(3, np.inf), where=size > 1e-12 * size.max(initial=1e-300))
        return float(ways.min())


def box_of(inertia: Float[np.ndarray, "3 3"], mass: float) -> Box:
    """Return the uniform box about the origin with an inertia tensor: sides with $J_i = m s_i^2 / 3$ of half sides $s$.

    A moment that is too small, or negative, as no body has it, gives a thin box.
    """
    moments, axes = np.linalg.eigh(np.trace(inertia) / 2 * np.eye(3) - inertia)
    longest = max(float(moments[-1]), 0.0)
    return Box(np.sqrt(3 / mass * np.maximum(moments, _THINNEST**2 * longest)), axes, np.zeros(3))


def draw_box(axes: Axes, view: View, box: Box, *, zorder: float, ghost: bool = False) -> Callable[[Any], None]:
    """Draw a box, or its edges alone; return what shows it in a pose."""
    edge = theme.CONTINUOUS if ghost else theme.MUTED
    drawn = PolyCollection([], edgecolors=edge, linewidths=1.4 if ghost else 0.9, zorder=zorder, facecolors="none")
    axes.add_collection(drawn, autolim=False)
    shade = np.array(to_rgb("#56b4e9" if theme.is_dark() else "#a8d4f2"))

    def show(g: Float[np.ndarray, "N N"]) -> None:
        facing = _NORMALS @ (g[:3, :3] @ box.axes).T @ view.frame.T
        front = facing[:, 2] > 0
        drawn.set_verts(list(view(box.corners(g)[front])[0]))
        if not ghost:
            light = 0.62 + 0.38 * np.clip(facing[front] @ _LIGHT, 0.0, 1.0)
            drawn.set_facecolor([tuple(one * shade) for one in light])

    return show


def _face(half: Float[np.ndarray, "3"], normal: Float[np.ndarray, "3"]) -> Float[np.ndarray, "4 3"]:
    along, across = (np.eye(3)[i] for i in range(3) if normal[i] == 0)
    return half * np.array([normal + i * along + j * across for i, j in ((1, 1), (1, -1), (-1, -1), (-1, 1))])
