"""The momentum locus in space and cut by a plane; the variety of displacements, foliated by its energy levels."""

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple, Unpack, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection
from matplotlib.contour import QuadContourSet
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Line3D, Path3DCollection, Poly3DCollection
from mpl_toolkits.mplot3d.axes3d import Axes3D

from nonholo import analysis
from nonholo.analysis import InvariantCurve, MomentumLocus, invariant_curve
from nonholo.analysis.planar import planar_map
from nonholo.base.checks import array, checked_energies, error, instance, pair, refuse_given, shown
from nonholo.base.types import Array, Float
from nonholo.discrete import Discretization
from nonholo.orbit import Orbit
from nonholo.plot import theme
from nonholo.plot.parts import draw_equilibria, draw_in_time, draw_orbit, evenly_in_box, own_orbit
from nonholo.plot.sheets import Sheet, draw_level, draw_surface, sheet_of, spans
from nonholo.plot.sphere import View
from nonholo.systems import AbstractLLSystem

_MOST_DOTS = 600
_WHISKER = 0.22  # of the length of its segment
_VIEW = (25.0, -52.0)  # elevation and azimuth
_AZIMUTHS = np.arange(-70.0, -24.0, 5.0)  # of a top


class MomentumLocusPicture(NamedTuple):
    """The artists of `momentum_locus`; None where there was nothing to draw.

    Attributes:
        axes: The axes in space.
        surface: The mesh.
        double_lines: Segments along which the surface meets itself.
        whiskers: Pieces of the same lines where the equation holds, off the surface.
        pinch_points: Ends of the segments.
        triple_point: Where three segments meet.
        curves: The components of the curve of one energy.
        rest: Momentum zero, the momentum of the identity.
        orbit: The momenta of a discrete orbit, colored by time.
    """

    axes: Axes3D
    surface: Poly3DCollection
    double_lines: tuple[Line3D, ...]
    whiskers: tuple[Line3D, ...]
    pinch_points: Path3DCollection | None
    triple_point: Path3DCollection | None
    curves: tuple[Line3D, ...]
    rest: Path3DCollection | None
    orbit: Path3DCollection | None


@theme.in_style
def momentum_locus(
    locus: MomentumLocus | Discretization,
    orbit: Orbit | None = None,
    curve: InvariantCurve | None = None,
    axes: Axes3D | None = None,
    view: tuple[float, float] | None = None,
    **look: Unpack[theme.Look],
) -> MomentumLocusPicture:
    """Draw the surface of discrete momenta, where it meets itself, where it is pinched, and an orbit that runs on it.

    Lines along which the surface meets itself are solid between their pinch points and dashed beyond: there the
    equation of the surface still holds, but no real displacement has such a momentum. Axes are components of the body
    momentum, each with its own scale; for a sleigh the angular momentum is that about the center of mass.

    Reference: [fedorov-zenkov-2004], equation (Steiner).

    Args:
        locus: The result of `nh.momentum_locus`, or the discretization of which it is computed.
        orbit: A discrete orbit of the same system.
        curve: The result of `nh.invariant_curve`: all momenta of one energy, on the surface.
        axes: Axes in space; new ones by default.
        view: Elevation and azimuth of the eye in degrees.
        **look: Title, label, color and more: `nh.plot.Look`.

    Raises:
        ValueError: No locus, an orbit of another discretization.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.5)
        >>> picture = nh.plot.momentum_locus(nh.momentum_locus(sleigh, resolution=20))
        >>> len(picture.double_lines), len(picture.whiskers)
        (1, 2)
    """
    where = "plot.momentum_locus"
    locus = _locus_of(where, locus)
    own_orbit(f"{where}(orbit=...)", orbit, locus.discrete)
    space: Any = axes
    if space is None:
        space = theme.new_figure((7.2, 6.4), None).add_axes((-0.02, 0.01, 0.94, 0.97), projection="3d")
    theme.begin(space)
    sheet = cast(Sheet, sheet_of(locus.discrete.system))
    components = sheet.locus_map()
    if curve is not None:
        instance(f"{where}(curve=...)", curve, InvariantCurve, "be an invariant curve", "Pass `invariant_curve`.")
    surface = draw_surface(space, locus.momentum @ components)
    singular: Any = {"color": theme.UNSTABLE}
    doubles = _lines(space, locus.double_lines @ components, "meets itself", linewidth=2.6, **singular)
    outside = locus.whiskers(_WHISKER) @ components
    whiskers = _lines(space, outside, "equation alone", linewidth=1.6, dashes=(3, 2), **singular)
    pinch = _dots(space, locus.pinch_points @ components, s=44, facecolors=theme.PAPER, label="pinch points")
    triple = None if locus.triple_point is None else locus.triple_point[None] @ components
    triple_dot = _dots(space, triple, s=64, facecolors=theme.INK, marker="D", label="triple point")
    rest = space.scatter(0.0, 0.0, 0.0, s=26, color=theme.INK, depthshade=False, label="rest")
    momenta = () if curve is None else (points @ components for points in curve.momentum)
    curves = _lines(space, momenta, "one energy", color=theme.DISCRETE, linewidth=1.3, zorder=7)
    path = None
    if orbit is not None:
        states = evenly_in_box(orbit.reduced_momentum, _MOST_DOTS)
        path = draw_in_time(space, orbit, orbit.momentum @ components, states, zorder=8, size=24, label="orbit")
    _dress(space, locus, sheet, view)
    return MomentumLocusPicture(space, surface, doubles, whiskers, pinch, triple_dot, curves, rest, path)


