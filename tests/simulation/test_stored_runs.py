"""Runs in blocks and in stores: the bits of one undisturbed run, and its crossings, whatever happens on the way."""

import contextlib
import errno
import functools
import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bodies import GENERAL
from comparisons import assert_same_run
from damage import DAMAGE, damage
from problems import PROBLEMS
from refusals import refusals
from stopping import stopped_at, stopped_in

import nonholo as nh
from nonholo.io.blocks import edit_attributes
from nonholo.io.metadata import read_attributes
from nonholo.io.orbits import Stream, standing
from nonholo.systems import AbstractSystem

SLEIGH = nh.discretize(PROBLEMS[7].system, 0.1)
WIDE = nh.discretize(GENERAL["sleigh 3"][0], 0.05)
COMPACT = ("canonical/reduced_momentum", "canonical/cayley", "canonical/pose")
START = {"restricted_velocity": (0.7, -0.3)}
TOP = nh.discretize(PROBLEMS[0].system, 0.1)
FOUR = nh.discretize(nh.SuslovTop(np.diag([1.0, 1.3, 0.8, 1.1]) + 0.1), 0.1)
ROUND = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.0), 0.1)
FOLDING = nh.discretize(PROBLEMS[0].system, 1.0)
FOLDS = {"momentum": np.array([1.93257157, -0.68979744])}


def _begun(path: Path, steps: int = 500, **options: Any) -> nh.Orbit:
    arguments = {"save_every": 2, "checkpoint_every": 40, **START, **options}
    return nh.simulate(SLEIGH, steps=steps, store=path, **arguments)


def _whole(steps: int = 500) -> nh.Orbit:
    return nh.simulate(SLEIGH, steps=steps, save_every=2, **START)


@pytest.mark.parametrize("throw", [True, False])
@pytest.mark.parametrize("block_steps", [1, 2, 3, 4, 5])
def test_blocks_end_where_the_run_ends(throw: bool, block_steps: int) -> None:
    """If a run cannot continue, its good states come first; then comes the error, or the outcome of the last block."""
    whole = nh.simulate(FOLDING, steps=500, throw=False, **FOLDS)
    assert 1 < len(whole) < 400, "this run has to end early"
    blocks = []
    with pytest.raises(nh.OutcomeError, match=str(whole.outcome)) if throw else contextlib.nullcontext():
        for block in nh.iterate(FOLDING, steps=500, block_steps=block_steps, throw=throw, **FOLDS):
            blocks.append(block)
    assert throw or blocks[-1].outcome == whole.outcome
    assert sum(map(len, blocks)) == len(whole)


@pytest.mark.profile("faults", keep=["1", "3"])
@pytest.mark.parametrize("block_steps", [1, 2, 3, 4, 5])
def test_run_that_ends_early_is_kept(block_steps: int, tmp_path: Path) -> None:
    """A stored run that cannot continue keeps its good steps, crossings and outcome; it is not extended."""
    events = [nh.Event(lambda orbit: orbit.configuration[:, 2, 2], name="level")]
    whole = nh.simulate(FOLDING, steps=500, events=events, throw=False, **FOLDS)
    path = tmp_path / "run.zarr"
    with pytest.raises(nh.OutcomeError, match=f"Step {len(whole)} of 500"):
        nh.simulate(FOLDING, steps=500, store=path, checkpoint_every=block_steps, events=events, **FOLDS)
    for result in (nh.load_orbit(path), nh.resume(path, events=events, throw=False)):
        assert_same_run(result, whole)
        assert result.events["level"].time.tolist() == whole.events["level"].time.tolist() != []
    with pytest.raises(ValueError, match="be a run that can continue"):
        nh.extend(path, 10, events=events)


def test_failed_run_that_was_not_cut_is_resumed_in_silence(tmp_path: Path) -> None:
    """A run that failed and was killed before its arrays were cut is no damaged one."""
    path = tmp_path / "run.zarr"
    with stopped_in("nonholo.io.orbits.Stream.finish"):
        nh.simulate(FOLDING, steps=500, store=path, checkpoint_every=5, throw=False, **FOLDS)
    assert_same_run(nh.resume(path, throw=False), nh.simulate(FOLDING, steps=500, throw=False, **FOLDS))


