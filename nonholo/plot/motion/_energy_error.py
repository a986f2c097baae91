"""The relative error of the energy along an orbit, against the rounding of a single number."""

import dataclasses
import math
from typing import Any, Unpack

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection, PolyCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.text import Text

from nonholo.base.types import Float
from nonholo.discrete import Discretization
from nonholo.orbit import AbstractOrbit
from nonholo.plot import theme
from nonholo.plot.parts import drawable_in_time, evenly_in_box, posed

_MOST_DOTS = 2000
_COLUMNS = 600
_EPS = float(np.finfo(np.float64).eps)
_VISIBLE = 1e-3  # half-width of the band, in units of the axis, from which it is wider than a hairline
_EXPECTED = {
    True: "exact by theorem, up to rounding",
    False: "not exact for this discretization",
    None: "error of the solver",
}
_THINNED = "with the work of forces, which no thinned run knows"


@dataclasses.dataclass(frozen=True)
class EnergyError:
    """The artists of `energy_error`.

    Attributes:
        axes: The axes.
        error: Dots, or for long orbits the band between the smallest and the
            largest error in each column; a line for a flow.
        rounding: The band of relative errors up to machine epsilon.
        unit: What 1 on the axis means.
        expected: Whether the error should be zero but for rounding, in words.
    """

    axes: Axes
    error: PathCollection | PolyCollection | Line2D
    rounding: Rectangle
    unit: float
    expected: Text


@theme.styled
def energy_error(orbit: AbstractOrbit, axes: Axes | None = None, **look: Unpack[theme.Look]) -> EnergyError:
    r"""Draw the relative error of the reduced constrained energy, under forces that of their balance, against time.

    $$ (E_k - E_0)/E_0, \qquad (E_k - E_0 - W_k)/\max_j|E_j| \text{ under forces that do the work } W_k, $$

    in units of 1e-16, or of a larger power of ten where rounding is not what is seen. The shaded band is the machine
    epsilon 2.2e-16 of double precision to either side. At rest, where E_0 = 0, the error is absolute. A line of
    text says whether a theorem makes the energy of this discretization exact (`Discretization.conserves_energy`).

    Args:
        orbit: The orbit.
        axes: Where to draw; a new figure by default.
        **look: Title, label, color and more: `nh.plot.Look`.

    Raises:
        ValueError: No orbit, one without states, or one without poses whose energy depends on them.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
        >>> orbit = nh.simulate(sleigh, body_velocity=(1, 0, 0), steps=50)
        >>> nh.plot.energy_error(orbit).unit
        1e-16
    """
    orbit = drawable_in_time("energy_error(orbit=...)", orbit)
    if not orbit.has_poses and orbit.system.is_spatial:
        posed("energy_error(orbit=...)", orbit)
    axes = theme.axes_or_new(axes, (6.0, 2.6))
    work, is_known = np.nan_to_num(orbit.known_work), bool(np.isfinite(orbit.known_work).all())
    balanced = bool(work.any())
    energy, name = orbit.energy - work, "(E - W)" if balanced else "E"
    size = np.abs(orbit.energy).max()
    error = (energy - energy[0]) / (size or 1.0)
    unit = _unit(float(np.abs(error).max()))
    rounding, drawn = _over_rounding(orbit, axes, error / unit, unit)
    theme.write_title(axes, "Energy less work" if balanced else "Energy error" if is_known else "Change of energy")
    _dress(axes, orbit.time, error / unit, unit, rf"\Delta {name}{'/E' if size else ''}")
    small: Any = {"color": theme.QUIET, "fontsize": "medium", "va": "top", "path_effects": theme.HALO, "zorder": 6}
    expected = axes.text(
        0.012, 0.97, _expected(orbit, balanced) if is_known else _THINNED, transform=axes.transAxes, **small
    )
    return EnergyError(axes, drawn, rounding, unit, expected)


@theme.styled
def draw_residual(orbit: Any, axes: Axes) -> None:
    """Draw the residual of the constraint of an orbit that knows it, in the same way."""
    residual = orbit.constraint_residual
    unit = _unit(float(np.abs(residual).max()))
    _over_rounding(orbit, axes, residual / unit, unit)
    theme.write_title(axes, "Residual of the constraint")
    _dress(axes, orbit.time, residual / unit, unit, "|F|" if orbit.is_discrete else r"|A\,v|")
    axes.set_ylim(bottom=0.0)


def _over_rounding(
    orbit: AbstractOrbit, axes: Axes, error: Float[np.ndarray, "K"], unit: float
) -> tuple[Rectangle, PathCollection | PolyCollection | Line2D]:
    """Draw errors in a unit over the band of rounding."""
    shown = "machine epsilon" if _EPS / unit > _VISIBLE else "_machine epsilon"  # a legend of what can be seen
    band: Any = {"color": theme.LEVEL, "alpha": 0.45, "linewidth": 0, "zorder": 0, "label": shown}
    rounding = axes.axhspan(-_EPS / unit, _EPS / unit, **band)
    axes.axhline(0.0, color=theme.LEVEL, linewidth=0.8, zorder=1)
    return rounding, (_error if orbit.is_discrete else _curve)(axes, orbit.time, error)


def _expected(orbit: AbstractOrbit, balanced: bool) -> str:
    if orbit.is_measured:
        return "of given poses"
    motion = orbit.motion
    exact = isinstance(motion, Discretization) and motion.is_balanced and motion.order == 2 and orbit.has_every_step
    if not balanced or exact:
        return _EXPECTED[exact or orbit.conserves_energy]
    return "of order 2 in the time between states"


def _unit(largest: float) -> float:
    return 1e-16 if largest < 1e-13 else float(f"1e{math.floor(math.log10(largest))}")


def _error(axes: Axes, time: Float[np.ndarray, "K"], error: Float[np.ndarray, "K"]) -> PathCollection | PolyCollection:
    if len(time) <= _MOST_DOTS:
        return axes.scatter(time, error, s=5, linewidths=0, zorder=3, **theme.named(theme.DISCRETE))
    starts = np.arange(0, len(time), math.ceil(len(time) / _COLUMNS))
    low, high = np.minimum.reduceat(error, starts), np.maximum.reduceat(error, starts)
    return axes.fill_between(time[starts], low, high, linewidth=0.8, zorder=3, **theme.named(theme.DISCRETE))


def _curve(axes: Axes, time: Float[np.ndarray, "K"], error: Float[np.ndarray, "K"]) -> Line2D:
    chosen = evenly_in_box(np.stack([time, error], axis=1), _MOST_DOTS)
    return axes.plot(time[chosen], error[chosen], linewidth=1.0, zorder=3, **theme.named(theme.CONTINUOUS))[0]


def _dress(axes: Axes, time: Any, error: Float[np.ndarray, "K"], unit: float, name: str) -> None:
    exponent = math.floor(math.log10(unit) + 0.5)
    reach = 1.4 * max(float(np.abs(error).max()), 1.6 * _EPS / unit)
    axes.set(xlabel="time", ylabel=rf"${name}$   [$10^{{{exponent}}}$]")
    axes.margins(y=0.0)
    axes.update_datalim([(time[0], -reach), (time[-1], reach)])
    axes.autoscale_view()
    theme.legend_above(axes)
