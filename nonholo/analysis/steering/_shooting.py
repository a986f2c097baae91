r"""Forces of least effort that meet goals, of many members at once, by shooting from random controls.

With $c(f) = 0$ and $l \le f \le u$ the least of $\tfrac12|f|^2$ obeys $f = \mathrm{clip}(J^T\lambda, l, u)$,
$J = \partial c/\partial f$. A step of Newton's method goes to the bounds that this names and meets the linearized goal
with what is left; conjugate gradients then move along the goal, with second derivatives from differences of J.
"""

import dataclasses
import functools
from collections.abc import Callable
from typing import Any

import equinox
import jax
import jax.numpy as jnp
import numpy as np

from nonholo.analysis.steering._arguments import BLOCK, Ends, Limits, state_units
from nonholo.base.progress import go_on
from nonholo.base.types import Array, Float
from nonholo.discrete import Discretization
from nonholo.discrete.definition import Rollout, compile_double, in_double
from nonholo.simulation.traced import rollout
from nonholo.systems import direction_lengths


@equinox.filter_jit
def _gaps(discrete: Discretization, forces: Array, ends: Ends) -> tuple[Array, Array]:
    """Return what goals are missed by, (m, c), and its derivatives by the forces along the constraint."""
    system = discrete.system
    covectors = np.linalg.pinv(system.constraint_subspace).T

    def gap_of(forces: Array, ends: Ends) -> tuple[Array, Array]:
        orbit = _orbit(discrete, forces @ covectors, ends[:2], len(forces))
        gap = goal_gap(system, ends, orbit.configuration[-1], orbit.restricted_momentum[-1])
        return gap, gap

    slopes, values = jax.vmap(jax.jacrev(gap_of, has_aux=True))(forces, ends)
    return values, slopes


def goal_gap(system: Any, ends: Any, g: Array, momentum: Array) -> Float[Array, "c"]:
    """Return by what a last pose and momentum miss those of a goal, which may be free."""
    (_, _, to_pose, to_velocity), parts = ends, [momentum[:0]]
    if to_pose is not None:
        parts.append(system.group.log(system.group.inverse(to_pose) @ g))
    if to_velocity is not None:
        parts.append(system.restricted_velocity(momentum) - to_velocity)
    return g.__array_namespace__().concatenate(parts)


def goal_units(discrete: Discretization, steps: int, ends: Ends) -> Float[np.ndarray, "c"]:
    """Return units of what a goal is missed by."""
    units = state_units(discrete.system, steps * float(discrete.time_step))
    return np.concatenate([np.zeros(0), *(x for x, end in zip(units, ends[2:], strict=True) if end is not None)])


@compile_double
def driven_side_by_side(discrete: Discretization, controls: Array, start: tuple[Array, Array]) -> Rollout:
    """Return the orbits under body covectors from velocities and poses of members."""
    return jax.vmap(lambda controls, start: _orbit(discrete, controls, start, 1))(controls, start)


def _orbit(discrete: Discretization, controls: Array, start: tuple[Array, Array], every: int) -> Rollout:
    at = dict(zip(("restricted_velocity", "configuration"), start, strict=True))
    return rollout(discrete, **at, controls=controls, steps=len(controls), save_every=every)


State = tuple[Array, Array]
"""A velocity along the constraint and a pose, or those of many nodes."""


@compile_double
def linearize_steps(
    discrete: Discretization, nodes: State, controls: Float[Array, "steps dim"]
) -> tuple[Float[Array, "steps n n"], Float[Array, "steps n k"]]:
    """Return the derivatives of the error after each step by the error before it and by the forces of the step."""
    system, group = discrete.system, discrete.system.group
    dim, covectors = group.dim, jnp.asarray(np.linalg.pinv(system.constraint_subspace).T)

    def after(error: Array, force: Array, before: State, reference: State, covector: Array) -> Array:
        start = before[0] + error[dim:], before[1] @ group.exp(error[:dim])
        pair = _orbit(discrete, (covector + force @ covectors)[None], start, 1)
        turn = group.log(group.inverse(reference[1]) @ pair.configuration[1])
        return jnp.append(turn, system.restricted_velocity(pair.restricted_momentum[1]) - reference[0])

    def at(before: State, reference: State, covector: Array) -> tuple[Array, Array]:
        nothing = jnp.zeros(dim + system.rank, covector.dtype), jnp.zeros(system.rank, covector.dtype)
        return jax.jacfwd(after, (0, 1))(*nothing, before, reference, covector)

    before, following = (jax.tree.map(lambda x, part=part: x[part], nodes) for part in (slice(-1), slice(1, None)))
    return jax.vmap(at)(before, following, controls)


