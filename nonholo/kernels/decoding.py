r"""Reading the rows of bodies with two admissible directions on SO(3) and SE(2), in the user's frame.

One formula serves both groups: their motions are those of a surface of curvature $\kappa$, 1 of the sphere, 0 of the
plane. The displacement with chart coordinates y is the Cayley image of $2x$, $x = Ay$. With $p = \mathbb{I}x$,
$\tau = x_1^2 + \kappa(x_2^2 + x_3^2)$ and $x \times_\kappa p = -\mathrm{ad}^*_x p$ its momenta, of the difference
"matrix", are

$$ P = \tfrac{2}{h(1 + \tau)}(p + x \times_\kappa p), \qquad
   \mathrm{Ad}^*_W P = \tfrac{2}{h(1 + \tau)}(p - x \times_\kappa p). $$
"""

from typing import Any, NamedTuple

import numpy as np

from nonholo.base.compiled import njit
from nonholo.kernels._scalar import COMPILED, scalar, sqrt

Triple = tuple[float, float, float]
Six = tuple[float, float, float, float, float, float]


class Reading(NamedTuple):
    """The numbers of a body that its rows are read with; matrices row by row.

    Attributes:
        curvature: Of the surface that it moves.
        arms: A, (3, 2): body velocities of the canonical rows of the constraint subspace.
        pulls: The inertia operator times A.
        rows: S, (2, 3): the constraint subspace.
        across: The row that takes a force of constraint to its multiplier.
        back: The inverse of the canonical frame as seen from the user's, (3, 3).
        factors: l, d1 and d2 of the inertia along the canonical rows: its `factors_of`.
        is_turned: Whether the canonical frame is another one than the user's.
    """

    curvature: float
    arms: Six
    pulls: Six
    rows: Six
    across: Triple
    back: tuple[float, ...]
    factors: Triple
    is_turned: bool


def read(loop: Any, numbers: Reading, columns: tuple[np.ndarray, ...], shape: tuple[int, ...], *others: float) -> Any:
    """Return what a loop makes of each row of columns."""
    rows = [np.require(each, np.float64, ["C", "W"]) for each in columns]  # else numba compiles once more
    out = np.empty((len(rows[0]), *shape))
    loop(numbers, *rows, *others, out)
    return out


@scalar
def _times(m: Six, y1: float, y2: float) -> Triple:
    return m[0] * y1 + m[1] * y2, m[2] * y1 + m[3] * y2, m[4] * y1 + m[5] * y2


@scalar
def _bent(k: float, term: float) -> float:
    """Return a term that there is on the sphere alone; on the plane it may overflow."""
    return term if k != 0 else 0.0


@scalar
def _cross(k: float, x: Triple, p: Triple) -> Triple:
    """Return minus ad*_x p."""
    return x[1] * p[2] - x[2] * p[1], _bent(k, x[2] * p[0]) - x[0] * p[2], x[0] * p[1] - _bent(k, x[1] * p[0])


@scalar
def _dot(k: float, x: Triple, y: Triple) -> float:
    """Return the product of which tau is the square."""
    return x[0] * y[0] + _bent(k, x[1] * y[1] + x[2] * y[2])


@scalar
def _along(rows: Six, p: Triple) -> tuple[float, float]:
    return rows[0] * p[0] + rows[1] * p[1] + rows[2] * p[2], rows[3] * p[0] + rows[4] * p[1] + rows[5] * p[2]


@scalar
def _momentum(b: Reading, y1: float, y2: float, side: float) -> Triple:
    """Return h times the momentum of a displacement, on the left (side 1) or on the right (-1)."""
    x, p = _times(b.arms, y1, y2), _times(b.pulls, y1, y2)
    q, unit = _cross(b.curvature, x, p), 2 / (1 + _dot(b.curvature, x, x))
    return (p[0] + side * q[0]) * unit, (p[1] + side * q[1]) * unit, (p[2] + side * q[2]) * unit


@scalar
def _velocity(b: Reading, r1: float, r2: float) -> tuple[float, float]:
    """Return the velocity along the canonical rows, by substitution."""
    second = (b.factors[0] * r1 + r2) / b.factors[2]
    return r1 / b.factors[1] + b.factors[0] * second, second


@njit(nogil=True, **COMPILED)
def write_velocities(b: Reading, momenta: np.ndarray, out: np.ndarray) -> None:
    """Write the body velocities of canonical momenta."""
    for i in range(len(out)):
        w1, w2 = _velocity(b, momenta[i, 0], momenta[i, 1])
        out[i, 0], out[i, 1], out[i, 2] = _times(b.arms, w1, w2)


@njit(nogil=True, **COMPILED)
def write_energies(b: Reading, momenta: np.ndarray, out: np.ndarray) -> None:
    """Write the energies of canonical momenta."""
    for i in range(len(out)):
        w1, w2 = _velocity(b, momenta[i, 0], momenta[i, 1])
        out[i] = (momenta[i, 0] * w1 + momenta[i, 1] * w2) / 2


@njit(nogil=True, **COMPILED)
def write_momenta(b: Reading, charts: np.ndarray, side: float, time_step: float, out: np.ndarray) -> None:
    """Write the momenta of displacements."""
    for i in range(len(out)):
        p = _momentum(b, charts[i, 0], charts[i, 1], side)
        out[i, 0], out[i, 1], out[i, 2] = p[0] / time_step, p[1] / time_step, p[2] / time_step


