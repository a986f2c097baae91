"""Bodies as pictures, films and pages show them: an elliptic plate with its blade in the plane, a box in space."""

from typing import NamedTuple

import numpy as np

from nonholo.analysis.planar import blade_axes
from nonholo.base.types import Float
from nonholo.groups import SE
from nonholo.systems import System

_SLENDER = 1.6  # length of the plate over its width
_THINNEST = 0.12  # of the box, over its longest side
_IN_SPHERE = 0.72  # from the center of that box to its corners, in radii of the sphere
_NORMALS = np.concatenate([np.eye(3), -np.eye(3)])


def plate(system: System) -> list[Float[np.ndarray, "P 2"]]:
    r"""Return the uniform ellipse with the mass and moment of inertia of a body, its center, and its blade.

    Points are in the axes of the blade, if there is one, else of the body. The ellipse with half axes $p$, $q$ has
    $J = m(p^2 + q^2)/4$.
    """
    inertia, frame = np.asarray(system.inertia_operator), blade_axes(system.inside)
    mass = float(np.trace(inertia[1:, 1:])) / 2
    center = np.array([inertia[0, 2], -inertia[0, 1]]) / mass
    moment = max(float(inertia[0, 0] - mass * center @ center), 0.0)
    length = _SLENDER * np.sqrt(4 * moment / mass / (1 + _SLENDER**2)) or 1.0
    angle = np.linspace(0, 2 * np.pi, 121)
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    middle = (SE(2).inverse(np.eye(3) if frame is None else frame) @ [*center, 1.0])[:2]
    parts = [middle + length * circle * [1.0, 1 / _SLENDER], middle + 0.05 * length * circle]
    stroke = np.array([[-0.4, -0.025], [0.4, -0.025], [0.4, 0.025], [-0.4, 0.025]])
    return parts if frame is None else [*parts, length * stroke]


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
        faces = []
        for normal in _NORMALS:
            along, across = np.eye(3)[normal == 0]
            faces.append([normal + i * along + j * across for i, j in ((1, 1), (1, -1), (-1, -1), (-1, 1))])
        inside = self.half * np.array(faces) @ self.axes.T + self.center
        return inside @ g[:3, :3].T + (g[:3, 3] if len(g) == 4 else 0.0)

    def normals(self, g: Float[np.ndarray, "N N"]) -> Float[np.ndarray, "6 3"]:
        """Return the normals of its faces in space."""
        return _NORMALS @ (g[:3, :3] @ self.axes).T

    def way_out(self, direction: Float[np.ndarray, "3"]) -> float:
        """Return how many times a vector, in body axes, goes from the center to the surface."""
        size = np.abs(self.axes.T @ direction)
        ways = np.divide(self.half, size, out=np.full(3, np.inf), where=size > 1e-12 * size.max(initial=1e-300))
        return float(ways.min())


def box_in_space(system: System) -> Box:
    """Return the uniform box with the mass tensor of a body on SE(3) about its center of mass."""
    inertia = np.asarray(system.inertia_operator)
    mass = float(np.trace(inertia[3:, 3:])) / 3
    lever = inertia[:3, 3:] / mass  # hat(center)
    center = np.array([lever[2, 1] - lever[1, 2], lever[0, 2] - lever[2, 0], lever[1, 0] - lever[0, 1]]) / 2
    steiner = mass * (center @ center * np.eye(3) - np.outer(center, center))
    return _box_of(inertia[:3, :3] - steiner, mass)._replace(center=center)


def box_in_sphere(system: System) -> Box:
    """Return the box in the unit sphere whose mass tensor is proportional to that of a body on SO(3)."""
    body = _box_of(np.asarray(system.inertia_operator), 1.0)
    return body._replace(half=_IN_SPHERE * body.half / np.linalg.norm(body.half))


def _box_of(inertia: Float[np.ndarray, "3 3"], mass: float) -> Box:
    """Return the uniform box about the origin with an inertia tensor: sides with $J_i = m s_i^2 / 3$ of half sides $s$.

    A moment that is too small, or negative, as no body has it, gives a thin box.
    """
    moments, axes = np.linalg.eigh(np.trace(inertia) / 2 * np.eye(3) - inertia)
    longest = max(float(moments[-1]), 0.0)
    return Box(np.sqrt(3 / mass * np.maximum(moments, _THINNEST**2 * longest)), axes, np.zeros(3))
