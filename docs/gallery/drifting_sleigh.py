"""A sleigh whose blade skids: pushed backwards it swings round, and the less grip it has the farther it drifts."""

from functools import cache

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.plot import theme

SLEIGH = nh.ChaplyginSleigh(mass=1.0, inertia=0.4, a=0.5)
BLADE = np.array([[0.0, 0.0, 1.0]])
GRIPS = {"ideal blade": np.inf, "grip 0.8": 0.8, "grip 0.45": 0.45}
COLORS = (theme.DISCRETE, theme.CONTINUOUS, "#d55e00")
HULL = np.array([[-0.2, 0.14, 1.0], [0.45, 0.14, 1.0], [0.75, 0.0, 1.0], [0.45, -0.14, 1.0], [-0.2, -0.14, 1.0]])
STEP, STEPS = 0.01, 600


@cache
def run(grip: float) -> nh.Orbit:
    """Return the motion that begins backwards with a slight turn."""
    forced = nh.Forced(SLEIGH, force=nh.Slip(BLADE, grip))
    return nh.simulate(nh.discretize(forced, STEP), body_velocity=(0.3, -1.6, 0.0), steps=STEPS)


def slip(orbit: nh.Orbit) -> np.ndarray:
    """Return the sideward velocity of the blade."""
    return orbit.body_velocity @ BLADE[0]


def numbers() -> dict[str, tuple[float, float, float]]:
    """The ideal blade keeps the energy; what the others lose is the work of friction; each blade holds in the end."""
    ideal, *others = map(run, GRIPS.values())
    gaps = [np.abs(orbit.energy - orbit.energy[0] - orbit.work).max() for orbit in others]
    return {
        "relative change of the energy of the ideal blade": (float(np.ptp(ideal.energy) / ideal.energy[0]), 0.0, 1e-13),
        "gap of energy and work of the others": (float(max(gaps)), 0.0, 1e-13),
        "largest slip in the end": (float(max(abs(slip(orbit)[-1]) for orbit in others)), 0.0, 1e-15),
    }


@theme.in_style
def draw() -> Figure:
    """Draw the paths with the hull, where blades slide, and the slips and the energies over time."""
    figure = Figure(figsize=(10.0, 4.8), layout="constrained")
    axes = figure.subplot_mosaic([["path", "slip"], ["path", "energy"]], width_ratios=(1.25, 1.0))
    for (name, grip), color in zip(GRIPS.items(), COLORS, strict=True):
        orbit = run(grip)
        _path(axes["path"], orbit, name, color)
        axes["slip"].plot(orbit.time, slip(orbit), color=color, linewidth=1.4)
        axes["energy"].plot(orbit.time, orbit.energy, color=color, linewidth=1.4)
    axes["path"].set(xlabel="x", ylabel="y", aspect="equal")
    axes["path"].set_title("Paths of the blade; thick where it slides", loc="left")
    axes["path"].legend(loc="best", fontsize="small")
    axes["slip"].set(ylabel="sideward velocity", xticklabels=[])
    axes["energy"].set(xlabel="time", ylabel="energy", ylim=(0.0, None))
    return figure


def _path(axes: Axes, orbit: nh.Orbit, name: str, color: str) -> None:
    """Draw a path, thick where the blade slides, and the hull at equal times."""
    slides = slip(orbit) != 0
    place = np.where(slides[:, None], orbit.position, np.nan)
    axes.plot(*orbit.position.T, color=color, linewidth=1.2, label=name)
    axes.plot(*place.T, color=color, linewidth=4.0, alpha=0.45, solid_capstyle="butt")
    for g in orbit.configuration[::100]:
        axes.fill(*(HULL @ g.T)[:, :2].T, facecolor=(*to_rgb(color), 0.12), edgecolor=color, linewidth=0.9)