def test_full_disk_leaves_a_valid_store(tmp_path: Path) -> None:
    """A full disk is an error that names the store and the remedy; with room again the run continues."""
    path = tmp_path / "run.zarr"
    full = OSError(errno.ENOSPC, "No space left on device")
    with stopped_at(3, full, r"No space left.*step 118 of 500\. Free space.*run\.zarr") as caught:
        _begun(path)
    assert caught.value.errno == errno.ENOSPC
    assert_same_run(nh.resume(path), _whole())


@pytest.mark.profile("faults", keep=["missing-run/blocks", "flipped-energy"])
@pytest.mark.parametrize("array", ["time", "energy", "x", "heading", *COMPACT, "run/blocks", "run/events"])
@pytest.mark.parametrize("how", DAMAGE)
def test_damaged_chunk_is_named_and_computed_again(array: str, how: str, tmp_path: Path) -> None:
    """A missing, changed or cut chunk of a finished block, or its mark, is named, and the orbit is whole again."""
    path = tmp_path / "run.zarr"
    events = [nh.Event(lambda states: np.sin(7 * states.time), name="beat")]
    orbit = _begun(path, events=events)
    key = "c/4" if array in ("time", "energy", "x", "heading") else "c/4/0"
    key = "3.json" if array == "run/blocks" else key
    damage(path / array / key, how)
    named = f"mark {re.escape(key)}|chunk {key} of the array {array}|place or store in block 4"
    with pytest.raises(ValueError, match=named):
        nh.load_orbit(path)
    with pytest.warns(RuntimeWarning, match=named):
        again = nh.resume(path, events=events)
    for each in (again, nh.resume(path, events=events), nh.load_orbit(path)):
        assert_same_run(each, orbit)
        assert np.array_equal(each.events["beat"].time, orbit.events["beat"].time)


def test_lost_start_is_refused(tmp_path: Path) -> None:
    """Where the first block and the state before it are both gone, nothing is invented."""
    path = tmp_path / "run.zarr"
    _begun(path)
    for chunk in ("time/c/0", "run/blocks/start.json"):
        (path / chunk).unlink()
    with pytest.warns(RuntimeWarning, match="c/0"), pytest.raises(ValueError, match=r"hold the start.*run it again"):
        nh.resume(path)


