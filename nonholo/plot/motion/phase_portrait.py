"""Phase portraits, momenta along a two-dimensional subspace on their energy ellipses, and Poincare sections.

[fedorov-zenkov-2004], figures suslov and mom_dynamics.
"""

from collections.abc import Callable
from typing import Any, NamedTuple, Unpack

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection
from matplotlib.lines import Line2D
from matplotlib.patches import FancyArrowPatch

from nonholo.base.calls import call, check_result
from nonholo.base.checks import checked_energies, choice, error, function, instance, pair, shown, text
from nonholo.base.types import Float
from nonholo.discrete import BranchTree, Discretization, branch_tree
from nonholo.orbit import Orbit
from nonholo.plot import parts, theme
from nonholo.plot.sheets import ellipse, half_axes, momenta_on_plane, name_axes, on_plane, plane_inertia
from nonholo.simulation import Crossings
from nonholo.systems import AbstractLLSystem, AbstractSystem, refuse_forces

_SEEDS = 3  # states of the orbit whose images are drawn
_GENERATIONS = 3
_SAME = 1e-6  # relative distance of an image from a state of the orbit that it is


def _trees_of(orbit: Orbit | None, branches: str) -> list[BranchTree]:
    """Return the images of some states of the orbit, or none."""
    where = "phase_portrait(branches=...)"
    if choice(where, branches, ("principal", "all")) == "principal":
        return []
    if orbit is None or not isinstance(orbit.motion, Discretization):
        got = "a system alone" if orbit is None else shown(orbit)
        raise error(where, "be 'principal' without a discrete orbit", got, "Pass an orbit of `nh.simulate`.")
    at = parts.evenly_in_box(orbit.reduced_momentum, _SEEDS + 1)[:_SEEDS]
    return [branch_tree(orbit.motion, W, _GENERATIONS) for W in orbit.displacement[at]]


def _draw_images(axes: Axes, orbit: Orbit, trees: list[BranchTree]) -> tuple[PathCollection, LineCollection]:
    """Draw the real images that are not on the orbit, later generations smaller, and lines that lead to them."""
    images = [_other_images(orbit, tree) for tree in trees]
    ends, level = (np.concatenate(column) for column in zip(*images, strict=True))
    edges = LineCollection(list(ends), colors=theme.COMPONENTS[1], linewidths=0.8, zorder=4)
    axes.add_collection(edges)
    look: Any = {"facecolors": theme.PAPER, "edgecolors": theme.COMPONENTS[1], "linewidths": 1.4, "zorder": 7}
    return axes.scatter(*ends[:, 1].T, s=90.0 / level, marker="D", label="other values", **look), edges


def _other_images(orbit: Orbit, tree: BranchTree) -> tuple[np.ndarray, np.ndarray]:
    """Return the momenta of the parents and of the real images that differ from the orbit's, and their generations."""
    system: Any = orbit.system
    momentum = on_plane(system, system.restrict(tree.momentum.real))
    distance = np.linalg.norm(momentum[:, None] - momenta_on_plane(orbit), axis=2).min(axis=1)
    apart = distance > _SAME * np.linalg.norm(momentum[0])
    at = np.flatnonzero(tree.is_real & tree.is_real[tree.parent] & (tree.level > 0) & apart)
    return np.stack([momentum[tree.parent[at]], momentum[at]], axis=1), tree.level[at]


class PhasePortrait(NamedTuple):
    """The artists of `phase_portrait`; None where there was nothing to draw.

    Attributes:
        axes: The axes.
        levels: One closed line for each energy.
        stable: Attracting equilibria, filled.
        unstable: Repelling equilibria, empty.
        neutral: Equilibria of a balanced system, which neither attract nor repel.
        arrows: The direction of motion along the levels.
        orbit: The orbit, colored by time: dots if discrete, a line if a flow.
        images: Real images of some of its states, of all branches, that are not states of the orbit; diamonds.
        edges: From each image to its images.
    """

    axes: Axes
    levels: tuple[Line2D, ...]
    stable: PathCollection | None
    unstable: PathCollection | None
    neutral: PathCollection | None
    arrows: tuple[FancyArrowPatch, ...]
    orbit: PathCollection | LineCollection | None
    images: PathCollection | None
    edges: LineCollection | None


