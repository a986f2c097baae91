"""The lock of a store that is being written: a file that names its owner; that of a dead process does not count."""

import contextlib
import datetime
import json
import os
import socket
import sys
import uuid
from collections.abc import Iterator
from pathlib import Path


@contextlib.contextmanager
def locked(store: Path) -> Iterator[None]:
    """Hold the lock of a store; refuse, naming the owner, while another process holds it.

    A lock left by a process of this host that has ended is taken over.
    """
    path = store / "run" / "lock.json"
    mine = json.dumps({"pid": os.getpid(), "host": socket.gethostname(), "since": _now()})
    _acquire(path, mine)
    try:
        yield
    finally:
        if _text(path) == mine:
            path.unlink(missing_ok=True)


def owner_of(store: Path) -> str | None:
    """Say who is writing a store; None if nobody is."""
    found = _text(store / "run" / "lock.json")
    return None if found is None or _is_stale(found) else _named(found)


def _acquire(path: Path, mine: str) -> None:
    """Create the lock file with its content at once, by a link, which fails if there is one."""
    own = path.with_name(f"lock.{uuid.uuid4().hex}.claim")
    try:
        own.write_text(mine)
        for _ in range(2):
            try:
                os.link(own, path)
            except FileExistsError:
                _remove_stale(path)
                continue
            return
        raise _refused(path, _text(path) or "")
    finally:
        own.unlink(missing_ok=True)


def _remove_stale(path: Path) -> None:
    """Move a stale lock away; if another process was faster, what was moved is its new lock, and goes back."""
    found = _text(path)
    if found is None:
        return
    if not _is_stale(found):
        raise _refused(path, found)
    aside = path.with_name(f"lock.{uuid.uuid4().hex}.claim")
    try:
        path.rename(aside)
    except FileNotFoundError:
        return
    moved = aside.read_text()
    if moved != found:
        with contextlib.suppress(FileExistsError):
            os.link(aside, path)
    aside.unlink()


def _is_stale(content: str) -> bool:
    """Tell whether the owner was a process of this host that has ended; an unreadable lock has an unknown owner."""
    try:
        owner = json.loads(content)
        if owner["host"] != socket.gethostname() or sys.platform == "win32":  # where os.kill is no mere question
            return False
        os.kill(owner["pid"], 0)
    except ProcessLookupError:
        return True
    except (ValueError, KeyError, TypeError, OSError):
        return False
    return False


def _refused(path: Path, content: str) -> BlockingIOError:
    remedy = f"Wait until it is done; if no such process is left, remove '{path}'."
    return BlockingIOError(f"The store '{path.parents[1]}' is being written by {_named(content)}. {remedy}")


def _named(content: str) -> str:
    try:
        owner = json.loads(content)
        return f"process {owner['pid']} on {owner['host']} since {owner['since']}"
    except (ValueError, KeyError, TypeError):
        return "an unknown process"


def _text(path: Path) -> str | None:
    try:
        return path.read_text()
    except FileNotFoundError:
        return None


def _now() -> str:
    return datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")
