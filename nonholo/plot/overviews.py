"""The picture of an orbit: its panels in one figure with a head, for the screen, a slide or a page.

Which panels it has is chosen by the group, the kind of constraint and the number of free directions. The head names the
system, its parameters, the time, and the end of the run.
"""

import functools
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple, Unpack, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from nonholo.base.results import Outcome
from nonholo.groups import SE, SO
from nonholo.orbit import AbstractOrbit, Orbit
from nonholo.plot import theme
from nonholo.plot.motion import coordinates, spheres, time_series, tracks
from nonholo.plot.motion.phase_portrait import phase_portrait
from nonholo.plot.parts import drawable_in_time, finish_page, is_free, new_page, same_space
from nonholo.plot.sheets import sheet_of, strip_of
from nonholo.systems import AbstractLLSystem, LLSystem, System


class Panel(NamedTuple):
    """A panel: what draws it on its axes, whether its abscissa is time, and the projection that its axes need."""

    draw: Callable[[Axes], object]
    is_timed: bool = False
    projection: str | None = None


def _in_coordinates(orbit: AbstractOrbit, flow: AbstractOrbit | None) -> list[Panel]:
    """Return the panels of an orbit of a Lagrange-d'Alembert system."""
    track = coordinates.track_of(orbit)
    panels = []
    if track is not None:
        draw = functools.partial(coordinates.draw_path, track, orbit, flow)
        panels = [Panel(draw, projection="3d" if len(track.names) == 3 else None)]
    pictures = [coordinates.draw_shape] * bool(orbit.coordinates) + [coordinates.draw_velocity]
    series = [functools.partial(draw, orbit, flow) for draw in pictures]
    errors = [time_series.energy_error] + [time_series.draw_residual] * bool(orbit.system.constraints)
    return panels + [Panel(each, is_timed=True) for each in (*series, *(functools.partial(e, orbit) for e in errors))]


def _of_body(orbit: Orbit, flow: Orbit | None) -> list[Panel]:
    """Return the panels of an orbit of a body, the large one first; there is always one."""
    energy = Panel(functools.partial(time_series.energy_error, orbit), is_timed=True)
    path, momentum = _path(orbit, flow), _momentum(orbit, flow)
    has_few = orbit.system.rank <= time_series.MOST_LINES
    velocity = [Panel(functools.partial(_velocity, orbit, flow), is_timed=True)] if has_few else []
    if not orbit.system.is_spatial:
        return [*path, *momentum, *velocity, energy]
    # the momenta along such a constraint are constant: nothing to enlarge
    return [_components(orbit, flow)] if orbit.canonical_pose is None else [*path, *velocity, *momentum, energy]


def _path(orbit: Orbit, flow: Orbit | None) -> list[Panel]:
    if orbit.canonical_pose is None:
        return []
    group, flow = orbit.system.group, flow if flow is not None and flow.canonical_pose is not None else None
    if strip_of(orbit.system) is not None:
        return [Panel(lambda axes: tracks.blade_track(orbit, axes=axes, flow=flow))]
    if group == SO(3):
        return [Panel(functools.partial(_body_axis, orbit, flow))]
    if group.size > 2 and group == SE(group.size - 1):
        projection = "3d" if group.size > 3 else None
        return [Panel(lambda axes: tracks.point_track(orbit, axes=axes, flow=flow), projection=projection)]
    return []


def _momentum(orbit: Orbit, flow: Orbit | None) -> list[Panel]:
    system, directions = orbit.system, orbit.system.rank
    if directions == 0:
        return []
    is_free_in_body = not (system.is_forced or system.is_spatial)
    if is_free_in_body and directions == 2:
        return [Panel(lambda axes: phase_portrait(cast(AbstractLLSystem, system), orbit, axes=axes))]
    if is_free_in_body and directions == 3:
        return [Panel(lambda axes: spheres.momentum_sphere(orbit, axes=axes))]
    return [_components(orbit, flow)]


def _components(orbit: Orbit, flow: Orbit | None) -> Panel:
    return Panel(lambda axes: time_series.momentum_components(orbit, axes, flow), is_timed=True)


def _body_axis(orbit: Orbit, flow: Orbit | None, axes: Axes) -> None:
    spheres.body_axis_track(orbit, axes=axes, flow=flow)
    tensor: Any = orbit.system.homogeneous_mass_tensor
    if tensor is None:
        return
    cells = [[f"{number:.3g}".replace("-", "\u2212") for number in row] for row in np.asarray(tensor) + 0.0]
    width = max(len(cell) for row in cells for cell in row)
    lines = ["  ".join(cell.rjust(width) for cell in row) for row in cells]
    text = f"    \u23a1{lines[0]}\u23a4\nJ = \u23a2{lines[1]}\u23a5\n    \u23a3{lines[2]}\u23a6"
    look: Any = {"family": "monospace", "fontsize": "medium", "linespacing": 1.05, "color": theme.QUIET}
    axes.text(0.0, 0.0, text, transform=axes.transAxes, **look)


def _velocity(orbit: Orbit, flow: Orbit | None, axes: Axes) -> None:
    has_heading = strip_of(orbit.system) is not None and orbit.canonical_pose is not None
    if flow is not None and flow.canonical_pose is None and (has_heading or orbit.system.is_spatial):
        flow = None
    (time_series.heading_and_speed if has_heading else time_series.velocity_components)(orbit, axes, flow)


