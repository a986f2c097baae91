"""Events of stored runs: the crossings of the run without a store, bit for bit, whatever happens on the way."""

import functools
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from comparisons import assert_same_run
from stopping import stopped_in

import nonholo as nh
from nonholo.io.orbits import Stream, standing

MASS = [[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]
TOP = nh.discretize(nh.SuslovTop(MASS), 0.1)
ROUND = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.0), 0.1)
CUTS = 3  # of each kind of run
BLOCKS = 11  # of 44 states


def east(orbit: nh.Orbit) -> np.ndarray:
    """Zero where the sleigh looks along the first axis, or back."""
    return np.sin(orbit.heading)


def entry(orbit: nh.Orbit) -> np.ndarray:
    """An entry of the pose that changes its sign in every motion here."""
    return orbit.configuration[:, 0, 1] - 0.01


def forward(orbit: nh.Orbit) -> np.ndarray:
    """A component of the momentum, from a level on."""
    return orbit.restricted_momentum[:, 0] - 0.1


TURNS = nh.Event(east, direction=1)
RUNS: dict[str, tuple[nh.Discretization, list[Any], dict[str, Any]]] = {
    "sleigh by heading": (ROUND, [TURNS, entry], {"body_velocity": (4.0, 1.0, 0.0)}),
    "sleigh with a cusp": (
        nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.2), 0.1), [nh.cusp, entry], {"body_velocity": (0.1, -1.0, 0)},
    ),
    "top": (TOP, [entry, forward], {"restricted_velocity": (0.7, -0.3)}),
    "order 4": (nh.discretize(TOP.system, 0.1, order=4), [entry, forward], {"restricted_velocity": (0.7, -0.3)}),
    "top in 4 dimensions": (
        nh.discretize(nh.SuslovTop(np.diag([1.0, 1.3, 0.8, 1.1]) + 0.1), 0.1),
        [entry, forward],
        {"restricted_velocity": (1.0, 0.2, -0.6)},
    ),
    "Veselova top": (nh.discretize(nh.VeselovaTop(MASS), 0.1), [entry],
                     {"restricted_velocity": (1.0, -0.6)}),
    "without poses": (TOP, [forward], {"restricted_velocity": (0.7, 0.5), "reconstruct": False}),
}  # fmt: skip


def begun(path: Path | None, events: list[Any], steps: int = 600, **options: Any) -> nh.Orbit:
    """Run the uniform circle, into a store of blocks of 35 steps if there is a path."""
    stored = {} if path is None else {"store": path, "checkpoint_every": 35}
    return nh.simulate(ROUND, body_velocity=(4, 1, 0), steps=steps, save_every=7, events=events, **stored, **options)


def cut(path: Path, monkeypatch: pytest.MonkeyPatch, block: int, late: bool, run: Callable[[], object]) -> None:
    """Let a run be interrupted before it writes a block or, late, when all of it but its mark is written."""
    write = Stream.write

    def interrupted(*_: Any) -> None:
        raise KeyboardInterrupt

    def failing(self: Stream, number: int, *rest: Any) -> None:
        if number == block:
            patch.setattr(f"nonholo.io.blocks.{'write_whole' if late else 'require_identity'}", interrupted)
        write(self, number, *rest)

    with monkeypatch.context() as patch:
        patch.setattr(Stream, "write", failing)
        with pytest.raises(KeyboardInterrupt, match="Stopped at step"):
            run()
    with pytest.raises(ValueError, match="be a finished run"):
        nh.load_orbit(path)


