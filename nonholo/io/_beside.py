"""New files and folders: written under a hidden name beside their own, and removed if they stay incomplete."""

import contextlib
import uuid
from collections.abc import Iterator
from pathlib import Path
from typing import TextIO

from nonholo.base.checks import path as checked_path
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


@contextlib.contextmanager
def complete_file(path: Path) -> Iterator[str]:
    """Give a file of the same name elsewhere to write to, which takes the place of the path when it is complete."""
    with new_beside(path) as part:
        part.mkdir()
        yield str(part / path.name)
        (part / path.name).replace(path)


def remove_store(path: Path) -> None:
    """Remove a store at once: whoever is killed leaves nothing of it at the path."""
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
