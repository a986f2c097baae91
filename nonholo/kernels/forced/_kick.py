"""Half an impulse that is linear in the momenta: friction, a force that is fixed in space, rows of a table."""

from typing import NamedTuple

import numpy as np

from nonholo.kernels._scalar import inlined, scalar


class Kick(NamedTuple):
    """Half an impulse, in the units and axes of a kernel.

    Attributes:
        keep: A, what is left of the momenta, (k, k); (0, 0) where all is.
        weight: F, as long as a row of poses that are matrices, (2,) for cosine and sine, (3,) for a quaternion; (0,)
            without a force that is fixed in space.
        arms: L, (k, len(F)).
        rows: r, (steps + 1, k), at both ends of each step; the last one is zero and acts after all steps.
    """

    is_python = False
    keep: np.ndarray
    weight: np.ndarray
    arms: np.ndarray
    rows: np.ndarray


@scalar
def room_for_kick(kick: Kick) -> np.ndarray:
    """Return room for what the weight adds to momenta."""
    return np.empty(kick.rows.shape[1])


@inlined
def pulled_by_weight(kick: Kick, force: np.ndarray, pose: np.ndarray) -> None:
    """Write what the weight adds to momenta at a pose that is a matrix."""
    n, k = len(kick.weight), len(force)
    force[:] = 0.0
    for j in range(n):
        seen = 0.0
        for i in range(n):
            seen += kick.weight[i] * pose[n * i + j]
        for i in range(k):
            force[i] += kick.arms[i, j] * seen


@inlined
def kept(kick: Kick, m: np.ndarray, i: int) -> float:
    """Return what friction leaves of a momentum, a number of A m."""
    if len(kick.keep) == 0:
        return m[i]
    total = 0.0
    for j in range(len(m)):
        total += kick.keep[i, j] * m[j]
    return total


@inlined
def linear(kick: Kick, force: np.ndarray, node: int, row: int, m: np.ndarray, out: np.ndarray) -> int:
    """Write the momenta after half an impulse of a step, from what the weight adds; return the outcome, zero."""
    at = min(row, len(kick.rows) - 1)
    for i in range(len(m)):
        out[i] = kept(kick, m, i) + (force[i] + kick.rows[at, i])
    return 0


@scalar
def seen(
    n: int, F: tuple[float, float, float], q0: float, q1: float, q2: float, q3: float
) -> tuple[float, float, float]:
    """Return R^T F at a compact pose, of a quaternion (3) or in the plane (2)."""
    x, y, z = F
    if n == 3:
        u1, u2, u3 = q2 * z - q3 * y, q3 * x - q1 * z, q1 * y - q2 * x
        return (
            x - 2 * (q0 * u1 - (q2 * u3 - q3 * u2)),
            y - 2 * (q0 * u2 - (q3 * u1 - q1 * u3)),
            z - 2 * (q0 * u3 - (q1 * u2 - q2 * u1)),
        )
    return q0 * x + q1 * y, q0 * y - q1 * x, 0.0
