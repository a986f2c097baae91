"""Events of discrete runs: what counts as a crossing, where it is, and how a run ends there."""

import pathlib
from typing import Any

import mpmath
import numpy as np
import pytest
from comparisons import assert_joined, assert_near, assert_same
from refusals import refusals
from simulation.forces import HEAVY

import nonholo as nh
from nonholo.simulation.members import _ensemble

# A sleigh with a = 0 keeps its momenta: P_theta = J sin(theta)/h, so a step of length tau turns it by arcsin(tau w).
ROUND = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.0), 0.1)
SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
TOP = nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 0.1)
FOUR = nh.discretize(nh.SuslovTop(np.diag([1.0, 1.3, 0.8, 1.1]) + 0.1), 0.1)
MOTIONS = {
    "top": TOP,
    "top in 4 dimensions": FOUR,
    "sleigh in space": nh.discretize(nh.MultidimensionalSleigh(1.0, (0.3, 0.1, -0.2), np.eye(3)), 0.1),
    "another body frame": nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.3), 0.1),
    "general": nh.discretize(nh.LLSystem(nh.SO(3), TOP.system.mass_tensor, annihilator=[[0.1, 0.3, 1]]), 0.1),
    "right-invariant": nh.discretize(nh.VeselovaTop(TOP.system.mass_tensor), 0.1),
    "order 4": nh.discretize(nh.SuslovTop(TOP.system.mass_tensor), 0.1, order=4),
    "order 6, sleigh": nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.3), 0.1, order=6),
}  # fmt: skip
OFFSET = nh.ChaplyginSleigh(1.0, 0.75, 0.5)  # rho^2 = a^2 + J/m = 1
VELOCITY = (0.3, -1.0, 0.0)
# v_1 = E tanh(s_0 + a E t / rho), with E = hypot(rho omega, v_1) and sinh s_0 = v_1/(rho omega).
CUSP = -np.arcsinh(VELOCITY[1] / VELOCITY[0]) / (0.5 * np.hypot(*VELOCITY[:2]))
TIMES = np.linspace(0.0, 10.0, 21)
FLOW: dict[str, Any] = {"body_velocity": VELOCITY, "times": TIMES}
ROWS = {"restricted_velocity": np.random.default_rng(3).normal(size=(9, 2)) * (1.5, 3.0)}
TILT = nh.Event(lambda orbit: orbit.configuration[:, 0, 0], name="tilt")
SIDE = nh.Event(lambda orbit: np.sin(orbit.heading), direction=1, name="side", stop=2)


def start(discrete: nh.Discretization) -> np.ndarray:
    """A velocity along the constraint that suits every system here."""
    return np.linspace(1.0, -0.6, discrete.system.rank)


CIRCLE = {"body_velocity": (4.0, 1.0, 0.0)}
CIRCLE_OF_ONE = {"body_velocity": [CIRCLE["body_velocity"]]}


def circle(steps: int = 20, **options: Any) -> nh.Orbit:
    """Run the sleigh that turns on a circle."""
    return nh.simulate(ROUND, **CIRCLE, steps=steps, **options)


def east(orbit: nh.Orbit) -> np.ndarray:
    """Zero where the sleigh looks along the first axis, or back."""
    return np.sin(orbit.heading)


def test_crossing_of_the_uniform_circle_is_the_known_one() -> None:
    """The sleigh with a = 0 looks east again where arcsin(tau w) fills up the whole turns, to 1e-15 of a time of 4."""
    orbit = circle(600, events=[nh.Event(east, direction=1)])
    with mpmath.workdps(40):
        h = mpmath.mpf(float(ROUND.time_step))
        turn = mpmath.asin(4 * h)
        whole = [mpmath.floor(2 * mpmath.pi * n / turn) for n in (1, 2, 3)]
        reference = [
            float(k * h + mpmath.sin(2 * mpmath.pi * n - k * turn) / 4) for n, k in zip((1, 2, 3), whole, strict=True)
        ]
    result = orbit.events["east"]
    assert np.array_equal(result.step[:3], np.array(whole, dtype=int))
    assert np.abs(result.time[:3] - reference).max() < 4e-15  # ulps of 4.6, and of a heading of 19 over w
    assert np.abs(result.states.heading[:3] - 2 * np.pi * np.arange(1, 4)).max() < 4e-15
    assert np.abs(result.states.heading - 2 * np.pi * np.arange(1, 40)).max() < 2e-13  # ulps of 250, all stretches
    assert np.array_equal(result.step, np.floor(result.time / ROUND.time_step))


