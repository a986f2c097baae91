"""The variety of displacements, foliated by its energy levels: a projective plane for a top, a Moebius band else."""

import dataclasses
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection
from matplotlib.patches import Circle, FancyArrowPatch

from nonholo._checks import array, error
from nonholo._types import Float
from nonholo.analysis import InvariantCurve, invariant_curve
from nonholo.analysis._variety_points import closed_form, points_of
from nonholo.discrete import Discretization
from nonholo.orbit import Orbit
from nonholo.plotting import _theme as theme
from nonholo.plotting._momentum_locus import own_orbit
from nonholo.plotting._thinning import evenly_in_box
from nonholo.systems import ChaplyginSleigh

_LEVELS = 9
_MOST_DOTS = 1500
_POINTS = 300
_TALLEST = 4.0  # height of the strip in translations without turning
_PAIRS = "abcd"  # names of pairs of opposite points of the rim that are one


@dataclasses.dataclass(frozen=True)
class InvariantCurvesPicture:
    """What `invariant_curves` drew; None where there was nothing to draw.

    Attributes:
        axes: The axes.
        levels: The curves, for each energy.
        own: The curve of the orbit's energy.
        stable: Attracting equilibria on the curves, filled.
        unstable: Repelling equilibria, empty.
        orbit: The displacements of the orbit, coloured by time.
    """

    axes: Axes
    levels: tuple[LineCollection, ...]
    own: LineCollection | None
    stable: PathCollection | None
    unstable: PathCollection | None
    orbit: PathCollection | None


@theme.styled
def invariant_curves(
    discrete: Discretization, orbit: Orbit | None = None, axes: Axes | None = None, energies: Any = None
) -> InvariantCurvesPicture:
    r"""Draw the displacements, foliated by energy, with the equilibria and an orbit on its curve.

    For a top the variety is a disc: the radius is the step angle, the direction is u of the plane of rotation
    $u\wedge e_3$; opposite points of the rim, half-turns, are the same displacement and bear the same letter. For a
    sleigh it is the strip of the step angle $\Delta$ and the translation $\nu$ along the chord; its left edge is its
    right edge upside down. An orbit jumps along its curve, from the repelling to the attracting equilibrium.

    Args:
        discrete: A top with n = 3 or a sleigh, discretised with "matrix" and "skew".
        orbit: An orbit of it.
        axes: Where to draw; a new figure by default.
        energies: Energies of the curves; by default nine.

    Raises:
        ValueError: Another system or discretisation, an orbit of another one, energies that are not positive.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.5)
        >>> picture = nh.plot.invariant_curves(sleigh, energies=[1.0, 2.0])
        >>> len(picture.levels), len(picture.stable.get_offsets())
        (2, 2)
    """
    where = "plot.invariant_curves"
    checked = closed_form(f"{where}(discrete=...)", discrete)
    own_orbit(f"{where}(orbit=...)", orbit, checked)
    axes = theme.axes_or_new(axes, (6.2, 6.0))
    curves = [invariant_curve(checked, energy, _POINTS) for energy in _energies(checked, energies)]
    levels = tuple(_lines(axes, curve, color=theme.LEVEL, linewidth=1.1, zorder=1) for curve in curves)
    own = path = None
    if orbit is not None:
        curves = [invariant_curve(checked, orbit[:1].energy[0], _POINTS)] if orbit.energy[0] > 0 else []
        for curve in curves:
            own = _lines(axes, curve, color=theme.DISCRETE, linewidth=1.8, zorder=3, label="its energy")
        path = _orbit(axes, checked, orbit)
    stable, unstable = _equilibria(axes, checked, curves)
    if isinstance(checked.system, ChaplyginSleigh):
        _dress_strip(axes, curves)
        theme.legend_above(axes)
    else:
        _dress_disc(axes)
    return InvariantCurvesPicture(axes, levels, own, stable, unstable, path)


