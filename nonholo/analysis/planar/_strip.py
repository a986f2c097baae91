r"""Displacements of a sleigh in the plane as a strip: $(\Delta, \nu)$, the step angle and the translation along it.

The translation is that along the direction $\Delta/2$, and $(\Delta, \nu) \sim (\Delta + 2\pi, -\nu)$: a Moebius band.
"""

import numpy as np

from nonholo.analysis.planar._base import AbstractPlanarVariety, HalfPlanes
from nonholo.analysis.planar._conoid import Conoid, conoid
from nonholo.analysis.planar._strip_level import StripLevel
from nonholo.base.types import Array, Float
from nonholo.groups import SE

_BACK = np.array([-1.0, 1.0])  # the plane e_1^e_2 turns against the angle


class Strip(AbstractPlanarVariety):
    """The displacements of a sleigh."""

    @property
    def inertia(self) -> float:
        """J, about the center of mass."""
        return float(self.form.stiffness[0, 0])

    @property
    def mass(self) -> float:
        """The mass m."""
        return float(self.form.mass)

    @property
    def arm(self) -> float:
        """The coordinate a of the center of mass along the blade."""
        return float(self.form.arm)

    def displacement(self, points: Float[np.ndarray, "... 2"]) -> Float[np.ndarray, "... 3 3"]:
        """Return the motions with these angles and translations."""
        angle, along = np.moveaxis(points, -1, 0)
        zero, one = np.zeros_like(angle), np.ones_like(angle)
        c, s = np.cos(angle), np.sin(angle)
        rows = ((c, -s, along * np.cos(angle / 2)), (s, c, along * np.sin(angle / 2)), (zero, zero, one))
        return self.frame @ np.stack([np.stack(row, axis=-1) for row in rows], axis=-2) @ SE(2).inverse(self.frame)

    def points(self, displacement: Float[np.ndarray, "... 3 3"]) -> Float[np.ndarray, "... 2"]:
        """Return angles between -pi and pi and translations."""
        W = SE(2).inverse(self.frame) @ displacement @ self.frame
        angle = np.arctan2(W[..., 1, 0], W[..., 0, 0])
        along = W[..., 0, 2] * np.cos(angle / 2) + W[..., 1, 2] * np.sin(angle / 2)
        return np.stack([angle, along], axis=-1)

    def canonical_momenta(self, restricted: Float[np.ndarray, "... 2"]) -> Float[np.ndarray, "... 2"]:
        r"""Return $(\pi, p_1)$ of momenta along the user's rows."""
        return _BACK * (restricted @ self.to_rows.T)

    def restricted_momenta(self, canonical: Float[np.ndarray, "... 2"]) -> Float[np.ndarray, "... 2"]:
        r"""Return momenta along the user's rows from $(\pi, p_1)$."""
        return np.linalg.solve(self.to_rows, (_BACK * canonical)[..., None])[..., 0] + 0.0

    def mesh(self, rows: int) -> tuple[Float[np.ndarray, "R C 2"], Float[np.ndarray, "R C 2"]]:
        """Return angles and translations of pieces of the rulings whose middles are on the axis, twice."""
        m, J, a = self.mass, self.inertia, self.arm
        reach = (2 * J + 2 * m * a * a) / (m * abs(a)) if a else 2 * np.sqrt(J / m)
        along, angle = np.meshgrid(np.linspace(-1, 1, rows), np.linspace(-np.pi, np.pi, 2 * rows + 1), indexing="ij")
        points = np.stack([angle, reach * along - 2 * a * np.cos(angle / 2)], axis=-1)
        return points, points

    def area_factor(self, points: Float[np.ndarray, "... 2"]) -> tuple[Float[Array, "..."], Float[Array, "..."]]:
        r"""Return $f = \cos\tfrac\Delta2\,(J\cos\Delta + ma^2) + \tfrac12 am\nu$, over m, in $\Delta$ and $\nu/2$."""
        angle, along, lever = points[..., 0], points[..., 1], self.mass * self.arm
        return np.cos(angle / 2) * (self.inertia * np.cos(angle) + lever * self.arm), lever * along / 2

    def sides(self, points: Float[np.ndarray, "... 2"]) -> tuple[HalfPlanes, Float[Array, "..."]]:
        r"""Return $(s, Q) = (\sin\tfrac\Delta2, am\nu)$ and $\Lambda = 2I\cos\tfrac\Delta2$."""
        angle, along, lever = points[..., 0], points[..., 1], self.arm * self.mass
        whole = self.inertia + lever * self.arm
        return HalfPlanes(np.sin(angle / 2), lever * along), 2 * whole * np.cos(angle / 2)

    def sides_of_momenta(self, restricted: Float[np.ndarray, "... 2"]) -> HalfPlanes:
        r"""Return $(\pi, a p_1)$."""
        canonical = self.canonical_momenta(restricted)
        return HalfPlanes(canonical[..., 0], self.arm * canonical[..., 1])

    def level(self, energy: float) -> StripLevel:
        """Return the level over the angles."""
        return StripLevel(self.mass, self.inertia, self.inertia + self.mass * self.arm**2, 2 * energy)

    def surface(self, time_step: float) -> Conoid:
        """Return Pluecker's conoid."""
        return conoid(self.mass, self.inertia, self.arm, self.frame, time_step)
