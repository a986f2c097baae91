r"""Half impulses that keep T + U: those of a force at the displacement itself, equal at both ends of a step.

With momenta m of a node in the units of a kernel, and the free root W over s,

$$ s = m + J(g, W), \qquad m' = m + 2J + \Delta(W), \qquad J = \tfrac h2\,N\,f, $$
$$ f = -G(g, W) + f_k + f(t, \bar g, X/h) - C X/h, $$

where $\Delta$ is the change of the free step, X = (W - W^-1)/2 and $\bar g = g W^{1/2}$; G is exact for potentials
that are linear in the entries of the pose and for springs, and the corrected midpoint slope for any other
(docs/theory/forces.md). Momenta of the middle are $\bar m = s + \Delta/2$, and X/h is their velocity. A part $\tau$ of
a step is the step of length $\tau h$.
"""

import math
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from nonholo.base.compiled import njit
from nonholo.kernels._composition import find_root, prepare, push_and_move, write_chart
from nonholo.kernels._driver import floor_of, kahan_sum
from nonholo.kernels._scalar import BORROWING, COMPILED, Rows, borrowing, function_at, scalar
from nonholo.kernels._small import assign, eliminate, multiply
from nonholo.kernels.forced._driven import largest

_CORRECTIONS = 30  # of momenta between two half impulses
_EXACT = 4e-16  # relative
_SETTLED = 1e-11  # relative, below which corrections that do not fall any more are rounding
_UNSEEN = 2e-15  # relative, of differences of U
_ROUNDED = 4e-16  # relative, of the terms of a pull, which are large where a group is not compact
_FALL = 0.5  # most that a correction leaves of what is missed, by which the root is certain
_PIECES = 1000  # most of a path
_FOLDED = 100.0  # of the inverse slope
_DIFFERENCE = 1e-7  # relative, of momenta
_SMALLEST = 1e-6  # part of a step by which its path is followed

When: TypeAlias = tuple[float, float, int]
"""A part of a step, its time in the middle, and the row of a table."""


class Impulses(NamedTuple):
    """Half impulses at the displacement, but for functions of users.

    Attributes:
        turn: T, the pose of the user is that of the kernel times T, (N, N).
        directions: What each chart coordinate adds to the Cayley matrix Y of the user, (m, N, N).
        velocity: V, (dim, k).
        along: h/2 N, (k, dim).
        levers: What the rows of it make of the basis of the algebra, (k, N, N).
        metric: The kinetic energy of momenta, twice, (k, k).
        linear: A of potentials tr(A^T g), (N, N); (0, 0) without any.
        springs: Stiffness, length, body point and space point, (S, 2 + 2 N).
        friction: K of half impulses -K m, (k, k); (0, 0) without any.
        rows: Half impulses of a table, (steps + 1, k), the last one zero.
        moves: Displacements to and fro for differences of U, (dim, orders, 2, N, N).
        weights: Weights of the differences, (orders,).
        time_step: h.
        begin: The time at which step 0 begins.
        stages: Parts of the step, taken one after the other, (S,).
    """

    turn: np.ndarray
    directions: np.ndarray
    velocity: np.ndarray
    along: np.ndarray
    levers: np.ndarray
    metric: np.ndarray
    linear: np.ndarray
    springs: np.ndarray
    friction: np.ndarray
    rows: np.ndarray
    moves: np.ndarray
    weights: np.ndarray
    time_step: float
    begin: float
    stages: np.ndarray


class Balanced(NamedTuple):
    """Half impulses at the displacement.

    Attributes:
        c: What is numbers.
        has: Whether there is a force, and whether there is a potential, that are functions.
        force: Writes f to its last argument, of (time, pose, body velocity, f).
        potential: Writes U to the first number of its last argument, of the same arguments.
    """

    is_python = property(lambda self: callable(self.force))
    stages = property(lambda self: self.c.stages)
    c: Impulses
    has: tuple[bool, bool]
    force: Any
    potential: Any


