"""What a process that was killed while it made a store leaves, and who removes it."""

import subprocess
import sys
from pathlib import Path

import pytest

import nonholo as nh
from nonholo.io import new_beside

MAKER = """
import sys
from pathlib import Path
from nonholo.io import new_beside
with new_beside(Path(sys.argv[1])) as part:
    part.mkdir()
    print("making", flush=True)
    sys.stdin.read()
"""


def hidden(folder: Path) -> list[str]:
    """Return the names of hidden files in a folder."""
    return [path.name for path in folder.iterdir() if path.name.startswith(".")]


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
