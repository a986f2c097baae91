"""The variety of displacements on paper: a disc for a top, whose opposite rim points are one, a strip for a sleigh.

Points are those of `nonholo.analysis._variety_points`; what is drawn on the plane is not decided here.
"""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.patches import FancyArrowPatch

from nonholo._types import Float
from nonholo.analysis import InvariantCurve
from nonholo.discrete import Discretization
from nonholo.plotting import theme
from nonholo.plotting.elements import draw_rim
from nonholo.systems import ChaplyginSleigh

_TALLEST = 4.0  # height of the strip in translations without turning


def flat(discrete: Discretization, points: Float[np.ndarray, "K c"]) -> Float[np.ndarray, "K 2"]:
    """Return the places of displacements on the disc or the strip."""
    if isinstance(discrete.system, ChaplyginSleigh):
        return points
    return disc(np.where(points[:, :1] >= 0, 1.0, -1.0) * points)


def draw_level(axes: Axes, curve: InvariantCurve, **look: Any) -> LineCollection:
    """Draw all components of a curve of one energy, cut where they leave the disc or the strip."""
    is_sleigh = isinstance(curve.discrete.system, ChaplyginSleigh)
    cut = _strips if is_sleigh else _discs
    runs = [run for points in curve.components for run in cut(points)]
    lines = LineCollection(runs, **look)
    axes.add_collection(lines)
    return lines


def _discs(z: Float[np.ndarray, "K 3"]) -> list[Float[np.ndarray, "L 2"]]:
    """Return the runs of a curve on the sphere, each turned to the upper half and laid on the disc."""
    runs = []
    for sign in (1, -1):
        upper = sign * z[:, 0] >= 0
        starts = np.flatnonzero(np.diff(np.concatenate([[0], upper.astype(int), [0]])))
        for first, last in starts.reshape(-1, 2):
            if last - first > 1:
                runs.append(disc(sign * z[first:last]))
    return runs


def _strips(points: Float[np.ndarray, "K 2"]) -> list[Float[np.ndarray, "L 2"]]:
    """Return the runs of a curve on the band between the angles -pi and pi, turned over after each full turn."""
    turn = np.floor((points[:, 0] + np.pi) / (2 * np.pi)).astype(int)
    runs = []
    for number in np.unique(turn):
        shift, flip = 2 * np.pi * number, (-1) ** int(number)
        inside = (points[:, 0] >= shift - np.pi) & (points[:, 0] <= shift + np.pi)
        bounds = np.flatnonzero(np.diff(np.concatenate([[0], inside.astype(int), [0]])))
        for first, last in bounds.reshape(-1, 2):
            if last - first > 1:
                runs.append((points[first:last] - [shift, 0.0]) * [1.0, flip])
    return runs


def disc(z: Float[np.ndarray, "K 3"]) -> Float[np.ndarray, "K 2"]:
    """Return the direction of the last two components, as long as the step angle in half-turns."""
    size = np.linalg.norm(z[:, 1:], axis=1, keepdims=True)
    angle = 2 * np.arctan2(size, z[:, :1]) / np.pi
    return z[:, 1:] * np.divide(angle, size, out=np.ones_like(size), where=size > 0)


def dress(axes: Axes, discrete: Discretization, curves: list[InvariantCurve], title: str = "Displacements") -> None:
    """Draw the rim or the edges, name the axes and place the legend."""
    axes.set_title(title)
    if isinstance(discrete.system, ChaplyginSleigh):
        _dress_strip(axes, curves)
        theme.legend_above(axes)
    else:
        _dress_disc(axes)


def _dress_disc(axes: Axes) -> None:
    draw_rim(axes)
    axes.set(xlim=(-1.14, 1.14), ylim=(-1.14, 1.14), xticks=[], yticks=[])
    axes.set_aspect("equal")
    axes.spines[:].set_visible(False)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="lower left", bbox_to_anchor=(0.9, 0.02))
    axes.set_xlabel("radius: step angle; equal letters: the same half-turn")


def _dress_strip(axes: Axes, curves: list[InvariantCurve]) -> None:
    axes.autoscale_view()
    low, high = axes.get_ylim()
    middle = max((float(np.abs(curve.over(0.0)[:, 1]).max()) for curve in curves), default=1.0)
    reach = min(max(-low, high), _TALLEST * middle)  # levels of a balanced sleigh go to infinity
    axes.set(xlim=(-np.pi, np.pi), ylim=(-reach, reach), xticks=np.pi * np.linspace(-1, 1, 5))
    axes.set_xticklabels([r"$-\pi$", r"$-\pi/2$", "0", r"$\pi/2$", r"$\pi$"])
    for side in (-1, 1):
        arrow = FancyArrowPatch(
            (side * np.pi, -0.1 * side * reach),
            (side * np.pi, 0.1 * side * reach),
            arrowstyle="-|>",
            mutation_scale=22,
            shrinkA=0,
            shrinkB=0,
            linewidth=2.0,
            color=theme.INK,
            clip_on=False,
            zorder=7,
        )
        axes.add_patch(arrow)
    axes.spines["right"].set_visible(True)
    axes.set(xlabel=r"step angle $\Delta$", ylabel=r"translation along the chord  $\nu$")
