"""The curvature of a local connection over two shape variables: what a small gait around a shape gains, by its area."""

from typing import Any, NamedTuple, Unpack

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colorbar import Colorbar
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.lines import Line2D

from nonholo.analysis import GeometricPhase, LocalConnection
from nonholo.base.checks import array, choice, error, instance, pair, shown
from nonholo.base.types import Array, Float
from nonholo.plot import theme
from nonholo.plot.motion.coordinates import symbol

_POINTS = 121  # a side
_MARGIN = 0.3  # of the extent of a gait
_REACH = 1.2  # of each shape variable, by default
_REACHED = 3  # by the colors, in units of the median: near singular shapes values have no bound


class CurvaturePicture(NamedTuple):
    """The artists of `curvature`; None where there was nothing to draw.

    Attributes:
        axes: The axes.
        values: The map; cells without a connection are empty.
        zero: Where the curvature changes its sign.
        gait: The gait.
        colorbar: The key to the colors.
    """

    axes: Axes
    values: QuadMesh
    zero: Any
    gait: Line2D | None
    colorbar: Colorbar


@theme.in_style
def curvature(
    connection: LocalConnection,
    component: str = "omega",
    *,
    phase: GeometricPhase | None = None,
    along: Any = None,
    bounds: Any = None,
    shape: Any = None,
    axes: Axes | None = None,
    **look: Unpack[theme.Look],
) -> CurvaturePicture:
    r"""Draw a component of the curvature over two shape variables: $-F_{ij}$, what counterclockwise gaits gain.

    By the area rule the exponential coordinates of the displacement are the integral of these values inside the gait:
    blue is gained by going around it counterclockwise, orange lost. Gaits that keep to one side of the line of zeros,
    and fill it, move most.

    Args:
        connection: A `local_connection` with at least two shape variables.
        component: One of `connection.components`, those of the body velocity: in the plane "omega", "v1", "v2".
        phase: The result of `geometric_phase`, whose gait is drawn.
        along: Names of the two shape variables, i and j; by default the first two.
        bounds: The range of each, a pair of pairs; by default around the gait, without one from -1.2 to 1.2.
        shape: The values of all shape variables where others are fixed; by default those in the middle of the gait,
            without one zero.
        axes: Where to draw; a new figure by default.
        **look: Title, label, color and more: `nh.plot.Look`.

    Raises:
        ValueError: Not a local connection, fewer than two shape variables, unknown names, empty ranges, no regular
            shape in them.

    Example:
        >>> board = nh.local_connection(nh.examples.snakeboard().system)
        >>> picture = nh.plot.curvature(board, "v1")
        >>> picture.values.get_array().shape, picture.axes.get_xlabel()
        ((120, 120), '$\\psi$')
    """
    instance("plot.curvature(connection=...)", connection, LocalConnection, "be a local connection", "Call it first.")
    if len(names := connection.shape_coordinates) < 2:
        raise error("plot.curvature(connection=...)", "have two shape variables", shown(names), "One encloses no area.")
    choice("plot.curvature(component=...)", component, connection.components)
    two = names[:2] if along is None else pair("plot.curvature(along=...)", along)
    shapes = [names.index(choice("plot.curvature(along=...)", name, names)) for name in two]
    if shapes[0] == shapes[1]:
        raise error("plot.curvature(along=...)", "name two shape variables", shown(along), "Name another one.")
    path = None if phase is None else np.asarray(phase.shape)
    sides = _sides(bounds, path, shapes)
    middle = np.zeros(len(names)) if path is None else (path.min(0) + path.max(0)) / 2
    at = middle if shape is None else array("plot.curvature(shape=...)", shape, (len(names),))
    values = _values(connection, component, shapes, sides, at)
    axes = theme.axes_or_new(axes, (6.4, 5.2))
    mesh, zero, bar = _map(axes, component, sides, values)
    gait = None if path is None else _draw_gait(axes, path[:, shapes])
    axes.set(xlabel=symbol(names[shapes[0]]), ylabel=symbol(names[shapes[1]]), xlim=sides[0], ylim=sides[1])
    theme.legend_above(axes, f"{connection.system.name}: curvature, {symbol(component)}")
    return CurvaturePicture(axes, mesh, zero, gait, bar)


