"""Impacts: the reflection, the parts of the steps around it, times and places that are known, and how a run ends."""

import dataclasses
import itertools
import pathlib
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from comparisons import assert_near, assert_same, assert_same_run
from refusals import refusals
from scipy.optimize import brentq

import nonholo as nh

BALANCED = nh.ChaplyginSleigh(1.0, 0.5, 0.0)
SLEIGH = nh.ChaplyginSleigh(1.0, 0.5, 0.3, 0.1)
DISK = nh.RigidBody.from_inertia(1.0, 0.5, (0.0, 0.0), nh.SE(2))
TOP = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
BODY = nh.RigidBody.from_inertia(1.0, np.diag([0.5, 0.4, 0.3]), (0.1, 0.0, 0.2), nh.SE(3))
FALLING = nh.Forced(DISK, nh.Gravity([0.0, -1.0], [0.0, 0.0]))
SIDES = {"east": (1.0, 0.0), "west": (-1.0, 0.0), "north": (0.0, 1.0), "south": (0.0, -1.0)}


def wall(name: str, outward: Any, distance: float = 1.0, **how: Any) -> nh.Event:
    """A wall that stops the reference point, at a distance from the origin; options of its event and its impact."""
    n = np.array(outward)
    reset = nh.Impact(how.pop("normal", -n), how.pop("restitution", 1.0))
    return nh.Event(lambda states: distance - states.position @ n, name=name, reset=reset, **how)


def box(**impact: Any) -> list[nh.Event]:
    """A square of side 2 about the origin."""
    return [wall(name, n, **impact) for name, n in SIDES.items()]


ROUND = nh.Event(lambda states: 1 - (states.position**2).sum(axis=1), name="round", reset=nh.Impact())
SPACE = [wall(f"w{k}", n) for k, n in enumerate(np.concatenate([np.eye(3), -np.eye(3)]))]


def tip(**impact: Any) -> nh.Event:
    """A floor for the tip of the third axis of a top."""
    return nh.Event(lambda states: states.configuration[:, 2, 2] - 0.3, name="tip", reset=nh.Impact(**impact))


def folded(way: np.ndarray) -> np.ndarray:
    """Where a point is that has gone a way from the origin, to and fro between -1 and 1."""
    return 1 - abs((way + 1) % 4 - 2)


Motions = dict[str, tuple[Any, dict[str, Any], list[nh.Event]]]
MOTIONS: Motions = {
    "sleigh in a square": (SLEIGH, {"restricted_velocity": (0.3, 1.0)}, box()),
    "sleigh in a circle": (SLEIGH, {"restricted_velocity": (0.3, 1.0)}, [ROUND]),
    "top": (TOP, {"body_velocity": (0.4, 0.9, 0.0)}, [tip()]),
    "body in a cube": (BODY, {"body_velocity": (0.3, 0.5, 1.0, 0.4, 1.0, 0.2)}, SPACE),
    "sleigh in space": (
        nh.MultidimensionalSleigh(1.0, (0.3, 0.1, -0.2), np.eye(3)), {"restricted_velocity": (0.3, 0.5, 1.0)}, SPACE
    ),
}  # fmt: skip
FIXED: Motions = {"right-invariant": (nh.VeselovaTop(TOP.mass_tensor), {"momentum": (0.4, 0.9)}, [tip()])}


@pytest.mark.parametrize("bounce", [1.0, 0.6, 0.0])
@pytest.mark.parametrize("name", [*MOTIONS, *FIXED])
def test_reflection_is_that_of_the_impulses(name: str, bounce: float) -> None:
    """That of impulses of wall and constraint at full inertia: I(w' - w) = jn + A'l, Aw' = 0, nw' = -e nw."""
    system, start, _ = (MOTIONS | FIXED)[name]
    rng = np.random.default_rng(7)
    orbit = nh.simulate(nh.discretize(system, 0.05), steps=3, **start)[3:]
    n = rng.normal(size=system.group.dim) * np.sign(rng.normal())
    reset = nh.Impact(lambda _: n, bounce)
    inertia, A = system.inertia_operator, system.annihilator @ system.carried(orbit.configuration[0])
    before = orbit.body_velocity[0]
    after = reset.struck("", None, orbit, int(np.sign(n @ before)))
    assert after is not None
    s, dim = len(A), len(n)
    matrix = np.block([
        [inertia, -n[:, None], -A.T], [A, np.zeros((s, 1 + s))], [n[None], np.zeros((1, 1 + s))]
    ])  # fmt: skip
    wanted = np.linalg.solve(matrix, np.concatenate([inertia @ before, np.zeros(s), [-bounce * (n @ before)]]))[:dim]
    assert np.abs(after.body_velocity[0] - wanted).max() < 1e-13 * np.linalg.cond(matrix)
    if bounce == 1:
        assert abs(after.energy[0] / orbit.energy[0] - 1) < 4e-15


