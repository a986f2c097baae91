r"""All values of the discrete map: four of a top, two real ones of another, and those of a sleigh.

Run it to print the numbers and to draw docs/images/gallery/multivalued_map_1_values.png.
"""

import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.plot import theme

PICTURE = Path(__file__).parents[1] / "images" / "gallery" / "multivalued_map_1_values.png"
FOUR = nh.discretize(nh.SuslovTop([[1.25, 0.0, -0.5], [0.0, 1.0, -0.75], [-0.5, -0.75, 1.25]]), 1.0)
EQUILIBRIUM = nh.SO(3).cayley([0.75, -0.5, 0.0])  # twice y: the step of a permanent rotation
TOP = nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 0.6)
SLEIGH = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5, b=0.3), 0.5)


def numbers() -> dict[str, float]:
    """Count the real values, and add up the step angles of the sleigh's."""
    four = nh.branches(FOUR, displacement=EQUILIBRIUM)
    two = nh.branches(TOP, momentum=[0.8, -0.3])
    three = nh.branches(SLEIGH, momentum=[0.5, -2.2])
    W = three.displacement.real
    angles = np.degrees(np.arctan2(W[:, 1, 0], W[:, 0, 0]))
    stays = four.displacement[0].real
    return {
        "real values of the first top": np.count_nonzero(four.is_real),
        "largest difference of its first value from the present displacement": round(
            np.abs(stays - EQUILIBRIUM).max(), 12
        ),
        "step angle of its third value, degrees": np.degrees(nh.SO(3).angle(nh.SO(3).log(four.displacement[2].real))),
        "real values of the second top": np.count_nonzero(two.is_real),
        "real values of the sleigh": np.count_nonzero(three.is_real),
        "sum of the sleigh's step angles, degrees": round(angles.sum(), 9) + 0.0,
    }


@theme.in_style
def draw() -> Figure:
    """Draw each set of values where it lives."""
    figure = Figure(figsize=(15.0, 5.2), layout="constrained")
    left, middle, right = figure.subplots(1, 3)
    nh.plot.branches(FOUR, displacement=EQUILIBRIUM, axes=left)
    nh.plot.branches(TOP, momentum=[0.8, -0.3], axes=middle)
    nh.plot.branches(SLEIGH, momentum=[0.5, -2.2], axes=right)
    return figure


if __name__ == "__main__":
    sys.stdout.writelines(f"{name}: {value:.8g}\n" for name, value in numbers().items())
    draw().savefig(PICTURE, dpi=80)