@pytest.mark.profile("faults", instead="test_full_disk_leaves_a_valid_store")
def test_limit_of_the_system_on_file_sizes(tmp_path: Path) -> None:
    """A limit met while zarr writes ends in the same clean error as a full disk, and the run continues without it."""
    path = tmp_path / "run.zarr"
    script = f"""
import resource, signal, sys
import nonholo as nh
sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 1e-3)
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
nh.simulate(sleigh, body_velocity=(1.0, 0.3, 0.0), steps=2)
resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))
try:
    nh.simulate(sleigh, body_velocity=(1.0, 0.3, 0.0), steps=9_000, store={str(path)!r}, checkpoint_every=3_000)
except OSError as failure:
    print(failure)
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)  # noqa: S603
    assert "File too large. The run stands at step 0 of 9000. Free space, then call nonholo.resume" in done.stdout
    discrete = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 1e-3)
    assert_same_run(nh.resume(path), nh.simulate(discrete, body_velocity=(1.0, 0.3, 0.0), steps=9_000))


def test_other_versions_are_told(tmp_path: Path) -> None:
    """A run that continues with another version of a package says that its last bits may change."""
    path = tmp_path / "run.zarr"
    _begun(path)
    versions = json.loads(read_attributes(path)["versions"]) | {"numba": "0.1"}
    edit_attributes(path, {"versions": json.dumps(versions)})
    assert_same_run(nh.resume(path), _whole())  # a finished store is loaded in silence
    with pytest.warns(RuntimeWarning, match=r"begun with numba 0\.1 \(now .*last bits"):
        nh.extend(path, 10)


@pytest.mark.parametrize(
    "system", [nh.SuslovTop.arrowhead([1.0, 1.4, 0.7, 1.2, 0.9], [0.1, -0.2, 0.3, 0.1]), WIDE.system]
)
def test_runs_without_poses(system: AbstractSystem, tmp_path: Path) -> None:
    """Runs that keep no poses are stored, resumed and extended too."""
    discrete, start = nh.discretize(system, 0.05), {"restricted_velocity": np.linspace(0.3, -0.5, system.rank)}
    path = tmp_path / "run.zarr"
    nh.simulate(discrete, steps=100, reconstruct=False, store=path, checkpoint_every=30, **start)
    orbit = nh.extend(path, 55)
    assert orbit.pose is None
    whole = nh.simulate(discrete, steps=155, reconstruct=False, **start)
    assert np.abs(orbit.reduced_momentum - whole.reduced_momentum).max() < 1e-15  # products of matrices: see `iterate`
    assert np.array_equal(orbit.time, whole.time)


def test_second_process_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """While one process writes a store, another one is refused, and told who writes it."""
    path, report = tmp_path / "run.zarr", []
    write = Stream.write

    def meanwhile(self: Stream, number: int, *rest: Any) -> None:
        if number == 2:
            script = f"import nonholo as nh; nh.resume({str(path)!r})"
            other = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)  # noqa: S603
            report.append(other.stderr.splitlines()[-1])
        write(self, number, *rest)

    monkeypatch.setattr(Stream, "write", meanwhile)
    orbit = _begun(path)
    assert report[0].startswith("BlockingIOError")
    assert f"is being written by process {os.getpid()} on " in report[0]
    assert_same_run(orbit, _whole())


_RUN = Path("run.zarr")
# Bad arguments and stores that are not there are refused with the reason.
test_refused = refusals(
    (lambda: nh.resume(_RUN), "must exist"),
    (lambda: _begun(_RUN, checkpoint_every=41), r"multiple of save_every = 2\. Got 41\. Pass 42"),
    (lambda: _begun(_RUN, branch=lambda *_: 0), "be a rule that a store can name"),
    (lambda: nh.simulate(SLEIGH, steps=9, checkpoint_every=4, **START), "come with a store"),
    (lambda: nh.extend(_RUN, 0), "positive integer"),
    (lambda: nh.iterate(SLEIGH, steps=9, block_steps=0, **START), "positive integer"),
    kind=(ValueError, FileNotFoundError),
)


def test_other_stores_are_refused(tmp_path: Path) -> None:
    """A path that is taken, an orbit that was saved whole, and the store of another run."""
    _begun(tmp_path / "run.zarr")
    with pytest.raises(FileExistsError, match="must be new"):
        _begun(tmp_path / "run.zarr")
    with pytest.raises(ValueError, match=r"motion .*0.2.* instead of .*0.1"):
        nh.resume(tmp_path / "run.zarr", discrete=nh.discretize(PROBLEMS[7].system, 0.2))
    nh.save_orbit(_whole(), tmp_path / "whole.zarr")
    with pytest.raises(ValueError, match=r"have checkpoints.*saved whole"):
        nh.resume(tmp_path / "whole.zarr")


def test_a_replaced_store_is_not_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A writer whose store was taken away stops; the store that has taken its place stays as it is."""
    path, other = tmp_path / "run.zarr", nh.simulate(SLEIGH, steps=5, **START)
    write = Stream.write

    def replaced_at_two(self: Stream, number: int, *rest: Any) -> None:
        if number == 2:
            path.rename(tmp_path / "aside.zarr")
            nh.save_orbit(other, path)
        write(self, number, *rest)

    monkeypatch.setattr(Stream, "write", replaced_at_two)
    with pytest.raises(OSError, match="Another store has taken the place"):
        _begun(path)
    assert_same_run(nh.load_orbit(path), other)


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
RUNS: dict[str, tuple[nh.Discretization, list[Any], tuple[float, ...]]] = {
    "sleigh by heading": (ROUND, [TURNS, entry], (4.0, 1.0)),
    "sleigh with a cusp": (nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.2), 0.1), [nh.cusp, entry], (0.1, -1.0)),
    "top": (TOP, [entry, forward], (0.7, -0.3)),
    "order 4": (nh.discretize(TOP.system, 0.1, order=4), [entry, forward], (0.7, -0.3)),
    "top in 4 dimensions": (FOUR, [entry, forward], (1.0, 0.2, -0.6)),
    "Veselova top": (nh.discretize(nh.VeselovaTop(TOP.system.mass_tensor), 0.1), [entry], (1.0, -0.6)),
    "without poses": (TOP, [forward], (0.7, 0.5)),
}


