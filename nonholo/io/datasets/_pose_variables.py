"""Poses as variables of a dataset in the user's body frame, each a thing that people know: x, heading, quaternion.

Poses as columns of numbers in the user's body frame: what they are called, and how one row continues another.
"""

import math
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from nonholo.base.types import Float
from nonholo.groups import AbstractMatrixGroup, ProductGroup, Translations, quaternion_from_matrix
from nonholo.io._descriptions import describe_group
from nonholo.orbit import Orbit, configurations, poses, unwrap

Variables: TypeAlias = dict[str, tuple[tuple[str, ...], np.ndarray, dict[str, str]]]
"""Dimensions after those of the states, values and attributes, by name."""

_AXIS = ("axis",)
_ENTRIES = ("row", "column")

HEADING = ["theta"]
QUATERNION = ["qw", "qx", "qy", "qz"]


def pose_variables(orbit: Orbit, before: Float[np.ndarray, "1 c"] | None = None) -> Variables:
    """Return the poses of an orbit by name; headings and signs of quaternions continue from row to row.

    Args:
        orbit: With poses.
        before: The heading or the quaternion of the state before the first one, in a row.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
        >>> list(pose_variables(nh.simulate(sleigh, body_velocity=(1, 0, 0), steps=3)))
        ['x', 'y', 'heading']
    """
    group = orbit.system.group
    stretch = Stretch(orbit.time, np.asarray(orbit.canonical_pose), orbit.turned)
    if isinstance(group, ProductGroup):
        return separate_variables(group, configurations(orbit.system, stretch.pose))
    (rows,) = rows_of(orbit.system, [stretch], 1, before)
    return _variables_of(group, rows[:, 1:])


def separate_variables(group: AbstractMatrixGroup, g: Float[np.ndarray, "... K N N"]) -> Variables:
    """Return poses as matrices by name; headings and signs of quaternions continue along the axis K, from the first.

    The translations in a product are its `shape`; of two factors with one name the second has a number.

    Example:
        >>> robot = nh.ProductGroup(nh.SE(2), nh.Translations(2))
        >>> list(separate_variables(robot, robot.identity[None]))
        ['x', 'y', 'heading', 'shape']
    """
    if not isinstance(group, ProductGroup):
        return _variables_of(group, joined_rows(group, g))
    variables: Variables = {}
    begin = 0
    for number, factor in enumerate(group.factors, start=1):
        part = slice(begin, begin := begin + factor.size)
        for name, entry in separate_variables(factor, g[..., part, part]).items():
            name = "shape" if isinstance(factor, Translations) else name
            variables[f"{name}_{number}" if name in variables else name] = entry
    return variables


def joined_rows(group: AbstractMatrixGroup, g: Float[np.ndarray, "... K N N"]) -> Float[np.ndarray, "... K c"]:
    """Return poses as rows of the columns but for the time; headings and signs of quaternions continue along K."""
    rows = separate_rows(group, g.reshape(-1, *g.shape[-2:])).reshape(*g.shape[:-2], -1)
    return _joined_turns(layout(group)[1], rows)


def _joined_turns(turn: list[str], rows: np.ndarray) -> np.ndarray:
    """Return rows whose headings or quaternions continue from each to the next."""
    if turn == HEADING:
        rows[..., -1] = np.unwrap(rows[..., -1], axis=-1)
    if turn == QUATERNION:
        rows[..., -4:] = continuous(rows[..., -4:])
    return rows


def _variables_of(group: AbstractMatrixGroup, rows: Float[np.ndarray, "... c"]) -> Variables:
    """Return the columns of `layout` by name."""
    position, turn = layout(group)
    where, turns = rows[..., : len(position)], rows[..., len(position) :]
    variables: Variables = {}
    if position and set(position) <= set("xyz"):
        variables |= {name: ((), where[..., i], _labels("position", "length unit")) for i, name in enumerate(position)}
    elif position:
        variables["position"] = _AXIS, where, _labels("position", "length unit")
    return variables | _turn(group, turn, turns)


def _turn(group: AbstractMatrixGroup, turn: list[str], turns: np.ndarray) -> Variables:
    if not turn:
        return {}
    if turn == HEADING:
        return {"heading": ((), turns[..., 0], _labels("angle of the body", "rad"))}
    if turn == QUATERNION:
        labels = _labels("unit quaternion w, x, y, z of the body, Hamilton's product", "1")
        return {"quaternion": (("quaternion_component",), turns, labels)}
    size = round(np.sqrt(turns.shape[-1]))
    name, meaning = ("rotation", "rotation") if group.is_rigid else ("configuration", "pose")
    return {name: (_ENTRIES, turns.reshape(*turns.shape[:-1], size, size), _labels(f"{meaning} as a matrix", "1"))}


def _labels(meaning: str, units: str) -> dict[str, str]:
    return {"long_name": meaning, "units": units}


class Stretch(NamedTuple):
    """Saved states that follow one another: times, places, and headings where the run knows them.

    Places are compact poses, matrices, or the coordinates of a system that has them.
    """

    time: Float[np.ndarray, "K"]
    pose: Float[np.ndarray, "K ..."]
    headings: Float[np.ndarray, "K"] | None


def column_names(group: AbstractMatrixGroup) -> list[str]:
    """Return the names of the columns: time, position, and how the body is turned.

    Example:
        >>> column_names(nh.SE(2)), column_names(nh.SO(3))
        (['t', 'x', 'y', 'theta'], ['t', 'qw', 'qx', 'qy', 'qz'])
    """
    position, turn = layout(group)
    return ["t", *position, *turn]


