"""The result of a sweep in one picture: a map over a grid, a curve along one axis, draws as dots or a histogram.

The quantity that is shown, the colors and names of outcomes, and the scales of axes come first.
"""

from typing import Any, NamedTuple, Unpack

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colorbar import Colorbar
from matplotlib.colors import BoundaryNorm, ListedColormap, LogNorm, Normalize
from matplotlib.ticker import MaxNLocator

from nonholo.base.checks import choice, error, shown
from nonholo.base.types import Float
from nonholo.plot import theme

OUTCOME, DRAWN = "outcome", "value of the design"
_ENDED = {
    "successful": "#56b4e9",
    "no_real_branch": "#cfd3da",
    "branch_unverified": "#8a8f98",
    "not_converged": "#cc79a7",
    "off_momentum_locus": "#e69f00",
    "no_half_impulse": "#009e73",
    "too_stiff": "#f0e442",
    "raised": "#d55e00",
}
_OTHER = "#a0522d"
Ends = list[tuple[int, str, str]]  # code, name and color of each outcome
_WIDE = 30.0  # quotient of the ends of the middle nine tenths from which a scale is logarithmic: 19 for even numbers
_FEW = 9  # different integers that get a color each


class Subject(NamedTuple):
    """The quantity of a picture.

    Attributes:
        values: The quantity, NaN where a member did not succeed.
        codes: How members ended.
        has_integers: Whether the quantity consists of whole numbers.
    """

    values: xarray.DataArray
    codes: xarray.DataArray
    has_integers: bool

    @property
    def title(self) -> str:
        """The meaning of the quantity."""
        name = str(self.values.attrs.get("long_name") or label(self.values))
        return name[:1].upper() + name[1:]

    @property
    def finite(self) -> Float[np.ndarray, "K"]:
        """The numbers of the members that have one."""
        return self.values.values[np.isfinite(self.values.values)]


def subject_of(result: Any, quantity: str | None) -> Subject:
    """Return the quantity of that name, by default the first one of a task that is one number of each member."""
    where = "plot.sweep_map"
    if not isinstance(result, xarray.Dataset) or OUTCOME not in result:
        remedy = "Pass what nh.sweep or nh.load_sweep returned."
        raise error(f"{where}(result=...)", "be the result of a sweep", type(result).__name__, remedy)
    codes = result[OUTCOME]
    numbers = [str(name) for name in result.data_vars if result[name].dtype.kind in "biuf"]
    if quantity is None:
        quantity = _first_of_the_task(result, numbers)
    values = result[choice(f"{where}(quantity=...)", quantity, tuple(numbers))]
    if more := [str(name) for name in values.dims if name not in codes.dims]:
        got, remedy = f"{quantity} along {', '.join(more)}", f"Pass result.isel({more[0]}=0), or another one."
        raise error(f"{where}(quantity=...)", "be one number of each member", got, remedy)
    successes = values.astype(float) if quantity == OUTCOME else values.where(codes == 0)
    return Subject(successes.assign_attrs(values.attrs), codes, values.dtype.kind in "biu")


def _first_of_the_task(result: xarray.Dataset, numbers: list[str]) -> str:
    """Return the first name that is one number of each member and no draw; the outcome if there is none."""
    own = [name for name in numbers if result[name].attrs.get("long_name") != DRAWN and name != OUTCOME]
    return next((name for name in own if result[name].dims == result[OUTCOME].dims), OUTCOME)


def label(values: xarray.DataArray) -> str:
    """Return the name of a quantity with its units."""
    units = values.attrs.get("units", "1")
    return str(values.name).replace("_", " ") + ("" if units == "1" else f"  [{units}]")


def ends(codes: xarray.DataArray, *, successful: bool = False) -> Ends:
    """Return the outcomes that occur, but for success, with their names and colors."""
    flags = [int(flag) for flag in np.atleast_1d(codes.attrs.get("flag_values", []))]
    names = dict(zip(flags, str(codes.attrs.get("flag_meanings", "")).split(), strict=False))
    own = _ENDED | {"nonfinite": theme.STABLE, "absent": theme.PAPER}
    counts = zip(*np.unique(codes.values, return_counts=True), strict=True)
    shown = [(int(k), names.get(int(k), str(k)), count) for k, count in counts if successful or k != 0]
    return [(k, f"{name.replace('_', ' ')} ({count:,})", own.get(name, _OTHER)) for k, name, count in shown]


