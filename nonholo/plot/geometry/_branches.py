"""All values of the discrete map: from one point, their tree over several steps, and their number over the momenta.

Values are drawn on the variety of displacements, or as tangents of the deltoid, inside which the discrete sleigh has
three real ones. Coordinates are those of the canonical frame, pi = p_theta + b p_1 and p_1.
"""

from collections.abc import Iterator
from typing import Any, NamedTuple, Unpack, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from matplotlib.text import Annotation
from matplotlib.ticker import MaxNLocator, NullLocator

from nonholo import discrete as maps
from nonholo.analysis import Deltoid, deltoid, invariant_curve
from nonholo.analysis.planar import planar_map
from nonholo.base.checks import choice, error, instance, pair, shape_of, shown
from nonholo.base.types import Float
from nonholo.discrete import Branches, BranchTree, Discretization, branching
from nonholo.orbit import Orbit
from nonholo.plot import theme
from nonholo.plot.parts import draw_orbit, own_orbit
from nonholo.plot.sheets import Sheet, draw_level, ellipse, momenta_on_plane, name_axes, on_plane, sheet_of


def draw_deltoid(axes: Axes, region: Deltoid) -> tuple[Polygon, Line2D, PathCollection]:
    """Draw the region with three real values, its boundary and its cusps."""
    system = region.discrete.system
    around, cusps = on_plane(system, region.boundary(601)), on_plane(system, region.cusps)
    inside = axes.fill(*around.T, color=theme.INSIDE, linewidth=0, zorder=1)[0]
    boundary = axes.plot(*around.T, color=theme.DISCRETE, linewidth=1.8, zorder=2, label="two meet")[0]
    return inside, boundary, axes.scatter(*cusps.T, s=34, color=theme.DISCRETE, zorder=4, label="three meet")


def dress_momenta(axes: Axes, region: Deltoid, title: str) -> None:
    """Name the axes and the region; the corners beside the long cusp are free, for the legend and for words."""
    cusps = on_plane(region.discrete.system, region.cusps)
    look: Any = {"ha": "center", "va": "center", "color": theme.DISCRETE, "fontweight": "bold", "zorder": 5}
    axes.annotate("3 real values", tuple(cusps.T @ [0.4, 0.3, 0.3]), **look)
    points_down = bool(cusps[0, 1] < cusps[1, 1])
    side, anchor = (0.03, "left") if points_down else (0.97, "right")
    axes.margins(0.1)
    axes.text(side, 0.96, "1 real value", transform=axes.transAxes, ha=anchor, va="top", fontweight="bold")
    axes.set(xlabel=r"$\pi = p_\theta + b\,p_1$", ylabel=r"momentum along the blade  $p_1$")
    theme.write_title(axes, title)
    theme.legend(axes, loc="lower left" if points_down else "upper left")


class BranchCounts(NamedTuple):
    """The artists of `branch_counts`; None where there was nothing to draw.

    Attributes:
        axes: The axes.
        inside: The region with three real values.
        boundary: Its boundary, where two values meet.
        cusps: Where all three meet.
        resting: Turns without translation.
        level: The energy ellipse of the orbit.
        orbit: The momenta of the orbit, colored by time.
    """

    axes: Axes
    inside: Polygon
    boundary: Line2D
    cusps: PathCollection
    resting: Line2D
    level: Line2D | None
    orbit: PathCollection | None


