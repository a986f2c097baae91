"""The pose of a body whose velocity is known in closed form: what the compiled integrator needs of it."""

import math
from typing import NamedTuple

import numpy as np

from nonholo.base.compiled import njit
from nonholo.kernels import RATES


class Turning(NamedTuple):
    r"""The motion $g' = g\,(\mathrm{sech}\,s\,A + \tanh s\,B)$, $s = s_0 + \nu t$; the state is g row by row.

    Attributes:
        across: A, (N, N).
        along: B, (N, N).
        start: $s_0$.
        rate: $\nu$.
    """

    across: np.ndarray
    along: np.ndarray
    start: float
    rate: float


@njit(error_model="numpy")
def turning_rate(p: Turning, time: float, state: np.ndarray, out: np.ndarray) -> None:
    """Write the rate of the pose, without overflow at any time."""
    phase, n = p.start + p.rate * time, len(p.across)
    decay = math.exp(-abs(phase))
    share, limit = 2 * decay / (1 + decay * decay), math.tanh(phase)
    for i in range(n):
        for j in range(n):
            total = 0.0
            for k in range(n):
                total += state[n * i + k] * (share * p.across[k, j] + limit * p.along[k, j])
            out[n * i + j] = total


RATES[Turning] = turning_rate
