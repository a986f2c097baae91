r"""The Chaplygin sleigh pushed backwards: it turns round through a cusp, by $\pi\sqrt{1 + J/(ma^2)}$ in total."""

import numpy as np
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.plot import theme

SLEIGH = nh.ChaplyginSleigh(mass=1.0, inertia=0.75, a=0.5)  # J = 3 m a^2: once round


def numbers() -> dict[str, tuple[float, float, float]]:
    """The whole turn of a long flow, started and ended within 1e-6 of straight motion."""
    flow = nh.flow(SLEIGH, body_velocity=(1e-6, -1.0, 0.0), times=(0.0, 60.0))
    return {"whole turn, degrees": (float(np.degrees(np.ptp(flow.heading))), 360.0, 1e-3)}


@theme.in_style
def draw() -> Figure:
    """Draw the track with its cusp."""
    orbit = nh.simulate(nh.discretize(SLEIGH, 0.1), body_velocity=(0.05, -1.0, 0.0), steps=260)
    figure = Figure(figsize=(7.5, 6.0), layout="constrained")
    nh.plot.blade_track(orbit, axes=figure.subplots(), title="Chaplygin sleigh")
    return figure
