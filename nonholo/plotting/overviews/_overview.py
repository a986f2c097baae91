"""The picture of an orbit: its panels in one figure with a head, for the screen, a slide or a page."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from nonholo.base.checks import error
from nonholo.base.checks import path as checked_path
from nonholo.io import check_file
from nonholo.orbit import Orbit
from nonholo.plotting import theme
from nonholo.plotting.overviews._head import write_head
from nonholo.plotting.overviews._panels import Panel, panels_of
from nonholo.plotting.parts import drawable

_SIZE = (13.0, 7.6)
_LARGER = 2.2  # times as high as a panel against time
_SMOOTH = 1000  # states of a flow, in which a curve has no corners


@theme.styled
def overview(
    orbit: Orbit, path: str | Path | None = None, flow: Orbit | None = None, *, overwrite: bool = False
) -> Figure:
    """Draw an orbit of any system: its path in space, its momentum, its velocity and the error of its energy.

    The path is that of a body axis on SO(3), of the blade of a sleigh, of the reference point on SE(n); other groups,
    and orbits without poses, have none. Momenta along the constraint are drawn as a phase portrait where they are two,
    on their energy sphere where they are three, against time otherwise. With a right-invariant constraint velocity and
    energy need poses, and are left out without them. Color is time in all panels; the strip under a panel against time
    is the key.

    Args:
        orbit: An orbit of any system, discrete or continuous.
        path: Where to save the figure, a new file; the suffix (.png, .svg, .pdf) chooses the format.
        flow: The continuous motion from the same initial data, drawn beside a discrete orbit.
        overwrite: Replace an older picture at the path.

    Raises:
        FileExistsError: The path exists, and is not to be replaced.
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
        check_file(path, overwrite=overwrite, where="overview(path=...)")
    panels = panels_of(_smooth(orbit), None if flow is None else _smooth(flow))
    axes = _axes(figure, panels)
    for panel, own in zip(panels, axes, strict=True):
        panel.draw(own)
    if panels[0].is_timed:
        axes[0].set_xlabel("time")
    _share_time([own for panel, own in zip(panels[1:], axes[1:], strict=True) if panel.is_timed])
    write_head(figure, orbit)
    if path is not None:
        figure.savefig(path)
    return figure


def _smooth(orbit: Orbit) -> Orbit:
    """Return a flow that knows its states between the saved ones with enough for curves; others as they are."""
    if orbit.motion.span is None or not 1 < len(orbit) < _SMOOTH:
        return orbit
    more = np.linspace(orbit.time[0], orbit.time[-1], _SMOOTH)
    times = np.union1d(orbit.time, more)
    return orbit.at(times if more[-1] > more[0] else times[::-1])


def check_suffix(figure: Figure, path: str | Path) -> None:
    """Refuse a path whose suffix is no picture format."""
    known = figure.canvas.get_supported_filetypes()
    if checked_path("overview(path=...)", path).suffix[1:].lower() not in known:
        remedy = "Use a path that ends in .png, .svg or .pdf."
        raise error("overview(path=...)", "end in a picture format", f"{str(path)!r}", remedy)


def _axes(figure: Figure, panels: list[Panel]) -> list[Axes]:
    """Return the large axes on the left and the others on the right, those against time lower."""
    first, *others = panels
    heights = [1.0 if panel.is_timed else _LARGER for panel in others]
    if len(heights) == 0:
        return [figure.add_subplot(projection=first.projection)]
    grid = figure.add_gridspec(len(others), 2, width_ratios=(1.3, 1.0), height_ratios=heights)
    large = figure.add_subplot(grid[:, 0], projection=first.projection)
    return [large, *(figure.add_subplot(grid[row, 1], projection=each.projection) for row, each in enumerate(others))]


def _share_time(panels: list[Axes]) -> None:
    if not panels:
        return
    *upper, lowest = panels
    lowest.set_xlabel("time")
    for axes in upper:
        axes.sharex(lowest)
        axes.tick_params(labelbottom=False)