@theme.in_style
def phase_portrait(
    system: AbstractLLSystem,
    orbit: Orbit | None = None,
    axes: Axes | None = None,
    energies: Any = None,
    branches: str = "principal",
    **look: Unpack[theme.Look],
) -> PhasePortrait:
    r"""Draw the momenta along the constraint subspace: energy levels, equilibria, direction of motion, an orbit.

    The levels of the reduced constrained energy are the ellipses

    $$ \tfrac12\, r\cdot(\mathbb{I}|_{\mathfrak{d}})^{-1} r = E . $$

    Equilibria are one line through the origin, filled where they attract and empty where they repel; all other
    motions run along their ellipse from one to the other. In a balanced system every point is an equilibrium. Momenta
    of a sleigh are $(p_\theta + b p_1, p_1)$ in the axes of its blade, those of a top $(M_{13}, M_{23})$ in axes whose
    third one is the forbidden axis, in every frame of the body; those of other systems are in its canonical frame.

    With `branches="all"` three states of a discrete orbit are followed for three steps along every real branch. All
    images stay on the ellipse. The values from one displacement coincide here, as they have the same momenta along the
    constraint subspace; what follows them differs. Images that the orbit itself visits are left out.

    Reference: [fedorov-zenkov-2004], figures suslov and mom_dynamics.

    Args:
        system: A left-invariant system with two-dimensional constraint subspace.
        orbit: An orbit of it.
        axes: Where to draw; a new figure by default.
        energies: Energies of the ellipses; by default four, evenly spread in size, one of them through the orbit.
        branches: "principal" or "all".
        **look: Title, label, color and more: `nh.plot.Look`.

    Raises:
        ValueError: A right-invariant constraint, a subspace of another dimension, an orbit of another body,
            energies that are not positive, all branches without a discrete orbit or as `nh.branch_tree` refuses them.

    Example:
        >>> top = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
        >>> portrait = nh.plot.phase_portrait(top, energies=[0.5, 1.0])
        >>> len(portrait.levels), len(portrait.stable.get_offsets())
        (2, 2)
    """
    orbit = _check(system, orbit)
    trees = _trees_of(orbit, branches)
    levels = _energies(system, orbit, energies)
    axes = theme.axes_or_new(axes)
    thin: Any = {"color": theme.LEVEL, "linewidth": 1.1, "zorder": 1}
    lines = tuple(axes.plot(*ellipse(system, level).T, **thin)[0] for level in levels)
    stable, unstable, neutral, arrows = _equilibria(axes, system, np.sqrt(2 * levels))
    path = None
    if orbit is not None:
        momentum = momenta_on_plane(orbit)
        size = 60 if np.ptp(momentum, axis=0).max() <= 1e-6 * np.abs(momentum).max() else None
        path = parts.draw_in_time(axes, orbit, momentum, parts.evenly_in_box(momentum), zorder=6, size=size)
    images, edges = _draw_images(axes, orbit, trees) if orbit is not None and trees else (None, None)
    name_axes(axes, system)
    theme.legend_above(axes, "Phase portrait")
    return PhasePortrait(axes, lines, stable, unstable, neutral, arrows, path, images, edges)


def _check(system: AbstractLLSystem, orbit: Orbit | None) -> Orbit | None:
    """Return the orbit as it is drawn."""
    where = "phase_portrait(system=...)"
    refuse_forces(where, system)
    instance(where, system, AbstractSystem, "be a system on a group", "Pass `orbit.system` first, then the orbit.")
    parts.check_directions(where, system, system, (2, "two"), "Plot `orbit.restricted_momentum`.")
    smooth = None if orbit is None else parts.drawable("phase_portrait(orbit=...)", orbit)
    if smooth is not None and not parts.is_same_body(smooth.system, system):
        raise error("phase_portrait(orbit=...)", "be an orbit of the system", shown(orbit), "Pass `orbit.system`.")
    return smooth


def _energies(system: AbstractLLSystem, orbit: Orbit | None, energies: Any) -> Float[np.ndarray, "L"]:
    if energies is not None:
        return checked_energies("phase_portrait(energies=...)", energies)
    own = 0.0 if orbit is None else float(orbit[:1].energy[0])
    # at rest, or without an orbit, the ellipse of unit velocities sets the size
    scale = own if own > 0 else float(np.trace(plane_inertia(system))) / 4
    return scale * (np.arange(1, 5) / 3) ** 2


def _equilibria(axes: Axes, system: AbstractLLSystem, sizes: Float[np.ndarray, "L"]) -> tuple[Any, ...]:
    to_ellipse = half_axes(system)
    if (equilibria := parts.known_equilibria(system)) is None:
        return None, None, None, ()
    if (attracting := equilibria.attracting) is None:
        angle = np.arange(24) * (np.pi / 12)
        circle = np.array([np.cos(angle), np.sin(angle)])
        x, y = np.concatenate([size * to_ellipse @ circle for size in sizes], axis=1)
        return None, None, axes.scatter(x, y, s=16, color=theme.MUTED, linewidths=0, zorder=3, label="equilibria"), ()
    u = np.linalg.solve(to_ellipse, on_plane(system, system.restrict(system.inertia_operator @ attracting)))
    u /= np.linalg.norm(u)
    points = sizes[:, None] * (to_ellipse @ u)
    stable, unstable = parts.draw_equilibria(axes, points, 1.12 * points[sizes.argmax()], 46)
    arrows = tuple(_arrow(axes, size * to_ellipse, u, side) for size in sizes for side in (1, -1))
    return stable, unstable, None, arrows


