"""Runs on bare memory, for hosts without Python: plain functions to compile for them."""

import functools
import math
from collections.abc import Callable
from typing import Any

from nonholo.kernels._driver import STATE_SIZE, advance, start
from nonholo.kernels._scalar import Body, inertia, quadratic
from nonholo.kernels._sleigh import SleighBody
from nonholo.kernels._small import assign
from nonholo.kernels._suslov import SuslovBody
from nonholo.kernels.forced import advance_cubic, cubic_of
from nonholo.kernels.secular import SecularBody
from nonholo.kernels.secular import run as secular
from nonholo.kernels.taylor import Arrowhead, room_for_steps, take_step, terms_for

FORCES = 8  # where they begin: after the numbers of a body
TABLE = 26  # where rows begin
FORCED_SIZE = 22  # of a state of a run under forces


def flat_run(kind: type[Body]) -> Callable[..., int]:
    """Return the run of a kind of body on bare memory, for hosts without Python: a plain function to compile for them.

    Its arguments are addresses of numbers but for `steps`. It takes up to `steps` steps into rows of momenta, charts
    and poses, and returns how many were good. A state whose chart is NaN is started first, from its momentum and pose.
    The outcome is written behind the state.
    """
    count = len(kind._fields)  # pyright: ignore[reportAttributeAccessIssue]

    from numba.np.numpy_support import carray
    from numba.np.unsafe.ndarray import to_fixed_tuple

    def run(body: Any, state: Any, steps: int, momenta: Any, charts: Any, poses: Any) -> int:
        p = kind(*to_fixed_tuple(carray(body, count), count))  # pyright: ignore
        s = carray(state, STATE_SIZE + 1)
        code = start(p, s[:2], s[10:STATE_SIZE], s) if math.isnan(s[4]) else 0
        good = 0
        if code == 0:
            rows = carray(momenta, (steps, 2)), carray(charts, (steps, 2)), carray(poses, (steps, 4))
            good, code = advance(p, s, steps, 1, rows)
        s[STATE_SIZE] = code
        return good

    return run


