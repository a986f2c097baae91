"""Energy errors: their values, units and the band of rounding."""

import dataclasses

import numpy as np
import pytest
from plot.runs import top_run

import nonholo as nh


def test_dots_are_relative_errors(top_orbit: nh.Orbit) -> None:
    """Each dot is (E_k - E_0) / E_0 in units of 1e-16, at its time."""
    drawn = nh.plot.energy_error(top_orbit)
    error = (top_orbit.energy - top_orbit.energy[0]) / top_orbit.energy[0]
    assert drawn.unit == 1e-16
    assert np.allclose(drawn.error.get_offsets(), np.stack([top_orbit.time, error / 1e-16], axis=1))
    low, high = drawn.rounding.get_extents().transformed(drawn.axes.transData.inverted()).intervaly
    assert np.allclose([low, high], [-2.220446049250313, 2.220446049250313])


def test_long_orbits_keep_their_extremes() -> None:
    """The band of a long orbit reaches from the least to the greatest error."""
    orbit = top_run((0.465, 0.75, 0.0), steps=5000)
    vertices = nh.plot.energy_error(orbit).error.get_paths()[0].vertices[:, 1]
    error = (orbit.energy - orbit.energy[0]) / orbit.energy[0] / 1e-16
    assert np.isclose(vertices.min(), error.min())
    assert np.isclose(vertices.max(), error.max())


def test_larger_errors_have_larger_units(top_orbit: nh.Orbit) -> None:
    """Where the energy is not kept, the unit on the axis says so."""
    growing = top_orbit.reduced_momentum * (1 + 1e-3 * np.arange(len(top_orbit)) / len(top_orbit))[:, None]
    drawn = nh.plot.energy_error(dataclasses.replace(top_orbit, reduced_momentum=growing))
    assert drawn.unit == 1e-3
    assert drawn.axes.get_legend() is None  # the band of rounding is too thin to be seen
    assert "10^{-3}" in drawn.axes.get_ylabel()


def test_at_rest_the_error_is_absolute() -> None:
    """A body at rest has no energy to compare with."""
    drawn = nh.plot.energy_error(top_run((0.0, 0.0, 0.0), steps=5))
    assert not np.any(drawn.error.get_offsets()[:, 1])
    assert "/E" not in drawn.axes.get_ylabel()


def test_refuses_an_orbit_without_states(top_orbit: nh.Orbit) -> None:
    """An orbit that did not start is refused, and its outcome is pointed at."""
    with pytest.raises(ValueError, match=r"must have a state to draw. Got none. `orbit.outcome` has"):
        nh.plot.energy_error(top_orbit[:0])
