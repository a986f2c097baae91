"""The route of any constraint with difference "matrix" whose variety has no exponential chart: matrix equations."""

import dataclasses
import functools
from typing import ClassVar

import numpy as np

from nonholo import kernels
from nonholo.base.types import Array
from nonholo.discrete._variety import Variety
from nonholo.discrete.routes._base import AbstractCompiledRoute
from nonholo.discrete.routes._general import general_body
from nonholo.systems import System


@dataclasses.dataclass(frozen=True, eq=False)
class MatrixRoute(AbstractCompiledRoute):
    """Momenta in the body's own units, the chart of the variety, and poses as matrices."""

    system: System
    variety: Variety
    time_step: Array
    order: ClassVar[int] = 2
    name: ClassVar[str] = "matrix"
    is_scalar: ClassVar[bool] = False
    needs_pose: ClassVar[bool] = True

    @functools.cached_property
    def _body_and_unit(self) -> tuple[kernels.GeneralBody, float]:
        return general_body(self.system, self.variety)

    @property
    def body(self) -> kernels.GeneralBody:
        """The matrices of the body."""
        return self._body_and_unit[0]

    @property
    def scale(self) -> Array:
        """The time step over the unit of momenta."""
        return self.time_step / self._body_and_unit[1]

    @property
    def single(self) -> "MatrixRoute":
        """The route itself."""
        return self

    def encode(self, momenta: np.ndarray) -> np.ndarray:
        """Return the momenta of the kernel from canonical ones."""
        return self.scale * momenta

    def decode(self, momenta: np.ndarray) -> np.ndarray:
        """Return canonical momenta from those of the kernel."""
        return momenta / self.scale

    def to_kernel(self, charts: np.ndarray) -> np.ndarray:
        """Return the chart itself."""
        return charts

    def from_kernel(self, charts: np.ndarray) -> np.ndarray:
        """Return the chart itself."""
        return charts

    def encode_poses(self, poses: np.ndarray) -> np.ndarray:
        """Return the matrices of poses, row by row."""
        group = self.system.group
        return group.matrix_from_pose(poses).reshape(*poses.shape[:-1], group.size**2)

    def decode_poses(self, poses: np.ndarray) -> np.ndarray:
        """Return compact poses from matrices row by row."""
        group = self.system.group
        return group.pose_from_matrix(poses.reshape(*poses.shape[:-1], group.size, group.size))
