"""Common parts of maps of sweeps: members that succeeded, how the others ended, scales, names. Nothing is run here."""

import dataclasses
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PathCollection
from matplotlib.colorbar import Colorbar
from matplotlib.colors import BoundaryNorm, LogNorm, Normalize

from nonholo.base.checks import choice, error
from nonholo.base.types import Float
from nonholo.plot import theme

if TYPE_CHECKING:
    import xarray

OUTCOME, DRAWN = "outcome", "value of the design"
_SUCCESSFUL = "successful"
_ENDED = {
    _SUCCESSFUL: "#56b4e9",
    "no_real_branch": "#cfd3da",
    "branch_unverified": "#8a8f98",
    "not_converged": "#cc79a7",
    "off_momentum_locus": "#e69f00",
    "no_half_impulse": "#009e73",
    "too_stiff": "#f0e442",
    "raised": "#d55e00",
}
_OTHER = "#a0522d"
_WIDE = 30.0  # quotient of the ends of the middle nine tenths from which a scale is logarithmic: 19 for even numbers
_FEW = 9  # different integers that get a color each


@dataclasses.dataclass(frozen=True)
class Subject:
    """The quantity of a picture.

    Attributes:
        values: The quantity, NaN where a member did not succeed.
        codes: How members ended.
        whole: Whether the quantity consists of whole numbers.
    """

    values: "xarray.DataArray"
    codes: "xarray.DataArray"
    whole: bool

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
    import xarray

    where = "plot.sweep_map"
    if not isinstance(result, xarray.Dataset) or OUTCOME not in result:
        remedy = "Pass what nh.sweep or nh.load_sweep returned."
        raise error(f"{where}(result=...)", "be the result of a sweep", type(result).__name__, remedy)
    codes = result[OUTCOME]
    numbers = [str(name) for name in result.data_vars if result[name].dtype.kind in "biuf"]
    if quantity is None:
        quantity = _first_of_the_task(result, numbers)
    values = result[choice(f"{where}(quantity=...)", quantity, tuple(numbers))]
    more = [str(name) for name in values.dims if name not in codes.dims]
    if more:
        got, remedy = f"{quantity} along {', '.join(more)}", f"Pass result.isel({more[0]}=0), or another one."
        raise error(f"{where}(quantity=...)", "be one number of each member", got, remedy)
    successes = values.astype(float) if quantity == OUTCOME else values.where(codes == 0)
    return Subject(successes.assign_attrs(values.attrs), codes, values.dtype.kind in "biu")


def _first_of_the_task(result: "xarray.Dataset", numbers: list[str]) -> str:
    """Return the first name that is one number of each member and no draw; the outcome if there is none."""
    own = [name for name in numbers if result[name].attrs.get("long_name") != DRAWN and name != OUTCOME]
    return next((name for name in own if result[name].dims == result[OUTCOME].dims), OUTCOME)


def label(values: "xarray.DataArray") -> str:
    """Return the name of a quantity with its units."""
    units = values.attrs.get("units", "1")
    return str(values.name).replace("_", " ") + ("" if units == "1" else f"  [{units}]")


def ends(codes: "xarray.DataArray", *, successful: bool = False) -> list[tuple[int, str, str]]:
    """Return the outcomes that occur, but for success, with their names and colors."""
    flags = [int(flag) for flag in np.atleast_1d(codes.attrs.get("flag_values", []))]
    names = dict(zip(flags, str(codes.attrs.get("flag_meanings", "")).split(), strict=False))
    own = _ENDED | {"nonfinite": theme.STABLE, "absent": theme.PAPER}
    outcomes = []
    for code, count in zip(*np.unique(codes.values, return_counts=True), strict=True):
        if successful or code != 0:
            name = names.get(int(code), str(code))
            outcomes.append((int(code), f"{name.replace('_', ' ')} ({count:,})", own.get(name, _OTHER)))
    return outcomes


def key_to(axes: Axes, outcomes: list[tuple[int, str, str]]) -> tuple[PathCollection, ...]:
    """Put a square into the legend for each outcome."""
    look: Any = {"marker": "s", "s": 42, "linewidths": 0.6, "edgecolors": theme.MUTED}
    return tuple(axes.scatter([], [], color=color, label=name, **look) for _, name, color in outcomes)


def mark_below(
    axes: Axes, across: np.ndarray, codes: np.ndarray, outcomes: list[tuple[int, str, str]], marker: str
) -> tuple[PathCollection, ...]:
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
    if subject.whole and 0 < len(distinct) <= _FEW:
        middles = (distinct[:-1] + distinct[1:]) / 2
        borders = np.concatenate([[distinct[0] - 1], middles, [distinct[-1] + 1]])
        return BoundaryNorm(borders, theme.TIME.N)
    if is_wide(finite):
        return LogNorm(finite.min(), finite.max())
    return Normalize(finite.min(), finite.max()) if len(finite) else Normalize(0.0, 1.0)


def color_key(axes: Axes, mappable: ScalarMappable, subject: Subject) -> Colorbar:
    """Put the key to the colors beside the axes."""
    figure: Any = axes.get_figure(root=False)
    bar = figure.colorbar(mappable, ax=axes, label=label(subject.values), pad=0.02)
    bar.outline.set_visible(False)
    bar.solids.set_alpha(1.0)
    if isinstance(mappable.norm, BoundaryNorm):
        labels = [f"{value:g}" for value in np.unique(subject.finite)]
        ends_of = np.asarray(mappable.norm.boundaries)
        bar.set_ticks(list((ends_of[:-1] + ends_of[1:]) / 2), labels=labels)
        bar.ax.tick_params(length=0, which="both")
    return bar


def is_wide(values: Float[np.ndarray, "..."]) -> bool:
    """Return whether positive numbers range over orders of magnitude."""
    if not values.size or not values.min() > 0:
        return False
    low, high = np.quantile(values, [0.05, 0.95])
    return bool(high > _WIDE * low)


def scale_along(values: Float[np.ndarray, "K"]) -> str:
    """Return the scale of an axis for these numbers, of which some may be missing."""
    return "log" if is_wide(values[np.isfinite(values)]) else "linear"


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
