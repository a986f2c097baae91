"""An orbit in time: velocity, momentum, heading and speed. These are panels of the overview."""

import dataclasses
import itertools
from typing import Any, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from nonholo.base.types import Float
from nonholo.groups import SE, SO, AbstractMatrixGroup
from nonholo.orbit import Orbit
from nonholo.plotting import theme
from nonholo.plotting.parts import evenly_in_box
from nonholo.plotting.sheets import Blade, blade_of_system

_MOST_POINTS = 2000
_MOST_LINES = 60  # momenta in one panel


@dataclasses.dataclass(frozen=True)
class TimeSeries:
    """Lines against time.

    Attributes:
        axes: The axes; two of them if the lines have different scales.
        lines: One line for each quantity.
    """

    axes: tuple[Axes, ...]
    lines: tuple[Line2D, ...]


def velocity_components(orbit: Orbit, axes: Axes, flow: Orbit | None = None) -> TimeSeries:
    """Draw the components of the body velocity that the constraint leaves free, against time."""
    free = np.flatnonzero(np.abs(_allowed(orbit)).max(axis=0, initial=0.0) > 0)
    names = _velocity_names(orbit.system.group)
    lines = _components(orbit, axes, orbit.body_velocity[:, free], [names[i] for i in free])
    if flow is not None:
        for component in free:
            _flow(axes, flow.time, flow.body_velocity[:, component], named=component == free[-1])
    _dress(axes, orbit, "Body velocity")
    return TimeSeries((axes,), lines)


def momentum_components(orbit: Orbit, axes: Axes, flow: Orbit | None = None) -> TimeSeries:
    """Draw the momenta along the rows of the constraint subspace, in space for a right-invariant one, against time.

    Of very many those are drawn that become largest.
    """
    momentum = orbit.restricted_momentum
    k = momentum.shape[1]
    shown = np.sort(np.argsort(-np.abs(momentum).max(axis=0, initial=0.0), kind="stable")[:_MOST_LINES])
    lines = _components(orbit, axes, momentum[:, shown], [f"$r_{{{i + 1}}}$" for i in shown])
    if flow is not None:
        for component, values in enumerate(flow.restricted_momentum[:, shown].T):
            _flow(axes, flow.time, values, named=component == len(shown) - 1)
    kind = "Spatial momentum" if orbit.system.is_spatial else "Momentum"
    of_many = "" if k <= _MOST_LINES else f", the {_MOST_LINES} largest of {k}"
    _dress(axes, orbit, f"{kind} along the constraint{of_many}")
    return TimeSeries((axes,), lines)


def heading_and_speed(orbit: Orbit, axes: Axes, flow: Orbit | None = None) -> TimeSeries:
    """Draw the heading of a sleigh (left scale) and the speed along its blade (right scale) against time."""
    right = axes.twinx()
    lines = []
    for one, name, values in ((axes, r"heading  $\theta/\pi$", _heading), (right, "speed  $v_1$", _speed)):
        color = theme.COMPONENTS[len(lines)]
        lines.append(_line(one, orbit.time, values(orbit), color))
        if flow is not None:
            _flow(one, flow.time, values(flow), named=one is right)
        one.set_ylabel(name, color=color)
        one.tick_params(axis="y", labelcolor=color)
        one.margins(y=0.12)
    right.spines["right"].set_visible(True)
    right.axhline(0.0, color=theme.COMPONENTS[1], linewidth=0.7, dashes=(4, 3), zorder=1)
    axes.set_title("Heading and speed")
    theme.mark_time(right, orbit)
    theme.legend_above(right)
    return TimeSeries((axes, right), tuple(lines))


def _heading(orbit: Orbit) -> Float[np.ndarray, "K"]:
    return cast(Blade, blade_of_system(orbit.system)).heading(orbit) / np.pi


def _speed(orbit: Orbit) -> Float[np.ndarray, "K"]:
    return cast(Blade, blade_of_system(orbit.system)).speed(orbit)


def _line(
    axes: Axes, time: Float[np.ndarray, "K"], values: Float[np.ndarray, "K"], color: str, label: str | None = None
) -> Line2D:
    chosen = evenly_in_box(np.stack([time, values], axis=1), _MOST_POINTS)
    marker = "o" if len(time) == 1 else None
    look: dict[str, Any] = {"color": color, "linewidth": 2.0, "marker": marker, "label": label, "zorder": 3}
    return axes.plot(time[chosen], values[chosen], **look)[0]


def _flow(axes: Axes, time: Float[np.ndarray, "K"], values: Float[np.ndarray, "K"], named: bool) -> None:
    line = _line(axes, time, values, theme.CONTINUOUS, "continuous" if named else None)
    line.set(linewidth=1.3, dashes=(3, 3), zorder=4)


def _components(orbit: Orbit, axes: Axes, values: Float[np.ndarray, "K m"], names: list[str]) -> tuple[Line2D, ...]:
    """Draw one line for each column, thin and without names where there are too many to tell apart."""
    colors = theme.component_colors(len(names))
    few = len(names) <= len(theme.COMPONENTS)
    rows = zip(values.T, colors, names, strict=True)
    lines = tuple(_line(axes, orbit.time, row, color, label=name if few else None) for row, color, name in rows)
    if not few:
        for line in lines:
            line.set_linewidth(1.0)
        axes.text(0.99, 0.97, f"{names[0]} to {names[-1]}", transform=axes.transAxes, ha="right", va="top")
    return lines


def _dress(axes: Axes, orbit: Orbit, title: str) -> None:
    axes.axhline(0.0, color=theme.LEVEL, linewidth=0.8, zorder=1)
    if not any(np.any(line.get_ydata()) for line in axes.lines):
        axes.set_ylim(-1.0, 1.0)
    axes.set_title(title)
    axes.margins(y=0.12)
    theme.mark_time(axes, orbit)
    theme.legend_above(axes)


def _allowed(orbit: Orbit) -> Float[np.ndarray, "m dim"]:
    """Return rows that span all body velocities the orbit could have."""
    return np.eye(orbit.system.group.dim) if orbit.system.is_spatial else orbit.system.constraint_subspace


def _velocity_names(group: AbstractMatrixGroup) -> list[str]:
    if group == SE(2):
        return [r"$\omega$", "$v_1$", "$v_2$"]
    if not group.is_rigid:
        return [rf"$\xi_{{{i + 1}}}$" for i in range(group.dim)]
    moves = group != SO(group.size)
    n = group.size - 1 if moves else group.size
    comma = "" if n < 10 else ","
    planes = ["1", "2", "3"] if n == 3 else [f"{i}{comma}{j}" for i, j in itertools.combinations(range(1, n + 1), 2)]
    return [rf"$\omega_{{{plane}}}$" for plane in planes] + [f"$v_{{{i + 1}}}$" for i in range(n * moves)]