def _locus_of(where: str, locus: Any) -> MomentumLocus:
    """Return a locus, that of a discretization if it is one."""
    if isinstance(locus, Discretization):
        return analysis.momentum_locus(locus)
    remedy = "Pass what `nh.momentum_locus` or `nh.discretize` returned."
    return instance(f"{where}(locus=...)", locus, MomentumLocus, "be a locus", remedy)


def _lines(axes: Any, curves: Iterable[Float[np.ndarray, "K 3"]], label: str, **look: Any) -> tuple[Any, ...]:
    """Draw lines of one look; the first one has the label."""
    lines = tuple(axes.plot(*points.T, **look)[0] for points in curves)
    for line in lines[:1]:
        line.set_label(label)
    return lines


def _dots(axes: Any, points: Float[np.ndarray, "L 3"] | None, **look: Any) -> Any:
    if points is None or len(points) == 0:
        return None
    return axes.scatter(*points.T, linewidths=1.5, depthshade=False, edgecolors=theme.UNSTABLE, zorder=9, **look)


def _dress(axes: Any, locus: MomentumLocus, sheet: Sheet, view: tuple[float, float] | None) -> None:
    across, deep, up = sheet.locus_labels
    axes.set(xlabel=across, ylabel=deep, zlabel=up)
    components = locus.momentum @ sheet.locus_map()
    span = spans(components)[2]
    if np.ptp(components[..., 2]) < span:
        axes.set_zlim(-span / 4, span / 4)
    axes.view_init(*(_best_view(locus) if view is None else pair("plot.momentum_locus(view=...)", view)))
    axes.set_box_aspect((1.0, 1.0, 0.85), zoom=1.0)
    axes.computed_zorder = False
    axes.grid(False)
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_pane_color((0.0, 0.0, 0.0, 0.0))
        axis.set_major_locator(MaxNLocator(4))
        axis.line.set_color(theme.MUTED)
    theme.write_title(axes, f"Momentum locus: {sheet.locus_kind(locus)}", x=0.03, y=0.95)
    theme.legend(axes, loc="upper right", bbox_to_anchor=(1.02, 1.0))


def _best_view(locus: MomentumLocus) -> tuple[float, float]:
    """Return a view that sees the double segments of a top well apart."""
    if len(locus.double_lines) < 3:
        return _VIEW
    along = np.diff(locus.double_lines, axis=1)[:, 0] / spans(locus.momentum)

    def apart(azimuth: float) -> float:
        flat = View(azimuth, _VIEW[0])(along)[0]
        flat = flat / np.linalg.norm(flat, axis=1, keepdims=True)
        return float(1 - np.abs(flat @ flat.T - np.eye(3)).max())

    return _VIEW[0], float(max(_AZIMUTHS, key=apart))


_GRID = 501
_LONG_WHISKER = 3.0  # how far whiskers are followed, in lengths of their segments
_MARGIN = 0.06


class LocusSection(NamedTuple):
    """The artists of `locus_section`; None where there was nothing to draw.

    Attributes:
        axes: The axes.
        curve: The section, where the polynomial of the locus vanishes.
        plane: Two orthonormal rows: the directions across and up.
        crossings: Points where the section crosses itself: of the double segments.
        isolated: Points where the polynomial vanishes alone: of the whiskers.
    """

    axes: Axes
    curve: QuadContourSet
    plane: Float[np.ndarray, "2 3"]
    crossings: PathCollection | None
    isolated: PathCollection | None


