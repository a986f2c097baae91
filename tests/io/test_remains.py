"""What a process that was killed while it made a store leaves, and who removes it."""

import inspect
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import nonholo as nh
from nonholo.io.places import check_assertions, check_target, complete_file, new_beside, remove_store

MAKER = """
import sys
from pathlib import Path
from nonholo.io.places import check_assertions
from nonholo.io.places import check_target, complete_file, new_beside, remove_store
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
    orbit = nh.simulate(nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1), restricted_velocity=(0.3, 0.2), steps=3)
    path = tmp_path / name
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
    with pytest.raises(OSError, match=complaint), new_beside(tmp_path / "run.zarr") as part:  # noqa: PT012
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
    check_target(path, overwrite=True)
    assert len(nh.load_orbit(path)) == 4
    nh.save_orbit(_orbit(), path, overwrite=True)
    assert hidden(tmp_path) == []


def test_store_is_removed_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A kill while its files are removed leaves nothing at the path: half a store would be no store to replace."""

    def stopped(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    path = tmp_path / "run.zarr"
    nh.save_orbit(_orbit(), path)
    monkeypatch.setattr(shutil, "rmtree", stopped)
    with pytest.raises(KeyboardInterrupt):
        remove_store(path)
    assert not path.exists()
    assert hidden(tmp_path) != []


def test_picture_of_a_killed_one(tmp_path: Path) -> None:
    """What was drawn half is removed by whoever draws there next, and the file has the suffix that was asked for."""
    path, part = tmp_path / "run.png", tmp_path / ".run.png.0123.partial"
    part.mkdir()
    (part / "run.png").write_text("half")
    part.with_suffix(".lock").touch()
    with complete_file(path) as drawn:
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
    told = subprocess.run(command, capture_output=True, text=True, check=True, cwd=tmp_path)  # noqa: S603
    assert told.stdout.count(WORDS) == 4
    assert [path.name for path in tmp_path.iterdir()] == ["run.zarr"]


def test_refusal_without_assertions() -> None:
    """The check of every door, as Python compiles it with -O, refuses; as it is here, it does not."""
    source, names = inspect.getsource(check_assertions), dict(vars(sys.modules[check_assertions.__module__]))
    exec(compile(source, "optimized", "exec", optimize=1), names)  # noqa: S102
    with pytest.raises(ValueError, match=WORDS):
        names["check_assertions"]("save_orbit(path=...)")
    check_assertions("save_orbit(path=...)")
