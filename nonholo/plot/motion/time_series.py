"""Orbits in time: velocity, momentum, heading and speed; errors of energy and constraint, beside those of rounding."""

import itertools
import math
from collections.abc import Callable
from typing import Any, NamedTuple, Unpack, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection, PolyCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.text import Text

from nonholo.base.types import Float
from nonholo.discrete import Discretization
from nonholo.groups import SE, SO, AbstractMatrixGroup
from nonholo.orbit import AbstractOrbit, Orbit
from nonholo.plot import theme
from nonholo.plot.parts import draw_line, drawable_in_time, orbit_with_poses
from nonholo.plot.sheets import StripSheet, strip_of

Series = Callable[[Any], np.ndarray]
MOST_LINES = 60  # momenta, or velocities, in one panel


@theme.in_style
def velocity_components(orbit: Orbit, axes: Axes, flow: Orbit | None = None) -> None:
    """Draw the components of the body velocity that the constraint leaves free, against time."""
    system = orbit.system
    directions = np.eye(system.group.dim) if system.is_spatial else system.constraint_subspace
    free = np.flatnonzero(np.abs(directions).max(axis=0, initial=0.0) > 0)
    names = [velocity_names(system.group)[i] for i in free]
    draw_components(axes, orbit, flow, lambda states: states.body_velocity[:, free], names, "Body velocity", "velocity")


@theme.in_style
def momentum_components(orbit: Orbit, axes: Axes, flow: Orbit | None = None) -> None:
    """Draw the momenta along the rows of the constraint subspace, in space for a right-invariant one, against time.

    Of very many those are drawn that become largest.
    """
    momentum = orbit.restricted_momentum
    k = momentum.shape[1]
    largest = np.sort(np.argsort(-np.abs(momentum).max(axis=0, initial=0.0), kind="stable")[:MOST_LINES])
    kind = "Spatial momentum" if orbit.system.is_spatial else "Momentum"
    of_many = "" if k <= MOST_LINES else f", the {MOST_LINES} largest of {k}"
    title, names = f"{kind} along the constraint{of_many}", [f"$r_{{{i + 1}}}$" for i in largest]
    draw_components(axes, orbit, flow, lambda states: states.restricted_momentum[:, largest], names, title, "momentum")


@theme.in_style
def heading_and_speed(orbit: Orbit, axes: Axes, flow: Orbit | None = None) -> None:
    """Draw the heading of a sleigh (left scale) and the speed along its blade (right scale) against time."""
    right = axes.twinx()
    scales = ((axes, r"heading  $\theta/\pi$"), (right, "speed  $v_1$"))
    for row, ((one, name), color) in enumerate(zip(scales, theme.COMPONENTS, strict=False)):
        draw_line(one, orbit.time, _turn_and_speed(orbit)[row], color=color, linewidth=2.0, zorder=3)
        if flow is not None:
            _flow(one, flow.time, _turn_and_speed(flow)[row], has_label=one is right)
        one.set_ylabel(name, color=color)
        one.tick_params(axis="y", labelcolor=color)
        one.margins(y=0.12)
    right.spines["right"].set_visible(True)
    right.axhline(0.0, color=theme.COMPONENTS[1], linewidth=0.7, dashes=(4, 3), zorder=1)
    theme.write_title(axes, "Heading and speed")
    theme.mark_time(right, orbit)
    theme.legend_above(right)


def _turn_and_speed(orbit: Orbit) -> tuple[Float[np.ndarray, "K"], Float[np.ndarray, "K"]]:
    strip = cast(StripSheet, strip_of(orbit.system))
    return strip.heading(orbit) / np.pi, strip.speed(orbit)


def _flow(axes: Axes, time: Float[np.ndarray, "K"], values: Float[np.ndarray, "K"], has_label: bool) -> None:
    look: Any = {"color": theme.CONTINUOUS, "linewidth": 1.3, "dashes": (3, 3), "zorder": 4}
    draw_line(axes, time, values, label="continuous" if has_label else None, **look)


def draw_components(
    axes: Axes, orbit: AbstractOrbit, flow: AbstractOrbit | None, of: Series, names: list[str], title: str, up: str
) -> None:
    """Draw one line for each component of a quantity, thin and without names where there are many."""
    few = len(names) <= len(theme.COMPONENTS)
    for values, color, name in zip(of(orbit).T, theme.component_colors(len(names)), names, strict=True):
        look = {"color": color, "linewidth": 2.0 if few else 1.0, "label": name if few else None, "zorder": 3}
        draw_line(axes, orbit.time, values, **look)
    if not few:
        axes.text(0.99, 0.97, f"{names[0]} to {names[-1]}", transform=axes.transAxes, ha="right", va="top")
    if flow is not None:
        for number, values in enumerate(of(flow).T, start=1):
            _flow(axes, flow.time, values, has_label=number == len(names))
    axes.axhline(0.0, color=theme.LEVEL, linewidth=0.8, zorder=1)
    if not any(np.any(line.get_ydata()) for line in axes.lines):
        axes.set_ylim(-1.0, 1.0)
    axes.margins(y=0.12)
    axes.set_ylabel(up)
    theme.mark_time(axes, orbit)
    theme.legend_above(axes, title)


