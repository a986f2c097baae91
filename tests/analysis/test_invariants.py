"""`invariants`: what it measures at the edges."""

import dataclasses

import numpy as np
import pytest
from problems import PROBLEMS

import nonholo as nh

SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
RUN = nh.simulate(SLEIGH, body_velocity=(0.1, 1.0, 0.0), steps=2)


def test_no_states() -> None:
    """An orbit that never started has nothing to measure, and the error says where to look."""
    empty = nh.simulate(nh.discretize(PROBLEMS[0].system, 1.0), body_velocity=(40.0, 0.0, 0.0), steps=3, throw=False)
    with pytest.raises(ValueError, match=r"at least one state.*outcome"):
        nh.invariants(empty)


def test_the_help_names_every_field() -> None:
    """`help(nh.invariants)` lists what it measures."""
    assert all(f"`{field.name}`" in str(nh.invariants.__doc__) for field in dataclasses.fields(nh.invariants(RUN)))


def test_rest() -> None:
    """A body at rest keeps everything."""
    found = nh.invariants(nh.simulate(SLEIGH, body_velocity=(0, 0, 0), steps=5))
    assert (found.energy_drift, found.reversal_defect, found.largest_step_angle) == (0.0, 0.0, 0.0)


def test_a_negative_energy() -> None:
    """On SO(2, 1) a turn may have one: its drift is a size all the same."""
    G = np.diag([1.0, 1.0, -1.0])
    lorentz, J = nh.MatrixGroup(G @ nh.SO(3).basis, form=G), np.diag([1.0, 2.0, 4.0]) @ G
    turning = nh.discretize(nh.LLSystem(lorentz, -J, annihilator=[[0.0, 0.3, 1.0]]), 0.2)
    orbit = nh.simulate(turning, restricted_velocity=(0.5, 0.4), steps=200)
    assert orbit.energy[0] < 0
    assert 0 < nh.invariants(orbit).energy_drift < 1e-13


@pytest.mark.parametrize("velocity", [(0.0, 0.0), (0.9, -0.4)], ids=["at rest", "one state"])
def test_edges_of_a_right_invariant_run(velocity: tuple[float, float]) -> None:
    """Its steps depend on the pose: none that moves, or a single saved state, is measured all the same."""
    discrete = nh.discretize(nh.VeselovaTop(np.diag([1.0, 2.0, 3.0])), 0.1)
    found = nh.invariants(nh.simulate(discrete, restricted_velocity=velocity, steps=3, save_every=4))
    assert (found.states, found.energy_drift) == (1, 0.0)
    assert found.reversal_defect is not None
    assert found.reversal_defect < 1e-14


@pytest.mark.profile("routes", instead="test_edges_of_a_right_invariant_run")
def test_undefined_quantities_are_none() -> None:
    """A flow has no displacements, a run without poses no group residual, another difference no reversal defect."""
    flow = nh.invariants(nh.flow(SLEIGH.system, body_velocity=(1, 0, 0), times=[0.0, 1.0]))
    assert flow.reversal_defect is None
    assert flow.largest_step_angle is None
    bare = nh.invariants(nh.simulate(SLEIGH, body_velocity=(1, 0, 0), steps=5, reconstruct=False))
    assert bare.group_residual is None
    logarithmic = nh.discretize(SLEIGH.system, 0.1, difference="logarithmic")
    assert nh.invariants(nh.simulate(logarithmic, body_velocity=(1, 0, 0), steps=2)).reversal_defect is None


@pytest.mark.parametrize(("field", "measure"), [("cayley", "reversal_defect"), ("reduced_momentum", "energy_drift")])
def test_a_spoilt_orbit_is_seen(field: str, measure: str) -> None:
    """A relative change of 1e-9 in one state shows in what belongs to it."""
    orbit = nh.simulate(SLEIGH, body_velocity=(1, 0, 0), steps=50)
    rows = getattr(orbit, field).copy()
    rows[20] *= 1 + 1e-9
    spoilt = nh.invariants(dataclasses.replace(orbit, **{field: rows}))
    assert getattr(nh.invariants(orbit), measure) < 1e-14
    assert getattr(spoilt, measure) > 1e-11


def test_group_residual_is_seen() -> None:
    """Poses off the group show."""
    orbit = nh.simulate(nh.discretize(PROBLEMS[0].system, 0.1), restricted_velocity=(0.9, -0.4), steps=5)
    stretched = dataclasses.replace(orbit, canonical_pose=np.array(orbit.canonical_pose) * (1 + 1e-9))
    assert nh.invariants(stretched).group_residual > 1e-10
