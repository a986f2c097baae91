"""The picture of an orbit: four panels in one figure, for the screen, a slide or a page."""

from pathlib import Path
from typing import cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from nonholo._checks import error
from nonholo._results import Outcome
from nonholo.orbit import Orbit
from nonholo.plotting import _theme as theme
from nonholo.plotting._blade_track import blade_track
from nonholo.plotting._body_axis_track import body_axis_track
from nonholo.plotting._energy_error import energy_error
from nonholo.plotting._phase_portrait import phase_portrait
from nonholo.plotting._subject import drawable, time_step
from nonholo.plotting._time_series import heading_and_speed, velocity_components
from nonholo.systems import AbstractLLSystem, ChaplyginSleigh, SuslovTop

_SIZE = (13.0, 7.6)


@theme.styled
def overview(orbit: Orbit, path: str | Path | None = None, flow: Orbit | None = None) -> Figure:
    """Draw the path in space, the phase portrait, the velocity and the energy error of an orbit in one figure.

    Colour is time in all panels; the strip under the velocity is the key. Without poses the phase portrait takes the
    place of the path.

    Args:
        orbit: An orbit of a top or a sleigh, discrete or continuous.
        path: Where to save the figure; the suffix (.png, .svg, .pdf) chooses the format.
        flow: The continuous motion from the same initial data, drawn beside a discrete orbit.

    Raises:
        ValueError: No orbit, one without states, or a suffix that is not a picture format.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
        >>> orbit = nh.simulate(sleigh, body_velocity=(1, 0, 0), steps=50)
        >>> [axes.get_title(loc="left") for axes in nh.plot.overview(orbit).axes[:2]]
        ['Track of the blade', 'Phase portrait']
    """
    drawable("overview(orbit=...)", orbit)
    if flow is not None:
        drawable("overview(flow=...)", flow)
    below_title = ConstrainedLayoutEngine(rect=(0.004, 0.004, 0.992, 0.905), hspace=0.05, wspace=0.03)
    figure = Figure(figsize=_SIZE, layout=below_title)
    if path is not None:
        check_suffix(figure, path)
    spatial = orbit.pose is not None and isinstance(orbit.system, (SuslovTop, ChaplyginSleigh))
    large, *small = _panels(figure, 3 if spatial else 2)
    if spatial:
        _path(orbit, large, flow)
        large = small.pop(0)
    phase_portrait(orbit.system, orbit, axes=large)
    _velocity(orbit, small[0], flow)
    energy_error(orbit, axes=small[1])
    _share_time(small)
    _title(figure, orbit)
    if path is not None:
        figure.savefig(path)
    return figure


def check_suffix(figure: Figure, path: str | Path) -> None:
    """Refuse a path whose suffix is no picture format."""
    known = figure.canvas.get_supported_filetypes()
    if Path(path).suffix[1:].lower() not in known:
        remedy = "Use a path that ends in .png, .svg or .pdf."
        raise error("overview(path=...)", "end in a picture format", f"{str(path)!r}", remedy)


def _panels(figure: Figure, rows: int) -> list[Axes]:
    """Return one large panel on the left and the small ones on the right."""
    heights = (2.2, 1.0, 1.0) if rows == 3 else (1.0, 1.0)
    grid = figure.add_gridspec(rows, 2, width_ratios=(1.3, 1.0), height_ratios=heights)
    return [figure.add_subplot(grid[:, 0]), *(figure.add_subplot(grid[row, 1]) for row in range(rows))]


def _path(orbit: Orbit, axes: Axes, flow: Orbit | None) -> None:
    posed = flow if flow is not None and flow.pose is not None else None
    if isinstance(orbit.system, ChaplyginSleigh):
        blade_track(orbit, axes=axes, flow=posed)
    else:
        body_axis_track(orbit, axes=axes, flow=posed)
        _show_mass_tensor(axes, cast(SuslovTop, orbit.system))


def _velocity(orbit: Orbit, axes: Axes, flow: Orbit | None) -> None:
    headed = isinstance(orbit.system, ChaplyginSleigh) and orbit.pose is not None
    if flow is not None and headed and flow.pose is None:
        flow = None
    (heading_and_speed if headed else velocity_components)(orbit, axes, flow)


def _share_time(panels: list[Axes]) -> None:
    upper, lower = panels
    upper.sharex(lower)
    upper.tick_params(labelbottom=False)


def _title(figure: Figure, orbit: Orbit) -> None:
    kind = {SuslovTop: "Suslov top", ChaplyginSleigh: "Chaplygin sleigh"}.get(type(orbit.system), "Orbit")
    figure.text(0.012, 0.985, kind, va="top", fontsize=17, fontweight="bold")
    figure.text(
        0.012, 0.934, "      ".join(_facts(orbit)).replace("-", "\u2212"), va="top", fontsize=10.5, color="#555a62"
    )


def _facts(orbit: Orbit) -> list[str]:
    step = time_step(orbit)
    if step is None:
        run = f"continuous flow from time {orbit.time[0]:g} to {orbit.time[-1]:g}"
    else:
        steps = (len(orbit) - 1) * orbit.save_every
        run = f"{steps:,} step{'s' * (steps != 1)} of $h$ = {step:g}".replace(",", "\u2009")
    stopped = [] if orbit.outcome == Outcome.successful else [f"stopped: {orbit.outcome}"]
    return [_parameters(orbit.system), run, *stopped]


def _parameters(system: AbstractLLSystem) -> str:
    if isinstance(system, ChaplyginSleigh):
        symbols = {"m": system.mass, "J": system.inertia, "a": system.a, "b": system.b}
        return ",  ".join(f"${symbol}$ = {float(value):.4g}" for symbol, value in symbols.items())
    if isinstance(system, SuslovTop):
        axis = ", ".join(f"{number:.3g}" for number in np.asarray(system.axis) + 0.0)
        return rf"SO(3),  $\langle\gamma,\omega\rangle = 0$  with  $\gamma$ = ({axis})"
    return repr(system)


def _show_mass_tensor(axes: Axes, system: SuslovTop) -> None:
    cells = [[f"{number:.3g}".replace("-", "\u2212") for number in row] for row in np.asarray(system.mass_tensor) + 0.0]
    width = max(len(cell) for row in cells for cell in row)
    lines = ["  ".join(cell.rjust(width) for cell in row) for row in cells]
    text = f"    \u23a1{lines[0]}\u23a4\nJ = \u23a2{lines[1]}\u23a5\n    \u23a3{lines[2]}\u23a6"
    axes.text(
        0.0, 0.0, text, transform=axes.transAxes, family="monospace", fontsize=9.5, linespacing=1.05, color="#555a62"
    )
