"""The lock of a store that is being written, and how a run is cut into blocks."""

import contextlib
import errno
import inspect
import itertools
import json
import os
import shutil
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from stopping import stopped_in

import nonholo as nh
from nonholo.io import places
from nonholo.orbit import Plan


@pytest.fixture
def store(tmp_path: Path) -> Path:
    """A folder with the place of the lock."""
    (tmp_path / "run.zarr" / "run").mkdir(parents=True)
    return tmp_path / "run.zarr"


CONTAINER = ["unshare", "--pid", "--fork", "--kill-child", "--mount-proc"]


def _hold(store: Path, inside: str) -> str:
    start = "import os, pathlib, time\nfrom nonholo.io.places import write_lock\n"
    return f"{start}with write_lock(pathlib.Path({str(store)!r})):\n    {inside}"


@contextlib.contextmanager
def _holder(store: Path, prefix: list[str] | None = None) -> Iterator[subprocess.Popen[str]]:
    """Hold a lock in another process, which is killed in the end."""
    program = _hold(store, "print('held', flush=True); time.sleep(60)")
    command = [*(prefix or []), sys.executable, "-c", program]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as holder:  # noqa: S603
        assert holder.stdout is not None
        assert holder.stdout.readline() == "held\n"
        yield holder
        holder.kill()


def test_lock_names_its_owner_and_goes(store: Path) -> None:
    """A lock names process, host and time while it is held, and is gone afterwards, also after an error."""
    owners = []

    def fail_inside() -> None:
        with places.write_lock(store):
            owners.append(places.owner_of(store))
            raise KeyError

    with pytest.raises(KeyError):
        fail_inside()
    assert f"process {os.getpid()} on {socket.gethostname()} since 20" in str(owners[0])
    assert places.owner_of(store) is None
    assert list((store / "run").iterdir()) == []


@pytest.mark.parametrize("left", ["", "{", "[]", '{"pid": "x", "host": 3}', "[" * 100_000, '{"pid": 1e400}'])
def test_what_is_left_does_not_lock(left: str, store: Path) -> None:
    """Files of a lock whose process has ended do not count, whatever they say, and are gone afterwards."""
    (store / "run" / "lock.json").write_text(left)
    (store / "run" / "lock").touch()
    assert places.owner_of(store) is None
    with places.write_lock(store):
        assert str(os.getpid()) in str(places.owner_of(store))
    assert list((store / "run").iterdir()) == []


@pytest.mark.parametrize("message", [b"", b"{", b"[]", b"\xff\xfe", b"[" * 100_000, b'{"host": {}}'])
def test_held_lock_needs_no_name(message: bytes, store: Path) -> None:
    """A lock is held also if what tells its owner cannot be read, and a terminal is not controlled by it."""
    with places.write_lock(store):
        (store / "run" / "lock.json").write_bytes(message)
        with pytest.raises(BlockingIOError, match="an unknown process"), places.write_lock(store):
            pass
        (store / "run" / "lock.json").write_text(json.dumps({"pid": "\x1b]0;x\x07", "host": "h", "since": 1}))
        assert places.owner_of(store) == "process ?]0;x? on h since 1"


def test_lock_ends_with_its_process(store: Path) -> None:
    """A lock holds as long as its process, and not longer, though that is killed."""
    with _holder(store) as holder:
        assert f"process {holder.pid} on {socket.gethostname()}" in str(places.owner_of(store))
        with pytest.raises(BlockingIOError), places.write_lock(store):
            pass
    assert (store / "run" / "lock").exists()
    assert places.owner_of(store) is None
    with places.write_lock(store):
        pass