_ROUNDS = 40  # of Newton's method
_PRODUCTS = 12  # with second derivatives, in each of them
_HALVINGS = 8  # of a step
_FORCING = 0.1  # part of the gradient that conjugate gradients leave
_OFFSET = 1e-6  # of the length of forces, for differences
_SETS = 20  # of forces at bounds that are tried
_BENT = 1e-3  # curvature below which a direction is not trusted
_REACH = 3.0  # the longest step, in lengths of forces
_MET, _LEVEL = 1e-10, 1e-6  # gap and gradient, in lengths of forces, of a minimum
_LEAST = 1e-300  # a length that may divide

Point = tuple[np.ndarray, ...]
"""Forces of members, what they miss, and its slope."""
Gaps = Callable[[Float[np.ndarray, "m n"], np.ndarray], tuple[Float[np.ndarray, "m c"], Float[np.ndarray, "m c n"]]]
"""From forces of members, and which members these are, to c and J; NaN where there is none."""


def _among(gaps: Gaps, members: np.ndarray) -> Gaps:
    """Return the gaps of some members, who go by their numbers among these."""
    return lambda f, at: gaps(f, members[at])


def least_effort(
    gaps: Gaps, f: Float[np.ndarray, "M n"], limits: Limits
) -> tuple[Float[np.ndarray, "M n"], Float[np.ndarray, "M c"], Float[np.ndarray, "M"]]:
    """Return forces near given ones, what they miss, infinite where none, and their excess over the least effort."""
    f = np.clip(f, *limits)
    c, J = gaps(f, np.arange(len(f)))
    going, rest, penalty = np.flatnonzero(np.isfinite(c).all(axis=1)), np.full(len(f), np.inf), np.zeros(len(f))
    first = np.linalg.norm(f, axis=1)
    for _ in range(_ROUNDS):
        length = np.maximum(np.linalg.norm(f[going], axis=1), first[going] + _LEAST)
        plane, jump, weights = _plane((f[going], c[going], J[going]), limits)
        rest[going] = np.linalg.norm(plane.along(f[going]) + jump, axis=1) / length
        on = (np.abs(c[going]).max(axis=1) > _MET) | (rest[going] > _LEVEL)
        going, plane, jump, weights, length = going[on], plane[on], jump[on], weights[on], length[on]
        if not len(going):
            break
        step = jump - plane.across(c[going] + _times(J[going], jump))
        own = _among(gaps, going)
        step += _along(own, (f[going], J[going], weights), plane, length)
        step *= np.minimum(1, _REACH * length / (np.linalg.norm(step, axis=1) + _LEAST))[:, None]
        penalty[going] = np.maximum(penalty[going], 2 * np.abs(weights).max(axis=1))
        point = f[going], c[going], J[going]
        (f[going], c[going], J[going]), fell = _shorten(own, point, step, penalty[going], limits)
        going = going[fell]
    return f, np.where(np.isfinite(c), c, np.inf), rest


def _plane(point: Point, limits: Limits) -> tuple["_Plane", np.ndarray, np.ndarray]:
    """Return the directions that bounds leave free, the ways to these bounds, and the multipliers that name them."""
    f, c, J = point
    bound = np.where(limits[0] == limits[1], limits[0], np.full_like(f, np.nan))
    for _ in range(_SETS):
        plane, jump = _Plane.of(J, np.isnan(bound)), np.nan_to_num(bound - f)
        weights = _times(plane.inverse, _times(plane.slopes, f) - _times(J, jump) - c)
        pull = (J * weights[:, :, None]).sum(axis=1)
        following = np.where(pull >= limits[1], limits[1], np.where(pull <= limits[0], limits[0], np.nan))
        if np.array_equal(bound, following, equal_nan=True):
            break
        bound = following
    return plane, jump, weights


