"""Starts, thinning, outcomes and refusals of `simulate`."""

import numpy as np
import pytest
from problems import PROBLEMS
from refusals import refusals

import nonholo as nh

TOP = nh.discretize(PROBLEMS[0].system, 0.1)
SLEIGH = nh.discretize(PROBLEMS[7].system, 0.1)


@pytest.mark.parametrize("discrete", [TOP, SLEIGH], ids=["top", "sleigh"])
def test_starts_agree(discrete: nh.Discretization) -> None:
    """Velocity, restricted velocity, displacement, full and restricted momentum name the same start."""
    system = discrete.system
    w = np.array([0.7, -0.3])
    orbit = nh.simulate(discrete, restricted_velocity=w, steps=5)
    starts = [
        {"body_velocity": w @ system.constraint_subspace},
        {"displacement": orbit.displacement[0]},
        {"momentum": orbit.momentum[0]},
        {"momentum": orbit.restricted_momentum[0]},
    ]
    for start in starts:
        assert np.abs(nh.simulate(discrete, **start, steps=5).configuration - orbit.configuration).max() < 1e-13
    assert np.abs(orbit.body_velocity[0] - w @ system.constraint_subspace).max() < 1e-15


def test_parts_of_a_thinned_orbit_are_thinned() -> None:
    """A part of a thinned orbit has the multipliers of single steps too, and is thinned by both strides."""
    top = nh.simulate(TOP, restricted_velocity=(0.7, -0.3), steps=24, save_every=6)
    for thin in (top, nh.examples.rolling_disk().simulate(steps=24, save_every=6)):
        assert np.array_equal(thin[1:4].multipliers[:2], thin.multipliers[1:3])
        assert [part.save_every for part in (thin[1:4], thin[::2], thin[::2][1:])] == [6, 12, 12]


def test_zero_velocity_stays() -> None:
    """At rest every displacement is the identity and nothing is NaN."""
    for discrete in (TOP, SLEIGH):
        orbit = nh.simulate(discrete, restricted_velocity=(0.0, 0.0), steps=10)
        assert np.array_equal(orbit.displacement, np.broadcast_to(np.eye(3), (11, 3, 3)))
        assert not orbit.energy.any()
        assert np.isfinite(orbit.spatial_momentum).all()
        assert nh.invariants(orbit).energy_drift == 0


def test_a_run_keeps_its_good_steps() -> None:
    """When the principal branch folds the orbit so far is kept, with the outcome and the step in the message."""
    discrete = nh.discretize(PROBLEMS[0].system, 1.0)
    start = {"momentum": np.array([1.93257157, -0.68979744]), "steps": 500}
    orbit = nh.simulate(discrete, **start, throw=False)
    assert orbit.outcome == nh.Outcome.no_real_branch
    assert 1 < len(orbit) < 500
    assert np.isfinite(orbit.displacement).all()
    with pytest.raises(nh.OutcomeError, match=rf"Step {len(orbit)} of 500.*no_real_branch.*smaller") as caught:
        nh.simulate(discrete, **start)
    assert np.array_equal(caught.value.orbit.momentum, orbit.momentum)
    assert caught.value.outcome == nh.Outcome.no_real_branch


def test_the_way_to_a_variety_that_is_no_exponential() -> None:
    """Where exp d is not the variety its elements are refused, and the error does not advise them."""
    discrete = nh.discretize(nh.LLSystem(nh.SO(4), np.diag([1.0, 2.0, 3.0, 4.0]), np.eye(6)[:2]), 0.1)
    orbit = nh.simulate(discrete, restricted_velocity=(0.7, -0.3), steps=1)
    again = nh.simulate(discrete, displacement=orbit.displacement[0], steps=1)
    assert np.abs(again.momentum - orbit.momentum).max() < 1e-14
    tilted = np.array([[1.0, 0, 0, 0, 0, 0], [0, 1.0, 0, 0, 0.5, 1.0]])
    discrete = nh.discretize(nh.LLSystem(nh.SO(4), np.diag([1.0, 2.0, 3.0, 4.0]), tilted), 0.1)
    W = discrete.system.group.exp(np.array([0.7, -0.9]) @ tilted)
    with pytest.raises(ValueError, match=r"take a row of `orbit\.displacement`: exp d is not this variety"):
        nh.simulate(discrete, displacement=W, steps=1)


def test_a_momentum_off_the_locus_is_refused() -> None:
    """A full momentum must be that of a displacement."""
    momentum = nh.simulate(TOP, restricted_velocity=(0.7, -0.3), steps=1).momentum[0] + np.array([0, 0, 0.1])
    with pytest.raises(nh.OutcomeError, match="off_momentum_locus"):
        nh.simulate(TOP, momentum=momentum, steps=3)


GOOD = {"body_velocity": (0.4, 0.9, 0.0), "steps": 3}


