"""The group of rigid motions of the plane, SE(2); the compact pose is (cos, sin, x, y)."""

import dataclasses
from typing import ClassVar

import numpy as np

from nonholo.base.numerics import half_cotangent, of_length_one
from nonholo.base.types import Array, Float
from nonholo.groups import _rotations
from nonholo.groups._coordinates import AbstractCoordinates, coordinates_of
from nonholo.groups._rodrigues import AbstractRodriguesGroup


@dataclasses.dataclass(frozen=True, repr=False)
class SpecialEuclidean2(AbstractRodriguesGroup):
    r"""Motions of the plane, $\begin{pmatrix} R & x \\ 0 & 1\end{pmatrix}$; coordinates $(\omega, v_1, v_2)$.

    `cayley(x)` is the motion with tan(angle / 2) = x[0] / 2 about the same center as `exp(x)`.
    """

    basis: ClassVar[np.ndarray] = np.array(
        [
            [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]],
            [[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]],
            [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]],
        ]
    )
    coordinates: ClassVar[AbstractCoordinates] = coordinates_of(basis)
    curvature: ClassVar[float] = 0.0

    def __repr__(self) -> str:
        return "SE(2)"

    def _squared_angle(self, x: Float[Array, "... 3"]) -> Float[Array, "..."]:
        return x[..., 0] * x[..., 0]

    def log(self, g: Float[Array, "... 3 3"]) -> Float[Array, "... 3"]:
        """Return the body velocity that leads to `g` in unit time, turning by at most pi."""
        g = self._matrix(g)
        xp = g.__array_namespace__()
        angle = xp.arctan2(g[..., 1, 0], g[..., 0, 0])
        along, across = half_cotangent(angle * angle), angle / 2
        x, y = g[..., 0, 2], g[..., 1, 2]
        return xp.stack([angle, along * x + across * y, along * y - across * x], axis=-1)

    def inverse(self, g: Float[Array, "... 3 3"]) -> Float[Array, "... 3 3"]:
        """Return the inverse motion."""
        return _rotations.motion_inverse(self._matrix(g))

    def residual(self, g: Float[Array, "... 3 3"]) -> Float[Array, "..."]:
        """Return the residual of the rotation or the largest error of the last row, whichever is larger."""
        return _rotations.motion_residual(self._matrix(g))

    def angle(self, x: Float[Array, "... 3"]) -> Float[Array, "..."]:
        """Return the angle through which `exp(x)` turns."""
        return abs(self._vector(x)[..., 0])

    def random(self, rng: np.random.Generator) -> Float[np.ndarray, "3 3"]:
        """Draw a uniform heading and a standard normal position."""
        rng = self._generator(rng)
        angle = rng.uniform(-np.pi, np.pi)
        return self.matrix_from_pose(np.array([np.cos(angle), np.sin(angle), *rng.normal(size=2)]))

    def matrix_from_pose(self, pose: Float[Array, "... 4"]) -> Float[Array, "... 3 3"]:
        """Return the matrix of (cos, sin, x, y); the heading is normalized first."""
        pose = self._pose(pose)
        xp = pose.__array_namespace__()
        unit = self.normalize_pose(pose)
        cos, sin, x, y = (unit[..., i] for i in range(4))
        zero, one = xp.zeros_like(cos), xp.ones_like(cos)
        rows = ((cos, -sin, x), (sin, cos, y), (zero, zero, one))
        return xp.stack([xp.stack(row, axis=-1) for row in rows], axis=-2)

    def pose_from_matrix(self, g: Float[Array, "... 3 3"]) -> Float[Array, "... 4"]:
        """Return (cos, sin, x, y)."""
        g = self._matrix(g)
        xp = g.__array_namespace__()
        return xp.stack([g[..., 0, 0], g[..., 1, 0], g[..., 0, 2], g[..., 1, 2]], axis=-1)

    def normalize_pose(self, pose: Float[Array, "... 4"]) -> Float[Array, "... 4"]:
        """Return the pose with cos^2 + sin^2 = 1."""
        return of_length_one(self._pose(pose), 2)

    def pose_product(self, pose: Float[Array, "... 4"], other: Float[Array, "... 4"]) -> Float[Array, "... 4"]:
        """Return (cos, sin, x, y) of the product: headings add, and the first one turns the second position."""
        poses = self.normalize_pose(pose), self.normalize_pose(other)
        xp = pose.__array_namespace__()
        (c, s, x, y), (d, t, u, v) = (tuple(each[..., i] for i in range(4)) for each in poses)
        return xp.stack([c * d - s * t, s * d + c * t, c * u - s * v + x, s * u + c * v + y], axis=-1)

    def pose_rate(self, pose: Float[Array, "... 4"], x: Float[Array, "... 3"]) -> Float[Array, "... 4"]:
        """Return the rates of (cos, sin, x, y): the body velocity turned by the heading."""
        pose, x = self._pose(pose), self._vector(x)
        xp = x.__array_namespace__()
        cos, sin = pose[..., 0], pose[..., 1]
        omega, v1, v2 = (x[..., i] for i in range(3))
        rows = (-sin * omega, cos * omega, cos * v1 - sin * v2, sin * v1 + cos * v2)
        return xp.stack(rows, axis=-1)
