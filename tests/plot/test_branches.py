"""Pictures of all values of the map: every value is where its definition says, and none is left out."""

import numpy as np
import pytest
from matplotlib.figure import Figure

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
    known = np.array([[-1 / 4, -3 / 8], [-16 / 13, -24 / 13], [-3.81310876, -0.50880833], [7.60258244, -8.96487588]])
    size = np.linalg.norm(known, axis=1, keepdims=True)
    expected = known / size * 2 * np.arctan(size) / np.pi
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


def test_planes_that_do_not_exist_are_refused() -> None:
    """A top has no deltoid, nor has a balanced sleigh, and other planes have no name."""
    for discrete in (FOUR, BALANCED):
        with pytest.raises(
            ValueError, match=r"`plot.branches\(plane=...\)` must be 'displacements' for a system without"
        ):
            nh.plot.branches(discrete, momentum=[0.1, 0.1], plane="momenta")
    with pytest.raises(ValueError, match=r"must be one of 'displacements', 'momenta'. Got 'disc'"):
        nh.plot.branches(SLEIGH, momentum=INSIDE, plane="disc")