@theme.in_style
def locus_section(
    locus: MomentumLocus | Discretization,
    normal: Array = (0.0, 0.0, 1.0),
    offset: Array = 0.0,
    axes: Axes | None = None,
    **look: Unpack[theme.Look],
) -> LocusSection:
    r"""Draw the section of the momentum locus by the plane $n\cdot P = $ `offset`, n the unit vector along `normal`.

    A double segment that meets the plane gives a crossing, a whisker an isolated point, which belongs to the zeros of
    the polynomial but not to the locus.

    Args:
        locus: The result of `nh.momentum_locus`, or the discretization of which it is computed.
        normal: Three components of the body momentum, not all zero.
        offset: The component of the momentum along the normal.
        axes: Where to draw; a new figure by default.
        **look: Title, label, color and more: `nh.plot.Look`.

    Raises:
        ValueError: No locus, a normal that is zero, an offset that is no number.

    Example:
        >>> top = nh.discretize(nh.SuslovTop(np.diag([1.0, 2.0, 3.0])), 0.5)
        >>> section = nh.plot.locus_section(nh.momentum_locus(top), normal=(0, 0, 1), offset=0.5)
        >>> len(section.crossings.get_offsets())
        1
    """
    where = "plot.locus_section"
    locus = _locus_of(where, locus)
    if not np.any(n := array(f"{where}(normal=...)", normal, (3,), "Pass three components.")):
        raise error(f"{where}(normal=...)", "not be zero", "0, 0, 0", "Pass a direction.")
    n = n / np.linalg.norm(n)
    height = float(array(f"{where}(offset=...)", offset, (), "Pass one number."))
    first = np.eye(3)[np.argmin(np.abs(n))]  # the coordinate direction least along the normal, made orthogonal
    first = first - (first @ n) * n
    first /= np.linalg.norm(first)
    plane = np.stack([first, np.cross(n, first)])
    axes = theme.axes_or_new(axes, (6.0, 5.6))
    curve = _curve(axes, locus, plane, height * n)
    crossings = _meeting(axes, locus.double_lines, plane, n, height, color=theme.UNSTABLE, label="crosses itself")
    empty: Any = {"facecolors": theme.PAPER, "edgecolors": theme.UNSTABLE, "linewidths": 1.5}
    alone = _meeting(axes, locus.whiskers(_LONG_WHISKER), plane, n, height, label="equation alone", **empty)
    names = cast(Sheet, sheet_of(locus.discrete.system)).component_names
    across, up, along_normal = (_words(row, names) for row in (*plane, n))
    axes.set(xlabel=across, ylabel=up, adjustable="datalim", aspect="equal")
    theme.legend_above(axes, f"Section  {along_normal} = {height:g}")
    return LocusSection(axes, curve, plane, crossings, alone)


def _curve(axes: Axes, locus: MomentumLocus, plane: np.ndarray, foot: np.ndarray) -> QuadContourSet:
    flat = locus.momentum.reshape(-1, 3) @ plane.T
    low, high = flat.min(axis=0), flat.max(axis=0)
    room = _MARGIN * (high - low)
    across, up = (np.linspace(*ends, _GRID) for ends in zip(low - room, high + room, strict=True))
    x, y = np.meshgrid(across, up)
    own = theme.own_look(theme.DISCRETE)
    axes.plot([], [], **own)
    values = locus.implicit(foot + np.stack([x, y], axis=-1) @ plane)
    return axes.contour(x, y, values, levels=[0.0], colors=[own["color"]], linewidths=1.8, zorder=2)


def _meeting(
    axes: Axes, segments: Float[np.ndarray, "L 2 3"], plane: np.ndarray, n: np.ndarray, height: float, **look: Any
) -> PathCollection | None:
    """Mark the points where segments meet the plane."""
    first, last = segments[:, 0] @ n - height, segments[:, 1] @ n - height
    if not np.any(meets := first * last < 0):
        return None
    part = (first / np.where(meets, first - last, 1.0))[meets, None]
    points = segments[meets, 0] + part * (segments[meets, 1] - segments[meets, 0])
    return axes.scatter(*(points @ plane.T).T, s=40, zorder=4, **look)


def _words(row: Float[np.ndarray, "3"], names: tuple[str, ...]) -> str:
    """Return a linear combination of the momentum's components in words."""
    terms = []
    for x, name in zip(row, names, strict=True):
        if abs(x) > 1e-12:
            size = "" if abs(abs(x) - 1) < 1e-12 else f"{abs(x):.2g}\\,"
            terms.append(f"{'-' if x < 0 else '+'} {size}{name}")
    return f"${' '.join(terms).removeprefix('+ ')}$"