@pytest.mark.parametrize("name", MOTIONS)
def test_parts_of_steps_join_the_states(name: str) -> None:
    """A part of a step is the next state at s = 1, to rounding, and tends to the state itself, and is continuous."""
    orbit = nh.simulate(MOTIONS[name], restricted_velocity=start(MOTIONS[name]), steps=8)
    between = MOTIONS[name].after_parts
    for fraction, limit, error in ((1.0, orbit[1:], 2e-14), (1e-10, orbit[:-1], 1e-9)):
        reached = between(orbit[:-1], np.full(8, fraction))
        assert_near(reached, limit, error, "momentum", "configuration", "displacement", "body_velocity")


def test_a_part_of_a_step_is_a_shorter_step() -> None:
    """Half a step of a top is the step of half the length from the same momentum along the constraint."""
    orbit = nh.simulate(TOP, restricted_velocity=(0.7, -0.3), steps=5)
    half = TOP.after_parts(orbit[4:5], np.array([0.5]))
    shorter = nh.discretize(TOP.system, TOP.time_step / 2)
    step = nh.simulate(shorter, momentum=orbit.restricted_momentum[4], configuration=orbit.configuration[4], steps=1)
    assert np.abs(half.restricted_momentum[0] - step.restricted_momentum[1]).max() < 1e-15
    assert np.abs(half.configuration[0] - step.configuration[1]).max() < 1e-15


@pytest.mark.profile("routes", keep=["jax"])
@pytest.mark.parametrize("options", [{"difference": "logarithmic"}, {"backend": "jax"}], ids=["logarithmic", "jax"])
def test_runs_by_the_definition_find_the_same(options: dict[str, str]) -> None:
    """The crossing lies where the function is zero to rounding, and the run ends there."""
    run = {"restricted_velocity": (0.7, -0.3), "steps": 40, "save_every": 3}
    discrete = nh.discretize(TOP.system, 0.1, difference=options.pop("difference", "matrix"))
    event = nh.Event(lambda orbit: orbit.configuration[:, 0, 0] - 0.8, stop=True, name="e")
    orbit = nh.simulate(discrete, **run, **options, events=[event])
    plain = nh.simulate(discrete, **run, **options)[: len(orbit)]
    assert orbit.events.stopped_by == "e"
    assert np.abs(event.function(orbit.events[0].states)).max() < 2e-16
    assert orbit.time[-1] <= orbit.events[0].time[0] <= orbit.time[-1] + 0.3
    assert np.array_equal(orbit.pose, plain.pose)


def test_direction() -> None:
    """Crossings from below and from above together are those in both directions, each marked with its own."""
    both, up, down = (circle(60, events=[nh.Event(east, direction=d)]).events[0] for d in (0, 1, -1))
    assert np.array_equal(both.time, np.sort(np.concatenate([up.time, down.time])))
    assert both.direction.tolist() == [-1, 1, -1, 1, -1, 1, -1]
    assert set(up.direction) == {1}
    assert set(down.direction) == {-1}


@pytest.mark.parametrize("every", [1, 4])
def test_stop_keeps_what_is_before(every: int) -> None:
    """A run that stops at the second crossing ends with the saved state before it, and is successful."""
    orbit, whole = circle(10**9, save_every=every, events=[nh.Event(east, stop=2)]), circle(15, save_every=every)
    assert orbit.outcome == nh.Outcome.successful
    assert orbit.events.stopped_by == "east"
    assert orbit.events["east"].step[-1] == 15
    assert np.array_equal(orbit.pose, whole.pose)