@pytest.mark.parametrize("name", [*MOTIONS, *FIXED])
def test_normals_of_all_kinds_are_one(name: str) -> None:
    """The derivative by differences is that of a spatial vector at a body point, and of a function."""
    system, start, _ = (MOTIONS | FIXED)[name]
    size = system.group.size - system.group.is_affine
    rng = np.random.default_rng(3)
    normal, point = rng.normal(size=(2, size))
    lifted = np.append(point, [1.0] * system.group.is_affine)

    def gap(states: nh.Orbit) -> np.ndarray:
        return 0.3 + (states.configuration @ lifted)[:, :size] @ normal

    def covector(g: np.ndarray) -> np.ndarray:
        return (g @ system.group.basis @ lifted)[:, :size] @ normal

    for states in nh.simulate(nh.discretize(system, 0.3), steps=5, **start), nh.flow(system, times=(0, 1), **start):
        for k in range(len(states)):
            state = states.chosen(slice(k, k + 1))
            reference = nh.Impact(normal, point=point).covector(gap, state)
            assert np.abs(reference - covector(state.configuration[0])).max() < 1e-14
            assert np.abs(reference - nh.Impact(covector).covector(gap, state)).max() < 1e-14
            assert np.abs(reference - nh.Impact().covector(gap, state)).max() < 2e-11


@pytest.mark.parametrize("size", 2.0 ** np.array([-40, -20, 0, 20, 40]))
def test_normals_of_curved_walls_are_exact_in_every_unit_of_length(size: float) -> None:
    """In a circle, an ellipse and a sphere, and at a post that touches the body anywhere, to 1e-11 of the normal."""
    point, far, axes = np.array([0.2, 0.1]) * size, np.array([-9.0, 4.0]) * size, np.array([1.3, 0.7]) * size
    body = nh.RigidBody.from_inertia(1.0, 0.3 * size**2, (0.0, 0.0), nh.SE(2))
    there = nh.SE(2).exp(np.array([0.7, 0.6 * size, 0.3 * size]))
    state = nh.simulate(nh.discretize(body, 0.1), steps=1, configuration=there, body_velocity=np.ones(3))[:1]

    def place(states: nh.Orbit) -> np.ndarray:
        return states.configuration[:, :2] @ np.append(point, 1.0)

    (at,), turned = place(state), state.configuration[0, :2, :2]
    for gap, slope in (
        (lambda states: size - np.hypot(*place(states).T), -at / np.hypot(*at)),
        (lambda states: np.hypot(*(place(states) - far).T) - size, (at - far) / np.hypot(*(at - far))),
        (lambda states: 1 - (place(states) ** 2 / axes**2).sum(axis=1), -2 * at / axes**2),
        (lambda states: np.sqrt(2 * size**2 - (place(states) ** 2).sum(axis=1)), -at / np.sqrt(2 * size**2 - at @ at)),
    ):
        along = slope @ turned
        wanted = np.append(along @ (-point[1], point[0]), along)
        off = np.abs(nh.Impact().covector(gap, state) - wanted) / np.array([size, 1.0, 1.0])
        assert off.max() < 1e-11 * np.linalg.norm(along)
    there = nh.SE(3).exp(np.array([0.7, 0.2, 0.1, 0.6 * size, 0.3 * size, 0.1 * size]))
    state = nh.simulate(nh.discretize(BODY, 0.1), steps=1, momentum=np.ones(6), configuration=there)[:1]
    normal = nh.Impact().covector(lambda states: size - np.linalg.norm(states.position, axis=1), state)
    center = -state.position[0] / np.linalg.norm(state.position[0]) @ state.configuration[0, :3, :3]
    assert np.abs(normal - np.append(np.zeros(3), center)).max() < 1e-11


def test_impacts_are_values() -> None:
    """An impact with another restitution has the same normal, whatever kind that is."""
    for arguments in (nh.Impact(), nh.Impact((0.0, 1.0), point=(0.3, 0.0)), nh.Impact(np.cos)):
        other = dataclasses.replace(arguments, restitution=0.5)
        assert other.restitution == 0.5
        assert np.array_equal(other.normal, arguments.normal)
        assert np.array_equal(other.point, arguments.point)


