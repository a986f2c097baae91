"""Figure circle, described in section 7: the track of a sleigh with a = 0, discrete and continuous."""

import functools
from typing import Any

import numpy as np
from matplotlib.lines import Line2D

import nonholo as nh
from nonholo.orbit import Orbit
from nonholo.plot import BladeTrack, blade_track, theme
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper.figures._figure import figure
from nonholo_paper.formulas import sleigh_discrete as formulas

SLEIGH = nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.0, b=0.3)
ANGLE, FIRST = 0.5, 1.2  # step angle and V_1


@functools.cache
def orbit() -> Orbit:
    """Return 11 steps, nearly a full turn; the time step is 1."""
    W = nh.SE(2).exp([ANGLE, FIRST * ANGLE / np.sin(ANGLE), 0.0])
    return nh.simulate(nh.discretize(SLEIGH, 1.0), displacement=W, steps=11)


@functools.cache
@theme.in_style
def picture() -> tuple[BladeTrack, Line2D]:
    """Draw it, and the circle of the flow with the same momentum."""
    drawn = blade_track(orbit())
    momentum = orbit().restricted_momentum[0]
    omega = float(nh.flow(SLEIGH, times=[0.0], momentum=momentum, method="closed_form").body_velocity[0, 0])
    times = np.linspace(0.0, 2 * np.pi / omega, 361)
    flow = nh.flow(SLEIGH, times=times, momentum=momentum, method="closed_form")
    look: Any = {"color": theme.CONTINUOUS, "linewidth": 1.2, "zorder": 1}
    circle = drawn.axes.plot(*flow.position.T, label="continuous", **look)[0]
    reach = 1.2 * np.abs(flow.position - flow.position.mean(axis=0)).max()
    middle = np.array([0.0, float(formulas.radius(ANGLE, FIRST))])
    drawn.axes.set(title="Track for $a = 0$", xlim=(-reach, reach), ylim=tuple(middle[1] + [-reach, reach]))
    theme.legend_above(drawn.axes)
    return drawn, circle


@statement
def circles() -> Measured:
    """Compare distances of drawn points and of the drawn curve from the center with the radius."""
    track, curve = picture()
    radius = float(formulas.radius(ANGLE, FIRST))
    dots, line = np.asarray(track.track.get_offsets()), np.asarray(curve.get_xydata())
    gaps = np.linalg.norm(np.concatenate([dots, line]) - [0.0, radius], axis=1) - radius
    return Measured(float(np.abs(gaps).max()), note="12 points, and 361 of the flow")


FIGURE = figure(lambda: picture()[0].axes.figure, circles)
