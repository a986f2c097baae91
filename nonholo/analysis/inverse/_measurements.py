"""Recorded motions on the nodes of a time grid, poses and angular velocities with gaps, and nearly their starts."""

from pathlib import Path
from typing import Any

import numpy as np

from nonholo.base.checks import array, checked_path, error, printable, shown, trailing, within_memory
from nonholo.base.limits import read_text
from nonholo.base.types import Float
from nonholo.groups import SE, SO, AbstractMatrixGroup
from nonholo.orbit import AbstractOrbit

Kinds = dict[str, Float[np.ndarray, "T K _"]]
"""Measured numbers of all trials by kind, "position", "turn" and "rate"; NaN where nothing was measured."""

Trial = dict[str, np.ndarray]
"""Measured numbers of one trial."""
WHERE = "fit(measurements=...)"
_OFF = 1e-3  # of a time step, by which times of samples may miss a node
_LARGEST = 1 << 28  # bytes of a CSV file
_HUGE = 1e300  # nodes
_TABLES = "Pass an orbit, a DataFrame, a Dataset, a dictionary of columns, the path of a CSV file, or a list of them."
_COLUMN = "Pass real numbers, times in the unit of the velocities; NaN marks what was not measured."

Names = dict[str, tuple[tuple[str, ...], ...]]
"""Names of columns by kind, with those that may stand instead."""
_NAMES: dict[AbstractMatrixGroup, Names] = {
    SE(2): {"position": (("x", "y"),), "turn": (("theta",), ("heading",)), "rate": (("omega",),)},
    SO(3): {
        "turn": (("qw", "qx", "qy", "qz"), ("quaternion",), tuple(f"quaternion_{axis}" for axis in "wxyz")),
        "rate": (("omega_x", "omega_y", "omega_z"), ("angular_velocity",)),
    },
}
_NAMES[SE(3)] = {"position": (("x", "y", "z"),), **_NAMES[SO(3)]}


def names_of(group: AbstractMatrixGroup) -> Names:
    """Return the names of columns of motions in a group."""
    if group not in _NAMES:
        raise error(WHERE, "be of a motion in SE(2), SO(3) or SE(3)", repr(group), "Fit its numbers by `nh.rollout`.")
    return _NAMES[group]


def kinds_of(columns: Names, records: Any, time_step: float | None, each: float) -> tuple[Kinds, float]:
    """Return what all trials measured, with as many nodes as the longest one has, and the time step.

    A node takes `each` bytes; `columns` are the names of columns by kind.
    """
    records = getattr(records, "orbits", records)  # of an ensemble
    tables = [_columns(one) for one in (records if isinstance(records, list | tuple) else [records])]
    if not tables:
        raise error(WHERE, "hold at least one trial", "none", "Pass a table, or a list of them.")
    times = [_times(table) for table in tables]
    h = min(float(np.diff(time).min()) for time in times) if time_step is None else time_step
    most = 1 + min(max(float(time[-1] - time[0]) for time in times) / h, _HUGE)
    within_memory(WHERE, len(tables) * most * each, f"Pass a time_step larger than {h:g}, or other times.")
    kinds = _on_nodes(columns, tables, [_nodes(time, h) for time in times])
    _refuse_other_columns(columns, tables, kinds)
    return kinds, h


def _refuse_other_columns(columns: Names, tables: list[dict[str, Any]], kinds: Kinds) -> None:
    """Refuse trials without numbers of any kind, or with numbers of different kinds."""
    has_numbers = np.array([np.isfinite(rows).any(axis=(1, 2)) for rows in kinds.values()])
    if not (has_numbers.any() and (has_numbers == has_numbers[:, :1]).all()):
        remedy = f"Name them {'; '.join(', '.join(choices[0]) for choices in columns.values())}."
        got = "different ones" if has_numbers.any() else ", ".join(tables[0])
        raise error(WHERE, "have the same columns of a motion in every trial", got, remedy)


def _on_nodes(columns: Names, tables: list[dict[str, Any]], nodes: list[np.ndarray]) -> Kinds:
    """Return the numbers of tables on the nodes, by kind."""
    size, kinds = 1 + max(int(each[-1]) for each in nodes), {}
    for kind, choices in columns.items():
        kinds[kind] = np.full((len(tables), size, len(choices[0])), np.nan)
        for target, table, at in zip(kinds[kind], tables, nodes, strict=True):
            names = next((names for names in choices if all(name in table for name in names)), ())
            if names:
                target[at] = _rows(kind, table, names, (len(at), len(choices[0])))
    return kinds


def _columns(table: Any) -> dict[str, Any]:
    """Return the columns of a file, an orbit, a table or a dataset by name, unchecked."""
    if isinstance(table, str | Path):
        return _of_file(checked_path(WHERE, table))
    table = table.to_pandas() if isinstance(table, AbstractOrbit) else table
    try:
        names = table.variables if hasattr(table, "data_vars") else table  # of a dataset coordinates too
        columns = {str(name): table[name] for name in names}
        if (rows := columns.get("configuration")) is not None and "coordinate" in getattr(rows, "coords", ()):
            columns |= {str(name): rows.sel(coordinate=name) for name in rows["coordinate"].values}
    except (TypeError, ValueError, KeyError, IndexError):
        raise error(WHERE, "be tables of numbers", shown(table), _TABLES) from None
    index = getattr(table, "index", None)
    return {**columns, "t": np.asarray(index)} if getattr(index, "name", None) in ("t", "time") else columns


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
    columns = []
    for name in names:
        where = f"fit(measurements={{{name!r}: ...}})"
        wide = shape[:1] if len(names) == shape[1] else shape
        rows = trailing(where, table[name], (), _COLUMN, real=True)
        columns.append(array(where, np.where(np.isnan(rows), 0.0, rows), wide, _COLUMN) + 0.0 * rows)
    rows = np.column_stack(columns)
    if kind == "turn":
        rows[~np.isfinite(rows).all(axis=1)] = np.nan
        if shape[1] == 4 and (np.sum(rows**2, axis=1) < 0.25).any():
            raise error(WHERE, "have quaternions of length 1", "shorter ones", "NaN marks what was not measured.")
    return rows


