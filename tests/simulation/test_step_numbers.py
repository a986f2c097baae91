"""The numbers of steps that an orbit knows, and what reads them: work, multipliers and events under forces."""

import copy
import functools
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from comparisons import assert_near
from simulation.forces import HEAVY, SLEIGH, TOP, VESELOVA, drive

import nonholo as nh
from nonholo.io.orbits import load_states
from nonholo.simulation import _run as _run_room

H = 0.05
FOUR = nh.SuslovTop(np.diag([1.0, 1.3, 0.8, 1.1]) + 0.1)
TABLE = np.random.default_rng(3).normal(size=(100, 3))
FORCED = {
    "table on a top": nh.Forced(TOP, force=TABLE),
    "table and weight on a top": nh.Forced(TOP, HEAVY, (TABLE, nh.Friction([0.1, 0.2, 0.3]))),
    "table on a sleigh": nh.Forced(SLEIGH, force=TABLE),
    "table and function on a sleigh": nh.Forced(SLEIGH, force=(TABLE, drive)),
    "function on a top": nh.Forced(TOP, force=drive),
    "table fixed in space": nh.Forced(VESELOVA, force=(TABLE, drive)),
}
STEPPED: dict[str, Callable[..., Any]] = {
    "scalar": lambda **run: _run(TOP, **run),
    "order 4": lambda **run: _run(TOP, order=4, **run),
    "four dimensions": lambda **run: _run(FOUR, **run),
    "right-invariant": lambda **run: _run(VESELOVA, **run),
    "branch rule": lambda **run: _run(SLEIGH, branch="nearest", **run),
    "table": lambda **run: _run(FORCED["table on a top"], **run),
    "function in Python": lambda **run: _run(FORCED["function on a top"], **run),
    "coordinates": lambda **run: nh.examples.particle().simulate(time_step=H, **run),
    "group": lambda **run: nh.examples.chaplygin_ball().simulate(time_step=H, **run),
}


def _start(system: Any) -> dict[str, np.ndarray]:
    return {"restricted_velocity": np.linspace(0.8, -0.5, system.rank)}


def _run(system: Any, *, order: int = 2, **run: Any) -> nh.Orbit:
    return nh.simulate(nh.discretize(system, H, order=order), **_start(system), **run)


def _level(states: nh.Orbit) -> np.ndarray:
    """What changes sign in every run here."""
    return 0.05 * states.restricted_momentum[:, 1] + np.sin(3 * states.time)


@functools.cache
def _whole(name: str) -> nh.Orbit:
    return _run(FORCED[name], steps=100)


@pytest.mark.profile("routes", cases=["group"])
@pytest.mark.parametrize("kind", STEPPED)
def test_each_way_to_take_rows_keeps_the_steps(kind: str) -> None:
    """Of orbits of all maps: rows have the numbers of their steps, which the times of a run tell."""
    orbit = STEPPED[kind](steps=24, save_every=2)
    assert orbit.step.dtype == np.int64
    assert orbit.step.tolist() == list(range(0, 25, 2))
    parts = orbit.chosen(slice(3, None, 4)), orbit.chosen(orbit.step % 3 == 0), orbit.chosen(np.array([5, 2, 2]))
    joined = parts[0].joined(parts[1:])
    for part in (*parts, joined):
        assert np.abs(part.time - H * part.step).max() < 1e-14
    assert joined.step.tolist() == [6, 14, 22, 0, 6, 12, 18, 24, 10, 4, 4]
    assert orbit.to_dataset()["step"].values.tolist() == orbit.step.tolist()
    assert joined.chosen(slice(0, 0)).step.tolist() == []


