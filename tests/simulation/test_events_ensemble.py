"""Events in ensembles: each member has what `simulate` finds for it alone."""

import numpy as np
import pytest
from comparisons import assert_same

import nonholo as nh
from nonholo.simulation.members import _ensemble

SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
TOP = nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 0.1)
ROWS = {"restricted_velocity": np.random.default_rng(3).normal(size=(9, 2)) * (1.5, 3.0)}
TILT = nh.Event(lambda orbit: orbit.configuration[:, 0, 0], name="tilt")
SIDE = nh.Event(lambda orbit: np.sin(orbit.heading), direction=1, name="side", stop=2)


def alone(batch: nh.Ensemble, member: int, events: list[nh.Event], **run: object) -> nh.Orbit:
    """The run of one member by itself."""
    start = {"restricted_velocity": ROWS["restricted_velocity"][member]}
    return nh.simulate(batch.members.of(member), **start, steps=120, throw=False, events=events, **run)  # type: ignore


CASES = {
    "sleighs": (SLEIGH, [SIDE, nh.cusp], {}),
    "sleighs that differ": (SLEIGH, [nh.cusp, SIDE], {"a": np.linspace(0.1, 0.9, 9), "time_step": np.full(9, 0.05)}),
    "tops": (TOP, [TILT], {}),
    "tops, order 4": (nh.discretize(TOP.system, 0.1, order=4), [TILT], {}),
}


@pytest.mark.profile("routes", keep=["None-tops", "7-tops, order 4", "1-sleighs"])
@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("every", [None, 1, 7])
def test_members_have_the_crossings_of_their_own_runs(name: str, every: int | None) -> None:
    """Number, first and last crossing, kept states and the end of each member are those of its own run, to rounding."""
    discrete, events, parameters = CASES[name]
    batch = nh.ensemble(discrete, **ROWS, steps=120, save_every=every, parameters=parameters or None, events=events)
    assert sum(int(found.count.sum()) for found in batch.events.found) > 5
    for member in range(len(batch)):
        orbit = alone(batch, member, events, save_every=every or 1)
        for event, found in zip(batch.events.found, orbit.events.found, strict=True):
            assert event.count[member] == len(found)
            for states, which in ((event.first, 0), (event.last, -1)):
                if len(found):
                    assert abs(states.time[member, 0] - found.time[which]) < 1e-12
                    assert np.abs(states.pose[member, 0] - found.states.pose[which]).max() < 1e-12
                else:
                    assert np.isnan(states.time[member]).all()
        kept = batch.orbit(member)
        assert np.abs(kept.pose - (orbit.pose[-1:] if every is None else orbit.pose)).max() < 1e-12  # of some 10
        name_of = orbit.events.stopped_by
        assert batch.events.stopped_by[member] == (-1 if name_of is None else [e.name for e in events].index(name_of))


@pytest.mark.parametrize("every", [None, 1, 7])
@pytest.mark.parametrize("discrete", [SLEIGH, TOP], ids=["sleigh", "top"])
def test_events_leave_members_alone(discrete: nh.Discretization, every: int | None) -> None:
    """With and without events the states of all members are the same to the last bit."""
    run = {**ROWS, "steps": 60, "save_every": every}
    batch, plain = nh.ensemble(discrete, **run, events=[TILT]), nh.ensemble(discrete, **run)
    assert_same(batch, plain, "reduced_momentum", "cayley", "canonical_pose", "outcome", "steps_done", "time")


def test_blocks_of_members_do_not_matter(monkeypatch: pytest.MonkeyPatch) -> None:
    """Members found in small blocks, and by a reduction, are those found at once."""
    run = {**ROWS, "steps": 120, "events": [SIDE, nh.cusp]}
    whole = nh.ensemble(SLEIGH, **run)
    monkeypatch.setattr(_ensemble, "_BLOCK", 2000)
    parts = nh.ensemble(SLEIGH, **run)
    times = nh.ensemble(SLEIGH, **run, reduce=lambda block: block.events["cusp"].first.time[:, 0])
    assert np.array_equal(parts.pose, whole.pose)
    for one, other in zip(parts.events.found, whole.events.found, strict=True):
        assert np.array_equal(one.count, other.count)
        assert np.array_equal(one.last.pose, other.last.pose, equal_nan=True)
    assert np.array_equal(times, whole.events["cusp"].first.time[:, 0], equal_nan=True)


def test_later_crossings_of_the_last_step_are_left_out() -> None:
    """Of crossings in the step in which a member ends those after its end do not count, whatever their order."""
    turn = np.arctan(0.2)
    events = [
        nh.Event(lambda orbit, at=at: orbit.time - (2.0 + at), stop=stop, name=f"at_{1000 * at:.0f}")
        for at, stop in ((0.09, True), (0.02, False), (0.07, True), (0.08, False))
    ]
    batch = nh.ensemble(SLEIGH, restricted_velocity=[[turn, 1.0]], steps=50, events=events)
    assert [int(found.count[0]) for found in batch.events.found] == [0, 1, 1, 0]
    assert batch.events.stopped_by.tolist() == [2]
    assert batch.steps_done.tolist() == [20]


def test_a_stop_at_a_state_keeps_it() -> None:
    """A member that stops exactly at a state keeps that state."""
    events = [nh.Event(lambda orbit: orbit.time - 2.0, stop=True)]
    batch = nh.ensemble(SLEIGH, **ROWS, steps=50, save_every=5, events=events)
    plain = nh.ensemble(SLEIGH, **ROWS, steps=20, save_every=5)
    assert batch.steps_done.tolist() == [20] * len(batch)
    assert np.array_equal(batch.pose[:, :5], plain.pose)
    assert np.isnan(batch.pose[:, 5:]).all()


def test_members_that_fail_keep_their_crossings() -> None:
    """A member without start has no crossings; the others are not touched by it."""
    velocities = [[0.1, -1.0], [9.0, -9.0]]
    batch = nh.ensemble(SLEIGH, restricted_velocity=velocities, steps=100, events=[nh.cusp])
    assert batch.outcome.tolist() == [0, int(nh.Outcome.no_real_branch)]
    assert batch.events["cusp"].count.tolist() == [1, 0]
    assert np.isnan(batch.pose[1]).all()
