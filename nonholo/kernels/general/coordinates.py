"""The step in coordinates: Newton's method on equations that are compiled for each system, and the loop.

A system comes as three C functions, which read an array and write another one. `arrive` maps place, velocity and time
step to the next place x, the momentum p on arrival and its doubt; `settle` maps x, p, doubt, the velocity before and
the time step to all that stays the same during Newton's method there; `correct` maps that, a velocity and multipliers
to the equations: the scaled matrix, what the scaled equations miss, the units of velocities and of multipliers, the
size of velocities, and the doubt, which is 0 where the formulas may be trusted.

A root that is not certain is left to the caller: a root may count for more reasons.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from nonholo.base.compiled import njit
from nonholo.kernels._scalar import BORROWING
from nonholo.kernels._small import assign, eliminate

ITERATIONS = 12
TOLERANCE = 1e-10  # of the last correction, which is still applied: what is left is its square
CONTRACTION = 0.5
SINGULAR = 6e-8  # a few square roots of the rounding unit: no nearer to a fold can a computed root come


class CoordinateBody(NamedTuple):
    """A system in coordinates, with room for its equations: for one run at a time.

    Attributes:
        arrive: See the head of this file, and so are the next two.
        settle: What stays the same.
        correct: The equations.
        departure: What `arrive` reads.
        arrival: What `arrive` writes, and `settle` reads.
        constants: What `settle` writes; with the root what `correct` reads.
        root: Velocity and multipliers, a part of `constants`.
        equations: What `correct` writes.
        matrix: The scaled matrix, a part of `equations`.
        gap: What the scaled equations miss, a part of them.
        units: Units of the root, a part of them.
        solution: The correction, and the inverse of the matrix.
        place: Count of the numbers of a place.
        velocity: Count of the velocities.
    """

    arrive: Any
    settle: Any
    correct: Any
    departure: np.ndarray
    arrival: np.ndarray
    constants: np.ndarray
    root: np.ndarray
    equations: np.ndarray
    matrix: np.ndarray
    gap: np.ndarray
    units: np.ndarray
    solution: np.ndarray
    place: int
    velocity: int


@njit(**BORROWING)
def _settle(body: CoordinateBody, near: np.ndarray, before: np.ndarray) -> None:
    """Write what is settled at the place of arrival, and the guess."""
    n, first = body.velocity, body.place + body.velocity + 1
    assign(body.arrival[first : first + n], near)
    body.settle(body.arrival.ctypes, body.constants.ctypes)
    for i in range(len(body.root)):
        body.root[i] = 2 * near[i] - before[i] if i < n else 0.0


@njit(**BORROWING)
def _correct(body: CoordinateBody) -> tuple[float, float, float]:
    """Move the root by Newton's correction; return the determinant, 0 with a doubt, and squares.

    They are those of the correction of the velocity, in its unit, and of the inverse of the matrix.
    """
    n, size = body.velocity, len(body.root)
    body.correct(body.constants.ctypes, body.equations.ctypes)
    scale, doubt = body.equations[-2], body.equations[-1]
    for i in range(size):
        body.solution[i, 0] = body.gap[i]
        for j in range(size):
            body.solution[i, 1 + j] = 1.0 if i == j else 0.0
    det = eliminate(body.matrix, body.solution)
    square = inverse = 0.0
    for i in range(size):
        step = body.solution[i, 0]
        square += step * step if i < n else 0.0
        body.root[i] -= step * body.units[i] if i < n else step / body.units[i]
        for j in range(size):
            inverse += body.solution[i, 1 + j] * body.solution[i, 1 + j]
    return det if doubt == 0 else 0.0, square / (scale * scale) if square > 0 else square, inverse


@njit(**BORROWING)
def newton(body: CoordinateBody, sign: float) -> float:
    """Improve the root; return the sign of the determinant, which is the given one unless that is 0; 0 without trust.

    A root is trusted if corrections shrink, the determinant keeps its sign, the matrix is regular, without a doubt.
    """
    before = math.inf
    for _ in range(ITERATIONS):
        det, square, inverse = _correct(body)
        sign = sign if sign != 0 else 1.0 if det > 0 else -1.0
        if square <= TOLERANCE * TOLERANCE:
            return sign if det * sign > 0 and inverse * SINGULAR * SINGULAR <= 1 else 0.0
        if not (abs(det) > 0 and square <= CONTRACTION * CONTRACTION * before):
            return 0.0
        before = square
    return 0.0


@njit(nogil=True, **BORROWING)
def set_out_coordinates(body: CoordinateBody, x: np.ndarray, p: np.ndarray, v: np.ndarray) -> float:
    """Find the root of a momentum next to a velocity; return the sign of the determinant there, 0 without trust."""
    assign(body.arrival, x)
    assign(body.arrival[body.place :], p)
    body.arrival[body.place + body.velocity] = 0.0
    _settle(body, v, v)
    return newton(body, 0.0)


@njit(nogil=True, **BORROWING)
def advance_coordinates(
    body: CoordinateBody,
    state: np.ndarray,
    sign: float,
    first: int,
    last: int,
    every: int,
    places: np.ndarray,
    velocities: np.ndarray,
    impulses: np.ndarray,
) -> int:
    """Run steps; return how many are done: all, or those before one without trust.

    Args:
        body: The system.
        state: Place, velocity and the velocity before, which are replaced.
        sign: The orientation to keep.
        first: How many steps are done already.
        last: How many are to be done in total.
        every: Steps of a row.
        places: Table of the states at the beginning of a row, to be filled.
        velocities: Their velocities.
        impulses: Those of the first step of each row.
    """
    m, n = body.place, body.velocity
    v, before = state[m : m + n], state[m + n :]
    for k in range(first, last):
        if k % every == 0:
            assign(places[k // every], state[:m])
            assign(velocities[k // every], v)
        assign(body.departure, state[: m + n])
        body.arrive(body.departure.ctypes, body.arrival.ctypes)
        _settle(body, v, before)
        if newton(body, sign) == 0:
            return k
        if k % every == 0:
            assign(impulses[k // every], body.root[n:])
        assign(state, body.arrival[:m])
        assign(before, v)
        assign(v, body.root[:n])
    return last


@njit(nogil=True, **BORROWING)
def each_root(body: CoordinateBody, places: np.ndarray, velocities: np.ndarray, roots: np.ndarray) -> bool:
    """Write the velocities of the roots next to those on arrival, row by row; return whether all can be trusted."""
    for i in range(len(places)):
        assign(body.departure, places[i])
        assign(body.departure[body.place :], velocities[i])
        body.arrive(body.departure.ctypes, body.arrival.ctypes)
        _settle(body, velocities[i], velocities[i])
        if newton(body, 0.0) == 0:
            return False
        assign(roots[i], body.root[: body.velocity])
    return True


@njit(nogil=True, **BORROWING)
def each_row(function: Any, rows: np.ndarray, values: np.ndarray) -> None:
    """Write the values of a C function for each row."""
    for i in range(len(rows)):
        function(rows[i].ctypes, values[i].ctypes)
