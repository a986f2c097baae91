r"""The tree of all values of the discrete map: images, images of images, over real and complex displacements.

Reference: docs/theory/branches.md. The values over one momentum come from `_values`.
"""

import dataclasses
from typing import Any

import numpy as np

from nonholo.base.checks import error, natural
from nonholo.base.types import Array, Bool, Int
from nonholo.discrete._discretization import Discretization
from nonholo.discrete._scheme import legendre
from nonholo.discrete.branching._sections import AnyFrame, frame_for
from nonholo.discrete.branching._values import checked_point, roots_over

_MOST = 10_000  # nodes of a tree
_ROUNDING = 1e-12  # relative imaginary part that counts as zero
_SAME = 1e-10  # relative distance of two images that rounding may have parted


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class BranchTree:
    """All images of a displacement under the multivalued map, generation by generation.

    Nodes are numbered from the root, generation by generation. Images of one generation that agree to a relative
    distance of 1e-10 are one node, whose parent is the first of its parents.

    Attributes:
        displacement: W, complex matrices.
        momentum: P(W), physical.
        level: Generation, 0 at the root.
        parent: Number of the parent, -1 at the root.
        is_real: Which displacements are real.
        counts: Number of distinct images in each generation, 1 for generation 0.
    """

    displacement: Array
    momentum: Array
    level: Int[np.ndarray, "T"]
    parent: Int[np.ndarray, "T"]
    is_real: Bool[np.ndarray, "T"]
    counts: Int[np.ndarray, "levels"]

    def __len__(self) -> int:
        return len(self.level)

    def __repr__(self) -> str:
        return f"<BranchTree: {', '.join(map(str, self.counts))} images, {np.count_nonzero(self.is_real)} of all real>"


def branch_tree(discrete: Discretization, displacement: Any, depth: int) -> BranchTree:
    r"""Find all images of a displacement under the discrete map, all images of these, and so on.

    $$ P(W')|_{\mathfrak{d}} = (\mathrm{Ad}^*_W P(W))|_{\mathfrak{d}}, \qquad W, W' \in S \ \text{complex}. $$

    The images of a Chaplygin sleigh are 3, 9, 27, ..., as far as counted. Images at infinity, and those that are not
    isolated, are left out.

    Reference: docs/theory/branches.md, "The tree of images".

    Args:
        discrete: As in `displacements_over`.
        displacement: The root W, real and on the displacement variety.
        depth: Number of generations, 0 for the root alone.

    Raises:
        ValueError: A displacement off the variety; a negative depth, or one with more than 10,000 images; as
            `displacements_over`.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5), time_step=0.1)
        >>> tree = branch_tree(sleigh, nh.SE(2).exp(np.array([0.3, 0.1, 0.0])), 3)
        >>> tree.counts
        array([ 1,  3,  9, 27])
    """
    frame = frame_for("branch_tree", discrete)
    group = discrete.system.group
    W, _ = checked_point("branch_tree(displacement=...)", discrete, frame, displacement)
    generations = [np.array([W - group.identity], dtype=complex)]
    reality, parents = [np.array([True])], [np.array([-1])]
    first = 0
    for _ in range(_checked_depth(discrete, frame, depth)):
        X, is_real, index = _next_generation(discrete, frame, generations[-1], reality[-1])
        parents.append(first + index)
        first += len(generations[-1])
        generations.append(X)
        reality.append(is_real)
    counts = np.array([len(X) for X in generations])
    X = np.concatenate(generations)
    return BranchTree(
        displacement=X + group.identity,
        momentum=legendre(discrete, X, "left"),
        level=np.repeat(np.arange(len(counts)), counts),
        parent=np.concatenate(parents),
        is_real=np.concatenate(reality),
        counts=counts,
    )


def _checked_depth(discrete: Discretization, frame: AnyFrame, depth: Any) -> int:
    where = "branch_tree(depth=...)"
    depth = natural(where, depth, "Pass the number of generations, 0 for the root alone.")
    images = frame.equations(np.zeros(len(discrete.system.constraint_subspace))).count
    if depth > _MOST or images**depth > _MOST:
        deepest = int(np.log(_MOST) / np.log(images))
        got = f"{depth}, with {images}^{depth} images"
        raise error(where, f"keep the tree below {_MOST} images", got, f"Pass depth={deepest} or less.")
    return depth


def _next_generation(
    discrete: Discretization, frame: AnyFrame, X: Array, is_real: Array
) -> tuple[Array, Array, Int[np.ndarray, "G"]]:
    """Return the distinct images of displacements minus the identity, which are real, and the index of the parent."""
    if len(X) == 0:
        return X, is_real, np.zeros(0, dtype=np.int64)
    images = [_images(discrete, frame, *node) for node in zip(X, is_real, strict=True)]
    matrices, reality = (np.concatenate(column) for column in zip(*images, strict=True))
    parents = np.repeat(np.arange(len(X)), [len(each) for each, _ in images])
    first = _first_of_equals(matrices * frame.stretch)
    return matrices[first], reality[first], parents[first]


def _images(discrete: Discretization, frame: AnyFrame, X: Array, is_real: Array) -> tuple[Array, Array]:
    r = discrete.system.restrict(legendre(discrete, X, "right"))
    if is_real or np.abs(r.imag).max() <= _ROUNDING * np.abs(r).max():
        r = r.real
    roots = roots_over(discrete, frame, discrete.system.to_canonical(r))
    return roots.increments, np.array([root.is_real for root in roots.zeros], dtype=bool)


def _first_of_equals(X: Array) -> Int[np.ndarray, "G"]:
    """Return the indices of matrices minus the identity, in a unit of length, that repeat none before them."""
    distinct = np.empty_like(X)
    indices: list[int] = []
    for i, candidate in enumerate(X):
        distances = np.abs(distinct[: len(indices)] - candidate).max(axis=(1, 2))
        if not np.any(distances <= _SAME * max(1.0, np.abs(candidate).max())):
            distinct[len(indices)] = candidate
            indices.append(i)
    return np.array(indices, dtype=np.int64)