def test_the_first_of_two_stops_in_one_step_counts() -> None:
    """Of crossings in one step those up to the one that ends the run are kept, in order of time, of members too."""
    turn = float(np.arcsin(0.4))
    events = [
        nh.Event(lambda orbit, at=at: orbit.heading - (20 + at / 10) * turn, stop=stop, name=f"at_{at}")
        for at, stop in ((9, True), (2, False), (7, True), (5, False), (8, False))
    ]
    result, batch = circle(100, events=events).events, nh.ensemble(ROUND, **CIRCLE_OF_ONE, steps=100, events=events)
    assert [len(crossings) for crossings in result.found] == [0, 1, 1, 1, 0]
    assert [int(crossings.count[0]) for crossings in batch.events.found] == [0, 1, 1, 1, 0]
    assert result.stopped_by == "at_7"
    assert (batch.events.stopped_by.tolist(), batch.steps_done.tolist()) == ([2], [20])
    assert result["at_2"].time < result["at_5"].time < result["at_7"].time


def test_zero_at_a_state_counts_once() -> None:
    """A function that is exactly zero at a saved state has one crossing, that state, also if it only touches zero."""
    plain = circle()
    through, touch = (nh.Event(lambda orbit, n=n: (orbit.time - plain.time[9]) ** n, name=f"power_{n}") for n in (1, 2))
    result = circle(events=[through, touch]).events
    for crossings in result.found:
        assert (crossings.step.tolist(), crossings.fraction.tolist()) == ([9], [0.0])
        assert np.array_equal(crossings.states.pose, plain.pose[9:10])


def test_states_between_stretches_keep_their_value() -> None:
    """A state that is the last of a stretch and the first of the next one has one value, whatever the function says."""

    def wavering(orbit: nh.Orbit) -> np.ndarray:
        values = orbit.time - 25.6
        at = np.flatnonzero(np.abs(values) < 0.05)
        values[at] = np.where(at == 0, -1e-16, 1e-16)  # products of matrices can have other last bits in other company
        return values

    assert len(circle(600, events=[wavering]).events[0]) == 1


def test_a_stop_at_a_state_keeps_it() -> None:
    """A run that stops exactly at a state keeps that state, and so does a member."""
    assert circle(events=[nh.Event(lambda orbit: 0.5 - orbit.time, 0, True)]).time[-1] == 0.5
    events = [nh.Event(lambda orbit: orbit.time - 2.0, stop=True)]
    batch = nh.ensemble(SLEIGH, **ROWS, steps=50, save_every=5, events=events)
    plain = nh.ensemble(SLEIGH, **ROWS, steps=20, save_every=5)
    assert batch.steps_done.tolist() == [20] * len(batch)
    assert np.array_equal(batch.pose[:, :5], plain.pose)
    assert np.isnan(batch.pose[:, 5:]).all()


def test_staying_at_zero_is_no_crossing() -> None:
    """An equilibrium, where v_1 and omega are constant, and a run that starts at zero, have no crossings."""
    run = {"body_velocity": (0.0, 1.0, 0.0), "steps": 50}
    events = [lambda orbit: orbit.body_velocity[:, 0], lambda orbit: orbit.time]
    assert [len(result) for result in nh.simulate(SLEIGH, **run, events=events).events.found] == [0, 0]


def test_headings_of_events_know_full_turns() -> None:
    """Blocks of a long run, and states in a step, continue the heading: it crosses 3000 turns once."""
    far = nh.Event(lambda orbit: orbit.heading - 6000 * np.pi, name="far")
    result = circle(50_000, save_every=10_000, events=[far]).events["far"]
    assert len(result) == 1
    assert abs(result.time[0] - 0.1 * 6000 * np.pi / np.arcsin(0.4)) < 0.1


