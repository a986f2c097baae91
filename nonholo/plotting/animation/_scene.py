"""The stage of an animation: a square figure with a title, the time, and a strip that shows how far time has come."""

from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from nonholo.base.types import Int
from nonholo.orbit import Orbit
from nonholo.plotting import theme

_SIZE = 4.8  # inches; 480 pixels


def stage(title: str, orbit: Orbit, shown: Int[np.ndarray, "F"]) -> tuple[Figure, Axes, Callable[[int], None]]:
    """Return a figure, its axes, and what sets the clock to a frame."""
    figure = Figure(figsize=(_SIZE, _SIZE), dpi=100)
    axes = figure.add_axes((0.02, 0.05, 0.96, 0.88))
    figure.text(0.03, 0.965, title, va="center", fontsize=12, fontweight="bold")
    clock = figure.text(0.97, 0.965, "", va="center", ha="right", family="monospace", fontsize=10, color="#555a62")
    strip = figure.add_axes((0.03, 0.022, 0.94, 0.012), xlim=(0, 1), ylim=(0, 1))
    strip.set_axis_off()
    times = orbit.time[shown]
    colors = theme.TIME(theme.time_scale(orbit)(np.linspace(times[0], times[-1], 256)))
    strip.imshow(colors[None], extent=(0, 1, 0, 1), aspect="auto", alpha=0.9)
    cover = strip.axvspan(0.0, 1.0, color="#e6e8ec", linewidth=0)

    def set_clock(frame: int) -> None:
        done = (frame + 1) / len(shown)
        cover.set(x=done, width=1 - done)
        clock.set_text(f"t = {times[frame]:.4g}")

    return figure, axes, set_clock
