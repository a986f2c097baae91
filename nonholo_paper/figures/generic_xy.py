"""Figure generic_xy: generic trajectories of the blade, with their cusps."""

import functools
from typing import Any

import numpy as np
from matplotlib.figure import Figure as MatplotlibFigure

import nonholo as nh
from nonholo.orbit import Orbit
from nonholo.plot import BladeTrack, blade_track, theme
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper.figures._figure import figure
from nonholo_paper.figures.mom_dynamics import TITLES
from nonholo_paper.formulas import sleigh_continuous as formulas

BODIES = ((1.0, 1.0, 0.6, 0.4), (1.0, 1.0, 0.6, 0.0))  # m, J, a, b
_SPAN = 7.0


@functools.cache
def orbits() -> tuple[Orbit, Orbit]:
    """Return the flows; at time zero the momentum is half way between the equilibria."""
    result = []
    for body in BODIES:
        sleigh = nh.ChaplyginSleigh(*body)
        turning = np.sqrt(float(sleigh.constrained_inertia[1][1]))
        middle = np.linalg.solve(np.asarray(sleigh.frame_map), [turning, 0.0])
        start = nh.flow(sleigh, times=[0.0, -_SPAN], momentum=middle, method="closed_form")
        result.append(
            nh.flow(
                sleigh,
                times=np.linspace(-_SPAN, _SPAN, 1401),
                momentum=start.restricted_momentum[-1],
                configuration=start.configuration[-1],
                method="closed_form",
            )
        )
    return result[0], result[1]


@functools.cache
@theme.in_style
def picture() -> tuple[MatplotlibFigure, tuple[BladeTrack, ...]]:
    """Draw both panels."""
    figure = MatplotlibFigure(figsize=(11.0, 5.6), layout="constrained")
    panels: Any = figure.subplots(1, 2)
    drawn = []
    for axes, orbit, title in zip(panels, orbits(), TITLES, strict=True):
        drawn.append(blade_track(orbit, axes=axes, enlarge=False))
        axes.set_title(title)
        theme.legend_above(axes)
    return figure, tuple(drawn)


@statement
def cusp_of_the_track() -> Measured:
    """Compare the one drawn star with the place where the momentum crosses the cusp line; the path turns back there."""
    gaps = []
    for body, orbit, drawn in zip(BODIES, orbits(), picture()[1], strict=True):
        crossing = np.array([formulas.cusp_line(body, p) for p in orbit.momentum])
        after = int(np.flatnonzero(np.diff(np.sign(crossing)))[0]) + 1
        share = crossing[after] / (crossing[after] - crossing[after - 1])
        place = orbit.position[after] + share * (orbit.position[after - 1] - orbit.position[after])
        before, beyond = (
            np.diff(orbit.position[rows], axis=0)[0] for rows in ([after - 3, after - 2], [after + 1, after + 2])
        )
        stars = np.asarray(drawn.cusps.get_offsets()) if drawn.cusps else np.empty((0, 2))
        gaps.append(float(len(stars) != 1))
        gaps.append(np.abs(stars - place).max(initial=0.0))
        gaps.append(1 + before @ beyond / np.linalg.norm(before) / np.linalg.norm(beyond))
    return Measured(float(max(gaps)), note="one star each, and the directions 0.02 before and after; drawn every 0.01")


FIGURE = figure(lambda: picture()[0], cusp_of_the_track)
