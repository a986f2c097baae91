"""The part of a motion that a film shows, its trail, and the point where it is."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, TypeAlias, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from nonholo.base.types import Float, Int
from nonholo.orbit import AbstractOrbit, Orbit
from nonholo.plot import theme
from nonholo.plot.parts import evenly_spread, some_states, turn_per_state, window

Show: TypeAlias = Callable[[int], None]
"""A function that shows a frame."""
Points: TypeAlias = Callable[[Any], Float[np.ndarray, "K d"]]
"""A function of states that gives their points."""

_BETWEEN = 8  # states of a flow from frame to frame
_MOST_PIECES = 1500  # of a trail
_TURN, _WAY = np.radians(15.0), 0.12  # most of a turn, and of the length of a body, between two frames


class Part(NamedTuple):
    """A part of a motion.

    Attributes:
        path: The states on its path.
        frames: The states of the frames.
        past: How many states of the path are past in each frame.
        is_flow: Whether it is the continuous motion beside another one.
    """

    path: Any
    frames: Any
    past: Int[np.ndarray, "F"]
    is_flow: bool = False


def shown_states(orbit: AbstractOrbit, motion: float, total: int) -> Int[np.ndarray, "F"]:
    """Return the states of the frames: the whole orbit, or the part about the transition if it moves too fast for that.

    `motion` is the motion of the body between two saved states, in units of what the eye can follow; 0 for all.
    """
    stride = max(1, int(1 / motion)) if motion > 0 else len(orbit)
    if len(orbit) <= stride * total:
        return np.linspace(0, len(orbit) - 1, total).round().astype(int)
    return np.arange(len(orbit))[window(cast(Orbit, orbit), motion, 1.0, total)]


def part_of(orbit: AbstractOrbit, states: Int[np.ndarray, "F"]) -> Part:
    """Return the part of an orbit between the states of the frames."""
    return Part(orbit.chosen(slice(states[0], states[-1] + 1)), orbit.chosen(states), states - states[0] + 1)


def part_of_flow(flow: AbstractOrbit, times: Float[np.ndarray, "F"]) -> Part:
    """Return a flow at the times of the frames and between them; at its nearest states if it has no others."""
    at = np.arange(_BETWEEN * (len(times) - 1) + 1)
    between = np.interp(at / _BETWEEN, np.arange(len(times)), times)
    if flow.span is None:
        onward = np.sign(flow.time[-1] - flow.time[0])
        nearest = np.interp(onward * between, onward * flow.time, np.arange(len(flow)))
        path = flow.chosen(nearest.round().astype(int))
    else:
        path = flow.at(between.clip(*np.sort(flow.span)))
    return Part(path, path.chosen(slice(None, None, _BETWEEN)), at[::_BETWEEN] + 1, is_flow=True)


def motion_of(orbit: Orbit, point: Float[np.ndarray, "n dim"], length: float) -> float:
    """Return the motion of a body between saved states, in units of what the eye can follow from frame to frame.

    Args:
        orbit: The orbit, on SE(n).
        point: The map from a body velocity to the velocity of the point to follow.
        length: Of the body.
    """
    if len(orbit) < 2:
        return 0.0
    speed = np.linalg.norm(some_states(orbit, 1000).body_velocity @ point.T, axis=1).max()
    return float(max(turn_per_state(orbit) / _TURN, speed * np.abs(np.diff(orbit.time)).max() / (_WAY * length)))


def together(shows: Sequence[Show]) -> Show:
    """Return what shows all of them."""

    def show(frame: int) -> None:
        for each in shows:
            each(frame)

    return show


def draw_trail(
    axes: Axes, orbit: AbstractOrbit, part: Part, path: Float[np.ndarray, "L 2"], *, color: Any = None, **look: Any
) -> Show:
    """Return what draws the points of a path up to a frame, in the colors of time, or as the line of a flow."""
    at = evenly_spread(path, _MOST_PIECES)
    pieces, past = theme.pieces(path[at]), np.searchsorted(at, part.past - 1, side="right")
    if color is None:
        color = theme.CONTINUOUS if part.is_flow else theme.time_colors(orbit, part.path.time[at][1:])
    look = {"linewidth": 1.2 if part.is_flow else 2, "zorder": 2} | look
    trail = LineCollection(pieces, colors=color, **look)
    axes.add_collection(trail, autolim=False)
    return lambda frame: trail.set_segments(pieces[: past[frame] - 1])


def draw_point(axes: Axes, part: Part, points: Float[np.ndarray, "F 2"]) -> Show:
    """Return what draws the point of a frame, as a ring for a flow."""
    color = theme.CONTINUOUS if part.is_flow else theme.option("color", theme.INK)
    face = "none" if part.is_flow else color
    dot = axes.plot([], [], "o", markersize=8, markerfacecolor=face, color=color, zorder=4)[0]
    return lambda frame: dot.set_data(*points[frame : frame + 1].T)


def name_of_trail(part: Part) -> str | None:
    """Return what the legend calls a trail."""
    return "continuous" if part.is_flow else theme.option("label", None)
