"""The routes of balanced half impulses: with numbers for a weight, friction and a table, on matrices for any force."""

import dataclasses
import functools
from collections.abc import Callable
from typing import Any, cast

import numpy as np

from nonholo import kernels
from nonholo.base.types import Float
from nonholo.discrete._scheme import weights
from nonholo.discrete._variety import variety_of
from nonholo.discrete.routes._base import AbstractCompiledRoute, Compact, plain, poses_of
from nonholo.discrete.routes._forced import (
    AbstractForcedRoute,
    AbstractOuterRoute,
    functions_of,
    kernel_frame,
    sum_products,
)
from nonholo.groups import SE, SO
from nonholo.orbit import Orbit
from nonholo.systems import Forced


def balanced_route(free: Any, matrix: Callable[[], Any], forced: Forced, order: int) -> "BalancedRoute":
    """Return the route of balanced half impulses around a free step, or for any force around that on matrices."""
    by_numbers = forced.function is None and (forced.gravity is not None or not forced.terms)
    return BalancedRoute(free if free.is_scalar and by_numbers and order == 2 else matrix(), forced, order, matrix)


@dataclasses.dataclass(frozen=True, eq=False)
class BalancedRoute(AbstractForcedRoute, AbstractOuterRoute):
    """Equal half impulses at the displacement, by which T + U and every balance is exact; in one or several stages.

    Attributes:
        order: 2, 4, 6 or 8.
        matrix: Makes the route of the free step on matrices.
    """

    order: int = 2
    matrix: Any = dataclasses.field(default=None, repr=False)

    @property
    def compiled_route(self) -> "BalancedRoute | None":  # type: ignore[override]
        """The route itself, if numba compiled all functions that it calls."""
        return self if self.forced.is_jitted else None

    @functools.cached_property
    def body(self) -> kernels.ForcedBody:
        """The body and its half impulses."""
        forced, free = self.forced, self.free
        kick = pull(free, forced) if free.is_scalar else balance(free, forced, self.order, self.faults)
        return kernels.ForcedBody(free.body, kick)

    @functools.cached_property
    def general(self) -> "BalancedRoute":
        """The route of any force, whose step has parts."""
        return dataclasses.replace(self, free=self.matrix()) if self.free.is_scalar else self

    def parts(self, states: Orbit, fractions: Float[np.ndarray, "K"]) -> Compact:
        """Return momenta, charts and poses after fractions of the steps from states; NaN where none starts."""
        if self.general is self:
            return super().parts(states, fractions)
        momenta, charts, poses = self.general.parts(states, fractions)
        if self.forced.group == SO(3):  # of both quaternions of a pose that of a turn by less than a half
            ahead = (poses * poses_of(states, is_needed=True)).sum(axis=1, keepdims=True)
            poses = np.where(ahead < 0, -poses, poses)
        return momenta, charts, poses

    def _part(self, m: np.ndarray, pose: np.ndarray, time: float, step: int, fraction: float) -> Compact | None:
        k = len(m)
        code, state = self.after(np.array(m), np.array(pose), time, step, fraction)
        if code != 0:
            return None
        after, place = state[:k].copy(), state[2 * k : 2 * k + len(pose)].copy()
        _, ahead = self.after(after, place, time + fraction * float(self.free.time_step), step + int(fraction), 1.0)
        return after, self.runs.chart_of(self.body, ahead), place

    def after(
        self, m: np.ndarray, pose: np.ndarray, time: float, step: int, fraction: float, force: Any = None
    ) -> tuple[int, np.ndarray]:
        """Return the outcome of a fraction of a step, and the kernel's state after it; a constant force may act too."""
        half = cast(kernels.Balanced, self.body.kick)
        rows = half.c.rows[[min(step, len(half.c.rows) - 1), -1]]
        if force is not None:
            rows = rows + half.c.along @ force
        c = half.c._replace(stages=fraction * half.c.stages, begin=float(time), rows=rows)
        return self.runs.start(self.body._replace(kick=half._replace(c=c)), m, pose)

    def body_from(self, step: int) -> kernels.ForcedBody:
        """Return the body of a run that begins at a step."""
        kick = self.body.kick
        if isinstance(kick, kernels.Pull):
            return self.body._replace(kick=kick._replace(rows=kick.rows[min(step, len(kick.rows) - 1) :]))
        c = cast(kernels.Balanced, kick).c
        c = c._replace(rows=c.rows[min(step, len(c.rows) - 1) :], begin=step * float(self.free.time_step))
        return self.body._replace(kick=cast(kernels.Balanced, kick)._replace(c=c))