def test_lock_knows_no_process_numbers(store: Path) -> None:
    """Process 1 of one namespace is refused while process 1 of another one writes, and not when that was killed."""
    if subprocess.run([*CONTAINER, "true"], capture_output=True, check=False).returncode != 0:  # noqa: S603
        pytest.skip("namespaces of processes need rights that are not given here")
    other = [*CONTAINER, sys.executable, "-c", _hold(store, "print(os.getpid())")]
    with _holder(store, CONTAINER) as _:
        refused = subprocess.run(other, capture_output=True, text=True, check=False)  # noqa: S603
        assert "is being written by process 1 on" in refused.stderr
    assert subprocess.run(other, capture_output=True, text=True, check=True).stdout == "1\n"  # noqa: S603


def test_file_systems_without_locks_are_named(store: Path) -> None:
    """Where the file system has no locks, nothing is written, and the remedy is named."""
    missing = OSError(errno.ENOSYS, "Function not implemented")
    words = r"cannot be locked.*Function not implemented.*write it elsewhere.*run\.zarr"
    with stopped_in("fcntl.flock", missing, words), places.write_lock(store):
        pass


def test_one_of_many_takes_a_lock(store: Path) -> None:
    """Of several processes that want a lock at once, only one holds the store at a time."""
    (store / "run" / "lock").touch()
    script = f"""
import os, pathlib, time
from nonholo.io.places import write_lock
store, held = pathlib.Path({str(store)!r}), pathlib.Path({str(store)!r}) / "held"
inside = refused = 0
for trial in range(6):
    child = os.fork()
    if child == 0:
        code = 1
        try:
            with write_lock(store):
                os.close(os.open(held, os.O_CREAT | os.O_EXCL))  # fails if another one is inside
                time.sleep(1.5)
                held.unlink()
                code = 0
        except BlockingIOError:
            code = 2
        os._exit(code)
codes = [os.WEXITSTATUS(os.wait()[1]) for _ in range(6)]
print(codes.count(0), codes.count(2))
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)  # noqa: S603
    assert done.stdout.split() == ["1", "5"]


@pytest.mark.parametrize("every", [1, 3, 10])
@pytest.mark.parametrize("rows", [1, 2, 7])
@pytest.mark.parametrize("steps", [1, 20, 21, 59, 60])
def test_blocks_cover_every_step_and_state_once(steps: int, rows: int, every: int) -> None:
    """Blocks follow one another from step 0 to the last, and save the states of a run without blocks."""
    plan = Plan(steps, every, rows)
    ends = [(plan.begin(block), plan.stop(block)) for block in range(plan.blocks)]
    assert ends[0][0] == 0
    assert ends[-1][1] == steps
    assert all(one[1] == other[0] for one, other in itertools.pairwise(ends))
    saved = [stop // every - begin // every for begin, stop in ends]
    saved[0] += 1  # the start
    assert sum(saved) == 1 + steps // every
    assert all(number == rows for number in saved[:-1])


MAKER = """
import sys
from pathlib import Path
from nonholo.io.places import new_beside
with new_beside(Path(sys.argv[1])) as part:
    part.mkdir()
    print("making", flush=True)
    sys.stdin.read()
