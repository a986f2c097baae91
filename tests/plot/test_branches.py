"""Pictures of all values of the map: every value is where its definition says, and none is left out."""

import numpy as np
import pytest
from matplotlib.figure import Figure
from plot.runs import run_of
from refusals import refusals

import nonholo as nh
from nonholo.analysis import deltoid

FOUR = nh.discretize(nh.SuslovTop([[1.25, 0, -0.5], [0, 1, -0.75], [-0.5, -0.75, 1.25]]), 1.0)
EQUILIBRIUM = nh.SO(3).cayley(2 * np.array([0.375, -0.25, 0.0]))  # y = (-1/4, -3/8)
SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.3), 0.5)
BALANCED = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.0), 0.5)
TILTED = nh.discretize(nh.SuslovTop.from_inertia(np.diag([3.0, 2.0, 1.5]), axis=np.array([2.0, 1.0, 2.0]) / 3), 0.5)
INSIDE, OUTSIDE = [0.5, -2.2], [0.5, 1.0]


def test_four_real_values_are_on_the_disc() -> None:
    """The values y = z / z_0 of the rational example are at radius (2 / 180 degrees) atan|y| in the direction of y."""
    picture = nh.plot.branches(FOUR, displacement=EQUILIBRIUM)
    reference = np.array(
        [[-1 / 4, -3 / 8], [-16 / 13, -24 / 13], [-3.81310876, -0.50880833], [7.60258244, -8.96487588]]
    )
    size = np.linalg.norm(reference, axis=1, keepdims=True)
    expected = reference / size * 2 * np.arctan(size) / np.pi
    assert np.allclose(picture.principal.get_offsets(), expected[:1], atol=1e-9)
    assert np.allclose(picture.others.get_offsets(), expected[1:], atol=1e-8)  # to the digits of the known values
    assert np.allclose(picture.present.get_offsets(), expected[:1], atol=1e-9)


def test_values_are_on_the_drawn_level() -> None:
    """Every dot, of tops in two frames and of a sleigh on its strip, is within the spacing of its curve of energy."""
    pictures = (
        nh.plot.branches(FOUR, displacement=EQUILIBRIUM),
        nh.plot.branches(SLEIGH, momentum=INSIDE, plane="displacements"),
        nh.plot.branches(TILTED, momentum=[0.9, -0.6]),
    )
    for picture in pictures:
        curve = np.concatenate(picture.level.get_segments())
        for dot in np.concatenate([picture.principal.get_offsets(), picture.others.get_offsets()]):
            assert np.linalg.norm(curve - dot, axis=1).min() < 0.02


@pytest.mark.parametrize(("momentum", "real"), [(INSIDE, 3), (OUTSIDE, 1)], ids=["inside", "outside"])
def test_lines_of_a_sleigh_are_tangents_through_its_momentum(momentum: list[float], real: int) -> None:
    """There is a line for each real value; it satisfies the equation of the displacements with its step angle."""
    picture = nh.plot.branches(SLEIGH, momentum=momentum)
    assert len(picture.tangents) == np.count_nonzero(picture.found.is_real) == real
    W = picture.found.displacement[picture.found.is_real].real
    half = np.arctan2(W[:, 1, 0], W[:, 0, 0]) / 2
    for line, phi in zip(picture.tangents, half, strict=True):
        pi, p_hat = 0.5 * line.get_xdata(), 0.5 * 0.5 * line.get_ydata() + 0.5  # h pi and a h p_1 + 2 m a^2
        missed = pi * np.cos(phi) - (p_hat + 0.5) * np.sin(phi) - 0.5 * np.sin(3 * phi)  # J = 1
        assert np.abs(missed).max() < 1e-12


def test_dots_of_a_sleigh_are_on_the_deltoid() -> None:
    """Each value is drawn where its line touches: the discriminant vanishes there, to rounding."""
    picture = nh.plot.branches(SLEIGH, momentum=INSIDE)
    dots = np.concatenate([picture.principal.get_offsets(), picture.others.get_offsets()])
    restricted = dots - np.outer(0.3 * dots[:, 1], [1.0, 0.0])
    assert np.abs(deltoid(SLEIGH).discriminant(restricted)).max() < 1e-12


def test_complex_values_are_counted() -> None:
    """A sleigh outside the deltoid has two complex values: the legend and the title say so."""
    picture = nh.plot.branches(SLEIGH, momentum=OUTSIDE)
    assert "and 2 complex" in [text.get_text() for text in picture.axes.get_legend().get_texts()]
    assert picture.axes.get_title(loc="left") == "Values: 1 real, 2 complex"


def test_rest_has_no_level() -> None:
    """At rest the energy is zero and there is no curve; a balanced sleigh is drawn on its strip, on given axes."""
    assert nh.plot.branches(FOUR, displacement=np.eye(3)).level is None
    axes = Figure().add_subplot()
    picture = nh.plot.branches(BALANCED, momentum=[0.5, 1.0], axes=axes)
    assert picture.axes is axes
    assert picture.tangents == ()
    axes.figure.canvas.draw()


_NO_DELTOID = r"`plot.branches\(plane=...\)` must be 'displacements' for a system without"
# A top has no deltoid, nor has a balanced sleigh, and other planes have no name.
test_planes_that_do_not_exist_are_refused = refusals(
    (FOUR, "momenta", _NO_DELTOID),
    (BALANCED, "momenta", _NO_DELTOID),
    (SLEIGH, "disc", r"must be one of 'displacements', 'momenta'. Got 'disc'"),
    ask=lambda discrete, plane: nh.plot.branches(discrete, momentum=[0.1, 0.1], plane=plane),
)


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


def test_images_on_the_portrait_are_values_of_the_map() -> None:
    """The far end of an edge from the first image of the orbit is reached by one of its other values."""
    picture = nh.plot.phase_portrait(SLEIGH.system, ORBIT, branches="all")
    ends = np.array(picture.edges.get_segments())
    result = nh.branches(SLEIGH, displacement=ORBIT.displacement[0])
    reached = [nh.branches(SLEIGH, displacement=W.real).momentum[0].real for W in result.displacement[1:]]
    expected = SLEIGH.system.restrict(np.array(reached)) @ SLEIGH.system.frame_map.T
    for place in expected:
        assert np.linalg.norm(ends[:, 1] - place, axis=1).min() < 1e-9


_WIDE = nh.discretize(nh.SuslovTop(np.diag([1.0, 1.5, 2.0, 2.5]) + 0.2), 0.1)
# No tree, the root alone, a tree of another group; all branches need a discrete orbit, and there is no third choice.
test_other_things_are_refused = refusals(
    (lambda: nh.plot.branch_tree(SLEIGH, ORBIT), r"`plot.branch_tree\(tree=...\)` must be a tree"),
    (lambda: nh.plot.branch_tree(SLEIGH, nh.branch_tree(SLEIGH, np.eye(3), 0)), "of images. Got the root alone"),
    (lambda: nh.plot.branch_tree(_WIDE, TREE), r"must be in SO\(4\)"),
    (lambda: nh.plot.phase_portrait(SLEIGH.system, branches="all"), "must be 'principal' without a discrete"),
    (lambda: nh.plot.phase_portrait(SLEIGH.system, ORBIT, branches="both"), "must be one of 'principal', 'all'"),
)
