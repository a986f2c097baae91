"""A thousand sleighs of one energy: pushed anyhow, they all end up gliding with their mass in front."""

from functools import cache

import numpy as np
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.plot import theme

SLEIGH = nh.ChaplyginSleigh(mass=1.0, inertia=0.75, a=0.5)


@cache
def members() -> nh.Ensemble:
    """Return a thousand motions that start evenly along the ellipse of their energy."""
    angle = np.linspace(-np.pi, np.pi, 1002)[1:-1]  # not the two equilibria
    start = np.stack([np.sin(angle), np.cos(angle)], axis=1)  # J + m a^2 = m: a circle
    return nh.ensemble(nh.discretize(SLEIGH, 0.05), restricted_velocity=start, steps=400, save_every=40)


def numbers() -> dict[str, tuple[float, float, float]]:
    """Which part of them glides forwards in the end."""
    return {"part that glides forwards": (float((members().restricted_momentum[:, -1, 1] > 0).mean()), 1.0, 0.0)}


@theme.in_style
def draw() -> Figure:
    """Draw the momenta at four times."""
    figure = Figure(figsize=(10.0, 3.0), layout="constrained")
    for axes, saved in zip(figure.subplots(1, 4, sharey=True), (0, 2, 5, 10), strict=True):
        axes.scatter(*members().restricted_momentum[:, saved].T, s=3, color=theme.DISCRETE)
        axes.set_title(f"t = {members().time[0, saved]:g}", loc="left")
        axes.set(xlabel="turning", aspect="equal", xlim=(-1.2, 1.2), ylim=(-1.2, 1.2))
    figure.axes[0].set_ylabel("along the blade")
    return figure