@dataclasses.dataclass(frozen=True)
class _Plane:
    """The directions in which free forces of members keep their linearized goals, and those across.

    Attributes:
        free: Which forces are free.
        slopes: J of these, zero elsewhere.
        inverse: Of slopes times their transpose.
    """

    free: Float[np.ndarray, "m n"]
    slopes: Float[np.ndarray, "m c n"]
    inverse: Float[np.ndarray, "m c c"]

    @classmethod
    def of(cls, J: np.ndarray, free: np.ndarray) -> "_Plane":
        slopes = np.where(free[:, None], np.nan_to_num(J), 0.0)
        lengths = np.linalg.norm(slopes, axis=2, keepdims=True)
        lengths = np.where(lengths > 0, lengths, 1.0)  # they differ as torques and forces do
        rows = slopes / lengths
        inverse = np.linalg.pinv(rows @ rows.swapaxes(1, 2), rcond=1e-14, hermitian=True)
        return cls(free, slopes, inverse / lengths / lengths.swapaxes(1, 2))

    def __getitem__(self, at: np.ndarray) -> "_Plane":
        return _Plane(self.free[at], self.slopes[at], self.inverse[at])

    def across(self, c: np.ndarray) -> np.ndarray:
        """Return the least forces that change the goal by c."""
        return _times(self.slopes.swapaxes(1, 2), _times(self.inverse, c))

    def along(self, v: np.ndarray) -> np.ndarray:
        """Return the part of free forces that does not change the goal."""
        return np.where(self.free, v, 0.0) - self.across(_times(self.slopes, v))


def _times(A: np.ndarray, x: np.ndarray) -> np.ndarray:
    return (A @ x[..., None])[..., 0]


def _along(gaps: Gaps, point: Point, plane: _Plane, length: np.ndarray) -> Float[np.ndarray, "m n"]:
    """Return steps along the linearized goal to less effort, by conjugate gradients; down the gradient where bent."""
    f, J, weights = point
    at, r = np.arange(len(f)), -plane.along(f)
    total, p, aim = np.zeros_like(f), r.copy(), np.maximum(_FORCING * np.linalg.norm(r, axis=1), 1e-14 * length)
    for count in range(_PRODUCTS):
        at = at[np.linalg.norm(r[at], axis=1) > aim[at]]
        if not len(at):
            break
        size = (_OFFSET * length[at] / np.linalg.norm(p[at], axis=1))[:, None]
        change = (gaps(f[at] + size * p[at], at)[1] - J[at]) * weights[at, :, None]
        Hp = plane[at].along(p[at] - np.nan_to_num(change.sum(axis=1)) / size)
        good = np.vecdot(p[at], Hp) > _BENT * np.vecdot(p[at], p[at])
        total[at[~good]] += (count == 0) * p[at[~good]]
        at, Hp, square = at[good], Hp[good], np.vecdot(r[at], r[at])[good, None]
        size = square / np.vecdot(p[at], Hp)[:, None]
        total[at] += size * p[at]
        r[at] -= size * Hp
        p[at] = r[at] + np.vecdot(r[at], r[at])[:, None] / square * p[at]
    return total


def _shorten(
    gaps: Gaps, point: Point, step: np.ndarray, penalty: np.ndarray, limits: Limits
) -> tuple[Point, np.ndarray]:
    """Return forces, c and J after steps that are halved until effort and gap fall together, and where they do."""
    now, fell = tuple(x.copy() for x in point), np.zeros(len(step), dtype=bool)

    def merit(at: np.ndarray, f: np.ndarray, c: np.ndarray) -> np.ndarray:
        return np.vecdot(f, f) / 2 + penalty[at] * np.abs(c).sum(axis=1)

    for count in range(_HALVINGS + 1):
        at = np.flatnonzero(~fell)
        if not len(at):
            break
        f = np.clip(point[0][at] + 0.5**count * step[at], *limits)
        there = (f, *gaps(f, at))
        fell[at] = good = merit(at, f, there[1]) <= merit(at, point[0][at], point[1][at]) * (1 + 1e-12)
        for whole, part in zip(now, there, strict=True):
            whole[at[good]] = part[good]
    return now, fell


SPREAD = (1.0, 2.0, 0.5, 4.0, 1.0, 2.0, 0.5, 4.0)  # of the random controls from which a goal is looked for, in turn
TOLERANCE = 1e-8  # of the goal
_GRADIENT = 1e-4  # of the gradient at a minimum


