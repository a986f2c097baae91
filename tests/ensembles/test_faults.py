"""Sweeps that are killed, damaged, or run into a full disk: what is there at the end is the undisturbed sweep."""

import errno
import json
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray
from ensembles import faults

import nonholo as nh
from nonholo import io
from nonholo.ensembles import standing_of
from nonholo.ensembles._layout import Piece
from nonholo.ensembles._store import SweepStore

DESIGN = nh.Grid({"x": [1.0, 2.0, 3.0], "start": [[0.0, 1.0], [2.0, 3.0]]}, seed=1)
ARRAYS = {"total": "c/1/0", "noise": "c/1/0/0", "outcome": "c/1/0"}
KILLS = {"threads": ["client"] * 8, "processes": ["worker", "all", "client", "worker"]}


def simple(block: nh.MemberBlock) -> dict[str, Any]:
    """Return numbers that depend on the design and on the random numbers of members."""
    return {"total": block["x"] + block["start"][:, 0], "noise": (("component",), block.random(3))}


def _swept(path: Path, **options: Any) -> xarray.Dataset:
    return nh.sweep(simple, DESIGN, path, **{"scheduler": "synchronous", "block": 2, **options}).load()


def _resumed(path: Path, **options: Any) -> xarray.Dataset:
    return nh.resume(path, task=simple, **{"scheduler": "synchronous", **options}).load()


def _same(one: xarray.Dataset, other: xarray.Dataset) -> bool:
    return one.variables.keys() == other.variables.keys() and all(
        one[name].dims == other[name].dims
        and one[name].dtype == other[name].dtype
        and one[name].values.tobytes() == other[name].values.tobytes()
        for name in one.variables
    )


def _stop_at(monkeypatch: pytest.MonkeyPatch, block: int, failure: BaseException) -> None:
    """Let the writing of a block end in a failure."""
    write = SweepStore.write

    def failing(self: SweepStore, piece: Piece, *rest: Any) -> None:
        if piece.number == block:
            raise failure
        write(self, piece, *rest)

    monkeypatch.setattr(SweepStore, "write", failing)


def _python(code: str, **options: Any) -> subprocess.Popen[str]:
    """Start a process that knows the sweeps to be disturbed."""
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[1])}
    program = f"from ensembles.faults import *\n{code}"
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    return subprocess.Popen([sys.executable, "-c", program], env=environment, **pipes, **options)  # noqa: S603