@theme.in_style
def branch_counts(
    discrete: Discretization, orbit: Orbit | None = None, axes: Axes | None = None, **look: Unpack[theme.Look]
) -> BranchCounts:
    r"""Draw where the discrete sleigh has one real value and where it has three: the deltoid.

    The plane is that of $\pi = p_\theta + bp_1$ and $p_1$. On the boundary two values meet, in the cusps three. The
    ellipse of turns without translation (for b = 0: $V_1 = 0$) is drawn dashed, the energy ellipse of the orbit solid.

    Args:
        discrete: A discretized sleigh with a not zero.
        orbit: An orbit of it.
        axes: Where to draw; a new figure by default.
        **look: Title, label, color and more: `nh.plot.Look`.

    Raises:
        ValueError: Another system or discretization, a = 0, an orbit of another discretized system.

    Example:
        >>> picture = nh.plot.branch_counts(nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.5))
        >>> picture.cusps.get_offsets().shape
        (3, 2)
    """
    region = deltoid(discrete)
    own_orbit("plot.branch_counts(orbit=...)", orbit, discrete)
    axes = theme.axes_or_new(axes, (6.4, 5.4))
    inside, boundary, dots = draw_deltoid(axes, region)
    thin: Any = {"color": theme.MUTED, "linewidth": 1.3, "dashes": (4, 3), "zorder": 2}
    resting = axes.plot(*on_plane(discrete.system, region.resting()).T, label="no translation", **thin)[0]
    level = path = None
    if orbit is not None:
        around = ellipse(orbit.system, float(orbit.energy[0]))
        level = axes.plot(*around.T, color=theme.MUTED, linewidth=1.2, zorder=2, label="energy")[0]
        path = draw_orbit(axes, orbit, momenta_on_plane(orbit))
    dress_momenta(axes, region, "Real values")
    return BranchCounts(axes, inside, boundary, dots, resting, level, path)


_BEYOND = 0.3  # how far a tangent continues beyond its ends, in its length
_AWAY = 12.0  # from a dot to its label, in points


class BranchesPicture(NamedTuple):
    """The artists of `branches`; None where there was nothing to draw.

    Attributes:
        axes: The axes.
        found: The values.
        principal: The principal value, filled.
        others: The other real values, empty.
        present: Where the map is applied.
        level: The displacements that have the energy of all values; None on the plane of momenta.
        tangents: On the plane of momenta, a line for each real value.
        labels: The index and step angle of each real value.
    """

    axes: Axes
    found: Branches
    principal: PathCollection | None
    others: PathCollection | None
    present: PathCollection
    level: LineCollection | None
    tangents: tuple[Line2D, ...]
    labels: tuple[Annotation, ...]


@theme.in_style
def branches(
    discrete: Discretization,
    *,
    momentum: Any = None,
    displacement: Any = None,
    plane: str | None = None,
    axes: Axes | None = None,
    **look: Unpack[theme.Look],
) -> BranchesPicture:
    r"""Draw every value of the discrete map from one displacement: the principal one filled, other real ones empty.

    On the plane "displacements", a disc for a top and a strip for a sleigh as in `invariant_curves`, all real values
    lie on the curve of their energy. On the plane "momenta" of a sleigh all values are over one point. There the
    displacements of one step angle are a tangent of the deltoid, with $\varphi = \Delta/2$

    $$ h\pi\cos\varphi - \bigl(\hat p + \tfrac J2\bigr)\sin\varphi = \tfrac J2\sin3\varphi, \qquad
       \hat p = a\,hp_1 + 2ma^2, $$

    so the values are the tangents through the point. Each bears its index in `nh.branches` and its step angle; complex
    ones are counted in the legend.

    Reference: docs/theory/branches.md, docs/theory/chaplygin-sleigh.md.

    Args:
        discrete: A top with n = 3 or a sleigh, discretized with "matrix" and "skew".
        momentum: As in `nh.branches`.
        displacement: As in `nh.branches`.
        plane: "displacements" or "momenta"; by default "momenta" for a sleigh that has a deltoid.
        axes: Where to draw; a new figure by default.
        **look: Title, label, color and more: `nh.plot.Look`.

    Raises:
        ValueError: Another system or discretization; a top, or a sleigh with a = 0, on the plane of momenta; as
            `nh.branches`.

    Example:
        >>> top = nh.discretize(nh.SuslovTop([[1.25, 0, -0.5], [0, 1, -0.75], [-0.5, -0.75, 1.25]]), 1.0)
        >>> picture = nh.plot.branches(top, displacement=nh.SO(3).cayley(2 * np.array([0.375, -0.25, 0.0])))
        >>> len(picture.others.get_offsets()), picture.labels[0].get_text()
        (3, '0: 49°')
    """
    discrete = planar_map("plot.branches(discrete=...)", discrete)[0]
    sheet = cast(Sheet, sheet_of(discrete.system))
    on_momenta = _is_over_momenta(discrete, sheet.has_deltoid, plane)
    values = branching.branches(discrete, momentum=momentum, displacement=displacement)
    if displacement is not None:
        W = np.asarray(displacement, dtype=float)
    elif shape_of(momentum) == (discrete.system.group.dim,):
        W = branching.inverse_discrete_legendre(discrete, momentum)
    else:
        over = branching.displacements_over(discrete, momentum)
        W = over.displacement[over.principal].real
    axes = theme.axes_or_new(axes, (6.4, 5.6))
    return (_over_momenta if on_momenta else _on_displacements)(axes, sheet, discrete, values, W)


