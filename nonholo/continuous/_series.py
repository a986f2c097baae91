r"""Continuous motions by Taylor series: their equations are quadratic in velocity and pose.

With a constraint fixed in the body momenta r and poses obey
$$ r' = S\,\mathrm{ad}^*_\omega\mathbb{I}\omega, \qquad g' = g\,\hat\omega, \qquad \omega = S^T w,
   \quad w = (S\mathbb{I}S^T)^{-1} r, $$
and with one fixed in space, where r is constant, tensor in space and pose
$$ \mathbb{J}_g' = X\mathbb{J}_g + \mathbb{J}_g X^T, \qquad g' = X g, \qquad X = \sum_j w_j D_j,
   \quad \sum_j \mathrm{tr}(D_i\mathbb{J}_g D_j^*)\,w_j = r_i . $$

Variations of momenta move as a pose does: the rates $\sum_{ab}T_{ab}w_aw_b$ change with r along
$$ \delta r' = \sum_a w_a\sum_b(T_{ab} + T_{ba})(V\,\delta r)_b, \qquad w = Vr. $$
"""

import functools
import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, cast

import numpy as np

from nonholo.base.checks import error
from nonholo.base.results import Outcome
from nonholo.base.types import Float
from nonholo.groups import SE, AbstractMatrixGroup
from nonholo.kernels import Columns, Quadratic, revisit_series, solve_series, sparse_products
from nonholo.orbit import looked_at, turned_near
from nonholo.systems import AbstractSystem, direction_lengths, displacement_units

PLANE = SE(2)
Covectors = Float[np.ndarray, "K dim"]
"""Body velocities, momenta or forces at the states of an orbit."""


class States(NamedTuple):
    """Compact states of a motion in the canonical frame.

    Attributes:
        momenta: Along the constraint subspace, (K, k).
        poses: (K, size), if they are solved for.
        turned: On SE(2) the heading without ambiguity of full turns, (K,).
    """

    momenta: Float[np.ndarray, "K k"]
    poses: Float[np.ndarray, "K size"] | None
    turned: Float[np.ndarray, "K"] | None

    def chosen(self, at: np.ndarray) -> "States":
        """Return the states at some places."""
        others = (None if rows is None else rows[at] for rows in (self.poses, self.turned))
        return States(self.momenta[at], *others)


class Problem(NamedTuple):
    """An initial value problem, in canonical numbers.

    Attributes:
        momentum: The reduced momentum at the start.
        pose: The compact pose there; None if it is not solved for.
        elapsed: Times since the start, from zero.
        tolerances: Relative and absolute.
    """

    momentum: Float[np.ndarray, "k"]
    pose: Any
    elapsed: Float[np.ndarray, "K"]
    tolerances: tuple[float, float]


class Solved(NamedTuple):
    """A solved motion.

    Attributes:
        states: At the requested times; after a failure only the good ones.
        outcome: How it ended.
        at: Gives the states at times since the start, up to the last good one, in the order of the requested times.
        steps: Gives where steps of the solver begin and, if they are long, times within; none if they do not depend
            on the motion.
        fault: The failure of a user's function that ended it.
    """

    states: States
    outcome: Outcome
    at: Callable[[Float[np.ndarray, "K"]], States]
    steps: Callable[[], Float[np.ndarray, "steps"]] = lambda: np.zeros(0)
    fault: str = ""


def first_heading(group: AbstractMatrixGroup, pose: Float[np.ndarray, "... size"]) -> Float[np.ndarray, "... j"]:
    """Return the angle of a pose in the plane as one number; none of other groups."""
    return np.arctan2(pose[..., 1:2], pose[..., :1]) if group == PLANE else pose[..., :0]


_COMPACT = 40
"""Poses of more numbers are integrated as matrices, whose rates need not be tried."""
_CHUNK = 1 << 12  # states that are decoded at once: what it takes between stays near the processor
GUARD = 1 / 64
"""The error of a step as a share of the tolerance, so that only rounding is left at the default."""


class Rates(NamedTuple):
    r"""Rates $x_m' = \sum_a w_a(c_{am} + \sum_b C_{abm}x_b)$: where C is not zero its (a, b, m) and values, and c."""

    places: np.ndarray
    values: np.ndarray
    lone: np.ndarray