def _printed(code: str) -> str:
    process = _python(code)
    told, complaint = process.communicate(timeout=100)
    assert process.returncode == 0, complaint
    return told


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="looks for processes in /proc")
@pytest.mark.parametrize(
    ("name", "scheduler"), [("noisy", "threads"), ("tops", "threads"), ("noisy", "processes")], ids=str
)
def test_killed_sweeps_go_on(name: str, scheduler: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Killed at 20 random moments in all, and resumed, sweeps are the undisturbed ones and leave no rubbish."""
    path, victims = tmp_path / "killed.zarr", KILLS[scheduler]
    ended = int(_printed(f"kill_often({name!r}, Path({str(path)!r}), {scheduler!r}, {victims})"))
    task, design, block = faults.SWEEPS[name]
    blocks = -(-design.members // block)
    with capsys.disabled():
        sys.stdout.write(
            f" {name}, {scheduler}: {ended} of {len(victims)} kills, {faults.done(path)} of {blocks} blocks"
        )
    assert ended == len(victims)
    assert 0 < faults.done(path) < blocks, "the last kill has to come before the end: the sweep has to be longer"
    found = nh.resume(path).load()
    assert _same(found, nh.sweep(task, design, tmp_path / "whole.zarr", block=design.members).load())
    assert not list(path.rglob("*.partial"))
    assert standing_of(path).owner is None


@pytest.mark.parametrize("scheduler", ["threads", "processes"])
def test_interrupted_sweep_goes_on(scheduler: str, tmp_path: Path) -> None:
    """Ctrl-C says how far the sweep came and how to go on, and nothing else; the store is valid."""
    path = tmp_path / "run.zarr"
    process = _python(f"go_on('noisy', Path({str(path)!r}), {scheduler!r})", start_new_session=True)
    faults.wait_for(lambda: faults.done(path) > 3)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does
    _, complaint = process.communicate(timeout=30)
    assert process.returncode == -signal.SIGINT
    now = standing_of(path)
    assert 0 < now.done < now.members
    last = f"Stopped at {now.done} of 2400 members, 0 of them failed. Go on with nonholo.resume('{path}')"
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
                _swept(tmp_path / "run.zarr", block=1, resume=True)
    assert _same(_swept(tmp_path / "run.zarr", resume=True), _swept(tmp_path / "whole.zarr"))


def test_end_between_the_last_two_writes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A sweep that was killed before its metadata were consolidated is finished by resuming it."""
    path = tmp_path / "run.zarr"
    with monkeypatch.context() as patch:
        patch.setattr(io, "consolidate", lambda _: (_ for _ in ()).throw(KeyboardInterrupt))
        with pytest.raises(KeyboardInterrupt, match="Stopped at 6 of 6"):
            _swept(path)
    with pytest.raises(ValueError, match="must be a finished sweep"):
        nh.load_sweep(path)
    assert _same(_resumed(path), _swept(tmp_path / "whole.zarr"))
    assert _same(nh.load_sweep(path), _swept(tmp_path / "other.zarr"))


@pytest.mark.parametrize("scheduler", ["synchronous", "threads"])
def test_full_disk_leaves_a_valid_store(scheduler: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A full disk is an error that names the store, the standing and the remedy; with room again the sweep goes on."""
    path = tmp_path / "run.zarr"
    with monkeypatch.context() as patch:
        _stop_at(patch, 2, OSError(errno.ENOSPC, "No space left on device"))
        with pytest.raises(OSError, match=r"No space left.*of 6 members.*Free space, then call.*run\.zarr") as caught:
            _swept(path, scheduler=scheduler)
    assert caught.value.errno == errno.ENOSPC
    with pytest.raises(ValueError, match="must be a finished sweep"):
        nh.load_sweep(path)
    assert _same(_resumed(path), _swept(tmp_path / "whole.zarr"))


@pytest.mark.parametrize("scheduler", ["threads", "processes"])
def test_limit_of_the_system_on_file_sizes(scheduler: str, tmp_path: Path) -> None:
    """A limit met while zarr writes ends in the same clean error, and the sweep goes on without it."""
    path = tmp_path / "run.zarr"
    told = _printed(f"""
import resource
resource.setrlimit(resource.RLIMIT_FSIZE, (15_000, 15_000))
try:
    nh.sweep(noisy, SWEEPS["noisy"][1], Path({str(path)!r}), {scheduler!r}, block=1200, workers=1)
except OSError as failure:
    print(failure.errno, failure)
""")
    assert told.startswith(f"{errno.EFBIG} ")
    assert "File too large. The sweep stands at 0 of 2400 members, 0 of them failed. Free space, then call" in told
    task, design, _ = faults.SWEEPS["noisy"]
    assert _same(nh.resume(path).load(), nh.sweep(task, design, tmp_path / "whole.zarr", block=2400).load())


def test_no_room_for_a_store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """If not even the empty store can be written, nothing is left at its path nor beside it."""
    full = OSError(errno.ENOSPC, "No space left on device")
    monkeypatch.setattr(io, "create_array", lambda *_, **__: (_ for _ in ()).throw(full))
    with pytest.raises(OSError, match=r"No space left on device. Nothing was computed yet.*run\.zarr"):
        _swept(tmp_path / "run.zarr")
    assert not list(tmp_path.iterdir())


def _damage(file: Path, how: str) -> None:
    content = bytearray(file.read_bytes())
    if how == "missing":
        file.unlink()
        return
    content[len(content) // 2] ^= 1
    file.write_bytes({"flipped": content, "cut": content[:-3], "empty": b""}[how])


@pytest.mark.parametrize("array", ARRAYS)
@pytest.mark.parametrize("damage", ["missing", "flipped", "cut", "empty"])
def test_damaged_chunk_is_named_and_computed_again(array: str, damage: str, tmp_path: Path) -> None:
    """A missing, changed or cut chunk is never read: it is named, refused by `load_sweep`, and computed again."""
    path = tmp_path / "run.zarr"
    whole = _swept(path)
    _damage(path / array / ARRAYS[array], damage)
    named = f"chunk {ARRAYS[array]} of the array {array}"
    with pytest.raises(ValueError, match=named):
        nh.load_sweep(path)
    with pytest.warns(RuntimeWarning, match=f"{named}. Block 1 is computed again"):
        assert _same(_resumed(path), whole)
    assert _same(nh.load_sweep(path), whole)
    assert _same(_resumed(path), whole), "a sound store is opened in silence"


@pytest.mark.parametrize("name", ["x", "restricted_velocity"])
def test_damaged_draws_are_computed_again(name: str, tmp_path: Path) -> None:
    """What a random design drew is kept beside the results, and is as safe."""
    path, design = tmp_path / "run.zarr", nh.RandomDesign(6, {name: nh.Uniform(0.0, 1.0)}, seed=2)
    task: Callable[[nh.MemberBlock], Any] = lambda block: block[name] ** 2  # noqa: E731
    whole = nh.sweep(task, design, path, block=2).load()
    _damage(path / name / "c" / "2", "flipped")
    with pytest.warns(RuntimeWarning, match=f"chunk c/2 of the array {name}"):
        assert _same(nh.resume(path, task=task).load(), whole)


@pytest.mark.parametrize("damage", ["flipped", "cut", "empty"])
def test_damaged_mark_is_named_and_its_block_computed_again(damage: str, tmp_path: Path) -> None:
    """A block whose mark cannot be trusted is computed again."""
    path = tmp_path / "run.zarr"
    whole = _swept(path)
    _damage(path / "run" / "blocks" / "2.json", damage)
    assert standing_of(path).done == 4
    with pytest.warns(RuntimeWarning, match=r"the mark 2\.json is damaged. Block 2 is computed again"):
        assert _same(_resumed(path), whole)
    assert standing_of(path).done == 6


def test_lost_mark_is_a_block_to_do(tmp_path: Path) -> None:
    """A block without a mark is one that was not finished, and is done in silence."""
    path = tmp_path / "run.zarr"
    whole = _swept(path)
    _damage(path / "run" / "blocks" / "0.json", "missing")
    _damage(path / "total" / "c" / "0" / "0", "cut")
    assert _same(_resumed(path), whole)


@pytest.mark.parametrize("damage", ["missing", "flipped", "cut", "empty"])
@pytest.mark.parametrize("axis", ["x", "start"])
def test_lost_axis_is_refused(axis: str, damage: str, tmp_path: Path) -> None:
    """Where the values along an axis are gone, nothing is invented."""
    path = tmp_path / "run.zarr"
    _swept(path)
    _damage(path / axis / ("c/0" if axis == "x" else "c/0/0"), damage)
    with pytest.raises(ValueError, match=f"hold the axis {axis}.*Run the sweep again"):
        _resumed(path)


@pytest.mark.parametrize("damage", ["missing", "cut", "empty"])
@pytest.mark.parametrize(
    ("place", "match"), [("", "zarr.json"), ("noise", "hold the array noise"), ("x", "hold the array x")]
)
def test_lost_metadata_are_refused(place: str, match: str, damage: str, tmp_path: Path) -> None:
    """Where metadata are gone, what they are of is named."""
    path = tmp_path / "run.zarr"
    _swept(path)
    _damage(path / place / "zarr.json", damage)
    with pytest.raises(ValueError, match=match):
        _resumed(path)
    with pytest.raises(ValueError, match=match if place else "must be a store of a sweep"):
        _swept(path, resume=True)


def test_second_process_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """While one process writes a store, another one is refused, and told who writes it."""
    path, told = tmp_path / "run.zarr", []
    write = SweepStore.write

    def meanwhile(self: SweepStore, piece: Piece, *rest: Any) -> None:
        if piece.number == 1:
            told.append(standing_of(path).owner)
            other = _python(f"nh.resume({str(path)!r}, task=noisy)")
            told.append(other.communicate(timeout=60)[1].splitlines()[-1])
        write(self, piece, *rest)

    monkeypatch.setattr(SweepStore, "write", meanwhile)
    task, design, _ = faults.SWEEPS["noisy"]
    nh.sweep(task, design, path, "synchronous", block=1200)
    assert told[0].startswith(f"process {os.getpid()} on ")
    assert told[1].startswith("BlockingIOError")
    assert f"is being written by {told[0]}" in told[1]
    assert standing_of(path).finished


def test_stale_lock_is_recognised(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A lock that a process left which has ended does not count, and neither do its half-written files."""
    path = tmp_path / "run.zarr"
    with monkeypatch.context() as patch:
        _stop_at(patch, 1, KeyboardInterrupt())
        with pytest.raises(KeyboardInterrupt):
            _swept(path)
    ended = _python("")
    ended.communicate()
    (path / "run" / "lock.json").write_text(json.dumps({"pid": ended.pid, "host": os.uname().nodename, "since": "1"}))
    strays = [path / "total" / "c" / "1" / "0.1f.partial", path / "run" / "blocks" / "1.json.2e.partial"]
    for stray in strays:
        stray.parent.mkdir(parents=True, exist_ok=True)
        stray.write_bytes(b"half")
    assert standing_of(path).owner is None
    assert _same(_resumed(path), _swept(tmp_path / "whole.zarr"))
    assert not any(stray.exists() for stray in strays)


def test_moved_store_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A store that was moved to another folder goes on there; another one in its old place is another one."""
    path, moved = tmp_path / "run.zarr", tmp_path / "elsewhere" / "moved.zarr"
    with monkeypatch.context() as patch:
        _stop_at(patch, 1, KeyboardInterrupt())
        with pytest.raises(KeyboardInterrupt):
            _swept(path)
    moved.parent.mkdir()
    path.rename(moved)
    whole = _swept(path, block=3)
    assert _same(_resumed(moved), whole)
    assert _same(nh.load_sweep(moved), whole)


def test_store_made_again_at_the_same_path(tmp_path: Path) -> None:
    """A store that is removed and made again with other blocks is not taken for the old one."""
    path = tmp_path / "run.zarr"
    _swept(path, block=1)
    path.rename(tmp_path / "old.zarr")
    assert _same(_swept(path, block=3), nh.load_sweep(tmp_path / "old.zarr").load())
    assert standing_of(path).done == 6


def test_existing_path_is_refused(tmp_path: Path) -> None:
    """What is at a path is never overwritten, be it a store, a folder or a file."""
    store, folder, file = (tmp_path / name for name in ("run.zarr", "folder", "file"))
    whole = _swept(store)
    folder.mkdir()
    file.write_text("mine")
    for path in (store, folder, file):
        with pytest.raises(FileExistsError, match=r"must be new.*Choose another path.*resume=True"):
            _swept(path)
    assert _same(nh.load_sweep(store), whole)
    assert not list(folder.iterdir())
    assert file.read_text() == "mine"


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="root has to become another user")
def test_read_only_folder_is_refused() -> None:
    """A folder that may not be written is an error with its path; a finished store there can still be loaded."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        whole = _swept(folder / "run.zarr")
        folder.chmod(0o755)
        os.seteuid(65534)
        try:
            with pytest.raises(PermissionError, match=r"Permission denied\. Nothing was computed yet.*new\.zarr"):
                _swept(folder / "new.zarr")
            with pytest.raises(PermissionError):
                _resumed(folder / "run.zarr")
            found = nh.load_sweep(folder / "run.zarr").load()
        finally:
            os.seteuid(0)
        assert _same(found, whole)
        assert [path.name for path in folder.iterdir()] == ["run.zarr"]


SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
SLEIGHS = nh.Grid({"a": [0.1, 0.2]})


def _sleighs(path: Path, *, time_step: float = 0.1, values: Any = (0.1, 0.2), **options: Any) -> xarray.Dataset:
    sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), time_step)
    task = nh.EnsembleTask(sleigh, **{"steps": 3, "restricted_velocity": (1.0, 0.5), **options})
    return nh.sweep(task, nh.Grid({"a": values}), path, resume=True)


