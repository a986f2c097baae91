"""What an orbit does in time: body velocity, heading and speed. These are panels of the overview."""

import dataclasses
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from nonholo._types import Float
from nonholo.orbit import Orbit
from nonholo.plotting import _theme as theme
from nonholo.plotting._thinning import evenly_in_box
from nonholo.systems import ChaplyginSleigh

_MOST_POINTS = 2000


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
    free = np.flatnonzero(np.abs(orbit.system.constraint_subspace).max(axis=0) > 0)
    names, velocity = _names(orbit), orbit.body_velocity
    lines = tuple(_line(axes, orbit.time, velocity[:, i], theme.COMPONENTS[i % 3], label=names[i]) for i in free)
    if flow is not None:
        for component in free:
            _flow(axes, flow.time, flow.body_velocity[:, component], named=component == free[-1])
    axes.axhline(0.0, color=theme.LEVEL, linewidth=0.8, zorder=1)
    if not velocity.any():
        axes.set_ylim(-1.0, 1.0)
    axes.set_title("Body velocity")
    axes.margins(y=0.12)
    theme.mark_time(axes, orbit)
    theme.legend_above(axes)
    return TimeSeries((axes,), lines)


def heading_and_speed(orbit: Orbit, axes: Axes, flow: Orbit | None = None) -> TimeSeries:
    """Draw the heading of a sleigh (left scale) and the speed along its blade (right scale) against time."""
    right = axes.twinx()
    lines = []
    for one, name, values in ((axes, r"heading  $\theta/\pi$", _heading), (right, "speed  $v_1$", _speed)):
        colour = theme.COMPONENTS[len(lines)]
        lines.append(_line(one, orbit.time, values(orbit), colour))
        if flow is not None:
            _flow(one, flow.time, values(flow), named=one is right)
        one.set_ylabel(name, color=colour)
        one.tick_params(axis="y", labelcolor=colour)
        one.margins(y=0.12)
    right.spines["right"].set_visible(True)
    right.axhline(0.0, color=theme.COMPONENTS[1], linewidth=0.7, dashes=(4, 3), zorder=1)
    axes.set_title("Heading and speed")
    theme.mark_time(right, orbit)
    theme.legend_above(right)
    return TimeSeries((axes, right), tuple(lines))


def _heading(orbit: Orbit) -> Float[np.ndarray, "K"]:
    return orbit.heading / np.pi


def _speed(orbit: Orbit) -> Float[np.ndarray, "K"]:
    return orbit.body_velocity[:, 1]


def _line(
    axes: Axes, time: Float[np.ndarray, "K"], values: Float[np.ndarray, "K"], colour: str, label: str | None = None
) -> Line2D:
    chosen = evenly_in_box(np.stack([time, values], axis=1), _MOST_POINTS)
    marker = "o" if len(time) == 1 else None
    look: dict[str, Any] = {"color": colour, "linewidth": 2.0, "marker": marker, "label": label, "zorder": 3}
    return axes.plot(time[chosen], values[chosen], **look)[0]


def _flow(axes: Axes, time: Float[np.ndarray, "K"], values: Float[np.ndarray, "K"], named: bool) -> None:
    line = _line(axes, time, values, theme.CONTINUOUS, "continuous" if named else None)
    line.set(linewidth=1.3, dashes=(3, 3), zorder=4)


def _names(orbit: Orbit) -> tuple[str, ...]:
    if isinstance(orbit.system, ChaplyginSleigh):
        return (r"$\omega$", "$v_1$", "$v_2$")
    return tuple(rf"$\omega_{{{i + 1}}}$" for i in range(orbit.system.group.dim))
