"""New files and folders, written under a hidden name beside their own, and the lock of a store that is being written.

The lock is that of the operating system, which ends with its process; a file tells who has it.
"""

import contextlib
import datetime
import glob
import json
import os
import shutil
import socket
import uuid
from collections.abc import Iterator
from pathlib import Path
from typing import TextIO

from filelock import FileLock, Timeout

from nonholo.base.checks import path as checked_path
from nonholo.base.checks import printable

_PATIENCE = 0.2  # seconds to wait for who only asks whether the store is locked


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
    path = checked_path(where, target)
    if path.exists() and not (overwrite and path.is_file()):
        how = "Choose another path"
        remedy = f"It is not a file. {how}." if overwrite else f"{how}, or pass overwrite=True (--overwrite)."
        raise FileExistsError(f"`{where}` must be new. Got '{path}', which exists. {remedy}")
