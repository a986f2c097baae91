"""Pictures of comparisons: errors of an orbit against time, and errors of several orbits against the time step."""

from pathlib import Path
from typing import Any, Unpack

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from nonholo.analysis import Comparison, Convergence, Errors
from nonholo.base.checks import instance
from nonholo.base.types import Float
from nonholo.plot import theme
from nonholo.plot.parts import draw_line, finish_page, new_page

_TITLES = {"pose": "Pose", "momentum": "Momentum along admissible directions", "energy": "Energy"}
_LEAST = 1e-17  # of the largest error, or absolute where there is none, on a logarithmic scale


@theme.in_style
def comparison(
    comparison: Comparison, path: str | Path | None = None, *, overwrite: bool = False, **look: Unpack[theme.Look]
) -> Figure:
    """Draw the errors of an orbit against another one over time: pose and momentum, and the difference of energies.

    The ring is the largest error.

    Args:
        comparison: The result of `compare` for one orbit.
        path: Where to save the figure, a new file; the suffix (.png, .svg, .pdf) chooses the format.
        overwrite: Replace an older picture at the path.
        **look: Title, label, color and more: `nh.plot.Look`.

    Raises:
        FileExistsError: The path exists, and is not to be replaced.
        ValueError: No comparison, or a suffix that is not a picture format.

    Example:
        >>> sleigh, start = nh.ChaplyginSleigh(1.0, 1.0, 0.5), {"body_velocity": (1, 0, 0)}
        >>> orbit = nh.simulate(nh.discretize(sleigh, 0.1), **start, steps=50)
        >>> figure = nh.plot.comparison(nh.compare(orbit, nh.flow(sleigh, **start, times=(0, 5))))
        >>> [axes.get_title(loc="left") for axes in figure.axes]
        ['Pose', 'Momentum along admissible directions', 'Energy']
    """
    remedy = "Pass what `compare` returned for one orbit."
    instance("comparison(comparison=...)", comparison, Comparison, "be a comparison", remedy)
    panels = _by_name(comparison.errors)
    figure = new_page("comparison", (8.4, 1.4 + 2.3 * len(panels)), path, overwrite=overwrite)
    axes = np.atleast_1d(figure.subplots(len(panels), sharex=True))
    for (name, errors), own in zip(panels.items(), axes, strict=True):
        theme.begin(own)
        _draw_errors(own, comparison.time, name, errors)
    axes[-1].set_xlabel("time")
    step = [] if comparison.time_step is None else [f"$h$ = {comparison.time_step:g}"]
    facts = [f"{len(comparison):,} common times".replace(",", "\u2009"), *step]
    return finish_page(figure, "Difference of two motions", facts, path)


@theme.in_style
def convergence(
    convergence: Convergence, path: str | Path | None = None, *, overwrite: bool = False, **look: Unpack[theme.Look]
) -> Figure:
    """Draw the largest errors of orbits over their time steps, with the slopes: the order of the map.

    Errors at rounding, whose slope has no meaning, are drawn pale.

    Args:
        convergence: The result of `compare` for several orbits.
        path: Where to save the figure, a new file; the suffix (.png, .svg, .pdf) chooses the format.
        overwrite: Replace an older picture at the path.
        **look: Title, label, color and more: `nh.plot.Look`.

    Raises:
        FileExistsError: The path exists, and is not to be replaced.
        ValueError: No convergence, or a suffix that is not a picture format.

    Example:
        >>> sleigh, start = nh.ChaplyginSleigh(1.0, 1.0, 0.5), {"body_velocity": (1, 0, 0)}
        >>> runs = [nh.simulate(nh.discretize(sleigh, h), **start, steps=round(4 / h)) for h in (0.2, 0.1)]
        >>> figure = nh.plot.convergence(nh.compare(runs, nh.flow(sleigh, **start, times=(0, 4))))
        >>> figure.axes[0].get_xscale(), len(figure.axes[0].lines) > 2
        ('log', True)
    """
    remedy = "Pass what `compare` returned for several orbits."
    instance("convergence(convergence=...)", convergence, Convergence, "be a convergence", remedy)
    figure = new_page("convergence", (7.2, 5.8), path, overwrite=overwrite)
    axes = figure.add_subplot(xscale="log", yscale="log", xlabel="time step  $h$", ylabel="largest error")
    theme.begin(axes)
    h, orders = convergence.time_step, convergence.order._asdict()
    for name, errors in _by_name(convergence.largest).items():
        _draw_slope(axes, h, np.maximum(errors, _LEAST * (errors.max() or 1.0)), orders[name], name)
    axes.margins(x=0.12, y=0.1)
    axes.grid(which="major", color=theme.LEVEL, linewidth=0.5, alpha=0.6)
    axes.set_xticks(h, [f"{step:g}" for step in h])
    axes.minorticks_off()
    theme.legend(axes, loc="best", frameon=True, framealpha=0.85, edgecolor="none")
    steps = f"{len(convergence)} time steps from {h[0]:g} to {h[-1]:g}"
    return finish_page(figure, "Order of convergence", [steps], path)


def _by_name(errors: Errors) -> dict[str, np.ndarray]:
    """Return what is known of errors, by name in the order of pictures."""
    return {name: rows for name in _TITLES if (rows := getattr(errors, name)) is not None}


def _color(name: str) -> Any:
    """Return the color of a kind of errors, or the given one."""
    return theme.option("color", theme.COMPONENTS[list(_TITLES).index(name)])


@theme.in_style
def _draw_errors(axes: Axes, time: Float[np.ndarray, "K"], name: str, errors: Float[np.ndarray, "K"]) -> None:
    """Draw errors in units of a power of ten, and a ring about the largest."""
    most = int(np.abs(errors).argmax())
    unit = 10.0 ** np.floor(np.log10(abs(errors[most]) or _LEAST))
    color = _color(name)
    draw_line(axes, time, errors / unit, color=color, label=theme.option("label", None), linewidth=1.6, zorder=3)
    axes.axhline(0.0, color=theme.LEVEL, linewidth=0.8, zorder=1)
    mantissa, power = f"{abs(errors[most]):.1e}".split("e")
    largest = "0" if errors[most] == 0 else rf"${mantissa}\cdot10^{{{int(power)}}}$"
    ring: Any = {"s": 46, "facecolors": theme.PAPER, "edgecolors": color, "linewidths": 1.6, "zorder": 5}
    axes.scatter(time[most], errors[most] / unit, label=f"largest {largest}", **ring)
    axes.set(ylabel=rf"error   [$10^{{{round(np.log10(unit))}}}$]")
    axes.margins(x=0.02, y=0.16)
    theme.legend_above(axes, _TITLES[name])


def _draw_slope(axes: Axes, h: Float[np.ndarray, "R"], errors: Float[np.ndarray, "R"], order: float, name: str) -> None:
    """Draw errors as dots, through them the line of their order, and write the order."""
    has_order, color = np.isfinite(order), _color(name)
    whose = " ".join(filter(None, (theme.option("label", None), name)))
    label = f"{whose}: order {order:.2f}" if has_order else f"{whose}: rounding"
    look: Any = {"color": color, "marker": "o", "markersize": 7, "linewidth": 0, "zorder": 3}
    axes.plot(h, errors, label=label, alpha=1.0 if has_order else 0.35, **look)
    if has_order:
        middle = np.exp(np.log(errors / h**order).mean())
        ends = np.array([h.min() / 1.15, h.max() * 1.15])
        axes.plot(ends, middle * ends**order, color=color, linewidth=1.2, alpha=0.6, zorder=2)
