"""The starts of the members of an ensemble, of tops and plane sleighs for all members at once."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from nonholo.base.checks import array, error, shape_of
from nonholo.base.numerics import applied, factors_of, solve_by_factors
from nonholo.base.types import Bool, Float
from nonholo.orbit import First
from nonholo.simulation.members._members import Members, ScalarMembers, refusal
from nonholo.systems import Start, in_group

_CHUNK = 1 << 16  # members whose starts are made at once: what it takes between is not kept
_TOLERANCE = 1e-9  # relative, for velocities and momenta that a user computed in floating point
_ONE = "Pass one row for each member, or one for all; `simulate` runs a single one."


class Firsts(NamedTuple):
    """The checked starts of members: as `First`, with an axis of members in front of all arrays."""

    numbers: tuple[Float[np.ndarray, "M ..."], ...]
    demand: Float[np.ndarray, "M ..."] | None

    def of(self, member: int) -> First:
        """Return the start of one member."""
        return First(tuple(x[member] for x in self.numbers), None if self.demand is None else self.demand[member])

    @property
    def places(self) -> tuple[Float[np.ndarray, "M k"], Float[np.ndarray, "M ..."]]:
        """Momenta, and poses or places."""
        return self.numbers[0], self.numbers[1]

    def part(self, which: slice) -> "Firsts":
        """Return the starts of some members."""
        return Firsts(tuple(x[which] for x in self.numbers), None if self.demand is None else self.demand[which])


def in_rows(motion: Any, start: Start, parameters: Mapping[str, np.ndarray]) -> tuple[Start, int]:
    """Return a start with a row for each member, and the number of members.

    The start and the pose may be one for all members where something else has a row for each.
    """
    pose, velocity = motion.system.shapes
    shapes = {"configuration": pose, start.name: _shape(motion, start, pose, velocity)}
    arrays = {"configuration": start.configuration, start.name: start.value}
    arrays = {name: value for name, value in arrays.items() if value is not None}
    several = [name for name, value in arrays.items() if len(shape_of(value)) != len(shapes[name])]
    rows = {
        name: array(
            f"{start.owner}({name}=...)", value, (None, *shapes[name]) if name in several else shapes[name], _ONE
        )
        for name, value in arrays.items()
    }
    count = _common({name: len(values) for name, values in parameters.items()} | {n: len(rows[n]) for n in several})
    whole = {n: x if n in several else np.broadcast_to(x, (count, *x.shape)) for n, x in rows.items()}
    return start._replace(value=whole[start.name], configuration=whole.get("configuration")), count


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


def firsts(members: Members, start: Start, *, with_poses: bool, at_once: bool) -> Firsts:
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
    return Firsts((momenta, _poses(members, start)), start.value if full else None)


def _one_by_one(members: Members, start: Start, *, with_poses: bool) -> Firsts:
    each = [_of_one(members, start, member, with_poses=with_poses) for member in range(len(members))]
    numbers = tuple(np.stack(column) for column in zip(*(first.numbers for first in each), strict=True))
    demand = None if each[0].demand is None else np.stack([np.asarray(first.demand) for first in each])
    return Firsts(numbers, demand)


def _of_one(members: Members, start: Start, member: int, *, with_poses: bool) -> First:
    """Return the checked start of one member, refused with its number."""
    pose = None if start.configuration is None else start.configuration[member]
    own = start._replace(value=start.value[member], configuration=pose)
    try:
        return members.of(member).first(own, with_poses=with_poses)
    except ValueError as failure:
        raise refusal(member, failure) from None


def _poses(members: Members, start: Start) -> Float[np.ndarray, "M 4"]:
    """Return the first poses of members in closed form, in the canonical frame."""
    system, pose = members.discrete.system, ScalarMembers(members).pose
    if start.configuration is None:
        return np.broadcast_to(pose, (len(members), pose.shape[1]))
    for member, g in enumerate(start.configuration):
        try:
            in_group(f"{start.owner}(configuration=...)", system.group, g)
        except ValueError as failure:
            raise refusal(member, failure) from None
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
