"""Writing a store: all of it or nothing, beside the old one until the new one is complete."""

import contextlib
import errno
import re
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from nonholo.base.checks import error, flags, instance
from nonholo.base.checks import path as checked_path
from nonholo.io._attributes import FORMAT, attributes, attributes_of_text
from nonholo.io._beside import new_beside
from nonholo.io._load import format_of
from nonholo.io._lock import owner_of, remove_remains
from nonholo.io._metadata import check_assertions
from nonholo.io.blocks import new_blocks
from nonholo.io.datasets import Variable, steps_apart, stored_variables
from nonholo.orbit import AbstractOrbit

_ROWS = 100_000  # states in one chunk
_NETCDF, _CSV = "use orbit.to_dataset().to_netcdf(path)", "use orbit.to_csv(path)"
_OTHER_FORMATS = {
    **dict.fromkeys((".nc", ".nc4", ".netcdf", ".h5", ".hdf5"), _NETCDF),
    **dict.fromkeys((".csv", ".txt"), _CSV),
    **dict.fromkeys((".parquet", ".feather", ".xlsx"), "use orbit.to_pandas()"),
    **dict.fromkeys((".png", ".svg", ".pdf"), "use orbit.plot(path)"),
    **dict.fromkeys((".gif", ".json", ".toml", ".npy", ".npz", ".mat", ".pkl", ".zip"), ""),
}
"""Suffixes that no store may have, and what writes such files."""
_OWN_RUN = r"run/(?:lock|lock\.json|blocks/(?:start|\d+)\.json)"
_OWN = re.compile(rf"(?:[^/]+/)*(?:zarr\.json|c(?:/\d+)*|\.[^/]+\.partial)|{_OWN_RUN}")
_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


def save_orbit(orbit: AbstractOrbit, path: str | Path, *, overwrite: bool = False, scenario: str | None = None) -> None:
    """Save an orbit as a Zarr store that `load_orbit` reads back bit for bit and `xarray.open_zarr` opens.

    The store appears at `path` only when it is complete; if writing fails, nothing is left behind and an old store
    stays as it was.

    Args:
        orbit: What to save.
        path: A new directory, usually named `*.zarr`; suffixes of other formats, such as .nc and .csv, are refused.
        overwrite: Replace an older store of an orbit (nothing else is ever replaced).
        scenario: Text of the scenario that was run, kept with its SHA-256.

    Raises:
        ValueError: The path has the suffix of another format.
        FileExistsError: The path exists, and is not to be replaced.
        OSError: The store cannot be written, for example because the disk is full.

    Example:
        >>> save_orbit(orbit, "orbit.zarr")  # doctest: +SKIP
    """
    remedy = "Pass what `simulate` or `flow` returned."
    instance("save_orbit(orbit=...)", orbit, AbstractOrbit, "be an orbit", remedy)
    flags("save_orbit", overwrite=overwrite)
    path = checked_path("save_orbit(path=...)", path)
    target = path.resolve()
    check_target(target, overwrite=overwrite)
    with new_beside(path) as part:
        metadata = attributes(orbit) | ({} if scenario is None else attributes_of_text(scenario))
        _write(stored_variables(orbit) | steps_apart(orbit), metadata, part)
        put_in_place(part, target, overwrite=overwrite)


def _write(variables: dict[str, Variable], metadata: dict[str, Any], path: Path) -> None:
    rows = len(variables["time"].values)
    store = new_blocks(path, metadata, variables, rows, max(1, min(_ROWS, rows)))
    for block in range(store.layout.blocks):
        (part,) = store.layout.piece(block).place
        store.write(block, {name: variable.values[part] for name, variable in variables.items()}, {})
    store.finish({})


@contextlib.contextmanager
def reporting_how_to_resume(store: Path, what: str, standing: Callable[[], object]) -> Iterator[None]:
    """Tell, if the writing of a store is stopped or fails, how far it came and how to resume."""
    again = f"nonholo.resume({str(store)!r})"
    try:
        yield
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f"Stopped at {standing()}. Resume with {again} (nonholo resume).") from None
    except OSError as failure:
        remedy = "Free space" if failure.errno in _FULL else "Solve the problem"
        reason = f"{failure.strerror or failure}. {what} stands at {standing()}. {remedy}, then call {again}"
        raise OSError(failure.errno or errno.EIO, reason, str(store)) from failure


def check_suffix(path: str | Path, where: str = "save_orbit(path=...)") -> None:
    """Refuse, in the name of `where`, a path with the suffix of another format, and any where zarr does not work."""
    check_assertions(where)
    suffix = Path(path).suffix.lower()
    if suffix in _OTHER_FORMATS:
        store, how = f"Write a store: '{Path(path).with_suffix('.zarr')}'", _OTHER_FORMATS[suffix]
        remedy = f"{store}, or {how}." if how and where.startswith("save_orbit") else f"{store}."
        raise error(where, "be the path of a Zarr store, usually *.zarr", f"'{path}'", remedy)


def check_target(path: str | Path, *, overwrite: bool = False, new: str | None = None) -> None:
    """Refuse a path that exists, unless it is a store of an orbit that may be replaced, and one of another format.

    Args:
        path: Where the store shall be.
        overwrite: Whether the caller asked to replace one.
        new: In whose name, if it has no such argument.
    """
    check_suffix(path)
    if not Path(path).exists():
        remove_remains(Path(path).resolve())  # which may put back what a killed process was about to replace
    if not Path(path).exists():
        return
    if new:
        raise _exists(path, "Choose another path, or resume what is there: nonholo.resume(path).", new)
    if not overwrite:
        raise _exists(path, "Choose another path, or pass overwrite=True (--overwrite) to replace it.")
    if format_of(path) != FORMAT:
        raise _exists(path, "It is not a store of an orbit, so it is not replaced. Choose another path.")
    if foreign := _foreign_file(Path(path)):
        raise _exists(path, f"It holds '{foreign}', which is no part of a store, so it is not replaced.")
    if owner := owner_of(Path(path)):
        raise BlockingIOError(
            f"The store '{path}' is being written by {owner}, so it is not replaced. Wait, or stop it."
        )


def _foreign_file(store: Path) -> str | None:
    """Return a file below a store that is none of its own."""
    files = (file.relative_to(store).as_posix() for file in store.rglob("*") if not file.is_dir())
    return next((name for name in files if not _OWN.fullmatch(name)), None)


def _exists(path: str | Path, remedy: str, where: str = "save_orbit(path=...)") -> FileExistsError:
    return FileExistsError(f"`{where}` must be new. Got '{path}', which exists. {remedy}")


def put_in_place(part: Path, target: Path, *, overwrite: bool) -> None:
    """Rename a complete store to its path; an older one there is replaced only if asked."""
    if not (overwrite and target.exists()):
        try:
            part.rename(target)
        except OSError:
            check_target(target)
            raise
        return
    check_target(target, overwrite=True)  # once more, after the time that writing took
    old = part.with_suffix(".old")  # which remove_remains knows
    target.rename(old)
    try:
        part.rename(target)
    except OSError:
        old.rename(target)
        raise
    shutil.rmtree(old, ignore_errors=True)
