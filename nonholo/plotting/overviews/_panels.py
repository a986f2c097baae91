"""Which panels an overview has: chosen by the group, the kind of constraint and the number of free directions."""

import functools
from collections.abc import Callable
from typing import Any, NamedTuple, cast

import numpy as np
from matplotlib.axes import Axes

from nonholo.base.types import Float
from nonholo.groups import SE, SO
from nonholo.orbit import Orbit
from nonholo.plotting import motion
from nonholo.plotting.sheets import blade_of_system, sheet_of
from nonholo.systems import AbstractLLSystem


class Panel(NamedTuple):
    """A panel: what draws it on its axes, whether its abscissa is time, and the projection that its axes need."""

    draw: Callable[[Axes], object]
    is_timed: bool = False
    projection: str | None = None


def panels_of(orbit: Orbit, flow: Orbit | None) -> list[Panel]:
    """Return the panels of an orbit, the large one first; there is always one."""
    energy = Panel(functools.partial(motion.energy_error, orbit), is_timed=True)
    if orbit.system.is_wide and sheet_of(orbit.system) is None:
        return [_components(orbit, flow), energy]
    path, momentum = _path(orbit, flow), _momentum(orbit, flow)
    velocity = Panel(functools.partial(_velocity, orbit, flow), is_timed=True)
    if not orbit.system.is_spatial:
        return [*path, *momentum, velocity, energy]
    if orbit.canonical_pose is None:
        return [_components(orbit, flow)]
    return [*path, velocity, *momentum, energy]  # the momenta along such a constraint are constant: nothing to enlarge


def _path(orbit: Orbit, flow: Orbit | None) -> list[Panel]:
    if orbit.canonical_pose is None:
        return []
    group, flow = orbit.system.group, flow if flow is not None and flow.canonical_pose is not None else None
    if blade_of_system(orbit.system) is not None:
        return [Panel(lambda axes: motion.blade_track(orbit, axes=axes, flow=flow))]
    if group == SO(3):
        return [Panel(functools.partial(_body_axis, orbit, flow))]
    if group.size > 2 and group == SE(group.size - 1):
        projection = "3d" if group.size > 3 else None
        return [Panel(lambda axes: motion.point_track(orbit, axes=axes, flow=flow), projection=projection)]
    return []


def _momentum(orbit: Orbit, flow: Orbit | None) -> list[Panel]:
    system, directions = orbit.system, orbit.system.rank
    if directions == 0:
        return []
    if system.is_forced:
        return [_components(orbit, flow)]
    if not system.is_spatial and directions == 2:
        return [Panel(lambda axes: motion.phase_portrait(cast(AbstractLLSystem, system), orbit, axes=axes))]
    if not system.is_spatial and directions == 3:
        return [Panel(lambda axes: motion.momentum_sphere(orbit, axes=axes))]
    return [_components(orbit, flow)]


def _components(orbit: Orbit, flow: Orbit | None) -> Panel:
    return Panel(lambda axes: motion.momentum_components(orbit, axes, flow), is_timed=True)


def _body_axis(orbit: Orbit, flow: Orbit | None, axes: Axes) -> None:
    motion.body_axis_track(orbit, axes=axes, flow=flow)
    tensor: Any = orbit.system.homogeneous_mass_tensor
    if tensor is not None:
        _write_mass_tensor(axes, np.asarray(tensor))


def _velocity(orbit: Orbit, flow: Orbit | None, axes: Axes) -> None:
    headed = blade_of_system(orbit.system) is not None and orbit.canonical_pose is not None
    if flow is not None and flow.canonical_pose is None and (headed or orbit.system.is_spatial):
        flow = None
    (motion.heading_and_speed if headed else motion.velocity_components)(orbit, axes, flow)


def _write_mass_tensor(axes: Axes, mass_tensor: Float[np.ndarray, "3 3"]) -> None:
    cells = [[f"{number:.3g}".replace("-", "\u2212") for number in row] for row in mass_tensor + 0.0]
    width = max(len(cell) for row in cells for cell in row)
    lines = ["  ".join(cell.rjust(width) for cell in row) for row in cells]
    text = f"    \u23a1{lines[0]}\u23a4\nJ = \u23a2{lines[1]}\u23a5\n    \u23a3{lines[2]}\u23a6"
    look: Any = {"family": "monospace", "fontsize": 9.5, "linespacing": 1.05, "color": "#555a62"}
    axes.text(0.0, 0.0, text, transform=axes.transAxes, **look)