def velocity_names(group: AbstractMatrixGroup) -> list[str]:
    """Return the names of the components of a body velocity."""
    if group == SE(2):
        return [r"$\omega$", "$v_1$", "$v_2$"]
    if not group.is_rigid:
        return [rf"$\xi_{{{i + 1}}}$" for i in range(group.dim)]
    moves = group != SO(group.size)
    n = group.size - 1 if moves else group.size
    comma = "" if n < 10 else ","
    planes = ["1", "2", "3"] if n == 3 else [f"{i}{comma}{j}" for i, j in itertools.combinations(range(1, n + 1), 2)]
    return [rf"$\omega_{{{plane}}}$" for plane in planes] + [f"$v_{{{i + 1}}}$" for i in range(n * moves)]


_MOST_DOTS = 2000
_COLUMNS = 600
_EPS = float(np.finfo(np.float64).eps)
_VISIBLE = 1e-3  # half-width of the band, in units of the axis, from which it is wider than a hairline
_EXPECTED = {
    True: "exact by theorem, up to rounding",
    False: "not exact for this discretization",
    None: "error of the solver",
}
_THINNED = "includes the work of forces, which a thinned run does not record"


class EnergyError(NamedTuple):
    """The artists of `energy_error`.

    Attributes:
        axes: The axes.
        error: Dots, or for long orbits the band between the smallest and the
            largest error in each column; a line for a flow.
        rounding: The band of relative errors up to machine epsilon.
        unit: The meaning of 1 on the axis.
        expected: Whether the error should be zero up to rounding, in words.
    """

    axes: Axes
    error: PathCollection | PolyCollection | Line2D
    rounding: Rectangle
    unit: float
    expected: Text


@theme.in_style
def energy_error(orbit: AbstractOrbit, axes: Axes | None = None, **look: Unpack[theme.Look]) -> EnergyError:
    r"""Draw the relative error of the reduced constrained energy, under forces that of their balance, against time.

    $$ (E_k - E_0)/E_0, \qquad (E_k - E_0 - W_k)/\max_j|E_j| \text{ under forces that do the work } W_k, $$

    in units of 1e-16, or of a larger power of ten where rounding is not what is seen. The shaded band is the machine
    epsilon 2.2e-16 of double precision to either side. At rest, where E_0 = 0, the error is absolute. A line of
    text states whether a theorem makes the energy of this discretization exact (`Discretization.conserves_energy`).

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
        orbit_with_poses("energy_error(orbit=...)", orbit)
    axes = theme.axes_or_new(axes, (6.0, 2.6))
    work, is_known = np.nan_to_num(orbit.known_work), bool(np.isfinite(orbit.known_work).all())
    has_work = bool(work.any())
    energy, name = orbit.energy - work, "(E - W)" if has_work else "E"
    size = np.abs(orbit.energy).max()
    error = (energy - energy[0]) / (size or 1.0)
    unit = _unit(float(np.abs(error).max()))
    rounding, dots = _over_rounding(orbit, axes, error / unit, unit)
    theme.write_title(axes, "Energy less work" if has_work else "Energy error" if is_known else "Change of energy")
    _dress(axes, orbit.time, error / unit, unit, rf"\Delta {name}{'/E' if size else ''}")
    small: Any = {"color": theme.QUIET, "fontsize": "medium", "va": "top", "path_effects": theme.HALO, "zorder": 6}
    outlook = _expectation(orbit, has_work) if is_known else _THINNED
    return EnergyError(axes, dots, rounding, unit, axes.text(0.012, 0.97, outlook, transform=axes.transAxes, **small))


@theme.in_style
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
    label = "machine epsilon" if _EPS / unit > _VISIBLE else "_machine epsilon"  # a legend of what can be seen
    band: Any = {"color": theme.LEVEL, "alpha": 0.45, "linewidth": 0, "zorder": 0, "label": label}
    rounding = axes.axhspan(-_EPS / unit, _EPS / unit, **band)
    axes.axhline(0.0, color=theme.LEVEL, linewidth=0.8, zorder=1)
    time, own = orbit.time, theme.own_look(theme.DISCRETE)
    if orbit.is_discrete and len(time) <= _MOST_DOTS:
        return rounding, axes.scatter(time, error, s=5, linewidths=0, zorder=3, **own)
    if orbit.is_discrete:
        starts = np.arange(0, len(time), math.ceil(len(time) / _COLUMNS))
        low, high = np.minimum.reduceat(error, starts), np.maximum.reduceat(error, starts)
        return rounding, axes.fill_between(time[starts], low, high, linewidth=0.8, zorder=3, **own)
    return rounding, draw_line(axes, time, error, linewidth=1.0, zorder=3, **theme.own_look(theme.CONTINUOUS))


def _expectation(orbit: AbstractOrbit, has_work: bool) -> str:
    if orbit.is_measured:
        return "of given poses"
    motion = orbit.motion
    exact = isinstance(motion, Discretization) and motion.has_exact_work(cast(Orbit, orbit))
    if not has_work or exact:
        return _EXPECTED[exact or orbit.conserves_energy]
    return "of order 2 in the time between states"


def _unit(largest: float) -> float:
    return 1e-16 if largest < 1e-13 else float(f"1e{math.floor(math.log10(largest))}")


def _dress(axes: Axes, time: Any, error: Float[np.ndarray, "K"], unit: float, name: str) -> None:
    reach = 1.4 * max(float(np.abs(error).max()), 1.6 * _EPS / unit)
    axes.set(xlabel="time", ylabel=rf"${name}$   [$10^{{{math.floor(math.log10(unit) + 0.5)}}}$]")
    axes.margins(y=0.0)
    axes.update_datalim([(time[0], -reach), (time[-1], reach)])
    axes.autoscale_view()
    theme.legend_above(axes)
