"""The picture of a Poincare section draws what the event found."""

import numpy as np
import pytest

import nonholo as nh

SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.0), 0.1)


def _crossings(steps: int) -> nh.Crossings:
    event = nh.Event(lambda orbit: np.sin(orbit.heading), name="east")
    return nh.simulate(SLEIGH, body_velocity=(4.0, 1.0, 0.0), steps=steps, events=[event]).events["east"]


def test_dots_are_the_quantities_at_the_crossings() -> None:
    """Each dot is a crossing, with the two quantities as its place and the time as its color."""
    found = _crossings(100)
    drawn = nh.plot.section(found, lambda states: states.position[:, 0], lambda states: states.heading)
    assert np.array_equal(drawn.points, np.stack([found.states.position[:, 0], found.states.heading], axis=1))
    assert np.array_equal(drawn.dots.get_offsets(), drawn.points)
    assert np.array_equal(drawn.dots.get_array(), found.time)


def test_axes_bear_the_names_of_their_quantities() -> None:
    """The first label is that of the abscissa, the second that of the ordinate."""
    drawn = nh.plot.section(
        _crossings(20), lambda states: states.position[:, 0], lambda states: states.heading, labels=("x", "heading")
    )
    assert (drawn.axes.get_xlabel(), drawn.axes.get_ylabel()) == ("x", "heading")


def test_sections_without_crossings_are_refused() -> None:
    """A section needs at least one crossing."""
    with pytest.raises(ValueError, match="hold crossings"):
        nh.plot.section(_crossings(3), lambda states: states.time, lambda states: states.time)


def test_quantities_of_the_wrong_shape_are_refused() -> None:
    """A quantity must give one number for each crossing; the error names which one does not."""
    with pytest.raises(ValueError, match=r"section\(up=.*shape"):
        nh.plot.section(_crossings(20), lambda states: states.time, lambda states: states.position)