@pytest.mark.profile("routes", keep=["2-sleigh in a square", "2-top"])
@pytest.mark.parametrize("name", MOTIONS)
@pytest.mark.parametrize("order", [2, 4])
def test_energy_is_kept_over_impacts(name: str, order: int) -> None:
    """The kinetic energy of an elastic billiard is the same to 1e-13, and the body stays inside."""
    system, start, walls = MOTIONS[name]
    orbit = nh.simulate(nh.discretize(system, 0.1, order=order), steps=1000, events=walls, **start)
    hits = [orbit.events[event] for event in orbit.events]
    assert sum(map(len, hits)) > 20
    assert np.abs(orbit.energy / orbit.energy[0] - 1).max() < 1e-13
    assert all(np.abs(hit.after.energy / orbit.energy[0] - 1).max(initial=0) < 1e-13 for hit in hits)
    assert min(event.function(orbit).min() for event in walls) > -1e-14


@pytest.mark.profile("routes", keep=["top", "right-invariant", "sleigh in a circle"])
@pytest.mark.parametrize("name", [*MOTIONS, *FIXED])
def test_impacts_are_roots_of_the_parts_of_steps(name: str) -> None:
    """Times are those of another root finder; the state after the step is the other part of it, from the reflection."""
    system, start, walls = (MOTIONS | FIXED)[name]
    discrete = nh.discretize(system, 0.1)
    orbit = nh.simulate(discrete, steps=400, events=walls, **start)
    steps = np.concatenate([orbit.events[event].step for event in orbit.events])
    count = 0
    for wall in walls:
        for k, step in enumerate(orbit.events[wall.name].step):
            hit, node = orbit.events[wall.name].chosen(slice(k, k + 1)), orbit.chosen(slice(step, step + 1))
            if (steps == step).sum() > 1:
                continue
            count += 1
            gap = lambda s: wall.function(discrete.after_parts(node, np.array([s])))[0]  # noqa: B023, E731
            assert abs(brentq(gap, 1e-9, 1.0, xtol=1e-16) - hit.fraction[0]) < 1e-13
            assert abs(wall.function(hit.states)[0]) < 1e-15
            assert abs(wall.function(hit.after)[0]) < 1e-15
            ahead, after = discrete.after_parts(hit.after, 1 - hit.fraction), orbit.chosen(slice(step + 1, step + 2))
            assert_near(ahead, after, 1e-15, "reduced_momentum", "configuration")
    assert count > 5


def test_straight_motions_are_the_known_ones() -> None:
    """A knife edge across a box and a turning disk on a slant: to and fro, to rounding of the way that was gone."""
    orbit = nh.simulate(nh.discretize(BALANCED, 0.1), body_velocity=(0, 0.73, 0), steps=1000, events=box())
    assert np.abs(orbit.position - np.stack([folded(0.73 * orbit.time), 0 * orbit.time], axis=1)).max() < 1e-13
    hits = orbit.events["east"]
    assert np.abs(hits.time - (1 + 4 * np.arange(len(hits))) / 0.73).max() < 1e-13
    assert np.array_equal(hits.after.body_velocity, -hits.states.body_velocity)
    orbit = nh.simulate(nh.discretize(DISK, 0.1), body_velocity=(0.4, 0.73, 0.31), steps=1000, events=box())
    assert np.abs(orbit.position - folded(orbit.time[:, None] * [0.73, 0.31])).max() < 4e-13
    assert [len(orbit.events[side]) for side in SIDES] == [18, 18, 8, 8]


@pytest.mark.profile("routes", cases=["1.7-*"])
@pytest.mark.parametrize(("step", "speed"), [(0.1, (0.7, 0.7)), (0.125, (1, 1)), (0.25, (1, -2)), (1.7, (5.1, 3.3))])
def test_corners_nodes_and_many_impacts_in_a_step(step: float, speed: tuple[float, float]) -> None:
    """Two walls at once, at a node or in a step; walls at nodes; 7 impacts in a step: places are the known ones."""
    disk = nh.discretize(DISK, step)
    orbit = nh.simulate(disk, body_velocity=(0.0, *speed), steps=25, events=box())
    way = orbit.time[:, None] * speed
    assert np.abs(orbit.position - folded(way)).max() < 1e-14 * np.abs(way).max()
    assert np.abs(orbit.energy / orbit.energy[0] - 1).max() < 2e-14