class Series(NamedTuple):
    """A solved motion: its equations, and from where their series can be expanded again.

    Attributes:
        group: Of the poses.
        equations: The quadratic equations.
        head: The number of components behind the pose.
        momentum: r at the start, whose components are the first behind the pose, others belong to forces; constant if
            the constraint is fixed in space.
        compact: Whether poses are integrated as compact ones, not as matrices.
        unit: The unit of time, inverted: a power of two that brings the velocities near to one, so that no coefficient
            over- or underflows without need.
        sizes: Units of the momenta.
        tolerance: Of a step.
        end: The last of the given times.
        nodes: Beginnings of steps.
    """

    group: AbstractMatrixGroup
    equations: Quadratic
    head: int
    momentum: Float[np.ndarray, "k"]
    compact: bool
    unit: float
    sizes: Any
    tolerance: float
    end: float
    nodes: Float[np.ndarray, "steps 2 state"]

    def __call__(self, elapsed: Float[np.ndarray, "K"]) -> States:
        """Return the states at times since the start, which lie in the order in which the motion was solved."""
        planar, limits = int(self.group == PLANE), (self.end * self.unit, self.tolerance)
        widths = len(self.equations.order) - planar - self.head, planar, self.head
        return self.decode(revisit_series(self.equations, self.nodes, widths, elapsed * self.unit, *limits))

    def looks(self) -> Float[np.ndarray, "looks"]:
        """Return times since the start at which events are evaluated."""
        return looked_at([*self.nodes[:, 0, -1], self.end * self.unit], self.unit)

    def decode(self, columns: Columns) -> States:
        """Return momenta, poses and headings, in the memory of the columns where they fit."""
        (poses, angles, head), group = columns, self.group
        headings = angles[:, 0] if angles.shape[1] else None
        if not self.compact:
            poses = group.pose_from_matrix(poses.reshape(-1, *group.identity.shape))
        for begin in range(0, len(poses), _CHUNK):
            part = slice(begin, begin + _CHUNK)
            poses[part] = group.normalize_pose(poses[part])
            if headings is not None:
                headings[part] = turned_near(headings[part], poses[part])
        k = len(self.momentum)
        if len(self.equations.forms):
            return States(np.broadcast_to(self.momentum, (len(poses), k)).copy(), poses, headings)
        head *= self.unit
        return States(np.ascontiguousarray(head[:, :k] * self.sizes), poses, headings)


def by_series(system: AbstractSystem, problem: Problem) -> Solved:
    """Solve the equations of a system."""
    reduced_momentum, f, sizes = problem.momentum, quadratic(system), 1.0
    if system.is_spatial:
        unit = power_of_two(system.restricted_velocity(reduced_momentum, system.group.matrix_from_pose(problem.pose)))
        f, head = f._replace(momentum=reduced_momentum / unit), np.zeros(f.tensor.size)
    else:
        sizes = _own_numbers(system)[2]
        unit = power_of_two(sizes * f.velocities.dot(reduced_momentum / sizes))
        head = reduced_momentum / sizes / unit
    return solve(system.group, f, head, unit, problem, sizes=sizes)


def has_compact_rates(group: AbstractMatrixGroup) -> bool:
    """Return whether poses are integrated as compact ones where the constraint is fixed in the body."""
    return group.pose_size <= _COMPACT


def power_of_two(velocities: Float[np.ndarray, "... j"]) -> Any:
    """Return the next power of two above the largest velocity, of rows that of each."""
    return np.ldexp(1.0, np.frexp(np.maximum.reduce(np.abs(velocities), -1, initial=0.0))[1])


def solve(
    group: AbstractMatrixGroup,
    f: Quadratic,
    head: np.ndarray,
    unit: float,
    problem: Problem,
    most: float = math.inf,
    sizes: Any = 1.0,
) -> Solved:
    """Solve equations from a head and a pose, in up to as many steps; see `Series` for the others."""
    momentum, pose, elapsed, tolerances = problem
    compact, tolerance = has_compact_rates(group) and not len(f.forms), tolerances[0] * GUARD
    g = pose if compact else group.matrix_from_pose(pose).ravel()
    columns, nodes = solve_series(f, (g, first_heading(group, pose), head), elapsed * unit, tolerance, most)
    series = Series(group, f, len(head), momentum, compact, unit, sizes, tolerance, float(elapsed[-1]), nodes)
    outcome = Outcome.successful if len(columns[0]) == len(elapsed) else Outcome.not_converged
    return Solved(series.decode(columns), outcome, series, series.looks)


@functools.lru_cache(maxsize=16)
def quadratic(system: AbstractSystem) -> Quadratic:
    """Return the equations of a system; of one with a constraint in space without its momenta."""
    group, S = system.group, system.constraint_subspace
    if system.is_spatial:
        return _space_equations(group, S, cast(np.ndarray, system.homogeneous_mass_tensor))
    return body_equations(group, S, *_own_numbers(system)[:2])


