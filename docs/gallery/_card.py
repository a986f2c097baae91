"""The look of the pictures with a path and a quantity beside it."""

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from nonholo.plot import theme

COLORS = (theme.DISCRETE, theme.CONTINUOUS, "#d55e00", "#009e73")


class Curve(NamedTuple):
    """Values over others: of a path, or of a quantity over time."""

    x: np.ndarray
    y: np.ndarray
    label: str = ""


@theme.in_style
def card(
    title: str,
    path: Iterable[Curve],
    quantity: Iterable[Curve],
    *,
    plane: tuple[str, str] = ("x", "y"),
    axis: tuple[str, str] = ("time", ""),
    equal: bool = True,
) -> Figure:
    """Draw curves in a plane, each with its start as a ring, and beside them others over time."""
    figure = Figure(figsize=(10.0, 4.4), layout="constrained")
    left, right = figure.subplots(1, 2)
    _draw(left, path, plane)
    for curve in path:
        left.scatter(curve.x[:1], curve.y[:1], s=26, facecolor="white", edgecolor=theme.INK, zorder=4)
    if equal:
        left.set_aspect("equal", adjustable="datalim")
    left.set_title(title, loc="left")
    _draw(right, quantity, axis)
    return figure


def _draw(axes: Axes, curves: Iterable[Curve], names: tuple[str, str]) -> None:
    named = False
    for curve, color in zip(curves, COLORS, strict=False):
        axes.plot(curve.x, curve.y, color=color, linewidth=1.2, label=curve.label)
        named = named or bool(curve.label)
    axes.set(xlabel=names[0], ylabel=names[1])
    axes.margins(0.08)
    if named:
        axes.legend(loc="best", fontsize="small")


def start(ready: Any) -> dict[str, Any]:
    """Return the start of a ready system as the arguments of `simulate` and `flow`."""
    return {"configuration": ready.configuration, "body_velocity": ready.body_velocity}


def along(orbit: Any) -> np.ndarray:
    """Return the speed in the direction of the third coordinate, an angle."""
    heading, v = orbit.configuration[:, 2], orbit.body_velocity
    return v[:, 0] * np.cos(heading) + v[:, 1] * np.sin(heading)