def test_impacts_converge_to_those_of_the_flow() -> None:
    """Times of impacts and places of the map differ from those of the flow by an error of order 2."""
    start: dict[str, Any] = {"restricted_velocity": (0.3, 1.0), "events": box()}
    flow = nh.flow(SLEIGH, times=np.linspace(0, 8, 41), **start)
    errors = []
    for every in (8, 16, 32):
        orbit = nh.simulate(nh.discretize(SLEIGH, 0.2 / every), steps=40 * every, save_every=every, **start)
        assert [len(orbit.events[side]) for side in SIDES] == [len(flow.events[side]) for side in SIDES]
        moments = [np.abs(orbit.events[side].time - flow.events[side].time).max(initial=0) for side in SIDES]
        errors.append((np.abs(orbit.position - flow.position).max(), max(moments)))
    assert sum(len(flow.events[side]) for side in SIDES) == 4
    assert np.abs(np.log2(np.divide(errors[:-1], errors[1:])) - 2).max() < 0.02
    assert np.ptp(flow.energy) < 1e-13


@pytest.mark.profile("routes", keep=["None"])
@pytest.mark.parametrize("method", [None, "closed_form"])
def test_flows_go_on_at_impacts(method: Any) -> None:
    """Between impacts a flow is the one from the reflected state; `at` knows it; times asked for make no difference."""
    start: dict[str, Any] = {"restricted_velocity": (0.3, 1.0), "events": [ROUND], "method": method}
    flow, fine = (nh.flow(SLEIGH, times=np.linspace(0, 10, count), **start) for count in (6, 101))
    hits = flow.events["round"]
    assert len(hits) == 5
    assert np.abs(hits.time - fine.events["round"].time).max() < 1e-12
    assert np.abs(flow.position - fine.position[::20]).max() < 1e-12
    assert np.abs(flow.at(fine.time).heading - fine.heading).max() < 1e-12
    assert np.array_equal(hits.step, np.searchsorted(flow.time, hits.time, "right") - 1)
    for k, (begin, end) in enumerate(itertools.pairwise([*hits.time, 10.0])):
        times = np.linspace(begin, end, 5)[:-1]
        after = hits.after.chosen(slice(k, k + 1))
        there = {"momentum": after.restricted_momentum[0], "configuration": after.configuration[0]}
        alone = nh.flow(SLEIGH, **there, times=times)
        assert np.abs(alone.position - flow.at(times).position).max() < 1e-12
        assert np.abs(ROUND.function(after)).max() < 1e-14


def test_forced_flows_and_maps_bounce() -> None:
    """A falling disk bounces on the floor at the known times, in the map and in the flow, and its energy is kept."""
    start: dict[str, Any] = {"body_velocity": (0, 0.1, 0), "events": [wall("floor", (0, -1))]}
    orbit = nh.simulate(nh.discretize(FALLING, 0.1), steps=200, **start)
    flow = nh.flow(FALLING, times=np.linspace(0, 20, 21), **start)
    moments = np.sqrt(2) * np.arange(1, 15, 2)
    for result in orbit, flow:
        assert np.abs(result.events["floor"].time - moments).max() < 1e-11
        assert np.ptp(result.energy) < 1e-11
        assert np.abs(result.position[:, 0] - 0.1 * result.time).max() < 1e-11


@pytest.mark.profile("problems", keep=["potential0"])
@pytest.mark.parametrize("potential", [nh.Gravity([0.3, -1], [0.3, 0.1]), lambda g: ((g[:2, 2] - 0.1) ** 2).sum() / 4])
def test_energy_with_a_potential_is_kept_over_impacts(potential: Any) -> None:
    """Under the scheme that keeps T + U both parts of a step keep it, and so does the reflection."""
    heavy = nh.discretize(nh.Forced(SLEIGH, potential, scheme="energy"), 0.1)
    orbit = nh.simulate(heavy, restricted_velocity=(0.3, 1.4), steps=120, events=box())
    assert sum(len(orbit.events[side]) for side in SIDES) >= 5
    assert np.ptp(orbit.energy) < 1e-13 * np.abs(orbit.energy).max()


@pytest.mark.parametrize("bounce", [0.5, 0.9])
def test_restitution_scales_the_normal_velocity(bounce: float) -> None:
    """Each impact leaves that share of the velocity toward the wall, and of the energy its square."""
    walls = box(restitution=bounce)
    hits = nh.simulate(nh.discretize(BALANCED, 0.1), body_velocity=(0, 1.0, 0), steps=400, events=walls).events["east"]
    assert len(hits) > 1
    assert np.abs(hits.after.body_velocity + bounce * hits.states.body_velocity).max() < 1e-15
    disk = nh.simulate(nh.discretize(DISK, 0.1), body_velocity=(0, 1.0, 0.4), steps=60, events=walls).events
    for side, across in (("east", 0), ("north", 1)):
        before, after = (states.configuration[:, :2, :2] @ states.body_velocity[:, 1:, None]
                         for states in (disk[side].states, disk[side].after))  # fmt: skip
        assert np.abs(after[:, across] + bounce * before[:, across]).max() < 1e-15
        assert np.abs(after[:, 1 - across] - before[:, 1 - across]).max() < 1e-15