@pytest.mark.parametrize(
    ("changes", "match"),
    [
        ({"steps": 4}, r"task\.steps is 4 instead of 3"),
        ({"restricted_velocity": (1.0, 0.6)}, r"task\.start is .*0\.6\]\] instead of .*0\.5"),
        ({"reductions": ["energy_drift"]}, r'task\.reductions is \["energy_drift"\] instead of \["final_state"\]'),
        ({"time_step": 0.2}, r"task\.motion is .*0\.2.* instead of .*0\.1"),
        ({"values": (0.1, 0.3)}, r"design\.axes\.a is"),
        ({"values": (0.1, 0.2, 0.3)}, r"design\.axes\.a is"),
    ],
)
def test_another_sweep_is_refused(changes: dict[str, Any], match: str, tmp_path: Path) -> None:
    """A store is not gone on with by another task or design: the difference is named, and nothing is changed."""
    path = tmp_path / "run.zarr"
    whole = _sleighs(path).load()
    with pytest.raises(ValueError, match=f"must hold this sweep.*where {match}"):
        _sleighs(path, **changes)
    assert _same(_sleighs(path), whole)


def _functions(path: Path) -> None:
    _swept(path)
    nh.resume(path, task=faults.noisy)


def _another_seed(path: Path) -> None:
    _swept(path)
    nh.sweep(simple, nh.Grid(DESIGN.axes, seed=2), path, resume=True)


