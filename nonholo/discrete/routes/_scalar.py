"""The route in closed form, which JAX can trace too."""

import dataclasses
import functools
from typing import ClassVar, NamedTuple

import numpy as np

from nonholo import kernels
from nonholo.base.types import Array, Float
from nonholo.discrete.routes._base import AbstractCompiledRoute, Axes
from nonholo.discrete.routes._closed_forms import ClosedForm, closed_form
from nonholo.systems import NormalForm, System


class ScalarStep(NamedTuple):
    """The data of a step in closed form for JAX.

    Attributes:
        body: The body of the kernel.
        scale: The factor to its momenta.
        rows: C with m = C r_canonical and y_canonical = y C; None where the rows are the same.
    """

    body: kernels.Body
    scale: Array
    rows: Float[np.ndarray, "2 2"] | None


@dataclasses.dataclass(frozen=True, eq=False)
class ScalarRoute(AbstractCompiledRoute):
    """Two momenta, a chart of two numbers and a compact pose of four."""

    system: System
    form: NormalForm
    closed: ClosedForm
    time_step: Array
    order: ClassVar[int] = 2
    name: ClassVar[str] = "scalar"
    is_scalar: ClassVar[bool] = True
    needs_pose: ClassVar[bool] = True

    @functools.cached_property
    def body(self) -> kernels.Body:
        """The numbers of the body."""
        return self.closed.body(self.form)

    @functools.cached_property
    def scale(self) -> Array:
        """The part of the time step that is the unit of the kernel's momenta."""
        return self.time_step * self.closed.share

    @property
    def single(self) -> "ScalarRoute":
        """The route itself."""
        return self

    @property
    def step(self) -> ScalarStep:
        """Its data for JAX."""
        return ScalarStep(self.body, self.scale, self.axes.rows)

    def start(self, momenta: np.ndarray, pose: np.ndarray) -> tuple[int, np.ndarray, np.ndarray]:
        """Return the outcome of the first root, its chart and the state of a run, in numbers of the kernel."""
        state = np.zeros(kernels.STATE_SIZE)
        return kernels.start(self.body, momenta, pose, state), state[kernels.CHART], state

    def encode(self, momenta: np.ndarray) -> np.ndarray:
        """Return the momenta of the kernel from canonical ones."""
        return self.scale * self.axes.momenta(momenta)

    def decode(self, momenta: np.ndarray) -> np.ndarray:
        """Return canonical momenta from those of the kernel."""
        return self.axes.canonical_momenta(momenta / self.scale)

    def to_kernel(self, charts: np.ndarray) -> np.ndarray:
        """Return the chart coordinates of the kernel from canonical ones."""
        return self.axes.charts(charts)

    def from_kernel(self, charts: np.ndarray) -> np.ndarray:
        """Return canonical chart coordinates from those of the kernel."""
        return self.axes.canonical_charts(charts)

    def encode_poses(self, poses: np.ndarray) -> np.ndarray:
        """Return the compact poses of the kernel's axes."""
        return self.axes.poses(poses)

    def decode_poses(self, poses: np.ndarray) -> np.ndarray:
        """Return compact canonical poses from those of the kernel."""
        return self.axes.canonical_poses(poses)

    def of_many(self, system: System, time_step: Array) -> "ScalarRoute | None":
        """Return the route of many systems in one, whose numbers have an axis in front; None of another closed form."""
        form = system.normal_form
        same = form is not None and closed_form(form) is self.closed
        return dataclasses.replace(self, system=system, form=form, time_step=time_step) if same else None

    @functools.cached_property
    def axes(self) -> Axes:
        """The change from the canonical axes to those of the kernel."""
        rows, own = self.form.frame_map, self.closed.rows
        if own is not None:
            rows = own if rows is None else own @ rows
        same = rows is None or np.array_equal(rows, np.broadcast_to(np.eye(2), rows.shape))
        return Axes(self.system.group, self.form.frame, None if same else rows)