def _is_over_momenta(discrete: Discretization, has_deltoid: bool, plane: str | None) -> bool:
    """Return whether to draw on the plane of momenta."""
    if plane is None:
        return has_deltoid
    where = "plot.branches(plane=...)"
    choice(where, plane, ("displacements", "momenta"), "Leave it out for the usual one.")
    if plane == "momenta" and not has_deltoid:
        raise error(where, "be 'displacements' for a system without a deltoid", shown(discrete.system), "Leave it out.")
    return plane == "momenta"


def _on_displacements(axes: Axes, sheet: Sheet, discrete: Discretization, values: Branches, W: Any) -> BranchesPicture:
    curves, level = [], None
    if values.energy > 0:
        curves = [invariant_curve(discrete, values.energy)]
        level = draw_level(axes, sheet, curves[0], label="its energy", color=theme.DISCRETE, linewidth=1.5, zorder=2)
    places = sheet.places(sheet.variety.points(values.displacement[values.is_real].real))
    dots = _dots(axes, values, places, sheet.places(sheet.variety.points(W[None])))
    labels = tuple(_labels(axes, sheet, values, places, places * sheet.inwards(places)))
    theme.write_title(axes, _title(values))
    sheet.dress(axes, curves, places)
    return BranchesPicture(axes, values, *dots, level, (), labels)


def _over_momenta(axes: Axes, sheet: Sheet, discrete: Discretization, values: Branches, W: Any) -> BranchesPicture:
    region, system = deltoid(discrete), discrete.system
    draw_deltoid(axes, region)
    before, after = system.restrict(maps.discrete_legendre(discrete, W)), system.restrict(values.momentum[0].real)
    here, there = on_plane(system, np.stack([before, after]))
    places = on_plane(system, region.touching(_angles(sheet, values)[values.is_real]))
    tangents = []
    for i, place in zip(np.flatnonzero(values.is_real), places, strict=True):
        ends = np.stack([there, place]) + _BEYOND * np.stack([there - place, place - there])
        style: Any = {"linewidth": 1.6} if i == values.principal else {"linewidth": 1.1, "dashes": (5, 3)}
        tangents += axes.plot(*ends.T, color=theme.STABLE, zorder=3, **style)
    axes.scatter(*there, marker="D", s=40, color=theme.UNSTABLE, zorder=6, label="new momentum")
    dots = _dots(axes, values, places, here[None])
    labels = tuple(_labels(axes, sheet, values, places, places - there))
    dress_momenta(axes, region, _title(values))
    return BranchesPicture(axes, values, *dots, None, tuple(tangents), labels)


def _angles(sheet: Sheet, values: Branches) -> Float[np.ndarray, "B"]:
    return sheet.step_angles(sheet.variety.points(values.displacement.real))


