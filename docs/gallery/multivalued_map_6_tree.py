r"""The tree of images of images, which grows like 3^k for the sleigh and like 4^k for the top.

Run it to print the numbers and to draw docs/images/gallery/multivalued_map_6_tree.png.
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.plot import theme

PICTURE = Path(__file__).parents[1] / "images" / "gallery" / "multivalued_map_6_tree.png"
TOP = nh.discretize(nh.SuslovTop([[1.25, 0.0, -0.5], [0.0, 1.0, -0.75], [-0.5, -0.75, 1.25]]), 1.0)
SLEIGH = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5, b=0.3), 0.5)


def trees() -> tuple[Any, Any]:
    """Return a tree of the sleigh from inside the deltoid, and one of the top."""
    start = nh.simulate(SLEIGH, body_velocity=(0.3, -2.0, 0.0), steps=1).displacement[0]
    return nh.branch_tree(SLEIGH, start, 5), nh.branch_tree(TOP, nh.SO(3).cayley([0.6, -0.5, 0.0]), 4)


def numbers() -> dict[str, float]:
    """Count the images of the last generation."""
    of_sleigh, of_top = trees()
    return {
        "images of the sleigh in generation 5": of_sleigh.counts[5],
        "real ones among them": np.count_nonzero(of_sleigh.is_real & (of_sleigh.level == 5)),
        "images of the top in generation 4": of_top.counts[4],
        "real ones among those": np.count_nonzero(of_top.is_real & (of_top.level == 4)),
    }


@theme.in_style
def draw() -> Figure:
    """Draw both trees."""
    figure = Figure(figsize=(12.5, 9.6), layout="constrained")
    panels = figure.subplots(2, 2, width_ratios=(1.25, 1.0))
    for name, discrete, tree, row in zip(("Sleigh", "Top"), (SLEIGH, TOP), trees(), panels, strict=True):
        nh.plot.branch_tree(discrete, tree, tuple(row))
        row[0].set_title(f"{name}: real images")
    return figure


if __name__ == "__main__":
    sys.stdout.writelines(f"{name}: {value:.8g}\n" for name, value in numbers().items())
    draw().savefig(PICTURE, dpi=80)
