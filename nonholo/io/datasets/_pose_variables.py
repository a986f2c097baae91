"""Poses as variables of a dataset in the user's body frame, each a thing that people know: x, heading, quaternion."""

from typing import TypeAlias

import numpy as np

from nonholo.base.types import Float
from nonholo.groups import AbstractMatrixGroup, ProductGroup, Translations
from nonholo.io.datasets._pose_columns import HEADING, QUATERNION, Stretch, continued, layout, rows_of, separate_rows
from nonholo.orbit import Orbit, configurations

Variables: TypeAlias = dict[str, tuple[tuple[str, ...], np.ndarray, dict[str, str]]]
"""Dimensions after those of the states, values and attributes, by name."""

_AXIS = ("axis",)
_ENTRIES = ("row", "column")


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
    return _named(group, rows[:, 1:])


def separate_variables(group: AbstractMatrixGroup, g: Float[np.ndarray, "... K N N"]) -> Variables:
    """Return poses as matrices by name; headings and signs of quaternions continue along the axis K, from the first.

    The translations in a product are its `shape`; of two factors with one name the second has a number.

    Example:
        >>> robot = nh.ProductGroup(nh.SE(2), nh.Translations(2))
        >>> list(separate_variables(robot, robot.identity[None]))
        ['x', 'y', 'heading', 'shape']
    """
    if not isinstance(group, ProductGroup):
        return _named(group, joined_rows(group, g))
    found: Variables = {}
    begin = 0
    for number, factor in enumerate(group.factors, start=1):
        part = slice(begin, begin := begin + factor.size)
        for name, entry in separate_variables(factor, g[..., part, part]).items():
            name = "shape" if isinstance(factor, Translations) else name
            found[f"{name}_{number}" if name in found else name] = entry
    return found


def joined_rows(group: AbstractMatrixGroup, g: Float[np.ndarray, "... K N N"]) -> Float[np.ndarray, "... K c"]:
    """Return poses as rows of the columns but for the time; headings and signs of quaternions continue along K."""
    rows = separate_rows(group, g.reshape(-1, *g.shape[-2:])).reshape(*g.shape[:-2], -1)
    return _joined_turns(layout(group)[1], rows)


def _joined_turns(turn: list[str], rows: np.ndarray) -> np.ndarray:
    """Return rows whose headings or quaternions continue from each to the next."""
    if turn == HEADING:
        rows[..., -1] = np.unwrap(rows[..., -1], axis=-1)
    if turn == QUATERNION:
        rows[..., -4:] = continued(rows[..., -4:])
    return rows


def _named(group: AbstractMatrixGroup, rows: Float[np.ndarray, "... c"]) -> Variables:
    """Return the columns of `layout` by name."""
    position, turn = layout(group)
    where, turned = rows[..., : len(position)], rows[..., len(position) :]
    found: Variables = {}
    if position and set(position) <= set("xyz"):
        found |= {name: ((), where[..., i], _labels("position", "length unit")) for i, name in enumerate(position)}
    elif position:
        found["position"] = _AXIS, where, _labels("position", "length unit")
    return found | _turn(group, turn, turned)


def _turn(group: AbstractMatrixGroup, turn: list[str], turned: np.ndarray) -> Variables:
    if not turn:
        return {}
    if turn == HEADING:
        return {"heading": ((), turned[..., 0], _labels("angle of the body", "rad"))}
    if turn == QUATERNION:
        labels = _labels("unit quaternion w, x, y, z of the body, Hamilton's product", "1")
        return {"quaternion": (("quaternion_component",), turned, labels)}
    size = round(np.sqrt(turned.shape[-1]))
    name, meaning = ("rotation", "rotation") if group.is_rigid else ("configuration", "pose")
    return {name: (_ENTRIES, turned.reshape(*turned.shape[:-1], size, size), _labels(f"{meaning} as a matrix", "1"))}


def _labels(meaning: str, units: str) -> dict[str, str]:
    return {"long_name": meaning, "units": units}
