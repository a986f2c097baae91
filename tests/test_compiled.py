"""Compiled code on disk: damaged, stale, without a place to lie, on a full disk."""

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from numba.core import config

import nonholo as nh
from nonholo.base.compiled import by_numba, njit
from nonholo.base.compiled.by_numba import private_folder

DAMAGE: dict[str, Callable[[bytes], bytes]] = {
    "cut": lambda content: content[: len(content) // 2],
    "empty": lambda _: b"",
    "garbage": lambda _: b"not a pickle",
    "one bit": lambda content: content[:-100] + bytes([content[-100] ^ 1]) + content[-99:],
    "longer": lambda content: content + content,
}


def times(factor: float) -> Any:
    """Return a kernel with a closure, as a process that has just begun makes it."""

    @njit()
    def multiplied(x: float) -> float:
        return factor * x

    return multiplied


def used_cache(kernel: Any) -> bool:
    """Tell whether the code of a kernel came from the disk, and check it."""
    assert kernel(2.0) == 6.0
    return kernel.stats.cache_hits == {kernel.signatures[0]: 1}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Keep compiled code in a folder of the test."""
    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path))
    return tmp_path


@pytest.mark.parametrize("damage", DAMAGE)
def test_damaged_code_is_compiled_again(damage: str, folder: Path) -> None:
    """A file that was cut or changed is as good as none, and is replaced by a whole one."""
    assert not used_cache(times(3.0))
    assert used_cache(times(3.0))
    (file,) = folder.rglob("*.nbc")
    file.write_bytes(DAMAGE[damage](file.read_bytes()))
    assert not used_cache(times(3.0))
    assert used_cache(times(3.0))


def test_code_of_another_closure_is_not_used(folder: Path) -> None:
    """Kernels that differ in what they close over share a file, and do not share code."""
    assert times(5.0)(2.0) == 10.0
    assert not used_cache(times(3.0))
    assert len(list(folder.rglob("*.nbc"))) == 1


@pytest.mark.usefixtures("folder")
def test_code_of_other_kernels_is_not_used(monkeypatch: pytest.MonkeyPatch) -> None:
    """A changed text of any kernel, which may be inlined in any other, makes all code stale."""
    assert not used_cache(times(3.0))
    monkeypatch.setattr(by_numba, "text_of_kernels", lambda: b"another text")
    assert not used_cache(times(3.0))


def test_full_disk(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Code that cannot be written stays in memory."""

    def full(*_: Any) -> Any:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(by_numba._Files, "_open_for_write", full)
    assert not used_cache(times(3.0))
    assert not list(folder.rglob("*.nbc"))


def test_flushed_code_is_gone(folder: Path) -> None:
    """What numba calls to compile a function again deletes the files of that function."""
    kernel = times(3.0)
    assert not used_cache(kernel)
    kernel._cache.flush()
    assert not list(folder.rglob("*.nbc"))


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="users of POSIX")
def test_the_private_folder_is_private(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is used again; one that is open to others, another user's, or a link is not used."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    folder = private_folder()
    assert private_folder() == folder
    folder.chmod(0o755)
    with pytest.raises(PermissionError):
        private_folder()
    folder.rename(tmp_path / "elsewhere").chmod(0o700)
    folder.symlink_to(tmp_path / "elsewhere")
    with pytest.raises(PermissionError):
        private_folder()
    monkeypatch.setattr(os, "geteuid", lambda: 4711)
    (tmp_path / "nonholo-4711").mkdir(mode=0o700)
    with pytest.raises(PermissionError):
        private_folder()


@pytest.mark.parametrize(("places", "said"), [([by_numba._Private], "is kept in"), ([], "is not kept")])
def test_no_place_for_code(
    places: list[Any], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """Where nothing else can be written code lies in a private folder or nowhere, and that is said once."""
    monkeypatch.setattr(by_numba._Places, "_locator_classes", places)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    by_numba.say_once.cache_clear()
    assert not used_cache(times(3.0))
    kernel = times(3.0)
    assert kernel(2.0) == 6.0
    assert bool(kernel.stats.cache_hits) == bool(places)
    (line,) = caplog.messages
    assert said in line


STRANGER = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"]
USE = """
import os, tempfile
tempfile.tempdir = os.environ.get("TMPDIR")  # and nowhere else
import nonholo as nh
nh.SO(3)
sleigh = nh.discretize(nh.ChaplyginSleigh(1, 1, 0.5), 0.1)
print(nh.simulate(sleigh, restricted_velocity=(0.3, 0.2), steps=3).momentum.tolist())
print(nh.load_orbit("run.zarr").momentum.tolist())
"""


def can_be_a_stranger() -> bool:
    """Tell whether a process may become another user, who can read this package."""
    if shutil.which("setpriv") is None:
        return False
    reads = [*STRANGER, sys.executable, "-c", "import nonholo"]
    return subprocess.run(reads, cwd="/", capture_output=True, check=False).returncode == 0  # noqa: S603


@pytest.fixture
def home() -> Iterator[Path]:
    """Return a folder that others can read, with an orbit."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        sleigh = nh.discretize(nh.ChaplyginSleigh(1, 1, 0.5), 0.1)
        nh.save_orbit(nh.simulate(sleigh, restricted_velocity=(0.3, 0.2), steps=3), folder / "run.zarr")
        folder.chmod(0o755)
        yield folder


@pytest.mark.parametrize("home_is", ["/nonexistent", None], ids=["HOME is nowhere", "no HOME"])
@pytest.mark.parametrize("temporary", [True, False], ids=["temporary folder", "nothing"])
@pytest.mark.profile("faults", instead="test_no_place_for_code")
def test_a_user_who_can_write_nowhere(temporary: bool, home_is: str | None, home: Path) -> None:
    """The library runs where package, home and the temporary folder are read-only, and says so once."""
    if not can_be_a_stranger():
        pytest.skip("a process may not become another user here")
    scratch = home / "scratch"
    scratch.mkdir(mode=0o777)
    scratch.chmod(0o777 if temporary else 0o555)
    own = {"PATH": os.environ["PATH"], "PYTHONPATH": os.environ.get("PYTHONPATH", ""), "TMPDIR": str(scratch)}
    own |= {"NONHOLO_KERNELS": "numba"} | ({} if home_is is None else {"HOME": home_is})
    run = [*STRANGER, sys.executable, "-B", "-c", USE]
    for _ in range(2):
        done = subprocess.run(run, cwd=home, env=own, capture_output=True, text=True, check=False)  # noqa: S603
        assert done.returncode == 0, done.stderr
        fresh, stored = done.stdout.splitlines()
        assert fresh == stored
        assert done.stderr.startswith("Compiled code is " + ("kept in" if temporary else "not kept"))
        assert len(done.stderr.splitlines()) == 1
    assert [path.name for path in scratch.iterdir()] == ["nonholo-65534"] * temporary
    assert sorted(path.name for path in home.iterdir()) == ["run.zarr", "scratch"]
