r"""Compositions of the step: one long step made of substeps $\gamma_i h$ of either sign (docs/theory/compositions.md).

Momenta are in units of the displacement of the long step, $m = h\,r/2$ or another unit of its body; a substep sees
$\gamma_i m$ and changes m by the increment over $\gamma_i$. A state counts as good when the whole step that starts
there was taken, so the state of a run holds the present state and the one after it. It is one array: momenta (k),
pose, then momenta (k), compensations (k) and pose after the step, then the last three roots of each substep.

The pieces of a substep (a root over given momenta, the push and the move at that root) are the same for every body,
chosen by its type; numba chooses when it compiles. Tops in space and sleighs in the plane have separate loops, here
and in `forced`, where no function is called.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from nonholo.base.compiled import njit, overload
from nonholo.kernels._driver import SETTLED, _solve, floor_of, kahan_sum
from nonholo.kernels._scalar import COMPILED, Body, Rows, increment, move
from nonholo.kernels._small import assign
from nonholo.kernels.general import GeneralBody, Workspace, increments, workspace
from nonholo.kernels.general import run as general_run
from nonholo.kernels.secular import SecularBody, certain_radius, level_of, room_for_sums, term
from nonholo.kernels.secular import run as secular_run


@njit(**COMPILED)
def _two_prepare(p: Body, m: np.ndarray, weights: np.ndarray) -> np.ndarray:
    return np.empty(0)


@njit(**COMPILED)
def _two_write_chart(p: Body, m: np.ndarray, root: np.ndarray, chart: np.ndarray) -> None:
    assign(chart, root)


@njit(**COMPILED)
def _two_find_root(
    p: Body, w: np.ndarray, stage: int, m: np.ndarray, guess: np.ndarray, pose: np.ndarray, root: np.ndarray
) -> int:
    code, root[0], root[1] = _solve(p, m[0], m[1], guess[0], guess[1])
    return code


@njit(**COMPILED)
def _two_push_and_move(
    p: Body, w: np.ndarray, m: np.ndarray, root: np.ndarray, change: np.ndarray, pose: np.ndarray
) -> None:
    change[0], change[1] = increment(p, m[0], m[1], root[0], root[1])
    pose[0], pose[1], pose[2], pose[3] = move(p, root[0], root[1], pose[0], pose[1], pose[2], pose[3])


@njit(**COMPILED)
def _secular_prepare(p: SecularBody, m: np.ndarray, weights: np.ndarray) -> Rows:
    """Return the certain radius of each stage, and room for y and for sums."""
    certain, k = np.empty(len(weights)), len(p.b)
    for i in range(len(weights)):
        momenta = weights[i] * m
        certain[i] = certain_radius(p, level_of(p, momenta[:k], momenta[-1] if p.slides else 0.0))
    return certain, np.empty(k), room_for_sums()


@njit(**COMPILED)
def _secular_find_root(
    p: SecularBody, w: Any, stage: int, m: np.ndarray, guess: np.ndarray, pose: np.ndarray, root: np.ndarray
) -> int:
    code, root[0], root[1] = secular_run.solve(p, m, w[0][stage], guess[0], guess[1], w[2])
    return code


@njit(**COMPILED)
def _secular_push_and_move(
    p: SecularBody, w: Any, m: np.ndarray, root: np.ndarray, change: np.ndarray, pose: np.ndarray
) -> None:
    y, nu, tau, k, lever = w[1], root[0], root[1], len(p.b), p.mass * p.arm * p.arm
    secular_run.coordinates(p, m, nu, tau, y)
    for i in range(k):
        change[i] = term(p.c[i], y[i], nu, tau, lever)
    if p.slides:
        change[k] = 2 * p.mass * p.arm * tau / (1 + tau)
    if len(pose):
        secular_run.move(p, m[-1], nu, tau, y, pose)


@njit(**COMPILED)
def _secular_write_chart(p: SecularBody, m: np.ndarray, root: np.ndarray, chart: np.ndarray) -> None:
    secular_run.chart_of(p, m, root[0], root[1], chart)


@njit()
def _general_prepare(p: GeneralBody, m: np.ndarray, weights: np.ndarray) -> Workspace:
    return workspace(p)


@njit()
def _general_find_root(
    p: GeneralBody, w: Workspace, stage: int, m: np.ndarray, guess: np.ndarray, pose: np.ndarray, root: np.ndarray
) -> int:
    g = pose.reshape(w.X.shape)
    general_run.see_pose(p, w, g)
    assign(root, guess)
    code = general_run.solve(p, w, m, root)
    return 5 if general_run.is_infinite(p, g) else code


@njit()
def _general_push_and_move(
    p: GeneralBody, w: Workspace, m: np.ndarray, root: np.ndarray, change: np.ndarray, pose: np.ndarray
) -> None:
    """Push and move at the root whose displacement is in the workspace."""
    change[:] = 0.0
    if not p.spatial:
        increments(p, w, change)
    general_run.move(p, w, pose.reshape(w.X.shape))


@njit()
def _general_write_chart(p: GeneralBody, m: np.ndarray, root: np.ndarray, chart: np.ndarray) -> None:
    assign(chart, root * p.stretch)


def choose_by_body(secular: Callable[..., Any], general: Callable[..., Any], two: Any = None) -> Callable[..., Any]:
    """Return the function that calls the piece for the type of its first argument, for numba and for plain Python."""
    table: dict[type, Any] = {SecularBody: secular, GeneralBody: general}

    def piece(p: Any, *rest: Any) -> Any:
        return table.get(type(p), two)(p, *rest)

    def choose(p: Any, *_: Any) -> Any:
        return table.get(p.instance_class, two).py_func  # a call of the compiled one would be optimized once more

    overload(piece, jit_options=COMPILED, strict=False)(choose)
    return piece


prepare = choose_by_body(_secular_prepare, _general_prepare, _two_prepare)
"""(p, m, weights): what the other pieces need beside the body."""
find_root = choose_by_body(_secular_find_root, _general_find_root, _two_find_root)
"""(p, w, stage, m, guess, pose, root): write the principal root over m; return the outcome."""
push_and_move = choose_by_body(_secular_push_and_move, _general_push_and_move, _two_push_and_move)
"""(p, w, m, root, change, pose): write the change of m, right after `find_root`; move the pose."""
write_chart = choose_by_body(_secular_write_chart, _general_write_chart, _two_write_chart)
"""(p, m, root, chart): write the chart coordinates of a root."""


def at_rest(body: Body | SecularBody | GeneralBody) -> np.ndarray:
    """Return the unknowns at the identity."""
    return _AT_REST.get(type(body), lambda _: np.zeros(2))(body)


_AT_REST: dict[type, Callable[[Any], np.ndarray]] = {
    SecularBody: lambda body: np.array((body.mass * body.arm * body.arm, 0.0)),
    GeneralBody: lambda body: np.zeros(len(body.stretch)),
}


class ComposedBody(NamedTuple):
    r"""A body and the weights of the substeps.

    Attributes:
        body: The body of the step that is composed.
        weights: The fractions $\gamma_i$ of the time step, (S,).
    """

    body: Body | SecularBody | GeneralBody
    weights: np.ndarray


@njit(**COMPILED)
def _sweep_arrays(
    p: Any, w: Any, weights: np.ndarray, m: np.ndarray, carry: np.ndarray, g: np.ndarray, roots: np.ndarray, room: Rows
) -> int:
    """Take all substeps from momenta and pose, in place; `roots` (S, 3, u) are extrapolated to guesses."""
    part, change, guess = room
    floor = floor_of(m)
    for i in range(len(weights)):
        weight, past = weights[i], roots[i]
        for j in range(len(guess)):
            guess[j] = 3 * (past[0, j] - past[1, j]) + past[2, j]
            past[2, j], past[1, j] = past[1, j], past[0, j]
        for j in range(len(m)):
            part[j] = weight * m[j]
        code = find_root(p, w, i, part, guess, g, past[0])
        if code != 0:
            return code
        push_and_move(p, w, part, past[0], change, g)
        for j in range(len(m)):
            m[j], carry[j] = kahan_sum(m[j], carry[j], change[j] / weight, floor)
    return 0


@njit(**COMPILED)
def _sweep_numbers(
    p: Any, w: Any, weights: np.ndarray, m: np.ndarray, carry: np.ndarray, g: np.ndarray, roots: np.ndarray, room: Rows
) -> int:
    """Take all substeps as `_sweep_arrays` does, with numbers in place of arrays: several times as fast."""
    m1, m2, l1, l2, q0, q1, q2, q3 = m[0], m[1], carry[0], carry[1], g[0], g[1], g[2], g[3]
    floor = SETTLED * max(abs(m1), abs(m2))
    for i in range(len(weights)):
        weight, s1, s2 = weights[i], weights[i] * m1, weights[i] * m2
        y1, y2, u1, u2 = roots[i, 0, 0], roots[i, 0, 1], roots[i, 1, 0], roots[i, 1, 1]
        code, w1, w2 = _solve(p, s1, s2, 3 * (y1 - u1) + roots[i, 2, 0], 3 * (y2 - u2) + roots[i, 2, 1])
        if code != 0:
            return code
        roots[i, 0, 0], roots[i, 0, 1], roots[i, 1, 0], roots[i, 1, 1] = w1, w2, y1, y2
        roots[i, 2, 0], roots[i, 2, 1] = u1, u2
        d1, d2 = increment(p, s1, s2, w1, w2)
        m1, l1 = kahan_sum(m1, l1, d1 / weight, floor)
        m2, l2 = kahan_sum(m2, l2, d2 / weight, floor)
        q0, q1, q2, q3 = move(p, w1, w2, q0, q1, q2, q3)
    m[0], m[1], carry[0], carry[1] = m1, m2, l1, l2
    g[0], g[1], g[2], g[3] = q0, q1, q2, q3
    return 0


_sweep = choose_by_body(_sweep_arrays, _sweep_arrays, _sweep_numbers)


@njit(**COMPILED)
def _room(momenta: int, unknowns: int) -> Rows:
    """Return the arrays that a sweep writes to: momenta and their changes in a substep, and a guess."""
    return np.empty(momenta), np.empty(momenta), np.empty(unknowns)


@njit(nogil=True, **COMPILED)
def _advance(p: Any, weights: np.ndarray, state: np.ndarray, steps: int, every: int, rows: Rows) -> tuple[int, int]:
    momenta, charts, poses = rows
    k, size, stages = momenta.shape[1], poses.shape[1], len(weights)
    now, g, ahead, after = state[:k], state[k : k + size], state[k + size : 3 * k + size], state[3 * k + size :]
    m, carry, pose = ahead[:k].copy(), ahead[k:].copy(), after[:size].copy()
    roots = after[size:].copy().reshape(stages, 3, -1)
    w, room, code, count = prepare(p, m, weights), _room(k, roots.shape[2]), 0, 0
    before, at = m.copy(), pose.copy()
    while count < steps:
        assign(before, m)
        assign(at, pose)
        code = _sweep(p, w, weights, m, carry, pose, roots, room)
        if code != 0:
            break
        assign(now, before)
        assign(g, at)
        count += 1
        if count % every == 0:
            row = count // every - 1
            assign(momenta[row], now)
            assign(poses[row], g)
            assign(room[0], weights[0] * now)
            write_chart(p, room[0], roots[0, 0], charts[row])
    assign(ahead, m)
    assign(ahead[k:], carry)
    assign(after, pose)
    assign(after[size:], roots.ravel())
    return count, code


@njit(nogil=True, **COMPILED)
def _each(
    p: Any, weights: np.ndarray, momenta: np.ndarray, poses: np.ndarray, rest: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Take one step from each row; return momenta, poses and outcomes, and compensations and roots of the last row."""
    after, next_poses, codes = momenta.copy(), poses.copy(), np.zeros(len(momenta), dtype=np.int64)
    room, roots = _room(momenta.shape[1], len(rest)), np.empty((len(weights), 3, len(rest)))
    carry = np.zeros(momenta.shape[1])
    for row in range(len(momenta)):
        carry[:] = 0.0
        for i in range(len(weights)):
            for j in range(3):
                assign(roots[i, j], rest)
        w = prepare(p, momenta[row], weights)
        codes[row] = _sweep(p, w, weights, after[row], carry, next_poses[row], roots, room)
    return after, next_poses, codes, carry, roots