def key_to(axes: Axes, outcomes: Ends) -> tuple[Any, ...]:
    """Put a square into the legend for each outcome."""
    look: Any = {"marker": "s", "s": 42, "linewidths": 0.6, "edgecolors": theme.MUTED}
    return tuple(axes.scatter([], [], color=color, label=name, **look) for _, name, color in outcomes)


def mark_below(axes: Axes, across: np.ndarray, codes: np.ndarray, outcomes: Ends, marker: str) -> tuple[Any, ...]:
    """Mark members along the bottom of the axes that have no number; call it after the others are drawn."""
    look: Any = {"marker": marker, "s": 18 if marker == "s" else 50, "linewidths": 0.8, "clip_on": False, "zorder": 5}
    axes.update_datalim(np.stack([across, across], axis=-1), updatey=False)
    axes.autoscale_view()
    groups = [(across[codes == code], color) for code, _, color in outcomes]
    where = axes.get_xaxis_transform()
    return tuple(axes.scatter(x, np.zeros(len(x)), transform=where, color=color, **look) for x, color in groups)


def scale_of(subject: Subject) -> Normalize:
    """Return how numbers become colors: whole numbers one each if they are few, by logarithm if they range widely."""
    finite = subject.finite
    distinct = np.unique(finite)
    if subject.has_integers and 0 < len(distinct) <= _FEW:
        middles = (distinct[:-1] + distinct[1:]) / 2
        return BoundaryNorm(np.concatenate([[distinct[0] - 1], middles, [distinct[-1] + 1]]), theme.TIME.N)
    if ranges_widely(finite):
        return LogNorm(finite.min(), finite.max())
    return Normalize(finite.min(), finite.max()) if len(finite) else Normalize(0.0, 1.0)


def color_key(axes: Axes, mappable: ScalarMappable, subject: Subject) -> Colorbar:
    """Put the key to the colors beside the axes."""
    bar = theme.color_key(axes, mappable, label(subject.values))
    bar.solids.set_alpha(1.0)
    if isinstance(mappable.norm, BoundaryNorm):
        labels = [f"{value:g}" for value in np.unique(subject.finite)]
        ends_of = np.asarray(mappable.norm.boundaries)
        bar.set_ticks(list((ends_of[:-1] + ends_of[1:]) / 2), labels=labels)
        bar.ax.tick_params(length=0, which="both")
    return bar


def ranges_widely(values: Float[np.ndarray, "..."]) -> bool:
    """Return whether positive numbers range over orders of magnitude."""
    if not values.size or not values.min() > 0:
        return False
    low, high = np.quantile(values, [0.05, 0.95])
    return bool(high > _WIDE * low)


def scale_along(values: Float[np.ndarray, "K"]) -> str:
    """Return the scale of an axis for these numbers, of which some may be missing."""
    return "log" if ranges_widely(values[np.isfinite(values)]) else "linear"


def is_geometric(values: Float[np.ndarray, "K"]) -> bool:
    """Return whether values along an axis have one quotient, and no one difference."""
    if len(values) < 3 or not values.min() > 0:
        return False
    quotients, differences = values[1:] / values[:-1], np.diff(values)
    return bool(np.ptp(quotients) < 1e-6 * quotients[0] and np.ptp(differences) > 1e-6 * abs(differences[0]))


def borders(values: Float[np.ndarray, "K"]) -> Float[np.ndarray, "K+1"]:
    """Return where cells around ascending values end: half-way between them, in logarithms if they are geometric."""
    if is_geometric(values):
        return np.exp(borders(np.log(values)))
    if len(values) == 1:
        return values[0] + np.array([-0.5, 0.5])
    middles = (values[:-1] + values[1:]) / 2
    return np.concatenate([[2 * values[0] - middles[0]], middles, [2 * values[-1] - middles[-1]]])


_MOST = 20_000  # dots
_LARGE = 2000  # dots from which they are small
_BARS = 60
_OPAQUE = 600  # dots up to which they are opaque

_Drawn = tuple[Any, tuple[Any, ...], Colorbar | None]


