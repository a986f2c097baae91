"""New files and folders: written under a hidden name beside their own, and removed if they stay incomplete."""

import contextlib
import uuid
from collections.abc import Iterator
from pathlib import Path

from nonholo.io._lock import being_made, remove_remains


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


def sibling(target: Path, purpose: str) -> Path:
    """Return a hidden new name beside a path."""
    return target.with_name(f".{target.name}.{uuid.uuid4().hex[:12]}.{purpose}")
