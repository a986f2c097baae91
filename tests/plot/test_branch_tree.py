"""Pictures of trees of images: every real image is drawn on its energy level, every generation is counted."""

import numpy as np
import pytest
from matplotlib.figure import Figure
from plot.runs import run_of

import nonholo as nh

SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.3), 0.5)
ORBIT = nh.simulate(SLEIGH, body_velocity=(0.3, -2.0, 0.0), steps=12)
TREE = nh.branch_tree(SLEIGH, ORBIT.displacement[0], 4)  # inside the deltoid: three real images


def test_counts_are_those_of_the_tree() -> None:
    """The panel beside shows 3^k, the distinct images and the real ones among them."""
    picture = nh.plot.branch_tree(SLEIGH, TREE)
    assert np.array_equal(picture.counts.get_ydata(), [1, 3, 9, 27, 81])
    assert np.array_equal(picture.bound.get_ydata(), 3 ** np.arange(5))
    assert np.array_equal(picture.real.get_ydata(), [1, 3, 5, 5, 5])
    assert picture.growth.get_yscale() == "log"


def test_every_real_image_is_drawn_on_its_level() -> None:
    """Each generation has a dot for every real image, with the energy of the orbit."""
    picture = nh.plot.branch_tree(SLEIGH, TREE)
    for level, dots in enumerate(picture.images):
        places = np.asarray(dots.get_offsets())
        assert len(places) == np.count_nonzero(TREE.is_real & (TREE.level == level))
        assert np.allclose(SLEIGH.system.canonical.constrained_energy(places), ORBIT.energy[0], rtol=1e-12)


def test_edges_lead_from_parents_to_images() -> None:
    """Each real image but the root has one edge, which ends at the image and starts at its parent."""
    picture = nh.plot.branch_tree(SLEIGH, TREE)
    momentum = SLEIGH.system.restrict(TREE.momentum.real) @ SLEIGH.system.frame_map.T
    drawn = np.flatnonzero(TREE.is_real & (TREE.level > 0))
    expected = np.stack([momentum[TREE.parent[drawn]], momentum[drawn]], axis=1)
    assert np.allclose(np.array(picture.edges.get_segments()), expected, rtol=1e-12)


def test_a_system_with_three_momenta_is_drawn_on_given_axes() -> None:
    """A top on SO(4) shows two of its three restricted momenta, and six images."""
    top = run_of(nh.SuslovTop(np.diag([1.0, 1.5, 2.0, 2.5]) + 0.2), steps=1)
    panels = tuple(Figure(figsize=(9, 4)).subplots(1, 2))
    picture = nh.plot.branch_tree(top.motion, nh.branch_tree(top.motion, top.displacement[0], 1), axes=panels)
    assert (picture.plane, picture.growth) == panels
    assert np.array_equal(picture.counts.get_ydata(), [1, 6])
    picture.plane.figure.canvas.draw()


def test_other_things_are_refused() -> None:
    """No tree, the root alone and a tree of another group are refused in words."""
    with pytest.raises(ValueError, match=r"`plot.branch_tree\(tree=...\)` must be a tree"):
        nh.plot.branch_tree(SLEIGH, ORBIT)
    with pytest.raises(ValueError, match=r"must have a generation of images. Got the root alone"):
        nh.plot.branch_tree(SLEIGH, nh.branch_tree(SLEIGH, np.eye(3), 0))
    four = nh.discretize(nh.SuslovTop(np.diag([1.0, 1.5, 2.0, 2.5]) + 0.2), 0.1)
    with pytest.raises(ValueError, match=r"must be in SO\(4\)"):
        nh.plot.branch_tree(four, TREE)


def test_images_on_the_portrait_are_values_of_the_map() -> None:
    """The far end of an edge from the first image of the orbit is reached by one of its other values."""
    picture = nh.plot.phase_portrait(SLEIGH.system, ORBIT, branches="all")
    ends = np.array(picture.edges.get_segments())
    found = nh.branches(SLEIGH, displacement=ORBIT.displacement[0])
    reached = [nh.branches(SLEIGH, displacement=W.real).momentum[0].real for W in found.displacement[1:]]
    expected = SLEIGH.system.restrict(np.array(reached)) @ SLEIGH.system.frame_map.T
    for place in expected:
        assert np.linalg.norm(ends[:, 1] - place, axis=1).min() < 1e-9


def test_all_branches_without_an_orbit_are_refused() -> None:
    """All branches need a discrete orbit, and there is no third choice."""
    with pytest.raises(ValueError, match=r"`phase_portrait\(branches=...\)` must be 'principal' without a discrete"):
        nh.plot.phase_portrait(SLEIGH.system, branches="all")
    with pytest.raises(ValueError, match=r"`phase_portrait\(branches=...\)` must be one of 'principal', 'all'"):
        nh.plot.phase_portrait(SLEIGH.system, ORBIT, branches="both")
