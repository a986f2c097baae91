r"""The seven ready systems in coordinates: where they go, and what the midpoint rule does to their energy.

Energy is -dL_d/dh of the steps; its change is shown divided by h^2. Steps h = 0.1, residuals of the discrete
constraint over 20000 steps (snakeboard: 500, where its wheels are nearly crossed):

    particle                     2e-16   settles to a constant as the motion becomes straight, -0.062 h^2
    rolling_disk                 1e-16   constant but for rounding, 7e-12: both rates are kept
    knife_edge_on_incline        1e-16   oscillates between 0 and 0.25 h^2, without drift
    snakeboard                   2e-15   at most 0.40 h^2, and returns
    two_wheeled_robot            1e-15   settles to a constant as the motion becomes straight, -0.041 h^2
    chaotic_quartic_oscillator   4e-16   wanders: mean square 4e-5 h^4 t over 64 starts, up to t = 20000
    non_reversible               5e-13   drifts, -0.015 h^2 t at first: no reflection reverses a rotation
      with asymmetry = 0         4e-13   oscillates within 1.05 h^2, without drift

The residual of the last two is the rounding of the pendulum's angle, which grows to thousands. Run the script to print
the residuals and energies and to draw docs/images/gallery/lagrange_dalembert_examples.png; it takes a minute.
"""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.examples import Example
from nonholo.lagrange_dalembert import CoordinateOrbit
from nonholo.plot import theme

STEPS = {0.2: "#9ecae1", 0.1: theme.DISCRETE}
"""Time steps, and the color of their energy."""

PICTURE = Path(__file__).parents[1] / "images" / "gallery" / "lagrange_dalembert_examples.png"
MOST_POINTS = 4000
X = nh.examples


class Card(NamedTuple):
    """One system of the picture.

    Attributes:
        title: What it is called, and how its energy behaves.
        make: Makes the example.
        plane: The two coordinates whose path is drawn.
        path: The time of the path.
        duration: The time of the energies.
    """

    title: str
    make: Callable[[], Example]
    plane: tuple[str, str]
    path: float
    duration: float


CARDS = (
    Card("Particle: settles", X.particle, ("x", "z"), 6.0, 60.0),
    Card("Rolling disk: exact", X.rolling_disk, ("x", "y"), 12.6, 2000.0),
    Card("Knife edge: bounded", X.knife_edge_on_incline, ("y", "x"), 12.0, 30.0),
    Card("Snakeboard: returns", X.snakeboard, ("x", "y"), 50.0, 50.0),
    Card("Robot: settles", X.two_wheeled_robot, ("x", "y"), 14.0, 30.0),
    Card("Chaotic oscillator: wanders", X.chaotic_quartic_oscillator, ("x", "y1"), 120.0, 20000.0),
    Card("Not reversible: drifts", X.non_reversible, ("x", "y"), 60.0, 2000.0),
    Card("Its reversible companion", lambda: X.non_reversible(asymmetry=0.0), ("x", "y"), 60.0, 2000.0),
)


def run(ready: Example, h: float, duration: float) -> CoordinateOrbit:
    """Return the discrete orbit from the start of an example."""
    start = {"configuration": ready.configuration, "body_velocity": ready.body_velocity}
    return nh.simulate(nh.discretize(ready.system, h), **start, steps=round(duration / h))


def draw_path(axes: Axes, card: Card, ready: Example, orbit: CoordinateOrbit) -> None:
    """Draw the motion in its plane: the flow where a formula is known, and dots for a few steps."""
    i, j = (ready.coordinates.index(name) for name in card.plane)
    few = orbit.time <= card.path + 1e-9
    q = orbit.configuration[few]
    if ready.exact is not None:
        exact = ready.exact(np.linspace(0.0, card.path, 400))
        axes.plot(exact[:, i], exact[:, j], color=theme.CONTINUOUS, linewidth=3.5, alpha=0.7, label="exact")
        axes.scatter(q[::4, i], q[::4, j], s=9, color=theme.DISCRETE, linewidths=0, zorder=3, label="map")
        axes.legend(loc="upper left", fontsize="small", handletextpad=0.3)
    else:
        axes.plot(q[:, i], q[:, j], color=theme.DISCRETE, linewidth=1.1 if card.path < 55 else 0.5)
    axes.scatter(*q[0, [i, j]], s=26, facecolor="white", edgecolor=theme.INK, linewidth=1.0, zorder=4)
    axes.set_title(card.title)
    axes.set_xlabel(card.plane[0], labelpad=1)
    axes.set_ylabel(card.plane[1], labelpad=1)
    axes.margins(0.12)
    if card.plane != ("x", "z"):
        axes.set_aspect("equal", adjustable="datalim")
    if card.plane == ("y", "x"):
        axes.invert_yaxis()  # the slope falls along x
        axes.set_ylabel("x, down the slope", labelpad=1)


def draw_energies(axes: Axes, orbits: dict[float, CoordinateOrbit]) -> None:
    """Draw the change of energy over h^2 against time, for each step."""
    for h, orbit in orbits.items():
        every = max(1, len(orbit) // MOST_POINTS)
        change = (orbit.energy - orbit.energy[0])[::every] / h**2
        axes.plot(orbit.time[::every], change, color=STEPS[h], linewidth=0.8 if h < 0.2 else 2.6, label=f"h = {h:g}")
    axes.axhline(0.0, color=theme.LEVEL, linewidth=0.8, zorder=1)
    axes.set_xlabel("time", labelpad=1)
    axes.set_ylabel(r"$\Delta E/h^2$", labelpad=1)
    if max(np.abs(line.get_ydata()).max() for line in axes.lines[:-1]) < 1e-6:
        axes.set_ylim(-0.1, 0.1)
        axes.text(0.03, 0.78, "below 1e-9", transform=axes.transAxes, fontsize=9, color="#555a62")


@theme.in_style
def draw() -> Figure:
    """Run all systems, print their residuals and energies, and return the picture."""
    figure = Figure(figsize=(13.0, 9.4), layout="constrained")
    grid = figure.add_gridspec(4, 4, height_ratios=(2.3, 1.0, 2.3, 1.0))
    for place, card in enumerate(CARDS):
        ready = card.make()
        orbits = {h: run(ready, h, card.duration) for h in STEPS}
        row, column = 2 * (place // 4), place % 4
        path, energies = (figure.add_subplot(grid[row + k, column]) for k in (0, 1))
        fine = orbits[0.1]
        draw_path(path, card, ready, fine if card.path <= card.duration else run(ready, 0.1, card.path))
        draw_energies(energies, orbits)
        if place == 0:
            energies.legend(loc="upper right", fontsize="small", ncols=2)
        largest = np.abs(fine.energy - fine.energy[0]).max()
        numbers = f"residual {fine.constraint_residual.max():.0e}  energy {largest:.1e} = {largest / 0.01:.3g} h^2"
        sys.stdout.write(f"{card.title:30s} t = {fine.time[-1]:<6g} {numbers}\n")
    figure.suptitle("Seven nonholonomic systems under the midpoint rule: path, and energy error in units of $h^2$")
    return figure


def main() -> None:
    """Draw and save the picture."""
    PICTURE.parent.mkdir(parents=True, exist_ok=True)
    draw().savefig(PICTURE, dpi=84)


if __name__ == "__main__":
    main()
