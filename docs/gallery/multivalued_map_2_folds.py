r"""Folds: where two values meet and end, and how many real values there are over each momentum.

The second panel follows all values of the top along the arrow of the first.
Run it to print the numbers and to draw docs/images/gallery/multivalued_map_2_folds.png.
"""

import sys
from pathlib import Path
from typing import Any

import contourpy
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.ndimage import map_coordinates

import nonholo as nh
from nonholo.plot import theme

PICTURE = Path(__file__).parents[1] / "images" / "gallery" / "multivalued_map_2_folds.png"
TOP = nh.discretize(nh.SuslovTop([[1.25, 0.0, -0.5], [0.0, 1.0, -0.75], [-0.5, -0.75, 1.25]]), 1.0)
SLEIGH = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5, b=0.3), 0.5)
RAY = np.array([-0.5547, -0.83205])  # a direction of the restricted momentum, through the region of four values
SHADES = ("#dbe9f3", "#7fb0d3")
POINTER: Any = {"arrowprops": {"arrowstyle": "-", "color": theme.DISCRETE}, "va": "center"}


def real_values(size: float) -> int:
    """Count the real values of the top so far along the ray."""
    return int(np.count_nonzero(nh.displacements_over(TOP, size * RAY).is_real))


def change(low: float, high: float) -> float:
    """Return where the number of real values changes between two sizes, by bisection."""
    count = real_values(low)
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if real_values(middle) == count else (low, middle)
    return (low + high) / 2


def numbers() -> dict[str, float]:
    """Find the folds along the ray."""
    return {
        "four real values from": change(1.0, 1.7),
        "four real values up to": change(1.7, 2.0),
        "no real value from": change(2.0, 4.0),
    }


def folds(resolution: int) -> list[np.ndarray]:
    """Return the momenta at which the surface turns back, where its projection has no area."""
    momentum = TOP.system.restrict(nh.momentum_locus(TOP, resolution).momentum)
    area = np.linalg.det(np.stack(np.gradient(momentum, axis=(0, 1)), axis=-1))
    curves = contourpy.contour_generator(z=area[1:]).lines(0.0)  # all of the first row is rest
    places = [(curve[:, ::-1] + (1.0, 0.0)).T for curve in curves]
    return [np.stack([map_coordinates(r, place, order=1) for r in np.moveaxis(momentum, -1, 0)]) for place in places]


def draw_folds(axes: Axes, resolution: int) -> None:
    """Fill the curves where real values meet."""
    curves = sorted(folds(resolution), key=lambda curve: -np.ptp(curve[0]))
    for curve, shade in zip(curves, SHADES, strict=True):
        axes.fill(*curve, facecolor=shade, edgecolor=theme.DISCRETE, linewidth=1.6)
    axes.text(0.0, 0.6, "2 real values", ha="center", color=theme.DISCRETE, fontweight="bold")
    axes.annotate("4 real values", (-0.95, -1.5), (0.1, -1.55), color=theme.DISCRETE, fontweight="bold", **POINTER)
    axes.annotate(
        "", 2.9 * RAY, (0.0, 0.0), arrowprops={"arrowstyle": "-|>", "color": theme.UNSTABLE, "linewidth": 1.4}
    )
    axes.set(title="Top: real values over the momenta", xlabel="$r_1$", ylabel="$r_2$")
    axes.set_aspect("equal", adjustable="datalim")


def draw_distances(axes: Axes, resolution: int) -> None:
    """Draw the fold distance of all real values along the ray."""
    for size in np.linspace(0.02, 2.33, resolution):
        result = nh.displacements_over(TOP, size * RAY)
        for index in np.flatnonzero(result.is_real):
            look: Any = {"color": theme.UNSTABLE, "markerfacecolor": "white", "markersize": 4}
            if index == result.principal:
                look = {"color": theme.STABLE, "markersize": 4, "zorder": 5}
            axes.plot(size, result.fold_distance[index], "o", **look)
    axes.plot([], [], "o", color=theme.STABLE, label="principal value")
    axes.plot([], [], "o", color=theme.UNSTABLE, markerfacecolor="white", label="other real values")
    axes.set(ylim=(0.0, None), title="Distance to the fold", xlabel="momentum along the arrow", ylabel="fold distance")
    axes.legend(loc="upper right")


@theme.in_style
def draw(resolution: int = 130) -> Figure:
    """Draw the sheets, the fold distances and the deltoid."""
    figure = Figure(figsize=(15.0, 4.8), layout="constrained")
    left, middle, right = figure.subplots(1, 3)
    draw_folds(left, 3 * resolution)
    draw_distances(middle, resolution)
    nh.plot.branch_counts(SLEIGH, nh.simulate(SLEIGH, body_velocity=(0.3, -2.0, 0.0), steps=60), right)
    return figure


if __name__ == "__main__":
    sys.stdout.writelines(f"{name}: {value:.8g}\n" for name, value in numbers().items())
    draw().savefig(PICTURE, dpi=80)