def _facts(orbit: AbstractOrbit) -> list[str]:
    run, step = f"from time {orbit.time[0]:g} to {orbit.time[-1]:g}", orbit.time_step
    if orbit.is_measured:
        run = f"{len(orbit):,} given poses {run}".replace(",", "\u2009")
    elif step is None:
        run = f"continuous flow {run}"
    else:
        steps = int(orbit.step[-1] - orbit.step[0])
        run = f"{steps:,} step{'s' * (steps != 1)} of $h$ = {step:g}".replace(",", "\u2009")
    end = [] if orbit.outcome == Outcome.successful else [f"stopped: {orbit.outcome}"]
    if isinstance(orbit, Orbit):
        return [_parameters(orbit.system.inside), run, *end]
    names = [coordinates.symbol(name) for name in orbit.coordinates]
    where = ", ".join(names if len(names) <= 7 else [*names[:3], "...", names[-1]]) or str(orbit.space)
    s = orbit.system.constraints
    return [f"{where},  {s or 'no'} constraint{'s' * (s != 1)}", run, *end]


def name_of(orbit: AbstractOrbit) -> str:
    """Return what moves, in words."""
    return _name_of_body(orbit.system) if isinstance(orbit, Orbit) else orbit.system.name


_NAMES = {  # by is_sleigh and is_planar: of its own class, and of an LLSystem that equals one
    (True, True): ("Chaplygin sleigh", "a sleigh in the plane"),
    (True, False): ("Multidimensional sleigh", "a multidimensional sleigh"),
    **dict.fromkeys([(False, True), (False, False)], ("Suslov top", "a Suslov top")),
}


def _name_of_body(system: System) -> str:
    if system.is_forced:
        return f"{_name_of_body(system.inside)}, under forces"
    if (form := system.normal_form) is not None:
        name, synonym = _NAMES[form.is_sleigh, form.is_planar]
        return f"LLSystem, {synonym}" if type(system) is LLSystem else name
    if system.homogeneous_mass_tensor is not None and system.group.is_rigid:
        if is_free(system):
            return "Free rigid body"
        in_body = LLSystem(system.group, system.homogeneous_mass_tensor, system.constraint_subspace).normal_form
        if system.is_spatial and in_body is not None and not in_body.is_sleigh:
            return "Veselova top"
    return f"System with a {('left', 'right')[system.is_spatial]}-invariant constraint"


def _parameters(system: System) -> str:
    if (sheet := sheet_of(system)) is not None:
        return sheet.facts(system)
    free, all_directions = system.rank, system.group.dim
    if free == all_directions:
        return f"{system.group},  no constraint"
    side = "space" if system.is_spatial else "the body"
    return f"{system.group},  {free} of {all_directions} directions of velocity allowed, fixed in {side}"


_LARGER = 2.2  # times as high as a panel against time


@theme.in_style
def overview(
    orbit: AbstractOrbit,
    path: str | Path | None = None,
    flow: AbstractOrbit | None = None,
    *,
    overwrite: bool = False,
    **look: Unpack[theme.Look],
) -> Figure:
    """Draw an orbit of any system: its path in space, its momentum, its velocity and the error of its energy.

    The path is that of a body axis on SO(3), of the blade of a sleigh, of the reference point on SE(n); other groups,
    and orbits without poses, have none. Momenta along the constraint are drawn as a phase portrait where they are two,
    on their energy sphere where they are three, against time otherwise; velocities where they are at most 60. With a
    right-invariant constraint velocity and energy need poses, and are left out without them. Color is time in all
    panels; the strip under a panel against time is the key.

    Of a Lagrange-d'Alembert system there are its path, where coordinates named x and y, or a group, give its place,
    the other coordinates, velocities, the error of the energy and the residual of the constraint.

    Args:
        orbit: An orbit of any system, discrete or continuous.
        path: Where to save the figure, a new file; the suffix (.png, .svg, .pdf) chooses the format.
        flow: The continuous motion from the same initial data, drawn beside a discrete orbit.
        overwrite: Replace an older picture at the path.
        **look: Title, label, color and more: `nh.plot.Look`.

    Raises:
        FileExistsError: The path exists, and is not to be replaced.
        ValueError: No orbit, one without states, or a suffix that is not a picture format.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
        >>> orbit = nh.simulate(sleigh, body_velocity=(1, 0, 0), steps=50)
        >>> [axes.get_title(loc="left") for axes in nh.plot.overview(orbit).axes[:2]]
        ['Track of the blade', 'Phase portrait']
    """
    smooth = drawable_in_time("overview(orbit=...)", orbit)
    flow = same_space("overview(flow=...)", flow, orbit)
    figure = new_page("overview", (13.0, 7.6), path, overwrite=overwrite)
    panels = (_of_body if isinstance(smooth, Orbit) else _in_coordinates)(smooth, cast(Any, flow))
    axes = _axes(figure, panels)
    for panel, own in zip(panels, axes, strict=True):
        theme.begin(own)
        panel.draw(own)
        if panel.is_timed:
            own.set_xlabel("time")
    panels_in_time = [own for panel, own in zip(panels[1:], axes[1:], strict=True) if panel.is_timed]
    for own in panels_in_time[:-1]:  # the lowest has the times of all
        own.sharex(panels_in_time[-1])
        own.set_xlabel("")
        own.tick_params(labelbottom=False)
    return finish_page(figure, name_of(orbit), _facts(orbit), path)


def _axes(figure: Figure, panels: list[Panel]) -> list[Axes]:
    """Return the large axes on the left and the others on the right, those against time lower."""
    first, *others = panels
    if not others:
        return [figure.add_subplot(projection=first.projection)]
    heights = [1.0 if panel.is_timed else _LARGER for panel in others]
    grid = figure.add_gridspec(len(others), 2, width_ratios=(1.3, 1.0), height_ratios=heights)
    places = (grid[:, 0], *(grid[row, 1] for row in range(len(others))))
    return [figure.add_subplot(place, projection=each.projection) for place, each in zip(places, panels, strict=True)]