@pytest.mark.parametrize(("block_steps", "stop"), [(20, 9), (5, 9), (5, False)])
def test_blocks_of_a_run_hold_its_crossings(block_steps: int, stop: int) -> None:
    """Blocks, of one state each too, have states and crossings of the run, and end with the one that a stop ends."""
    run: dict[str, Any] = {"events": [nh.Event(east, stop=stop)], "save_every": 5}
    whole = circle(200, **run)
    blocks = list(nh.iterate(ROUND, **CIRCLE, steps=200, **run, block_steps=block_steps))
    assert np.array_equal(np.concatenate([block.events["east"].time for block in blocks]), whole.events["east"].time)
    assert_joined(blocks, whole)
    assert [block.events.stopped_by for block in blocks] == [None] * (len(blocks) - 1) + [whole.events.stopped_by]


def test_a_stored_run_without_start_has_no_crossings(tmp_path: pathlib.Path) -> None:
    """A start beyond the fold gives an orbit of no states and crossings, and no store."""
    beyond = {"body_velocity": (40.0, 0.0, 0.0), "steps": 3, "throw": False, "store": tmp_path / "run.zarr"}
    orbit = nh.simulate(nh.discretize(TOP.system, 1.0), **beyond, events=[lambda orbit: orbit.time - 1.0])
    assert (len(orbit), orbit.outcome, len(orbit.events[0])) == (0, nh.Outcome.no_real_branch, 0)
    assert not list(tmp_path.iterdir())


def test_cusp_of_the_discrete_sleigh_tends_to_the_continuous_one() -> None:
    """A backward sleigh turns round once; the time of its cusp has an error of second order in h."""
    errors = []
    for h in (0.1, 0.05, 0.025):
        run = nh.simulate(nh.discretize(OFFSET, h), body_velocity=VELOCITY, steps=int(20 / h), events=[nh.cusp])
        assert len(run.events["cusp"]) == 1
        errors.append(abs(run.events["cusp"].time[0] - CUSP))
    assert np.abs(np.log2(np.divide(errors[:-1], errors[1:])) - 2).max() < 0.05


# A function must give one finite real number for each state; the error names it and what it gave.
test_functions_that_give_no_number_are_refused = refusals(
    (lambda orbit: orbit.body_velocity, r"one real number for each of 1 states. Got float64 of shape \(1, 3\)"),
    (lambda _: 1.0, r"of shape \(\)"),
    (lambda orbit: orbit.time > 1, "bool of shape"),
    (lambda orbit: np.where(orbit.time > 1.05, np.nan, 1.0), "nan from `<lambda>` at time 1.1"),
    (lambda orbit: orbit.altitude, "AttributeError"),
    ask=lambda function: circle(events=[function]),
    begin=r"(?s)(?=.*event 0).*",
)


_ALONG: dict[str, Any] = {"restricted_velocity": (0.7, -0.3), "steps": 5}
_FALLING = nh.discretize(nh.Forced(TOP.system, HEAVY), 0.1)
_WITHOUT, _THINNED = {"reconstruct": False}, "one with steps left out"
# What cannot be watched is refused before any work, orbits with states left out too.
test_what_cannot_be_watched_is_refused = refusals(
    (lambda: nh.simulate(SLEIGH, **CIRCLE, steps=20, events=east), "be a list"),
    (lambda: nh.simulate(SLEIGH, **CIRCLE, steps=20, events=[3]), "be a function"),
    (lambda: nh.simulate(SLEIGH, **CIRCLE, steps=20, events=[east, east]), "different names"),
    (lambda: nh.simulate(SLEIGH, **CIRCLE, steps=20, events=[east], branch="smallest"), "principal branch"),
    (lambda: nh.simulate(MOTIONS["right-invariant"], **_ALONG, **_WITHOUT, events=[east]), "reconstruct=True"),
    (
        lambda: nh.simulate(_FALLING, **_ALONG, **_WITHOUT, events=[nh.cusp]),
        "a step that depends on the pose, without r",
    ),
    (lambda: circle(**_WITHOUT, events=[east]), "reconstruct=True"),
    (lambda: nh.simulate(TOP, **_ALONG, events=[nh.cusp]), "watch a sleigh"),
    (lambda: nh.flow(OFFSET, **FLOW, events=[lambda o: o.displacement[:, 0, 0]]), "displacement.*needs a discrete"),
    (lambda: nh.Event(east, direction=2), "Event"),
    (lambda: nh.Event(east, direction=True), r"Event\(direction=...\)` must be one of"),
    (lambda: nh.Event(east, stop=0.5), "Event"),
    (lambda: nh.Event(east, stop=0), "positive integer"),
    (lambda: nh.crossings(circle()[::2], east), _THINNED),
    (lambda: nh.crossings(circle().chosen(np.arange(21) != 5), east), _THINNED),
)


