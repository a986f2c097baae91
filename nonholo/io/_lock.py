"""The lock of a store that is being written: the operating system's, which ends with its process; a file tells who."""

import contextlib
import datetime
import glob
import json
import os
import shutil
import socket
from collections.abc import Iterator
from pathlib import Path

from filelock import FileLock, Timeout

from nonholo.base.checks import printable

_PATIENCE = 0.2  # seconds to wait for who only asks whether the store is locked


@contextlib.contextmanager
def locked(store: Path) -> Iterator[None]:
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
        raise BlockingIOError(
            f"The store '{store}' is being written by {_named(about)}. Wait until it is done."
        ) from None
    except (OSError, NotImplementedError) as failure:
        number = getattr(failure, "errno", None)
        remedy = "A run that is stored needs a file system with locks: write it elsewhere, then copy it."
        raise OSError(number, f"The store cannot be locked ({failure}). {remedy}", str(store)) from failure
    try:
        about.write_text(json.dumps({"pid": os.getpid(), "host": socket.gethostname(), "since": _now()}))
        yield
    finally:
        if lock.is_locked:  # not in a process that was forked meanwhile
            for file in (about, Path(lock.lock_file)):
                with contextlib.suppress(OSError):
                    file.unlink()
            lock.release()


@contextlib.contextmanager
def being_made(part: Path) -> Iterator[None]:
    """Hold a lock beside what is being made, if the file system has locks: whoever is killed leaves both, unlocked."""
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
    """Say who is writing a store; None if nobody is."""
    lock = _lock(store, 0)
    if not Path(lock.lock_file).exists():
        return None
    try:
        with lock:
            return None
    except Timeout:
        return _named(store / "run" / "lock.json")
    except OSError:  # a store of somebody else, or on a medium that is only read
        return None


def _lock(store: Path, timeout: float) -> FileLock:
    return FileLock(store / "run" / "lock", timeout=timeout, thread_local=False, fallback_to_soft=False)


def _named(about: Path) -> str:
    try:
        owner = json.loads(about.read_text())
        return printable(f"process {owner['pid']} on {owner['host']} since {owner['since']}")
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return "an unknown process"


def _now() -> str:
    return datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