def _energies(discrete: Discretization, energies: Any) -> Float[np.ndarray, "L"]:
    if energies is not None:
        where, remedy = "plot.invariant_curves(energies=...)", "Pass a list of positive energies."
        levels = array(where, energies, (None,), remedy)
        if not np.all(levels > 0):
            raise error(where, "be positive", f"{levels.min():g}", remedy)
        return levels
    system, h = discrete.system, float(discrete.time_step)
    if isinstance(system, ChaplyginSleigh):  # in units of the energy of a quarter-turn on the spot
        return float(system.inertia + system.mass * system.a**2) / h**2 * (np.arange(1, _LEVELS + 1) / 5) ** 2
    # of the order of the largest energy there is
    largest = np.linalg.eigvalsh(np.asarray(system.canonical.constrained_inertia))[-1] / (2 * h**2)
    return largest * (np.arange(1, _LEVELS + 1) / (_LEVELS + 0.5))


def _lines(axes: Axes, curve: InvariantCurve, **look: Any) -> LineCollection:
    is_sleigh = isinstance(curve.discrete.system, ChaplyginSleigh)
    cut = _strips if is_sleigh else _discs
    runs = [run for points in curve.components for run in cut(points)]
    lines = LineCollection(runs, **look)
    axes.add_collection(lines)
    return lines


def _discs(z: Float[np.ndarray, "K 3"]) -> list[Float[np.ndarray, "L 2"]]:
    """Return the runs of a curve on the sphere, each turned to the upper half and laid on the disc."""
    runs = []
    for sign in (1, -1):
        upper = sign * z[:, 0] >= 0
        starts = np.flatnonzero(np.diff(np.concatenate([[0], upper.astype(int), [0]])))
        for first, last in starts.reshape(-1, 2):
            if last - first > 1:
                runs.append(_disc(sign * z[first:last]))
    return runs


def _strips(points: Float[np.ndarray, "K 2"]) -> list[Float[np.ndarray, "L 2"]]:
    """Return the runs of a curve on the band between the angles -pi and pi, turned over after each full turn."""
    turn = np.floor((points[:, 0] + np.pi) / (2 * np.pi)).astype(int)
    runs = []
    for number in np.unique(turn):
        shift, flip = 2 * np.pi * number, (-1) ** int(number)
        inside = (points[:, 0] >= shift - np.pi) & (points[:, 0] <= shift + np.pi)
        bounds = np.flatnonzero(np.diff(np.concatenate([[0], inside.astype(int), [0]])))
        for first, last in bounds.reshape(-1, 2):
            if last - first > 1:
                runs.append((points[first:last] - [shift, 0.0]) * [1.0, flip])
    return runs


def _flat(discrete: Discretization, points: Float[np.ndarray, "K c"]) -> Float[np.ndarray, "K 2"]:
    if isinstance(discrete.system, ChaplyginSleigh):
        return points
    return _disc(np.where(points[:, :1] >= 0, 1.0, -1.0) * points)


def _disc(z: Float[np.ndarray, "K 3"]) -> Float[np.ndarray, "K 2"]:
    """Return the direction of the last two components, as long as the step angle in half-turns."""
    size = np.linalg.norm(z[:, 1:], axis=1, keepdims=True)
    angle = 2 * np.arctan2(size, z[:, :1]) / np.pi
    return z[:, 1:] * np.divide(angle, size, out=np.ones_like(size), where=size > 0)


def _orbit(axes: Axes, discrete: Discretization, orbit: Orbit) -> PathCollection:
    x, y = _flat(discrete, points_of(discrete, orbit.displacement)).T
    chosen = evenly_in_box(np.stack([x, y], axis=1), _MOST_DOTS)
    return axes.scatter(
        x[chosen],
        y[chosen],
        c=orbit.time[chosen],
        cmap=theme.TIME,
        norm=theme.time_scale(orbit),
        s=theme.dot_size(len(orbit)) + 6,
        linewidths=0,
        zorder=6,
        label="orbit",
    )


