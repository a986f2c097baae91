"""Runs of tops on SO(n) on bare memory, for hosts without Python."""

import math
from collections.abc import Callable
from typing import Any

from nonholo.kernels._small import assign
from nonholo.kernels.secular import run as secular
from nonholo.kernels.secular._step import SecularBody


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
        done, code = 0, 0
        if math.isnan(s[2 * k]):
            code, first = secular.start(p, s[:k], s[begin:size])
            assign(s, first)
        if code == 0:
            rows = carray(momenta, (steps, k)), carray(charts, (steps, k)), carray(poses, (steps, (k + 1) ** 2))
            done, code = secular.advance(p, s[:size], steps, 1, rows[0], rows[1], rows[2])
        secular.chart_of(p, s[:k], s[2 * k], s[2 * k + 1], s[size + 1 :])
        s[size] = code
        return done

    return run
