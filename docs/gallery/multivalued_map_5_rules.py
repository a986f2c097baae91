r"""Branch rules: where runs of one top and one sleigh go that take different values of the map.

Run it to print the numbers and to draw docs/images/gallery/multivalued_map_5_rules.png.
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.plot import theme

PICTURE = Path(__file__).parents[1] / "images" / "gallery" / "multivalued_map_5_rules.png"
TOP = nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 0.6)
SLEIGH = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5, b=0.3), 0.5)
MARKS = {"principal": "o", "nearest": "x", "smallest": "s", "largest": "D", "inner": "+", "outer": "^"}
OF_SLEIGH = ("principal", "smallest", "largest")


def of_top(rule: str, steps: int = 30) -> nh.Orbit:
    """Run the top with one rule."""
    return nh.simulate(TOP, restricted_velocity=(0.95, -0.4), steps=steps, branch=rule)


def of_sleigh(rule: str, steps: int = 12) -> nh.Orbit:
    """Run the sleigh with one rule."""
    return nh.simulate(SLEIGH, body_velocity=(0.3, -2.0, 0.0), steps=steps, branch=rule)


def numbers() -> dict[str, float]:
    """Compare the rules: their energies, and the first step at which they leave the principal run."""
    runs = {rule: of_top(rule) for rule in MARKS}
    apart = {rule: np.abs(run.momentum - runs["principal"].momentum).max(axis=1) > 1e-9 for rule, run in runs.items()}
    changes = [np.abs(run.energy / run.energy[0] - 1).max() for run in runs.values()]
    return {
        "runs whose energy changes by more than 1e-14": np.count_nonzero(np.array(changes) > 1e-14),
        "step at which 'largest' leaves the principal run": int(np.argmax(apart["largest"])),
        "step at which 'smallest' leaves it": int(np.argmax(apart["smallest"])),
        "steps at which 'nearest' or 'inner' differ from it": np.count_nonzero(apart["nearest"] | apart["inner"]),
    }


def draw_run(axes: Axes) -> None:
    """Draw the direction of the momentum of all runs over the steps."""
    for (rule, mark), color in zip(MARKS.items(), theme.component_colors(len(MARKS)), strict=True):
        momentum = of_top(rule).reduced_momentum
        look: Any = {"markersize": 6, "linewidth": 0.8, "markerfacecolor": "none", "markeredgewidth": 1.4}
        angle = np.degrees(np.unwrap(np.arctan2(momentum[:, 1], momentum[:, 0])))
        axes.plot(angle, marker=mark, color=color, label=rule, **look)
    axes.set(title="Top: direction of the momentum", xlabel="step", ylabel="degrees")
    axes.legend(loc="lower right")


def draw_tracks(axes: Axes) -> None:
    """Draw the paths of the blade."""
    for rule, color in zip(OF_SLEIGH, theme.component_colors(len(OF_SLEIGH)), strict=True):
        x, y = of_sleigh(rule).position.T
        size = 9 if rule == "principal" else 5  # the others may lie on it
        axes.plot(x, y, marker=MARKS[rule], color=color, linewidth=1.0, markersize=size, label=rule)
    axes.set(title="Sleigh: paths of the blade", xlabel="x", ylabel="y")
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend()


@theme.in_style
def draw() -> Figure:
    """Draw an outer run on the disc, the momenta of all runs of the top, and tracks of the sleigh."""
    figure = Figure(figsize=(15.0, 5.0), layout="constrained")
    left, middle, right = figure.subplots(1, 3)
    nh.plot.invariant_curves(TOP, of_top("outer"), left, energies=[0.6, 1.2, 1.8])
    left.set_title("Top: branch='outer'")
    draw_run(middle)
    draw_tracks(right)
    return figure


if __name__ == "__main__":
    sys.stdout.writelines(f"{name}: {value:.8g}\n" for name, value in numbers().items())
    draw().savefig(PICTURE, dpi=80)
