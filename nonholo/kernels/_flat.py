"""Runs of a scalar body on bare memory, for hosts without Python: a plain function that is compiled for them."""

import math
from collections.abc import Callable
from typing import Any

from numba.np.numpy_support import carray
from numba.np.unsafe.ndarray import to_fixed_tuple

from nonholo.kernels._driver import STATE_SIZE, advance, start
from nonholo.kernels._interface import Body


def flat_run(kind: type[Body]) -> Callable[..., int]:
    """Return the run of a kind of body, whose arguments are addresses of numbers but for `steps`.

    It takes up to `steps` steps into rows of momenta, charts and poses, and returns how many were good. A state whose
    chart is NaN is started first, from its momentum and pose. The outcome is written behind the state.
    """
    count = len(kind._fields)  # pyright: ignore[reportAttributeAccessIssue]

    def run(body: Any, state: Any, steps: int, momenta: Any, charts: Any, poses: Any) -> int:
        p = kind(*to_fixed_tuple(carray(body, count), count))  # pyright: ignore
        s = carray(state, STATE_SIZE + 1)
        code = start(p, s[:2], s[10:STATE_SIZE], s) if math.isnan(s[4]) else 0
        done = 0
        if code == 0:
            rows = carray(momenta, (steps, 2)), carray(charts, (steps, 2)), carray(poses, (steps, 4))
            done, code = advance(p, s, steps, 1, rows[0], rows[1], rows[2])
        s[STATE_SIZE] = code
        return done

    return run
