"""The lock of a store that is being written, and how a run is cut into blocks."""

import contextlib
import errno
import fcntl
import itertools
import json
import os
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from nonholo.io.places import owner_of, write_lock
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
        with write_lock(store):
            owners.append(owner_of(store))
            raise KeyError

    with pytest.raises(KeyError):
        fail_inside()
    assert f"process {os.getpid()} on {socket.gethostname()} since 20" in str(owners[0])
    assert owner_of(store) is None
    assert list((store / "run").iterdir()) == []


def test_held_lock_is_refused(store: Path) -> None:
    """A second owner is refused, the first one is named, and its lock stays."""
    with write_lock(store):
        with pytest.raises(BlockingIOError, match=f"being written by process {os.getpid()} on"), write_lock(store):
            pass
        assert owner_of(store) is not None


@pytest.mark.parametrize("left", ["", "{", "[]", '{"pid": "x", "host": 3}', "[" * 100_000, '{"pid": 1e400}'])
def test_what_is_left_does_not_lock(left: str, store: Path) -> None:
    """Files of a lock whose process has ended do not count, whatever they say, and are gone afterwards."""
    (store / "run" / "lock.json").write_text(left)
    (store / "run" / "lock").touch()
    assert owner_of(store) is None
    with write_lock(store):
        assert str(os.getpid()) in str(owner_of(store))
    assert list((store / "run").iterdir()) == []


@pytest.mark.parametrize("told", [b"", b"{", b"[]", b"\xff\xfe", b"[" * 100_000, b'{"host": {}}'])
def test_held_lock_needs_no_name(told: bytes, store: Path) -> None:
    """A lock is held also if what tells its owner cannot be read, and a terminal is not controlled by it."""
    with write_lock(store):
        (store / "run" / "lock.json").write_bytes(told)
        with pytest.raises(BlockingIOError, match="an unknown process"), write_lock(store):
            pass
        (store / "run" / "lock.json").write_text(json.dumps({"pid": "\x1b]0;x\x07", "host": "h", "since": 1}))
        assert owner_of(store) == "process ?]0;x? on h since 1"


def test_lock_ends_with_its_process(store: Path) -> None:
    """A lock holds as long as its process, and not longer, though that is killed."""
    with _holder(store) as holder:
        assert f"process {holder.pid} on {socket.gethostname()}" in str(owner_of(store))
        with pytest.raises(BlockingIOError), write_lock(store):
            pass
    assert (store / "run" / "lock").exists()
    assert owner_of(store) is None
    with write_lock(store):
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


def test_file_systems_without_locks_are_named(store: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the file system has no locks, nothing is written, and the remedy is named."""

    def missing(*_: object) -> None:
        raise OSError(errno.ENOSYS, "Function not implemented")

    monkeypatch.setattr(fcntl, "flock", missing)
    with pytest.raises(OSError, match=r"cannot be locked.*Function not implemented.*write it elsewhere.*run\.zarr"):
        _ = write_lock(store).__enter__()


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