@njit(nogil=True, **COMPILED)
def write_multipliers(b: Reading, charts: np.ndarray, following: np.ndarray, time_step: float, out: np.ndarray) -> None:
    """Write the impulses between displacements and those that follow."""
    for i in range(len(out)):
        p, q = _momentum(b, charts[i, 0], charts[i, 1], -1.0), _momentum(b, following[i, 0], following[i, 1], 1.0)
        d1, d2, d3 = (q[0] - p[0]) / time_step, (q[1] - p[1]) / time_step, (q[2] - p[2]) / time_step
        out[i, 0] = b.across[0] * d1 + b.across[1] * d2 + b.across[2] * d3


@njit(nogil=True, **COMPILED)
def write_displacements(b: Reading, charts: np.ndarray, out: np.ndarray) -> None:
    """Write the matrices of displacements: I + 2 (Y + Y^2) / (1 + tau)."""
    k = b.curvature
    for i in range(len(out)):
        x = _times(b.arms, charts[i, 0], charts[i, 1])
        unit = 2 / (1 + _dot(k, x, x))
        t, x1, x2 = x if k == 0 else (x[2], x[1], -x[0])  # of SO(3) the axes of the plane x3 = 1
        out[i, 0, 0], out[i, 0, 1] = 1 - unit * (t * t + _bent(k, x1 * x1)), unit * (-t - _bent(k, x1 * x2))
        out[i, 1, 0], out[i, 1, 1] = unit * (t - _bent(k, x1 * x2)), 1 - unit * (t * t + _bent(k, x2 * x2))
        out[i, 0, 2], out[i, 1, 2] = unit * (x1 - t * x2), unit * (x2 + t * x1)
        out[i, 2, 0], out[i, 2, 1], out[i, 2, 2] = 0.0, 0.0, 1.0
        if k != 0:
            out[i, 2, 0], out[i, 2, 1] = unit * (-x1 - t * x2), unit * (t * x1 - x2)
            out[i, 2, 2] = 1 - unit * (x1 * x1 + x2 * x2)


@scalar
def _slopes(b: Reading, x: Triple, p: Triple, j: int) -> tuple[float, float, float, float]:
    """Return the even and the odd part of h (1 + tau) / 2 times the derivative of momenta along S by y_j."""
    a, c = (b.arms[j], b.arms[2 + j], b.arms[4 + j]), (b.pulls[j], b.pulls[2 + j], b.pulls[4 + j])
    k = b.curvature
    rate = 2 * _dot(k, x, a) / (1 + _dot(k, x, x))
    f, g, q = _cross(k, x, c), _cross(k, a, p), _cross(k, x, p)
    e1, e2 = _along(b.rows, (c[0] - rate * p[0], c[1] - rate * p[1], c[2] - rate * p[2]))
    o1, o2 = _along(b.rows, (f[0] + g[0] - rate * q[0], f[1] + g[1] - rate * q[1], f[2] + g[2] - rate * q[2]))
    return e1, e2, o1, o2


@njit(nogil=True, **COMPILED)
def write_tangents(b: Reading, charts: np.ndarray, out: np.ndarray) -> None:
    """Write the derivatives of momenta along S after steps by those before: (E - O) (E + O)^-1, even and odd parts."""
    for i in range(len(out)):
        x, p = _times(b.arms, charts[i, 0], charts[i, 1]), _times(b.pulls, charts[i, 0], charts[i, 1])
        e11, e21, o11, o21 = _slopes(b, x, p, 0)
        e12, e22, o12, o22 = _slopes(b, x, p, 1)
        b11, b12, b21, b22 = e11 + o11, e12 + o12, e21 + o21, e22 + o22
        a11, a12, a21, a22 = e11 - o11, e12 - o12, e21 - o21, e22 - o22
        det = b11 * b22 - b12 * b21
        out[i, 0, 0], out[i, 0, 1] = (a11 * b22 - a12 * b21) / det, (a12 * b11 - a11 * b12) / det
        out[i, 1, 0], out[i, 1, 1] = (a21 * b22 - a22 * b21) / det, (a22 * b11 - a21 * b12) / det


@scalar
def _rotation(w: float, x: float, y: float, z: float) -> tuple[Triple, Triple, Triple]:
    length = sqrt(w * w + x * x + y * y + z * z)
    w, x, y, z = w / length, x / length, y / length, z / length
    first = (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y))
    second = (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x))
    return first, second, (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y))


@scalar
def _motion(cos: float, sin: float, x: float, y: float) -> tuple[Triple, Triple, Triple]:
    length = sqrt(cos * cos + sin * sin)
    return (cos / length, -sin / length, x), (sin / length, cos / length, y), (0.0, 0.0, 1.0)


@njit(nogil=True, **COMPILED)
def write_matrices(b: Reading, poses: np.ndarray, out: np.ndarray) -> None:
    """Write the matrices, in the user's frame, of compact canonical poses."""
    for i in range(len(out)):
        q0, q1, q2, q3 = poses[i, 0], poses[i, 1], poses[i, 2], poses[i, 3]
        g = _motion(q0, q1, q2, q3) if b.curvature == 0 else _rotation(q0, q1, q2, q3)
        for r in range(3):
            row = g[r]
            if not b.is_turned:
                out[i, r, 0], out[i, r, 1], out[i, r, 2] = row
            else:
                for c in range(3):
                    out[i, r, c] = row[0] * b.back[c] + row[1] * b.back[3 + c] + row[2] * b.back[6 + c]


@njit(nogil=True, **COMPILED)
def write_positions(b: Reading, poses: np.ndarray, out: np.ndarray) -> None:
    """Write the positions in the plane of compact canonical poses: the last columns of their matrices."""
    for i in range(len(out)):
        first, second, _ = _motion(poses[i, 0], poses[i, 1], poses[i, 2], poses[i, 3])
        x, y = b.back[2], b.back[5]
        out[i, 0], out[i, 1] = first[0] * x + first[1] * y + first[2], second[0] * x + second[1] * y + second[2]