def pull(free: AbstractCompiledRoute, forced: Forced) -> kernels.Pull:
    """Return half impulses of a weight, friction and a table, for tops in space and sleighs in the plane."""
    half, inside, flat = float(free.time_step) / 2, 2 if forced.group == SE(2) else 3, np.eye(3)[:2]
    rows = (free.encode(forced.to_canonical(np.eye(2))) / free.scale).T @ np.asarray(forced.constraint_subspace)
    weight, arms, friction = np.zeros(0), np.zeros((2, 0)), np.zeros((0, 0))
    if forced.gravity is not None:  # levers of the point in the kernel's own axes: rounded ones would do work on loops
        weight, point = forced.gravity.homogeneous(forced.group)
        own = flat if inside == 2 else np.array([flat[1], -flat[0]])
        arms = half * free.scale * (own @ (forced.group.basis @ (kernel_frame(free, forced) @ point)))
        weight, arms = weight[:inside], arms[:, :inside]
    if forced.friction is not None:
        stiff = kernels.quadratic(free.body)[0] / kernels.inertia(free.body)[0]
        friction = half * stiff * (rows @ forced.friction.matrix @ rows.T)
    table = forced.rows(np.arange(1 + (0 if forced.table is None else len(forced.table))))
    return kernels.Pull(*map(plain, (weight, arms, friction, half * free.scale * sum_products(table.T, rows.T))))


def balance(free: AbstractCompiledRoute, forced: Forced, order: int, faults: dict[str, str]) -> kernels.Balanced:
    """Return half the impulses at displacements in the units and axes of a kernel."""
    group, S, half = forced.group, np.asarray(forced.constraint_subspace), float(free.time_step) / 2
    to_kernel = free.encode(forced.to_canonical(np.eye(forced.rank)))
    momenta = forced.from_canonical(free.decode(np.eye(forced.rank)))
    velocity = S.T @ np.linalg.solve(S @ np.asarray(forced.inertia_operator) @ S.T, momenta.T)
    along, variety = half * to_kernel.T @ S, variety_of(forced.system, "skew")
    frame, charts = forced.frame, free.from_kernel(np.eye(free.sizes[1]))
    exact = [each for each in forced.terms if hasattr(each, "matrix_for")]
    springs = [each.numbers_for(group) for each in forced.terms if hasattr(each, "numbers_for")]
    linear = sum((each.matrix_for(group) for each in exact), np.zeros((group.size,) * 2 if exact else (0, 0)))
    C = np.zeros((0, 0)) if forced.friction is None else along @ forced.friction.matrix @ velocity
    rows = forced.rows(np.arange(1 + (0 if forced.table is None else len(forced.table)))) @ along.T
    moves, parts = forced.differences
    force, potential = functions_of(forced, forced.own_potential, faults)
    numbers = kernels.Impulses(
        turn=plain(kernel_frame(free, forced)),
        directions=plain(frame @ group.hat(charts @ variety.chart) @ group.inverse(frame)),
        velocity=plain(velocity),
        along=plain(along),
        levers=plain(np.einsum("kd,dab->kab", along, group.basis)),
        metric=plain(velocity.T @ np.asarray(forced.inertia_operator) @ velocity),
        linear=plain(linear),
        springs=plain(np.reshape(springs, (len(springs), 2 + 2 * group.size))),
        friction=plain(C),
        rows=plain(rows),
        moves=plain(moves),
        weights=plain(parts),
        time_step=float(free.time_step),
        begin=0.0,
        stages=plain(weights(order)),
    )
    has = forced.function is not None, forced.own_potential is not None
    return kernels.Balanced(numbers, has, force, potential)
