"""The members of an ensemble: one motion, the parameters in which each differs, their closed form and their starts."""

import contextlib
import dataclasses
import functools
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from nonholo import kernels
from nonholo.base.checks import array, error, shape_of, shown
from nonholo.base.memo import Keeper
from nonholo.base.numerics import applied, factors_of, solve_by_factors
from nonholo.base.types import Bool, Float
from nonholo.discrete import discretize
from nonholo.orbit import First
from nonholo.systems import AbstractCoordinateSystem, Start, System, in_coordinates, in_group

STEP = "time_step"
_ARGUMENTS = {"given_inertia": "inertia_operator"}  # fields that the constructor calls otherwise


@dataclasses.dataclass(frozen=True, eq=False)
class Members(Keeper):
    """Motions that differ by parameters.

    Attributes:
        discrete: The discretized system of all members, but for the parameters; of flows their `ContinuousFlow`.
        parameters: Values by name, a field of the system or "time_step", with a leading member axis.
        count: The number M of members.
    """

    discrete: Any
    parameters: dict[str, Float[np.ndarray, "M ..."]]
    count: int

    def __len__(self) -> int:
        return self.count

    @property
    def in_coordinates(self) -> bool:
        """Whether they move in coordinates, which have no closed forms."""
        return in_coordinates(self.discrete)

    @property
    def time_step(self) -> Float[np.ndarray, "m"]:
        """The time step of each member, or that of all as one number; NaN of flows."""
        return self.values(STEP)

    @functools.cached_property
    def route(self) -> Any:
        """How steps of the shared motion are computed; of a flow those of its map, None in coordinates."""
        if self.in_coordinates:
            return None
        is_flow = self.discrete.time_step is None
        return (discretize(self.discrete.system, 1.0) if is_flow else self.discrete).route  # it knows closed forms

    def values(self, name: str) -> Float[np.ndarray, "m ..."]:
        """Return a parameter of each member, or with an axis of length 1 that of all."""
        if name in self.parameters:
            return self.parameters[name]
        if name == STEP:
            return np.array([self.discrete.time_step], dtype=np.float64)
        return np.asarray(numbers_of(self.discrete)[name])[None]

    def of(self, member: int) -> Any:
        """Return the motion of one member."""
        own = {name: values[member] for name, values in self.parameters.items()}
        changes = {STEP: own.pop(STEP)} if STEP in own else {}
        if own:
            changes["system"] = _rebuilt(self.discrete.system, own)
        return dataclasses.replace(self.discrete, **changes) if changes else self.discrete

    @property
    def of_system(self) -> set[str]:
        """The parameters that belong to the system."""
        return self.parameters.keys() - {STEP}

    @functools.cached_property
    def joint_system(self) -> System | None:
        """The systems of all members in one, numbers with an axis of members in front where any of them differ.

        None where formulas do not allow it, and in coordinates.
        """
        if self.in_coordinates:
            return None
        if not self.of_system:
            return self.discrete.system
        system = self.discrete.system.inside
        values = {name: self.values(_ARGUMENTS.get(name, name)) for name in _leaves(system)}
        return system.stack(**{name: np.broadcast_to(x, (len(self), *x.shape[1:])) for name, x in values.items()})

    @functools.cached_property
    def lanes(self) -> Any:
        """The route of all members in one, in closed form; None where they do not have the same."""
        if self.route is None or not self.route.is_scalar or self.joint_system is None:
            return None
        return self.route.of_many(self.joint_system, self.time_step) if self.parameters else self.route

    def part(self, which: slice) -> "Members":
        """Return some of the members."""
        if which.indices(self.count) == (0, self.count, 1):
            return self
        numbers = {name: values[which] for name, values in self.parameters.items()}
        return Members(self.discrete, numbers, len(range(*which.indices(self.count))))


def _rebuilt(system: Any, own: dict[str, Any]) -> Any:
    if isinstance(system, AbstractCoordinateSystem):
        return system.with_parameters(**own)
    if system.is_forced:
        return dataclasses.replace(system, system=_rebuilt(system.system, own))
    names = [field.name for field in dataclasses.fields(system)]
    fields = {_ARGUMENTS.get(name, name): getattr(system, name) for name in names}
    return type(system)(**{**fields, **own})


def _leaves(system: System) -> list[str]:
    return [name for name in system.leaves if getattr(system, name) is not None]