def shot(discrete: Discretization, ends: Ends, limits: Limits) -> tuple[np.ndarray, ...]:
    """Return the forces of members, (members, steps, k), what they miss, and outcomes.

    Where torques cost much more than forces, or much less, the least effort may not be near: what meets the goal then
    is least in the units of the body.
    """
    system, block = discrete.system, min(BLOCK, len(ends[0]))
    steps = len(limits[0]) // system.rank
    lengths = direction_lengths(system.constraint_subspace, system.displacement_units)
    units = goal_units(discrete, steps, ends)

    def gaps(unit: Any, f: np.ndarray, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        go_on()
        forces = (f * unit).reshape(len(f), steps, -1)
        blocks = np.arange(-(-len(f) // block) * block).reshape(-1, block) % len(f)  # of one size: compiled once
        parts = [in_double(_gaps, discrete, forces[i], jax.tree.map(lambda x, i=i: x[at[i]], ends)) for i in blocks]
        c, J = (np.concatenate(part)[: len(f)] for part in zip(*parts, strict=True))
        return c / units, J.reshape(*c.shape, -1) * unit / units[:, None]

    size, unit = sizes(discrete, steps, ends), np.tile(np.exp2(np.round(np.log2(lengths))), steps)
    forces, misses, is_least = best(functools.partial(gaps, 1.0), size, limits)
    failures = np.flatnonzero(_largest(misses) >= TOLERANCE)
    if len(failures) and (unit != unit[0]).any():
        own = _among(functools.partial(gaps, unit), failures)
        others, left, _ = best(own, size[failures] / unit, (limits[0] / unit, limits[1] / unit))
        is_nearer = _largest(left) < _largest(misses[failures])
        forces[failures[is_nearer]], misses[failures[is_nearer]] = others[is_nearer] * unit, left[is_nearer]
    words = np.where(is_least, "converged", np.where(_largest(misses) < TOLERANCE, "not least", "not found"))
    return forces.reshape(len(forces), steps, -1), _largest(misses), words


def _largest(misses: Float[np.ndarray, "m c"]) -> Float[np.ndarray, "m"]:
    return np.abs(misses).max(axis=1)


def sizes(discrete: Discretization, steps: int, ends: Ends) -> np.ndarray:
    """Return how large forces are that turn bodies by about one radian, or move them by their length or half the way.

    Ends may be those of one member, or of many.
    """
    system, (_, g, to_pose, _) = discrete.system, ends
    units = np.broadcast_to(system.displacement_units, (*g.shape[:-2], system.group.dim)).copy()
    if system.group.is_affine and to_pose is not None:
        n = system.group.point_size
        way = np.linalg.norm(to_pose[..., :n, n] - g[..., :n, n], axis=-1, keepdims=True) / 2
        units[..., -n:] = np.maximum(units[..., -n:], way)
    along = system.constrained_inertia.diagonal() / direction_lengths(system.constraint_subspace, units)
    return np.tile(np.sqrt(steps) * along / (steps * float(discrete.time_step)) ** 2, steps)


def best(gaps: Gaps, size: Float[np.ndarray, "m n"], limits: Limits) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the forces of least effort, or those that come nearest, what they miss, and whether they are least.

    Each member has a separate random stream, so that no other one changes where it begins.
    """
    streams = [np.random.default_rng(member) for member in range(len(size))]
    nothing = np.clip(np.zeros_like(size), *limits)
    misses = gaps(nothing, np.arange(len(size)))[0]
    is_least = (_largest(misses) < _MET) & ~nothing.any(axis=1)  # no effort at all
    ends = nothing, np.where(is_least[:, None], misses, np.inf), is_least
    for spread in SPREAD:
        left = np.flatnonzero(~ends[2])
        if not len(left):
            break
        first = spread * size[left] * np.array([streams[member].normal(size=size.shape[1]) for member in left])
        near, misses, rest = least_effort(_among(gaps, left), first, limits)
        least = ((gap := _largest(misses)) < TOLERANCE) & (rest < _GRADIENT)
        better = least | (gap < _largest(ends[1][left]))
        for whole, part in zip(ends, (near, misses, least), strict=True):
            whole[left[better]] = part[better]
    return ends