def test_wide_tops_need_no_poses() -> None:
    """A top in many dimensions without poses has events of its momenta, located as those of others."""
    top = nh.SuslovTop.arrowhead(np.linspace(1, 2, 300), np.full(299, 1e-2))
    run = {"restricted_velocity": np.random.default_rng(0).normal(size=299) * 0.05, "steps": 50}
    middle = nh.simulate(nh.discretize(top, 0.1), **run, reconstruct=False).restricted_momentum[[0, -1], 0].mean()
    event = nh.Event(lambda orbit: orbit.restricted_momentum[:, 0] - middle)
    result = nh.simulate(nh.discretize(top, 0.1), **run, reconstruct=False, events=[event]).events[0]
    assert len(result) == 1
    assert abs(event.function(result.states)[0]) < 1e-16


@pytest.mark.parametrize("method", ["closed_form", None])
def test_cusp_of_the_sleigh_is_where_the_closed_form_says(method: str | None) -> None:
    """A backward sleigh turns round once, at the time where tanh is zero; numerically as exact as the tolerances."""
    result = nh.flow(OFFSET, **FLOW, method=method, rtol=1e-13, atol=1e-14, events=[nh.cusp]).events["cusp"]
    assert len(result) == 1
    assert result.step.tolist() == [int(np.searchsorted(TIMES, CUSP)) - 1]
    assert abs(result.time[0] - CUSP) < 4e-15 if method else abs(result.time[0] - CUSP) < 1e-12
    assert abs(result.states.body_velocity[0, 1]) < 1e-15


def test_events_leave_the_flow_alone() -> None:
    """With and without events the states are the same to the last bit; a stopping event cuts them."""
    stop = nh.Event(lambda orbit: orbit.time - 3.2, stop=True, name="t")
    plain, stopped = (nh.flow(OFFSET, **FLOW, events=events) for events in (None, [stop]))
    assert stopped.events.stopped_by == "t"
    assert len(stopped) == 7
    assert np.array_equal(stopped.pose, plain.pose[:7])
    assert np.array_equal(stopped.heading, plain.heading[:7])


@pytest.mark.parametrize("method", ["closed_form", None])
def test_full_turns_between_two_times_are_known(method: str | None) -> None:
    """A heading of three turns is crossed within one interval of four turns, where the closed form has it."""
    spin = nh.ChaplyginSleigh(1.0, 0.75, 0.0)
    flow = {"body_velocity": (1.0, 0.5, 0.0), "times": (0.0, 4.0, 4.0 + 8 * np.pi), "method": method, "rtol": 1e-13}
    result = nh.flow(spin, **flow, events=[lambda orbit: orbit.heading - 6 * np.pi]).events[0]
    assert result.step.tolist() == [1]
    assert abs(result.time[0] - 6 * np.pi) < 1e-11  # some 100 solver steps of relative error 1e-13