class Scratch(NamedTuple):
    """The arrays that half impulses write to.

    Attributes:
        poses: The user's pose before and after, in the middle, and others, (8, N, N).
        covectors: A body velocity, what a function writes, and dU, (3, dim).
        momenta: In the middle, half impulses, what is missed, before, the change, others, (8, k).
        noise: Rounding of half impulses, (1,).
        slopes: The inverse slope of what is missed, (k, k).
        slope: The slope, to be destroyed, (k, k).
        chart: Chart coordinates, (m,).
        pose: The kernel's pose after the displacement.
    """

    poses: np.ndarray
    covectors: np.ndarray
    momenta: np.ndarray
    noise: np.ndarray
    slopes: np.ndarray
    slope: np.ndarray
    chart: np.ndarray
    pose: np.ndarray


@scalar
def room_of(c: Impulses, size: int) -> Scratch:
    """Return room for the half impulses of one run."""
    (k, dim), n = c.along.shape, len(c.turn)
    poses, covectors, momenta = np.zeros((8, n, n)), np.zeros((3, dim)), np.zeros((8, k))
    chart, pose = np.zeros(len(c.directions)), np.zeros(size)
    return Scratch(poses, covectors, momenta, np.zeros(1), np.zeros((k, k)), np.zeros((k, k)), chart, pose)


@njit(**BORROWING)
def see_pose(c: Impulses, room: Scratch, pose: np.ndarray, out: np.ndarray) -> None:
    """Write the user's pose from that of the kernel."""
    assign(room.poses[7].reshape(-1), pose)
    multiply(room.poses[7], c.turn, out)


@njit(**BORROWING)
def lean(c: Impulses, room: Scratch) -> None:
    """Write g (I + Y) from the chart and the pose before."""
    Y, n = room.poses[3], len(c.turn)
    for i in range(n):
        for j in range(n):
            Y[i, j] = 1.0 if i == j else 0.0
            for a in range(len(c.directions)):
                Y[i, j] += room.chart[a] * c.directions[a, i, j]
    multiply(room.poses[0], Y, room.poses[4])


@njit(**BORROWING)
def pull(c: Impulses, room: Scratch, out: np.ndarray) -> None:
    """Add half impulses of potentials that are linear and of springs, which are linear in the leaning pose."""
    A, leaning, product, n = room.poses[3], room.poses[4], room.poses[5], len(c.turn)
    lean(c, room)
    for i in range(n):
        for j in range(n):
            A[i, j] = c.linear[j, i] if len(c.linear) else 0.0
    for s in range(len(c.springs)):
        stretch(c.springs[s], room, A)
    multiply(A, leaning, product)
    for r in range(len(out)):
        for i in range(n):
            for j in range(n):
                term = product[i, j] * c.levers[r, j, i]
                out[r] -= term
                room.noise[0] += _ROUNDED * abs(term)


@njit(**BORROWING)
def stretch(spring: np.ndarray, room: Scratch, A: np.ndarray) -> None:
    """Add x v^T of a spring: U = k/2 (d - L)^2 changes by v . (g' x - g x), v along the mean of both ends."""
    n = len(A)
    before, after, mean = 0.0, 0.0, room.poses[6, 0]
    for i in range(n):
        start = end = 0.0
        for j in range(n):
            start += room.poses[0, i, j] * spring[2 + j]
            end += room.poses[1, i, j] * spring[2 + j]
        start, end = start - spring[2 + n + i], end - spring[2 + n + i]
        before, after, mean[i] = before + start * start, after + end * end, (start + end) / 2
    sizes = math.sqrt(before) + math.sqrt(after)
    stiff = spring[0] * (1.0 - (2 * spring[1] / sizes if spring[1] != 0.0 else 0.0))
    for i in range(n):
        for j in range(n):
            A[i, j] += stiff * mean[j] * spring[2 + i]


@njit(**BORROWING)
def halve(room: Scratch, n: int) -> None:
    """Write the pose in the middle, g W^(1/2), by the iteration of Denman and Beavers."""
    g, after, middle, root = room.poses[0], room.poses[1], room.poses[2], room.poses[3]
    other, later, scratch = room.poses[5], room.poses[6], room.poses[7]
    assign(scratch.reshape(-1), g.reshape(-1))
    assign(root.reshape(-1), after.reshape(-1))
    eliminate(scratch, root)
    other[:] = 0.0
    for i in range(n):
        other[i, i] = 1.0
    for _ in range(50):
        change = 0.0
        inverse_mean(root, other, later, middle, scratch)
        for i in range(n):
            for j in range(n):
                change = max(change, abs(middle[i, j] - root[i, j]))
        assign(root.reshape(-1), middle.reshape(-1))
        assign(other.reshape(-1), later.reshape(-1))
        if not change > 1e-15:
            break
    multiply(g, root, middle)