@functools.lru_cache(maxsize=16)
def _own_numbers(system: AbstractSystem) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return body_numbers(system.group, system.constraint_subspace, system.inertia_operator)


def body_numbers(
    group: AbstractMatrixGroup, S: np.ndarray, inertia: Float[np.ndarray, "... dim dim"]
) -> tuple[Float[np.ndarray, "... k k"], Float[np.ndarray, "... k k k"], Float[np.ndarray, "... k"]]:
    """Return V, the coefficients of products w_a w_b, a <= b, in the rates of momenta, and the units of momenta.

    Units are the lengths of the rows, as powers of two; V and rates are in them.
    """
    momenta = S @ inertia.swapaxes(-1, -2)
    torques = np.zeros((*inertia.shape[:-2], len(S), len(S), len(S)))
    for a, row in enumerate(S):
        torques[..., a, :, :] = group.coad(np.broadcast_to(row, momenta.shape), momenta) @ S.T
    upper = (np.tri(len(S)).T - np.eye(len(S)) / 2)[..., None]
    sizes = np.exp2(np.round(np.log2(direction_lengths(S, displacement_units(group, inertia)))))
    torques = (torques + torques.swapaxes(-3, -2)) * upper / sizes[..., None, None, :]
    return np.linalg.inv(S @ inertia @ S.T) * sizes[..., None, :], torques, sizes


def body_equations(
    group: AbstractMatrixGroup, S: np.ndarray, velocities: np.ndarray, torques: np.ndarray, parts: Sequence[int] = ()
) -> Quadratic:
    """Return equations of momenta with rates torques[a, b] w_a w_b, w = V r, and of a pose that moves along rows S."""
    rates = _compact_rates(group, S) if has_compact_rates(group) else _matrix_rates(group.hat(S), False)
    if group == PLANE:
        rates = rates._replace(lone=np.concatenate([rates.lone, S[:, :1]], axis=1))
    return assemble(velocities, rates, torques, parts)


