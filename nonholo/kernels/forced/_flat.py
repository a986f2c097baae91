"""Runs under forces on bare memory, for hosts without Python."""

import math
from collections.abc import Callable
from typing import Any

from nonholo.kernels._interface import Body
from nonholo.kernels.forced._kick import rubbed
from nonholo.kernels.forced._two import Numbers, advance_numbers

FORCES = 8  # where they begin: after the numbers of a body
TABLE = 26  # where rows begin
STATE_SIZE = 22


def flat_forced_run(kind: type[Body]) -> Callable[..., int]:
    """Return the run of a kind of body under linear forces on bare memory: a plain function, as `flat_run` does.

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
        A, V = (1.0, 0.0, 0.0, 1.0), (half, 0.0, 0.0, half)
        if f[9] != 0:
            A, V = rubbed(p, (f[12], f[13], f[14], f[15]), half)
        a, b, c, d = scale * V[0], scale * V[1], scale * V[2], scale * V[3]
        x, y, z, u, v, w = f[19], f[20], f[21], f[22], f[23], f[24]
        L = a * x + b * u, a * y + b * v, a * z + b * w, c * x + d * u, c * y + d * v, c * z + d * w
        kick = Numbers(n, f[9] != 0, (f[16], f[17], f[18]), L, A)
        table = carray(body, (TABLE // 2 + rows, 2))[TABLE // 2 :]
        for i in range(int(f[25])):  # not once they are half impulses
            x, y = table[i, 0], table[i, 1]
            table[i, 0], table[i, 1] = a * x + b * y, c * x + d * y
        f[25] = -rows
        s = carray(state, STATE_SIZE + 1)
        done, code, first = 0, 0, 0 if math.isnan(s[8]) else 1
        s[8] = s[8] if first else 0.0
        for at in range(first, 2):
            size = steps if at else 1
            into = carray(momenta, (size, 2)), carray(charts, (size, 2)), carray(poses, (size, 4))
            done, code = advance_numbers(p, kick, table, s, size, 1, into)
            done = done * at
            for i in range(10, 10 if at else 16):
                s[i] = s[i - 2]  # the first root is the guess of those after it
            if code != 0:
                break
        s[STATE_SIZE] = code
        return done

    return run