def numbers_of(motion: Any) -> dict[str, Any]:
    """Return what may differ from member to member, by the name that its constructor has for it."""
    step = {} if motion.time_step is None else {STEP: motion.time_step}
    if in_coordinates(motion):
        return {**motion.system.parameters, **step}
    system = motion.system.inside
    return {_ARGUMENTS.get(name, name): getattr(system, name) for name in _leaves(system)} | step


def checked_parameters(motion: Any, parameters: Any) -> dict[str, Any]:
    """Return the parameters of an ensemble as arrays, refused with names that the motion does not have."""
    if parameters is None:
        return {}
    if not isinstance(parameters, Mapping):
        raise error("ensemble(parameters=...)", "be a mapping of names to arrays", shown(parameters), "Pass a dict.")
    numbers = numbers_of(motion)
    kind, arrays = type(motion.system if in_coordinates(motion) else motion.system.inside).__name__, {}
    for name, value in parameters.items():
        if name not in numbers:
            requirement, remedy = "name fields of the system", f"{kind} has {', '.join(numbers)}."
            if [*numbers] == [STEP]:
                requirement = f"name {STEP!r} alone for a system in coordinates that has no parameters"
                remedy = "Give it some: LagrangeDAlembert(lagrangian, forms, dimension=n, parameters={'mass': 1.0})."
            elif name == STEP:
                remedy = "A flow has no time step."
            raise error("ensemble(parameters=...)", requirement, shown(name), remedy)
        shape = np.shape(numbers[name])
        where = f"ensemble(parameters={{{name!r}: ...}})"
        arrays[name] = array(where, value, (None, *shape), "Pass one value for each member.")
    return arrays


@contextlib.contextmanager
def naming(member: int) -> Iterator[None]:
    """Refuse one member with its number."""
    try:
        yield
    except ValueError as failure:
        raise ValueError(f"{failure} This is member {member}.") from failure


class ScalarMembers:
    """Members of one closed form as its kernel sees them; an axis of length 1 where all agree.

    Attributes:
        members: Who runs.
        route: The route of all of them in one.
        axes: The change from the canonical axes to those of the kernel, with an axis of members where they differ.
    """

    def __init__(self, members: Members) -> None:
        self.members, self.route = members, members.lanes
        self.axes = self.route.axes

    @property
    def body(self) -> type[Any]:
        """The type of the bodies that the kernel runs."""
        return type(self.members.route.body)

    @functools.cached_property
    def fields(self) -> Float[np.ndarray, "f m"]:
        """Fields of their bodies, one row each, which only a run needs: for tops they take longer than all else."""
        fields = np.broadcast_arrays(*self.route.body)
        return np.reshape(fields, (len(fields), -1))

    @property
    def scale(self) -> Float[np.ndarray, "m"]:
        """Factors from momenta to those of the kernel."""
        return np.reshape(self.route.scale, -1)

    @functools.cached_property
    def to_canonical(self) -> kernels.MemberAxes:
        """How the kernel takes its rows to canonical numbers."""
        axes = self.axes
        C = np.zeros((1, 2, 2)) if axes.rows is None else axes.rows.reshape(-1, 2, 2)
        back = C if axes.rows is None else axes.inverse.reshape(-1, 2, 2)
        turn = np.zeros((1, 4)) if axes.frame is None else axes.turns[1].reshape(-1, 4)
        parts = self.scale[:, None], back.reshape(-1, 4), C.swapaxes(1, 2).reshape(-1, 4), turn
        count = max(map(len, parts))
        columns = np.hstack([np.broadcast_to(part, (count, part.shape[1])) for part in parts])
        numbers = np.ascontiguousarray(columns)  # as the library takes it
        space = 0 if axes.frame is None else 3 if axes.group.curvature else 2
        return kernels.MemberAxes(numbers, axes.rows is not None, space)

    @property
    def inertia(self) -> Float[np.ndarray, "m 2 2"]:
        """Inertias along the constraint in the canonical frame."""
        return np.reshape(self.route.system.canonical.inertia_along, (-1, 2, 2))

    @property
    def frame_map(self) -> Float[np.ndarray, "m 2 2"]:
        """C with r_canonical = C r."""
        return np.reshape(self.route.system.frame_map, (-1, 2, 2))

    @property
    def pose(self) -> Float[np.ndarray, "m 4"]:
        """First poses."""
        return np.reshape(self.route.system.frame_pose, (-1, 4))

    def charts(self, canonical: Float[np.ndarray, "M K 2"]) -> Float[np.ndarray, "M K 2"]:
        """Return chart coordinates of the kernel: of a sleigh the first is the tangent of half the turn."""
        return self.axes.beside(1).charts(canonical)