def _dots(axes: Axes, values: Branches, places: np.ndarray, here: np.ndarray) -> tuple[Any, Any, Any]:
    """Draw the values and the present displacement; count the complex values in the legend."""
    is_principal = np.flatnonzero(values.is_real) == values.principal  # nowhere if it is None
    own, look = theme.own_look(theme.STABLE, "principal"), {"linewidths": 1.6, "s": 58, "zorder": 7}
    principal = others = None
    if is_principal.any():
        principal = axes.scatter(*places[is_principal].T, **look, **own)
    if not is_principal.all():
        look |= {"facecolors": theme.PAPER, "edgecolors": own["color"]}
        others = axes.scatter(*places[~is_principal].T, label="other real", **look)
    present = axes.scatter(*here.T, marker="x", s=70, color=theme.UNSTABLE, linewidths=2.2, zorder=8, label="present")
    if not values.is_real.all():
        axes.plot([], [], " ", label=f"and {np.count_nonzero(~values.is_real)} complex")
    return principal, others, present


def _labels(axes: Axes, sheet: Sheet, values: Branches, places: np.ndarray, away: np.ndarray) -> Iterator[Annotation]:
    """Write index and step angle beside each real value, in a direction."""
    angles = np.degrees(_angles(sheet, values))
    for i, place, direction in zip(np.flatnonzero(values.is_real), places, away, strict=True):
        size = np.linalg.norm(direction)
        x, y = direction / size if size > 0 else np.array([0.0, 1.0])
        text = f"{i}: {angles[i]:.0f}°".replace("-", "\u2212")
        look: Any = {"ha": "left" if x >= 0 else "right", "va": "center", "path_effects": theme.HALO, "zorder": 9}
        shift = (_AWAY * float(np.copysign(max(abs(x), 0.6), x)), _AWAY * float(y))
        yield axes.annotate(text, (place[0], place[1]), shift, textcoords="offset points", **look)


def _title(values: Branches) -> str:
    real, others = int(np.count_nonzero(values.is_real)), int(np.count_nonzero(~values.is_real))
    return f"Values: {real} real" + (f", {others} complex" if others else "")


_EARLY, _LATE = 0.05, 0.9  # ends of the shades of the generations
_LARGEST, _SMALLEST = 150.0, 26.0  # areas of the dots of the first and the last generation


class BranchTreePicture(NamedTuple):
    """The artists of `branch_tree`.

    Attributes:
        plane: The axes of the momenta.
        growth: The axes of the counts.
        edges: From each real image whose parent is real to its parent.
        images: The real images of each generation.
        counts: All distinct images of each generation.
        bound: Their number if none coincide.
        real: The real images of each generation.
    """

    plane: Axes
    growth: Axes
    edges: LineCollection
    images: tuple[PathCollection, ...]
    counts: Line2D
    bound: Line2D
    real: Line2D