@pytest.mark.profile("routes", keep=["scalar", "order 4", "right-invariant"])
@pytest.mark.parametrize("kind", STEPPED)
def test_rows_have_the_same_bits_in_calls_of_any_length(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of all maps: rows are settled call by call, and the first of a call, the last of the one before, twice."""
    runs: list[dict[str, Any]] = [{"steps": 50}, {"steps": 50, "save_every": 3}]
    if kind != "branch rule":  # other branches have no parts of a step
        runs.append(runs[1] | {"events": [_level]})
    whole = [STEPPED[kind](**run).rows() for run in runs]
    monkeypatch.setattr(_run_room, "_NEAR", 60)
    for rows, run in zip(whole, runs, strict=True):
        again = STEPPED[kind](**run).rows()
        assert rows.keys() == again.keys()
        assert all(np.array_equal(rows[name], again[name], equal_nan=True) for name in rows)


@pytest.mark.parametrize(("column", "most"), [(0, 1e150), (1, np.inf), (2, np.inf)])
@pytest.mark.parametrize("system", [TOP, FOUR], ids=["scalar", "matrices"])
def test_rows_that_are_not_finite_are_no_success(system: Any, column: int, most: float) -> None:
    """One number in a column is seen when the rows are settled, a pose that is not saved excepted."""
    for with_poses in (True, False):
        stepper = nh.discretize(system, H).stepper(with_poses=with_poses)
        sizes = stepper.columns.values()
        for bad in (np.nan, -np.inf, 1.01 * most / stepper.route.scale if column == 0 else np.nan):
            rows = tuple(np.ones((3, size)) for size in sizes)
            rows[column][1, -1:] = bad
            expected = nh.Outcome.nonfinite if with_poses or column < 2 else nh.Outcome.successful
            assert stepper.settle(rows) == expected


@pytest.mark.parametrize("reconstruct", [True, False])
@pytest.mark.parametrize("system", [TOP, FOUR], ids=["scalar", "matrices"])
def test_an_orbit_keeps_the_memory_of_its_columns_alone(system: Any, reconstruct: bool) -> None:
    """Poses of the kernel that are not saved, or that are decoded anew, are given back."""
    orbit = _run(system, steps=9, reconstruct=reconstruct)
    columns = [each for each in (orbit.reduced_momentum, orbit.cayley, orbit.canonical_pose) if each is not None]
    memory = {id(owner): owner.nbytes for each in columns for owner in [each if each.base is None else each.base]}
    assert sum(memory.values()) == sum(each.nbytes for each in columns)


def test_times_of_a_run_are_computed_when_they_are_read() -> None:
    """They are h times the numbers of steps, also in copies; other names do not exist."""
    orbit = _run(TOP, steps=24, save_every=2)
    assert not {"time", "step"} & vars(orbit).keys()
    assert len(orbit) == 13
    for each in (pickle.loads(pickle.dumps(orbit)), copy.copy(orbit), orbit):  # noqa: S301
        assert np.array_equal(each.time, np.float64(H) * np.arange(0, 25, 2))
        assert each.time is each.time
    with pytest.raises(AttributeError, match="'Orbit' object has no attribute 'times'"):
        _ = orbit.times


@pytest.mark.profile("faults", keep=["table"])
@pytest.mark.parametrize("kind", ["scalar", "table", "coordinates"])
def test_stores_keep_the_steps(kind: str, tmp_path: Path) -> None:
    """Of whole runs, of parts that were saved, of the last block, and of what `extend` adds."""
    whole = STEPPED[kind](steps=20, save_every=2)
    for number, part in enumerate((whole, whole.chosen(slice(2, None, 3)), whole.chosen(np.array([1, 7, 9])))):
        nh.save_orbit(part, tmp_path / f"{number}.zarr")
        loaded = nh.load_orbit(tmp_path / f"{number}.zarr", discrete=whole.motion)
        assert loaded.step.dtype == np.int64
        assert np.array_equal(loaded.step, part.step)
    path = tmp_path / "run.zarr"
    STEPPED[kind](steps=14, save_every=2, store=path, checkpoint_every=6)
    assert np.array_equal(nh.extend(path, 6, discrete=whole.motion).step, whole.step)
    assert load_states(path, whole.motion, last=True).step.tolist() == [18, 20]


@pytest.mark.parametrize(("every", "steps"), [(None, [9]), (3, [0, 3, 6, 9])])
def test_members_of_ensembles_know_their_steps(every: int | None, steps: list[int]) -> None:
    """Of bodies side by side and one by one, and in coordinates."""
    particle = nh.examples.particle()
    here = {"configuration": particle.configuration, "body_velocity": np.array([particle.body_velocity] * 2)}
    cases = (
        (nh.discretize(TOP, H), {"restricted_velocity": np.ones((2, 2))}),
        (nh.discretize(FORCED["table on a top"], H), {"restricted_velocity": np.ones((2, 2))}),
        (nh.discretize(particle.system, H), here),
    )
    for discrete, start in cases:
        assert nh.ensemble(discrete, **start, steps=9, save_every=every).orbit(1).step.tolist() == steps


def test_motions_without_steps_number_their_rows() -> None:
    """Flows the requested times, also of `at` and in coordinates, and given poses their rows."""
    run = _run(TOP, steps=10)
    flows = (
        nh.flow(TOP, **_start(TOP), times=np.linspace(0, 1, 11)),
        nh.examples.particle().flow(times=np.linspace(0, 1, 11)),
        nh.Orbit.from_poses(TOP, run.time, run.configuration),
        nh.ensemble(TOP, restricted_velocity=np.ones((2, 2)), times=np.linspace(0, 1, 11)).orbit(1),
    )
    for flow in flows:
        assert flow.step.tolist() == list(range(11))
        assert flow.chosen(np.array([2, 7])).step.tolist() == [2, 7]
    assert flows[0].at([0.3, 0.1]).step.tolist() == [0, 1]


@pytest.mark.profile("problems", cases=["table fixed in space", "table and function on a sleigh"])
@pytest.mark.parametrize("name", [name for name in FORCED if "table" in name])
def test_work_under_a_table_is_that_of_every_step(name: str) -> None:
    """However rows are taken: that of the whole run at these rows, less that before the first, to rounding."""
    whole = _whole(name)
    work = whole.work
    thinned = _run(FORCED[name], steps=100, save_every=7)
    rows = np.arange(0, 101, 7), np.flatnonzero(np.random.default_rng(5).random(101) < 0.2), np.array([40, 41, 41, 60])
    for part, at in ((thinned, rows[0]), (whole[::7], rows[0]), *((whole.chosen(at), at) for at in rows)):
        assert np.abs(part.work - (work[at] - work[at[0]])).max() < 1e-13  # 100 steps, each to some 1e-15


def test_work_of_rows_that_are_no_run_is_refused() -> None:
    """Under a table: rows backwards, states within steps, and given poses of which some are left out."""
    whole = _whole("table on a top")
    poses = nh.Orbit.from_poses(whole.system, whole.time, whole.configuration)
    assert len(poses.work) == 101
    event = nh.crossings(whole, lambda states: np.sin(9 * states.time))
    for part in (whole.chosen(np.array([7, 3])), event.states, poses.chosen(np.arange(0, 101, 7))):
        with pytest.raises(ValueError, match=r"`Orbit.work` must"):
            _ = part.work
        assert np.isnan(part.known_work).all()


@pytest.mark.parametrize("system", [TOP, SLEIGH, VESELOVA, *FORCED.values()])
def test_multipliers_of_some_rows_are_those_of_their_steps(system: Any) -> None:
    """Of rows that were taken by their numbers: the impulses of the single steps from them, to rounding."""
    whole, rows = _run(system, steps=100), np.array([0, 7, 14, 50, 99])
    assert np.abs(whole.chosen(rows).multipliers - whole.multipliers[rows[:-1]]).max() < 1e-14


@pytest.mark.profile("problems", cases=["table fixed in space", "*on a top"])
@pytest.mark.parametrize("name", FORCED)
def test_the_whole_part_of_a_step_under_forces_is_the_step(name: str) -> None:
    """At s = 1 a part is the next state: momenta, poses, displacements and node momenta, to a few units of rounding."""
    whole = _whole(name)
    ahead, after = whole.motion.after_parts(whole[:-1], np.ones(100)), whole[1:]
    for quantity in ("time", "step", "reduced_momentum", "cayley", "canonical_pose", "momentum"):
        mine, theirs = getattr(ahead, quantity), getattr(after, quantity)
        assert np.abs(mine - theirs).max() <= 4e-15 * max(1.0, np.abs(theirs).max()), quantity  # 4 x 4 products


@pytest.mark.profile("problems", keep=["table and*"])
@pytest.mark.parametrize("name", FORCED)
def test_events_under_forces_are_where_a_shorter_step_arrives(name: str) -> None:
    """A crossing is where a map with another time step, from the state before and under the forces then, arrives."""
    forced, whole = FORCED[name], _whole(name)
    result = _run(forced, steps=100, events=[_level]).events[0]
    assert len(result) > 0
    assert np.abs(_level(result.states)).max() < 4e-15  # ulps of 3 t = 15
    k, fraction = int(result.step[-1]), float(result.fraction[-1])
    parts = [] if forced.table is None else [np.asarray(forced.table)[k : k + 1]]
    parts += [] if forced.friction is None else [forced.friction]
    if forced.function is not None:
        parts.append(lambda time, g, w: drive(whole.time[k] + time, g, w))
    moved = nh.Forced(forced.system, forced.potential, tuple(parts) if len(parts) > 1 else parts[0])
    start = {"momentum": whole.restricted_momentum[k], "configuration": whole.configuration[k]}
    there = nh.simulate(nh.discretize(moved, fraction * H), **start, steps=1)
    assert_near(there[1:], result.states[-1:], 4e-15, "restricted_momentum", "configuration")


def test_crossings_of_a_part_of_an_orbit_count_from_its_run() -> None:
    """The numbers of steps of crossings are those of the run, whatever rows are searched and events it had."""
    watched = STEPPED["coordinates"](steps=100, events=[_level])
    for whole, event in ((_whole("table on a sleigh"), nh.cusp), (watched, _level)):
        result, later = nh.crossings(whole, event), nh.crossings(whole[20:], event)
        assert later.step.tolist() == result.step[result.step >= 20].tolist()
        assert np.array_equal(later.states.step, later.step)
        assert len(later)


def test_events_need_no_poses_where_forces_do_not() -> None:
    """Under friction and a table crossings of momenta are those of the run with its poses."""
    rubbed = nh.discretize(nh.Forced(TOP, force=(TABLE, nh.Friction([0.1, 0.2, 0.3]))), H)
    run = {**_start(TOP), "steps": 100, "events": [_level]}
    with_poses, without = (nh.simulate(rubbed, **run, reconstruct=posed).events[0] for posed in (True, False))
    assert len(without)
    assert np.array_equal(with_poses.time, without.time)