def turning(path: Path | None, events: list[Any], steps: int = 600, **options: Any) -> nh.Orbit:
    """Run a sleigh on a circle, into a store of blocks of 35 steps if there is a path."""
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
    discrete, events, velocity = RUNS[name]
    run = {"steps": 301, "save_every": 7, "checkpoint_every": 28, "events": events, "restricted_velocity": velocity}
    run["reconstruct"] = name != "without poses"
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
    stored, whole = turning(path, events, steps=2000), turning(None, events, steps=2000)
    assert whole.events.stopped_by == "east"
    assert_same_run(stored, whole)
    assert_same_run(nh.resume(path, events=events), whole)
    attributes = json.loads((path / "zarr.json").read_text())["attributes"]
    assert (attributes["stopped_by"], attributes["outcome"]) == ("east", "successful")
    assert json.loads(attributes["crossings"]) == [len(result) for result in whole.events.found]
    with pytest.raises(ValueError, match=r"continue.*event 'east' ended"):
        nh.extend(path, 10, events=events)


def test_stop_that_was_not_cut_is_resumed(tmp_path: Path) -> None:
    """A run that an event ended, killed before its arrays were cut, ends there when it is resumed."""
    path, events = tmp_path / "run.zarr", [nh.Event(east, direction=1, stop=3)]
    with stopped_in("nonholo.io.orbits.Stream.finish"):
        turning(path, events)
    assert_same_run(nh.resume(path, events=events), turning(None, events))


@pytest.mark.profile("faults", keep=["lengths0"])
@pytest.mark.parametrize("lengths", [(1, 599), (50, 550), (245, 1, 354)])
def test_extended_run_has_the_crossings_of_the_long_run(lengths: tuple[int, ...], tmp_path: Path) -> None:
    """Crossings before and after the end of a run that is extended, also those of a stop there, are found once."""
    path, events = tmp_path / "run.zarr", [entry, nh.Event(east, direction=1, stop=20)]
    turning(path, events, lengths[0])
    for steps in lengths[1:]:
        nh.extend(path, steps, events=events)
    whole = turning(None, events, sum(lengths))
    assert whole.events.stopped_by == "east"
    assert_same_run(nh.load_orbit(path), whole)


def test_many_crossings_fill_several_chunks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Crossings of a block that do not fit in one chunk of three rows are kept in several, those of none in none."""
    monkeypatch.setattr("nonholo.io.orbits._MOST", 3)
    path, rare = tmp_path / "run.zarr", nh.Event(lambda orbit: orbit.heading - 70.0, name="rare")
    for name, events in (("many", [TURNS, entry]), ("few", [rare])):
        stored = turning(path / name, events, 210)
        assert_same_run(stored, turning(None, events, 210))
        assert_same_run(nh.resume(path / name, events=events), stored)
    assert len(list((path / "few/run/events").rglob("c/*/0"))) == 1
    assert len(list((path / "many/run/events").rglob("c/*/0"))) > 210 // 35


@pytest.mark.profile("faults", instead="test_many_crossings_fill_several_chunks")
def test_large_orbit_has_the_crossings_of_its_last_block(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where only the last block of states is returned, its crossings are; the store holds all."""
    monkeypatch.setattr("nonholo.simulation._stored._LOADED", 100)
    tail, whole = turning(tmp_path / "run.zarr", [TURNS]), turning(None, [TURNS])
    result, reference = tail.events["east"], whole.events["east"]
    begin = tail.time[0] - 7 * ROUND.time_step
    assert len(tail) == len(whole) % 5
    assert 0 < len(result) == np.count_nonzero(reference.time > begin)
    assert np.array_equal(result.time, reference.time[-len(result) :])
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
    turning(path, [TURNS, entry], steps=70)
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
        turning(tmp_path / "run.zarr", [lambda orbit: orbit.nothing])
    assert list(tmp_path.iterdir()) == []


def test_a_function_that_fails_on_the_way_leaves_a_valid_store(tmp_path: Path) -> None:
    """Where a function fails at a later state the run stops there, and continues with one that does not."""

    def brittle(orbit: nh.Orbit) -> np.ndarray:
        return np.where(orbit.time > 30, np.nan, east(orbit))

    path, sound = tmp_path / "run.zarr", [nh.Event(east, name="brittle")]
    with pytest.raises(ValueError, match=r"be finite. Got nan from `brittle` at time 30"):
        turning(path, [brittle])
    now = standing(path)
    assert now is not None
    assert now.done == 273, "the last block of 35 steps that ends before step 300"
    assert_same_run(nh.resume(path, events=sound), turning(None, sound))