def _another_kind_of_design(path: Path) -> None:
    _swept(path)
    nh.sweep(simple, nh.RandomDesign(6, {"x": nh.Normal()}, seed=1), path, resume=True)


def _another_schema(path: Path) -> None:
    _swept(path)
    document = json.loads((path / "zarr.json").read_text())
    document["attributes"]["schema"] = 99
    (path / "zarr.json").write_text(json.dumps(document))
    _resumed(path)


def _orbit(path: Path) -> None:
    nh.simulate(SLEIGH, steps=20, restricted_velocity=(1.0, 0.0), store=path)


def _sweep_where_an_orbit_is(path: Path) -> None:
    _orbit(path)
    _swept(path, resume=True)


def _load_an_orbit_as_a_sweep(path: Path) -> None:
    _orbit(path)
    nh.load_sweep(path)


def _load_a_sweep_as_an_orbit(path: Path) -> None:
    _swept(path)
    nh.load_orbit(path)


def _task_for_an_orbit(path: Path) -> None:
    _orbit(path)
    nh.resume(path, task=simple)


def _scheduler_for_an_orbit(path: Path) -> None:
    _orbit(path)
    nh.resume(path, scheduler="threads")


def _system_for_a_sweep(path: Path) -> None:
    _swept(path)
    nh.resume(path, discrete=SLEIGH)


