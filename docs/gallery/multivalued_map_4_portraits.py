r"""Phase portraits with all branches, stable halves, and the energies at which the sleigh is single-valued.

Run it to print the numbers and to draw docs/images/gallery/multivalued_map_4_portraits.png.
"""

import sys
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.plot import theme

PICTURE = Path(__file__).parents[1] / "images" / "gallery" / "multivalued_map_4_portraits.png"
TOP = nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 0.6)
SLEIGH = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5, b=0.3), 0.5)


def numbers() -> dict[str, float]:
    """Return multipliers of equilibria, bounds of the single-valued region, and sides of an orbit."""
    region = nh.single_valued_region(SLEIGH)
    orbit = nh.simulate(TOP, restricted_velocity=(0.95, -0.4), steps=60)
    sides = nh.half_planes(TOP, displacement=orbit.displacement)
    return {
        "multiplier of the top at energy 0.5": nh.equilibria(TOP, 0.5).multipliers[0],
        "multiplier of the sleigh at energy 0.5": nh.equilibria(SLEIGH, 0.5).multipliers[0],
        "the sleigh is single-valued below": region.energy,
        "bound of the paper": region.bound_of_the_paper,
        "sides of the line of equilibria that the top visits": len(np.unique(np.sign(sides.side))),
        "sign of Q at its start": np.sign(sides.forward[0]),
        "sign of Q at its end": np.sign(sides.forward[-1]),
    }


def draw_region(axes: Axes) -> None:
    """Draw the ellipses of both bounds beside the deltoid."""
    nh.plot.branch_counts(SLEIGH, axes=axes)
    region, body = nh.single_valued_region(SLEIGH), SLEIGH.system
    turn = np.linspace(0.0, 2 * np.pi, 361)
    whole = body.inertia + body.mass * body.a**2
    bounds = (
        ("sharp bound", region.energy, theme.UNSTABLE),
        ("bound of the paper", region.bound_of_the_paper, theme.INK),
    )
    for name, energy, color in bounds:
        pi, p1 = np.sqrt(2 * energy * whole) * np.cos(turn), np.sqrt(2 * energy * body.mass) * np.sin(turn)
        axes.plot(pi, p1, color=color, linewidth=1.8, label=name)
    axes.legend(loc="lower left")
    axes.set_title("Sleigh: single-valued below")


@theme.in_style
def draw() -> Figure:
    """Draw two portraits and the region."""
    figure = Figure(figsize=(15.0, 5.0), layout="constrained")
    left, middle, right = figure.subplots(1, 3)
    of_top = nh.simulate(TOP, restricted_velocity=(0.95, -0.4), steps=60)
    of_sleigh = nh.simulate(SLEIGH, body_velocity=(0.3, -2.0, 0.0), steps=40)
    nh.plot.phase_portrait(TOP.system, of_top, left, branches="all")
    nh.plot.phase_portrait(SLEIGH.system, of_sleigh, middle, branches="all")
    draw_region(right)
    return figure


if __name__ == "__main__":
    sys.stdout.writelines(f"{name}: {value:.8g}\n" for name, value in numbers().items())
    draw().savefig(PICTURE, dpi=80)
