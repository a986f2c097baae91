r"""Routes of tops and sleighs by their normal form: the closed forms, which JAX can trace too, and the route in O(n).

A closed form is one entry for each body that has one, and what its kernel makes of a normal form. The route in O(n) of
tops on SO(n) and sleighs on SE(n) has axes, units and signs between the system and its kernel. Reference:
docs/theory/secular-step.md.
"""

import dataclasses
import functools
from collections.abc import Callable
from typing import ClassVar, NamedTuple

import numpy as np

from nonholo import kernels
from nonholo.base.checks import is_traced
from nonholo.base.types import Array, Float
from nonholo.discrete.routes._base import AbstractCompiledRoute, Axes
from nonholo.systems import NormalForm, System


class ClosedForm(NamedTuple):
    """A scalar kernel, and the bodies that it is for.

    Attributes:
        covers: Returns whether a planar normal form is one of its bodies.
        body: Makes its body; of many systems in one a body whose fields have an axis in front.
        share: The part of the time step in its momenta, m = share h r.
        rows: C with r_kernel = C r_form; None where its rows are those of the normal form.
    """

    covers: Callable[[NormalForm], bool]
    body: Callable[[NormalForm], kernels.Body]
    share: float
    rows: Float[np.ndarray, "2 2"] | None


def _slides_with_inertia(form: NormalForm) -> bool:
    """A plane sleigh needs a moment about its center of mass."""
    return form.is_sleigh and (is_traced(form.stiffness) or bool(np.all(form.stiffness > 0)))


def _sleigh(form: NormalForm) -> kernels.SleighBody:
    numbers = (form.mass, form.stiffness[..., 0, 0], form.arm)
    return kernels.SleighBody(*(x if is_traced(x) or np.ndim(x) else float(x) for x in numbers))


def _top(form: NormalForm) -> kernels.SuslovBody:
    if form.stiffness.ndim > 2:
        return kernels.SuslovBody(*kernels.suslov_table(form.stiffness, form.coupling))
    return kernels.suslov_body(form.stiffness, form.coupling)


_CLOSED_FORMS = (
    ClosedForm(_slides_with_inertia, _sleigh, 1.0, np.diag([-1.0, 1.0])),  # by omega, against e1 ^ e2 of the form
    ClosedForm(lambda form: not form.is_sleigh, _top, 0.5, None),
)
"""Looked through from the first to the last: one that is for fewer bodies comes first."""


def closed_form(form: NormalForm | None) -> ClosedForm | None:
    """Return the closed form of the step of a body; None where there is none."""
    if form is None or not form.is_planar or form.is_diagonal:
        return None
    return next((entry for entry in _CLOSED_FORMS if entry.covers(form)), None)


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

    def momentum_map(self, system: System) -> Float[Array, "2 2"]:
        """Return C with m = C r for momenta along the rows of the constraint subspace."""
        return self.scale * (system.frame_map if self.rows is None else self.rows @ system.frame_map)

    def canonical_chart(self, chart: Float[Array, "2"]) -> Float[Array, "2"]:
        """Return canonical chart coordinates from those of the kernel."""
        return chart if self.rows is None else chart @ self.rows


