"""Sweeps that are killed, interrupted, out of space or damaged: what is lost is named, the end is that of a whole."""

import errno
import functools
import json
import os
import re
import signal
import subprocess
import sys
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from damage import DAMAGE, damage, swap
from ensembles import faults
from ensembles.faults import python, resumed, same, swept
from refusals import assert_refused
from stopping import stopped_at, stopped_in
from waiting import wait_for

import nonholo as nh
from nonholo.ensembles import standing_of
from nonholo.ensembles.stores import open_store
from nonholo.io.blocks import BlockStore


def _writers(path: Path) -> set[int]:
    """Return the processes that have written blocks."""
    return {int(mark.writer.partition(":")[2]) for _, mark in open_store(path).marks()}


@pytest.mark.profile("faults", instead="test_interruption_after_each_block")
@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="looks for processes in /proc")
def test_killed_client_goes_on(tmp_path: Path) -> None:
    """Workers of a killed client end with it; its sweep, resumed, has the same bits and leaves no rubbish."""
    path, (task, design, block) = tmp_path / "killed.zarr", faults.SWEEPS["noisy"]
    with python(f"go_on('noisy', Path({str(path)!r}), 'processes')") as client:
        wait_for(lambda: faults.done(path) > 3 and len(_writers(path)) == 2, seconds=400.0)  # a busy machine
        client.kill()
    wait_for(lambda: not any(map(faults.is_running, _writers(path))))
    assert faults.done(path) < design.members // block
    assert standing_of(path).owner is None
    whole = nh.sweep(task, design, tmp_path / "whole.zarr", block=design.members).load()
    assert same(nh.resume(path, task=task).load(), whole)
    assert not list(path.rglob("*.partial"))


@pytest.mark.profile("faults", instead="test_interruption_after_each_block")
def test_killed_worker_is_told(tmp_path: Path) -> None:
    """A worker that is killed ends the sweep with an error in words, and what was done is kept."""
    with pytest.raises(OSError, match="A worker process was killed"):
        nh.sweep(faults.dying, faults.DESIGN, tmp_path / "run.zarr", "processes", block=1, workers=2)
    assert standing_of(tmp_path / "run.zarr").owner is None
    result = nh.resume(tmp_path / "run.zarr", task=faults.dying, scheduler="synchronous").load()
    assert same(result, swept(tmp_path / "whole.zarr"))


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
    write = BlockStore.write

    def one_more(self: BlockStore, *rest: Any) -> None:
        write(self, *rest)
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(BlockStore, "write", one_more)
        for done in range(1, 7):
            with pytest.raises(KeyboardInterrupt, match=f"Stopped at {done} of 6 members"):
                swept(tmp_path / "run.zarr", block=1, resume=True)
    assert same(swept(tmp_path / "run.zarr", resume=True), swept(tmp_path / "whole.zarr"))


def test_end_between_the_last_two_writes(tmp_path: Path) -> None:
    """A sweep that was killed before its metadata were consolidated is finished by resuming it."""
    path = tmp_path / "run.zarr"
    with stopped_in("nonholo.io.blocks.consolidate", match="Stopped at 6 of 6"):
        swept(path)
    assert_refused(path, "must be a finished sweep", nh.load_sweep)
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
    assert_refused(path, "must be a finished sweep", nh.load_sweep)
    assert same(resumed(path), swept(tmp_path / "whole.zarr"))


def test_second_writer_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """While a sweep writes a store, another one is refused, and told which process writes it."""
    path, write = tmp_path / "run.zarr", BlockStore.write

    def meanwhile(self: BlockStore, *rest: Any) -> None:
        owner = standing_of(path).owner
        assert owner.startswith(f"process {os.getpid()} on ")
        assert_refused(path, f"is being written by {re.escape(owner)}", resumed, kind=BlockingIOError)
        write(self, *rest)

    monkeypatch.setattr(BlockStore, "write", meanwhile)
    swept(path)
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


ARRAYS = {"total": "c/1/0", "noise": "c/1/0/0", "outcome": "c/1/0"}


