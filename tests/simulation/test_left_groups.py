"""A pose that has left its group ends a motion of every kind, before that pose.

Boosts of the plane of signature (1, 1) have one number, the rapidity. A pose of rapidity x that misses its group by a
factor 1 + m has the residual 2 m / cosh(x)^2: motions that come in leave the group at a known time.
"""

from pathlib import Path
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest
from comparisons import assert_joined, assert_same

import nonholo as nh
from nonholo.lagrange_dalembert import GroupLagrangeDAlembert

BOOSTS = nh.MatrixGroup([[[0.0, 1.0], [1.0, 0.0]]], form=np.diag([1.0, -1.0]))
WIDE = nh.ProductGroup(BOOSTS, nh.Translations(1))
FAR, STEP, GOOD = 6.0, 0.125, 16
MISS = 1e-9 * np.cosh(FAR - STEP * (GOOD + 0.5)) ** 2 / 2


def _action(W: Any, h: Any) -> Any:
    """Return that of unit masses, of which the second one, if there is one, is moved along a line."""
    return (W[0, 1] ** 2 + (W[2:-1, -1] ** 2).sum()) / (2 * h)


def _body(group: Any) -> nh.LLSystem:
    """Return a free body of unit masses."""
    return nh.LLSystem(group, inertia_operator=np.eye(group.dim), constraint_subspace=np.eye(group.dim))


def _across(g: Any) -> Any:
    """Return the form that holds the second one."""
    del g
    return jnp.array([[0.0, 1.0]])


SYSTEMS: dict[str, Any] = {
    "form": _body(BOOSTS),
    "product": _body(WIDE),
    "functions": GroupLagrangeDAlembert(BOOSTS, _action, None),
    "functions that yield": GroupLagrangeDAlembert(WIDE, _action, _across, force=nh.Slip([[1.0]], 0.5)),
}
FLOWS = ["form", "product", "functions"]


def start_of(system: Any, place: float = 0.0, speed: float = 0.0) -> dict[str, Any]:
    """Return a start far out that comes in, its pose already off the group by what is no error there."""
    boost, is_wide = BOOSTS.exp(np.array([FAR])) * (1 + MISS), system.group.size > 2
    pose = np.eye(system.group.size)
    pose[:2, :2] = boost
    if is_wide:
        pose[2, 3] = place
    return {"configuration": pose, "body_velocity": np.array([-1.0, speed][: 1 + is_wide])}


def _twice(start: dict[str, Any]) -> dict[str, Any]:
    """Return the starts of two members."""
    return {name: np.stack([row, row]) for name, row in start.items()}


def ended(run: Any, *arguments: Any, **options: Any) -> Any:
    """Return the orbit of a flow that raises."""
    with pytest.raises(nh.OutcomeError, match=r"nonfinite.*growing pose off its group") as failure:
        run(*arguments, **options)
    return failure.value.orbit


@pytest.mark.profile("routes", cases=["functions that yield"])
@pytest.mark.parametrize("name", SYSTEMS)
def test_a_map_ends_before_the_step_that_leaves(name: str) -> None:
    """Whatever is saved, and however the run is cut, the last state is the one before the first pose off the group."""
    discrete, start = nh.discretize(SYSTEMS[name], STEP), start_of(SYSTEMS[name])
    whole = nh.simulate(discrete, **start, steps=40, throw=False)
    assert (len(whole), whole.outcome) == (1 + GOOD, nh.Outcome.nonfinite)
    states = "configuration", "body_velocity", "time"
    for every in (3, 40):
        thinned = nh.simulate(discrete, **start, steps=40, save_every=every, throw=False)
        assert_same(thinned, whole.chosen(slice(None, None, every)), *states)
    assert_joined([*nh.iterate(discrete, **start, steps=40, block_steps=7, throw=False)], whole, *states)
    assert_same(nh.simulate(discrete, **start, steps=GOOD), whole, *states)
    with pytest.raises(nh.OutcomeError, match=f"^Step {GOOD + 1} of 40"):
        nh.simulate(discrete, **start, steps=40, save_every=40)


@pytest.mark.parametrize("name", FLOWS)
def test_a_flow_ends_before_the_time_at_which_it_has_left(name: str) -> None:
    """The requested times up to then remain, with the bits of a flow that ends there, alone and among members."""
    system, times = SYSTEMS[name], np.linspace(0.0, 5.0, 41)
    start = start_of(system)
    whole, states = ended(nh.flow, system, **start, times=times), ("configuration", "body_velocity", "time")
    assert len(whole) == 1 + GOOD
    assert_same(nh.flow(system, **start, times=times[: 1 + GOOD]), whole, *states)
    watched = ended(nh.flow, system, **start, times=times, events=[lambda x: x.configuration[:, 0, 1] - 50])
    assert_same(watched, whole, *states)
    assert len(watched.events[0]) == 1
    rows = _twice(start)
    rows["body_velocity"][1] *= -1
    batch = nh.ensemble(system, **rows, times=times)
    assert_same(batch.orbit(0), whole, "configuration")
    assert batch.outcome.tolist() == [nh.Outcome.nonfinite, nh.Outcome.successful]
    assert batch.steps_done.tolist() == [GOOD, 40]
    assert np.isnan(batch.momentum[0, 1 + GOOD :]).all()


