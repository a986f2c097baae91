r"""Energy levels on the projective plane of displacements of a top, with the critical ones, in both regimes.

Run it to print the numbers and to draw docs/images/gallery/multivalued_map_3_levels.png.
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.plot import theme

PICTURE = Path(__file__).parents[1] / "images" / "gallery" / "multivalued_map_3_levels.png"
REGULAR = nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 1.0)
ROD = nh.discretize(
    nh.SuslovTop([[0.83, 0.05, 0.39], [0.05, 0.06, 0.0], [0.39, 0.0, 0.21]]), 1.0
)  # nearly a tilted rod
CRITICAL = {"equatorial_saddle": (theme.COMPONENTS[1], "$h_e$"), "saddle": (theme.UNSTABLE, "$h^*$")}
LOOKS: dict[str, Any] = {
    "minimum": {"marker": "s", "facecolors": theme.INK},
    "saddle": {"marker": "X", "facecolors": "white"},
    "maximum": {"marker": "^", "facecolors": "white"},
}


def numbers() -> dict[str, float]:
    """Return the critical energies of both tops."""
    regular, rod = nh.critical_energies(REGULAR), nh.critical_energies(ROD)
    return {
        "regular top, saddle among half-turns h_e": regular.equatorial_saddle,
        "regular top, saddle h*": regular.saddle,
        "regular top, maximum h**": regular.center,
        "rod, saddle among half-turns h_e": rod.equatorial_saddle,
    }


def draw_levels(axes: Axes, top: nh.Discretization, title: str) -> None:
    """Draw levels in gray, critical ones in color, and the critical points."""
    result = nh.critical_energies(top)
    highest = max(point.energy for point in result.points)
    critical = {getattr(result, name): look for name, look in CRITICAL.items() if getattr(result, name) is not None}
    energies = [*highest * np.linspace(0.06, 0.96, 9), *critical]
    drawn = nh.plot.invariant_curves(top, axes=axes, energies=energies).levels
    for level, (color, label) in zip(drawn[9:], critical.values(), strict=True):
        level.set(color=color, linewidth=1.8, label=label, zorder=3)
    for kind, look in LOOKS.items():
        points = [point.half_turn_vector for point in result.points if point.kind == kind]
        places = np.array([side * disc(z) for z in points for side in (1.0, -1.0)])
        axes.scatter(*places.T, s=60, edgecolors=theme.INK, linewidths=1.3, zorder=9, label=kind, **look)
    axes.legend(loc="upper left", bbox_to_anchor=(0.97, 1.0))
    axes.set_title(title)


def disc(z: np.ndarray) -> np.ndarray:
    """Return the place on the disc of sin(angle / 2) times a direction."""
    size = float(np.linalg.norm(z))
    return z * 2 * np.arcsin(min(size, 1.0)) / np.pi / size if size else z


@theme.in_style
def draw() -> Figure:
    """Draw both discs."""
    figure = Figure(figsize=(13.0, 5.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    draw_levels(left, REGULAR, "Regular: the level of $h^*$ separates")
    draw_levels(right, ROD, "Nearly a rod: no saddle off the rim")
    return figure


if __name__ == "__main__":
    sys.stdout.writelines(f"{name}: {value:.8g}\n" for name, value in numbers().items())
    draw().savefig(PICTURE, dpi=80)