_POINTS = 300


class InvariantCurvesPicture(NamedTuple):
    """The artists of `invariant_curves`; None where there was nothing to draw.

    Attributes:
        axes: The axes.
        levels: The curves, for each energy.
        own: The curve of the orbit's energy.
        stable: Attracting equilibria on the curves, filled.
        unstable: Repelling equilibria, empty.
        orbit: The displacements of the orbit, colored by time.
    """

    axes: Axes
    levels: tuple[LineCollection, ...]
    own: LineCollection | None
    stable: PathCollection | None
    unstable: PathCollection | None
    orbit: PathCollection | None


@theme.in_style
def invariant_curves(
    discrete: Discretization | Sequence[InvariantCurve],
    orbit: Orbit | None = None,
    axes: Axes | None = None,
    energies: Any = None,
    **look: Unpack[theme.Look],
) -> InvariantCurvesPicture:
    r"""Draw the displacements, foliated by energy, with the equilibria and an orbit on its curve.

    For a top the variety is a disc: the radius is the step angle, the direction is u of the plane of rotation
    $u\wedge e_3$; opposite points of the rim, half-turns, are the same displacement and bear the same letter. For a
    sleigh it is the strip of the step angle $\Delta$ and the translation $\nu$ along the chord; its left edge is its
    right edge upside down. An orbit jumps along its curve, from the repelling to the attracting equilibrium.

    Args:
        discrete: A top with n = 3 or a sleigh, discretized with "matrix" and "skew"; or curves of one, in a list, that
            `nh.invariant_curve` returned.
        orbit: An orbit of it.
        axes: Where to draw; a new figure by default.
        energies: Energies of the curves; by default nine, or those of the curves that are passed.
        **look: Title, label, color and more: `nh.plot.Look`.

    Raises:
        ValueError: Another system or discretization, an orbit of another one, energies that are not positive.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.5)
        >>> picture = nh.plot.invariant_curves(sleigh, energies=[1.0, 2.0])
        >>> len(picture.levels), len(picture.stable.get_offsets())
        (2, 2)
    """
    where = "plot.invariant_curves"
    discrete, curves = _curves_of(where, discrete, energies)
    sheet = cast(Sheet, sheet_of(discrete.system))
    own_orbit(f"{where}(orbit=...)", orbit, discrete)
    axes = theme.axes_or_new(axes, (6.2, 6.0))
    levels = tuple(draw_level(axes, sheet, curve, color=theme.LEVEL, linewidth=1.1, zorder=1) for curve in curves)
    own = path = None
    if orbit is not None:
        curves = [invariant_curve(discrete, orbit[:1].energy[0], _POINTS)] if orbit.energy[0] > 0 else []
        for curve in curves:
            own = draw_level(axes, sheet, curve, color=theme.DISCRETE, linewidth=1.8, zorder=3, label="its energy")
        path = draw_orbit(axes, orbit, sheet.places(sheet.variety.points(orbit.displacement)))
    stable = unstable = None
    if cast(AbstractLLSystem, discrete.system).equilibria().attracting is not None:
        stable, unstable = draw_equilibria(axes, *sheet.attracting(curves), 40 if len(curves) == 1 else 22)
    theme.write_title(axes, "Displacements")
    sheet.dress(axes, curves, np.empty((0, 2)))
    return InvariantCurvesPicture(axes, levels, own, stable, unstable, path)


def _curves_of(where: str, value: Any, energies: Any) -> tuple[Discretization, list[InvariantCurve]]:
    """Return a map and curves of it: those that are passed, else those of the energies."""
    if not isinstance(value, list | tuple):
        discrete = planar_map(f"{where}(discrete=...)", value)[0]
        if energies is None:
            energies = cast(Sheet, sheet_of(discrete.system)).energies(float(discrete.time_step))
        wishes = checked_energies(f"{where}(energies=...)", energies)
        return discrete, [invariant_curve(discrete, energy, _POINTS) for energy in wishes]
    if not value or not all(isinstance(each, InvariantCurve) and each.discrete is value[0].discrete for each in value):
        remedy = "Pass a list of what `nh.invariant_curve` returned for one map."
        raise error(f"{where}(discrete=...)", "be curves of one discretization", shown(value), remedy)
    refuse_given(where, "be left out beside curves, which have theirs", "Pass `discrete`.", energies=(energies, None))
    return value[0].discrete, list(value)
