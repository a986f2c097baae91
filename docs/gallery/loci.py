r"""Momentum loci and invariant curves of the discrete top and the discrete sleigh, with one orbit on each.

Run it to print the numbers and to draw docs/images/gallery/loci.png.
"""

import io
import sys
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from PIL import Image

import nonholo as nh
from nonholo.plot import theme

PICTURE = Path(__file__).parents[1] / "images" / "gallery" / "loci.png"


def top() -> nh.Discretization:
    """Return a top with a large step, so that its orbit covers much of the surface."""
    return nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 0.6)


def sleigh() -> nh.Discretization:
    """Return a sleigh with a step so large that an orbit near its start has three real values."""
    return nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5, b=0.3), 0.5)


def orbits() -> tuple[nh.Orbit, nh.Orbit]:
    """Return an orbit of each."""
    of_top = nh.simulate(top(), restricted_velocity=(0.95, -0.4), steps=60)
    return of_top, nh.simulate(sleigh(), body_velocity=(0.3, -2.0, 0.0), steps=60)


def numbers() -> dict[str, float]:
    """Count pinch points and crossings, and states of the orbits that miss their surface."""
    surfaces = nh.momentum_locus(top(), 10), nh.momentum_locus(sleigh(), 10)
    missed = [abs(s.implicit(orbit.momentum)) > 1e-12 for s, orbit in zip(surfaces, orbits(), strict=True)]
    crossings = nh.plot.locus_section(surfaces[0], offset=0.35).crossings
    return {
        "pinch points of the top's surface": len(surfaces[0].pinch_points),
        "pinch points of the sleigh's surface": len(surfaces[1].pinch_points),
        "crossings of the section": 0 if crossings is None else len(crossings.get_offsets()),
        "states of both orbits off their surface": sum(int(m.sum()) for m in missed),
    }


@theme.in_style
def draw(resolution: int = 70) -> Figure:
    """Draw surfaces, foliations, a section and the deltoid."""
    of_top, of_sleigh = orbits()
    surface, ruled = nh.momentum_locus(top(), resolution), nh.momentum_locus(sleigh(), resolution)
    figure = Figure(figsize=(15.5, 10.0))
    spaces: list[Any] = [figure.add_axes((0.0, bottom, 0.32, 0.49), projection="3d") for bottom in (0.505, 0.005)]
    planes = [figure.add_axes((left, bottom, 0.262, 0.385)) for bottom in (0.565, 0.065) for left in (0.395, 0.725)]
    curves = [nh.invariant_curve(top(), of_top.energy[0]), nh.invariant_curve(sleigh(), of_sleigh.energy[0])]
    nh.plot.momentum_locus(surface, of_top, curves[0], spaces[0])
    nh.plot.momentum_locus(ruled, of_sleigh, curves[1], spaces[1])
    nh.plot.invariant_curves(top(), of_top, planes[0])
    nh.plot.locus_section(surface, offset=0.35, axes=planes[1])
    nh.plot.invariant_curves(sleigh(), of_sleigh, planes[2])
    nh.plot.branch_counts(sleigh(), of_sleigh, planes[3])
    return figure


if __name__ == "__main__":
    sys.stdout.writelines(f"{name}: {value:.8g}\n" for name, value in numbers().items())
    page = io.BytesIO()
    draw().savefig(page, dpi=80)
    Image.open(page).convert("RGB").quantize(256, Image.Quantize.MAXCOVERAGE, kmeans=2).save(PICTURE, optimize=True)
