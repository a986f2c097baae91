"""The route of a composition: the kernel of another route, run over substeps."""

import dataclasses
import functools
from typing import ClassVar

import numpy as np

from nonholo import kernels
from nonholo.base.types import Array
from nonholo.discrete._composition import weights
from nonholo.discrete.routes._base import AbstractCompiledRoute
from nonholo.systems import System


@dataclasses.dataclass(frozen=True, eq=False)
class ComposedRoute(AbstractCompiledRoute):
    """Momenta, charts and poses are those of the route that is composed.

    Attributes:
        composed: The route of a step of order 2 with the same time step.
        order: 4, 6 or 8.
    """

    composed: AbstractCompiledRoute
    order: int
    is_scalar: ClassVar[bool] = False

    @functools.cached_property
    def body(self) -> kernels.ComposedBody:
        """The body and the weights of the substeps."""
        return kernels.ComposedBody(self.single.body, weights(self.order).copy())

    @property
    def single(self) -> AbstractCompiledRoute:
        """The discretization that is composed."""
        return self.composed

    @property
    def name(self) -> str:
        """The name of what is composed."""
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