def compact_names(group: AbstractMatrixGroup) -> list[str]:
    """Return the names of the numbers of a compact pose; none for products, whose factors may share them.

    Example:
        >>> compact_names(nh.SE(2)), compact_names(nh.SO(3))
        (['cos', 'sin', 'x', 'y'], ['qw', 'qx', 'qy', 'qz'])
    """
    if isinstance(group, ProductGroup):
        return []
    position, turn = layout(group)
    if turn == HEADING:
        return ["cos", "sin", *position]
    return [*(_entries(3) if turn == QUATERNION and position else turn), *position]


def separate_rows(group: AbstractMatrixGroup, g: Float[np.ndarray, "R N N"]) -> Float[np.ndarray, "R c"]:
    """Return poses that do not follow one another as rows of the columns but for the time.

    Angles are between -pi and pi, quaternions have a scalar that is not negative.
    """
    position, turn = layout(group)
    turns = np.arctan2(g[:, 1, 0], g[:, 0, 0])[:, None] if turn == HEADING else _turns(g, turn)
    return np.concatenate([g[:, : len(position), len(position)], turns], axis=1)


def rows_of(
    system: Any, stretches: Iterable[Stretch], every: int, before: Float[np.ndarray, "1 c"] | None = None
) -> Iterator[Float[np.ndarray, "R c"]]:
    """Return one in `every` of the states as rows of the columns; rows do not depend on how the motion is cut.

    The first row continues from the one `before`, if there is one.
    """
    position, turn = layout(system.group)
    first = 0
    for time, pose, headings in _with_headings(stretches, before) if turn == HEADING else stretches:
        own_rows = slice(-first % every, None, every)
        place, turns = _places_and_turns(system, pose[own_rows], len(position), turn)
        if turn == HEADING:
            turns = np.asarray(headings)[own_rows, None]
        if turn == QUATERNION:
            turns = continuous(turns, None if before is None else before[:, -4:])
        rows = np.concatenate([time[own_rows, None], place, turns], axis=1)
        first, before = first + len(time), rows[-1:] if len(rows) else before
        yield rows


def _places_and_turns(system: Any, pose: np.ndarray, n: int, turn: list[str]) -> tuple[np.ndarray, np.ndarray]:
    """Return n numbers of the positions, and the turns, of poses: compact ones with the turn first, or matrices."""
    if pose.shape[1:] == (4,) and turn in (HEADING, QUATERNION):
        compact = poses(system, pose)
        return compact[:, 4 - n :], compact
    g = pose if pose.ndim == 3 else configurations(system, pose)
    return g[:, :n, n], _turns(g, turn)


def coordinate_rows(stretches: Iterable[Stretch], every: int) -> Iterator[Float[np.ndarray, "R c"]]:
    """Return times and coordinates of one in `every` of the states."""
    first = 0
    for time, q, _ in stretches:
        yield np.concatenate([time[:, None], q], axis=1)[-first % every :: every]
        first += len(time)


def layout(group: AbstractMatrixGroup) -> tuple[list[str], list[str]]:
    """Return the columns of the position and of the turn; groups that are none of ours have all entries as turn."""
    text = describe_group(group)
    kind, n = text["group"], text.get("n", 0)
    if kind == "Translations":
        return _numbers(n), []
    position = [] if kind != "SE" else list("xyz"[:n]) if n <= 3 else _numbers(n)
    if (kind, n) == ("SE", 2):
        return position, HEADING
    return position, QUATERNION if n == 3 else _entries(n or group.size)


def _numbers(n: int) -> list[str]:
    return [f"x{i}" for i in range(1, n + 1)]


def _entries(size: int) -> list[str]:
    between = "" if size < 10 else "_"
    return [f"r{i}{between}{j}" for i in range(1, size + 1) for j in range(1, size + 1)]


def _with_headings(stretches: Iterable[Stretch], row: Float[np.ndarray, "1 c"] | None) -> Iterator[Stretch]:
    """Give stretches on SE(2) headings, each continuing the one before, the first that at the end of a row."""
    before = None if row is None else float(row[0, -1])
    for stretch in stretches:
        turns = stretch.pose[:, :2, 0] if stretch.pose.ndim == 3 else stretch.pose  # cosine and sine first
        headings = unwrap(turns, before) if stretch.headings is None else stretch.headings
        before = headings[-1] if len(headings) else before
        yield stretch._replace(headings=headings)


def _turns(g: np.ndarray, names: list[str]) -> Float[np.ndarray, "R c"]:
    """Return the rotations as quaternions or, row by row, as matrices."""
    if names == QUATERNION:
        return quaternion_from_matrix(g[:, :3, :3])
    size = math.isqrt(len(names))
    return g[:, :size, :size].reshape(len(g), len(names))


def continuous(
    q: Float[np.ndarray, "... R 4"], before: Float[np.ndarray, "... 1 4"] | None = None
) -> Float[np.ndarray, "... R 4"]:
    """Return the quaternions, each with the sign that is nearer to the one before it."""
    chain = np.concatenate([q[..., :1, :] if before is None else before, q], axis=-2)
    signs = np.where(np.sum(chain[..., 1:, :] * chain[..., :-1, :], axis=-1) < 0, -1.0, 1.0)
    return q * np.cumprod(signs, axis=-1)[..., : q.shape[-2], None]
