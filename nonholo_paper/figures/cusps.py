"""Figure cusps: a discrete trajectory of the sleigh against the continuous one."""

import functools

import numpy as np

import nonholo as nh
from nonholo.orbit import Orbit
from nonholo.plot import BladeTrack, blade_track, theme
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper.figures._figure import figure

SLEIGH = nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.6)
START = (0.15, -1.0, 0.0)
TIME_STEP = 0.4
_SPAN = 12.0


def discrete(time_step: float) -> Orbit:
    """Return the discrete orbit."""
    steps = round(_SPAN / time_step)
    return nh.simulate(nh.discretize(SLEIGH, time_step), body_velocity=START, steps=steps)


@functools.cache
def continuous() -> Orbit:
    """Return the flow, at twice the times of the discrete orbit."""
    times = np.linspace(0.0, _SPAN, 2 * round(_SPAN / TIME_STEP) + 1)
    return nh.flow(SLEIGH, times=times, body_velocity=START, method="closed_form")


@functools.cache
@theme.in_style
def picture() -> BladeTrack:
    """Draw it."""
    times = np.linspace(0.0, _SPAN, 1201)
    smooth = nh.flow(SLEIGH, times=times, body_velocity=START, method="closed_form")
    drawn = blade_track(discrete(TIME_STEP), flow=smooth)
    drawn.axes.set_title("Track")
    return drawn


@statement
def tracks() -> Measured:
    """Count drawn cusps; the distance of drawn points from those of the flow falls fourfold for half the step."""
    drawn, flow = picture(), continuous()
    points = np.asarray(drawn.track.get_offsets())
    finer = discrete(TIME_STEP / 2).position
    coarse, fine = (
        np.abs(result - place).max() for result, place in ((points, flow.position[::2]), (finer, flow.position))
    )
    cusps = 0 if drawn.cusps is None else len(np.asarray(drawn.cusps.get_offsets()))
    order = np.log2(coarse / fine)
    return Measured(
        float(max(abs(order - 2), abs(cusps - 1))), note=f"largest distance {coarse:.3f}; order {order:.3f}"
    )


FIGURE = figure(lambda: picture().axes.figure, tracks)