def in_lanes(members: Members) -> bool:
    """Return whether members are computed side by side: those of one closed form."""
    return members.lanes is not None


def tangents(
    members: Members, momenta: Float[np.ndarray, "M K 2"], charts: Float[np.ndarray, "M K 2"]
) -> Float[np.ndarray, "M K 2 2"]:
    """Return the derivatives of steps of members in lanes by the momenta of their rows before them."""
    scalar = ScalarMembers(members)
    axes = scalar.axes.beside(1)
    m1, m2 = np.moveaxis(axes.momenta(momenta) * scalar.scale[:, None, None], -1, 0)
    C, body = scalar.frame_map[:, None], scalar.body(*scalar.fields[..., None])
    own = np.stack(kernels.tangent(body, m1, m2, *np.moveaxis(axes.charts(charts), -1, 0)), axis=-1)
    C = C if axes.rows is None else axes.rows @ C
    return np.linalg.inv(C) @ own.reshape(*m1.shape, 2, 2) @ C


def inertias_of(members: Members) -> Float[np.ndarray, "m dim dim"]:
    """Return canonical inertia operators; an axis of length 1 where all members agree."""
    if members.joint_system is not None:
        inertia = members.joint_system.canonical.inertia_operator
        return inertia if inertia.ndim == 3 else inertia[None]
    return np.stack([members.of(member).system.canonical.inertia_operator for member in range(len(members))])


def check_systems(members: Members) -> None:
    """Refuse parameters of which no system can be made; those that clearly make one are checked at once."""
    step = members.parameters.get(STEP)
    if step is not None and callable(getattr(members.discrete, "difference", None)):
        where, got = "ensemble(parameters={'time_step': ...})", "a function"
        remedy = "Run `simulate` for each: your own discrete Lagrangian includes its time step."
        raise error(where, "come with a difference given by its name", got, remedy)
    if step is not None and not np.all(step > 0):
        at = int(np.argmax(~(step > 0)))
        remedy = f"Pass positive time steps. This is member {at}."
        raise error("ensemble(parameters={'time_step': ...})", "be positive", f"{step[at]}", remedy)
    joint = members.joint_system
    is_clear = not members.of_system or (joint is not None and joint.is_clear)  # that all of them, or each, can be made
    for member in np.flatnonzero(~np.broadcast_to(is_clear, len(members))).tolist():
        with naming(member):
            members.of(member)


_CHUNK = 1 << 16  # members whose starts are made at once: what it takes between is not kept
_TOLERANCE = 1e-9  # relative, for velocities and momenta that a user computed in floating point
_ONE = "Pass one row for each member, or one for all; `simulate` runs a single one."


def in_rows(motion: Any, start: Start, parameters: Any) -> tuple[Start, int, dict[str, Any]]:
    """Return a start with a row for each member, the number of members, and their parameters as arrays.

    The start and the pose may be one for all members where something else has a row for each.
    """
    numbers, (pose, velocity) = checked_parameters(motion, parameters), motion.system.shapes
    shapes: dict[str, Any] = {"configuration": pose, start.name: _shape(motion, start, pose, velocity)}
    arrays = {"configuration": start.configuration, start.name: start.value}
    arrays = {name: value for name, value in arrays.items() if value is not None}
    several = [name for name, value in arrays.items() if len(shape_of(value)) != len(shapes[name])]
    shapes |= {name: (None, *shapes[name]) for name in several}
    rows = {name: array(f"{start.owner}({name}=...)", x, shapes[name], _ONE) for name, x in arrays.items()}
    count = _common({name: len(values) for name, values in numbers.items()} | {n: len(rows[n]) for n in several})
    whole = {n: x if n in several else np.broadcast_to(x, (count, *x.shape)) for n, x in rows.items()}
    return start._replace(value=whole[start.name], configuration=whole.get("configuration")), count, numbers


def _shape(motion: Any, start: Start, pose: tuple[int, ...], velocity: tuple[int, ...]) -> tuple[int, ...]:
    """Return the shape of the start of one member."""
    if start.name == "displacement":
        return pose
    if start.name == "body_velocity" or "restricted_velocity" not in motion.starts:
        return velocity
    along = (motion.system.rank,)
    return along if start.name == "restricted_velocity" or shape_of(start.value)[-1:] == along else velocity


