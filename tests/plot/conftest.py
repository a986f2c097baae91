"""Orbits that the tests of the pictures share."""

import pytest
from plot.runs import sleigh_run, top_run

import nonholo as nh


@pytest.fixture(scope="session")
def top_orbit() -> nh.Orbit:
    """A top on its way from the repelling to the attracting permanent rotation."""
    return top_run((0.465, 0.75, 0.0), steps=600)


@pytest.fixture(scope="session")
def sleigh_orbit() -> nh.Orbit:
    """A sleigh that starts backwards and turns round through a cusp."""
    return sleigh_run((0.1, -1.0, 0.0), steps=200)
