"""Figure quat_dots: discrete dynamics of the top near the origin of the projective plane."""

import dataclasses
import functools
from typing import Any

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection
from matplotlib.figure import Figure as MatplotlibFigure

import nonholo as nh
from nonholo.plot import theme
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper.figures._figure import figure
from nonholo_paper.figures._plane import draw_curve, project
from nonholo_paper.figures.quat import J, sphere
from nonholo_paper.figures.st import TOP
from nonholo_paper.formulas import suslov_integrals as formulas
from nonholo_paper.formulas import suslov_momenta

ENERGIES = [0.1, 0.3, 0.55, 0.85]
SIDES = {1: theme.DISCRETE, -1: theme.COMPONENTS[1]}


@dataclasses.dataclass(frozen=True)
class Orbits:
    """The drawing of `picture`; one of each for an energy, two orbits.

    Attributes:
        axes: The axes.
        ovals: The parts of the invariant curves about the origin.
        orbits: Displacements of one orbit, from first to last.
        stable: Stable equilibria, filled.
        unstable: Unstable equilibria, empty.
    """

    axes: Axes
    ovals: tuple[LineCollection, ...]
    orbits: tuple[PathCollection, ...]
    stable: PathCollection
    unstable: PathCollection


@functools.cache
@theme.in_style
def picture() -> Orbits:
    """Draw it."""
    axes = MatplotlibFigure(figsize=(7.2, 6.2), layout="constrained").add_subplot()
    ovals, orbits, points = [], [], []
    for energy in ENERGIES:
        curve = nh.invariant_curve(TOP, energy)
        inner = min(curve.components, key=lambda z: np.linalg.norm(z[:, 1:], axis=1).max())
        ovals.append(
            draw_curve(axes, dataclasses.replace(curve, components=(inner,)), color=theme.LEVEL, linewidth=1.2)
        )
        attracting = curve.over(float(np.arctan2(-J[1, 2], -J[0, 2])))
        points.append(project(attracting[np.argmin(np.linalg.norm(attracting[:, 1:], axis=1))]))
        orbits += [_orbit(axes, energy, side) for side in SIDES]
    result = np.array(points)
    ends = 1.15 * np.outer([-1, 1], result[-1])
    axes.plot(*ends.T, color=theme.INK, linewidth=1.0, zorder=2, label=r"equilibria $\mathbb{P}$")
    dots: Any = {"s": 58, "zorder": 7, "linewidths": 1.6}
    stable = axes.scatter(*result.T, facecolors=theme.STABLE, edgecolors=theme.STABLE, label="stable", **dots)
    unstable = axes.scatter(*-result.T, facecolors="white", edgecolors=theme.UNSTABLE, label="unstable", **dots)
    axes.set(xlabel="$q_1$", ylabel="$q_2$", title="Discrete dynamics near the origin")
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return Orbits(axes, tuple(ovals), tuple(orbits), stable, unstable)


def _orbit(axes: Axes, energy: float, side: int) -> PathCollection:
    """Draw an orbit from the unstable to the stable equilibrium, and arrows along its jumps."""
    W = nh.heteroclinic(TOP, energy=energy, side=side).orbit.displacement
    q0 = np.sqrt((1 + np.trace(W, axis1=-2, axis2=-1)) / 4)
    q = np.stack([W[:, 2, 1] - W[:, 1, 2], W[:, 0, 2] - W[:, 2, 0]], axis=-1) / (4 * q0[:, None])
    jumps = np.linalg.norm(np.diff(q, axis=0), axis=1)
    for k in np.flatnonzero((jumps > 0.06) | (jumps == jumps.max())):
        look = {"arrowstyle": "-|>", "color": SIDES[side], "linewidth": 0.7, "shrinkA": 3, "shrinkB": 3, "alpha": 0.8}
        axes.annotate("", q[k + 1], q[k], arrowprops=look, zorder=3)
    label = f"orbits, $J_{{13}}q_1 + J_{{23}}q_2 {'><'[int(_slope(q) < 0)]} 0$" if energy == ENERGIES[0] else None
    return axes.scatter(*q.T, s=17, color=SIDES[side], linewidths=0, zorder=5, label=label)


def _slope(q: Float[np.ndarray, "K 2"]) -> float:
    return float(np.median(suslov_momenta.slope(J, sphere(q))))


@statement
def discrete_dynamics() -> Measured:
    """Compare ends of drawn orbits with drawn equilibria, put orbits into the integral, count changes of side."""
    drawn, gaps = picture(), []
    stable, unstable = (np.asarray(dots.get_offsets()) for dots in (drawn.stable, drawn.unstable))
    for number, dots in enumerate(drawn.orbits):
        q = np.asarray(dots.get_offsets())
        oval = np.concatenate([np.asarray(path.vertices) for path in drawn.ovals[number // 2].get_paths()])
        level = formulas.quartic(J, sphere(oval))
        gaps.append(np.abs(formulas.quartic(J, sphere(q)) - level.mean()).max() + np.ptp(level))
        gaps.append(np.abs(q[0] - unstable[number // 2]).max())
        gaps.append(np.abs(q[-1] - stable[number // 2]).max())
        moving = suslov_momenta.slope(J, sphere(q))
        gaps.append(float(np.any(np.sign(moving[np.abs(moving) > 1e-9]) != np.sign(np.median(moving)))))
    return Measured(float(max(gaps)), note="8 orbits, from start to end to rounding")


FIGURE = figure(lambda: picture().axes.figure, discrete_dynamics)
