"""Recorded motions as arrays on the nodes of a time grid: poses and angular velocities, with gaps."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from nonholo.base.checks import array, error, printable, shown, trailing
from nonholo.base.checks import path as checked_path
from nonholo.base.limits import read_text, within_memory
from nonholo.base.types import Float
from nonholo.groups import SE, SO, AbstractMatrixGroup

Kinds = dict[str, Float[np.ndarray, "T K _"]]
"""Measured numbers of all trials by kind, "position", "turn" and "rate"; NaN where nothing was measured."""

WHERE = "fit(measurements=...)"
_OFF = 1e-3  # of a time step, by which times of samples may miss a node
_LARGEST = 1 << 28  # bytes of a CSV file
_HUGE = 1e300  # nodes
_TABLES = "Pass a DataFrame, a Dataset, a dictionary of columns, the path of a CSV file, or a list of them."
_COLUMN = "Pass real numbers, times in the unit of the velocities; NaN marks what was not measured."

Names = dict[str, tuple[tuple[str, ...], ...]]
"""Names of columns by kind, with those that may stand instead."""
_NAMES: dict[AbstractMatrixGroup, Names] = {
    SE(2): {"position": (("x", "y"),), "turn": (("theta",), ("heading",)), "rate": (("omega",),)},
    SO(3): {
        "turn": (("qw", "qx", "qy", "qz"), ("quaternion",)),
        "rate": (("omega_x", "omega_y", "omega_z"), ("angular_velocity",)),
    },
}
_NAMES[SE(3)] = {"position": (("x", "y", "z"),), **_NAMES[SO(3)]}


def names_of(group: AbstractMatrixGroup) -> Names:
    """Return the names of columns of motions in a group."""
    if group not in _NAMES:
        raise error(WHERE, "be of a motion in SE(2), SO(3) or SE(3)", repr(group), "Fit its numbers by `nh.rollout`.")
    return _NAMES[group]


def kinds_of(known: Names, given: Any, time_step: float | None, each: float) -> tuple[Kinds, float]:
    """Return what all trials measured, with as many nodes as the longest one has, and the time step.

    A node takes `each` bytes; `known` are the names of columns by kind.
    """
    tables = [_columns(one) for one in (given if isinstance(given, list | tuple) else [given])]
    if not tables:
        raise error(WHERE, "hold at least one trial", "none", "Pass a table, or a list of them.")
    times = [_times(table) for table in tables]
    h = min(float(np.diff(time).min()) for time in times) if time_step is None else time_step
    most = 1 + min(max(float(time[-1] - time[0]) for time in times) / h, _HUGE)
    within_memory(WHERE, len(tables) * most * each, f"Pass a time_step larger than {h:g}, or other times.")
    kinds = _on_nodes(known, tables, [_nodes(time, h) for time in times])
    _refuse_other_columns(known, tables, kinds)
    return kinds, h


def _refuse_other_columns(known: Names, tables: list[dict[str, Any]], kinds: Kinds) -> None:
    """Refuse trials without numbers of any kind, or with numbers of different kinds."""
    seen = np.array([np.isfinite(rows).any(axis=(1, 2)) for rows in kinds.values()])
    if not (seen.any() and (seen == seen[:, :1]).all()):
        remedy = f"Name them {'; '.join(', '.join(choices[0]) for choices in known.values())}."
        got = "different ones" if seen.any() else ", ".join(tables[0])
        raise error(WHERE, "have the same columns of a motion in every trial", got, remedy)


def _on_nodes(known: Names, tables: list[dict[str, Any]], nodes: list[np.ndarray]) -> Kinds:
    """Return the numbers of tables on the nodes, by kind."""
    size, kinds = 1 + max(int(each[-1]) for each in nodes), {}
    for kind, choices in known.items():
        kinds[kind] = np.full((len(tables), size, len(choices[0])), np.nan)
        for target, table, at in zip(kinds[kind], tables, nodes, strict=True):
            names = next((names for names in choices if all(name in table for name in names)), ())
            if names:
                target[at] = _rows(kind, table, names, (len(at), len(choices[0])))
    return kinds


def _columns(table: Any) -> dict[str, Any]:
    """Return the columns of a file, a table or a dataset by name, not yet looked at."""
    if isinstance(table, str | Path):
        return _of_file(checked_path(WHERE, table))
    try:
        names = list(table) if isinstance(table, Mapping) or not hasattr(table, "variables") else list(table.variables)
        found = {str(name): table[name] for name in names}
    except (TypeError, ValueError, KeyError, IndexError):
        raise error(WHERE, "be tables of numbers", shown(table), _TABLES) from None
    index = getattr(table, "index", None)
    return {**found, "t": np.asarray(index)} if getattr(index, "name", None) in ("t", "time") else found


def _of_file(path: Path) -> dict[str, np.ndarray]:
    """Return the columns of a CSV file with a header; an empty place is no measurement."""
    try:
        header, *lines = read_text(path, _LARGEST).splitlines() or [""]
        names = [name.strip('# "') for name in header.split(",")]
        if not any(lines):
            raise ValueError("no rows below a header")
        rows = np.loadtxt(lines, delimiter=",", ndmin=2, converters=lambda x: float(x.strip() or "nan"))
        return dict(zip(names, rows.T, strict=True))
    except (OSError, ValueError) as failure:
        got = f"{str(path)!r}: {printable(str(failure))}"
        raise error(WHERE, "be the path of a CSV file of numbers with a header", got, _TABLES) from None


def _times(table: dict[str, Any]) -> np.ndarray:
    name = next((name for name in ("t", "time") if name in table), None)
    if name is None:
        raise error(WHERE, "have a column `t` of times", ", ".join(table) or "no columns", "Name it.")
    time = array(f"fit(measurements={{{name!r}: ...}})", table[name], (None,), _COLUMN)
    if len(time) < 2 or not (np.diff(time) > 0).all():
        raise error(WHERE, "have two times and more, each after the one before", shown(time), "Sort the rows by time.")
    return time


def _nodes(time: np.ndarray, h: float) -> np.ndarray:
    exact = (time - time[0]) / h
    nodes = np.rint(exact).astype(int)
    worst = int(np.abs(exact - nodes).argmax())
    if abs(exact[worst] - nodes[worst]) > _OFF:
        got = f"{time[worst]:g}, {exact[worst]:.6g} steps of {h:g} after the first"
        raise error(WHERE, "have times a whole number of time steps apart", got, "Pass a time_step that divides them.")
    if (twice := np.diff(nodes) == 0).any():
        got = f"{time[:-1][twice][0]:.12g} and {time[1:][twice][0]:.12g} at one step"
        raise error(WHERE, "have one row at a time step", got, "Pass a smaller time_step, or put rows together.")
    return nodes


def _rows(kind: str, table: dict[str, Any], names: tuple[str, ...], shape: tuple[int, int]) -> np.ndarray:
    """Return columns side by side, each with as many rows as there are times; turns are measured whole or not."""
    found = []
    for name in names:
        where = f"fit(measurements={{{name!r}: ...}})"
        wide = shape[:1] if len(names) == shape[1] else shape
        rows = trailing(where, table[name], (), _COLUMN, real=True)
        found.append(array(where, np.where(np.isnan(rows), 0.0, rows), wide, _COLUMN) + 0.0 * rows)
    rows = np.column_stack(found)
    if kind == "turn":
        rows[~np.isfinite(rows).all(axis=1)] = np.nan
        if shape[1] == 4 and (np.sum(rows**2, axis=1) < 0.25).any():
            raise error(WHERE, "have quaternions of length 1", "shorter ones", "NaN marks what was not measured.")
    return rows