def dropped(bounce: float, step: float = 0.05, size: float = 1, unit: float = 1, lift: float = 0) -> nh.Orbit:
    """The map, or with a negative step the flow, of a disk that falls from about 1 onto a floor, in any units."""
    body = nh.RigidBody.from_inertia(1.0, 0.5 * size**2, (0.0, 0.0), nh.SE(2))
    falling = nh.Forced(body, nh.Gravity([0.0, -size / unit**2], [0.0, 0.0]))
    start: dict[str, Any] = {
        "body_velocity": (0.0, 0.1 * size / unit, 0.0),
        "configuration": nh.SE(2).exp(np.array([0.0, 0.0, lift * size])),
        "events": [wall("floor", (0, -1), size, restitution=bounce)],
    }
    if step > 0:
        return nh.simulate(nh.discretize(falling, step * unit), steps=1000, throw=False, **start)
    with pytest.raises(nh.OutcomeError, match=r"lasting_contact\. The body comes to stay at a wall") as failure:
        nh.flow(falling, times=np.linspace(0, 40, 81) * unit, **start)
    return failure.value.orbit  # type: ignore[attr-defined]


@pytest.mark.profile("problems", cases=["0.9"])
@pytest.mark.parametrize("bounce", [0.0, 0.5, 0.9])
def test_chattering_ends(bounce: float) -> None:
    """A ball that comes to rest ends the run within a step of the limit of its impacts, after few of them.

    Their number is that of bounces higher than 7e-13 of the place: with any step, in any unit, after any rounding.
    """
    limit = np.sqrt(2) * (1 + bounce) / (1 - bounce)
    wanted = 1 if bounce == 0 else np.ceil(np.log(7e-13 * max(1, 0.1 * limit)) / np.log(bounce**2))
    hows = {}, {"step": 0.173}, {"size": 2.0**18}, {"unit": 2.0**-18}, {"lift": 1e-15}, {"step": -0.5}
    for how in hows if bounce < 0.9 else hows[:2]:
        orbit = dropped(bounce, **how)
        assert orbit.outcome == nh.Outcome.lasting_contact
        assert limit - abs(how.get("step", 0.05)) <= orbit.time[-1] / how.get("unit", 1) <= limit
        assert np.all(np.diff(orbit.events["floor"].time) >= 0)
        assert len(orbit.events["floor"]) == wanted


@pytest.mark.profile("problems", keep=["60-0.07"])
@pytest.mark.parametrize("step", [0.07, 0.11])
@pytest.mark.parametrize("angle", [30, 60, 90, 120])
def test_plastic_corners_are_left_or_kept(angle: int, step: float) -> None:
    """A disk slides along a wall without restitution into a corner: two of no time each stop it, a wide one is left."""
    turn = np.radians(angle) / 2
    s, c = np.sin(turn), np.cos(turn)
    sides = [wall(f"w{k}", (s, side), s, restitution=0.0) for k, side in enumerate((c, -c))]
    for speed in (0.1, 0.04):
        start: dict[str, Any] = {"body_velocity": (0.2, 1.0, speed), "events": sides}
        orbit = nh.simulate(nh.discretize(DISK, step), steps=60, throw=False, **start)
        assert min(event.function(orbit).min() for event in sides) > -1e-13
        assert (orbit.outcome == nh.Outcome.lasting_contact) == (angle < 90)
        assert sum(len(orbit.events[each.name]) for each in sides) <= 4
        assert (orbit.body_velocity[-1, 1:] == 0).all() == (angle == 90)


HEAVY = nh.Forced(TOP, nh.Gravity([0.0, 0.0, -1.0], [0.0, 0.0, 0.5]))
ECCENTRIC = nh.RigidBody.from_inertia(1.0, 0.5, (0.1, 0.05), nh.SE(2))
PLASTIC: dict[str, tuple[Any, dict[str, Any], Callable[[nh.Orbit], np.ndarray], bool]] = {
    "falls": (FALLING, {"body_velocity": (0.7, 0.3, 0.1)}, lambda states: 1 + states.position @ (0.2, 1.0), True),
    "turns in a circle": (BODY, {"body_velocity": (0.3, 0.5, 1.0, 0.4, 1.0, 0.2)}, ROUND.function, True),
    "tips over": (HEAVY, {"body_velocity": (0.4, 0.2, 0.0)}, lambda states: states.configuration[:, 2, 2] - 0.3, True),
    "turns into it": (ECCENTRIC, {"body_velocity": (0.3, 1.0, 0.5)}, lambda states: 1 - states.position[:, 0], True),
    "slides": (DISK, {"body_velocity": (0.0, 1.0, 0.3)}, lambda states: 1 - states.position @ (0.8, 0.6), False),
    "stops": (DISK, {"body_velocity": (0.0, 0.8, 0.6)}, ROUND.function, False),
    "falls off": (FALLING, {"body_velocity": (0.3, 0.4, 1.0)}, lambda states: 0.1 - states.position[:, 1], False),
}


