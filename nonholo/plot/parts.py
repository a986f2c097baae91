"""The common parts of pictures: which orbits and which of their states are drawn, marks, pages, enlarged corners.

Curves are thinned evenly along the drawn line, so that a short transition in a long run is not lost. Refusals say in
words which orbits are drawn. No mechanics.
"""

import weakref
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeAlias, cast

import numpy as np
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.backend_bases import FigureCanvasBase
from matplotlib.collections import LineCollection, PathCollection
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from mpl_toolkits.mplot3d.art3d import Line3DCollection

from nonholo.base.checks import checked_path, error, shown
from nonholo.base.types import Float, Int
from nonholo.discrete import Discretization
from nonholo.io.places import check_file, complete_file
from nonholo.orbit import AbstractOrbit, Orbit, any_orbit, as_orbit
from nonholo.plot import theme
from nonholo.systems import AbstractLLSystem, AbstractSystem, Equilibria, System, have_same_rows, refuse_fixed_in_space

MOST_DOTS = 1500  # of most pictures
_MOST_POINTS = 2000  # of a line


def evenly_spread(points: Float[np.ndarray, "K d"], most: int = MOST_DOTS) -> Int[np.ndarray, "L"]:
    """Return at most `most` + 2 indices, evenly along the polygon through the points, both ends kept.

    Example:
        >>> evenly_spread(np.array([[0.0], [0.0], [0.0], [1.0], [2.0]]), most=3).tolist()
        [0, 3, 4]
    """
    if len(points) <= most:
        return np.arange(len(points))
    distance = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    at = np.searchsorted(distance, np.linspace(0.0, distance[-1], most))
    return np.unique(np.concatenate([[0], at, [len(points) - 1]]))


def evenly_in_box(points: Float[np.ndarray, "K d"], most: int = MOST_DOTS) -> Int[np.ndarray, "L"]:
    """Do the same after scaling each coordinate to its own range, as axes do."""
    extent = np.ptp(points, axis=0)
    return evenly_spread(points / np.where(extent > 0, extent, 1.0), most)


def draw_line(axes: Axes, x: Float[np.ndarray, "K"], y: Float[np.ndarray, "K"], **look: Any) -> Any:
    """Draw a line of at most some thousand points, and of one state a dot."""
    at = evenly_in_box(np.stack([x, y], axis=1), _MOST_POINTS)
    return axes.plot(x[at], y[at], marker="o" if len(x) == 1 else None, **look)[0]


def some_states(orbit: Orbit, most: int) -> Orbit:
    """Return the orbit at about this many states, evenly in momentum and, as momentum may be conserved, in time."""
    evenly_in_time = np.linspace(0, len(orbit) - 1, min(most, len(orbit))).round().astype(int)
    return orbit.chosen(np.union1d(evenly_spread(orbit.reduced_momentum, most), evenly_in_time))


def transition(orbit: Orbit) -> int:
    """Return the state about which the momentum changes fastest; 0 if it does not change."""
    momentum = orbit.reduced_momentum
    change = np.abs(np.diff(momentum, axis=0)).sum(axis=1)
    moving = len(change) > 0 and change.max() > 1e-9 * np.abs(momentum).max(initial=0.0)
    return int(change.argmax()) if moving else 0


def turn_per_state(orbit: Orbit) -> float:
    """Return the largest angle, in radians, between saved states: greatest angular speed times distance in time."""
    if len(orbit) < 2:
        return 0.0
    speed = orbit.system.group.angle(some_states(orbit, 1000).body_velocity).max()
    return float(speed * np.abs(np.diff(orbit.time)).max())


