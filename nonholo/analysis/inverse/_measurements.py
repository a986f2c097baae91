"""Recorded motions as arrays on the nodes of a time grid: poses and angular velocities, with gaps."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from nonholo.base.checks import error, shown
from nonholo.base.checks import path as checked_path
from nonholo.base.types import Float
from nonholo.groups import SE, SO, AbstractMatrixGroup

Columns = dict[str, np.ndarray]
_OFF = 1e-3  # of a time step, by which times of samples may miss a node

_NAMES: dict[AbstractMatrixGroup, dict[str, tuple[tuple[str, ...], ...]]] = {
    SE(2): {"position": (("x", "y"),), "turn": (("theta",), ("heading",)), "rate": (("omega",),)},
    SO(3): {
        "turn": (("qw", "qx", "qy", "qz"), ("quaternion",)),
        "rate": (("omega_x", "omega_y", "omega_z"), ("angular_velocity",)),
    },
}
_NAMES[SE(3)] = {"position": (("x", "y", "z"),), **_NAMES[SO(3)]}


class Trial(NamedTuple):
    """A recorded motion on the nodes; NaN where nothing was measured.

    Attributes:
        first: Time of node 0.
        kinds: Measured numbers by kind, "position", "turn" and "rate", (K, ...).
    """

    first: float
    kinds: dict[str, Float[np.ndarray, "K _"]]


def trials_of(where: str, group: AbstractMatrixGroup, given: Any, time_step: Any) -> tuple[list[Trial], float]:
    """Return the trials, all with as many nodes as the longest one, and the time step."""
    if group not in _NAMES:
        raise error(where, "be of a motion in SE(2), SO(3) or SE(3)", repr(group), "Fit its numbers by `nh.rollout`.")
    tables = [_columns(where, one) for one in (given if isinstance(given, list | tuple) else [given])]
    if not tables:
        raise error(where, "hold at least one trial", "none", "Pass a table, or a list of them.")
    times = [_times(where, table) for table in tables]
    gaps = np.concatenate([np.diff(time) for time in times])
    h = float(gaps.min() if time_step is None else time_step)
    nodes = [_nodes(where, time, h) for time in times]
    size = 1 + max(int(node[-1]) for node in nodes)
    found = [_trial(where, group, *row, size) for row in zip(tables, times, nodes, strict=True)]
    if len({tuple(trial.kinds) for trial in found}) > 1:
        raise error(
            where, "have the same columns in every trial", str([list(t.kinds) for t in found]), "Fill with NaN."
        )
    return found, h


def _columns(where: str, table: Any) -> Columns:
    """Return the columns of a file, a table or a dataset by name."""
    if isinstance(table, str | Path):
        rows: Any = np.genfromtxt(checked_path(where, table), delimiter=",", names=True, dtype=np.float64)
        return {name: np.atleast_1d(rows[name]) for name in rows.dtype.names or ()}
    try:
        names = list(table) if isinstance(table, Mapping) or not hasattr(table, "variables") else list(table.variables)
        found = {str(name): np.asarray(table[name], dtype=np.float64) for name in names}
    except (TypeError, ValueError, KeyError):
        remedy = "Pass a DataFrame, a Dataset, a dictionary of columns, the path of a CSV file, or a list of them."
        raise error(where, "be tables of numbers", shown(table), remedy) from None
    index = getattr(table, "index", None)
    return {**found, "t": np.asarray(index)} if getattr(index, "name", None) in ("t", "time") else found


def _times(where: str, table: Columns) -> np.ndarray:
    time = next((table[name] for name in ("t", "time") if name in table), None)
    if time is None:
        raise error(where, "have a column `t` of times", ", ".join(table) or "no columns", "Name it.")
    if time.ndim != 1 or len(time) < 2 or not (np.diff(time) > 0).all():
        raise error(where, "have two times and more, each after the one before", shown(time), "Sort the rows by time.")
    return time


def _nodes(where: str, time: np.ndarray, h: float) -> np.ndarray:
    exact = (time - time[0]) / h
    nodes = np.rint(exact).astype(int)
    worst = int(np.abs(exact - nodes).argmax())
    if abs(exact[worst] - nodes[worst]) > _OFF:
        got = f"{time[worst]:g}, {exact[worst]:.6g} steps of {h:g} after the first"
        raise error(where, "have times a whole number of time steps apart", got, "Pass a time_step that divides them.")
    return nodes


def _trial(
    where: str, group: AbstractMatrixGroup, table: Columns, time: np.ndarray, nodes: np.ndarray, size: int
) -> Trial:
    kinds = {}
    for kind, choices in _NAMES[group].items():
        names = next((names for names in choices if all(name in table for name in names)), None)
        if names is not None:
            rows = np.column_stack([table[name] for name in names])
            kinds[kind] = np.full((size, rows.shape[1]), np.nan)
            whole = np.isfinite(rows).all(axis=1, keepdims=True) if kind == "turn" else np.isfinite(rows)
            kinds[kind][nodes] = np.where(whole, rows, np.nan)
    if not kinds:
        wanted = "; ".join(", ".join(choices[0]) for choices in _NAMES[group].values())
        raise error(where, f"have columns of a motion in {group}", ", ".join(table), f"Name them: {wanted}.")
    return Trial(float(time[0]), kinds)