@pytest.mark.profile("problems", keep=["*-0.0625"])
@pytest.mark.parametrize("step", [0.0625, 0.1, 0.173])
@pytest.mark.parametrize("name", PLASTIC)
def test_a_plastic_impact_is_one(name: str, step: float) -> None:
    """Without restitution a body that is pressed stays at the wall from the first impact; another moves on."""
    system, start, gap, is_pressed = PLASTIC[name]
    events = [nh.Event(gap, name="wall", reset=nh.Impact(restitution=0.0))]
    wanted = nh.Outcome.lasting_contact if is_pressed else nh.Outcome.successful
    orbit = nh.simulate(nh.discretize(system, step), steps=40, events=events, throw=False, **start)
    flow: Any
    try:
        flow = nh.flow(system, times=np.linspace(0, 40 * step, 9), events=events, **start)
    except nh.OutcomeError as early:
        flow = early.orbit
    for result in orbit, flow:
        assert result.outcome == wanted
        assert len(result.events["wall"]) == 1
        assert gap(result).min() > -1e-13


def test_motion_is_reversed() -> None:
    """From the reversed momentum an elastic billiard leads back to its start, through the same impacts."""
    sleigh = nh.discretize(SLEIGH, 0.1)
    there = nh.simulate(sleigh, restricted_velocity=(0.3, 1.0), steps=80, events=box())
    end = {"momentum": -there.restricted_momentum[-1], "configuration": there.configuration[-1]}
    back = nh.simulate(sleigh, steps=80, events=box(), **end)
    assert sum(len(there.events[side]) for side in SIDES) == 4
    assert np.abs(back.configuration[::-1] - there.configuration).max() < 1e-12
    assert np.abs(back.restricted_momentum[::-1] + there.restricted_momentum).max() < 1e-12


@pytest.mark.profile("routes", keep=["sleigh in a square"])
@pytest.mark.parametrize("name", ["sleigh in a square", "top", "body in a cube", "disk in corners"])
def test_thinned_iterated_and_stored_runs_have_the_same_bits(name: str, tmp_path: pathlib.Path) -> None:
    """Saved states, crossings and states after impacts do not depend on how a run is cut, kept and continued.

    The disk meets two walls at once where a block ends.
    """
    system, start, walls = MOTIONS.get(name, (DISK, {"body_velocity": (0.0, 1.0, 1.0)}, box()))
    discrete, how = nh.discretize(system, 0.125), {"events": walls, **start}
    orbit = nh.simulate(discrete, steps=200, **how)
    thinned = nh.simulate(discrete, steps=200, save_every=7, **how)
    assert_same_run(orbit, thinned, 7)
    assert np.array_equal(orbit.multipliers[::7][:28], thinned.multipliers[:28], equal_nan=True)
    first, *others = nh.iterate(discrete, steps=200, block_steps=8, **how)
    nh.simulate(discrete, steps=120, store=tmp_path / "run.zarr", checkpoint_every=8, **how)
    stored = nh.extend(tmp_path / "run.zarr", 80, discrete=discrete, events=walls)
    loaded = nh.load_orbit(tmp_path / "run.zarr", discrete=discrete)
    for other in first.joined(others), stored, loaded:
        assert_same_run(orbit, other)
        assert np.array_equal(orbit.multipliers, other.multipliers, equal_nan=True)
    with pytest.raises(ValueError, match=r"be the events of the store, '\w+' \(restitution=1\.0\)"):
        nh.resume(tmp_path / "run.zarr", events=[nh.Event(event.function, name=event.name) for event in walls])


@pytest.mark.parametrize("name", MOTIONS)
def test_nothing_changes_without_an_impact(name: str) -> None:
    """A motion that meets no wall has the bits of one without, maps and flows alike."""
    system, start, walls = MOTIONS[name]
    times = np.linspace(0, 0.3, 7)
    free, near = (nh.simulate(nh.discretize(system, 0.05), steps=6, events=each, **start) for each in (None, walls))
    assert_same(free, near)
    assert all(len(near.events[event]) == len(near.events[event].after) == 0 for event in near.events)
    free, near = (nh.flow(system, times=times, events=each, **start) for each in (None, walls))
    assert_same(free, near, "reduced_momentum", "canonical_pose")


