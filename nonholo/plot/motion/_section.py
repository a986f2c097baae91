"""Poincare sections: two quantities of the states at the crossings of an event."""

import dataclasses
from collections.abc import Callable
from typing import Any, Unpack

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection

from nonholo.base.calls import call, check_result
from nonholo.base.checks import error, function, pair, shown, text
from nonholo.base.types import Float
from nonholo.orbit import Orbit
from nonholo.plot import theme
from nonholo.simulation import Crossings

_FEW, _LARGE, _SMALL = 500, 14.0, 4.0  # up to this many dots are large; areas of dots

Quantity = Callable[[Orbit], Float[np.ndarray, "C"]]


@dataclasses.dataclass(frozen=True)
class Section:
    """The artists of `section`.

    Attributes:
        axes: The axes.
        points: The drawn points.
        dots: One dot for each crossing, colored by its time.
    """

    axes: Axes
    points: Float[np.ndarray, "C 2"]
    dots: PathCollection


@theme.styled
def section(
    crossings: Crossings,
    across: Quantity,
    up: Quantity,
    axes: Axes | None = None,
    labels: tuple[str, str] = ("", ""),
    **look: Unpack[theme.Look],
) -> Section:
    """Draw a Poincare section: one dot for each crossing of an event, colored from early to late.

    Args:
        crossings: What an event found: `orbit.events["name"]` or `nh.crossings(orbit, event)`.
        across: The abscissa, a function of an orbit that returns one number for each of its states.
        up: The ordinate.
        axes: Where to draw; a new figure by default.
        labels: Names of the axes; by default those of the functions.
        **look: Title, label, color and more: `nh.plot.Look`.

    Raises:
        ValueError: No crossings at all, or quantities of the wrong shape.

    Example:
        >>> top = nh.discretize(nh.VeselovaTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 0.1)
        >>> level = nh.Event(lambda states: states.configuration[:, 2, 2], direction=1, stop=20)
        >>> orbit = nh.simulate(top, restricted_velocity=(1.0, -0.6), steps=10_000, events=[level])
        >>> picture = nh.plot.section(
        ...     orbit.events[0], lambda states: states.body_velocity[:, 0], lambda states: states.body_velocity[:, 1]
        ... )
        >>> picture.points.shape
        (20, 2)
    """
    if not isinstance(crossings, Crossings) or not len(crossings):
        remedy = "Pass `orbit.events[...]` of a run that crosses."
        raise error("section(crossings=...)", "hold crossings of an event", shown(crossings), remedy)
    function("section(across=...)", across)
    function("section(up=...)", up)
    given = [text("section(labels=...)", label) for label in pair("section(labels=...)", labels)]
    across_label, up_label = given[0] or _name_of(across, "across"), given[1] or _name_of(up, "up")
    points = np.stack([_values("across", across, crossings), _values("up", up, crossings)], axis=1)
    axes = theme.axes_or_new(axes, (6.0, 5.0))
    area = _LARGE if len(points) <= _FEW else _SMALL
    color = theme.asked("color", None)
    colors: Any = {"c": crossings.time, "cmap": theme.TIME} if color is None else {"color": color}
    dots = axes.scatter(*points.T, s=area, linewidths=0, label=theme.asked("label", None), **colors)
    axes.set(xlabel=across_label, ylabel=up_label)
    axes.margins(0.06)
    theme.write_title(axes, f"{len(points)} crossings")
    theme.legend_above(axes)
    return Section(axes, points, dots)


def _name_of(quantity: Quantity, otherwise: str) -> str:
    name = getattr(quantity, "__name__", "<lambda>")
    return otherwise if name == "<lambda>" else name.strip("_").replace("_", " ")


def _values(name: str, quantity: Quantity, crossings: Crossings) -> Float[np.ndarray, "C"]:
    where, remedy = (
        f"section({name}=...)",
        "It gets an `Orbit`: return an array with one number for each of its states.",
    )
    found, words = call(where, quantity, crossings.states), ("one number for each crossing", remedy)
    return check_result(where, quantity, found, (len(crossings),), words, lambda at: f"time {crossings.time[at]:.17g}")