_ENOUGH = 12  # rows, of which a few may be outliers
_NEAR = 5  # nodes between the poses that a first velocity is taken from


def first(
    group: AbstractMatrixGroup, S: np.ndarray, h: float, kinds: Trial, *, is_robust: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Return a first pose and a first start: velocity along rows S, and what is fitted of the change of pose.

    Positions see all of a pose, turns alone its turn, angular velocities nothing of it. Outliers do not count
    if they are to be borne.
    """
    some = {kind: rows for kind, rows in kinds.items() if kind != "rate" and np.isfinite(rows).any()}
    poses = {kind: measured_rows(kind, rows, is_robust, is_angle=rows.shape[1] == 1) for kind, rows in some.items()}
    if not poses:
        rate = kinds["rate"]
        whole = rate[np.isfinite(rate).all(axis=1)][:1].ravel()
        return group.identity, np.linalg.lstsq(S[:, : len(whole)].T, whole)[0]
    if "turn" not in poses and group != SE(2):
        raise error(WHERE, "have turns beside positions in space", "positions", "Measure turns, such as quaternions.")
    begin, end = ends = ends_of(poses)
    g = _matrices(group, S, poses, ends)
    velocity = group.log(group.inverse(g[0]) @ g[1]) / ((end - begin) * h)
    unseen = 0 if "position" in poses else kinds.get("position", np.zeros((0, 0))).shape[1]
    start = np.concatenate([np.linalg.lstsq(S.T, velocity)[0], np.zeros(group.dim - unseen)])
    return g[0] @ group.exp(-velocity * begin * h), start


def ends_of(series: dict[str, tuple[np.ndarray, np.ndarray]]) -> tuple[int, int]:
    """Return two nodes between which all that is measured moves clearly, the first where all of it is known."""
    begin = max(int(nodes[0]) for nodes, _ in series.values())
    after = max(int(nodes[nodes > begin][:1].sum()) for nodes, _ in series.values())
    return begin, max(after, begin + _NEAR)


def measured_rows(kind: str, rows: np.ndarray, is_robust: bool, *, is_angle: bool) -> tuple[np.ndarray, np.ndarray]:
    """Return the nodes where a kind is measured whole, and what was measured without jumps of angles and signs."""
    nodes = np.flatnonzero(np.isfinite(rows).all(axis=1))
    if len(nodes) < 2:
        remedy = "Leave the columns out that hold so little."
        raise error(WHERE, f"have two whole {kind}s in each trial", f"{len(nodes)}", remedy)
    values = rows[nodes]
    if values.shape[1] == 4:  # a quaternion, up to its sign
        values[1:] *= np.cumprod(np.where(np.sum(values[1:] * values[:-1], axis=1) < 0, -1.0, 1.0))[:, None]
    values = np.unwrap(values, axis=0) if is_angle else values
    return nodes, _straight(nodes, values, is_angle) if is_robust and len(values) >= _ENOUGH else values


def _straight(nodes: np.ndarray, rows: np.ndarray, is_angle: bool) -> np.ndarray:
    """Return rows of which the first dozen lie on straight lines by Theil and Sen, which bear a quarter of outliers."""
    times, some, (i, j) = nodes[:_ENOUGH], rows[:_ENOUGH], np.triu_indices(_ENOUGH, 1)
    if is_angle:  # headings, which an outlier of half a turn may have shifted by a whole one
        middle = np.angle(np.exp(1j * some).sum())
        some = middle + np.angle(np.exp(1j * (some - middle)))
    slope = np.median((some[j] - some[i]) / (times[j] - times[i])[:, None], axis=0)
    middle = np.median(some - slope * times[:, None], axis=0)
    return np.concatenate([middle + slope * times[:, None], rows[_ENOUGH:]])


def at_nodes(where: tuple[int, ...], nodes: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Return what is measured at some nodes, on straight lines between those where it is."""
    return np.stack([np.interp(where, nodes, column) for column in rows.T], axis=1)


def chords_of(ends: tuple[int, int], nodes: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Return the chords of a path after each of two nodes, as long as they are apart."""
    return np.diff(at_nodes((*ends, 2 * ends[1] - ends[0]), nodes, rows), axis=0)


def _matrices(group: AbstractMatrixGroup, S: np.ndarray, poses: dict, ends: tuple[int, int]) -> np.ndarray:
    """Return two poses as matrices; where no turn is measured, a body that moves forward along its blade."""
    g = np.broadcast_to(group.identity, (2, group.size, group.size)).copy()
    if "position" in poses:
        g[:, :-1, -1] = at_nodes(ends, *poses["position"])
    if "turn" in poses:
        turn = at_nodes(ends, *poses["turn"])
    else:
        x, y = chords_of(ends, *poses["position"]).T
        blade = np.linalg.svd(S[:, :1].T)[2][-1] @ S  # a velocity without rotation
        turn = np.unwrap(np.arctan2(y, x) - np.arctan2(*(blade[:0:-1] * np.sign(blade[1] or 1.0))))[:, None]
    if turn.shape[1] == 1:
        return g @ SE(2).exp(np.pad(turn, ((0, 0), (0, 2))))
    g[:, :3, :3] = SO(3).matrix_from_pose(SO(3).normalize_pose(turn))
    return g
