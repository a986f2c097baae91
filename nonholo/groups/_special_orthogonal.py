"""The rotation group of space, SO(3); the compact pose is a unit quaternion, scalar first."""

import dataclasses
from typing import ClassVar

import numpy as np

from nonholo.base.numerics import of_length_one
from nonholo.base.types import Array, Float
from nonholo.groups import _rotations
from nonholo.groups._coordinates import AbstractCoordinates, coordinates_of
from nonholo.groups._quaternion import matrix_from_quaternion, quaternion_from_matrix, quaternion_product
from nonholo.groups._rodrigues import AbstractRodriguesGroup


@dataclasses.dataclass(frozen=True, repr=False)
class SpecialOrthogonal3(AbstractRodriguesGroup):
    """Rotations of space; the coordinates of the algebra are the angular velocity vector.

    `exp(x)` is the rotation by the vector `x` (axis times angle), `cayley(x)` that about `x` with
    tan(angle / 2) = |x| / 2.
    """

    basis: ClassVar[np.ndarray] = np.array(
        [
            [[0.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]],
            [[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [-1.0, 0.0, 0.0]],
            [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]],
        ]
    )
    coordinates: ClassVar[AbstractCoordinates] = coordinates_of(basis)
    curvature: ClassVar[float] = 1.0

    def __repr__(self) -> str:
        return "SO(3)"

    def _squared_angle(self, x: Float[Array, "... 3"]) -> Float[Array, "..."]:
        return (x * x).sum(axis=-1)

    def log(self, g: Float[Array, "... 3 3"]) -> Float[Array, "... 3"]:
        """Return the rotation vector, of length at most pi; accurate near 0 and near pi."""
        g = self._matrix(g)
        xp = g.__array_namespace__()
        q = quaternion_from_matrix(g)
        squared = (q[..., 1:] * q[..., 1:]).sum(axis=-1)
        tiny = squared < np.finfo(np.float64).tiny
        sine = xp.sqrt(xp.where(tiny, 1.0, squared))
        scale = xp.where(tiny, 2.0, 2 * xp.arctan2(sine, q[..., 0]) / sine)
        return scale[..., None] * q[..., 1:]

    def inverse(self, g: Float[Array, "... 3 3"]) -> Float[Array, "... 3 3"]:
        """Return the transpose."""
        return self.form_adjoint(self._matrix(g))

    def residual(self, g: Float[Array, "... 3 3"]) -> Float[Array, "..."]:
        """Return the largest entry of g g^T - I; at least 2 for a reflection."""
        return _rotations.residual(self._matrix(g))

    def angle(self, x: Float[Array, "... 3"]) -> Float[Array, "..."]:
        """Return the angle through which `exp(x)` turns."""
        x = self._vector(x)
        return x.__array_namespace__().sqrt((x * x).sum(axis=-1))

    def random(self, rng: np.random.Generator) -> Float[np.ndarray, "3 3"]:
        """Draw a uniformly distributed rotation."""
        return matrix_from_quaternion(self._generator(rng).normal(size=4))

    def matrix_from_pose(self, pose: Float[Array, "... 4"]) -> Float[Array, "... 3 3"]:
        """Return the rotation matrix of a quaternion, scalar first."""
        return matrix_from_quaternion(self._pose(pose))

    def pose_from_matrix(self, g: Float[Array, "... 3 3"]) -> Float[Array, "... 4"]:
        """Return the unit quaternion, scalar first and non-negative."""
        return quaternion_from_matrix(self._matrix(g))

    def normalize_pose(self, pose: Float[Array, "... 4"]) -> Float[Array, "... 4"]:
        """Return the unit quaternion."""
        return of_length_one(self._pose(pose), 4)

    def pose_product(self, pose: Float[Array, "... 4"], other: Float[Array, "... 4"]) -> Float[Array, "... 4"]:
        """Return Hamilton's product of two quaternions as a unit quaternion, its scalar non-negative."""
        return quaternion_product(self._pose(pose), self._pose(other))

    def pose_rate(self, pose: Float[Array, "... 4"], x: Float[Array, "... 3"]) -> Float[Array, "... 4"]:
        """Return half the Hamilton product of the quaternion with the angular velocity."""
        pose, x = self._pose(pose), self._vector(x)
        xp = x.__array_namespace__()
        (q0, q1, q2, q3), (a, b, c) = (tuple(v[..., i] for i in range(v.shape[-1])) for v in (pose, x))
        rows = (-q1 * a - q2 * b - q3 * c, q0 * a + q2 * c - q3 * b, q0 * b + q3 * a - q1 * c, q0 * c + q1 * b - q2 * a)
        return xp.stack(rows, axis=-1) / 2
