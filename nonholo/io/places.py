"""New files and folders, written under a hidden name beside their own, and the lock of a store that is being written.

The lock is that of the operating system, which ends with its process; a file tells who has it.
"""

import contextlib
import datetime
import glob
import json
import os
import re
import shutil
import socket
import uuid
from collections.abc import Iterator
from pathlib import Path
from typing import Any, TextIO

from filelock import FileLock, Timeout

from nonholo.base.checks import checked_path, error, printable

FORMAT, SWEEP_FORMAT = "nonholo.orbit", "nonholo.sweep"
SCHEMAS = {FORMAT: 5, SWEEP_FORMAT: 4}
"""Written by this version, and read. Those below are of before 0.3.0, from which on later versions read stores."""
WHERE, _SAVED = "load_orbit(path=...)", "save_orbit(path=...)"  # in whose names stores are refused
_PATIENCE = 0.2  # seconds to wait for who only asks whether the store is locked
_OTHER_FORMATS = {
    **dict.fromkeys((".nc", ".nc4", ".netcdf", ".h5", ".hdf5"), "use orbit.to_dataset().to_netcdf(path)"),
    **dict.fromkeys((".csv", ".txt"), "use orbit.to_csv(path)"),
    **dict.fromkeys((".parquet", ".feather", ".xlsx"), "use orbit.to_pandas()"),
    **dict.fromkeys((".png", ".svg", ".pdf"), "use orbit.plot(path)"),
    **dict.fromkeys((".gif", ".json", ".toml", ".npy", ".npz", ".mat", ".pkl", ".zip"), ""),
}
"""Suffixes that no store may have, and what writes such files."""
_OWN_RUN = r"run/(?:lock|lock\.json|blocks/(?:start|\d+)\.json)"
_OWN = re.compile(rf"(?:[^/]+/)*(?:zarr\.json|c(?:/\d+)*|\.[^/]+\.partial)|{_OWN_RUN}")


@contextlib.contextmanager
def write_lock(store: Path) -> Iterator[None]:
    """Hold the lock of a store; refuse, naming the owner, while another process or thread holds it.

    The lock is one of the operating system on the file `run/lock`, so it ends with the process that holds it, however
    that ends, in whichever container. `run/lock.json` only tells who it is.

    Raises:
        BlockingIOError: The store is being written.
        OSError: The file system of the store has no locks.
    """
    lock, about = _lock(store, _PATIENCE), store / "run" / "lock.json"
    try:
        lock.acquire()
    except Timeout:
        words = f"The store '{store}' is being written by {_owner_in(about)}. Wait until it is done."
        raise BlockingIOError(words) from None
    except (OSError, NotImplementedError) as failure:
        number = getattr(failure, "errno", None)
        remedy = "A run that is stored needs a file system with locks: write it elsewhere, then copy it."
        raise OSError(number, f"The store cannot be locked ({failure}). {remedy}", str(store)) from failure
    try:
        since = datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
        about.write_text(json.dumps({"pid": os.getpid(), "host": socket.gethostname(), "since": since}))
        yield
    finally:
        if lock.is_locked:  # not in a process that was forked meanwhile
            for file in (about, Path(lock.lock_file)):
                with contextlib.suppress(OSError):
                    file.unlink()
            lock.release()


@contextlib.contextmanager
def being_made(part: Path) -> Iterator[None]:
    """Hold a lock beside what is being made, if the file system has locks: a killed process leaves both, unlocked."""
    lock = FileLock(part.with_suffix(".lock"), timeout=0, thread_local=False, fallback_to_soft=False)
    with contextlib.suppress(OSError, NotImplementedError):
        lock.acquire()
    try:
        yield
    finally:
        _remove(part)
        if lock.is_locked:
            Path(lock.lock_file).unlink(missing_ok=True)
            lock.release()


