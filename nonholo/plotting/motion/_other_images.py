"""Images of some states of an orbit along all real branches, on the plane of its momenta."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection

from nonholo.base.checks import choice, error, shown
from nonholo.discrete import BranchTree, Discretization, branch_tree
from nonholo.orbit import Orbit
from nonholo.plotting import theme
from nonholo.plotting.parts import evenly_in_box
from nonholo.plotting.sheets import momenta_on_plane, on_plane

_SEEDS = 3  # states of the orbit whose images are drawn
_GENERATIONS = 3
_SAME = 1e-6  # relative distance of an image from a state of the orbit that it is
_OTHER = theme.COMPONENTS[1]


def trees_of(orbit: Orbit | None, branches: str) -> list[BranchTree]:
    """Return the images of some states of the orbit, or none."""
    where = "phase_portrait(branches=...)"
    if choice(where, branches, ("principal", "all")) == "principal":
        return []
    if orbit is None or not isinstance(orbit.motion, Discretization):
        got = "a system alone" if orbit is None else shown(orbit)
        raise error(where, "be 'principal' without a discrete orbit", got, "Pass what `nh.simulate` returned.")
    chosen = evenly_in_box(orbit.reduced_momentum, _SEEDS + 1)[:_SEEDS]
    return [branch_tree(orbit.motion, W, _GENERATIONS) for W in orbit.displacement[chosen]]


def draw_images(axes: Axes, orbit: Orbit, trees: list[BranchTree]) -> tuple[PathCollection, LineCollection]:
    """Draw the real images that are not on the orbit, later generations smaller, and lines that lead to them."""
    found = [_other_images(orbit, tree) for tree in trees]
    ends, level = (np.concatenate(column) for column in zip(*found, strict=True))
    edges = LineCollection(list(ends), colors=_OTHER, linewidths=0.8, zorder=4)
    axes.add_collection(edges)
    look: Any = {"facecolors": "white", "edgecolors": _OTHER, "linewidths": 1.4, "zorder": 7}
    return axes.scatter(*ends[:, 1].T, s=90.0 / level, marker="D", label="other values", **look), edges


def _other_images(orbit: Orbit, tree: BranchTree) -> tuple[np.ndarray, np.ndarray]:
    """Return the momenta of the parents and of the real images that differ from the orbit's, and their generations."""
    system: Any = orbit.system
    momentum = on_plane(system, system.restrict(tree.momentum.real))
    missed = np.linalg.norm(momentum[:, None] - momenta_on_plane(orbit), axis=2).min(axis=1)
    apart = missed > _SAME * np.linalg.norm(momentum[0])
    chosen = np.flatnonzero(tree.is_real & tree.is_real[tree.parent] & (tree.level > 0) & apart)
    return np.stack([momentum[tree.parent[chosen]], momentum[chosen]], axis=1), tree.level[chosen]