def window(orbit: Orbit, step: float, finest: float, most: int) -> slice:
    """Return at most `most` states about the transition; they start at the first state if they can.

    Args:
        orbit: The orbit.
        step: The motion in a picture between two states.
        finest: The least motion between two of them.
        most: Number of states.
    """
    stride = max(1, int(finest / step)) if step > 0 else max(1, len(orbit) // most)
    if len(orbit) <= (span := stride * most):
        return slice(0, len(orbit), stride)
    first = min(max(0, transition(orbit) - span // 2), len(orbit) - span)
    return slice(first, first + span, stride)


def draw_in_time(
    axes: Any,
    orbit: AbstractOrbit,
    points: Float[np.ndarray, "K d"],
    states: Int[np.ndarray, "L"],
    *,
    zorder: float,
    size: float | None = None,
    label: str | None = None,
    whole: AbstractOrbit | None = None,
) -> Any:
    """Draw some states at their points in the colors of time: dots of a discrete orbit, a line of a flow.

    Args:
        axes: Where to draw.
        orbit: The orbit.
        points: A point of the plane or of space for each of its states.
        states: Which of them to draw.
        zorder: The layer.
        size: Area of the dots; by default by their number.
        label: Name of the dots; where it is given there are dots of any orbit.
        whole: The orbit whose colors these are, where `orbit` is a part of it.
    """
    points, time, own = points[states], orbit.time[states], theme.option("color", None)
    colors = {"cmap": theme.TIME, "norm": theme.time_scale(orbit if whole is None else whole)} if own is None else {}
    if label is not None or orbit.is_discrete:
        size = theme.dot_size(len(orbit)) if size is None else size
        name = theme.option("label", label or ("given poses" if orbit.is_measured else "discrete orbit"))
        colors |= {"c": time if own is None else [own], "label": name}
        return axes.scatter(*points.T, s=size, linewidths=0, zorder=zorder, **_flat(points), **colors)
    path = segments(points[:-1], points[1:], linewidth=2, zorder=zorder, **colors)
    path.set(label=theme.option("label", "flow"), **({"array": time[1:]} if own is None else {"color": own}))
    axes.add_collection(path)
    return path


def draw_orbit(axes: Axes, orbit: Orbit, places: Float[np.ndarray, "K 2"]) -> Any:
    """Draw the states of a discrete orbit at their places over a picture of its map, as larger dots."""
    size = theme.dot_size(len(orbit)) + 6
    return draw_in_time(axes, orbit, places, evenly_in_box(places), zorder=6, size=size, label="orbit")


def draw_flow(axes: Any, points: Float[np.ndarray, "K d"]) -> Any:
    """Draw the path of a continuous motion beside an orbit, as a thin line."""
    line = points[evenly_spread(points, 10 * MOST_DOTS)]
    return axes.plot(*line.T, color=theme.CONTINUOUS, linewidth=1.0, zorder=4, label="continuous")[0]


def segments(feet: Float[np.ndarray, "L d"], tips: Float[np.ndarray, "L d"], **look: Any) -> LineCollection:
    """Return segments of the plane or of space, from each foot to its tip."""
    kind = Line3DCollection if feet.shape[1] == 3 else LineCollection
    return kind(list(np.stack([feet, tips], axis=1)), **look)


def draw_ends(axes: Any, points: Float[np.ndarray, "K d"], orbit: AbstractOrbit) -> Any:
    """Mark the first point, empty, and the last one, in the colors of the first and the last state."""
    rim = theme.end_colors(orbit)
    look: Any = {"facecolors": [theme.PAPER, rim[1]], "edgecolors": rim, "linewidths": 1.6, "zorder": 7}
    return axes.scatter(*points[[0, -1]].T, s=44, **look, **_flat(points))


def draw_equilibria(
    axes: Axes, points: Float[np.ndarray, "E 2"], reach: Float[np.ndarray, "2"], size: float
) -> tuple[PathCollection, PathCollection]:
    """Draw attracting equilibria, filled, their opposites, empty, and the line of both through the origin."""
    axes.plot(*np.stack([0 * reach, reach], axis=1), color=theme.STABLE, linewidth=0.9, zorder=2)
    axes.plot(*np.stack([0 * reach, -reach], axis=1), color=theme.UNSTABLE, linewidth=0.9, dashes=(5, 3), zorder=2)
    stable = axes.scatter(*points.T, s=size, color=theme.STABLE, zorder=5, label="stable")
    empty: Any = {"facecolors": theme.PAPER, "edgecolors": theme.UNSTABLE, "linewidths": 1.5}
    return stable, axes.scatter(*-points.T, s=size, zorder=5, label="unstable", **empty)


def _flat(points: Float[np.ndarray, "L d"]) -> dict[str, Any]:
    """Return what keeps dots in space from fading with their distance."""
    return {"depthshade": False} if points.shape[1] == 3 else {}


def new_page(where: str, size: tuple[float, float], path: str | Path | None, *, overwrite: bool) -> Figure:
    """Return a figure for a head and panels; a path where it cannot be saved is refused in the name of `where`."""
    if path is not None:
        check_picture(path, overwrite=overwrite, where=f"{where}(path=...)")
    return theme.new_figure(size)


def check_picture(path: str | Path, *, overwrite: bool, where: str) -> None:
    """Refuse, in the name of `where`, a path at which no picture can be saved."""
    if checked_path(where, path).suffix[1:].lower() not in FigureCanvasBase.get_supported_filetypes():
        remedy = "Use a path that ends in .png, .svg or .pdf."
        raise error(where, "end in a picture format", f"{str(path)!r}", remedy)
    check_file(path, overwrite=overwrite, where=where)


def finish_page(figure: Figure, title: str, facts: list[str], path: str | Path | None) -> Figure:
    """Write the head above the panels, with the given title, and save the figure."""
    line = rcParams["font.size"] / 72 / figure.get_figheight()  # in parts of the figure
    title = theme.option("title", title)
    figure.text(0.012, 0.985, title, va="top", fontsize="xx-large", fontweight="bold")
    below = 0.985 - 2.8 * line * bool(title)
    if theme.option("annotate", True):
        figure.text(0.012, below, "      ".join(facts).replace("-", "\u2212"), va="top", color=theme.QUIET)
        below -= 1.6 * line
    figure.set_layout_engine(ConstrainedLayoutEngine(rect=(0.004, 0.004, 0.992, below), hspace=0.05, wspace=0.03))
    if path is not None:
        with complete_file(Path(path)) as part:
            figure.savefig(part)
    return figure


Square: TypeAlias = Float[np.ndarray, "2 2"]  # rows (x_min, x_max), (y_min, y_max)
_DETAILS: weakref.WeakKeyDictionary[Axes, tuple[Any, Any]] = weakref.WeakKeyDictionary()

_SMALL = 0.2  # a turn below this part of the picture is shown enlarged as a whole, else its cusp is
_NEAR_CUSP = 0.055  # part of the picture, to either side
_SIZE, _MARGIN = 0.40, 0.07  # of the enlarged detail, in parts of the picture


def fit_view(axes: Axes, points: Float[np.ndarray, "K 2"], names: Sequence[str] = ("$x$", "$y$")) -> Square:
    """Let axes of one scale show the points, as large as their shape allows, with all that they show already."""
    box, square = axes.get_window_extent(), square_about(points)
    wide, extent = max(1.0, box.width / box.height), np.ptp(points, axis=0)
    half = 0.57 * max(extent[1], extent[0] / wide) * np.array([wide, 1.0])
    view = square if not half.any() else square.mean(axis=1)[:, None] + half[:, None] * [-1.0, 1.0]
    axes.margins(0.0)
    axes.update_datalim(view.T)
    axes.autoscale_view()
    axes.set(xlabel=names[0], ylabel=names[1], aspect="equal")
    return view


def square_about(points: Float[np.ndarray, "K d"]) -> Float[np.ndarray, "d 2"]:
    """Return a square with a margin about the points.

    Example:
        >>> square_about(np.array([[0.0, 0.0], [2.0, 1.0]])).round(2)
        array([[-0.14,  2.14],
               [-0.64,  1.64]])
    """
    low, high = points.min(axis=0), points.max(axis=0)
    reach = 0.57 * float((high - low).max()) or 1.0
    center = (low + high) / 2
    return np.stack([center - reach, center + reach], axis=1)


def detail(
    position: Float[np.ndarray, "K 2"], turning: Float[np.ndarray, "K"], cusp: Float[np.ndarray, "2"], view: Square
) -> tuple[slice, Square]:
    """Return the states and the square to enlarge: the turn, if it is small in the picture, else what is near the cusp.

    Args:
        position: Points of the curve.
        turning: Angular velocities there.
        cusp: A cusp of the curve.
        view: The view of the picture.
    """
    fast = np.flatnonzero(np.abs(turning) > 0.1 * np.abs(turning).max())
    turn = slice(fast[0], fast[-1] + 1)
    square = square_about(position[turn])
    side = np.ptp(view, axis=1).min()
    if np.ptp(square[0]) <= _SMALL * side:
        return turn, square
    reach = _NEAR_CUSP * side
    near = np.flatnonzero(np.abs(position - cusp).max(axis=1) < 1.5 * reach)
    return slice(near[0], near[-1] + 1), np.stack([cusp - reach, cusp + reach], axis=1)


def remove_detail(axes: Axes) -> None:
    """Remove the detail of a track to which another one comes."""
    for artist in _DETAILS.pop(axes, ()):
        artist.remove()


def corner_axes(axes: Axes, track: Float[np.ndarray, "L 2"], view: Square, near: Square) -> Axes:
    """Return axes that show the square `near` in the corner of `axes` where the fewest points are drawn."""
    points = (track - view[:, 0]) / np.ptp(view, axis=1)
    corners = [(x, y) for y in (0.95 - _SIZE, 0.02) for x in (0.98 - _SIZE, 0.02)]
    crowd = [np.sum(np.abs(points - corner - _SIZE / 2).max(axis=1) < _SIZE / 2 + _MARGIN) for corner in corners]
    inset = axes.inset_axes((*corners[int(np.argmin(crowd))], _SIZE, _SIZE), zorder=10)
    inset.set(xlim=near[0], ylim=near[1], xticks=[], yticks=[], aspect="equal", autoscale_on=False)
    inset.spines[:].set(visible=True, color=theme.MUTED)
    times = _SIZE * np.ptp(view, axis=1).min() / np.ptp(near[0])
    look: Any = {"loc": "left", "fontsize": "medium", "fontweight": "normal", "pad": 4}
    inset.set_title(f"enlarged {times:.{0 if times >= 9.5 else 1}f} times", **look)
    frame = axes.indicate_inset_zoom(inset, edgecolor=theme.MUTED, alpha=0.8)
    _DETAILS[axes] = inset, frame
    for connector in frame.connectors or ():
        connector.set_visible(False)
    return inset


_SMOOTH = 1000  # states of a flow, in which a curve has no corners
_ROUNDING = 1e-12  # relative
_SEEN = 1e-5  # of the extent of a path


def drawable(where: str, orbit: Any) -> Orbit:
    """Return the same of an orbit on a group."""
    as_orbit(where, orbit, "for one in coordinates use `overview` and `energy_error`.")
    return drawable_in_time(where, orbit)


def drawable_in_time(where: str, orbit: Any) -> Any:
    """Return an orbit of any kind with at least one state; a flow that knows those between with enough for a curve."""
    if len(any_orbit(where, orbit)) == 0:
        raise error(where, "have a state to draw", "none", "`orbit.outcome` has the reason.")
    if orbit.span is None or not 1 < len(orbit) < _SMOOTH:
        return orbit
    more = np.linspace(orbit.time[0], orbit.time[-1], _SMOOTH)
    times = np.union1d(orbit.time, more)
    return orbit.at(times if more[-1] > more[0] else times[::-1])


def orbit_with_poses(where: str, orbit: Any) -> Orbit:
    """Return the same of an orbit with poses."""
    orbit = drawable(where, orbit)
    if orbit.canonical_pose is None:
        raise error(where, "have poses", "an orbit without them", "Run with reconstruct=True.")
    return orbit


def same_space(where: str, flow: Any, orbit: AbstractOrbit, ready: Callable[..., Any] = drawable_in_time) -> Any:
    """Return the same of an orbit, if there is one, that moves in the same space as the orbit it is drawn beside."""
    if flow is not None and (flow := ready(where, flow)).space != orbit.space:
        raise error(where, f"move in {orbit.space}", f"{flow.space}", "Pass a motion of the same system.")
    return flow


def is_free(system: System) -> bool:
    """Return whether nothing constrains the body or acts on it, whose spatial momentum is then conserved."""
    return system.rank == system.group.dim and not system.is_forced


def forbidden_axis(system: AbstractSystem) -> Float[np.ndarray, "3"] | None:
    """Return the body axis about which a body on SO(3) does not turn; None if there is not one."""
    if system.is_spatial or system.rank != 2:
        return None
    axis = system.annihilator[0]
    return axis / np.linalg.norm(axis)


def check_directions(where: str, value: Any, system: AbstractSystem, number: tuple[int, str], remedy: str) -> None:
    """Refuse a constraint fixed in space, and another number of admissible directions than a picture has."""
    elsewhere = "Its momenta along the constraint are conserved: draw `overview` instead."
    refuse_fixed_in_space(where, system, elsewhere, shown(value))
    if len(system.constraint_subspace) != number[0]:
        got = f"dimension {len(system.constraint_subspace)}"
        raise error(where, f"have a {number[1]}-dimensional constraint subspace", got, remedy)


def is_closed(points: Float[np.ndarray, "K d"]) -> bool:
    """Return whether a path ends where it starts, to what is seen of it."""
    return bool(np.abs(points[-1] - points[0]).max() <= _SEEN * np.ptp(points, axis=0).max())


def is_same_body(system: System, other: System) -> bool:
    """Return whether two systems have the same constraint and inertia, up to rounding, in any classes."""
    if (system.group, system.is_spatial, system.rank) != (other.group, other.is_spatial, other.rank):
        return False
    units = other.displacement_units
    each, inertia = (x.inertia_operator * units * units[:, None] for x in (system, other))
    return have_same_rows(system, other) and bool(np.abs(each - inertia).max() <= _ROUNDING * np.abs(inertia).max())


def own_orbit(where: str, orbit: Any, discrete: Discretization) -> None:
    """Refuse an orbit that belongs to another discretized system."""
    same = orbit is None or drawable(where, orbit).time_step == float(discrete.time_step)
    if orbit is not None and not (same and is_same_body(orbit.system, discrete.system)):
        raise error(where, "be an orbit of the same discretized system", shown(orbit), "Run `nh.simulate` with it.")


def known_equilibria(system: System) -> Equilibria | None:
    """Return the equilibria of a system; None where they are no linear space, or where the library has none."""
    if system.is_spatial or system.is_forced:
        return None
    try:
        equilibria = cast(AbstractLLSystem, system).equilibria()
    except ValueError:
        return None
    return None if equilibria.others else equilibria