def test_backward_flow() -> None:
    """Run backwards from after the cusp the flow finds it again, in the other direction."""
    after = nh.flow(OFFSET, **FLOW, method="closed_form")
    back: dict[str, Any] = {"body_velocity": after.body_velocity[-1], "times": TIMES[::-1], "method": "closed_form"}
    result = nh.flow(OFFSET, **back, events=[nh.cusp]).events["cusp"]
    assert result.direction.tolist() == [-1]
    assert abs(result.time[0] - CUSP) < 1e-14 * 10 * np.exp(5)  # errors of the state grow backwards as e^(aEt)


def test_a_flow_that_stops_in_time_does_not_fail() -> None:
    """An event before the time at which the solver gives up ends the orbit successfully."""
    flow = {"restricted_velocity": (1e140, 2e140), "rtol": 1e-14, "atol": 1e-300}
    times = (0.0, 1e-141, 2e-141, 1.0)
    with pytest.raises(nh.OutcomeError, match="not_converged") as caught:
        nh.flow(TOP.system, **flow, times=times, events=[lambda orbit: orbit.time - 5e-142])
    assert len(caught.value.orbit.events[0]) == 1
    orbit = nh.flow(TOP.system, **flow, times=times, events=[nh.Event(lambda orbit: orbit.time - 1.5e-141, stop=True)])
    assert (orbit.outcome, len(orbit)) == (nh.Outcome.successful, 2)


def test_events_between_requested_times_are_seen() -> None:
    """Every step of the series is looked at: a sine of time, between two times and between many."""
    top = nh.SuslovTop.from_inertia(np.diag([3.0, 2.0, 2.5]), axis=(0, 0, 1))
    for times in ((0.0, 100.0), np.linspace(0.0, 100.0, 300)):
        orbit = nh.flow(top, restricted_velocity=(0.4, 0.9), times=times, events=[lambda orbit: np.sin(orbit.time)])
        result = orbit.events[0]
        assert np.abs(result.time - np.pi * np.arange(1, 32)).max() <= 1e-13
        begin, gap = orbit.time[result.step], orbit.time[result.step + 1] - orbit.time[result.step]
        assert np.abs(begin + result.fraction * gap - result.time).max() <= 1e-13
    fifth = nh.Event(lambda orbit: np.sin(orbit.time), stop=5)
    orbit = nh.flow(top, restricted_velocity=(0.4, 0.9), times=(0.0, 1.0, 15.0, 16.0, 17.0), events=[fifth])
    assert orbit.time.tolist() == [0.0, 1.0, 15.0]
    assert orbit.events[0].step.tolist() == [1, 1, 1, 1, 2]


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
    assert sum(int(result.count.sum()) for result in batch.events.found) > 5
    for member in range(len(batch)):
        start = {"restricted_velocity": ROWS["restricted_velocity"][member], "save_every": every or 1}
        orbit = nh.simulate(batch.members.of(member), **start, steps=120, throw=False, events=events)
        for event, result in zip(batch.events.found, orbit.events.found, strict=True):
            assert event.count[member] == len(result)
            for states, which in ((event.first, 0), (event.last, -1)):
                if len(result):
                    assert abs(states.time[member, 0] - result.time[which]) < 1e-12
                    assert np.abs(states.pose[member, 0] - result.states.pose[which]).max() < 1e-12
                else:
                    assert np.isnan(states.time[member]).all()
        own = batch.orbit(member)
        assert np.abs(own.pose - (orbit.pose[-1:] if every is None else orbit.pose)).max() < 1e-12  # of some 10
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


def test_members_that_fail_keep_their_crossings() -> None:
    """A member without start has no crossings; the others are not touched by it."""
    velocities = [[0.1, -1.0], [9.0, -9.0]]
    batch = nh.ensemble(SLEIGH, restricted_velocity=velocities, steps=100, events=[nh.cusp])
    assert batch.outcome.tolist() == [0, int(nh.Outcome.no_real_branch)]
    assert batch.events["cusp"].count.tolist() == [1, 0]
    assert np.isnan(batch.pose[1]).all()
