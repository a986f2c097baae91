"""The families whose members are computed side by side, tops (n = 3) and plane sleighs: one entry each in one table."""

import dataclasses
import functools
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from nonholo import kernels
from nonholo.base.checks import error
from nonholo.base.types import Bool, Float
from nonholo.discrete import Discretization
from nonholo.simulation.members._members import STEP, Members, refused
from nonholo.systems import ChaplyginSleigh, LLSystem, RigidBody, SuslovTop


@dataclasses.dataclass(frozen=True, eq=False)
class ScalarMembers:
    """The bodies that the kernels of tops (n = 3) and plane sleighs see; an axis of length 1 where all members agree.

    Attributes:
        table: Makes the fields of their bodies, which only a run needs: for tops they take longer than all else.
        scale: Factors from canonical momenta to those of the kernel, (m,).
        inertia: Inertias along the constraint in the canonical frame, (m, 2, 2).
        frame_map: C with r_canonical = C r, (m, 2, 2).
        pose: First poses, (m, 4).
        route: That of all members, whose kernel has units and axes of its own; None where `scale` is all.
    """

    table: Callable[[], Float[np.ndarray, "f _"]]
    scale: Float[np.ndarray, "_"]
    inertia: Float[np.ndarray, "_ 2 2"]
    frame_map: Float[np.ndarray, "_ 2 2"]
    pose: Float[np.ndarray, "_ 4"]
    route: Any = None

    @functools.cached_property
    def fields(self) -> Float[np.ndarray, "f m"]:
        """Fields of their bodies, one row each."""
        return self.table()


class Family(NamedTuple):
    """The functions of a family for an ensemble.

    Attributes:
        body: The type of the bodies that its kernel runs.
        numbers: What the kernels see of members.
        keeps_frame: Parameters that leave the user's frame where it is.
        is_doubtful: Tells which members have to be built to know that they can be; all others can.
    """

    body: type[Any]
    numbers: Callable[[Members], ScalarMembers]
    keeps_frame: frozenset[str]
    is_doubtful: Callable[[Members], Bool[np.ndarray, "M"]]


def _sleighs(members: Members) -> ScalarMembers:
    m, J, a, b = np.broadcast_arrays(*map(members.values, ("mass", "inertia", "a", "b")))
    zero, one = np.zeros_like(m), np.ones_like(m)
    turning = J / 2 + m * a * a + J / 2  # as the mass tensor of one body adds it
    inertia = np.moveaxis(np.array([[turning, zero], [zero, m]]), -1, 0)
    frame_map = np.moveaxis(np.array([[one, b], [zero, one]]), -1, 0)
    pose = np.stack([one, zero, zero, b], axis=-1)
    return ScalarMembers(lambda: np.stack([m, J, a]), members.time_step, inertia, frame_map, pose)


def _tops(members: Members) -> ScalarMembers:
    system = members.discrete.system
    F, J = system.frame, members.values("mass_tensor")
    turned = F.T @ J @ F
    J = (turned + turned.swapaxes(1, 2)) / 2
    B = J[:, :2, :2] + J[:, 2:, 2:] * np.eye(2)
    pose = system.group.pose_from_matrix(F)[None]
    table = functools.partial(kernels.suslov_table, B, J[:, :2, 2])
    return ScalarMembers(table, members.time_step / 2, B, np.asarray(system.frame_map)[None], pose)


def _doubtful_sleighs(members: Members) -> Bool[np.ndarray, "M"]:
    mass, inertia = members.values("mass"), members.values("inertia")
    return np.broadcast_to(~((mass > 0) & (inertia > 0)), len(members))


def _doubtful_tensors(members: Members) -> Bool[np.ndarray, "M"]:
    J = members.values("mass_tensor")
    eigenvalues = np.linalg.eigvalsh(J)
    clear = (J.swapaxes(1, 2) == J).all(axis=(1, 2)) & (eigenvalues[:, 0] > 1e-12 * eigenvalues[:, -1])
    return np.broadcast_to(~clear, len(members))


_FAMILIES = {
    ChaplyginSleigh: Family(kernels.SleighBody, _sleighs, frozenset({"mass", "inertia", "a"}), _doubtful_sleighs),
    SuslovTop: Family(kernels.SuslovBody, _tops, frozenset({"mass_tensor"}), _doubtful_tensors),
}
_STACKED = (ChaplyginSleigh, SuslovTop, RigidBody, LLSystem)
"""Systems whose formulas allow for an axis of members in front of all numbers."""