def _equilibria(axes: Axes, discrete: Discretization, curves: list[InvariantCurve]) -> tuple[Any, Any]:
    """Draw the line of equilibria, and its points on the curves."""
    system: Any = discrete.system.canonical
    if system.equilibria().attracting is None:
        return None, None
    if isinstance(system, ChaplyginSleigh):
        points = [p[np.sign(p[:, 1]) == np.sign(system.a)] for p in (curve.over(0.0) for curve in curves)]
        reach = max((abs(p).max() for p in points), default=1.0) * 1.06 * np.array([0.0, np.sign(system.a)])
    else:
        towards = -np.asarray(system.coupling)
        reach = towards / np.linalg.norm(towards)
        points = [_disc(curve.over(np.arctan2(reach[1], reach[0]))) for curve in curves]
    axes.plot(*np.stack([0 * reach, reach], axis=1), color=theme.STABLE, linewidth=0.9, zorder=2)
    axes.plot(*np.stack([0 * reach, -reach], axis=1), color=theme.UNSTABLE, linewidth=0.9, dashes=(5, 3), zorder=2)
    found = np.concatenate([np.empty((0, 2)), *points])
    size = 40 if len(curves) == 1 else 22
    stable = axes.scatter(*found.T, s=size, color=theme.STABLE, zorder=5, label="stable")
    unstable = axes.scatter(
        *-found.T, s=size, facecolors="white", edgecolors=theme.UNSTABLE, linewidths=1.5, zorder=5, label="unstable"
    )
    return stable, unstable


def _dress_disc(axes: Axes) -> None:
    axes.add_patch(Circle((0, 0), 1.0, facecolor="none", edgecolor=theme.MUTED, linewidth=1.2, zorder=2))
    for index, letter in enumerate(_PAIRS):
        angle = np.pi * (index + 0.5) / len(_PAIRS)
        for sign in (1, -1):
            x, y = sign * np.cos(angle), sign * np.sin(angle)
            axes.plot(x, y, "o", color=theme.MUTED, markersize=4, zorder=4)
            axes.text(1.07 * x, 1.07 * y, letter, color=theme.INK, ha="center", va="center", style="italic")
    axes.set(xlim=(-1.14, 1.14), ylim=(-1.14, 1.14), xticks=[], yticks=[])
    axes.set_aspect("equal")
    axes.spines[:].set_visible(False)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="lower left", bbox_to_anchor=(0.9, -0.03))
    axes.set_xlabel("radius: step angle; equal letters: the same half-turn")
    axes.set_title("Displacements")


def _dress_strip(axes: Axes, curves: list[InvariantCurve]) -> None:
    axes.autoscale_view()
    low, high = axes.get_ylim()
    middle = max((float(np.abs(curve.over(0.0)[:, 1]).max()) for curve in curves), default=1.0)
    reach = min(max(-low, high), _TALLEST * middle)  # levels of a balanced sleigh go to infinity
    axes.set(xlim=(-np.pi, np.pi), ylim=(-reach, reach), xticks=np.pi * np.linspace(-1, 1, 5))
    axes.set_xticklabels([r"$-\pi$", r"$-\pi/2$", "0", r"$\pi/2$", r"$\pi$"])
    for side in (-1, 1):
        arrow = FancyArrowPatch(
            (side * np.pi, -0.1 * side * reach),
            (side * np.pi, 0.1 * side * reach),
            arrowstyle="-|>",
            mutation_scale=22,
            shrinkA=0,
            shrinkB=0,
            linewidth=2.0,
            color=theme.INK,
            clip_on=False,
            zorder=7,
        )
        axes.add_patch(arrow)
    axes.spines["right"].set_visible(True)
    axes.set(xlabel=r"step angle $\Delta$", ylabel=r"translation along the chord  $\nu$")
    axes.set_title("Displacements")
