"""Figure quat: invariant curves and the line of equilibria on the projective plane."""

import dataclasses
import functools
from typing import Any

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection
from matplotlib.figure import Figure as MatplotlibFigure
from matplotlib.lines import Line2D

import nonholo as nh
from nonholo.plot import theme
from nonholo.plot.sheets import draw_rim
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper._suslov_twin import BODIES
from nonholo_paper.figures._figure import figure
from nonholo_paper.figures._plane import draw_curve, project
from nonholo_paper.figures.st import TOP
from nonholo_paper.formulas import suslov_integrals as formulas
from nonholo_paper.formulas import suslov_momenta

J = np.array(BODIES["generic"])
ENERGIES = [0.02, 0.1, 0.2, 0.3, 0.45, 0.6, 0.75, 0.87, 0.98, 1.06, 1.15, 1.22]


@dataclasses.dataclass(frozen=True)
class Foliation:
    """The drawing of `picture`.

    Attributes:
        axes: The axes.
        curves: The invariant curves of the energies and of the saddles.
        line: The line of equilibria.
        saddles: The saddle points.
        centers: The centers.
    """

    axes: Axes
    curves: tuple[LineCollection, ...]
    line: Line2D
    saddles: PathCollection
    centers: PathCollection


@functools.cache
@theme.in_style
def picture() -> Foliation:
    """Draw it."""
    axes = MatplotlibFigure(figsize=(7.6, 6.0), layout="constrained").add_subplot()
    result = nh.critical_energies(TOP)
    curves = [
        draw_curve(axes, nh.invariant_curve(TOP, energy), color=theme.MUTED, linewidth=0.9) for energy in ENERGIES
    ]
    saddle, equatorial = float(result.saddle or 0), float(result.equatorial_saddle or 0)
    for energy, color in ((saddle, theme.DISCRETE), (equatorial, theme.COMPONENTS[2])):
        curves.append(draw_curve(axes, nh.invariant_curve(TOP, energy, 1200), color=color, linewidth=1.9, zorder=3))
    axes.plot([], [], color=theme.DISCRETE, label=f"$h^*$: energy {saddle:.3f}")
    axes.plot([], [], color=theme.COMPONENTS[2], label=f"$h_e$: energy {equatorial:.3f}")
    across = np.array([-J[1, 2], J[0, 2]]) / np.hypot(J[0, 2], J[1, 2])
    line = axes.plot(*np.outer(across, [-1, 1]), color=theme.INK, linewidth=2.2, zorder=4, label="equilibria")[0]
    dots: Any = {"s": 52, "zorder": 6, "linewidths": 1.5, "edgecolors": theme.UNSTABLE}
    saddles = axes.scatter(*critical("saddle").T, marker="X", facecolors="white", label="saddles", **dots)
    centers = axes.scatter(*critical("maximum").T, facecolors=theme.UNSTABLE, label="centers", **dots)
    draw_rim(axes)
    axes.set(
        xlabel="$q_1$", ylabel="$q_2$", title="Invariant curves", xlim=(-1.14, 1.14), ylim=(-1.14, 1.14), aspect="equal"
    )
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return Foliation(axes, tuple(curves), line, saddles, centers)


def critical(kind: str) -> Float[np.ndarray, "L 2"]:
    """Return the critical points of a kind, both of two opposite ones."""
    points = [p for p in nh.critical_energies(TOP).points if p.kind == kind]
    z = np.array(
        [[np.sqrt(max(0.0, 1 - p.half_turn_vector @ p.half_turn_vector)), *p.half_turn_vector] for p in points]
    )
    return np.concatenate([project(z), -project(z)])


def sphere(q: Float[np.ndarray, "L 2"]) -> Any:
    """Return q0, q1, q2."""
    return np.stack([np.sqrt(np.maximum(0.0, 1 - np.sum(q * q, axis=1))), *q.T])


@statement
def foliation() -> Measured:
    """Put drawn curves into the quartic integral, and the drawn points into its derivatives, and count them."""
    drawn = picture()
    gaps = []
    for curve in drawn.curves:
        points = np.concatenate([np.asarray(path.vertices) for path in curve.get_paths()])
        values = formulas.quartic(J, sphere(points))
        gaps.append(np.ptp(values) / values.max())
    saddles, centers = (np.asarray(dots.get_offsets()) for dots in (drawn.saddles, drawn.centers))
    gaps += [_slope(point) for point in (*saddles, *centers)]
    ends = np.asarray(drawn.line.get_xydata())
    gaps.append(np.abs(suslov_momenta.slope(J, sphere(ends))).max())
    gaps.append(float(len(centers) != 2))
    gaps.append(float(np.sum(np.linalg.norm(saddles, axis=1) < 0.99) != 2))
    return Measured(float(max(gaps)), note="14 curves; two saddles and two centers inside, one more saddle on the rim")


def _slope(point: Float[np.ndarray, "2"]) -> float:
    """Return the derivative of the quartic integral along the sphere, by central differences."""
    q, small = np.asarray(sphere(point[None]))[:, 0], 1e-6
    rows = np.linalg.svd(q[None])[2][1:]
    forth, back = ([formulas.quartic(J, (q + s * row) / np.hypot(1, s)) for row in rows] for s in (small, -small))
    return float(np.abs(np.subtract(forth, back)).max() / (2 * small))


FIGURE = figure(lambda: picture().axes.figure, foliation)