def _no_store(path: Path) -> None:
    path.mkdir()
    nh.resume(path)


@pytest.mark.parametrize(
    ("mistake", "match"),
    [
        (_functions, r'task\.name is "ensembles\.faults:noisy" instead of ".*test_faults:simple"'),
        (_another_seed, r"design\.seed is 2 instead of 1"),
        (_another_kind_of_design, r'design\.kind is "RandomDesign" instead of "Grid"'),
        (_another_schema, r"have a schema of \(1,\). Got schema 99"),
        (_sweep_where_an_orbit_is, "a store of an orbit"),
        (_load_an_orbit_as_a_sweep, "a store of an orbit"),
        (_load_a_sweep_as_an_orbit, "a store of a sweep"),
        (_task_for_an_orbit, "come with the store of a sweep"),
        (_scheduler_for_an_orbit, "come with the store of a sweep"),
        (_system_for_a_sweep, "come with the store of an orbit"),
        (_no_store, "must be a store of a run or a sweep"),
    ],
)
def test_wrong_stores_are_refused(mistake: Callable[[Path], None], match: str, tmp_path: Path) -> None:
    """What does not belong together is refused, with the difference named."""
    with pytest.raises(ValueError, match=match):
        mistake(tmp_path / "run.zarr")


def test_nothing_at_the_path_is_refused(tmp_path: Path) -> None:
    """A path at which there is nothing is named."""
    for call in (nh.resume, nh.load_sweep):
        with pytest.raises(FileNotFoundError, match=r"nothing\.zarr"):
            call(tmp_path / "nothing.zarr")


def test_orbits_are_resumed_as_ever(tmp_path: Path) -> None:
    """A finished orbit's store is an orbit, whatever the door."""
    _orbit(tmp_path / "run.zarr")
    orbit = nh.simulate(SLEIGH, steps=20, restricted_velocity=(1.0, 0.0))
    assert np.array_equal(nh.resume(tmp_path / "run.zarr").reduced_momentum, orbit.reduced_momentum)


def test_tasks_without_a_name_have_to_be_passed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A task that no process can import is asked for by `resume`, and goes on once it is passed."""
    path, task = tmp_path / "run.zarr", lambda block: simple(block)
    mixed = nh.EnsembleTask(SLEIGH, steps=3, restricted_velocity=(1.0, 0.5), reductions=[lambda batch: batch.outcome])
    for store, each, design in ((path, task, DESIGN), (tmp_path / "mixed.zarr", mixed, SLEIGHS)):
        with monkeypatch.context() as patch:
            _stop_at(patch, 0, KeyboardInterrupt())
            with pytest.raises(KeyboardInterrupt):
                nh.sweep(each, design, store, "synchronous")
        with pytest.raises(ValueError, match=r"task can be made again.*without an importable name.*task=\.\.\."):
            nh.resume(store)
        assert _same(nh.resume(store, task=each).load(), nh.sweep(each, design, f"{store}.whole").load())


def test_tasks_with_a_name_are_found(tmp_path: Path) -> None:
    """A function that any process can import, and an `EnsembleTask` of data, need not be passed."""
    for name in ("noisy", "tops"):
        task, design, _ = faults.SWEEPS[name]
        whole = nh.sweep(task, design, tmp_path / name, block=design.members).load()
        (tmp_path / name / "run" / "blocks" / "0.json").unlink()
        assert _same(nh.resume(tmp_path / name).load(), whole)