@dataclasses.dataclass(frozen=True, eq=False)
class ScalarRoute(AbstractCompiledRoute):
    """Two momenta, a chart of two numbers and a compact pose of four."""

    system: System
    form: NormalForm
    closed_form: ClosedForm
    time_step: Array
    name: ClassVar[str] = "scalar"
    is_scalar: ClassVar[bool] = True

    @functools.cached_property
    def body(self) -> kernels.Body:
        """The numbers of the body."""
        return self.closed_form.body(self.form)

    @functools.cached_property
    def scale(self) -> Array:
        """The part of the time step that is the unit of the kernel's momenta."""
        return self.time_step * self.closed_form.share

    @property
    def step(self) -> ScalarStep:
        """Its data for JAX."""
        return ScalarStep(self.body, self.scale, self.axes.rows)

    def start(self, momenta: np.ndarray, pose: np.ndarray) -> tuple[int, np.ndarray, np.ndarray]:
        """Return the outcome of the first root, its chart and the state of a run, in numbers of the kernel."""
        state = np.zeros(kernels.STATE_SIZE)
        return kernels.start(self.body, momenta, pose, state), state[kernels.CHART], state

    def encode_poses(self, poses: np.ndarray) -> np.ndarray:
        """Return the compact poses of the kernel's axes."""
        return self.axes.poses(poses)

    def decode_poses(self, poses: np.ndarray) -> np.ndarray:
        """Return compact canonical poses from those of the kernel."""
        return self.axes.canonical_poses(poses)

    def of_many(self, system: System, time_step: Array) -> "ScalarRoute | None":
        """Return the route of many systems in one, whose numbers have an axis in front; None of another closed form."""
        form = system.normal_form
        same = form is not None and closed_form(form) is self.closed_form
        return dataclasses.replace(self, system=system, form=form, time_step=time_step) if same else None

    @functools.cached_property
    def axes(self) -> Axes:
        """The change from the canonical axes to those of the kernel."""
        rows, own = self.form.frame_map, self.closed_form.rows
        if own is not None:
            rows = own if rows is None else own @ rows
        same = rows is None or np.array_equal(rows, np.broadcast_to(np.eye(2), rows.shape))
        return Axes(self.system.group, self.form.frame, None if same else rows)


@dataclasses.dataclass(frozen=True, eq=False)
class SecularRoute(AbstractCompiledRoute):
    r"""Momenta in the axes that diagonalize B, a chart, and the rows of a pose matrix.

    The kernel's momenta of a sleigh are $h\,(\pi, p_1)/2$ with $\pi = p|_{e_1\wedge e_j} - \alpha_j p_1$ along those
    axes.
    """

    system: System
    form: NormalForm
    time_step: Array
    name: ClassVar[str] = "secular"
    needs_pose: ClassVar[bool] = False

    @staticmethod
    def covers(form: NormalForm | None) -> bool:
        """Return whether a body is one of this route."""
        return form is not None and (not form.is_planar or form.is_diagonal)

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

    def encode(self, momenta: np.ndarray) -> np.ndarray:
        """Return the momenta of the kernel from canonical ones."""
        momenta = self.form.turned_about(self.axes.momenta(momenta), -1.0)
        return self.form.to_principal(self.scale * momenta)

    def decode(self, momenta: np.ndarray) -> np.ndarray:
        """Return canonical momenta from those of the kernel."""
        momenta = self.form.from_principal(momenta) / self.scale
        return self.axes.canonical_momenta(self.form.turned_about(momenta, 1.0))

    def to_kernel(self, charts: np.ndarray) -> np.ndarray:
        """Return the chart coordinates of the kernel from canonical ones."""
        return self.form.to_principal(self.axes.charts(charts))

    def from_kernel(self, charts: np.ndarray) -> np.ndarray:
        """Return canonical chart coordinates from those of the kernel."""
        return self.axes.canonical_charts(self.form.from_principal(charts))

    def encode_poses(self, poses: np.ndarray) -> np.ndarray:
        """Return the matrices of poses of the kernel's axes, row by row."""
        g, frame = self.system.group.matrix_from_pose(poses), self.axes.frame
        g = g if frame is None else g @ frame
        g = g if self._turn is None else g @ self._turn
        return g.reshape(*poses.shape[:-1], self.system.group.size**2)

    def decode_poses(self, poses: np.ndarray) -> np.ndarray:
        """Return compact canonical poses from those of the kernel."""
        size = self.system.group.size
        g = poses.reshape(*poses.shape[:-1], size, size)
        g = g if self._turn is None else g @ self._turn.T
        g = g if self.axes.frame is None else g @ self.system.group.inverse(self.axes.frame)
        return self.system.group.pose_from_matrix(g)

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
    def axes(self) -> Axes:
        """The axes of the normal form."""
        return Axes(self.system.group, self.form.frame, self.form.frame_map)