@njit(**BORROWING)
def inverse_mean(P: np.ndarray, Q: np.ndarray, out: np.ndarray, other: np.ndarray, scratch: np.ndarray) -> None:
    """Write (Q + P^-1)/2 to `out` and (P + Q^-1)/2 to `other`."""
    for A, B, into in ((P, Q, out), (Q, P, other)):
        assign(scratch.reshape(-1), A.reshape(-1))
        into[:] = 0.0
        for i in range(len(A)):
            into[i, i] = 1.0
        eliminate(scratch, into)
        for i in range(len(A)):
            for j in range(len(A)):
                into[i, j] = (B[i, j] + into[i, j]) / 2


@borrowing
def value_at(f: Balanced, room: Scratch, g: np.ndarray) -> float:
    """Return U of a function at a pose."""
    function_at(f.potential, 0.0, g, room.covectors[0], room.covectors[1])
    return room.covectors[1, 0]


@borrowing
def differentiate(f: Balanced, room: Scratch) -> None:
    """Write dU of a function in the middle, by differences."""
    dU, bent = room.covectors[2], room.poses[3]
    for i in range(len(dU)):
        dU[i] = 0.0
        for j in range(len(f.c.weights)):
            for k in range(2):
                multiply(room.poses[2], f.c.moves[i, j, k], bent)
                dU[i] += (1 - 2 * k) * f.c.weights[j] * value_at(f, room, bent)


@borrowing
def add_potential(f: Balanced, room: Scratch, part: float, out: np.ndarray) -> None:
    """Add half impulses of a potential that is a function, h/2 times -dU - (U' - U - <dU, X>)/<BX, X> BX.

    A difference below rounding is none; above it its rounding is that of half impulses, however short the step is.
    """
    mean, dU, velocity = room.momenta[0], room.covectors[2], room.covectors[0]
    before, after = value_at(f, room, room.poses[0]), value_at(f, room, room.poses[1])
    rounding, change, twice = _UNSEEN * (abs(before) + abs(after)), after - before, 0.0
    differentiate(f, room)
    see_velocity(f.c, mean, velocity)
    for i in range(len(dU)):
        change -= part * f.c.time_step * dU[i] * velocity[i]
    for i in range(len(mean)):
        for j in range(len(mean)):
            twice += mean[i] * f.c.metric[i, j] * mean[j]
    share = 1 / (2 * twice) if twice > 0.0 else 0.0
    left = 0.0 if abs(change) <= rounding else change * share
    room.noise[0] += rounding * share * largest(mean, mean)
    for i in range(len(out)):
        out[i] -= left * mean[i]
        for j in range(len(dU)):
            out[i] -= part * f.c.along[i, j] * dU[j]


@njit(**BORROWING)
def see_velocity(c: Impulses, mean: np.ndarray, velocity: np.ndarray) -> None:
    """Write the body velocity of momenta."""
    for i in range(len(velocity)):
        velocity[i] = 0.0
        for j in range(len(mean)):
            velocity[i] += c.velocity[i, j] * mean[j]


@borrowing
def add_force(f: Balanced, room: Scratch, part: float, time: float, out: np.ndarray) -> None:
    """Add half impulses of a force that is a function, in the middle of the step."""
    velocity, value = room.covectors[0], room.covectors[1]
    see_velocity(f.c, room.momenta[0], velocity)
    function_at(f.force, time, room.poses[2], velocity, value)
    for i in range(len(out)):
        for j in range(len(value)):
            out[i] += part * f.c.along[i, j] * value[j]