def start(composition: ComposedBody, momentum: np.ndarray, pose: np.ndarray) -> tuple[int, np.ndarray]:
    """Return the outcome of the first step and the state of a run that begins with scaled momenta and a pose."""
    p, weights = composition
    after, next_poses, codes, carry, roots = _each(p, weights, np.array([momentum]), np.array([pose]), at_rest(p))
    roots[:, 1:] = roots[:, :1]
    return int(codes[0]), np.concatenate((momentum, pose, after[0], carry, next_poses[0], roots.ravel()))


def advance(composition: ComposedBody, state: np.ndarray, steps: int, every: int, rows: Rows) -> tuple[int, int]:
    """Take up to `steps` steps, saving each `every`-th one; return how many were good and the outcome.

    The chart of a row is that of its first substep. After a failure momenta and pose of the present state are those of
    the last good step.
    """
    return _advance(*composition, state, steps, every, rows)


def first_chart(composition: ComposedBody, state: np.ndarray, momenta: int, coordinates: int) -> np.ndarray:
    """Return the chart coordinates of the first substep from the present state, given their numbers."""
    p, weights = composition
    unknowns = len(at_rest(p))
    chart = np.empty(coordinates)
    first = len(state) - 3 * unknowns * len(weights)
    write_chart(p, weights[0] * state[:momenta], state[first : first + unknowns], chart)
    return chart


def whole_steps(composition: ComposedBody, momenta: np.ndarray, poses: np.ndarray) -> Rows:
    """Take one whole step from each row of momenta and poses; return both after it, and the outcomes."""
    p, weights = composition
    return _each(p, weights, np.array(momenta, order="C"), np.array(poses, order="C"), at_rest(p))[:3]