@pytest.mark.profile("faults", keep=["cut-outcome", "flipped-noise", "missing-total", "empty-total"])
@pytest.mark.parametrize("array", ARRAYS)
@pytest.mark.parametrize("how", DAMAGE)
def test_damaged_chunk_is_named_and_computed_again(array: str, how: str, tmp_path: Path) -> None:
    """A missing, changed or cut chunk is never read: it is named, refused by `load_sweep`, and computed again."""
    path = tmp_path / "run.zarr"
    whole = swept(path)
    damage(path / array / ARRAYS[array], how)
    named = f"chunk {ARRAYS[array]} of the array {array}"
    assert_refused(path, named, nh.load_sweep)
    with pytest.warns(RuntimeWarning, match=f"{named}. Block 1 is computed again"):
        assert same(resumed(path), whole)
    assert same(nh.load_sweep(path), whole)
    assert same(resumed(path), whole), "a sound store is opened in silence"


@pytest.mark.parametrize("name", ["x", "restricted_velocity"])
def test_damaged_draws_are_computed_again(name: str, tmp_path: Path) -> None:
    """What a random design drew is kept beside the results, and is as safe; also in a last chunk that is not full."""
    path, design = tmp_path / "run.zarr", nh.RandomDesign(5, {name: nh.Uniform(0.0, 1.0)}, rng=2)
    task: Callable[[nh.MemberBlock], Any] = lambda block: block[name] ** 2  # noqa: E731
    whole = nh.sweep(task, design, path, block=2).load()
    damage(path / name / "c" / "2", "flipped")
    with pytest.warns(RuntimeWarning, match=f"chunk c/2 of the array {name}"):
        assert same(nh.resume(path, task=task).load(), whole)


@pytest.mark.profile("faults", keep=["edited", "flipped"])
@pytest.mark.parametrize("how", ["flipped", "cut", "empty", "edited"])
def test_damaged_mark_is_named_and_its_block_computed_again(how: str, tmp_path: Path) -> None:
    """A block whose mark cannot be trusted is computed again."""
    path = tmp_path / "run.zarr"
    whole = swept(path)
    mark = path / "run" / "blocks" / "2.json"
    if how == "edited":
        mark.write_text(mark.read_text().replace('"writer": "', '"writer": "another '))
    else:
        damage(mark, how)
    assert standing_of(path).done == 4
    with pytest.warns(RuntimeWarning, match=r"the mark 2\.json is damaged. Block 2 is computed again"):
        assert same(resumed(path), whole)
    assert standing_of(path).done == 6


def test_lost_mark_is_a_block_to_do(tmp_path: Path) -> None:
    """A block without a mark is one that was not finished, and is done in silence."""
    path = tmp_path / "run.zarr"
    whole = swept(path)
    damage(path / "run" / "blocks" / "0.json", "missing")
    damage(path / "total" / "c" / "0" / "0", "cut")
    assert same(resumed(path), whole)


@pytest.mark.profile("faults", keep=["x-flipped", "start-missing"])
@pytest.mark.parametrize("how", DAMAGE)
@pytest.mark.parametrize("axis", ["x", "start"])
def test_lost_axis_is_refused(axis: str, how: str, tmp_path: Path) -> None:
    """Where the values along an axis are gone, nothing is invented."""
    path = tmp_path / "run.zarr"
    swept(path)
    damage(path / axis / ("c/0" if axis == "x" else "c/0/0"), how)
    assert_refused(path, f"hold the axis {axis}.*Run the sweep again", resumed)


@pytest.mark.profile("faults", keep=["*-cut"])
@pytest.mark.parametrize("how", ["missing", "cut", "empty"])
@pytest.mark.parametrize(
    ("place", "match"), [("", "zarr.json"), ("noise", "hold the array noise"), ("x", "hold the array x")]
)
def test_lost_metadata_are_refused(place: str, match: str, how: str, tmp_path: Path) -> None:
    """Where metadata are gone, what they are of is named."""
    path = tmp_path / "run.zarr"
    swept(path)
    damage(path / place / "zarr.json", how)
    assert_refused(path, match, resumed)
    assert_refused(path, match if place else "must be a store of a sweep", functools.partial(swept, resume=True))