@borrowing
def half_impulse(f: Balanced, room: Scratch, part: float, time: float, row: int) -> None:
    """Write the half impulse of a part of a step from what stands in the room: poses, chart, momenta of the middle."""
    mean, out = room.momenta[0], room.momenta[1]
    out[:] = 0.0
    room.noise[0] = 0.0
    if len(f.c.linear) > 0 or len(f.c.springs) > 0:
        pull(f.c, room, out)
    for i in range(len(out)):
        out[i] += f.c.rows[min(row, len(f.c.rows) - 1), i]
        for j in range(len(f.c.friction)):
            out[i] -= f.c.friction[i, j] * mean[j]
        out[i] *= part
    if f.has[0] or f.has[1]:
        halve(room, len(f.c.turn))
    if f.has[1]:
        add_potential(f, room, part, out)
    if f.has[0]:
        add_force(f, room, part, time, out)


@scalar
def displace(p: Any, f: Balanced, room: Scratch, when: When, s: np.ndarray, guess: np.ndarray, pose: np.ndarray) -> int:
    """Write the displacement over momenta, the change of the free step, and the half impulse; return the outcome.

    The guess becomes the root.
    """
    part, momenta, change, mean = when[0], room.momenta[6], room.momenta[4], room.momenta[0]
    one, root = np.zeros(1), guess.copy()
    one[0] = 1.0
    for i in range(len(s)):
        momenta[i] = part * s[i]
    w = prepare(p, momenta, one)
    assign(room.pose, pose)
    code = find_root(p, w, 0, momenta, root, room.pose, guess)
    if code != 0:
        return code
    write_chart(p, momenta, guess, room.chart)
    push_and_move(p, w, momenta, guess, change, room.pose)
    for i in range(len(s)):
        change[i] /= part
        mean[i] = s[i] + change[i] / 2
    see_pose(f.c, room, room.pose, room.poses[1])
    half_impulse(f, room, part, when[1], when[2])
    return 0


@njit(**BORROWING)
def write_gap(room: Scratch, m: np.ndarray, s: np.ndarray) -> float:
    """Write what momenta miss, m + J - s; return the largest of it."""
    gap = room.momenta[2]
    for i in range(len(m)):
        gap[i] = (m[i] - s[i]) + room.momenta[1, i]  # exact where impulses are small
    return largest(gap, gap)


@njit(**BORROWING)
def share_of_gap(c: Impulses, room: Scratch, m: np.ndarray) -> float:
    """Write the momenta after a step, and return which part of them T has too much, by what the momenta before miss.

    The step is exact from m less the gap, so T gains gap . B^-1 (m' - m) besides its work, to first order: of one sign
    in most steps. Where T falls by more than half nothing is returned.
    """
    gap, after, change = room.momenta[2], room.momenta[7], room.momenta[3]
    excess = before = twice = 0.0
    for i in range(len(m)):
        change[i] = room.momenta[4, i] + 2 * room.momenta[1, i]
        after[i] = m[i] + change[i]
    for i in range(len(m)):
        for j in range(len(m)):
            excess += gap[i] * c.metric[i, j] * change[j]
            before += m[i] * c.metric[i, j] * m[j]
            twice += after[i] * c.metric[i, j] * after[j]
    return excess / twice if 2 * twice > before else 0.0


@scalar
def settle(
    p: Any, f: Balanced, room: Scratch, when: When, m: np.ndarray, s: np.ndarray, root: np.ndarray, pose: np.ndarray
) -> int:
    """Correct momenta s until s = m + J, by Broyden's method from the inverse slope in the room; return the outcome.

    It is 7 if a correction leaves more than half of what is missed. If none does, the slopes of all that was met differ
    by less than half, and the root is that of the path from where the slope was taken.
    """
    before = math.inf
    for _ in range(_CORRECTIONS):
        code = displace(p, f, room, when, s, root, pose)
        if code != 0:
            return code
        left, size = write_gap(room, m, s), largest(m, s)
        if not left < math.inf:
            return 5
        if left <= _EXACT * size or (left <= _SETTLED * size + room.noise[0] and not left < before / 2):
            return 0
        if not left <= _FALL * before:
            return 7
        if before < math.inf:
            renew(room, s)
        before = left
        correct(room, s)
    return 7