def test_multipliers_of_cut_steps_are_unknown() -> None:
    """Impulses of the constraint are those of whole steps, and NaN where a wall gave one too; displacements stay."""
    orbit = nh.simulate(nh.discretize(SLEIGH, 0.1), restricted_velocity=(0.3, 1.0), steps=300, events=box())
    cut = np.isin(np.arange(300), orbit.events.impact_steps)
    assert 5 < cut.sum() < 100
    assert np.array_equal(np.isnan(orbit.multipliers[:, 0]), cut)
    assert np.array_equal(orbit.has_impacts[:-1], cut)
    assert not orbit.has_every_step
    moved = orbit.configuration[:-1] @ orbit.displacement[:-1] - orbit.configuration[1:]
    assert np.array_equal(np.abs(moved).max(axis=(1, 2)) > 1e-14, cut)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_starts_at_a_wall(side: float) -> None:
    """With a direction a body that starts at a wall is before it: the motion toward it is reflected at once."""
    for speed, direction in itertools.product((1.0, -1.0), (-1, 0)):
        place = nh.SE(2).exp(np.array([0.0, side, 0.0]))
        start: dict[str, Any] = {"body_velocity": (0.1, speed, 0.0), "configuration": place}
        east = wall("east", (side, 0.0), direction=direction)
        orbit = nh.simulate(nh.discretize(SLEIGH, 0.05), steps=40, events=[east], **start)
        flow = nh.flow(SLEIGH, times=np.linspace(0, 2, 11), events=[east], **start)
        for result in orbit, flow:
            toward = speed * side > 0
            assert len(result.events["east"]) == (toward and direction == -1)
            assert (east.function(result).min() > -1e-14) == (not toward or direction == -1)


def test_one_way_walls() -> None:
    """A body passes a wall with a direction from behind, and is held on the other side."""
    gate = nh.Event(lambda states: states.position[:, 0] - 0.5, direction=-1, name="gate", reset=nh.Impact((1.0, 0.0)))
    orbit = nh.simulate(nh.discretize(BALANCED, 0.1), body_velocity=(0, 1.0, 0), steps=100, events=[gate, box()[0]])
    assert np.abs(orbit.events["gate"].time - np.arange(1.5, 10, 1)).max() < 1e-14
    assert np.all(orbit.position[orbit.time > 0.5, 0] > 0.5 - 1e-14)


def test_other_events_see_the_parts_of_the_step() -> None:
    """An event that is no wall is found before and after an impact in a step, and may stop the motion there."""
    line = nh.Event(lambda states: states.position[:, 0] - 0.9, name="line", stop=2)
    run: dict[str, Any] = {"body_velocity": (0, 1.0, 0), "steps": 10}
    orbit = nh.simulate(nh.discretize(BALANCED, 0.5), **run, events=[line, *box()])
    assert np.abs(orbit.events["line"].time - [0.9, 1.1]).max() < 1e-15
    assert orbit.events.stopped_by == "line"
    line, longer = nh.Event(line.function, name="line"), nh.discretize(BALANCED, 0.7)
    orbit = nh.simulate(longer, **run, events=[line, *box()])
    lines, hits = orbit.events["line"], orbit.events["east"]
    assert np.array_equal(lines.step[:2], [1, 1])
    assert np.abs(lines.fraction[:2] * 0.7 + 0.7 - [0.9, 1.1]).max() < 1e-15
    assert np.array_equal(lines.direction[:2], [1, -1])
    assert lines.fraction[0] < hits.fraction[0] < lines.fraction[1]
    last = nh.simulate(longer, **run, events=[wall("east", (1, 0), stop=1)])
    assert last.time[-1] == 0.7
    assert last.events.stopped_by == "east"
    assert len(last.events["east"].after) == 1


