"""Half an impulse that is linear in the momenta: friction, a force that is fixed in space, rows of a table."""

from typing import Any, NamedTuple

import numpy as np

from nonholo.kernels._interface import Body, inertia
from nonholo.kernels._scalar import inlined, scalar

_TERMS = 14  # of a series at norm 1/2
_DOUBLINGS = 1100  # more than any finite number needs


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


@scalar
def _times(A: Any, B: Any) -> tuple[float, float, float, float]:
    """Return A B of matrices with two rows."""
    first, second = A[0] * B[0] + A[1] * B[2], A[0] * B[1] + A[1] * B[3]
    return first, second, A[2] * B[0] + A[3] * B[2], A[2] * B[1] + A[3] * B[3]


@scalar
def _plus(A: Any, a: float, B: Any) -> tuple[float, float, float, float]:
    """Return A + a B."""
    return A[0] + a * B[0], A[1] + a * B[1], A[2] + a * B[2], A[3] + a * B[3]


@scalar
def rubbed(p: Body, C: Any, time: float) -> tuple[Any, Any]:
    r"""Return A and V of friction $\dot r = a - Dr$ with two momenta over a time: $r' = Ar + Va$; $D = CB^{-1}$.

    $$ V(t) = \int_0^t e^{-sD}ds, \qquad A(t) = I + E(t), \qquad V(2t) = 2V + EV, \qquad E(2t) = 2E + EE : $$

    the series of a part of the time, which is doubled, by sums and products alone, as every processor has them.
    """
    b11, b12, b22 = inertia(p)
    one, none, lean = (1.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0, 0.0), b12 / b11
    second, fourth = (C[1] - C[0] * lean) / (b22 - b12 * lean), (C[3] - C[2] * lean) / (b22 - b12 * lean)
    D = (C[0] - second * b12) / b11, second, (C[2] - fourth * b12) / b11, fourth
    X, doublings = _plus(none, -time, D), 0
    while doublings < _DOUBLINGS and abs(X[0]) + abs(X[1]) + abs(X[2]) + abs(X[3]) > 0.5:
        X, time, doublings = _plus(none, 0.5, X), time / 2, doublings + 1
    phi = one
    for k in range(_TERMS, 1, -1):
        phi = _plus(one, 1 / k, _times(X, phi))
    E, V = _times(X, phi), _plus(none, time, phi)
    for _ in range(doublings):
        V, E = _plus(_times(E, V), 2.0, V), _plus(_times(E, E), 2.0, E)
    return _plus(one, 1.0, E), V