@njit(**BORROWING)
def correct(room: Scratch, s: np.ndarray) -> None:
    """Correct momenta by what they miss, and keep both."""
    origin, last, H = room.momenta[3], room.momenta[5], room.slopes
    assign(origin, s)
    assign(last, room.momenta[2])
    for i in range(len(s)):
        for j in range(len(s)):
            s[i] += H[i, j] * last[j]


@njit(**BORROWING)
def renew(room: Scratch, s: np.ndarray) -> None:
    """Let the inverse slope know the last correction, and what it changed: H y = s for both."""
    gap, origin, last, H, scratch = room.momenta[2], room.momenta[3], room.momenta[5], room.slopes, room.momenta[7]
    below = 0.0
    for i in range(len(s)):
        scratch[i] = 0.0
        for j in range(len(s)):
            scratch[i] += H[i, j] * (last[j] - gap[j])
        below += (s[i] - origin[i]) * scratch[i]
    if not abs(below) > 0.0:
        return
    for j in range(len(s)):
        along = 0.0
        for i in range(len(s)):
            along += (s[i] - origin[i]) * H[i, j]
        for i in range(len(s)):
            H[i, j] += (s[i] - origin[i] - scratch[i]) * along / below


@njit(**BORROWING)
def rub(c: Impulses, room: Scratch, part: float) -> None:
    """Write the inverse slope of what is missed that friction alone has, (I + K)^-1."""
    slope, H = room.slope, room.slopes
    for i in range(len(H)):
        for j in range(len(H)):
            H[i, j] = 1.0 if i == j else 0.0
            slope[i, j] = H[i, j] + (part * c.friction[i, j] if len(c.friction) else 0.0)
    eliminate(slope, H)


@scalar
def see_slope(
    p: Any, f: Balanced, room: Scratch, when: When, s: np.ndarray, root: np.ndarray, pose: np.ndarray
) -> None:
    """Write the inverse slope of what is missed at momenta, by differences."""
    slope, H, place, guess, first = room.slope, room.slopes, s.copy(), root.copy(), s.copy()
    size = 0.0
    for j in range(len(s) + 1):
        if j > 0:
            place[j - 1] += size
        displace(p, f, room, when, place, guess, pose)
        if j == 0:
            assign(first, room.momenta[1])
            size = largest(s, first)
            size = _DIFFERENCE * (size if size > 0.0 else 1.0)
            continue
        place[j - 1] = s[j - 1]
        for i in range(len(s)):
            H[i, j - 1] = 1.0 if i == j - 1 else 0.0
            slope[i, j - 1] = H[i, j - 1] - (room.momenta[1, i] - first[i]) / size
    eliminate(slope, H)


@njit(**BORROWING)
def is_folded(room: Scratch) -> bool:
    """Return whether what is missed hardly depends on momenta in some direction, by the inverse slope."""
    rows = room.slopes.reshape(-1)
    return not largest(rows, rows) < _FOLDED


@borrowing
def why_lost(f: Balanced, room: Scratch, code: int, reach: float, size: float) -> int:
    """Return the outcome of a path that is lost after a part of the step: 1 at a fold.

    Half impulses that are smooth functions of the displacement change without bound nowhere else. Where rounding blurs
    them slopes are noise, and at the beginning of a path there is no fold: nothing is known then.
    """
    if code != 7:
        return code
    is_known = reach > 0.0 and not room.noise[0] > _SETTLED * size
    if is_known and (not f.has[0] or is_folded(room)):
        return 1
    return 7 if f.has[0] else 3


@scalar
def solve(
    p: Any, f: Balanced, room: Scratch, when: When, m: np.ndarray, s: np.ndarray, root: np.ndarray, pose: np.ndarray
) -> int:
    """Correct momenta and root; where that is not certain, follow them over growing parts; return the outcome."""
    part, middle, row = when
    reach, size, at, guess = 0.0, 1.0, m.copy(), np.zeros_like(root)
    begin = middle - part * f.c.time_step / 2
    for _ in range(_PIECES):
        goal = min(1.0, reach + size)
        if reach > 0.0:
            see_slope(p, f, room, (part * reach, begin + part * reach * f.c.time_step / 2, row), at, guess, pose)
        else:
            rub(f.c, room, part * goal)
        code = settle(p, f, room, (part * goal, begin + part * goal * f.c.time_step / 2, row), m, s, root, pose)
        if code == 5 or (code == 0 and goal == 1.0):
            return code
        if code == 0:
            assign(at, s)
            assign(guess, root)
            reach, size = goal, 2 * size
        else:
            size /= 4
            assign(s, at)
            assign(root, guess)
        if size < _SMALLEST:
            return why_lost(f, room, code, reach, largest(m, s))
    return 3


