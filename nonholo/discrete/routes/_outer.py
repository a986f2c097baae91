"""The interface of a route around another one, whose units, axes and poses it has."""

import numpy as np

from nonholo.base.types import Array
from nonholo.discrete.routes._base import AbstractCompiledRoute
from nonholo.systems import System


class AbstractOuterRoute(AbstractCompiledRoute):
    """A route that runs the kernel of another one, its `single`."""

    @property
    def name(self) -> str:
        """The name of the route inside."""
        return self.single.name

    @property
    def needs_pose(self) -> bool:
        """Whether it carries a pose along even where none is kept."""
        return self.single.needs_pose

    @property
    def system(self) -> System:
        """The system that moves."""
        return self.single.system

    @property
    def time_step(self) -> Array:
        """The length of the whole step."""
        return self.single.time_step

    @property
    def scale(self) -> Array:
        """The factor to the momenta of the kernel."""
        return self.single.scale

    def encode(self, momenta: np.ndarray) -> np.ndarray:
        """Return the momenta of the kernel from canonical ones."""
        return self.single.encode(momenta)

    def decode(self, momenta: np.ndarray) -> np.ndarray:
        """Return canonical momenta from those of the kernel."""
        return self.single.decode(momenta)

    def to_kernel(self, charts: np.ndarray) -> np.ndarray:
        """Return the chart coordinates of the kernel from canonical ones."""
        return self.single.to_kernel(charts)

    def from_kernel(self, charts: np.ndarray) -> np.ndarray:
        """Return canonical chart coordinates from those of the kernel."""
        return self.single.from_kernel(charts)

    def encode_poses(self, poses: np.ndarray) -> np.ndarray:
        """Return the poses of the kernel from compact canonical ones."""
        return self.single.encode_poses(poses)

    def decode_poses(self, poses: np.ndarray) -> np.ndarray:
        """Return compact canonical poses from those of the kernel."""
        return self.single.decode_poses(poses)
