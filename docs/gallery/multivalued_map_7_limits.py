r"""Where orbits come from and go to: the turn of the heading of a sleigh, the axis of a top in space.

Run it to print the numbers and to draw docs/images/gallery/multivalued_map_7_limits.png.
"""

import sys
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.plot import theme

PICTURE = Path(__file__).parents[1] / "images" / "gallery" / "multivalued_map_7_limits.png"
SLEIGH = nh.ChaplyginSleigh(mass=1.0, inertia=0.75, a=0.5)  # the flow turns once round
TOP = nh.discretize(nh.SuslovTop([[1.0, 0.2, 0.3], [0.2, 1.5, -0.5], [0.3, -0.5, 0.6]]), 0.2)
ENERGY = 0.5
STEPS = (0.4, 0.2, 0.1, 0.05, 0.025)


def turn(time_step: float) -> float:
    """Return the whole turn of the discrete sleigh in degrees."""
    connection = nh.heteroclinic(nh.discretize(SLEIGH, time_step), energy=ENERGY)
    return float(np.degrees(connection.limits.heading_turn))


def numbers() -> dict[str, float]:
    """Return turns of the sleigh and the change of the axis of the top."""
    flow = float(np.degrees(nh.asymptotics(SLEIGH).heading_turn))
    top = nh.heteroclinic(TOP, energy=ENERGY).limits
    cosine = top.spatial_axis_before @ top.spatial_axis_after
    return {
        "turn of the flow, degrees": flow,
        "turn of the map, h = 0.2, degrees": turn(0.2),
        "ratio of the errors of h = 0.05 and h = 0.025": (turn(0.05) - flow) / (turn(0.025) - flow),
        "angle between the axes of the top in space, degrees": np.degrees(np.arccos(cosine)),
    }


def draw_turns(axes: Axes) -> None:
    """Draw how far the turn of the map is from that of the flow."""
    flow = float(np.degrees(nh.asymptotics(SLEIGH).heading_turn))
    errors = np.abs([turn(step) - flow for step in STEPS])
    axes.loglog(STEPS, errors, "o", color=theme.DISCRETE, label="difference")
    axes.loglog(STEPS, errors[-1] * (np.array(STEPS) / STEPS[-1]) ** 2, color=theme.MUTED, dashes=(4, 3), label="$h^2$")
    axes.set(title="Sleigh: turn of the map and of the flow", xlabel="time step h", ylabel="degrees")
    axes.set_xticks(STEPS, [f"{step:g}" for step in STEPS])
    axes.minorticks_off()
    axes.legend()


@theme.in_style
def draw() -> Figure:
    """Draw a whole orbit of the sleigh, its turn, and the path of the axis of the top."""
    figure = Figure(figsize=(15.0, 5.0), layout="constrained")
    left, middle, right = figure.subplots(1, 3)
    upwards = nh.SE(2).exp(np.array([np.pi / 2, 0.0, 0.0]))
    orbit = nh.heteroclinic(nh.discretize(SLEIGH, 0.2), energy=ENERGY, configuration=upwards).orbit
    near = np.flatnonzero((orbit.time > -2.5) & (orbit.time < 9.0))
    nh.plot.blade_track(orbit[near[0] : near[-1]], axes=left)
    left.set_title("Sleigh, the cusp of its orbit")
    draw_turns(middle)
    nh.plot.body_axis_track(nh.heteroclinic(TOP, energy=ENERGY).orbit, axes=right)
    return figure


if __name__ == "__main__":
    sys.stdout.writelines(f"{name}: {value:.8g}\n" for name, value in numbers().items())
    draw().savefig(PICTURE, dpi=80)