def test_a_member_that_overflows_is_alone() -> None:
    """A rapidity of 710 is none of a number: that member ends as its flow does, the others continue."""
    batch = nh.ensemble(SYSTEMS["form"], body_velocity=[[8.0], [1.0]], times=np.linspace(0.0, 100.0, 101))
    assert batch.outcome.tolist() == [nh.Outcome.not_converged, nh.Outcome.successful]
    assert batch.steps_done.tolist() == [88, 100]
    for rows in (batch.momentum, batch.configuration):
        assert np.isnan(rows[0, 89:]).all()
        assert np.isfinite(rows[0, :89]).all()


@pytest.mark.parametrize("name", FLOWS)
def test_a_flow_tells_poses_between_its_times(name: str) -> None:
    """Far out again the residual is small: a flow that asks for nothing between ends well, and `at` has the others."""
    system = SYSTEMS[name]
    orbit = nh.flow(system, **start_of(system), times=(0.0, 2 * FAR))
    assert orbit.outcome == orbit.at(1.9).outcome == nh.Outcome.successful
    assert orbit.at([1.9, FAR]).outcome == nh.Outcome.nonfinite
    watched = ended(nh.flow, system, **start_of(system), times=(0.0, 2 * FAR), events=[lambda x: x.time - 1.0])
    assert (len(watched), len(watched.events[0])) == (1, 1)


@pytest.mark.parametrize("name", FLOWS)
def test_rounding_takes_poses_off(name: str) -> None:
    """A body that is driven out to the rapidity 13 and back misses the identity by rounding of the squares of 2e5."""
    system, xp = SYSTEMS[name], jnp if name == "functions" else np
    first = 13 * np.eye(system.group.dim)[0]

    def force(time: Any, g: Any, velocity: Any) -> Any:
        del g, velocity
        return -first * xp.sin(time)

    orbit = ended(nh.flow, nh.Forced(system, force=force), body_velocity=first, times=np.linspace(0, np.pi, 32))
    there = BOOSTS.exp(13 * np.sin(orbit.time)[:, None])
    size = np.abs(there).max(axis=(1, 2))
    assert size.max() > 2e5 > 1e3 > size[-1] > 1
    assert (np.abs(orbit.configuration[:, :2, :2] - there).max(axis=(1, 2)) <= 1e-9 * size).all()


def test_stores_and_ensembles_end_there(tmp_path: Path) -> None:
    """A store that is extended, resumed or begun so long has the states of the run in memory; so have members."""
    discrete, start = nh.discretize(SYSTEMS["form"], STEP), start_of(SYSTEMS["form"])
    whole = nh.simulate(discrete, **start, steps=40, throw=False)
    nh.simulate(discrete, **start, steps=13, store=tmp_path / "longer", checkpoint_every=6)
    nh.simulate(discrete, **start, steps=40, store=tmp_path / "whole", checkpoint_every=6, throw=False)
    for orbit in (nh.extend(tmp_path / "longer", 27, throw=False), nh.resume(tmp_path / "whole", throw=False)):
        assert_same(orbit, whole)
        assert orbit.outcome == nh.Outcome.nonfinite
    for every in (1, None):
        batch = nh.ensemble(discrete, **_twice(start), steps=40, save_every=every)
        assert batch.outcome.tolist() == [nh.Outcome.nonfinite] * 2
        assert batch.steps_done.tolist() == [GOOD] * 2
        assert_same(batch.orbit(1), whole if every else whole[GOOD:], "configuration")


@pytest.mark.parametrize("flows", [False, True])
@pytest.mark.parametrize("ahead", [STEP * GOOD, STEP * (GOOD + 0.5), 1.0])
def test_walls_before_a_pose_leaves(ahead: float, flows: bool) -> None:
    """Impacts before the pose leaves, at the last good node and in the step in which it leaves end no run otherwise."""
    wall = nh.Event(lambda x: x.configuration[:, 2, 3], name="wall", reset=nh.Impact())
    start: Any = start_of(SYSTEMS["product"], place=ahead, speed=-1.0) | {"events": [wall]}
    if flows:
        orbit = ended(nh.flow, SYSTEMS["product"], **start, times=np.linspace(0.0, 5.0, 41))
    else:
        orbit = nh.simulate(nh.discretize(SYSTEMS["product"], STEP), **start, steps=1 + GOOD, throw=False)
    assert (len(orbit), orbit.outcome) == (1 + GOOD, nh.Outcome.nonfinite)
    assert np.abs(orbit.configuration[:, 2, 3] - np.abs(ahead - orbit.time)).max() < 1e-12


def test_which_groups_are_left() -> None:
    """Those of a form, alone or as a factor; rotations, motions, translations, and what has no form, are not."""
    shear = nh.MatrixGroup([np.eye(2, k=1)])
    for group in (BOOSTS, WIDE, nh.ProductGroup(nh.SO(3), nh.ProductGroup(shear, BOOSTS))):
        assert group.has_drift
    for group in (nh.SO(3), nh.SO(5), nh.SE(2), nh.SE(4), nh.Translations(2), shear):
        assert not group.has_drift
        assert not nh.ProductGroup(group, group).has_drift
    poses = np.tile(np.eye(4), (2, 5, 1, 1))
    poses[1, 3:, 2:, 2:] *= 1 + 1e-8
    assert nh.ProductGroup(shear, BOOSTS).leading_elements(poses).tolist() == [5, 3]
    assert nh.ProductGroup(nh.SO(2), nh.SO(2)).leading_elements(np.ones((3, 4, 4, 4))).tolist() == [4, 4, 4]
    assert nh.ProductGroup(BOOSTS, shear).leading_elements(poses).tolist() == [5, 5]
