"""The tree of images: its growth, its nodes as values of the map, its conserved energy, what is refused."""

import numpy as np
import pytest
from refusals import refusals

import nonholo as nh
from nonholo.discrete import BranchTree

SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
TOP = nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 0.5)
MOTION = nh.discretize(nh.MultidimensionalSleigh(1.3, [0.3, 0.2, -0.1], np.diag([0.5, 0.7, 0.4]) + 0.1), 0.3)
ROOTS = {
    "sleigh": (SLEIGH, nh.SE(2).exp(np.array([0.3, 0.1, 0.0]))),
    "top": (TOP, nh.SO(3).exp(np.array([0.3, -0.4, 0.0]))),
    "tilted top": (
        nh.discretize(
            nh.SuslovTop.from_inertia([[3, 0.1, 0.2], [0.1, 2, 0.3], [0.2, 0.3, 2.5]], (2 / 3, -1 / 3, 2 / 3)), 0.2
        ),
        np.eye(3),
    ),
    "motion": (MOTION, nh.SE(3).exp(np.array([0.0, 0.2, -0.3, 0.4, 0.0, 0.0]))),
}


def _tree(name: str, depth: int) -> tuple[nh.Discretization, BranchTree]:
    discrete, W = ROOTS[name]
    return discrete, nh.branch_tree(discrete, W, depth)


@pytest.mark.parametrize(("name", "base", "depth"), [("sleigh", 3, 5), ("top", 4, 4), ("motion", 5, 3)])
def test_images_multiply(name: str, base: int, depth: int) -> None:
    """A sleigh has 3, 9, 27, 81, 243 distinct images, a top in space 4, 16, ..., a sleigh on SE(3) 5, 25, ..."""
    _, tree = _tree(name, depth)
    assert tree.counts.tolist() == [base**level for level in range(depth + 1)]
    assert np.bincount(tree.level).tolist() == tree.counts.tolist()


@pytest.mark.parametrize("name", ["sleigh", "top", "motion"])
def test_each_node_follows_its_parent(name: str) -> None:
    """The momenta along the constraint are those that arrive from the parent: the defining equation, complex too."""
    discrete, tree = _tree(name, 2)
    before, after = tree.displacement[tree.parent[1:]], tree.momentum[1:]
    images = before[:, None] @ discrete.system.group.basis @ np.linalg.inv(before)[:, None]
    carried = np.einsum("tji,ti->tj", discrete.system.group.vee(images), tree.momentum[tree.parent[1:]])
    missed = discrete.system.restrict(carried - after)
    size = np.abs(before).max((1, 2)) ** 2 * np.abs(tree.momentum[tree.parent[1:]]).max(1)
    assert np.abs(missed / size[:, None]).max() < 1e-12  # rounding of a product of three matrices


@pytest.mark.parametrize("name", ["sleigh", "top", "motion"])
def test_energy_is_that_of_the_root(name: str) -> None:
    """Every image, complex ones included, has the energy of the root: r . B^-1 r without conjugation."""
    discrete, tree = _tree(name, 2)
    r = discrete.system.restrict(tree.momentum)
    energy = np.einsum("ti,ij,tj->t", r, np.linalg.inv(discrete.system.constrained_inertia), r) / 2
    size = np.einsum("ti,ti->t", r.conj(), r).real
    assert (np.abs(energy - energy[0]) / size).max() < 1e-12


@pytest.mark.parametrize("name", ["sleigh", "top", "motion"])
def test_the_first_generation_is_branches(name: str) -> None:
    """The images of the root are what `branches` finds, with the same mask of real ones."""
    discrete, tree = _tree(name, 1)
    found = nh.branches(discrete, displacement=ROOTS[name][1])
    np.testing.assert_allclose(tree.displacement[1:], found.displacement, rtol=0, atol=1e-13)
    np.testing.assert_allclose(tree.momentum[1:], found.momentum, rtol=0, atol=1e-11)  # 1/time_step larger
    assert np.array_equal(tree.is_real[1:], found.is_real)


def test_complex_nodes_have_conjugate_partners() -> None:
    """The root is real, so each generation is its own complex conjugate."""
    _, tree = _tree("top", 2)
    last = tree.displacement[tree.level == 2]
    missed = [np.abs(last - W.conj()).max((1, 2)).min() / np.abs(W).max() for W in last]
    assert max(missed) < 1e-9  # two generations of roots, near folds too


def test_equal_images_are_one_node() -> None:
    """At rest a top has images that its other images have too; they are counted once."""
    discrete, W = ROOTS["tilted top"]
    tree = nh.branch_tree(discrete, W, 2)
    assert tree.counts[2] < tree.counts[1] ** 2
    last = tree.displacement[tree.level == 2]
    apart = np.abs(last[:, None] - last[None]).max((2, 3)) + np.eye(len(last))
    assert apart.min() > 1e-10


def test_depth_zero_is_the_root() -> None:
    """With depth 0 the tree has one node, real and without a parent."""
    tree = nh.branch_tree(SLEIGH, np.eye(3), 0)
    assert (len(tree), tree.counts.tolist(), tree.parent.tolist(), tree.is_real.tolist()) == (1, [1], [-1], [True])


def test_a_single_image_has_a_single_line() -> None:
    """A balanced sleigh on a straight line has one image; the other half-turn is infinitely far."""
    straight = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.0), 0.1)
    assert nh.branch_tree(straight, nh.SE(2).exp(np.array([0.0, 0.1, 0.0])), 3).counts.tolist() == [1, 1, 1, 1]


# Each names the argument, the requirement, what was got and the remedy.
test_bad_arguments_are_refused = refusals(
    ((SLEIGH, np.eye(3), -1), r"depth=...\)` must be a natural number. Got -1"),
    ((SLEIGH, np.eye(3), 1.5), "must be a natural number. Got 1.5"),
    ((SLEIGH, np.eye(3), True), "must be a natural number. Got True"),
    ((SLEIGH, np.eye(3), 9), r"below 10000 images. Got 9, with 3\^9 images. Pass depth=8 or less"),
    ((SLEIGH, np.eye(2), 1), r"displacement=...\)` must have shape \(3, 3\)"),
    ((SLEIGH, nh.SE(2).exp(np.array([0.3, 0.1, 0.2])), 1), "must lie on the displacement variety"),
    ((nh.discretize(nh.RigidBody(np.diag([1.0, 2.0, 3.0, 4.0])), 0.1), np.eye(4), 1), "rank at most 4. Got .* rank 6"),
    (("sleigh", np.eye(3), 1), "must be a discretized system"),
    ask=lambda given: nh.branch_tree(*given),
)