def _common(lengths: dict[str, int]) -> int:
    """Return the number of members, refused if there is none or several."""
    if not lengths or not all(lengths.values()):
        got, remedy = ("no rows", "Pass at least one row.") if lengths else ("one start", _ONE)
        raise error("ensemble(...)", "have a row for each member", got, remedy)
    if len(set(lengths.values())) > 1:
        got = ", ".join(f"{length} of {name}" for name, length in lengths.items())
        raise error("ensemble(...)", "have one number of rows", got, "Pass one value for each member, or one for all.")
    return next(iter(lengths.values()))


def firsts(members: Members, start: Start, *, with_poses: bool, at_once: bool) -> First:
    """Return the checked starts of all members, with poses or without, from one that has rows.

    Those that are computed side by side start at once.
    """
    if start.name == "displacement" or not at_once:
        return _one_by_one(members, start, with_poses=with_poses)
    momenta = np.empty((len(members), 2))
    for begin in range(0, len(members), _CHUNK):
        part = slice(begin, begin + _CHUNK)
        momenta[part], bad = _momenta_of_part(members.part(part), start.name, start.value[part])
        if bad.any():
            _of_one(members, start, begin + int(np.argmax(bad)), with_poses=with_poses)
    full = start.name == "momentum" and start.value.shape[1] != 2
    return First((momenta, _poses(members, start)), start.value if full else None)


def _one_by_one(members: Members, start: Start, *, with_poses: bool) -> First:
    each = [_of_one(members, start, member, with_poses=with_poses) for member in range(len(members))]
    numbers = tuple(np.stack(column) for column in zip(*(first.numbers for first in each), strict=True))
    demands = [first.demand for first in each if first.demand is not None]
    return First(numbers, np.stack(demands) if demands else None)


def _of_one(members: Members, start: Start, member: int, *, with_poses: bool) -> First:
    """Return the checked start of one member, refused with its number."""
    pose = None if start.configuration is None else start.configuration[member]
    own = start._replace(value=start.value[member], configuration=pose)
    with naming(member):
        return members.of(member).first(own, with_poses=with_poses)


def _poses(members: Members, start: Start) -> Float[np.ndarray, "M 4"]:
    """Return the first poses of members in closed form, in the canonical frame."""
    system, pose = members.discrete.system, ScalarMembers(members).pose
    if start.configuration is None:
        return np.broadcast_to(pose, (len(members), pose.shape[1]))
    for member, g in enumerate(start.configuration):
        with naming(member):
            in_group(f"{start.owner}(configuration=...)", system.group, g)
    frames = system.frame if len(pose) == 1 else system.group.matrix_from_pose(pose)
    return system.group.pose_from_matrix(start.configuration @ frames)


def _momenta_of_part(members: Members, name: str, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return canonical momenta, and which members may not start: the constraint is broken, the energy not finite."""
    scalar, bad = ScalarMembers(members), np.zeros(len(members), dtype=bool)
    system = scalar.route.system
    S = system.constraint_subspace
    with np.errstate(over="ignore", invalid="ignore"):
        if name == "body_velocity":
            bad = np.abs(rows @ system.annihilator.T).max(axis=1) > _TOLERANCE * np.abs(rows).max(axis=1)
            rows = applied(np.linalg.pinv(S).T, rows)
        if name == "momentum":
            momenta = rows if rows.shape[1] == system.rank else applied(S, rows)
        else:
            momenta = system.restricted_momentum(rows)
        momenta = system.to_canonical(momenta)
        return momenta, bad | ~np.isfinite(energies(scalar, momenta))


def energies(scalar: ScalarMembers, momenta: Float[np.ndarray, "M ... 2"]) -> Float[np.ndarray, "M ..."]:
    """Return the reduced constrained energies of canonical momenta."""
    factors = factors_of(scalar.inertia.reshape(-1, *(1,) * (momenta.ndim - 2), 2, 2))
    if factors is None:
        return np.full(momenta.shape[:-1], np.nan)
    return (momenta * solve_by_factors(factors, momenta)).sum(-1) / 2


def are_others(demand: Float[np.ndarray, "M ..."], full: Float[np.ndarray, "M ..."]) -> Bool[np.ndarray, "M"]:
    """Return which momenta or displacements that were given are not those with which the members start."""
    demand, full = demand.reshape(len(demand), -1), full.reshape(len(full), -1)
    return np.linalg.norm(demand - full, axis=1) > _TOLERANCE * np.linalg.norm(full, axis=1)
