"""An orbit in time: velocity, momentum, heading and speed. These are panels of the overview."""

import itertools
from collections.abc import Callable
from typing import Any, TypeVar, cast

import numpy as np
from matplotlib.axes import Axes

from nonholo.base.types import Float
from nonholo.groups import SE, SO, AbstractMatrixGroup
from nonholo.orbit import AbstractOrbit, Orbit
from nonholo.plot import theme
from nonholo.plot.parts import evenly_in_box
from nonholo.plot.sheets import Blade, blade_of_system

AnyOrbit = TypeVar("AnyOrbit", bound=AbstractOrbit)
_MOST_POINTS = 2000
_MOST_LINES = 60  # momenta in one panel


@theme.styled
def velocity_components(orbit: Orbit, axes: Axes, flow: Orbit | None = None) -> None:
    """Draw the components of the body velocity that the constraint leaves free, against time."""
    system = orbit.system
    allowed = np.eye(system.group.dim) if system.is_spatial else system.constraint_subspace
    free = np.flatnonzero(np.abs(allowed).max(axis=0, initial=0.0) > 0)
    names = velocity_names(system.group)
    theme.write_title(axes, "Body velocity")
    draw_components(axes, orbit, flow, lambda states: states.body_velocity[:, free], [names[i] for i in free])
    axes.set_ylabel("velocity")


@theme.styled
def momentum_components(orbit: Orbit, axes: Axes, flow: Orbit | None = None) -> None:
    """Draw the momenta along the rows of the constraint subspace, in space for a right-invariant one, against time.

    Of very many those are drawn that become largest.
    """
    momentum = orbit.restricted_momentum
    k = momentum.shape[1]
    shown = np.sort(np.argsort(-np.abs(momentum).max(axis=0, initial=0.0), kind="stable")[:_MOST_LINES])
    kind = "Spatial momentum" if orbit.system.is_spatial else "Momentum"
    of_many = "" if k <= _MOST_LINES else f", the {_MOST_LINES} largest of {k}"
    theme.write_title(axes, f"{kind} along the constraint{of_many}")
    names = [f"$r_{{{i + 1}}}$" for i in shown]
    draw_components(axes, orbit, flow, lambda states: states.restricted_momentum[:, shown], names)
    axes.set_ylabel("momentum")


@theme.styled
def heading_and_speed(orbit: Orbit, axes: Axes, flow: Orbit | None = None) -> None:
    """Draw the heading of a sleigh (left scale) and the speed along its blade (right scale) against time."""
    right = axes.twinx()
    scales = ((axes, r"heading  $\theta/\pi$", _heading), (right, "speed  $v_1$", _speed))
    for (one, name, values), color in zip(scales, theme.COMPONENTS, strict=False):
        _line(one, orbit.time, values(orbit), color=color, linewidth=2.0, zorder=3)
        if flow is not None:
            _flow(one, flow.time, values(flow), named=one is right)
        one.set_ylabel(name, color=color)
        one.tick_params(axis="y", labelcolor=color)
        one.margins(y=0.12)
    right.spines["right"].set_visible(True)
    right.axhline(0.0, color=theme.COMPONENTS[1], linewidth=0.7, dashes=(4, 3), zorder=1)
    theme.write_title(axes, "Heading and speed")
    theme.mark_time(right, orbit)
    theme.legend_above(right)


def _heading(orbit: Orbit) -> Float[np.ndarray, "K"]:
    return cast(Blade, blade_of_system(orbit.system)).heading(orbit) / np.pi


def _speed(orbit: Orbit) -> Float[np.ndarray, "K"]:
    return cast(Blade, blade_of_system(orbit.system)).speed(orbit)


def _line(axes: Axes, time: Float[np.ndarray, "K"], values: Float[np.ndarray, "K"], **look: Any) -> None:
    chosen = evenly_in_box(np.stack([time, values], axis=1), _MOST_POINTS)
    axes.plot(time[chosen], values[chosen], marker="o" if len(time) == 1 else None, **look)


def _flow(axes: Axes, time: Float[np.ndarray, "K"], values: Float[np.ndarray, "K"], named: bool) -> None:
    look: Any = {"color": theme.CONTINUOUS, "linewidth": 1.3, "dashes": (3, 3), "zorder": 4}
    _line(axes, time, values, label="continuous" if named else None, **look)


def draw_components(
    axes: Axes, orbit: AnyOrbit, flow: AnyOrbit | None, quantity: Callable[[AnyOrbit], np.ndarray], names: list[str]
) -> None:
    """Draw one line for each component of a quantity, thin and without names where there are too many to tell apart."""
    few = len(names) <= len(theme.COMPONENTS)
    for values, color, name in zip(quantity(orbit).T, theme.component_colors(len(names)), names, strict=True):
        look = {"color": color, "linewidth": 2.0 if few else 1.0, "label": name if few else None, "zorder": 3}
        _line(axes, orbit.time, values, **look)
    if not few:
        axes.text(0.99, 0.97, f"{names[0]} to {names[-1]}", transform=axes.transAxes, ha="right", va="top")
    if flow is not None:
        for number, values in enumerate(quantity(flow).T, start=1):
            _flow(axes, flow.time, values, named=number == len(names))
    axes.axhline(0.0, color=theme.LEVEL, linewidth=0.8, zorder=1)
    if not any(np.any(line.get_ydata()) for line in axes.lines):
        axes.set_ylim(-1.0, 1.0)
    axes.margins(y=0.12)
    theme.mark_time(axes, orbit)
    theme.legend_above(axes)


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