def family_of(system: Any) -> Family | None:
    """Return what is known of a family, whatever n; None of others."""
    return _FAMILIES.get(type(system))


def run_in_lanes(discrete: Discretization) -> bool:
    """Tell whether the members of an ensemble of a discretization are computed side by side."""
    return have_kernel(Members(discrete, {}, 1))


def have_kernel(members: Members) -> bool:
    """Tell whether members are tops (n = 3) or plane sleighs with a step in closed form."""
    route, family = members.route and members.route.compiled, family_of(members.discrete.system)
    return route is not None and route.is_scalar and family is not None and isinstance(route.body, family.body)


def in_lanes(members: Members) -> bool:
    """Tell whether members are computed side by side: those that have a kernel, and those of one closed form."""
    route = members.route
    return have_kernel(members) or (not members.parameters and route is not None and route.is_scalar)


def body_of(members: Members) -> type[Any]:
    """Return the type of the bodies of members that are computed side by side."""
    if have_kernel(members):
        return _FAMILIES[type(members.discrete.system)].body
    return type(members.route.body)


def scalar_members(members: Members) -> ScalarMembers:
    """Return the numbers of members that are computed side by side."""
    if have_kernel(members):
        return _FAMILIES[type(members.discrete.system)].numbers(members)
    return _of_one_route(members)


def _of_one_route(members: Members) -> ScalarMembers:
    """Return the numbers of members that are one body, whatever its class, in the axes of its normal form."""
    route, system = members.route, members.discrete.system
    inertia = np.asarray(system.canonical.constrained_inertia)[None]
    frame_map, pose = np.asarray(system.frame_map)[None], system.frame_pose[None]
    return ScalarMembers(lambda: np.array(route.body)[:, None], members.time_step, inertia, frame_map, pose, route)


def tangents(
    members: Members, momenta: Float[np.ndarray, "M K 2"], charts: Float[np.ndarray, "M K 2"]
) -> Float[np.ndarray, "M K 2 2"]:
    """Return the derivatives of steps of tops and plane sleighs by the momenta of their rows before them."""
    scalar = scalar_members(members)
    m1, m2 = np.moveaxis(momenta * scalar.scale[:, None, None], -1, 0)
    C, body = scalar.frame_map[:, None], body_of(members)(*scalar.fields[..., None])
    canonical = np.stack(kernels.tangent(body, m1, m2, *np.moveaxis(charts, -1, 0)), axis=-1).reshape(*m1.shape, 2, 2)
    return np.linalg.inv(C) @ canonical @ C


def inertias_of(members: Members) -> Float[np.ndarray, "m dim dim"]:
    """Return canonical inertia operators; an axis of length 1 where all members agree."""
    if members.parameters and type(members.discrete.system) in _STACKED:
        return members.stacked.canonical.inertia_operator
    systems = [members.of(member).system for member in range(len(members) if members.parameters else 1)]
    return np.stack([system.canonical.inertia_operator for system in systems])


def check_systems(members: Members) -> None:
    """Refuse parameters of which no system can be made; tops and sleighs are looked through in one go."""
    step = members.parameters.get(STEP)
    if step is not None and callable(getattr(members.discrete, "difference", None)):
        where, got = "ensemble(parameters={'time_step': ...})", "a function"
        remedy = "Run `simulate` for each: your own discrete Lagrangian includes its time step."
        raise error(where, "go with a difference by name", got, remedy)
    if step is not None and not np.all(step > 0):
        at = int(np.argmax(~(step > 0)))
        remedy = f"Pass positive time steps. This is member {at}."
        raise error("ensemble(parameters={'time_step': ...})", "be positive", f"{step[at]}", remedy)
    for member in np.flatnonzero(_doubtful(members)):
        try:
            members.of(int(member))
        except ValueError as failure:
            raise refused(int(member), failure) from None


def _doubtful(members: Members) -> Bool[np.ndarray, "M"]:
    """Tell which members have to be built to know that they can be."""
    varied, family = members.parameters.keys() - {STEP}, family_of(members.discrete.system)
    if not varied:
        return np.zeros(len(members), dtype=bool)
    if family is not None:
        return family.is_doubtful(members)
    return _doubtful_tensors(members) if varied == {"mass_tensor"} else np.ones(len(members), dtype=bool)
