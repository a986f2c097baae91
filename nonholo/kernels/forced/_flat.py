"""Runs under forces on bare memory, for hosts without Python."""

import math
from collections.abc import Callable
from typing import Any

from nonholo.kernels._interface import Body, inertia, quadratic
from nonholo.kernels.forced._cubic import advance_cubic, cubic_of

FORCES = 8  # where they begin: after the numbers of a body
TABLE = 26  # where rows begin
STATE_SIZE = 22


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
        s = carray(state, STATE_SIZE + 1)
        done, code, first = 0, 0, 0 if math.isnan(s[8]) else 1
        s[8] = s[8] if first else 0.0
        for at in range(first, 2):
            size = steps if at else 1
            into = carray(momenta, (size, 2)), carray(charts, (size, 2)), carray(poses, (size, 4))
            done, code = advance_cubic(p, cubic, table, s, size, 1, into)
            done = done * at
            for i in range(10, 10 if at else 16):
                s[i] = s[i - 2]  # the first root is the guess of those after it
            if code != 0:
                break
        s[STATE_SIZE] = code
        return done

    return run
