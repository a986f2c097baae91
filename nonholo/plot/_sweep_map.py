"""The result of a sweep in one picture: a map over a grid, a curve along one axis, draws as dots or a histogram."""

from typing import TYPE_CHECKING, Any, NamedTuple, Unpack

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colorbar import Colorbar
from matplotlib.colors import ListedColormap
from matplotlib.ticker import MaxNLocator

from nonholo.base.checks import choice, error, shown
from nonholo.base.types import Float
from nonholo.plot import _sweep_axes as common
from nonholo.plot import theme

if TYPE_CHECKING:
    import xarray

_MOST = 20_000  # dots
_LARGE = 2000  # dots from which they are small
_BARS = 60
_OPAQUE = 600  # dots up to which they are opaque

_Drawn = tuple[Any, tuple[Any, ...], Colorbar | None]


def _draw_draws(axes: Axes, result: "xarray.Dataset", subject: common.Subject, x: str | None, y: str | None) -> _Drawn:
    """Draw the members of a random design."""
    if y is not None and x is None:
        raise error("plot.sweep_map(y=...)", "come with x", shown(y), "Pass x, or x and y.")
    if x is not None and y is not None:
        members = _colored_dots(axes, subject, _number(result, "x", x), _number(result, "y", y))
    elif subject.values.name == common.OUTCOME:
        members = _outcomes(axes, subject)
    elif x is not None:
        members = _dots_over(axes, subject, _number(result, "x", x))
    else:
        members = _histogram(axes, subject)
    theme.write_title(axes, subject.title)
    theme.legend_above(axes)
    return members


def _number(result: "xarray.Dataset", argument: str, name: str) -> "xarray.DataArray":
    numbers = [str(names) for names, values in result.data_vars.items() if values.dims == ("member",)]
    if name not in numbers:
        names = ", ".join(numbers)
        where = f"plot.sweep_map({argument}=...)"
        raise error(where, "be one number of each member", shown(name), f"Choose among {names}.")
    return result[name]


