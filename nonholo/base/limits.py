"""Limits, refused before any work: more memory or disk than there is."""

import functools
import math
import os
import shutil
from pathlib import Path
from typing import Any

from nonholo.base.checks import count, error

_UNITS = ("B", "kB", "MB", "GB", "TB", "PB", "EB")
_LARGEST_TEXT = 1 << 22  # bytes of a file: a mass tensor of some hundred dimensions fits


def within_memory(where: str, size: float, remedy: str) -> None:
    """Refuse what needs more bytes than this process can have.

    Example:
        >>> within_memory("f(n=...)", 1e30, "Pass a smaller n.")
        Traceback (most recent call last):
        ...
        ValueError: `f(n=...)` must fit into memory. Got about 1e+12 EB of ... GB. Pass a smaller n.
    """
    if size > (limit := memory_limit()):
        raise error(where, "fit into memory", f"about {size_text(size)} of {size_text(limit)}", remedy)


def read_text(path: Path, largest: int = _LARGEST_TEXT) -> str:
    """Return the text of a file, refused with an OSError if it is none or too large; pipes and devices may not end."""
    if path.exists() and not path.is_file():  # to open a pipe may take forever
        raise OSError("it is a folder, a device or a pipe")
    with path.open("rb") as file:
        content = file.read(largest + 1)
    if len(content) > largest:
        raise OSError(f"it has more than {size_text(largest)}")
    return content.decode("utf-8-sig")


def within_disk(where: str, size: float, folder: Path, remedy: str) -> None:
    """Refuse what needs more bytes than are free on the disk of a folder, or of the one that it would be made in."""
    there = next(path for path in (folder.absolute(), *folder.absolute().parents) if path.exists())
    if size > (free := shutil.disk_usage(there).free):
        got = f"about {size_text(size)} before compression, of which {size_text(free)} are free in '{there}'"
        raise error(where, "fit on the disk", got, remedy)


def bounded_count(where: str, value: Any, each: float, remedy: str) -> int:
    """Return a positive integer, refused if this many things of `each` bytes do not fit into memory."""
    number = count(where, value, remedy)
    within_memory(where, number * each, remedy)
    return number


def size_text(size: float) -> str:
    """Return a number of bytes for people.

    Example:
        >>> size_text(3.2e9)
        '3.2 GB'
    """
    power = min(len(_UNITS) - 1, int(math.log10(max(size, 1.0)) // 3))
    return f"{size / 1000**power:.3g} {_UNITS[power]}"


def memory_limit() -> float:
    """Return the bytes that this process can have: of the machine, of its container, of the limit of the process."""
    return min(_machine(), _of_the_process())


@functools.cache
def _machine() -> float:
    try:
        whole = float(os.sysconf("SC_PAGE_SIZE")) * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, OSError, ValueError):  # Windows
        return math.inf
    for file in ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"):
        try:
            content = Path(file).read_text().strip()
        except OSError:
            continue
        return whole if content in ("max", "") else min(whole, float(content))
    return whole


def _of_the_process() -> float:
    try:
        import resource
    except ImportError:  # Windows
        return math.inf
    limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    return math.inf if limit == resource.RLIM_INFINITY else float(limit)