@theme.in_style
def branch_tree(
    discrete: Discretization, tree: BranchTree, axes: tuple[Axes, Axes] | None = None, **look: Unpack[theme.Look]
) -> BranchTreePicture:
    r"""Draw the tree of all images: the real ones in the plane of restricted momenta, and how many there are.

    Dots are colored by generation, later ones are smaller. All lie on one ellipse, that of their energy, and the
    images of one displacement coincide in this plane, since they differ in the forbidden component alone: a dot stands
    for all of them. Lines lead from dot to dot. Beside it the number of distinct images, complex ones included,
    and of the real ones among them, in each generation; the dashed line is the power $m^k$ that they have if no two
    coincide, m = 3 for a sleigh.

    Reference: docs/theory/branches.md.

    Args:
        discrete: The discretization of the tree; with three or more restricted momenta the first two are drawn.
        tree: The result of `nh.branch_tree`, with one generation or more.
        axes: Where to draw the momenta and the counts; a new figure by default.
        **look: Title, label, color and more: `nh.plot.Look`.

    Raises:
        ValueError: No tree, a tree of the root alone, a tree of another group.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.5)
        >>> tree = nh.branch_tree(sleigh, nh.SE(2).exp(np.array([0.3, -0.6, 0.0])), 4)
        >>> picture = nh.plot.branch_tree(sleigh, tree)
        >>> picture.counts.get_ydata()
        array([ 1,  3,  9, 27, 81])
    """
    system = _system_of(discrete, tree)
    if axes is None:
        axes = theme.new_figure((10.4, 4.8)).subplots(1, 2, width_ratios=(1.25, 1.0))
    plane, growth = map(theme.axes_or_new, pair("plot.branch_tree(axes=...)", axes))
    restricted = system.restrict(tree.momentum.real)
    momentum = on_plane(system, restricted)
    if momentum.shape[1] == 2:
        level = ellipse(system, float(system.constrained_energy(restricted[0])))
        plane.plot(*level.T, color=theme.LEVEL, linewidth=1.1, zorder=1)
    colors = theme.TIME(np.linspace(_EARLY, _LATE, len(tree.counts)))
    momentum, parent = momentum[:, :2], np.maximum(tree.parent, 0)
    at = np.flatnonzero((tree.parent >= 0) & tree.is_real & tree.is_real[parent])
    ends = np.stack([momentum[parent[at]], momentum[at]], axis=1)
    edges = LineCollection(list(ends), colors=colors[tree.level[at]], linewidths=0.7, zorder=2)
    plane.add_collection(edges)
    images = []
    for level, (color, size) in enumerate(zip(colors, np.geomspace(_LARGEST, _SMALLEST, len(colors)), strict=True)):
        dots: Any = {"color": color, "edgecolors": theme.PAPER, "linewidths": 0.6, "zorder": 4 + level / 100}
        generation = momentum[tree.is_real & (tree.level == level)]
        images.append(plane.scatter(*generation.T, s=size, label=str(level), **dots))
    name_axes(plane, system)
    theme.write_title(plane, "Real images")
    theme.legend(plane, title="generation", loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return BranchTreePicture(plane, growth, edges, tuple(images), *_growth(growth, tree))


def _system_of(discrete: Any, tree: Any) -> Any:
    where = "plot.branch_tree(tree=...)"
    system = maps.as_discretization("plot.branch_tree(discrete=...)", discrete).system
    instance(where, tree, BranchTree, "be a tree", "Pass what `nh.branch_tree` returned.")
    if len(tree.counts) < 2:
        raise error(where, "have a generation of images", "the root alone", "Make it with depth=1 or more.")
    if tree.displacement.shape[1:] != system.group.identity.shape:
        got = f"matrices {tree.displacement.shape[1:]}"
        raise error(where, f"be in {system.group}", got, "Pass its own `discrete`.")
    return system


def _growth(axes: Axes, tree: BranchTree) -> tuple[Line2D, Line2D, Line2D]:
    level, images = np.arange(len(tree.counts)), int(tree.counts[1])
    real = np.bincount(tree.level[tree.is_real], minlength=len(level))
    bound = axes.plot(level, images**level, color=theme.MUTED, dashes=(4, 3), label=f"${images}^k$", zorder=1)[0]
    counts = axes.plot(level, tree.counts, "o", markersize=7, **theme.own_look(theme.DISCRETE, "distinct images"))[0]
    look: Any = {"markerfacecolor": theme.PAPER, "markeredgewidth": 1.6, "linestyle": "none"}
    reals = axes.plot(level, real, "o", color=theme.UNSTABLE, markersize=7, label="real ones", **look)[0]
    axes.set(title="Growth", xlabel="generation k", ylabel="number of images", yscale="log")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.yaxis.set_minor_locator(NullLocator())
    theme.legend(axes, loc="upper left")
    return counts, bound, reals
