"""The tree of all images under the multivalued map: real images in the plane of momenta, and how many there are."""

from typing import Any, NamedTuple, Unpack

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator, NullLocator

from nonholo.base.checks import error, instance, pair
from nonholo.base.types import Float
from nonholo.discrete import BranchTree, Discretization, as_discretization
from nonholo.plot import theme
from nonholo.plot.sheets import ellipse, name_axes, on_plane

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
        plane, growth = theme.new_figure((10.4, 4.8)).subplots(1, 2, width_ratios=(1.25, 1.0))
    else:
        plane, growth = pair("plot.branch_tree(axes=...)", axes)
    plane, growth = map(theme.axes_or_new, (plane, growth))
    restricted = system.restrict(tree.momentum.real)
    momentum = on_plane(system, restricted)
    if momentum.shape[1] == 2:
        level = ellipse(system, float(system.constrained_energy(restricted[0])))
        plane.plot(*level.T, color=theme.LEVEL, linewidth=1.1, zorder=1)
    colors = theme.TIME(np.linspace(_EARLY, _LATE, len(tree.counts)))
    edges = _edges(plane, tree, momentum[:, :2], colors)
    images = tuple(_images(plane, tree, momentum[:, :2], *one) for one in enumerate(colors))
    name_axes(plane, system)
    theme.write_title(plane, "Real images")
    theme.legend(plane, title="generation", loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return BranchTreePicture(plane, growth, edges, images, *_growth(growth, tree))


def _system_of(discrete: Any, tree: Any) -> Any:
    where = "plot.branch_tree(tree=...)"
    system = as_discretization("plot.branch_tree(discrete=...)", discrete).system
    instance(where, tree, BranchTree, "be a tree", "Pass what `nh.branch_tree` returned.")
    if len(tree.counts) < 2:
        raise error(where, "have a generation of images", "the root alone", "Make it with depth=1 or more.")
    if tree.displacement.shape[1:] != system.group.identity.shape:
        got = f"matrices {tree.displacement.shape[1:]}"
        raise error(where, f"be in {system.group}", got, "Pass its own `discrete`.")
    return system


def _edges(
    axes: Axes, tree: BranchTree, momentum: Float[np.ndarray, "T 2"], colors: Float[np.ndarray, "L 4"]
) -> LineCollection:
    parent = np.maximum(tree.parent, 0)
    at = np.flatnonzero((tree.parent >= 0) & tree.is_real & tree.is_real[parent])
    ends = np.stack([momentum[parent[at]], momentum[at]], axis=1)
    edges = LineCollection(list(ends), colors=colors[tree.level[at]], linewidths=0.7, zorder=2)
    axes.add_collection(edges)
    return edges


def _images(
    axes: Axes, tree: BranchTree, momentum: Float[np.ndarray, "T 2"], level: int, color: Float[np.ndarray, "4"]
) -> PathCollection:
    at = tree.is_real & (tree.level == level)
    size = np.geomspace(_LARGEST, _SMALLEST, len(tree.counts))[level]
    look: Any = {"color": color, "edgecolors": theme.PAPER, "linewidths": 0.6, "zorder": 4 + level / 100}
    return axes.scatter(*momentum[at].T, s=size, label=str(level), **look)


def _growth(axes: Axes, tree: BranchTree) -> tuple[Line2D, Line2D, Line2D]:
    level, images = np.arange(len(tree.counts)), int(tree.counts[1])
    real = np.bincount(tree.level[tree.is_real], minlength=len(level))
    bound = axes.plot(level, images**level, color=theme.MUTED, dashes=(4, 3), label=f"${images}^k$", zorder=1)[0]
    own = theme.own_look(theme.DISCRETE, "distinct images")
    counts = axes.plot(level, tree.counts, "o", markersize=7, **own)[0]
    look: Any = {"markerfacecolor": theme.PAPER, "markeredgewidth": 1.6, "linestyle": "none"}
    reals = axes.plot(level, real, "o", color=theme.UNSTABLE, markersize=7, label="real ones", **look)[0]
    axes.set(xlabel="generation k", ylabel="number of images", yscale="log")
    axes.set_title("Growth", loc="left")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.yaxis.set_minor_locator(NullLocator())
    theme.legend(axes, loc="upper left")
    return counts, bound, reals