def _sides(bounds: Any, path: Array | None, shapes: list[int]) -> Float[np.ndarray, "2 2"]:
    """Return the least and the greatest value of both variables."""
    where, remedy = "plot.curvature(bounds=...)", "Pass ((from, to), (from, to))."
    if bounds is None and path is not None:
        low, high = path[:, shapes].min(0), path[:, shapes].max(0)
        margin = _MARGIN * np.where(high > low, high - low, np.abs([low, high]).max(0))
        return np.stack([low - margin, high + margin], -1)
    sides = array(where, ((-_REACH, _REACH),) * 2 if bounds is None else bounds, (2, 2), remedy)
    if not (sides[:, 0] < sides[:, 1]).all():
        raise error(where, "have its lower end first", shown(bounds), remedy)
    return sides


def _values(connection: LocalConnection, component: str, shapes: list[int], sides: Array, at: Array) -> Array:
    """Return minus the curvature in the middle of cells."""
    points = np.broadcast_to(at, (_POINTS - 1, _POINTS - 1, len(at))).copy()
    points[..., shapes[0]], points[..., shapes[1]] = np.meshgrid(*_middles(sides))
    values = -connection.curvature(points)[..., connection.components.index(component), shapes[0], shapes[1]]
    if not np.isfinite(values).any():
        raise error("plot.curvature(bounds=...)", "hold regular shapes", shown(sides.tolist()), "Choose other ranges.")
    return values


def _middles(sides: Array) -> list[Array]:
    return [np.linspace(low, high, 2 * _POINTS - 1)[1::2] for low, high in sides]


def _map(axes: Axes, component: str, sides: Array, values: Array) -> tuple[QuadMesh, Any, Colorbar]:
    """Draw the map in two hues that meet at zero, the line of zeros, and the key."""
    most = float(np.nanmax(np.abs(values)))
    top = min(most, _REACHED * float(np.nanmedian(np.abs(values)))) or most or 1.0
    hues = LinearSegmentedColormap.from_list("nonholo_signed", [theme.UNSTABLE, theme.PAPER, theme.DISCRETE])
    edges = [np.linspace(low, high, _POINTS) for low, high in sides]
    shown_as: Any = {"cmap": hues, "norm": Normalize(-top, top), "rasterized": True, "zorder": 1}
    mesh = axes.pcolormesh(*edges, np.ma.masked_invalid(values), **shown_as)
    zero = None
    if values[np.isfinite(values)].min() < 0 < values[np.isfinite(values)].max():
        line: Any = {"colors": [theme.QUIET], "linewidths": 1.0, "linestyles": "dashed", "zorder": 2}
        zero = axes.contour(*_middles(sides), np.ma.masked_invalid(values), levels=[0.0], **line)
    words, extend = f"gain in {symbol(component)} per area", "both" if most > top else "neither"
    return mesh, zero, theme.color_key(axes, mesh, words, extend=extend)


def _draw_gait(axes: Axes, path: Float[np.ndarray, "K 2"]) -> Line2D:
    """Draw a gait, with an arrow that shows its sense."""
    line = axes.plot(*path.T, linewidth=2.0, zorder=4, **theme.own_look(theme.INK, "gait"))[0]
    k = int(np.argmax(np.abs(np.diff(path, axis=0)).sum(-1)))
    arrow: Any = {"arrowstyle": "-|>", "color": line.get_color(), "mutation_scale": 18, "linewidth": 0}
    axes.annotate("", path[k + 1], path[k], arrowprops=arrow, zorder=4)
    return line
