"""A round sleigh in a round box: its energy is exact, and impacts of some starts fill curves, of others a sea."""

from functools import cache

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.plot import theme

SLEIGH = nh.ChaplyginSleigh(mass=1.0, inertia=0.5, a=0.3)
CENTER, HULL = np.array([0.3, 0.0, 1.0]), 0.4  # a round hull about the center of mass, in a circle of radius 1.4
TURNS = np.sqrt(SLEIGH.constrained_inertia[0, 0])  # times the rate of turning: its share of the speed, 2T = 1
REGULAR, CHAOTIC = (0.08, 0.2, 0.3, 0.9), (0.62, -0.55)


def place(states: nh.Orbit) -> np.ndarray:
    """Return where the center of mass is."""
    return states.configuration[:, :2] @ CENTER


WALL = nh.Event(lambda states: 1 - (place(states) ** 2).sum(axis=1), name="wall", reset=nh.Impact())


@cache
def run(turning: float, steps: int = 6000) -> nh.Orbit:
    """Return the motion from the middle of the circle, with this share of the turning."""
    velocity = (turning / TURNS, np.sqrt(1 - turning**2), 0.0)
    begun = nh.SE(2).exp([0.0, -0.3, 0.0 if turning > 0 else 0.3])
    discrete = nh.discretize(SLEIGH, 0.04)
    return nh.simulate(discrete, body_velocity=velocity, configuration=begun, steps=steps, events=[WALL])


def numbers() -> dict[str, tuple[float, float, float]]:
    """The energy is kept over 60 impacts; the velocity of the center toward the wall is reversed."""
    orbit = run(0.3, 2500)
    hits, change = orbit.events["wall"], np.ptp(orbit.energy) / orbit.energy[0]
    toward = [(place(each) * velocity(each)).sum(axis=1) for each in (hits.states, hits.after)]
    return {
        "relative change of the energy": (float(change), 0.0, 1e-13),
        "velocities toward the wall, sum": (float(np.abs(np.add(*toward)).max()), 0.0, 1e-11),
    }


def velocity(states: nh.Orbit) -> np.ndarray:
    """Return the velocity of the center of mass in the plane."""
    omega, v, _ = states.body_velocity.T
    return (states.configuration[:, :2, :2] @ np.stack([v, 0.3 * omega], axis=1)[..., None])[..., 0]


@theme.in_style
def draw() -> Figure:
    """Draw the path of one, with the sleigh at its impacts, and the impacts of all."""
    figure = Figure(figsize=(10.0, 4.8), layout="constrained")
    left, right = figure.subplots(1, 2)
    _path(left, run(0.3))
    for turning in REGULAR + CHAOTIC:
        orbit = run(turning, 6000 if turning in REGULAR else 15000)
        color, size = (theme.DISCRETE, 3.5) if turning in REGULAR else (theme.CONTINUOUS, 1.5)
        right.plot(*_section(orbit), ".", color=color, markersize=size)
    right.set(xlabel="heading, from the outward normal", ylabel="turning after the impact, of the largest")
    right.set_xticks([-np.pi, -np.pi / 2, 0, np.pi / 2, np.pi], ["$-\\pi$", "", "0", "", "$\\pi$"])
    right.set_title("Impacts of six starts", loc="left")
    return figure


def _section(orbit: nh.Orbit) -> tuple[np.ndarray, np.ndarray]:
    """Return the heading against the normal and the share of the turning, after each impact."""
    after = orbit.events["wall"].after
    angle = after.heading - np.arctan2(*place(after).T[::-1])
    return np.mod(angle + np.pi, 2 * np.pi) - np.pi, after.body_velocity[:, 0] * TURNS


def _path(axes: Axes, orbit: nh.Orbit) -> None:
    """Draw a path of the center of mass, and the sleigh with its blade at impacts."""
    early = orbit.chosen(orbit.time < 45)
    axes.plot(*place(early).T, color=theme.DISCRETE, linewidth=0.9)
    hits, turn = orbit.events["wall"].states.chosen(slice(0, 16, 5)), np.linspace(0, 2 * np.pi, 400)
    circle = np.stack([np.cos(turn), np.sin(turn)])
    for center, blade in zip(place(hits), hits.position, strict=True):
        axes.plot(*(center[:, None] + HULL * circle), color="#d55e00", linewidth=0.9)
        axes.plot(*(center + np.outer((-1.0, 1.0), center - blade)).T, color="#d55e00", linewidth=2.0)
    axes.plot(*circle, color=theme.INK, linewidth=0.7, linestyle=(0, (2, 3)))
    axes.plot(*((1 + HULL) * circle), color=theme.INK, linewidth=1.4)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel="x", ylabel="y")
    axes.set_title("Center of mass; the sleigh at some impacts", loc="left")