"""


def hidden(folder: Path) -> list[str]:
    """Return the names of hidden files in a folder."""
    return [path.name for path in folder.iterdir() if path.name.startswith(".")]


@pytest.mark.profile("faults", keep=["odd*"])
@pytest.mark.parametrize("name", ["run.zarr", "odd [1]*.zarr"])
def test_the_next_maker_removes_what_a_killed_one_left(name: str, tmp_path: Path) -> None:
    """Only of the same path, and only if its maker is dead."""
    orbit, path = _orbit(), tmp_path / name
    command = [sys.executable, "-c", MAKER, str(path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as maker:  # noqa: S603
        assert maker.stdout is not None
        maker.stdout.readline()
        remains = hidden(tmp_path)
        nh.save_orbit(orbit, path)
        assert sorted(hidden(tmp_path)) == sorted(remains) != []
        maker.kill()
    nh.save_orbit(orbit, tmp_path / "other.zarr")
    assert sorted(hidden(tmp_path)) == sorted(remains)
    nh.save_orbit(orbit, path, overwrite=True)
    assert hidden(tmp_path) == []
    assert len(nh.load_orbit(path)) == len(orbit)


def test_nothing_is_left_of_what_fails(tmp_path: Path) -> None:
    """Neither the partial file nor its lock."""
    complaint = "Nothing at this path was changed"
    with pytest.raises(OSError, match=complaint), places.new_beside(tmp_path / "run.zarr") as part:  # noqa: PT012
        part.write_text("half")
        raise OSError(28, "No space left on device")
    assert hidden(tmp_path) == []


def _orbit() -> nh.Orbit:
    return nh.simulate(nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1), restricted_velocity=(0.3, 0.2), steps=3)


@pytest.mark.parametrize("is_replaced", [False, True])
def test_store_that_was_being_replaced(is_replaced: bool, tmp_path: Path) -> None:
    """Whoever is killed between the two renames has the older store put back; after both it is gone for good."""
    path = tmp_path / "run.zarr"
    nh.save_orbit(_orbit(), path)
    (shutil.copytree if is_replaced else shutil.move)(path, tmp_path / ".run.zarr.0123.old")
    (tmp_path / ".run.zarr.0123.lock").touch()
    places.check_target(path, overwrite=True)
    assert len(nh.load_orbit(path)) == 4
    nh.save_orbit(_orbit(), path, overwrite=True)
    assert hidden(tmp_path) == []


def test_store_is_removed_at_once(tmp_path: Path) -> None:
    """A kill while its files are removed leaves nothing at the path: half a store would be no store to replace."""
    path = tmp_path / "run.zarr"
    nh.save_orbit(_orbit(), path)
    with stopped_in("shutil.rmtree"):
        places.remove_store(path)
    assert not path.exists()
    assert hidden(tmp_path) != []


def test_picture_of_a_killed_one(tmp_path: Path) -> None:
    """What was drawn half is removed by whoever draws there next, and the file has the suffix that was asked for."""
    path, part = tmp_path / "run.png", tmp_path / ".run.png.0123.partial"
    part.mkdir()
    (part / "run.png").write_text("half")
    part.with_suffix(".lock").touch()
    with places.complete_file(path) as drawn:
        assert Path(drawn).suffix == ".png"
        Path(drawn).write_text("whole")
    assert path.read_text() == "whole"
    assert hidden(tmp_path) == []


OPTIMIZED = """
import sys
import nonholo as nh
from nonholo.io.places import check_target
doors = (
    lambda: nh.load_orbit(sys.argv[1]),
    lambda: nh.resume(sys.argv[1]),
    lambda: check_target("new.zarr"),
    lambda: nh.sweep(print, nh.Grid({"x": [1.0]}), "new.zarr"),
)
for door in doors:
    try:
        door()
    except ValueError as refusal:
        print(refusal)
"""
WORDS = "must be run by Python with assertions. Got python -O or PYTHONOPTIMIZE"


@pytest.mark.profile("faults", instead="test_refusal_without_assertions")
def test_python_without_assertions(tmp_path: Path) -> None:
    """Under `python -O`, where zarr does not work, every door of stores says so before any work."""
    nh.save_orbit(_orbit(), tmp_path / "run.zarr")
    command = [sys.executable, "-O", "-c", OPTIMIZED, str(tmp_path / "run.zarr")]
    report = subprocess.run(command, capture_output=True, text=True, check=True, cwd=tmp_path)  # noqa: S603
    assert report.stdout.count(WORDS) == 4
    assert [path.name for path in tmp_path.iterdir()] == ["run.zarr"]


def test_refusal_without_assertions() -> None:
    """The check of every door, as Python compiles it with -O, refuses; as it is here, it does not."""
    source, names = inspect.getsource(places.check_assertions), dict(vars(places))
    exec(compile(source, "optimized", "exec", optimize=1), names)  # noqa: S102
    with pytest.raises(ValueError, match=WORDS):
        names["check_assertions"]("save_orbit(path=...)")
    places.check_assertions("save_orbit(path=...)")