def flat_forced_run(kind: type[Body]) -> Callable[..., int]:
    """Return the run of a kind of body under balanced forces on bare memory: a plain function, as `flat_run` does.

    Arguments and result are those of `flat_run` but for the numbers of the body and the state. From place FORCES on
    stand: how many numbers F has (2 or 3; 0 without a weight), whether there is friction, half the time step, the
    factor to the momenta of the kernel, C (4), F (3) and the lever (2, 3) of the kernel's rows, both zero without a
    weight, and how many rows of a table follow from place TABLE on, forces along the rows of the kernel, the last one
    zero: the first run makes them half impulses, and their number negative. The state is that of `advance_two`: one
    whose chart is NaN, at place 8, is started first, from its momentum and its pose at place 4; all else is zero.
    Before the steps it is then at the node after the start.
    """
    count = len(kind._fields)  # pyright: ignore[reportAttributeAccessIssue]

    from numba.np.numpy_support import carray
    from numba.np.unsafe.ndarray import to_fixed_tuple

    def run(body: Any, state: Any, steps: int, momenta: Any, charts: Any, poses: Any) -> int:
        f = carray(body, TABLE)
        p = kind(*to_fixed_tuple(f[:count], count))  # pyright: ignore
        n, half, scale, rows = int(f[8]), f[10], f[11], abs(int(f[25]))
        stiff, unit, none = half * (quadratic(p)[0] / inertia(p)[0]), half * scale, f[9] == 0
        K = (0.0, 0.0, 0.0, 0.0) if none else (stiff * f[12], stiff * f[13], stiff * f[14], stiff * f[15])
        L = unit * f[19], unit * f[20], unit * f[21], unit * f[22], unit * f[23], unit * f[24]
        cubic = cubic_of(p, n, (f[16], f[17], f[18]), L, K)
        table = carray(body, (TABLE // 2 + rows, 2))[TABLE // 2 :]
        for i in range(int(f[25])):  # not once they are half impulses
            table[i, 0], table[i, 1] = unit * table[i, 0], unit * table[i, 1]
        f[25] = -rows
        s = carray(state, FORCED_SIZE + 1)
        good, code, first = 0, 0, 0 if math.isnan(s[8]) else 1
        s[8] = s[8] if first else 0.0
        for at in range(first, 2):
            size = steps if at else 1
            into = carray(momenta, (size, 2)), carray(charts, (size, 2)), carray(poses, (size, 4))
            good, code = advance_cubic(p, cubic, table, s, size, 1, into)
            good = good * at
            for i in range(10, 10 if at else 16):
                s[i] = s[i - 2]  # the first root is the guess of those after it
            if code != 0:
                break
        s[FORCED_SIZE] = code
        return good

    return run


def flat_secular_run(k: int) -> Callable[..., int]:
    """Return the run of tops with k admissible rotations on bare memory: a plain function, as `flat_run` does.

    Arguments and result are those of `flat_run` but for the numbers of the body, b (k), c (k) with the sign of
    `SecularBody`, the least of b; and the state, which is that of `secular.run`. One whose nu is NaN, at place 2 k,
    is started first, from its momenta and the rows of its pose at place 2 k + 7. Behind the state stand the outcome
    and the chart of the last good step.
    """
    begin, size = 2 * k + 7, 2 * k + 7 + (k + 1) ** 2

    from numba.np.numpy_support import carray

    def run(body: Any, state: Any, steps: int, momenta: Any, charts: Any, poses: Any) -> int:
        f, s = carray(body, 2 * k + 1), carray(state, size + 1 + k)
        p = SecularBody(f[:k], f[k : 2 * k], 1.0, 0.0, f[:0], f[2 * k], False)
        good, code = 0, 0
        if math.isnan(s[2 * k]):
            code, first = secular.start(p, s[:k], s[begin:size])
            assign(s, first)
        if code == 0:
            rows = carray(momenta, (steps, k)), carray(charts, (steps, k)), carray(poses, (steps, (k + 1) ** 2))
            good, code = secular.advance(p, s[:size], steps, 1, rows)
        secular.chart_of(p, s[:k], s[2 * k], s[2 * k + 1], s[size + 1 :])
        s[size] = code
        return good

    return run


def flat_arrowhead_run(size: int, tolerance: float) -> Callable[..., int]:
    """Return `solve_arrowhead` for `size` components on bare memory: a plain function to compile for other hosts.

    Its arguments are addresses of numbers but for `count`: rates, coupling and the end; x and time, and what rounding
    took from them, which become those of the last step; times; rows of x. It returns how many of the `count` rows are
    written. The last address is not used.
    """
    terms = terms_for(tolerance)

    from numba.np.numpy_support import carray

    def run(body: Any, state: Any, count: int, times: Any, rows: Any, _: Any) -> int:
        f, s = carray(body, 2 * size + 1), carray(state, (2, size + 1))
        equations = Arrowhead(f[:size], f[size : 2 * size])
        p = room_for_steps(equations, f[2 * size], tolerance, terms)
        at, out = carray(times, (count,)), carray(rows, (count, size))
        good, going = 0, True
        while going and good < count:
            good, going = take_step(p, s, at, good, out)
        return good

    return run


FLAT_RUNS: dict[str, Callable[[], Callable[..., int]]] = {
    "top": functools.partial(flat_run, SuslovBody),
    "sleigh": functools.partial(flat_run, SleighBody),
    "forced_top": functools.partial(flat_forced_run, SuslovBody),
    "forced_sleigh": functools.partial(flat_forced_run, SleighBody),
    "top4": functools.partial(flat_secular_run, 3),
    "flow4": functools.partial(flat_arrowhead_run, 3, 1e-14 / 64),
}
"""What makes runs on bare memory, for hosts without Python: those of a page."""