@pytest.mark.profile("faults", keep=["sleigh with a cusp"])
@pytest.mark.parametrize("name", RUNS)
def test_runs_cut_at_random_blocks_go_on(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Cut at random blocks, resumed and cut again (21 times in total), a run has the bits of the undisturbed one."""
    discrete, events, start = RUNS[name]
    run = {"steps": 301, "save_every": 7, "checkpoint_every": 28, "events": events, **start}
    undisturbed = nh.simulate(discrete, **run, store=tmp_path / "whole.zarr")
    chance = np.random.default_rng(len(name))
    for number in range(CUTS):
        path, (first, second) = tmp_path / f"{number}.zarr", np.sort(chance.integers(0, BLOCKS, 2))
        cut(path, monkeypatch, first, number == 1, functools.partial(nh.simulate, discrete, **run, store=path))
        cut(path, monkeypatch, second, number != 1, functools.partial(nh.resume, path, events=events))
        assert_same_run(nh.resume(path, events=events), undisturbed)


@pytest.mark.profile("faults", keep=["2"])
@pytest.mark.parametrize("stop", [1, 2, 7])
def test_stopping_event_ends_the_store(stop: int, tmp_path: Path) -> None:
    """A stopping event finishes the store: its arrays are cut, it says what ended it, and it is not extended."""
    path, events = tmp_path / "run.zarr", [entry, nh.Event(east, direction=1, stop=stop)]
    stored, whole = begun(path, events, steps=2000), begun(None, events, steps=2000)
    assert whole.events.stopped_by == "east"
    assert_same_run(stored, whole)
    assert_same_run(nh.resume(path, events=events), whole)
    attributes = json.loads((path / "zarr.json").read_text())["attributes"]
    assert (attributes["stopped_by"], attributes["outcome"]) == ("east", "successful")
    assert json.loads(attributes["crossings"]) == [len(found) for found in whole.events.found]
    with pytest.raises(ValueError, match=r"continue.*event 'east' ended"):
        nh.extend(path, 10, events=events)


def test_stop_that_was_not_cut_is_resumed(tmp_path: Path) -> None:
    """A run that an event ended, killed before its arrays were cut, ends there when it is resumed."""
    path, events = tmp_path / "run.zarr", [nh.Event(east, direction=1, stop=3)]
    with stopped_in("nonholo.io.orbits.Stream.finish"):
        begun(path, events)
    assert_same_run(nh.resume(path, events=events), begun(None, events))


@pytest.mark.profile("faults", keep=["lengths0"])
@pytest.mark.parametrize("lengths", [(1, 599), (50, 550), (245, 1, 354)])
def test_extended_run_has_the_crossings_of_the_long_run(lengths: tuple[int, ...], tmp_path: Path) -> None:
    """Crossings before and after the end of a run that is extended, also those of a stop there, are found once."""
    path, events = tmp_path / "run.zarr", [entry, nh.Event(east, direction=1, stop=20)]
    begun(path, events, lengths[0])
    for steps in lengths[1:]:
        nh.extend(path, steps, events=events)
    whole = begun(None, events, sum(lengths))
    assert whole.events.stopped_by == "east"
    assert_same_run(nh.load_orbit(path), whole)


def test_many_crossings_fill_several_chunks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Crossings of a block that do not fit in one chunk of three rows are kept in several, those of none in none."""
    monkeypatch.setattr("nonholo.io.orbits._MOST", 3)
    path, rare = tmp_path / "run.zarr", nh.Event(lambda orbit: orbit.heading - 70.0, name="rare")
    for name, events in (("many", [TURNS, entry]), ("few", [rare])):
        stored = begun(path / name, events, 210)
        assert_same_run(stored, begun(None, events, 210))
        assert_same_run(nh.resume(path / name, events=events), stored)
    assert len(list((path / "few/run/events").rglob("c/*/0"))) == 1
    assert len(list((path / "many/run/events").rglob("c/*/0"))) > 210 // 35


@pytest.mark.profile("faults", instead="test_many_crossings_fill_several_chunks")
def test_large_orbit_has_the_crossings_of_its_last_block(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where only the last block of states is returned, its crossings are; the store holds all."""
    monkeypatch.setattr("nonholo.simulation._stored._LOADED", 100)
    tail, whole = begun(tmp_path / "run.zarr", [TURNS]), begun(None, [TURNS])
    found, known = tail.events["east"], whole.events["east"]
    begin = tail.time[0] - 7 * ROUND.time_step
    assert len(tail) == len(whole) % 5
    assert 0 < len(found) == np.count_nonzero(known.time > begin)
    assert np.array_equal(found.time, known.time[-len(found) :])
    assert_same_run(nh.load_orbit(tmp_path / "run.zarr"), whole)


def opposite(orbit: nh.Orbit) -> np.ndarray:
    """Another function than `east`."""
    return np.cos(orbit.heading)


@pytest.mark.profile("faults", keep=["*-resume"])
@pytest.mark.parametrize("going_on", [nh.resume, lambda path, **given: nh.extend(path, 10, **given)])
@pytest.mark.parametrize(
    ("events", "words"),
    [
        (None, r"events of the store, 'east' \(direction=1\), 'entry'\. Got None .* Pass events=.* holds no functions"),
        ([entry, TURNS], r"Got 'entry', 'east' \(direction=1\)"),
        ([TURNS], r"Got 'east' \(direction=1\)\. Pass the ones"),
        ([nh.Event(east, direction=1, stop=3), entry], r"Got 'east' \(direction=1, stop=3\)"),
        ([nh.Event(opposite, direction=1, name="east"), entry], "another one of 'east': 1 instead of 0 at the first"),
        (TURNS, "be a list of events"),
    ],
)
def test_other_events_are_refused(going_on: Callable[..., object], events: Any, words: str, tmp_path: Path) -> None:
    """A run with events continues with the same events only; the message says what the store has and what was got."""
    path = tmp_path / "run.zarr"
    begun(path, [TURNS, entry], steps=70)
    with pytest.raises(ValueError, match=words):
        going_on(path, events=events)


def test_events_of_a_store_without_are_refused(tmp_path: Path) -> None:
    """A run that was begun without events cannot continue with some: what came before was not searched."""
    path = tmp_path / "run.zarr"
    nh.simulate(ROUND, body_velocity=(4.0, 1.0, 0.0), steps=70, store=path)
    with pytest.raises(ValueError, match=r"events of the store, no events\. Got 'east'"):
        nh.resume(path, events=[TURNS])
    assert nh.resume(path).events is None


@pytest.mark.profile("faults", keep=["None-begun_with1"])
@pytest.mark.parametrize("begun_with", [None, []])
@pytest.mark.parametrize("going_with", [None, []])
def test_no_events_are_an_empty_list_of_them(begun_with: Any, going_with: Any, tmp_path: Path) -> None:
    """A run without events continues without, however that is said."""
    path, run = tmp_path / "run.zarr", {"body_velocity": (4.0, 1.0, 0.0), "save_every": 7}
    nh.simulate(ROUND, steps=70, events=begun_with, store=path, **run)
    assert_same_run(nh.extend(path, 70, events=going_with), nh.simulate(ROUND, steps=140, **run))


def test_bad_functions_leave_no_store(tmp_path: Path) -> None:
    """A function that gives no number for the first state is refused before there is a store."""
    with pytest.raises(ValueError, match="take an orbit"):
        begun(tmp_path / "run.zarr", [lambda orbit: orbit.nothing])
    assert list(tmp_path.iterdir()) == []


def test_a_function_that_fails_on_the_way_leaves_a_valid_store(tmp_path: Path) -> None:
    """Where a function fails at a later state the run stops there, and continues with one that does not."""

    def brittle(orbit: nh.Orbit) -> np.ndarray:
        return np.where(orbit.time > 30, np.nan, east(orbit))

    path, sound = tmp_path / "run.zarr", [nh.Event(east, name="brittle")]
    with pytest.raises(ValueError, match=r"be finite. Got nan from `brittle` at time 30"):
        begun(path, [brittle])
    now = standing(path)
    assert now is not None
    assert now.done == 273, "the last block of 35 steps that ends before step 300"
    assert_same_run(nh.resume(path, events=sound), begun(None, sound))