def _thin(*arrays: "xarray.DataArray") -> list[np.ndarray]:
    """Return the values of evenly spaced members, of at most this many."""
    return [array.values[:: -(-len(array) // _MOST)] for array in arrays]


def _dots_over(axes: Axes, subject: common.Subject, x: "xarray.DataArray") -> _Drawn:
    """Draw the quantity of members that succeeded as dots over x; the others are marked along the bottom."""
    across, values, codes = _thin(x, subject.values, subject.codes)
    good, outcomes = codes == 0, common.ends(subject.codes)
    members = axes.scatter(across[good], values[good], **theme.own_look(theme.DISCRETE), **_look(across, 0.2))
    axes.set(xlabel=common.label(x), xscale=common.scale_along(across))
    axes.set(ylabel=common.label(subject.values), yscale=common.scale_along(values))
    marks = common.mark_below(axes, across, codes, outcomes, marker="|")
    common.key_to(axes, outcomes)
    return members, marks, None


def _colored_dots(axes: Axes, subject: common.Subject, x: "xarray.DataArray", y: "xarray.DataArray") -> _Drawn:
    """Draw members as dots over x and y, those that did not succeed below the others."""
    across, up, values, codes = _thin(x, y, subject.values, subject.codes)
    of_outcome, look = subject.values.name == common.OUTCOME, _look(across, 0.5)
    outcomes = common.ends(subject.codes, successful=of_outcome)
    groups = [(codes == code, color) for code, _, color in outcomes]
    marks = tuple(axes.scatter(across[of], up[of], color=color, **look) for of, color in groups)
    members = bar = None
    if not of_outcome:
        good = codes == 0
        colors: Any = {"c": values[good], "cmap": theme.TIME, "norm": common.scale_of(subject)}
        members = axes.scatter(across[good], up[good], **colors, **look)
        bar = common.color_key(axes, members, subject)
    axes.set(xlabel=common.label(x), xscale=common.scale_along(across))
    axes.set(ylabel=common.label(y), yscale=common.scale_along(up))
    common.key_to(axes, outcomes)
    return members, marks, bar


def _look(across: np.ndarray, faintest: float) -> Any:
    """Return the look of this many dots, which let others through where they are many: crowds are darker."""
    opacity = max(faintest, min(1.0, _OPAQUE / max(1, len(across))))
    return {"s": 14.0 if len(across) <= _LARGE else 5.0, "linewidths": 0, "rasterized": True, "alpha": opacity}


def _histogram(axes: Axes, subject: common.Subject) -> _Drawn:
    """Count the members that succeeded; the legend counts the others."""
    bars = axes.hist(
        subject.finite, bins=_bins(subject.finite, subject.whole), rwidth=0.94, **theme.own_look(theme.DISCRETE)
    )[2]
    axes.set(xlabel=common.label(subject.values), ylabel="members")
    if subject.whole:
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    else:
        axes.set_xscale(common.scale_along(subject.finite))
    common.key_to(axes, common.ends(subject.codes))
    return bars, (), None


def _outcomes(axes: Axes, subject: common.Subject) -> _Drawn:
    """Count how members ended, one bar each."""
    outcomes = common.ends(subject.codes, successful=True)
    counts = [int((subject.codes.values == code).sum()) for code, _, _ in outcomes]
    bars = axes.barh([name for _, name, _ in outcomes], counts, color=[color for _, _, color in outcomes], height=0.6)
    axes.set(xlabel="members", ylim=(len(outcomes) - 0.5, -0.5))
    return bars, (), None


def _bins(values: Float[np.ndarray, "K"], whole: bool) -> Any:
    if not values.size:
        return 1
    if whole and np.ptp(values) < _BARS:
        return np.arange(values.min() - 0.5, values.max() + 1)
    if common.is_wide(values):
        return np.geomspace(values.min(), values.max(), _BARS + 1)
    return min(_BARS, max(1, int(np.sqrt(len(values)))))


_MARKED = 60  # members along a curve that get a dot each


class SweepMap(NamedTuple):
    """The artists of `sweep_map`; None where there was nothing to draw.

    Attributes:
        axes: The axes.
        drawn: The members that succeeded: a mesh, a line, dots, or the bars of a histogram.
        ended: For each other outcome what shows it; the legend counts its members.
        colorbar: The key to the colors.
    """

    axes: Axes
    drawn: Any
    ended: tuple[Any, ...]
    colorbar: Colorbar | None


@theme.in_style
def sweep_map(
    result: Any,
    quantity: str | None = None,
    x: str | None = None,
    y: str | None = None,
    axes: Axes | None = None,
    **look: Unpack[theme.Look],
) -> SweepMap:
    """Draw one quantity of a sweep over what was varied; members that did not succeed are shown by how they ended.

    Over a grid: a map with cells around the values, or along one axis a curve; axes whose values have one quotient are
    logarithmic. For random draws: dots over two values, over one, or with neither x nor y a histogram.

    Args:
        result: The result of `sweep` or `load_sweep`, or a part of it, as from `result.sel(...)`.
        quantity: A number of each member; by default the first that the task returned. "outcome" shows how all ended.
        x: An axis of the grid, by default the first one; for draws any number of each member.
        y: The same, by default the next axis.
        axes: Where to draw; a new figure by default.
        **look: Title, label, color and more: `nh.plot.Look`.

    Raises:
        ValueError: No result of a sweep, no such quantity or axis, a quantity with several numbers for each member,
            more than two axes.

    Example:
        >>> def turn(block):
        ...     return {"turn": np.pi * np.sqrt(1 + block["inertia"] / block["a"] ** 2)}
        >>> design = nh.Grid({"inertia": [0.5, 1.0, 2.0], "a": [0.5, 1.0]})
        >>> from tempfile import TemporaryDirectory
        >>> with TemporaryDirectory() as folder:
        ...     picture = nh.plot.sweep_map(nh.sweep(turn, design, f"{folder}/turns.zarr"))
        >>> picture.drawn.get_array().shape, picture.axes.get_xlabel()
        ((2, 3), 'inertia')
    """
    subject = common.subject_of(result, quantity)
    if subject.codes.dims == ("member",):
        axes = theme.axes_or_new(axes, (7.2, 5.4))
        return SweepMap(axes, *_draw_draws(axes, result, subject, x, y))
    along = _along(subject.values, x, y)
    axes = theme.axes_or_new(axes, (7.2, 5.4))
    return _curve(axes, subject, *along) if len(along) == 1 else _map(axes, subject, *along)


def _along(values: "xarray.DataArray", x: str | None, y: str | None) -> list[str]:
    """Return the axes of the picture; others may only have one value."""
    names = [str(name) for name in values.dims]
    _check_named(names, x, y)
    return _axes_of([name for name in names if values.sizes[name] > 1 and name not in (x, y)], x, y) or names[:1]


def _check_named(names: list[str], x: str | None, y: str | None) -> None:
    """Refuse axes that the result does not have, and one that is named twice."""
    for argument, name in (("x", x), ("y", y)):
        if name is not None:
            choice(f"plot.sweep_map({argument}=...)", name, tuple(names))
    if not names or (x is not None and x == y):
        got, remedy = ("one member" if not names else f"{x!r} twice"), "Pass more of the result, or name two axes."
        raise error("plot.sweep_map(result=...)", "have an axis for x, and another one for y", got, remedy)


def _axes_of(free: list[str], x: str | None, y: str | None) -> list[str]:
    """Return the axes that are named, or else the first ones that are free."""
    across = x or (free.pop(0) if free else None)
    up = y or (free.pop(0) if free and across else None)
    if free:
        remedy = f"Pass result.sel({free[0]}=..., method='nearest'), or result.isel({free[0]}=0)."
        raise error("plot.sweep_map(result=...)", "have at most two free axes", f"also {', '.join(free)}", remedy)
    return [name for name in (across, up) if name is not None]


def _map(axes: Axes, subject: common.Subject, x: str, y: str) -> SweepMap:
    values, codes = (_plane(array, x, y) for array in (subject.values, subject.codes))
    edges = common.borders(_places(values, x)), common.borders(_places(values, y))
    outcomes = common.ends(subject.codes, successful=subject.values.name == common.OUTCOME)
    marks = _fill_outcomes(axes, edges, codes, outcomes)
    members = bar = None
    if subject.values.name != common.OUTCOME:
        look: Any = {"cmap": theme.TIME, "norm": common.scale_of(subject), "rasterized": True, "zorder": 1}
        members = axes.pcolormesh(*edges, np.ma.masked_invalid(values.values), **look)
        bar = common.color_key(axes, members, subject)
    _dress_axis(axes, "x", values, x)
    _dress_axis(axes, "y", values, y)
    common.key_to(axes, outcomes)
    _name(axes, subject)
    return SweepMap(axes, members, marks, bar)


def _fill_outcomes(
    axes: Axes, edges: Any, codes: "xarray.DataArray", outcomes: list[tuple[int, str, str]]
) -> tuple[QuadMesh, ...]:
    """Fill the cells of each outcome with its color."""
    cells = []
    for code, _, color in outcomes:
        here = np.ma.masked_where(codes.values != code, np.ones(codes.shape))
        cells.append(axes.pcolormesh(*edges, here, cmap=ListedColormap([color]), rasterized=True, zorder=1))
    return tuple(cells)


def _curve(axes: Axes, subject: common.Subject, x: str) -> SweepMap:
    values, codes = (_plane(array, x) for array in (subject.values, subject.codes))
    across = _places(values, x)
    marker = "o" if len(across) <= _MARKED else ""
    (line,) = axes.plot(across, values.values, **theme.own_look(theme.DISCRETE), marker=marker, markersize=3.5)
    outcomes = common.ends(subject.codes)
    marks = common.mark_below(axes, across, codes.values, outcomes, marker="s")
    _dress_axis(axes, "x", values, x)
    axes.set(ylabel=common.label(subject.values), yscale=common.scale_along(values.values))
    common.key_to(axes, outcomes)
    _name(axes, subject)
    return SweepMap(axes, line, marks, None)


def _plane(array: "xarray.DataArray", *names: str) -> "xarray.DataArray":
    """Return an array along some axes, the first one last, ascending along all."""
    flat = array.squeeze([name for name in array.dims if name not in names])
    return flat.transpose(*reversed(names)).sortby(list(names))


def _places(array: "xarray.DataArray", name: str) -> np.ndarray:
    """Return the values along an axis; vectors and matrices are numbered."""
    return np.asarray(array[name].values, dtype=float)


def _dress_axis(axes: Axes, side: str, array: "xarray.DataArray", name: str) -> None:
    scale = "log" if common.is_geometric(_places(array, name)) else "linear"
    axes.set(**{f"{side}scale": scale, f"{side}label": common.label(array[name])})


def _name(axes: Axes, subject: common.Subject) -> None:
    """Write what is shown, and the values that the rest of the design has."""
    rest = [
        f"{str(name).replace('_', ' ')} = {values.values.item():.4g}"
        for name, values in subject.values.coords.items()
        if values.size == 1 and values.dtype.kind in "if"
    ]
    theme.write_title(axes, ", ".join([subject.title, *rest]))
    theme.legend_above(axes)
