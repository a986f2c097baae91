r"""Runs with forces: half an impulse at each end of a step, and the step of the body between them.

A node k has the momenta m. A step begins at $s = K_k(m)$ with the root over s, and ends, after the increment and the
move, with $K_k$ once more at the pose of the next node (docs/theory/forces.md). The half impulse is linear,

$$ K_k(m) = A\,m + L\,R^TF + r_k, $$

with a force F that is fixed in space and the rotation R of the pose, or that of functions (`_driven`). A run's state is
one array: momenta of the next node, in loops over arrays before its impulse, their compensations, its pose, the last
four roots, for quaternions and headings $L R^TF$ and $R^TF$ there, the number of its step, and the chart at which the
run began.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from nonholo.base.compiled import njit, overload
from nonholo.kernels._composition import at_rest, find_root, prepare, push_and_move, write_chart
from nonholo.kernels._driver import floor_of, kahan_sum
from nonholo.kernels._scalar import COMPILED, INLINED, Rows
from nonholo.kernels._small import assign
from nonholo.kernels.forced._balanced import Balanced, advance_balanced
from nonholo.kernels.forced._cubic import Pull, advance_pulled
from nonholo.kernels.forced._driven import Drive, drive_momenta, pulled_by_functions, room_for_drive
from nonholo.kernels.forced._kick import Kick, advance_two, linear, pulled_by_weight, room_for_kick
from nonholo.kernels.general import GeneralBody
from nonholo.kernels.secular import SecularBody


class ForcedBody(NamedTuple):
    """A body of an order-2 step and its half impulse."""

    body: Any
    kick: Kick | Drive | Balanced | Pull


def _either(of_kick: Any, of_drive: Any, options: Any = INLINED) -> Callable[..., Any]:
    """Return the function that calls one or the other by the type of its first argument, as `choose_by_body` does."""

    def piece(kick: Any, *rest: Any) -> Any:
        return (of_kick if type(kick) is Kick else of_drive)(kick, *rest)

    overload(piece, jit_options=options, strict=False)(
        lambda kick, *_: of_kick if kick.instance_class is Kick else of_drive
    )
    return piece


room_of = _either(room_for_kick, room_for_drive, COMPILED)
"""(kick): room for the other pieces."""
see_node = _either(pulled_by_weight, pulled_by_functions)
"""(kick, room, pose): see the pose of a node."""
half_kick = _either(linear, drive_momenta)
"""(kick, room, node, row, m, out): write momenta after half the impulse of a step, a row, at a node; the outcome."""


@njit(nogil=True, **COMPILED)
def advance_many(p: Any, kick: Any, state: np.ndarray, steps: int, every: int, rows: Rows) -> tuple[int, int]:
    """Advance any body, under any force: that of a node is asked when its step is taken, not before."""
    momenta, charts, poses = rows
    k, size = momenta.shape[1], poses.shape[1]
    before, carry, pose = state[:k].copy(), state[k : 2 * k].copy(), state[2 * k : 2 * k + size].copy()
    roots = state[2 * k + size : len(state) - 6].copy().reshape(4, -1)
    m, s, change, root, guess = before.copy(), np.empty(k), np.empty(k), roots[0].copy(), roots[0].copy()
    room, row, code, count, one = room_of(kick), int(state[len(state) - 1]), 0, 0, np.zeros(1)
    one[0] = 1.0
    while count < steps:
        see_node(kick, room, pose)
        code = half_kick(kick, room, row, row - 1, before, m) if row > 0 else 0
        code = half_kick(kick, room, row, row, m, s) if code == 0 else code
        if code != 0:
            break
        w = prepare(p, s, one)  # a certificate may be for momenta of one energy
        for j in range(len(guess)):
            guess[j] = 3 * (roots[0, j] - roots[1, j]) + roots[2, j]
        code = find_root(p, w, 0, s, guess, pose, root)
        if code != 0:
            break
        for j in range(len(root)):
            roots[2, j], roots[1, j], roots[0, j] = roots[1, j], roots[0, j], root[j]
        count += 1
        row += 1
        if count % every == 0:
            at = count // every - 1
            assign(momenta[at], m)
            assign(poses[at], pose)
            write_chart(p, s, root, charts[at])
        push_and_move(p, w, s, root, change, pose)
        add_compensated(s, carry, change)
        assign(before, s)
    for begin, part in ((0, before), (k, carry), (2 * k, pose), (2 * k + size, roots.reshape(-1))):
        assign(state[begin:], part)
    state[len(state) - 1] = row
    return count, code


@njit(**COMPILED)
def add_compensated(s: np.ndarray, carry: np.ndarray, change: np.ndarray) -> None:
    """Add a change to momenta in place, by Kahan's summation."""
    floor = floor_of(s)
    for i in range(len(s)):
        s[i], carry[i] = kahan_sum(s[i], carry[i], change[i], floor)


def start(forced: ForcedBody, momentum: np.ndarray, pose: np.ndarray, sizes: Any) -> tuple[int, np.ndarray]:
    """Return the outcome of the first root and the state of a run; `sizes` are those of a row of the body."""
    rest, k, begin = at_rest(forced.body), len(momentum), 2 * len(momentum) + len(pose)
    stages = len(forced.kick.stages) if type(forced.kick) is Balanced else 0
    histories = ((stages, 3, len(rest)), (stages, 3, k)) if stages else ((1, 4, len(rest)),)
    past = [np.zeros(shape) for shape in histories]
    past[0][:] = rest
    more = np.zeros((1 if stages else 6) + sizes[1])
    state = np.concatenate((momentum, np.zeros_like(momentum), pose, *map(np.ravel, past), more))
    momenta, chart, poses = np.empty((1, k)), np.empty((1, sizes[1])), np.empty((1, len(pose)))
    _, code = advance(forced, state, 1, 1, (momenta, chart, poses))
    state[len(state) - sizes[1] :] = chart[0] if code == 0 else np.nan
    for each in past:  # what is known so far stands for all that came before
        history = state[begin : begin + each.size].reshape(each.shape)
        history[:, 1:] = history[:, :1]
        begin += each.size
    return code, state


def advance(forced: ForcedBody, state: np.ndarray, steps: int, every: int, rows: Rows) -> tuple[int, int]:
    """Take up to `steps` steps, saving each `every`-th one; return how many were good and the outcome.

    After a failure the state is that of the last good step.
    """
    few = type(forced.kick) is Kick and not isinstance(forced.body, SecularBody | GeneralBody)
    run = _LOOPS.get(type(forced.kick), advance_two if few else advance_many)
    run = getattr(run, "py_func", run) if forced.kick.is_python else run
    return run(*forced, state[: len(state) - rows[1].shape[1]], steps, every, rows)


_LOOPS: dict[type, Any] = {Balanced: advance_balanced, Pull: advance_pulled}
"""The loops of half impulses at the displacement."""
