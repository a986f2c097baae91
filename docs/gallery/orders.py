"""Compositions of the step: order 2, 4, 6 and 8, all with exact energy."""

from functools import cache

import numpy as np
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.plot import theme

SLEIGH = nh.ChaplyginSleigh(mass=1.0, inertia=0.75, a=0.5)
START = {"body_velocity": (1.0, 0.5, 0.0)}
STEPS = {2: (10, 20, 40, 80), 4: (10, 20, 40, 80), 6: (10, 20, 40), 8: (8, 12, 16)}


@cache
def errors(order: int) -> np.ndarray:
    """Return the errors of the last pose at t = 4."""
    flow = nh.flow(SLEIGH, **START, times=(0.0, 4.0))
    discretized = {n: nh.discretize(SLEIGH, 4.0 / n, order=order) for n in STEPS[order]}
    runs = [nh.simulate(each, **START, steps=n) for n, each in discretized.items()]
    return np.array([nh.compare(run, flow).last.pose for run in runs])


def numbers() -> dict[str, tuple[float, float, float]]:
    """The slopes of the errors in a log-log plot; the first steps are large, so to a tenth of the order."""
    slopes = {order: -np.polyfit(np.log(STEPS[order]), np.log(errors(order)), 1)[0] for order in STEPS}
    return {f"slope of order {order}": (float(slope), float(order), order / 10) for order, slope in slopes.items()}


@theme.in_style
def draw() -> Figure:
    """Draw the errors over the time step."""
    figure = Figure(figsize=(6.0, 4.6), layout="constrained")
    axes = figure.subplots()
    for order, counts in STEPS.items():
        axes.loglog(4.0 / np.array(counts), errors(order), "o-", label=f"order {order}")
    axes.set(xlabel="time step h", ylabel="error of the pose at t = 4")
    axes.set_title("Orders of the discrete sleigh", loc="left")
    axes.legend()
    return figure
