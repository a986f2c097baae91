"""Runs in blocks and in stores: the bits of one undisturbed run, whatever happens on the way."""

import errno
import json
import os
import re
import subprocess
import sys
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
from nonholo.io.orbits import Stream
from nonholo.systems import AbstractSystem

SLEIGH = nh.discretize(PROBLEMS[7].system, 0.1)
WIDE = nh.discretize(GENERAL["sleigh 3"][0], 0.05)
COMPACT = ("canonical/reduced_momentum", "canonical/cayley", "canonical/pose")
START = {"restricted_velocity": (0.7, -0.3)}
FOLDING = nh.discretize(PROBLEMS[0].system, 1.0)
FOLDS = {"momentum": np.array([1.93257157, -0.68979744])}


def _begun(path: Path, steps: int = 500, **options: Any) -> nh.Orbit:
    given = {"save_every": 2, "checkpoint_every": 40, **START, **options}
    return nh.simulate(SLEIGH, steps=steps, store=path, **given)


def _whole(steps: int = 500) -> nh.Orbit:
    return nh.simulate(SLEIGH, steps=steps, save_every=2, **START)


@pytest.mark.parametrize("throw", [True, False])
@pytest.mark.parametrize("block_steps", [1, 2, 3, 4, 5])
def test_blocks_end_where_the_run_ends(throw: bool, block_steps: int) -> None:
    """If a run cannot continue, its good states come first; then comes the error, or the outcome of the last block."""
    whole = nh.simulate(FOLDING, steps=500, throw=False, **FOLDS)
    assert 1 < len(whole) < 400, "this run has to end early"
    blocks, failures = [], []
    try:
        for block in nh.iterate(FOLDING, steps=500, block_steps=block_steps, throw=throw, **FOLDS):
            blocks.append(block)
    except nh.OutcomeError as failure:
        failures.append(failure.outcome)
    assert failures == ([whole.outcome] if throw else [])
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
    for found in (nh.load_orbit(path), nh.resume(path, events=events, throw=False)):
        assert_same_run(found, whole)
        assert found.events["level"].time.tolist() == whole.events["level"].time.tolist() != []
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
    path, told = tmp_path / "run.zarr", []
    write = Stream.write

    def meanwhile(self: Stream, number: int, *rest: Any) -> None:
        if number == 2:
            script = f"import nonholo as nh; nh.resume({str(path)!r})"
            other = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)  # noqa: S603
            told.append(other.stderr.splitlines()[-1])
        write(self, number, *rest)

    monkeypatch.setattr(Stream, "write", meanwhile)
    orbit = _begun(path)
    assert told[0].startswith("BlockingIOError")
    assert f"is being written by process {os.getpid()} on " in told[0]
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