def _draw_draws(axes: Axes, result: xarray.Dataset, subject: Subject, x: str | None, y: str | None) -> _Drawn:
    """Draw the members of a random design."""
    if y is not None and x is None:
        raise error("plot.sweep_map(y=...)", "come with x", shown(y), "Pass x, or x and y.")
    if x is not None and y is not None:
        return _colored_dots(axes, subject, _number(result, "x", x), _number(result, "y", y))
    if subject.values.name == OUTCOME:
        return _outcomes(axes, subject)
    return _histogram(axes, subject) if x is None else _dots_over(axes, subject, _number(result, "x", x))


def _number(result: xarray.Dataset, argument: str, name: str) -> xarray.DataArray:
    numbers = tuple(str(names) for names, values in result.data_vars.items() if values.dims == ("member",))
    return result[choice(f"plot.sweep_map({argument}=...)", name, numbers, "Choose one number of each member.")]


def _thin(*arrays: xarray.DataArray) -> list[np.ndarray]:
    """Return the values of evenly spaced members, of at most this many."""
    return [array.values[:: -(-len(array) // _MOST)] for array in arrays]


def _dots_over(axes: Axes, subject: Subject, x: xarray.DataArray) -> _Drawn:
    """Draw the quantity of members that succeeded as dots over x; the others are marked along the bottom."""
    across, values, codes = _thin(x, subject.values, subject.codes)
    good, outcomes = codes == 0, ends(subject.codes)
    members = axes.scatter(across[good], values[good], **theme.own_look(theme.DISCRETE), **_look(across, 0.2))
    axes.set(xlabel=label(x), xscale=scale_along(across), ylabel=label(subject.values), yscale=scale_along(values))
    marks = mark_below(axes, across, codes, outcomes, marker="|")
    key_to(axes, outcomes)
    return members, marks, None


def _colored_dots(axes: Axes, subject: Subject, x: xarray.DataArray, y: xarray.DataArray) -> _Drawn:
    """Draw members as dots over x and y, those that did not succeed below the others."""
    across, up, values, codes = _thin(x, y, subject.values, subject.codes)
    of_outcome, look = subject.values.name == OUTCOME, _look(across, 0.5)
    outcomes = ends(subject.codes, successful=of_outcome)
    groups = [(codes == code, color) for code, _, color in outcomes]
    marks = tuple(axes.scatter(across[of], up[of], color=color, **look) for of, color in groups)
    members = bar = None
    if not of_outcome:
        good = codes == 0
        members = axes.scatter(across[good], up[good], c=values[good], cmap=theme.TIME, norm=scale_of(subject), **look)
        bar = color_key(axes, members, subject)
    axes.set(xlabel=label(x), xscale=scale_along(across), ylabel=label(y), yscale=scale_along(up))
    key_to(axes, outcomes)
    return members, marks, bar


def _look(across: np.ndarray, faintest: float) -> Any:
    """Return the look of this many dots, which let others through where they are many: crowds are darker."""
    opacity = max(faintest, min(1.0, _OPAQUE / max(1, len(across))))
    return {"s": 14.0 if len(across) <= _LARGE else 5.0, "linewidths": 0, "rasterized": True, "alpha": opacity}


def _histogram(axes: Axes, subject: Subject) -> _Drawn:
    """Count the members that succeeded; the legend counts the others."""
    look = theme.own_look(theme.DISCRETE)
    bars = axes.hist(subject.finite, bins=_bins(subject.finite, subject.has_integers), rwidth=0.94, **look)[2]
    axes.set(xlabel=label(subject.values), ylabel="members")
    if subject.has_integers:
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    else:
        axes.set_xscale(scale_along(subject.finite))
    key_to(axes, ends(subject.codes))
    return bars, (), None


def _outcomes(axes: Axes, subject: Subject) -> _Drawn:
    """Count how members ended, one bar each."""
    outcomes = ends(subject.codes, successful=True)
    counts = [int((subject.codes.values == code).sum()) for code, _, _ in outcomes]
    bars = axes.barh([name for _, name, _ in outcomes], counts, color=[color for _, _, color in outcomes], height=0.6)
    axes.set(xlabel="members", ylim=(len(outcomes) - 0.5, -0.5))
    return bars, (), None


def _bins(values: Float[np.ndarray, "K"], whole: bool) -> Any:
    if not values.size:
        return 1
    if whole and np.ptp(values) < _BARS:
        return np.arange(values.min() - 0.5, values.max() + 1)
    if ranges_widely(values):
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
    subject = subject_of(result, quantity)
    along = [] if subject.codes.dims == ("member",) else _axes_of(subject, x, y)
    axes = theme.axes_or_new(axes, (7.2, 5.4))
    if along:
        artists = (_curve if len(along) == 1 else _map)(axes, subject, *along)
    else:
        artists = _draw_draws(axes, result, subject, x, y)
    # the rest of the design has one value each
    coordinates = subject.values.coords.items()
    single = {str(name): x.values.item() for name, x in coordinates if x.size == 1 and x.dtype.kind in "if"}
    rest = [f"{name.replace('_', ' ')} = {value:.4g}" for name, value in single.items()]
    theme.legend_above(axes, ", ".join([subject.title, *rest]))
    return SweepMap(axes, *artists)


def _check_named(names: list[str], x: str | None, y: str | None) -> None:
    """Refuse axes that the result does not have, and one that is named twice."""
    for argument, name in (("x", x), ("y", y)):
        if name is not None:
            choice(f"plot.sweep_map({argument}=...)", name, tuple(names))
    if not names or (x is not None and x == y):
        got, remedy = ("one member" if not names else f"{x!r} twice"), "Pass more of the result, or name two axes."
        raise error("plot.sweep_map(result=...)", "have an axis for x, and another one for y", got, remedy)


def _axes_of(subject: Subject, x: str | None, y: str | None) -> list[str]:
    """Return the axes that are named, or else the first ones of those that have several values; at least one."""
    names = [str(name) for name in subject.values.dims]
    _check_named(names, x, y)
    free = (name for name in names if subject.values.sizes[name] > 1 and name not in (x, y))
    along = [name for name in (x or next(free, None), y or next(free, None)) if name is not None]
    if more := list(free):
        remedy = f"Pass result.sel({more[0]}=..., method='nearest'), or result.isel({more[0]}=0)."
        raise error("plot.sweep_map(result=...)", "have at most two free axes", f"also {', '.join(more)}", remedy)
    return along or names[:1]


def _map(axes: Axes, subject: Subject, x: str, y: str) -> _Drawn:
    values, codes = (_plane(array, x, y) for array in (subject.values, subject.codes))
    edges = borders(_places(values, x)), borders(_places(values, y))
    outcomes = ends(subject.codes, successful=subject.values.name == OUTCOME)
    look: Any = {"rasterized": True, "zorder": 1}
    cells = [(np.ma.masked_where(codes.values != k, np.ones(codes.shape)), color) for k, _, color in outcomes]
    marks = tuple(axes.pcolormesh(*edges, here, cmap=ListedColormap([color]), **look) for here, color in cells)
    members = bar = None
    if subject.values.name != OUTCOME:
        colors: Any = {"cmap": theme.TIME, "norm": scale_of(subject)}
        members = axes.pcolormesh(*edges, np.ma.masked_invalid(values.values), **colors, **look)
        bar = color_key(axes, members, subject)
    _dress_axis(axes, "x", values, x)
    _dress_axis(axes, "y", values, y)
    key_to(axes, outcomes)
    return members, marks, bar


def _curve(axes: Axes, subject: Subject, x: str) -> _Drawn:
    values, codes = (_plane(array, x) for array in (subject.values, subject.codes))
    across = _places(values, x)
    marker = "o" if len(across) <= _MARKED else ""
    (line,) = axes.plot(across, values.values, **theme.own_look(theme.DISCRETE), marker=marker, markersize=3.5)
    outcomes = ends(subject.codes)
    marks = mark_below(axes, across, codes.values, outcomes, marker="s")
    _dress_axis(axes, "x", values, x)
    axes.set(ylabel=label(subject.values), yscale=scale_along(values.values))
    key_to(axes, outcomes)
    return line, marks, None


def _plane(array: xarray.DataArray, *names: str) -> xarray.DataArray:
    """Return an array along some axes, the first one last, ascending along all."""
    flat = array.squeeze([name for name in array.dims if name not in names])
    return flat.transpose(*reversed(names)).sortby(list(names))


def _places(array: xarray.DataArray, name: str) -> np.ndarray:
    """Return the values along an axis; vectors and matrices are numbered."""
    return np.asarray(array[name].values, dtype=float)


def _dress_axis(axes: Axes, side: str, array: xarray.DataArray, name: str) -> None:
    scale = "log" if is_geometric(_places(array, name)) else "linear"
    axes.set(**{f"{side}scale": scale, f"{side}label": label(array[name])})