def remove_remains(target: Path) -> None:
    """Remove what processes that were killed have left beside a path, which they were making."""
    for file in target.parent.glob(f".{glob.escape(target.name)}.*.lock"):
        with contextlib.suppress(OSError, Timeout), FileLock(file, timeout=0, fallback_to_soft=False):
            if (old := file.with_suffix(".old")).exists() and not target.exists():
                old.rename(target)  # the store whose place the new one was about to take
            _remove(old)
            _remove(file.with_suffix(".partial"))
            file.unlink()


def _remove(part: Path) -> None:
    shutil.rmtree(part, ignore_errors=True)
    with contextlib.suppress(OSError):  # where it is a file
        part.unlink()


def owner_of(store: Path) -> str | None:
    """Return the process that is writing a store; None if there is none."""
    lock = _lock(store, 0)
    if not Path(lock.lock_file).exists():
        return None
    try:
        with lock:
            return None
    except Timeout:
        return _owner_in(store / "run" / "lock.json")
    except OSError:  # a store of somebody else, or on a medium that is only read
        return None


def _lock(store: Path, timeout: float) -> FileLock:
    return FileLock(store / "run" / "lock", timeout=timeout, thread_local=False, fallback_to_soft=False)


def _owner_in(about: Path) -> str:
    try:
        owner = json.loads(about.read_text())
        return printable(f"process {owner['pid']} on {owner['host']} since {owner['since']}")
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return "an unknown process"


@contextlib.contextmanager
def new_beside(path: Path) -> Iterator[Path]:
    """Give a hidden new name beside a path; what is left of it is removed, and a failure names the path."""
    target = path.resolve()
    part = sibling(target, "partial")
    try:
        part.parent.mkdir(parents=True, exist_ok=True)
        remove_remains(target)
        with being_made(part):
            yield part
    except OSError as failure:
        if failure.errno is None:  # a refusal of ours, which says it all
            raise
        reason = f"{failure.strerror}. Nothing at this path was changed. Free space, or choose another path"
        raise OSError(failure.errno, reason, str(path)) from failure


@contextlib.contextmanager
def complete_file(path: Path) -> Iterator[str]:
    """Give a file of the same name elsewhere to write to, which takes the place of the path when it is complete."""
    with new_beside(path) as part:
        part.mkdir()
        yield str(part / path.name)
        (part / path.name).replace(path)


def remove_store(path: Path) -> None:
    """Remove a store at once: a killed process leaves nothing of it at the path."""
    with new_beside(path) as part:
        path.rename(part)


def sibling(target: Path, purpose: str) -> Path:
    """Return a hidden new name beside a path."""
    return target.with_name(f".{target.name}.{uuid.uuid4().hex[:12]}.{purpose}")


@contextlib.contextmanager
def new_file(target: str | Path | TextIO, *, overwrite: bool) -> Iterator[TextIO]:
    """Give a file to write to, which takes its name only when it is complete, or the stream that is the target."""
    if not isinstance(target, str | Path):
        yield target
        return
    check_file(target, overwrite=overwrite)
    with new_beside(Path(target)) as part:
        with part.open("w", encoding="ascii", newline="\n") as file:
            yield file
        check_file(target, overwrite=overwrite)
        part.replace(Path(target).resolve())


def check_file(target: str | Path | TextIO, *, overwrite: bool, where: str = "to_csv(path=...)") -> None:
    """Refuse, in the name of `where`, a path that exists, unless it is a file that may be replaced."""
    if hasattr(target, "writelines"):
        return
    if (path := checked_path(where, target)).exists() and not (overwrite and path.is_file()):
        how = "Choose another path"
        remedy = f"It is not a file. {how}." if overwrite else f"{how}, or pass overwrite=True (--overwrite)."
        raise FileExistsError(f"`{where}` must be new. Got '{path}', which exists. {remedy}")


def check_assertions(where: str) -> None:
    """Refuse to read or write a store where Python leaves assertions out: some assertions of zarr do work."""
    if not __debug__:
        got = "python -O or PYTHONOPTIMIZE, which leaves out assertions in which zarr does a part of its work"
        raise error(where, "be run by Python with assertions", got, "Run it without -O, and unset PYTHONOPTIMIZE.")


