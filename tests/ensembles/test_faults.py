"""Sweeps that are killed, interrupted, or run into a full disk: what is there at the end is the undisturbed sweep."""

import errno
import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from ensembles import faults
from ensembles.small import python, resumed, same, swept
from stopping import stopped_at, stopped_in
from waiting import wait_for

import nonholo as nh
from nonholo.ensembles import standing_of
from nonholo.ensembles.stores import SweepStore, open_store
from nonholo.io.blocks import Piece

VICTIMS = ["worker", "all", "client"]


def _writers(path: Path) -> set[int]:
    """Return the processes that have written blocks."""
    return {int(mark.writer.partition(":")[2]) for _, mark in open_store(path).marks()}


def _printed(code: str) -> str:
    process = python(code)
    told, complaint = process.communicate(timeout=300)
    assert process.returncode == 0, complaint
    return told


@pytest.mark.profile("faults", instead="test_interruption_after_each_block")
@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="looks for processes in /proc")
def test_killed_processes_go_on(tmp_path: Path) -> None:
    """Killed at random moments, and resumed, a sweep in processes is the undisturbed one and leaves no rubbish."""
    path = tmp_path / "killed.zarr"
    ended = int(_printed(f"kill_often('noisy', Path({str(path)!r}), {VICTIMS})"))
    task, design, block = faults.SWEEPS["noisy"]
    blocks = -(-design.members // block)
    assert ended == len(VICTIMS)
    assert 0 < faults.done(path) < blocks, "the last kill has to come before the end: the sweep has to be longer"
    found = nh.resume(path, task=task).load()
    assert same(found, nh.sweep(task, design, tmp_path / "whole.zarr", block=design.members).load())
    assert not list(path.rglob("*.partial"))
    assert standing_of(path).owner is None


@pytest.mark.profile("faults", instead="test_interruption_after_each_block")
@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="looks for processes in /proc")
@pytest.mark.parametrize("scheduler", ["threads", "processes"])
def test_interrupted_sweep_goes_on(scheduler: str, tmp_path: Path) -> None:
    """Ctrl-C says how far the sweep came and how to resume, and nothing else; the store is valid."""
    path = tmp_path / "run.zarr"
    process = python(f"go_on('noisy', Path({str(path)!r}), {scheduler!r})", start_new_session=True)
    wait_for(lambda: faults.done(path) > 3)
    if scheduler == "processes":
        wait_for(lambda: len(_writers(path)) == 2)  # both work, and do not care
        before = faults.done(path)
        for writer in _writers(path):
            os.kill(writer, signal.SIGINT)
        wait_for(lambda: faults.done(path) > before + 4)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does
    _, complaint = process.communicate(timeout=100)
    assert process.returncode == -signal.SIGINT
    now = standing_of(path)
    assert 0 < now.done < now.members
    last = f"Stopped at {now.done} of 2400 members, 0 of them failed. Resume with nonholo.resume('{path}')"
    assert complaint.splitlines()[-1].startswith(f"KeyboardInterrupt: {last}")
    assert complaint.count("Traceback") == 1, "workers have nothing to say"
    assert now.owner is None
    assert not now.finished


def test_interruption_after_each_block(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Interrupted after each block in turn, a sweep keeps them all and comes to the same bits."""
    write = SweepStore.write

    def one_more(self: SweepStore, *rest: Any) -> None:
        write(self, *rest)
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(SweepStore, "write", one_more)
        for done in range(1, 7):
            with pytest.raises(KeyboardInterrupt, match=f"Stopped at {done} of 6 members"):
                swept(tmp_path / "run.zarr", block=1, resume=True)
    assert same(swept(tmp_path / "run.zarr", resume=True), swept(tmp_path / "whole.zarr"))


def test_end_between_the_last_two_writes(tmp_path: Path) -> None:
    """A sweep that was killed before its metadata were consolidated is finished by resuming it."""
    path = tmp_path / "run.zarr"
    with stopped_in("nonholo.io.blocks.consolidate", match="Stopped at 6 of 6"):
        swept(path)
    with pytest.raises(ValueError, match="must be a finished sweep"):
        nh.load_sweep(path)
    assert same(resumed(path), swept(tmp_path / "whole.zarr"))
    assert same(nh.load_sweep(path), swept(tmp_path / "other.zarr"))


@pytest.mark.parametrize("scheduler", ["synchronous", "threads"])
def test_full_disk_leaves_a_valid_store(scheduler: str, tmp_path: Path) -> None:
    """A full disk is an error that names the store, the standing and the remedy; with room again it continues."""
    path = tmp_path / "run.zarr"
    full = OSError(errno.ENOSPC, "No space left on device")
    with stopped_at(2, full, r"No space left.*of 6 members.*Free space, then call.*run\.zarr") as caught:
        swept(path, scheduler=scheduler)
    assert caught.value.errno == errno.ENOSPC
    with pytest.raises(ValueError, match="must be a finished sweep"):
        nh.load_sweep(path)
    assert same(resumed(path), swept(tmp_path / "whole.zarr"))


def test_no_room_for_a_store(tmp_path: Path) -> None:
    """If not even the empty store can be written, nothing is left at its path nor beside it."""
    full = OSError(errno.ENOSPC, "No space left on device")
    told = r"No space left on device. Nothing at this path was changed.*run\.zarr"
    with stopped_in("nonholo.io.blocks.create_array", full, told):
        swept(tmp_path / "run.zarr")
    assert not list(tmp_path.iterdir())


@pytest.mark.profile("faults", instead="test_second_process_is_refused")
def test_second_process_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """While one process writes a store, another one is refused, and told who writes it."""
    path, told = tmp_path / "run.zarr", []
    write = SweepStore.write

    def meanwhile(self: SweepStore, piece: Piece, *rest: Any) -> None:
        if piece.number == 1:
            told.append(standing_of(path).owner)
            other = python(f"nh.resume({str(path)!r}, task=noisy)")
            told.append(other.communicate(timeout=100)[1].splitlines()[-1])
        write(self, piece, *rest)

    monkeypatch.setattr(SweepStore, "write", meanwhile)
    task, design, _ = faults.SWEEPS["noisy"]
    nh.sweep(task, design, path, "synchronous", block=1200)
    assert told[0].startswith(f"process {os.getpid()} on ")
    assert told[1].startswith("BlockingIOError")
    assert f"is being written by {told[0]}" in told[1]
    assert standing_of(path).finished


def test_stale_lock_is_recognized(tmp_path: Path) -> None:
    """A lock that a process left which has ended does not count, and neither do its half-written files."""
    path = tmp_path / "run.zarr"
    with stopped_at(1):
        swept(path)
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    (path / "run" / "lock.json").write_text(json.dumps({"pid": ended.pid, "host": os.uname().nodename, "since": "1"}))
    strays = [path / "total" / "c" / "1" / "0.1f.partial", path / "run" / "blocks" / "1.json.2e.partial"]
    for stray in strays:
        stray.parent.mkdir(parents=True, exist_ok=True)
        stray.write_bytes(b"half")
    assert standing_of(path).owner is None
    assert same(resumed(path), swept(tmp_path / "whole.zarr"))
    assert not any(stray.exists() for stray in strays)
