"""The members that are computed side by side, those of one closed form, in numbers of many systems in one."""

import functools
from typing import Any

import numpy as np

from nonholo import kernels
from nonholo.base.checks import error
from nonholo.base.types import Bool, Float
from nonholo.discrete import Discretization
from nonholo.simulation.members._members import STEP, Members, refused


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


def run_in_lanes(discrete: Discretization) -> bool:
    """Tell whether the members of an ensemble of a discretization are computed side by side."""
    return in_lanes(Members(discrete, {}, 1))


def in_lanes(members: Members) -> bool:
    """Tell whether members are computed side by side: those of one closed form."""
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
    if members.stacked is not None:
        inertia = members.stacked.canonical.inertia_operator
        return inertia if inertia.ndim == 3 else inertia[None]
    return np.stack([members.of(member).system.canonical.inertia_operator for member in range(len(members))])


def check_systems(members: Members) -> None:
    """Refuse parameters of which no system can be made; those that clearly make one are looked through in one go."""
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
    is_clear = not members.of_system or (members.stacked is not None and members.stacked.is_clear)
    return np.broadcast_to(~np.asarray(is_clear), len(members))
