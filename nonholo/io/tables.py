"""Poses as CSV, of an orbit or of a store of any length: all rows or no file, in bounded memory."""

import csv
import io
import itertools
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, TextIO

import numpy as np

from nonholo.base import checks
from nonholo.base.progress import progress_bar
from nonholo.io.datasets import Stretch, column_names, rows_of
from nonholo.io.places import check_file, new_file
from nonholo.orbit import AbstractOrbit, any_orbit

_NUMBERS = 1 << 16  # formatted at once


def orbit_to_csv(orbit: AbstractOrbit, path: str | Path, *, overwrite: bool = False) -> None:
    r"""Write the times and poses, or coordinates, of an orbit to a CSV file, in the user's body frame.

    A header names the columns. The pose $g$ takes body coordinates to space.

    | group | columns |
    |---|---|
    | SE(2) | `t,x,y,theta`, the heading unwrapped |
    | SO(3) | `t,qw,qx,qy,qz`: unit quaternions, scalar first, Hamilton's product, signs continuous from row to row |
    | SE(3) | `t,x,y,z,qw,qx,qy,qz` |
    | SO(n) | `t,r11,r12,...`, the entries of the rotation row by row; from n = 10 on `r1_1` |
    | SE(n) | `t,x1,...,xn,r11,r12,...` |
    | translations | `t,x1,...,xn` |
    | other groups | `t,r11,r12,...`, the entries of the matrix |
    | coordinates of a `LagrangeDAlembert` | `t` and their names |

    Numbers have as many digits as they need to be read back exactly. The file appears only when it is complete.

    Args:
        orbit: The orbit to write.
        path: A new file.
        overwrite: Replace an older file.

    Raises:
        FileExistsError: The path exists, and is not to be replaced.
        OSError: The file cannot be written, for example because the disk is full; nothing is left behind.
        ValueError: The orbit has no poses.

    Example:
        >>> orbit_to_csv(orbit, "poses.csv")  # doctest: +SKIP
    """
    checks.flags("Orbit.to_csv", overwrite=overwrite)
    any_orbit("orbit_to_csv(orbit=...)", orbit)
    if not orbit.has_poses:
        remedy = "Run with reconstruct=True."
        raise checks.error("Orbit.to_csv(...)", "be called on an orbit with poses", "reconstruct=False", remedy)
    own: Any = orbit
    pose, heading = (own.canonical_pose, own.turned) if orbit.is_compact else (own.configuration, None)
    with new_file(checks.checked_path("Orbit.to_csv(path=...)", path), overwrite=overwrite) as file:
        file.writelines(_lines(orbit.system, [Stretch(orbit.time, np.asarray(pose), heading)], 1))


def store_to_csv(
    store: str | Path, target: str | Path | TextIO, *, every: int = 1, overwrite: bool = False, progress: bool = False
) -> None:
    """Write the poses of a store as `orbit_to_csv` does, chunk by chunk: an orbit of any length needs little memory.

    Of a run that is not finished the finished blocks are written, and a `RuntimeWarning` names the last step. The
    store is read twice: damage is found before the first row is written.

    Args:
        store: A store of an orbit.
        target: A new file, or a stream of text such as `sys.stdout`.
        every: Write every n-th of the saved states, beginning with the first.
        overwrite: Replace an older file.
        progress: Show a progress bar.

    Raises:
        FileExistsError: The target exists, and is not to be replaced.
        OSError: The store is not there, or the file cannot be written; nothing is left behind.
        ValueError: The store holds no poses, or is damaged; the message names the array and the chunk.

    Example:
        >>> store_to_csv("run.zarr", "poses.csv", every=100)  # doctest: +SKIP
    """
    every = checks.count("store_to_csv(every=...)", every, "Pass 1 for every saved state.")
    check_file(target, overwrite=overwrite)
    checks.flags("store_to_csv", overwrite=overwrite, progress=progress)
    from nonholo.io.orbits import open_poses  # loads zarr, which a CSV of an orbit does not need

    poses = open_poses(checks.checked_path("store_to_csv(store=...)", store))
    for _ in poses.stretches():  # so that damage is found before the first row is used
        pass
    with new_file(target, overwrite=overwrite) as file, progress_bar("states", progress) as report:
        file.writelines(_lines(poses.system, poses.stretches(report), every))


def _lines(system: Any, stretches: Iterable[Stretch], every: int) -> Iterator[str]:
    """Return the header, then many lines at a time."""
    coordinates = getattr(system, "coordinates", ())
    names = ["t", *coordinates] if coordinates else column_names(system.group)
    parts = _cut(stretches, max(1, _NUMBERS // len(names)))
    return table_lines(names, (rows.T for rows in rows_of(system, parts, every)))


def table_lines(names: list[str], pieces: Iterable[Iterable[np.ndarray]]) -> Iterator[str]:
    """Return a header, then many lines of columns at a time: one template for them is faster than a writer of rows."""
    header = io.StringIO()
    csv.writer(header, lineterminator="\n").writerow(names)
    yield header.getvalue()
    line = ",".join(["%r"] * len(names)) + "\n"
    for columns in pieces:
        cells = [column.tolist() for column in columns]  # whole numbers are written as such
        yield line * len(cells[0]) % tuple(itertools.chain.from_iterable(zip(*cells, strict=True)))


def _cut(stretches: Iterable[Stretch], most: int) -> Iterator[Stretch]:
    """Cut stretches to this many states at most: decoded, and as text, they are many times larger."""
    for time, pose, headings in stretches:
        for first in range(0, len(time), most):
            part = slice(first, first + most)
            yield Stretch(time[part], pose[part], None if headings is None else headings[part])
