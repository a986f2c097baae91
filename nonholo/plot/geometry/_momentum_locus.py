"""The momentum locus in space: the translucent surface, its singular lines and points, an orbit on it."""

import dataclasses
from collections.abc import Iterable
from typing import Any, Unpack, cast

import numpy as np
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Line3D, Path3DCollection, Poly3DCollection
from mpl_toolkits.mplot3d.axes3d import Axes3D

from nonholo.analysis import InvariantCurve, MomentumLocus
from nonholo.base.checks import instance, pair
from nonholo.base.types import Float
from nonholo.orbit import Orbit
from nonholo.plot import theme
from nonholo.plot.elements import draw_surface, spans
from nonholo.plot.parts import View, draw_in_time, evenly_in_box, own_orbit
from nonholo.plot.sheets import AbstractSheet, sheet_of

_MOST_DOTS = 600
_WHISKER = 0.22  # of the length of its segment
_VIEW = (25.0, -52.0)  # elevation and azimuth
_AZIMUTHS = np.arange(-70.0, -24.0, 5.0)  # of a top


@dataclasses.dataclass(frozen=True)
class MomentumLocusPicture:
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


@theme.styled
def momentum_locus(
    locus: MomentumLocus,
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
        locus: What `nh.momentum_locus` returned.
        orbit: A discrete orbit of the same system.
        curve: What `nh.invariant_curve` returned: all momenta of one energy, on the surface.
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
    instance(f"{where}(locus=...)", locus, MomentumLocus, "be a locus", "Pass what `nh.momentum_locus` returned.")
    own_orbit(f"{where}(orbit=...)", orbit, locus.discrete)
    space: Any = axes
    if space is None:
        space = theme.new_figure((7.2, 6.4), None).add_axes((-0.02, 0.01, 0.94, 0.97), projection="3d")
    theme.begin(space)
    sheet = cast(AbstractSheet, sheet_of(locus.discrete.system))
    drawn = sheet.locus_map()
    if curve is not None:
        instance(f"{where}(curve=...)", curve, InvariantCurve, "be an invariant curve", "Pass `invariant_curve`.")
    surface = draw_surface(space, locus.momentum @ drawn)
    singular: Any = {"color": theme.UNSTABLE}
    doubles = _lines(space, locus.double_lines @ drawn, "meets itself", linewidth=2.6, **singular)
    outside = locus.whiskers(_WHISKER) @ drawn
    whiskers = _lines(space, outside, "equation alone", linewidth=1.6, dashes=(3, 2), **singular)
    pinch = _dots(space, locus.pinch_points @ drawn, s=44, facecolors=theme.PAPER, label="pinch points")
    triple = None if locus.triple_point is None else locus.triple_point[None] @ drawn
    triple_dot = _dots(space, triple, s=64, facecolors=theme.INK, marker="D", label="triple point")
    rest = space.scatter(0.0, 0.0, 0.0, s=26, color=theme.INK, depthshade=False, label="rest")
    momenta = () if curve is None else (points @ drawn for points in curve.momentum)
    curves = _lines(space, momenta, "one energy", color=theme.DISCRETE, linewidth=1.3, zorder=7)
    path = None
    if orbit is not None:
        states = evenly_in_box(orbit.reduced_momentum, _MOST_DOTS)
        path = draw_in_time(space, orbit, orbit.momentum @ drawn, states, zorder=8, size=24, label="orbit")
    _dress(space, locus, sheet, view)
    return MomentumLocusPicture(space, surface, doubles, whiskers, pinch, triple_dot, curves, rest, path)


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


def _dress(axes: Any, locus: MomentumLocus, sheet: AbstractSheet, view: tuple[float, float] | None) -> None:
    across, deep, up = sheet.locus_labels
    axes.set(xlabel=across, ylabel=deep, zlabel=up)
    drawn = locus.momentum @ sheet.locus_map()
    span = spans(drawn)[2]
    if np.ptp(drawn[..., 2]) < span:
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
