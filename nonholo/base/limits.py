"""How much there is: memory of this process, text in a file; and sizes in words."""

import functools
import math
import os
from pathlib import Path

_UNITS = ("B", "kB", "MB", "GB", "TB", "PB", "EB")
_LARGEST_TEXT = 1 << 22  # bytes of a file: a mass tensor of some hundred dimensions fits


def read_text(path: Path, largest: int = _LARGEST_TEXT) -> str:
    """Return the text of a file, refused with an OSError if it is none or too large; pipes and devices may not end."""
    if path.exists() and not path.is_file():  # to open a pipe may take forever
        raise OSError("it is a folder, a device or a pipe")
    with path.open("rb") as file:
        content = file.read(largest + 1)
    if len(content) > largest:
        raise OSError(f"it has more than {size_text(largest)}")
    return content.decode("utf-8-sig")


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