# Each names the owner, the requirement, what was got and the remedy, before any work.
test_bad_arguments_are_refused = refusals(
    ({**GOOD, "steps": 0}, r"simulate\(steps=...\)` must be a positive integer. Got 0"),
    ({**GOOD, "steps": 2.5}, "positive integer. Got 2.5"),
    ({**GOOD, "steps": True}, "positive integer. Got True"),
    ({**GOOD, "save_every": -1}, r"save_every=...\)` must be a positive integer"),
    ({"steps": 3}, "exactly one of body_velocity, .*Got none"),
    ({**GOOD, "momentum": (1, 2)}, "Got body_velocity and momentum"),
    ({**GOOD, "body_velocity": (0.4, 0.9, 0.1)}, r"satisfy the constraint. Got residual \[0.1\].*\[0.4, 0.9, 0.0\]"),
    ({**GOOD, "body_velocity": (0.4, 0.9)}, r"shape \(3,\). Got shape \(2,\)"),
    ({**GOOD, "body_velocity": (0.4, np.nan, 0.0)}, "be finite. Got nan at index"),
    ({**GOOD, "body_velocity": (0.4, 1j, 0.0)}, "be real. Got complex"),
    ({**GOOD, "branch": "closest"}, "branch=.*must be one of 'principal', 'nearest', .*Got 'closest'"),
    ({**GOOD, "backend": "cuda"}, "be one of 'auto', 'numba', 'jax'"),
    ({**GOOD, "configuration": 2 * np.eye(3)}, r"lie in SO\(3\). Got a matrix at distance"),
    ({"displacement": nh.SO(3).exp(np.array([0.1, 0.2, 0.3])), "steps": 3}, "displacement variety.*forbidden part"),
    ({"displacement": np.eye(3) + 0.1, "steps": 3}, r"lie in SO\(3\)"),
    ask=lambda arguments: nh.simulate(TOP, **arguments),
)


# `discretize` says what it accepts.
test_bad_discretizations_are_refused = refusals(
    ({"time_step": 0}, "time_step=.*must be positive. Got 0.0"),
    ({"time_step": -0.1}, "must be positive. Got -0.1"),
    ({"time_step": 0.1 + 1j}, "must be real"),
    ({"time_step": np.nan}, "must be finite"),
    ({"difference": "central"}, "be one of 'matrix', 'logarithmic'. Got 'central'"),
    ({"constraint": "holonomic"}, "be one of 'skew', 'exponential', 'naive'"),
    ({"order": 3}, "be one of 2, 4, 6, 8. Got 3"),
    ask=lambda arguments: nh.discretize(TOP.system, **{"time_step": 0.1, **arguments}),
)


HUGE = nh.discretize(nh.ChaplyginSleigh(1e100, 1e100, 0.5), 0.1)
# A backend without a closed form; energies that overflow, before any work; poses that are not kept.
test_what_is_not_there_is_refused = refusals(
    (lambda: nh.simulate(nh.discretize(TOP.system, 0.1, "logarithmic"), **GOOD, backend="numba"), "have a closed form"),
    (lambda: nh.simulate(HUGE, body_velocity=(0.0, 1e150, 0.0), steps=3), "finite energy"),
    (lambda: nh.simulate(HUGE, body_velocity=(1e150, 1.0, 0.0), steps=3), "finite energy"),
    (lambda: nh.simulate(TOP, **GOOD, reconstruct=False).configuration, "reconstruct=True"),
    (lambda: nh.simulate(TOP, **GOOD).position, "group of motions"),
)


def test_a_first_pose_that_is_not_kept_does_not_matter() -> None:
    """A left-invariant top without poses has the same momenta from any configuration, in blocks and with events too."""
    discrete = nh.discretize(nh.SuslovTop(np.diag([1.0, 1.3, 0.8, 1.1]) + 0.1), 0.1)
    run = {"restricted_velocity": (1.0, 0.2, -0.6), "steps": 20, "reconstruct": False}
    turned = {**run, "configuration": discrete.system.group.exp(np.linspace(0.1, 0.6, 6))}
    momenta = nh.simulate(discrete, **run).reduced_momentum
    events = [lambda orbit: orbit.time - 1.0]
    for orbit in (
        nh.simulate(discrete, **turned),
        nh.simulate(discrete, **turned, events=events),
        *nh.iterate(discrete, **turned),
    ):
        assert np.array_equal(orbit.reduced_momentum, momenta)


def test_an_index_of_an_orbit_is_refused() -> None:
    """An index in place of a slice is refused with what to do instead."""
    with pytest.raises(TypeError, match=r"takes slices.*orbit\.momentum\[0\]"):
        nh.simulate(SLEIGH, body_velocity=(1, 0, 0), steps=3)[0]


def test_numbers_and_truth_values_of_numpy_are_not_refused() -> None:
    """Integers and truth values of NumPy are those of Python: an order, a direction, a choice of poses."""
    sleigh = nh.ChaplyginSleigh(1.0, 1.0, 0.5)
    plain, other = (nh.discretize(sleigh, 0.1, order=order) for order in (4, np.int64(4)))
    assert repr(plain) == repr(other)
    assert "time_step=0.1, " in repr(plain)
    run = {"restricted_velocity": (0.4, 1.0), "steps": 3}
    poses = (nh.simulate(plain, **run, reconstruct=kind(True)).configuration for kind in (bool, np.bool_))
    np.testing.assert_array_equal(*poses)
    assert nh.Event(len, direction=np.int64(-1)) == nh.Event(len, direction=-1)


def test_denormal_motion_is_measured() -> None:
    """A motion whose squared speed underflows still has defects, and no warning."""
    result = nh.invariants(nh.simulate(SLEIGH, body_velocity=(1e-200, 1e-200, 0), steps=3))
    assert result.reversal_defect <= 1e-12