def _arrow(axes: Axes, half_axes: Float[np.ndarray, "2 2"], u: Float[np.ndarray, "2"], side: int) -> FancyArrowPatch:
    across = side * np.array([-u[1], u[0]])
    tail, head = (tuple(half_axes @ (across + lean * u)) for lean in (-0.02, 0.02))
    look: Any = {"arrowstyle": "-|>", "mutation_scale": 13, "shrinkA": 0, "shrinkB": 0, "linewidth": 0}
    arrow = FancyArrowPatch(tail, head, color=theme.MUTED, zorder=2, **look)
    axes.add_patch(arrow)
    return arrow


_FEW, _LARGE, _SMALL = 500, 14.0, 4.0  # up to this many dots are large; areas of dots

Quantity = Callable[[Orbit], Float[np.ndarray, "C"]]


class Section(NamedTuple):
    """The artists of `section`.

    Attributes:
        axes: The axes.
        points: The drawn points.
        dots: One dot for each crossing, colored by its time.
    """

    axes: Axes
    points: Float[np.ndarray, "C 2"]
    dots: PathCollection


@theme.in_style
def section(
    crossings: Crossings,
    across: Quantity,
    up: Quantity,
    axes: Axes | None = None,
    labels: tuple[str, str] = ("", ""),
    **look: Unpack[theme.Look],
) -> Section:
    """Draw a Poincare section: one dot for each crossing of an event, colored from early to late.

    Args:
        crossings: The crossings of an event: `orbit.events["name"]` or `nh.crossings(orbit, event)`.
        across: The abscissa, a function of an orbit that returns one number for each of its states.
        up: The ordinate.
        axes: Where to draw; a new figure by default.
        labels: Names of the axes; by default those of the functions.
        **look: Title, label, color and more: `nh.plot.Look`.

    Raises:
        ValueError: No crossings at all, or quantities of the wrong shape.

    Example:
        >>> top = nh.discretize(nh.VeselovaTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 0.1)
        >>> level = nh.Event(lambda states: states.configuration[:, 2, 2], direction=1, stop=20)
        >>> orbit = nh.simulate(top, restricted_velocity=(1.0, -0.6), steps=10_000, events=[level])
        >>> picture = nh.plot.section(
        ...     orbit.events[0], lambda states: states.body_velocity[:, 0], lambda states: states.body_velocity[:, 1]
        ... )
        >>> picture.points.shape
        (20, 2)
    """
    if not isinstance(crossings, Crossings) or not len(crossings):
        remedy = "Pass `orbit.events[...]` of a run that crosses."
        raise error("section(crossings=...)", "hold crossings of an event", shown(crossings), remedy)
    function("section(across=...)", across)
    function("section(up=...)", up)
    names = [text("section(labels=...)", label) for label in pair("section(labels=...)", labels)]
    across_label, up_label = names[0] or _name_of(across, "across"), names[1] or _name_of(up, "up")
    points = np.stack([_values("across", across, crossings), _values("up", up, crossings)], axis=1)
    axes = theme.axes_or_new(axes, (6.0, 5.0))
    area = _LARGE if len(points) <= _FEW else _SMALL
    color = theme.option("color", None)
    colors: Any = {"c": crossings.time, "cmap": theme.TIME} if color is None else {"color": color}
    dots = axes.scatter(*points.T, s=area, linewidths=0, label=theme.option("label", None), **colors)
    axes.set(xlabel=across_label, ylabel=up_label)
    axes.margins(0.06)
    theme.legend_above(axes, f"{len(points)} crossings")
    return Section(axes, points, dots)


def _name_of(quantity: Quantity, otherwise: str) -> str:
    name = getattr(quantity, "__name__", "<lambda>")
    return otherwise if name == "<lambda>" else name.strip("_").replace("_", " ")


def _values(name: str, quantity: Quantity, crossings: Crossings) -> Float[np.ndarray, "C"]:
    where = f"section({name}=...)"
    remedy = "It gets an `Orbit`: return an array with one number for each of its states."
    values, words = call(where, quantity, crossings.states), ("one number for each crossing", remedy)
    return check_result(where, quantity, values, (len(crossings),), words, lambda at: f"time {crossings.time[at]:.17g}")
