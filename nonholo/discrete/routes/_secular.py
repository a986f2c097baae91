r"""The route in O(n) of tops on SO(n) and sleighs on SE(n): axes, units and signs between the system and its kernel.

Reference: docs/theory/secular-step.md.
"""

import dataclasses
import functools
from typing import ClassVar

import numpy as np

from nonholo import kernels
from nonholo.base.types import Array, Float
from nonholo.discrete.routes._base import AbstractCompiledRoute, Axes
from nonholo.systems import NormalForm, System


@dataclasses.dataclass(frozen=True, eq=False)
class SecularRoute(AbstractCompiledRoute):
    r"""Momenta in the axes that diagonalize B, a chart, and the rows of a pose matrix.

    The kernel's momenta of a sleigh are $h\,(\pi, p_1)/2$ with $\pi = p|_{e_1\wedge e_j} - \alpha_j p_1$ along those
    axes.
    """

    system: System
    form: NormalForm
    time_step: Array
    order: ClassVar[int] = 2
    name: ClassVar[str] = "secular"
    is_scalar: ClassVar[bool] = False
    needs_pose: ClassVar[bool] = False

    @staticmethod
    def covers(form: NormalForm) -> bool:
        """Tell whether a body is one of this route."""
        return not form.is_planar or form.is_diagonal

    @functools.cached_property
    def body(self) -> kernels.SecularBody:
        """The numbers of the body in the principal axes of B."""
        form, (b, _) = self.form, self.form.principal
        c = form.to_principal(form.coupling)
        if not form.is_sleigh:
            return kernels.secular_top(b, c)
        return kernels.secular_sleigh(b, -c, float(form.mass), float(form.arm), form.to_principal(form.offset))

    @property
    def scale(self) -> Array:
        """Half the time step."""
        return self.time_step / 2

    @property
    def single(self) -> "SecularRoute":
        """The route itself."""
        return self

    def encode(self, momenta: np.ndarray) -> np.ndarray:
        """Return the momenta of the kernel from canonical ones."""
        momenta = self._axes.momenta(momenta)
        if self.form.is_sleigh:
            along = momenta[..., -1:]
            momenta = np.concatenate([momenta[..., :-1] - along * self.form.offset, along], axis=-1)
        return self.form.to_principal(self.scale * momenta)

    def decode(self, momenta: np.ndarray) -> np.ndarray:
        """Return canonical momenta from those of the kernel."""
        momenta = self.form.from_principal(momenta) / self.scale
        if self.form.is_sleigh:
            momenta[..., :-1] += momenta[..., -1:] * self.form.offset
        return self._axes.canonical_momenta(momenta)

    def to_kernel(self, charts: np.ndarray) -> np.ndarray:
        """Return the chart coordinates of the kernel from canonical ones."""
        return self.form.to_principal(self._axes.charts(charts))

    def from_kernel(self, charts: np.ndarray) -> np.ndarray:
        """Return canonical chart coordinates from those of the kernel."""
        return self._axes.canonical_charts(self.form.from_principal(charts))

    def encode_poses(self, poses: np.ndarray) -> np.ndarray:
        """Return the matrices of poses of the kernel's axes, row by row."""
        g = self._axes.turned(self.system.group.matrix_from_pose(poses))
        g = g if self._turn is None else g @ self._turn
        return g.reshape(*poses.shape[:-1], self.system.group.size**2)

    def decode_poses(self, poses: np.ndarray) -> np.ndarray:
        """Return compact canonical poses from those of the kernel."""
        size = self.system.group.size
        g = poses.reshape(*poses.shape[:-1], size, size)
        g = g if self._turn is None else g @ self._turn.T
        return self.system.group.pose_from_matrix(self._axes.turned_back(g))

    @functools.cached_property
    def _turn(self) -> Float[np.ndarray, "N N"] | None:
        """The body frame of the kernel as seen from that of the normal form; None where they are the same."""
        axes = self.form.principal[1]
        if axes is None:
            return None
        turn, first = np.eye(self.system.group.size), int(self.form.is_sleigh)
        planes = slice(first, first + len(axes))
        turn[planes, planes] = axes
        return turn

    @functools.cached_property
    def _axes(self) -> Axes:
        return Axes(self.system.group, self.form.frame, self.form.frame_map)
