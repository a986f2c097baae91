"""The starts of the members of an ensemble, and the numbers of tops and plane sleighs for all members in one go."""

import numpy as np

from nonholo.base.checks import array, error, shape_of
from nonholo.base.numerics import applied, factors_of, solved
from nonholo.base.types import Bool, Float
from nonholo.simulation.members._families import ScalarMembers, in_lanes, scalar_members
from nonholo.simulation.members._members import Members, refused
from nonholo.systems import Start, System

_CHUNK = 1 << 16  # members whose starts are made at once: what it takes between is not kept
_TOLERANCE = 1e-9  # relative, for velocities and momenta that a user computed in floating point


def checked_rows(system: System, parameters: dict[str, np.ndarray], start: Start) -> np.ndarray:
    """Return the rows of a start, one for each member."""
    where, name, value, k, dim = start.where, start.name, start.value, system.rank, system.group.dim
    lengths = {"body_velocity": (dim,), "restricted_velocity": (k,), "momentum": (k, dim)}[name]
    shape = shape_of(value)
    size = shape[-1] if shape and shape[-1] in lengths else lengths[-1]
    if len(shape) == 1 and parameters:
        count = len(next(iter(parameters.values())))
        return np.broadcast_to(array(where, value, (size,)), (count, size))
    rows = array(where, value, (None, size), "Pass one row for each member; `simulate` runs a single one.")
    if not len(rows):
        raise error(where, "have at least one row", "none", "Pass one row for each member.")
    for other, values in parameters.items():
        if len(values) != len(rows):
            got = f"{len(values)} values for {len(rows)} rows of {name}"
            raise error(
                f"ensemble(parameters={{{other!r}: ...}})", "have one value for each member", got, "Match them."
            )
    return rows


def first_momenta(members: Members, name: str, rows: np.ndarray) -> Float[np.ndarray, "M k"]:
    """Return the canonical momenta along the constraint subspace of starts whose shapes are checked."""
    if not in_lanes(members):
        return np.array([_of_one(members, member, name, rows[member]) for member in range(len(members))])
    momenta = np.empty((len(members), 2))
    for begin in range(0, len(members), _CHUNK):
        part = slice(begin, begin + _CHUNK)
        momenta[part], bad = _momenta_of_part(members.part(part), name, rows[part])
        if bad.any():
            member = begin + int(np.argmax(bad))
            _of_one(members, member, name, rows[member])
    return momenta


def _momenta_of_part(members: Members, name: str, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return canonical momenta, and which members may not start: the constraint is broken, the energy not finite."""
    system, scalar = members.discrete.system, scalar_members(members)
    S, bad = system.constraint_subspace, np.zeros(len(members), dtype=bool)
    with np.errstate(over="ignore", invalid="ignore"):
        if name == "momentum":
            momenta = applied(scalar.frame_map, rows if rows.shape[1] == system.rank else applied(S, rows))
        elif name == "restricted_velocity" and scalar.route is not None:  # one body, whose own formula it is
            momenta = system.to_canonical(system.restricted_momentum(rows))
        else:
            if name == "body_velocity":
                bad = np.abs(rows @ system.annihilator.T).max(axis=1) > _TOLERANCE * np.abs(rows).max(axis=1)
                rows = applied(np.linalg.pinv(S).T, rows)
            momenta = applied(scalar.inertia @ np.linalg.inv(scalar.frame_map.swapaxes(1, 2)), rows)
        return momenta, bad | ~np.isfinite(energies(scalar, momenta))


def energies(scalar: ScalarMembers, momenta: Float[np.ndarray, "M ... 2"]) -> Float[np.ndarray, "M ..."]:
    """Return the reduced constrained energies of canonical momenta."""
    factors = factors_of(scalar.inertia.reshape(-1, *(1,) * (momenta.ndim - 2), 2, 2))
    return np.full(momenta.shape[:-1], np.nan) if factors is None else (momenta * solved(factors, momenta)).sum(-1) / 2


def are_others(given: Float[np.ndarray, "M dim"], full: Float[np.ndarray, "M dim"]) -> Bool[np.ndarray, "M"]:
    """Tell which full momenta that were given are not those with which the members start."""
    return np.linalg.norm(given - full, axis=1) > _TOLERANCE * np.linalg.norm(full, axis=1)


def _of_one(members: Members, member: int, name: str, row: np.ndarray) -> np.ndarray:
    """Return the canonical momentum at which one member starts, refused with its number."""
    system = members.of(member).system
    try:
        return Start("ensemble", name, row).momentum(system, system.group.identity)
    except ValueError as failure:
        raise refused(member, failure) from None