@pytest.mark.profile("problems", keep=["[0-3]", "8", "9"])
@pytest.mark.parametrize("seed", range(12))
def test_random_bodies_in_random_polygons(seed: int) -> None:
    """With any step, corners, contact point and a post: no wall is left behind, no energy gained, each hit is at it."""
    rng = np.random.default_rng(seed)
    point, corners, bounce = rng.uniform(-0.2, 0.2, 2), int(rng.integers(3, 7)), float(rng.choice([1.0, 0.8]))
    body = nh.ChaplyginSleigh(1.0, rng.uniform(0.1, 1), rng.uniform(-0.5, 0.5), rng.uniform(-0.3, 0.3))
    system = body if seed % 2 else nh.RigidBody.from_inertia(1.0, rng.uniform(0.1, 1), point, nh.SE(2))

    def place(states: nh.Orbit) -> np.ndarray:
        return states.configuration[:, :2] @ np.append(point, 1.0)

    def side(angle: float, distance: float) -> Callable[[nh.Orbit], np.ndarray]:
        return lambda states: distance - place(states) @ (np.cos(angle), np.sin(angle))

    angles = np.arange(corners) * 2 * np.pi / corners + rng.uniform(-0.3, 0.3, corners)
    gaps = [side(angle, rng.uniform(0.6, 1.0)) for angle in angles]
    gaps.append(lambda states: ((place(states) - 0.35) ** 2).sum(axis=1) - 0.01)
    walls = [nh.Event(gap, name=f"w{k}", reset=nh.Impact(restitution=bounce)) for k, gap in enumerate(gaps)]
    discrete = nh.discretize(system, 10 ** rng.uniform(-1.5, -0.3))
    velocity = rng.normal(size=system.rank)
    orbit = nh.simulate(discrete, restricted_velocity=velocity, steps=60, events=walls, throw=False)
    ways = np.abs(velocity).max() * discrete.time_step
    assert min(gap(orbit).min() for gap in gaps) > -1e-11 * ways
    assert np.diff(orbit.energy).max() < 1e-14 * orbit.energy[0]
    assert bounce < 1 or np.abs(orbit.energy / orbit.energy[0] - 1).max() < 1e-13
    for event in walls:
        assert np.abs(event.function(orbit.events[event.name].states)).max(initial=0) < 1e-14


START: dict[str, Any] = {"restricted_velocity": (0.3, 1.0)}
PLANE = nh.discretize(SLEIGH, 0.1)
MOTOR = nh.discretize(nh.Forced(SLEIGH, force=np.ones((9, 3))), 0.1)
SPEED = nh.Event(lambda states: states.body_velocity[:, 1], reset=nh.Impact())


def bounced(discrete: Any = PLANE, events: Any = None, steps: int = 9, **options: Any) -> nh.Orbit:
    """Run in a box."""
    return nh.simulate(discrete, steps=steps, events=box() if events is None else events, **START, **options)


def flowed(*times: float, **options: Any) -> nh.Orbit:
    """Flow in a box."""
    return nh.flow(SLEIGH, times=times, events=box(), **START, **options)


# What impacts do not have is refused, with the reason.
test_what_impacts_do_not_have_is_refused = refusals(
    (lambda: nh.Impact(restitution=1.1), "lie between 0 and 1"),
    (lambda: nh.Impact("up"), r"Impact\(normal=...\)"),
    (lambda: nh.Impact((0.0, 0.0)), "be no zero vector"),
    (lambda: nh.Impact(point=(0.0, 0.0)), "come with a spatial vector"),
    (lambda: nh.Event(len, reset=1.0), "be an impact"),  # type: ignore[arg-type]
    (lambda: bounced(reconstruct=False), "reconstruct=False"),
    (lambda: flowed(0.0, 1.0, reconstruct=False), "without poses"),
    (lambda: flowed(1.0, 0.0), "back in time"),
    (lambda: bounced(events=[SPEED]), "depend on the pose alone"),
    (lambda: bounced(events=box(normal=(1.0, 0.0, 0.0))), "have a normal of the space"),
    (lambda: bounced(steps=99, events=[wall("east", (1, 0), normal=(1.0, 0.0))]), "in whose direction the function gr"),
    (lambda: nh.ensemble(PLANE, restricted_velocity=np.ones((2, 2)), steps=9, events=box()), "have no reset"),
    (lambda: bounced(MOTOR), "a force of the time"),
    (lambda: bounced(branch="nearest"), "be left out where a part"),
)


def test_what_follows_from_whole_steps_is_refused(tmp_path: pathlib.Path) -> None:
    """Derivatives, crossings afterwards and files without events do not know of impacts; parts before them do."""
    orbit = bounced(steps=100)
    first = int(orbit.events.impact_steps[0])
    save = lambda o: nh.save_orbit(o, tmp_path / "o.zarr")  # noqa: E731
    for ask in (nh.asymptotics, lambda o: o.tangent, lambda o: nh.crossings(o, nh.cusp), save):
        with pytest.raises(ValueError, match="impacts"):
            ask(orbit)
        ask(orbit[:first])
    with pytest.raises(ValueError, match="impacts"):
        _ = flowed(*np.linspace(0, 5, 9)).tangent
