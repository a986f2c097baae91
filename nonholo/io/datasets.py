"""Orbits as labeled variables in the user's body frame: poses as things that people know, x, heading, quaternion.

Poses are columns of numbers first: what they are called, and how one row continues another.
"""

import itertools
import math
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, NamedTuple, TypeAlias

import numpy as np
import pandas
import xarray

from nonholo.base.types import Float
from nonholo.discrete import Discretization
from nonholo.groups import AbstractMatrixGroup, ProductGroup, Translations, quaternion_from_matrix
from nonholo.io.provenance import attributes, describe_group
from nonholo.orbit import STATES, AbstractOrbit, Orbit, configurations, poses, unwrap
from nonholo.systems import System


class Variable(NamedTuple):
    """An array with the names of its dimensions, and its attributes: xarray takes it as it is.

    Attributes:
        dims: Names; of poses by name those after the dimensions of the states.
        values: Numbers.
        attrs: Texts by name.
    """

    dims: tuple[str, ...]
    values: np.ndarray
    attrs: dict[str, Any]

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the array."""
        return self.values.shape


Variables: TypeAlias = dict[str, Variable]
_ENTRIES = ("row", "column")
_PARTS = {"quaternion_component": list("wxyz")}
HEADING = ["theta"]
QUATERNION = ["qw", "qx", "qy", "qz"]


def pose_variables(orbit: Orbit, before: Float[np.ndarray, "1 c"] | None = None) -> Variables:
    """Return the poses of an orbit by name; headings and signs of quaternions continue from row to row.

    There are none where poses are not known, or have more than a thousand numbers.

    Args:
        orbit: The orbit.
        before: The heading or the quaternion of the state before the first one, in a row.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
        >>> list(pose_variables(nh.simulate(sleigh, body_velocity=(1, 0, 0), steps=3)))
        ['x', 'y', 'heading']
    """
    group, pose = orbit.system.group, orbit.canonical_pose
    if pose is None or pose.shape[1] > _MOST:
        return {}
    if isinstance(group, ProductGroup):
        return posed(group, configurations(orbit.system, pose))
    (rows,) = rows_of(orbit.system, [Stretch(orbit.time, pose, orbit.turned)], 1, before)
    return _along(("step",), _variables_of(group, rows[:, 1:]))


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
    return with_own_axes(variables)


def with_own_axes(variables: Mapping[str, tuple[tuple[str, ...], np.ndarray, Any]]) -> Variables:
    """Return variables whose dimensions have one length each: one of another length is named by its variable.

    Example:
        >>> robot = nh.ProductGroup(nh.Translations(2), nh.Translations(3))
        >>> [variable.dims for variable in separate_variables(robot, robot.identity[None]).values()]
        [('axis',), ('shape_2_axis',)]
    """
    lengths: dict[str, int] = {}

    def own(name: str, dims: tuple[str, ...], sizes: tuple[int, ...]) -> tuple[str, ...]:
        each = zip(dims, sizes[len(sizes) - len(dims) :], strict=True)
        return tuple(dim if lengths.setdefault(dim, size) == size else f"{name}_{dim}" for dim, size in each)

    return {name: Variable(own(name, dims, x.shape), x, attrs) for name, (dims, x, attrs) in variables.items()}


def posed(group: AbstractMatrixGroup, g: Float[np.ndarray, "... K N N"], *before: str) -> Variables:
    """Return the same variables with their dimensions: any before those of the states, `step`."""
    return _along((*before, "step"), separate_variables(group, g))


def _along(states: tuple[str, ...], variables: Variables) -> Variables:
    return {name: variable._replace(dims=(*states, *variable.dims)) for name, variable in variables.items()}


def joined_rows(group: AbstractMatrixGroup, g: Float[np.ndarray, "... K N N"]) -> Float[np.ndarray, "... K c"]:
    """Return poses as rows of the columns but for the time; headings and signs of quaternions continue along K."""
    rows = separate_rows(group, g.reshape(-1, *g.shape[-2:]))
    rows = rows.reshape(*g.shape[:-2], rows.shape[-1])
    turn = layout(group)[1]
    if turn == HEADING:
        rows[..., -1] = np.unwrap(rows[..., -1], axis=-1)
    if turn == QUATERNION:
        rows[..., -4:] = continuous(rows[..., -4:])
    return rows


def _variables_of(group: AbstractMatrixGroup, rows: Float[np.ndarray, "... c"]) -> Variables:
    """Return the columns of `layout` by name."""
    position, turn = layout(group)
    where, turns = rows[..., : len(position)], rows[..., len(position) :]
    labels = _labels("position", "length unit")
    if set(position) <= set("xyz"):  # or none
        variables = {name: Variable((), where[..., i], dict(labels)) for i, name in enumerate(position)}
    else:
        variables = {"position": Variable(("axis",), where, labels)}
    return variables | _turn(group, turn, turns)


def _turn(group: AbstractMatrixGroup, turn: list[str], turns: np.ndarray) -> Variables:
    if not turn:
        return {}
    if turn == HEADING:
        return {"heading": Variable((), turns[..., 0], _labels("angle of the body", "rad"))}
    if turn == QUATERNION:
        labels = _labels("unit quaternion w, x, y, z of the body, Hamilton's product", "1")
        return {"quaternion": Variable(("quaternion_component",), turns, labels)}
    size = round(np.sqrt(turns.shape[-1]))
    name, meaning = ("rotation", "rotation") if group.is_rigid else ("configuration", "pose")
    matrices = turns.reshape(*turns.shape[:-1], size, size)
    return {name: Variable(_ENTRIES, matrices, _labels(f"{meaning} as a matrix", "1"))}


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
    """Return the names of the numbers of a compact pose; none where the columns are other numbers, as of products.

    Example:
        >>> compact_names(nh.SE(2)), compact_names(nh.SO(3))
        (['cos', 'sin', 'x', 'y'], ['qw', 'qx', 'qy', 'qz'])
    """
    position, turn = layout(group)
    if turn == HEADING:
        return ["cos", "sin", *position]
    names = [*(_entries(3) if turn == QUATERNION and position else turn), *position]
    return names if len(names) == group.pose_size else []


def separate_rows(group: AbstractMatrixGroup, g: Float[np.ndarray, "R N N"]) -> Float[np.ndarray, "R c"]:
    """Return poses that do not follow one another as rows of the columns but for the time.

    Angles are between -pi and pi, quaternions have a scalar that is not negative.
    """
    position, turn = layout(group)
    if turn == HEADING:
        turns = np.arctan2(g[:, 1, 0], g[:, 0, 0])[:, None]
    elif turn == QUATERNION:
        turns = quaternion_from_matrix(g[:, :3, :3])
    else:
        size = math.isqrt(len(turn))
        turns = g[:, :size, :size].reshape(len(g), len(turn))
    return np.concatenate([g[:, : len(position), len(position)], turns], axis=1)


def rows_of(
    system: Any, stretches: Iterable[Stretch], every: int, before: Float[np.ndarray, "1 c"] | None = None
) -> Iterator[Float[np.ndarray, "R c"]]:
    """Return one in `every` of the states as rows of the columns; rows do not depend on how the motion is cut.

    The first row continues from the one `before`, if there is one. Coordinates are columns as they are.
    """
    names = list(getattr(system, "coordinates", ()))
    position, turn = (names, []) if names else layout(system.group)
    first = 0
    for time, pose, headings in _with_headings(stretches, before) if turn == HEADING else stretches:
        own_rows = slice(-first % every, None, every)
        place = pose[own_rows] if names else _separate_rows_of(system, pose[own_rows], len(position), turn)
        rows = np.concatenate([time[own_rows, None], place], axis=1)
        if turn == HEADING:
            rows[:, -1] = np.asarray(headings)[own_rows]
        if turn == QUATERNION:
            rows[:, -4:] = continuous(rows[:, -4:], None if before is None else before[:, -4:])
        first, before = first + len(time), rows[-1:] if len(rows) else before
        yield rows


def _separate_rows_of(system: Any, pose: np.ndarray, n: int, turn: list[str]) -> Float[np.ndarray, "R c"]:
    """Return `separate_rows` of poses with n coordinates: compact ones with the turn first, or matrices."""
    if pose.shape[1:] == (4,) and turn in (HEADING, QUATERNION):
        compact = poses(system, pose)
        return np.concatenate([compact[:, 4 - n :], compact[:, : len(turn)]], axis=1)
    return separate_rows(system.group, pose if pose.ndim == 3 else configurations(system, pose))


def layout(group: AbstractMatrixGroup) -> tuple[list[str], list[str]]:
    """Return the columns of the position and of the turn; groups that are none of ours have all entries as turn."""
    text = describe_group(group)
    kind, n = text["group"], text.get("n", 0)
    if kind == "Translations":
        return _numbers(n), []
    if kind not in ("SO", "SE"):
        return [], _entries(group.size)
    position = [] if kind == "SO" else list("xyz"[:n]) if n <= 3 else _numbers(n)
    if (kind, n) == ("SE", 2):
        return position, HEADING
    return position, QUATERNION if n == 3 else _entries(n)


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


def continuous(q: Float[np.ndarray, "... R 4"], before: np.ndarray | None = None) -> Float[np.ndarray, "... R 4"]:
    """Return the quaternions, each with the sign that is nearer to the one before it."""
    chain = np.concatenate([q[..., :1, :] if before is None else before, q], axis=-2)
    signs = np.where(np.sum(chain[..., 1:, :] * chain[..., :-1, :], axis=-1) < 0, -1.0, 1.0)
    return q * np.cumprod(signs, axis=-1)[..., : q.shape[-2], None]


CANONICAL = "canonical/"
"""The group of a store that holds compact states."""
STEP = CANONICAL + "step"
"""The numbers of steps in a store, where they do not follow from the places of its rows."""
_MOST = 1000  # components of a momentum, or numbers of a pose, that are reported
HEADED = ("heading", "quaternion")  # whose rows continue from the row before

# name: dimensions after `step`, and what the numbers are
_COMPACT = {
    "reduced_momentum": (("component",), "momentum along the constraint subspace, canonical frame", "momentum unit"),
    "cayley": (("chart",), "chart coordinates of the displacement, canonical frame", "1"),
    "pose": (("pose_component",), "compact pose, canonical frame", "1, lengths in length unit"),
    "turned": ((), "heading without ambiguity of full turns", "rad"),
}
_KNOWN = {
    "energy": ((), "reduced constrained energy", "energy unit"),
    "restricted_momentum": (("component",), "momentum along the rows of the constraint subspace", "momentum unit"),
    "body_velocity": (("coordinate",), "body velocity", "1 / time unit"),
    "momentum": (("coordinate",), "body momentum", "momentum unit"),
}
_STORED = ("energy", "restricted_momentum")
_MATRICES = {
    "configuration": (_ENTRIES, "pose as a matrix", "1"),
    "displacement": (_ENTRIES, "displacement of one step as a matrix", "1"),
}
_IMPULSES = "multipliers: forces of a flow, impulses to the next state of a discrete orbit"
_OTHERS = {"time": ((), "time", "time unit"), "multipliers": (("multiplier",), _IMPULSES, "force unit, or times time")}
_LABELS = _COMPACT | _KNOWN | _MATRICES | _OTHERS
_SPATIAL = {  # of a right-invariant constraint
    "reduced_momentum": "spatial momentum along the constraint subspace",
    "restricted_momentum": "spatial momentum along the rows of the constraint subspace",
    "cayley": "chart coordinates of the spatial displacement",
}


def orbit_to_dataset(orbit: Orbit, *, decoded: bool = False) -> xarray.Dataset:
    r"""Return an orbit as a labeled dataset in the user's body frame; attributes describe its making.

    Variables along `step`, whose coordinate is the number of the step, with the coordinate `time`: `energy`,
    `restricted_momentum`, `body_velocity`, `momentum` and the pose.

    | group | the pose |
    |---|---|
    | SE(2) | `x`, `y`, `heading` |
    | SO(3), SE(3) | `quaternion`: w, x, y, z, unit, signs continuous; on SE(3) also `x`, `y`, `z` |
    | SO(n), SE(n) | `rotation`, a matrix; on SE(n) also `position` |
    | translations | `position` |
    | products | those of the factors, translations as `shape` |
    | other groups | `configuration`, a matrix |

    Quantities that the orbit does not have, or that are too large in many dimensions, are left out.

    Args:
        orbit: The orbit to label.
        decoded: Also poses and displacements as matrices, and `multipliers` of an orbit of which every step is saved,
            NaN after the last state of a discrete one.

    Example:
        >>> orbit = nh.simulate(nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1), body_velocity=(1, 0, 0), steps=3)
        >>> list(orbit.to_dataset().data_vars)
        ['energy', 'restricted_momentum', 'body_velocity', 'momentum', 'x', 'y', 'heading']
    """
    names = (*_KNOWN, *_MATRICES) if decoded else tuple(_KNOWN)
    states = {name: _variable(orbit, name) for name in names if _is_known(orbit, name)}
    columns = {"time": _variable(orbit, "time")} | states | pose_variables(orbit)
    motion: Any = orbit.motion
    is_own = not isinstance(motion, Discretization) or (motion.order == 2 and orbit.has_every_step)
    has_multipliers = is_own and not motion.is_measured and len(orbit) > 0 and _is_known(orbit, "momentum")
    if decoded and has_multipliers:  # that need no other steps than those of its states
        rows = orbit.multipliers
        missing = np.full((len(orbit) - len(rows), rows.shape[1]), np.nan)
        columns["multipliers"] = _variable(orbit, "multipliers", np.concatenate([rows, missing]))
    number = ("step", orbit.step, {"long_name": "number of the step", "units": "1"})
    dataset = xarray.Dataset(with_own_axes(columns), {"step": number}, attributes(orbit))
    return dataset.set_coords("time").copy(deep=True)


def stored_variables(orbit: Any, before: Float[np.ndarray, "1 c"] | None = None) -> dict[str, Variable]:
    """Return the arrays of a store by name: what a person knows, and compact states in a separate group.

    Args:
        orbit: An orbit or a block of one.
        before: The heading or the quaternion of the state before the first one, in a row.
    """
    if not orbit.is_compact:
        rows = {name: Variable(("step", *axes), *rest) for name, (axes, *rest) in orbit.labeled_rows().items()}
        time = Variable(("step",), orbit.time, {"long_name": "time"})
        return _with_names(orbit, rows) | {"time": time}
    rows = {name: getattr(orbit, state) for name, state in zip(_COMPACT, STATES[1:], strict=True)}
    compact = {CANONICAL + name: _variable(orbit, name, own) for name, own in rows.items() if own is not None}
    states = {name: _variable(orbit, name) for name in _STORED if _is_known(orbit, name)}
    states |= pose_variables(orbit, before)
    for variable in states.values():
        variable.attrs["coordinates"] = "time"  # those of the group canonical need none
    return {"time": _variable(orbit, "time")} | states | compact


def variables_of(orbit: Any) -> dict[str, Variable]:
    """Return what tables have of an orbit: all that its dataset tells, but matrices that poses by name stand for."""
    dataset: Any = orbit.to_dataset()
    if not orbit.coordinates:
        poses = separate_variables(orbit.space, orbit.space.identity[None])
        dataset = dataset.drop_vars({"configuration", "displacement"} - poses.keys(), errors="ignore")
    columns = dataset.reset_coords("time").data_vars.items()
    return _with_names(orbit, {str(name): Variable(tuple(map(str, x.dims)), x.values, x.attrs) for name, x in columns})


def _with_names(orbit: Any, variables: dict[str, Variable]) -> dict[str, Variable]:
    """Return variables that are not empty, with attributes for their times and for names along their last axis."""
    names = _PARTS | ({"coordinate": list(orbit.coordinates)} if orbit.coordinates else {})
    whole = {name: variable for name, variable in variables.items() if 0 not in variable.shape[1:]}
    for name, (dims, _, attrs) in whole.items():
        if name != "time":
            attrs["coordinates"] = "time"
        if dims[-1] in names:
            attrs["components"] = names[dims[-1]]
    return whole


def columns_of(name: str, shape: tuple[int, ...], attributes: Mapping[str, Any]) -> list[str]:
    """Return the names of the numbers of a variable: its own, then numbers or the names of its components.

    Coordinates have their names alone.

    Example:
        >>> columns_of("configuration", (2,), {"components": ["x", "y"]}), columns_of("momentum", (2,), {})
        (['x', 'y'], ['momentum_0', 'momentum_1'])
    """
    if not shape:
        return [name]
    components = attributes.get("components")
    stem = name.removesuffix("configuration").removesuffix("_") if components else name
    labels = itertools.product(components or range(shape[0]), *map(range, shape[1:]))
    return ["_".join(filter(None, [stem, *map(str, place)])) for place in labels]


def is_known(system: System, name: str, *, posed: bool, discrete: bool) -> bool:
    """Return whether motions of a system have a quantity; with a right-invariant constraint most need the pose."""
    needs_pose = {"configuration"}
    if system.is_spatial:
        needs_pose |= {"energy", "momentum", "body_velocity", "displacement"}
    if (name in needs_pose and not posed) or (name == "displacement" and not discrete):
        return False
    return name in _STORED or system.group.dim <= _MOST


def labels_of(system: System, name: str) -> tuple[tuple[str, ...], dict[str, str]]:
    """Return the dimensions of a quantity after those of the states, and its attributes."""
    axes, meaning, units = _LABELS[name]
    return axes, {"long_name": _SPATIAL.get(name, meaning) if system.is_spatial else meaning, "units": units}


def _is_known(orbit: Orbit, name: str) -> bool:
    return is_known(orbit.system, name, posed=orbit.canonical_pose is not None, discrete=orbit.cayley is not None)


def _variable(orbit: Orbit, name: str, values: np.ndarray | None = None) -> Variable:
    axes, labels = labels_of(orbit.system, name)
    return Variable(("step", *axes), getattr(orbit, name) if values is None else values, labels)


def orbit_to_pandas(orbit: AbstractOrbit) -> Any:
    """Return an orbit as a `pandas.DataFrame` in the user's body frame, indexed by time.

    Columns are the variables of `orbit_to_dataset`; those of several numbers have their numbers in the name, from 0 on,
    quaternions the letters w, x, y, z. Coordinates of a Lagrange-d'Alembert system have their names, such as `x`; what
    belongs to one has its name too, such as `momentum_x`.

    Example:
        >>> orbit = nh.simulate(nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1), body_velocity=(1, 0, 0), steps=3)
        >>> table = orbit.to_pandas()
        >>> table.shape, list(table.columns[-5:])
        ((4, 12), ['momentum_1', 'momentum_2', 'x', 'y', 'heading'])
    """
    variables = variables_of(orbit)
    time = pandas.Index(variables.pop("time").values, name="time")
    columns: dict[str, np.ndarray] = {}
    for name, variable in variables.items():
        names = columns_of(name, variable.shape[1:], variable.attrs)
        columns |= dict(zip(names, variable.values.reshape(len(time), len(names)).T, strict=True))
    return pandas.DataFrame(columns, index=time)