@pytest.mark.parametrize(
    ("one", "other"),
    [("noise/c/2/0/0", "noise/c/1/0/0"), ("total/c/0/0", "total/c/2/0"), ("run/blocks/0.json", "run/blocks/1.json")],
)
def test_a_block_in_the_place_of_another_is_computed_again(one: str, other: str, tmp_path: Path) -> None:
    """A checksum does not know where its chunk lies: the mark of the block does."""
    path = tmp_path / "run.zarr"
    whole = swept(path)
    swap(path, one, other)
    assert_refused(path, "of another place or store in block", nh.load_sweep)
    with pytest.warns(RuntimeWarning, match="of another place or store in block"):
        assert same(resumed(path), whole)
    assert same(nh.load_sweep(path), whole)


def test_metadata_of_another_array_are_refused(tmp_path: Path) -> None:
    """An array is the one that the description tells: dimensions, type and what is said of it."""
    path = tmp_path / "run.zarr"
    swept(path)
    swap(path, "total/zarr.json", "outcome/zarr.json")
    assert_refused(path, r"hold the array \w+ of its description", nh.load_sweep, resumed)
    swap(path, "total/zarr.json", "outcome/zarr.json")
    for name in ("outcome", "x"):
        for report in ("a text", {"scale_factor": 2.0}):
            file = path / name / "zarr.json"
            sound = file.read_text()
            file.write_text(json.dumps(json.loads(sound) | {"attributes": report}))
            assert_refused(path, f"hold the (array|axis) {name}", nh.load_sweep)
            file.write_text(sound)


@pytest.mark.parametrize("name", ["total", "start", "run"])
def test_consolidated_metadata_are_not_believed(name: str, tmp_path: Path) -> None:
    """They repeat what each array says of itself, which is what is read."""
    path = tmp_path / "run.zarr"
    whole = swept(path)
    document = json.loads((path / "zarr.json").read_text())
    document["consolidated_metadata"]["metadata"][name] = {"shape": None}
    (path / "zarr.json").write_text(json.dumps(document))
    assert same(nh.load_sweep(path), whole)
    (path / "run" / "zarr.json").write_text("{")
    assert_refused(path, "hold sound metadata", nh.load_sweep)


def test_an_axis_of_other_values_is_refused(tmp_path: Path) -> None:
    """The description holds the hash of what lies along an axis."""
    path, other = tmp_path / "run.zarr", tmp_path / "other.zarr"
    nh.sweep(lambda block: block["x"], nh.Grid({"x": [1.0, 2.0]}), path)
    nh.sweep(lambda block: block["x"], nh.Grid({"x": [1.0, 3.0]}), other)
    (path / "x" / "c" / "0").write_bytes((other / "x" / "c" / "0").read_bytes())
    assert_refused(path, "hold the axis x of its design", nh.load_sweep)


def test_a_mark_is_data(tmp_path: Path) -> None:
    """A mark of other entries is damaged, whatever its checksum says; what a task said cannot control a terminal."""
    path = tmp_path / "run.zarr"
    swept(path)
    written = (path / "run" / "blocks" / "0.json").read_text().partition(" ")[2]
    others = json.dumps(json.loads(written) | {"about": {"members": 1}})
    for text in (others, '{"members": 1}', "[" * 100_000, "7"):
        (path / "run" / "blocks" / "0.json").write_text(f"{zlib.crc32(text.encode()):08x} {text}")
        assert standing_of(path).done == 4
        assert_refused(path, r"mark 0\.json is damaged", nh.load_sweep)

    def failing(block: nh.MemberBlock) -> Any:
        if 1.5 in block["x"]:
            raise RuntimeError("a\x1b]0;gone\x07b")
        return block["x"]

    nh.sweep(failing, nh.Grid({"x": [1.0, 1.5]}), tmp_path / "raised.zarr")
    assert standing_of(tmp_path / "raised.zarr").messages == [(1, "RuntimeError: a?]0;gone?b")]