def attribute_of(path: str | Path, name: str) -> Any:
    """Return an attribute that a store claims to have, unchecked; None if it has no readable one."""
    try:
        return json.loads((Path(path) / "zarr.json").read_text())["attributes"][name]
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None


def format_of(path: str | Path) -> str | None:
    """Return the format that a store claims to have; None if it has no readable one."""
    return attribute_of(path, "format")


def check_suffix(path: str | Path, where: str) -> None:
    """Refuse, in the name of `where`, a path with the suffix of another format, and any where zarr does not work."""
    check_assertions(where)
    if (suffix := Path(path).suffix.lower()) in _OTHER_FORMATS:
        store, how = f"Write a store: '{Path(path).with_suffix('.zarr')}'", _OTHER_FORMATS[suffix]
        remedy = f"{store}, or {how}." if how and not where.startswith("sweep") else f"{store}."
        raise error(where, "be the path of a Zarr store, usually *.zarr", f"'{path}'", remedy)


def check_target(path: str | Path, *, overwrite: bool = False, new: str | None = None) -> None:
    """Refuse a path that exists, unless it is a store of an orbit that may be replaced, and one of another format.

    Args:
        path: Where the store shall be.
        overwrite: Whether the caller asked to replace one.
        new: In whose name, if it has no such argument.
    """
    check_suffix(path, new or _SAVED)
    if not Path(path).exists():
        remove_remains(Path(path).resolve())  # which may put back what a killed process was about to replace
    if not Path(path).exists():
        return
    if new:
        ways = f"nonholo.resume({str(path)!r}), nonholo resume, or sweep(..., resume=True) of a sweep"
        raise _exists(path, f"Choose another path, or resume what is there: {ways}.", new)
    if not overwrite:
        raise _exists(path, "Choose another path, or pass overwrite=True (--overwrite) to replace it.")
    _check_replaceable(path)


def _check_replaceable(path: str | Path) -> None:
    """Refuse what is no store of an orbit, holds what is no part of one, or is being written."""
    if format_of(path) != FORMAT:
        raise _exists(path, "It is not a store of an orbit, so it is not replaced. Choose another path.")
    files = (file.relative_to(path).as_posix() for file in Path(path).rglob("*") if not file.is_dir())
    if foreign := next((name for name in files if not _OWN.fullmatch(name)), None):
        raise _exists(path, f"It holds '{foreign}', which is no part of a store, so it is not replaced.")
    if owner := owner_of(Path(path)):
        remedy = "so it is not replaced. Wait, or stop it."
        raise BlockingIOError(f"The store '{path}' is being written by {owner}, {remedy}")


def _exists(path: str | Path, remedy: str, where: str = _SAVED) -> FileExistsError:
    return FileExistsError(f"`{where}` must be new. Got '{path}', which exists. {remedy}")


@contextlib.contextmanager
def new_store(path: Path, *, overwrite: bool = False, new: str | None = None) -> Iterator[Path]:
    """Give a place beside a path to make a store; it appears at the path when it is complete (see `check_target`)."""
    target = path.resolve()
    check_target(target, overwrite=overwrite, new=new)
    with new_beside(path) as part:
        yield part
        _put_in_place(part, target, overwrite=overwrite, new=new)


def _put_in_place(part: Path, target: Path, *, overwrite: bool, new: str | None) -> None:
    """Rename a complete store to its path; an older one there is replaced only if asked (see `check_target`)."""
    check_target(target, overwrite=overwrite, new=new)  # once more, after the time that writing took
    old = part.with_suffix(".old")  # which remove_remains knows
    if overwrite and target.exists():
        target.rename(old)
    try:
        part.rename(target)
    except OSError:
        if old.exists():
            old.rename(target)
        raise
    shutil.rmtree(old, ignore_errors=True)
