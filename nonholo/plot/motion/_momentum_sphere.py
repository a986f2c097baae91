"""The momenta along a three-dimensional constraint subspace, on their energy ellipsoid drawn as a sphere."""

import dataclasses
from typing import Any, Unpack, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection

from nonholo.base.checks import error, shown
from nonholo.base.types import Float
from nonholo.orbit import Orbit
from nonholo.plot import parts, theme
from nonholo.systems import AbstractLLSystem

_MOST_DOTS = 1500
_FINEST = np.radians(3.0)  # no need to draw states that are closer than this


@dataclasses.dataclass(frozen=True)
class MomentumSphere:
    """The artists of `momentum_sphere`; None where there was nothing to draw.

    Attributes:
        axes: The axes.
        view: The projection.
        points: The drawn points, on the unit sphere where the energy is that of the first state.
        path: The path, colored by time, what lies behind the sphere fainter.
        dots: The states of a discrete orbit.
        stable: The attracting equilibrium, filled.
        unstable: The repelling equilibrium, empty.
    """

    axes: Axes
    view: parts.View
    points: Float[np.ndarray, "L 3"]
    path: LineCollection
    dots: PathCollection | None
    stable: PathCollection | None
    unstable: PathCollection | None


@theme.styled
def momentum_sphere(
    orbit: Orbit, axes: Axes | None = None, view: tuple[float, float] | None = None, **look: Unpack[theme.Look]
) -> MomentumSphere:
    r"""Draw the momenta along a three-dimensional constraint subspace on the sphere of their energy.

    The ellipsoid of constant energy is drawn as the unit sphere,

    $$ u = B^{-1/2}\,r/\sqrt{2E_0}, \qquad |u|^2 = E/E_0, \qquad B = \mathbb{I}|_{\mathfrak{d}}, $$

    in the canonical body frame. For a free body on SO(3) these are the polhodes. Of an orbit too long to draw, the part
    about the transition is shown. Equilibria are drawn where the library knows an attracting one.

    Args:
        orbit: An orbit with a left-invariant constraint whose subspace has dimension 3.
        axes: Where to draw (plain two-dimensional axes; the projection is orthographic); a new figure by default.
        view: Azimuth and elevation of the eye in degrees; by default chosen so that most of the path is in front.
        **look: Title, label, color and more: `nh.plot.Look`.

    Raises:
        ValueError: No orbit, one without states, a right-invariant constraint, or a subspace of another dimension.

    Example:
        >>> body = nh.RigidBody(np.diag([1.0, 3.0, 2.0]))
        >>> orbit = nh.simulate(nh.discretize(body, 0.1), body_velocity=(0.02, 0.0, 1.0), steps=200)
        >>> np.allclose(np.linalg.norm(nh.plot.momentum_sphere(orbit).points, axis=1), 1.0)
        True
    """
    system = _check(orbit)
    orbit = parts.drawable("momentum_sphere(orbit=...)", orbit)
    values, directions = np.linalg.eigh(np.asarray(system.canonical.constrained_inertia))
    to_sphere = directions @ np.diag(values**-0.5) @ directions.T
    size = np.sqrt(2 * orbit[:1].energy[0]) or 1.0
    part = _part(orbit.reduced_momentum @ to_sphere / size, orbit)
    points = orbit[part].reduced_momentum @ to_sphere / size
    attracting = _attracting(system, to_sphere)
    eye = parts.view_of("momentum_sphere(view=...)", view, points, attracting)
    axes = theme.axes_or_new(axes, (6.0, 6.0))
    parts.draw_globe(axes, eye)
    path, dots = parts.draw_path(axes, eye, orbit[part], points, orbit)
    _rows(axes, eye, to_sphere)
    parts.mark_ends(axes, eye, points, part, orbit)
    stable, unstable = _equilibria(axes, eye, attracting)
    theme.write_title(axes, "Momentum on its energy sphere")
    if axes.get_legend_handles_labels()[0]:
        is_narrow = theme.is_narrow(axes)  # then beside the axes, otherwise in the corner beside the sphere
        place = ("lower left", (1.0, 0.0)) if is_narrow else ("lower right", None)
        theme.legend(axes, loc=place[0], bbox_to_anchor=place[1])
    return MomentumSphere(axes, eye, points, path, dots, stable, unstable)


def _check(orbit: Orbit) -> AbstractLLSystem:
    where = "momentum_sphere(orbit=...)"
    system = parts.drawable(where, orbit).system
    if system.is_spatial:
        remedy = "Its momenta along the constraint are conserved: draw `overview` instead."
        raise error(where, "have a left-invariant constraint", shown(orbit), remedy)
    if len(system.constraint_subspace) != 3:
        got = f"dimension {len(system.constraint_subspace)}"
        remedy = "Use `phase_portrait` in two dimensions, `overview` in others."
        raise error(where, "have a three-dimensional constraint subspace", got, remedy)
    return cast(AbstractLLSystem, system)


def _part(points: Float[np.ndarray, "K 3"], orbit: Orbit) -> slice:
    if len(orbit) <= _MOST_DOTS:
        return slice(0, len(orbit), 1)
    step = np.linalg.norm(np.diff(points, axis=0), axis=1).max(initial=0.0)
    return parts.window(orbit, step, _FINEST, _MOST_DOTS)


def _attracting(system: AbstractLLSystem, to_sphere: Float[np.ndarray, "3 3"]) -> Float[np.ndarray, "A 3"]:
    """Return the attracting equilibrium as a row, no row where there is none or more than one."""
    canonical = system.canonical
    equilibria = parts.known_equilibria(canonical)
    if equilibria is None or equilibria.attracting is None or len(equilibria.subspace) != 1:
        return np.empty((0, 3))
    point = to_sphere @ canonical.restrict(canonical.inertia_operator @ equilibria.attracting)
    return (point / np.linalg.norm(point))[None, :]


def _rows(axes: Axes, eye: parts.View, to_sphere: Float[np.ndarray, "3 3"]) -> None:
    """Draw where each component of the momentum alone points, out of the sphere."""
    for index, direction in enumerate(to_sphere / np.linalg.norm(to_sphere, axis=1)[:, None]):
        (pole, tip), depth = eye(np.array([[1.0], [1.16]]) * direction)
        alpha = float(parts.opacity(depth[:1])[0])
        axes.plot(*np.stack([pole, tip], axis=1), color=theme.MUTED, linewidth=1.4, alpha=alpha, zorder=6)
        parts.name_beside(axes, f"$r_{index + 1}$", tip, away=tip, color=theme.MUTED)


def _equilibria(
    axes: Axes, eye: parts.View, attracting: Float[np.ndarray, "A 3"]
) -> tuple[PathCollection | None, PathCollection | None]:
    if not len(attracting):
        return None, None
    (here, there), depth = eye(np.concatenate([attracting, -attracting]))
    alpha = parts.opacity(depth)
    look: Any = {"s": 60, "linewidths": 1.6, "zorder": 8}
    stable = axes.scatter(*here, color=theme.STABLE, alpha=alpha[0], label="stable", **look)
    look |= {"facecolors": theme.PAPER, "edgecolors": theme.UNSTABLE, "alpha": alpha[1]}
    return stable, axes.scatter(*there, label="unstable", **look)
