"""Momenta along a two-dimensional constraint subspace in the coordinates of the paper: levels, equilibria, arrows."""

import dataclasses
from typing import Any

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.lines import Line2D
from matplotlib.patches import FancyArrowPatch

from nonholo.plot import theme
from nonholo.systems import AbstractLLSystem

_LEAN = 0.02  # half the length of an arrow, as an angle on its ellipse


@dataclasses.dataclass(frozen=True)
class Portrait:
    """The drawing of `portrait`; coordinates are those of the plane.

    Attributes:
        levels: A closed line for each energy.
        stable: Attracting equilibria, filled.
        unstable: Repelling equilibria, empty.
    """

    levels: tuple[Line2D, ...]
    stable: PathCollection
    unstable: PathCollection


def portrait(axes: Axes, system: AbstractLLSystem, energies: list[float], plane: Float[np.ndarray, "2 2"]) -> Portrait:
    """Draw energy ellipses, the line of equilibria and the direction of motion.

    Args:
        axes: Where to draw.
        system: An unbalanced top or sleigh.
        energies: Energies of the ellipses.
        plane: Takes restricted momenta to the plane.
    """
    frame = plane @ _frame(system)
    sizes = np.sqrt(2 * np.array(energies))
    angle = np.linspace(0.0, 2 * np.pi, 361)
    circle = np.stack([np.cos(angle), np.sin(angle)])
    look: Any = {"color": theme.LEVEL, "linewidth": 1.2, "zorder": 1}
    levels = tuple(axes.plot(*(size * frame @ circle), **look)[0] for size in sizes)
    attracting = sizes[:, None] * frame[:, 0]
    _line(axes, 1.14 * attracting[sizes.argmax()], color=theme.STABLE)
    _line(axes, -1.14 * attracting[sizes.argmax()], color=theme.UNSTABLE, dashes=(5, 3))
    dots: Any = {"s": 52, "zorder": 6, "linewidths": 1.5}
    stable = axes.scatter(*attracting.T, facecolors=theme.STABLE, edgecolors=theme.STABLE, label="stable", **dots)
    unstable = axes.scatter(*-attracting.T, facecolors="white", edgecolors=theme.UNSTABLE, label="unstable", **dots)
    for size in sizes:
        for side in (1, -1):
            for place in (0.3, 0.5, 0.7):
                _arrow(axes, size * frame, side * np.pi * place)
    return Portrait(levels, stable, unstable)


def _frame(system: AbstractLLSystem) -> Float[np.ndarray, "2 2"]:
    """Return columns of energy 1/2, the attracting equilibrium first, orthogonal in the metric of the energy."""
    half_axes = np.linalg.cholesky(np.asarray(system.constrained_inertia))
    momentum = system.restrict(np.asarray(system.inertia_operator) @ np.asarray(system.equilibria().attracting))
    u = np.linalg.solve(half_axes, momentum)
    u /= np.linalg.norm(u)
    return half_axes @ np.array([[u[0], -u[1]], [u[1], u[0]]])


def _line(axes: Axes, end: Float[np.ndarray, "2"], **look: Any) -> None:
    axes.plot([0.0, end[0]], [0.0, end[1]], linewidth=1.0, zorder=2, **look)


def _arrow(axes: Axes, frame: Float[np.ndarray, "2 2"], angle: float) -> None:
    """Put an arrow on an ellipse; angles decrease in size toward the attracting equilibrium, at zero."""
    lean = np.copysign(_LEAN, angle)
    tail, head = (tuple(frame @ [np.cos(a), np.sin(a)]) for a in (angle + lean, angle - lean))
    look: Any = {"arrowstyle": "-|>", "mutation_scale": 13, "shrinkA": 0, "shrinkB": 0, "linewidth": 0}
    axes.add_patch(FancyArrowPatch(tail, head, color=theme.MUTED, zorder=3, **look))