@scalar
def step(
    p: Any, f: Balanced, room: Scratch, row: int, now: Rows, past: np.ndarray, pushes: np.ndarray, first: np.ndarray
) -> int:
    """Take all stages of a step from momenta, compensations and pose, in place; return the outcome.

    The chart of the first stage is written.
    """
    m, carry, pose = now
    s, root, floor, begin, code = m.copy(), past[0, 0].copy(), floor_of(m), f.c.begin + row * f.c.time_step, 0
    at = min(row, len(f.c.rows) - 1)
    for i in range(len(f.c.stages)):
        part = f.c.stages[i]
        when = part, begin + part * f.c.time_step / 2, row
        see_pose(f.c, room, pose, room.poses[0])
        for j in range(len(root)):
            root[j] = 3 * (past[i, 0, j] - past[i, 1, j]) + past[i, 2, j]
        for j in range(len(m)):
            table = part * f.c.rows[at, j]
            s[j] = m[j] + (table + (3 * (pushes[i, 0, j] - pushes[i, 1, j]) + pushes[i, 2, j]))
        code = solve(p, f, room, when, m, s, root, pose)
        if code != 0:
            return code
        if i == 0:
            assign(first, room.chart)
        for j in range(len(root)):
            past[i, 2, j], past[i, 1, j], past[i, 0, j] = past[i, 1, j], past[i, 0, j], root[j]
        share = share_of_gap(f.c, room, m)
        for j in range(len(m)):
            push = room.momenta[1, j]
            rest = push - part * f.c.rows[at, j]
            pushes[i, 2, j], pushes[i, 1, j], pushes[i, 0, j] = pushes[i, 1, j], pushes[i, 0, j], rest
            change = room.momenta[3, j] - share * room.momenta[7, j]
            m[j], carry[j] = kahan_sum(m[j], carry[j], change, floor)
        assign(pose, room.pose)
        begin += part * f.c.time_step
    return 0


@njit(nogil=True, **COMPILED)
def advance_balanced(p: Any, f: Balanced, state: np.ndarray, steps: int, every: int, rows: Rows) -> tuple[int, int]:
    """Advance any body under any force.

    The state holds momenta, compensations, the pose, the last three roots and half impulses of each stage, the number
    of the step.
    """
    momenta, charts, poses = rows
    k, size, stages = momenta.shape[1], poses.shape[1], len(f.c.stages)
    m, carry, pose = state[:k].copy(), state[k : 2 * k].copy(), state[2 * k : 2 * k + size].copy()
    rest = state[2 * k + size : len(state) - 1]
    past, pushes = rest[: len(rest) - 3 * k * stages].copy(), rest[len(rest) - 3 * k * stages :].copy()
    roots, halves = past.reshape(stages, 3, -1), pushes.reshape(stages, 3, k)
    room, first, row, count, code = room_of(f.c, size), np.zeros(charts.shape[1]), int(state[len(state) - 1]), 0, 0
    while count < steps:
        after, left, next_pose = m.copy(), carry.copy(), pose.copy()
        code = step(p, f, room, row, (after, left, next_pose), roots, halves, first)
        if code != 0:
            break
        count += 1
        row += 1
        if count % every == 0:
            at = count // every - 1
            assign(momenta[at], m)
            assign(poses[at], pose)
            assign(charts[at], first)
        assign(m, after)
        assign(carry, left)
        assign(pose, next_pose)
    for begin, part in (
        (0, m),
        (k, carry),
        (2 * k, pose),
        (2 * k + size, past),
        (len(state) - 1 - 3 * k * stages, pushes),
    ):
        assign(state[begin:], part)
    state[len(state) - 1] = row
    return count, code