def _space_equations(group: AbstractMatrixGroup, S: np.ndarray, tensor: np.ndarray) -> Quadratic:
    """Return the equations of the tensor in space and of a pose that moves along rows S in space."""
    hats, N = group.hat(S), len(tensor)
    (a, b, m), values, _ = _matrix_rates(hats, True)
    # X J moves columns as X g does; J X^T is its transpose
    J = N * N + (group == PLANE)
    sources = np.concatenate([b, b + J, b % N * N + b // N + J])
    targets = np.concatenate([m, m + J, m % N * N + m // N + J])
    lone = np.zeros((len(S), J + N * N))
    lone[:, N * N : J] = S[:, :1]
    rates = Rates(np.stack([np.tile(a, 3), sources, targets]), np.tile(values, 3), lone)
    forms = np.einsum("apq,brp->abqr", hats, group.form_adjoint(hats)).reshape(len(S), len(S), N * N)
    equations = assemble(np.eye(len(S)), rates, np.zeros((0, 0, 0)))
    return equations._replace(forms=forms, tensor=np.ascontiguousarray(tensor))


def assemble(velocities: np.ndarray, rates: Rates, torques: np.ndarray, parts: Sequence[int] = ()) -> Quadratic:
    """Return equations of what moves by `rates` and of momenta behind it, with rates torques[a, b] w_a w_b.

    `parts` has the numbers of momenta that V mixes, and whose errors are measured together: by default that of all.
    """
    k, before, head, ((a, b, m), values, lone) = len(velocities), rates.lone.shape[1], len(torques), rates
    (c, i), (d, o, n) = np.nonzero(lone), np.nonzero(torques)
    places = np.arange(before) if not head else _side_by_side(k, before, a, b)
    b, m, i = (np.argsort(places)[x] for x in (b, m, i))
    # places in z: the velocities, the state
    products, index = sparse_products(np.concatenate([a, d]), np.concatenate([b + k, o]), 8)
    index = np.concatenate([c + 8 * products.shape[1], index])
    targets, factors = np.concatenate([i, m, n + before]), np.concatenate([lone[c, i], values, torques[d, o, n]])
    rows = np.argsort(targets, kind="stable")
    first = np.searchsorted(targets[rows], np.arange(before + head + 1))
    momenta, ends = np.arange(before, before + head), np.cumsum(parts, dtype=np.int64)[:-1]  # each part in one block
    part, cycles = np.searchsorted(ends, np.arange(head), "right"), [np.roll(x, 1) for x in np.split(momenta, ends)]
    o, n = (x[part[o] != part[n]] + before for x in (o, n))
    edges = np.stack([np.concatenate([momenta, b, o]), np.concatenate([*cycles, m, n])])
    counts = (products, first, index[rows], np.append(places, momenta))
    products, first, index, order = (x.astype(np.int64, copy=False) for x in counts)  # in a browser they have 32 bits
    sparse = products, first, index, factors[None, rows], order
    nothing = np.zeros(0), np.zeros((0, 0)), np.zeros(0)
    return Quadratic(velocities, *sparse, *_blocks(before + head, edges, i), *nothing)


def _side_by_side(k: int, size: int, velocities: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Return an order of the components in which those stand together that the same velocities multiply."""
    is_multiplied = np.zeros((k, size), dtype=np.bool_)
    is_multiplied[velocities, places] = True
    return np.lexsort(~is_multiplied[::-1])


def _compact_rates(group: AbstractMatrixGroup, S: np.ndarray) -> Rates:
    """Return the rates of a compact pose, which is bilinear in velocity and (1, pose)."""
    units = np.eye(group.pose_size)
    lone, rates = np.zeros((len(S), len(units))), np.zeros((len(S), len(units), len(units)))
    for a, row in enumerate(S):
        lone[a] = group.pose_rate(np.zeros(len(units)), row)
        rates[a] = group.pose_rate(units, np.broadcast_to(row, (len(units), group.dim))) - lone[a]
    places = np.nonzero(rates)
    return Rates(np.stack(places), rates[places], lone)


def _matrix_rates(hats: Float[np.ndarray, "k N N"], spatial: bool) -> Rates:
    """Return the rates of a matrix: of g' = g X, or in space of g' = X g."""
    (k, N, _), (a, i, j) = hats.shape, np.nonzero(hats)
    other, where = np.arange(N)[:, None], np.broadcast_to(a, (N, len(a)))
    places = (where, N * j + other, N * i + other) if spatial else (where, N * other + i, N * other + j)
    return Rates(np.stack(places).reshape(3, -1), np.tile(hats[a, i, j], N), np.zeros((k, N * N)))


def _blocks(size: int, edges: np.ndarray, lone: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the block of each component, where those are that move each other, and which blocks nothing else moves."""
    places, labels = np.arange(size), np.full(size, -1)
    while (is_left := labels < 0).any():
        sources, targets = edges[:, is_left[edges].all(axis=0)]
        first = _least_along(places, sources, targets)
        same = first[sources] == first[targets]
        is_block = is_left & (_least_along(first != places, targets[same], sources[same]) == 0)
        labels[is_block] = first[is_block]
    roots, labels = np.unique(labels, return_inverse=True)
    is_closed, (sources, targets) = np.ones(len(roots), dtype=np.bool_), labels[edges]
    is_closed[targets[sources != targets]] = False
    is_closed[labels[lone]] = False
    return labels, is_closed


def _least_along(values: np.ndarray, sources: np.ndarray, targets: np.ndarray) -> np.ndarray:
    """Return the least value at each component and at those from which edges lead to it."""
    before = np.zeros(0)
    while not np.array_equal(values, before):
        before, values = values, values.copy()
        np.minimum.at(values, targets, before[sources])
    return values


_TOLERANCE = 1e-12


def flow_tangents(
    where: str, system: AbstractSystem, momenta: Float[np.ndarray, "K k"], time: Float[np.ndarray, "K"]
) -> Float[np.ndarray, "L k k"]:
    """Return the derivative of each momentum by the one before, for restricted momenta of a flow."""
    k, (V, torques, sizes) = system.rank, _own_numbers(system)
    slopes = np.einsum("abn,bc->acn", torques + torques.swapaxes(0, 1), V)
    a, c, n = np.nonzero(slopes)
    column = np.arange(k)[:, None]
    places = np.stack([np.broadcast_to(a, (k, len(a))), k * c + column, k * n + column]).reshape(3, -1)
    f = assemble(V, Rates(places, np.tile(slopes[a, c, n], k), np.zeros((k, k * k))), torques)
    out = np.empty((len(time) - 1, k, k))
    for j, (r, step) in enumerate(zip(momenta / sizes, np.diff(time), strict=False)):
        unit = power_of_two(sizes * (V @ r))
        parts = np.eye(k).ravel(), np.zeros(0), r / unit
        (tangents, *_), _ = solve_series(f, parts, np.array([0.0, step * unit]), _TOLERANCE * GUARD)
        if len(tangents) < 2:
            got = f"a failure at state {j}"
            raise error(where, "have steps that the series can integrate", got, "Pass closer times.")
        out[j] = tangents[1].reshape(k, k) * (sizes[:, None] / sizes)
    return out
