r"""Displacements of a top, n = 3, as a disc: unit vectors $(z_0, z_1, z_2)$ up to sign, the projective plane.

They are the quaternions of the displacements; z lies in the direction of turning, z_0 = 0 is the angle pi.
"""

import numpy as np

from nonholo.analysis.planar._base import AbstractPlanarVariety, HalfPlanes
from nonholo.analysis.planar._disc_level import DiscLevel
from nonholo.analysis.planar._steiner import SteinerSurface, steiner_surface
from nonholo.base.types import Array, Float


class Disc(AbstractPlanarVariety):
    """The displacements of a top."""

    @property
    def inertia(self) -> Float[np.ndarray, "2 2"]:
        """B."""
        return self.form.stiffness_matrix

    @property
    def coupling(self) -> Float[np.ndarray, "2"]:
        """The vector c."""
        return np.asarray(self.form.coupling)

    def displacement(self, points: Float[np.ndarray, "... 3"]) -> Float[np.ndarray, "... 3 3"]:
        """Return the rotations with these quaternions."""
        z0, z1, z2 = np.moveaxis(points, -1, 0)
        rows = (
            (1 - 2 * z1 * z1, -2 * z1 * z2, 2 * z0 * z1),
            (-2 * z1 * z2, 1 - 2 * z2 * z2, 2 * z0 * z2),
            (-2 * z0 * z1, -2 * z0 * z2, 2 * z0 * z0 - 1),
        )
        return self.frame @ np.stack([np.stack(row, axis=-1) for row in rows], axis=-2) @ self.frame.T

    def points(self, displacement: Float[np.ndarray, "... 3 3"]) -> Float[np.ndarray, "... 3"]:
        """Return z from the columns of z z^T, the longest of which is nowhere small; its largest component positive."""
        W = self.frame.T @ displacement @ self.frame
        outer = np.empty_like(W)
        outer[..., 0, 0] = (1 + W[..., 2, 2]) / 2
        outer[..., 0, 1:] = outer[..., 1:, 0] = W[..., :2, 2] / 2
        outer[..., 1:, 1:] = (np.eye(2) - W[..., :2, :2]) / 2
        largest = np.argmax(np.diagonal(outer, axis1=-2, axis2=-1), axis=-1)
        column = np.take_along_axis(outer, largest[..., None, None], axis=-1)[..., 0]
        return column / np.linalg.norm(column, axis=-1, keepdims=True)

    def mesh(self, rows: int) -> tuple[Float[np.ndarray, "R C 2"], Float[np.ndarray, "R C 3"]]:
        """Return step angles, 0 to pi, with directions of z, and the points."""
        directions = np.linspace(0, 2 * np.pi, 2 * rows + 1)
        angle, direction = np.meshgrid(np.linspace(0, np.pi, rows), directions, indexing="ij")
        z0, size = np.cos(angle / 2), np.sin(angle / 2)
        points = np.stack([z0, size * np.cos(direction), size * np.sin(direction)], axis=-1)
        return np.stack([angle, direction], axis=-1), points

    def area_factor(self, points: Float[np.ndarray, "... 3"]) -> tuple[Float[Array, "..."], Float[Array, "..."]]:
        r"""Return the factor on the sphere, up to a constant.

        $$ f = D z_0(z_0^2 - |z|^2) + 2z_0\,(c\cdot z^\perp)^2 \; - \; c\cdot Bz + 2(c\cdot z)(z\cdot Bz). $$
        """
        B, c, z0, z = self.inertia, self.coupling, points[..., 0], points[..., 1:]
        square, across = (z * z).sum(axis=-1), z[..., 0] * c[1] - z[..., 1] * c[0]
        even = z0 * (np.linalg.det(B) * (z0 * z0 - square) + 2 * across * across)
        return even, 2 * (z @ c) * np.einsum("...i,ij,...j->...", z, B, z) - z @ (B @ c)

    def sides(self, points: Float[np.ndarray, "... 3"]) -> tuple[HalfPlanes, Float[Array, "..."]]:
        r"""Return $(s, Q) = (c\cdot z^\perp, -c\cdot Bz)$ and $\Lambda = Dz_0$, with $z_0 \ge 0$."""
        points = np.where(points[..., :1] < 0, -points, points)
        z0, z = points[..., 0], points[..., 1:]
        sides = HalfPlanes(_quarter_turned(z) @ self.coupling, -z @ (self.inertia @ self.coupling))
        return sides, np.linalg.det(self.inertia) * z0

    def sides_of_momenta(self, restricted: Float[np.ndarray, "... 2"]) -> HalfPlanes:
        r"""Return $\bigl((Bc)\cdot r^\perp, -c\cdot r\bigr)$."""
        r = restricted @ self.to_rows.T
        return HalfPlanes(_quarter_turned(r) @ (self.inertia @ self.coupling), -r @ self.coupling)

    def level(self, energy: float) -> DiscLevel:
        """Return the level in polar coordinates of z."""
        return DiscLevel(self.inertia, self.coupling, energy / 2)

    def surface(self, time_step: float) -> SteinerSurface:
        """Return the Steiner surface."""
        return steiner_surface(self.inertia, self.coupling, self.frame, time_step)


def _quarter_turned(z: Float[np.ndarray, "... 2"]) -> Float[np.ndarray, "... 2"]:
    return np.stack([-z[..., 1], z[..., 0]], axis=-1)
