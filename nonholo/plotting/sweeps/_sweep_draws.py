"""Random draws of a sweep: dots over one or two of their numbers, or a histogram."""

from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.colorbar import Colorbar
from matplotlib.ticker import MaxNLocator

from nonholo.base.checks import error, shown
from nonholo.base.types import Float
from nonholo.plotting import theme
from nonholo.plotting.sweeps import _sweep_axes as common

_MOST = 20_000  # dots
_LARGE = 2000  # dots from which they are small
_BARS = 60

Drawn = tuple[Any, tuple[Any, ...], Colorbar | None]


def draw_draws(axes: Axes, result: xarray.Dataset, subject: common.Subject, x: str | None, y: str | None) -> Drawn:
    """Draw the members of a random design."""
    if y is not None and x is None:
        raise error("plot.sweep_map(y=...)", "come with x", shown(y), "Pass x, or x and y.")
    if x is not None and y is not None:
        drawn = _colored_dots(axes, subject, _number(result, "x", x), _number(result, "y", y))
    elif subject.values.name == common.OUTCOME:
        drawn = _outcomes(axes, subject)
    elif x is not None:
        drawn = _dots_over(axes, subject, _number(result, "x", x))
    else:
        drawn = _histogram(axes, subject)
    axes.set_title(subject.title)
    theme.legend_above(axes)
    return drawn


def _number(result: xarray.Dataset, argument: str, name: str) -> xarray.DataArray:
    numbers = [str(known) for known, values in result.data_vars.items() if values.dims == ("member",)]
    if name not in numbers:
        known = ", ".join(numbers)
        where = f"plot.sweep_map({argument}=...)"
        raise error(where, "be one number of each member", shown(name), f"Choose among {known}.")
    return result[name]


def _thinned(*arrays: xarray.DataArray) -> list[np.ndarray]:
    """Return the values of evenly spaced members, of at most this many."""
    return [array.values[:: -(-len(array) // _MOST)] for array in arrays]


def _dots_over(axes: Axes, subject: common.Subject, x: xarray.DataArray) -> Drawn:
    """Draw the quantity of members that succeeded as dots over x; the others are marked along the bottom."""
    across, values, codes = _thinned(x, subject.values, subject.codes)
    good, ended = codes == 0, common.ends(subject.codes)
    drawn = axes.scatter(across[good], values[good], color=theme.DISCRETE, **_look(across))
    axes.set(xlabel=common.label(x), xscale=common.scale_along(across))
    axes.set(ylabel=common.label(subject.values), yscale=common.scale_along(values))
    shown = common.mark_below(axes, across, codes, ended, marker="|")
    common.key_to(axes, ended)
    return drawn, shown, None


def _colored_dots(axes: Axes, subject: common.Subject, x: xarray.DataArray, y: xarray.DataArray) -> Drawn:
    """Draw members as dots over x and y, those that did not succeed below the others."""
    across, up, values, codes = _thinned(x, y, subject.values, subject.codes)
    of_outcome, look = subject.values.name == common.OUTCOME, _look(across)
    ended = common.ends(subject.codes, successful=of_outcome)
    groups = [(codes == code, color) for code, _, color in ended]
    shown = tuple(axes.scatter(across[of], up[of], color=color, **look) for of, color in groups)
    drawn = bar = None
    if not of_outcome:
        good = codes == 0
        colors: Any = {"c": values[good], "cmap": theme.TIME, "norm": common.scale_of(subject)}
        drawn = axes.scatter(across[good], up[good], **colors, **look)
        bar = common.color_key(axes, drawn, subject)
    axes.set(xlabel=common.label(x), xscale=common.scale_along(across))
    axes.set(ylabel=common.label(y), yscale=common.scale_along(up))
    common.key_to(axes, ended)
    return drawn, shown, bar


def _look(across: np.ndarray) -> Any:
    return {"s": 14.0 if len(across) <= _LARGE else 5.0, "linewidths": 0, "rasterized": True}


def _histogram(axes: Axes, subject: common.Subject) -> Drawn:
    """Count the members that succeeded; the legend counts the others."""
    bars = axes.hist(subject.finite, bins=_bins(subject.finite, subject.whole), color=theme.DISCRETE, rwidth=0.94)[2]
    axes.set(xlabel=common.label(subject.values), ylabel="members")
    if subject.whole:
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    else:
        axes.set_xscale(common.scale_along(subject.finite))
    common.key_to(axes, common.ends(subject.codes))
    return bars, (), None


def _outcomes(axes: Axes, subject: common.Subject) -> Drawn:
    """Count how members ended, one bar each."""
    ended = common.ends(subject.codes, successful=True)
    counts = [int((subject.codes.values == code).sum()) for code, _, _ in ended]
    bars = axes.barh([name for _, name, _ in ended], counts, color=[color for _, _, color in ended], height=0.6)
    axes.set(xlabel="members", ylim=(len(ended) - 0.5, -0.5))
    return bars, (), None


def _bins(values: Float[np.ndarray, "K"], whole: bool) -> Any:
    if not values.size:
        return 1
    if whole and np.ptp(values) < _BARS:
        return np.arange(values.min() - 0.5, values.max() + 1)
    if common.is_wide(values):
        return np.geomspace(values.min(), values.max(), _BARS + 1)
    return min(_BARS, max(1, int(np.sqrt(len(values)))))
