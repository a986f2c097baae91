"""The lock of a store that is being written, and how a run is cut into blocks."""

import itertools
import json
import os
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from nonholo.io import Plan, locked, owner_of


@pytest.fixture
def store(tmp_path: Path) -> Path:
    """A folder with the place of the lock."""
    (tmp_path / "run.zarr" / "run").mkdir(parents=True)
    return tmp_path / "run.zarr"


def _lock(store: Path, content: str) -> Path:
    path = store / "run" / "lock.json"
    path.write_text(content)
    return path


def _dead_process() -> int:
    """Return the number of a process that has ended."""
    process = subprocess.Popen([sys.executable, "-c", ""])
    process.wait()
    return process.pid


def _named(pid: int, host: str | None = None) -> str:
    return json.dumps({"pid": pid, "host": host or socket.gethostname(), "since": "2026-01-01T00:00:00+00:00"})


def test_lock_names_its_owner_and_goes(store: Path) -> None:
    """A lock names process, host and time while it is held, and is gone afterwards, also after an error."""
    owners = []

    def fail_inside() -> None:
        with locked(store):
            owners.append(owner_of(store))
            raise KeyError

    with pytest.raises(KeyError):
        fail_inside()
    assert f"process {os.getpid()} on {socket.gethostname()} since 20" in str(owners[0])
    assert owner_of(store) is None
    assert list((store / "run").iterdir()) == []


def test_held_lock_is_refused(store: Path) -> None:
    """A second owner is refused, the first one is named, and its lock stays."""
    with locked(store):
        with pytest.raises(BlockingIOError, match=f"being written by process {os.getpid()} on"), locked(store):
            pass
        assert owner_of(store) is not None


def test_stale_lock_is_taken_over(store: Path) -> None:
    """The lock of a process of this host that has ended does not count."""
    _lock(store, _named(_dead_process()))
    assert owner_of(store) is None
    with locked(store):
        assert str(os.getpid()) in str(owner_of(store))
    assert list((store / "run").iterdir()) == []


def test_lock_of_another_host_is_refused(store: Path) -> None:
    """Whether a process of another host lives is not known: its lock holds, and the file to remove is named."""
    path = _lock(store, _named(_dead_process(), "elsewhere"))
    with pytest.raises(BlockingIOError, match=r"on elsewhere since 2026-01-01.*remove '.*lock\.json'"), locked(store):
        pass
    assert path.exists()


@pytest.mark.parametrize("content", ["", "{", "[]", '{"pid": "x", "host": 3}'])
def test_unreadable_lock_is_refused(content: str, store: Path) -> None:
    """A lock that names nobody holds too."""
    _lock(store, content)
    with pytest.raises(BlockingIOError, match=r"remove '.*lock\.json'"), locked(store):
        pass


def test_one_of_many_takes_a_stale_lock_over(store: Path) -> None:
    """Of several processes that find a stale lock at once, only one holds the store at a time."""
    _lock(store, _named(_dead_process()))
    script = f"""
import os, pathlib, time
from nonholo.io import locked
store, held = pathlib.Path({str(store)!r}), pathlib.Path({str(store)!r}) / "held"
inside = refused = 0
for trial in range(6):
    child = os.fork()
    if child == 0:
        code = 1
        try:
            with locked(store):
                os.close(os.open(held, os.O_CREAT | os.O_EXCL))  # fails if another one is inside
                time.sleep(0.3)
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
