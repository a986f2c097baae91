"""The continuous momenta of tops and sleighs on bare memory, for hosts without Python."""

from collections.abc import Callable
from typing import Any

from nonholo.kernels.taylor._arrowhead import Arrowhead, room_for_steps, take_step, terms_for


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
        reached, going = 0, True
        while going and reached < count:
            reached, going = take_step(p, s, at, reached, out)
        return reached

    return run
