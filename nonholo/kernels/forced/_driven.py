r"""Half impulses of functions: a force by the midpoint rule, a potential by differences.

At a node with pose g the momenta m of a kernel go to

$$ m' = A\,m + r_k + N\,(-dU(g) + f(t, g, V(m + m')/2)), $$

with the body velocity V m, the momenta N j of impulses j, and what friction leaves, A m. Poses and covectors are those
of the user's frame.
Functions are addresses in compiled code, so that one loop serves all of them, and Python functions in plain Python,
whose loop is the same.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from nonholo.kernels._scalar import function_at, inlining, scalar
from nonholo.kernels._small import assign, eliminate, multiply
from nonholo.kernels.forced._kick import Kick, after_friction, linear, pulled_by_weight, to_body

_ITERATIONS = 30  # of Newton's method with one slope
_MOST, _SHORTEST = 100, 1e-12  # with new slopes; part of a correction
_ROUNDING = 1e-12  # relative, before the last correction
_DIFFERENCE = 1e-7  # relative, of a momentum


class Drive(NamedTuple):
    """Half an impulse of functions.

    Attributes:
        kick: What is linear in the momenta; its weight is for poses of the user's frame.
        planar: 2 or 3 where poses of the kernel are headings or quaternions, 0 where they are matrices.
        turn: T, the pose of the user is that of the kernel times T, (N, N).
        velocity: V, (dim, k).
        along: N, (k, dim).
        moves: Displacements to and fro for differences of U, (dim, orders, 2, N, N).
        weights: Weights of the differences, (orders,).
        time_step: h.
        has: Whether there is a force, and whether there is a potential.
        force: Writes f to its last argument, of (time, pose, body velocity, f).
        potential: Writes U to the first number of its last argument, of the same arguments.
    """

    is_python = property(lambda self: callable(self.force))
    kick: Kick
    planar: int
    turn: np.ndarray
    velocity: np.ndarray
    along: np.ndarray
    moves: np.ndarray
    weights: np.ndarray
    time_step: float
    has: tuple[bool, bool]
    force: Any
    potential: Any


class DriveRoom(NamedTuple):
    """What a half impulse writes to.

    Attributes:
        force: The momenta of what does not depend on velocities, (k,).
        poses: The user's pose and another matrix, (2, N, N).
        rows: The same numbers, (2, N N).
        covectors: A body velocity, what a function writes, and -dU, (3, dim).
        momenta: Momenta on the way, (5, k).
        gap: What they lack, a column, (k, 1).
        slopes: The slope of the midpoint rule, and one to be destroyed, (2, k, k).
    """

    force: np.ndarray
    poses: np.ndarray
    rows: np.ndarray
    covectors: np.ndarray
    momenta: np.ndarray
    gap: np.ndarray
    slopes: np.ndarray


@scalar
def room_for_drive(drive: Drive) -> DriveRoom:
    """Return room for the half impulses of one run."""
    (k, dim), n = drive.along.shape, len(drive.turn)
    poses = np.zeros((2, n, n))
    rows = poses.reshape(2, n * n)
    return DriveRoom(
        np.zeros(k), poses, rows, np.zeros((3, dim)), np.zeros((5, k)), np.zeros((k, 1)), np.zeros((2, k, k))
    )


@inlining
def place(drive: Drive, room: DriveRoom, pose: np.ndarray) -> None:
    """Write the user's pose from that of the kernel."""
    P, n = room.poses[1], drive.planar
    if n == 0:
        assign(room.rows[1], pose)
    else:
        q0, q1, q2, q3 = pose[0], pose[1], pose[2], pose[3]
        P[0, 0], P[0, 1], P[0, 2] = to_body(n, (1.0, 0.0, 0.0), q0, q1, q2, q3)
        P[1, 0], P[1, 1], P[1, 2] = to_body(n, (0.0, 1.0, 0.0), q0, q1, q2, q3)
        P[2, 0], P[2, 1], P[2, 2] = to_body(n, (0.0, 0.0, 1.0), q0, q1, q2, q3)
        if n == 2:
            P[0, 2], P[1, 2], P[2, 0], P[2, 1], P[2, 2] = q2, q3, 0.0, 0.0, 1.0
    multiply(P, drive.turn, room.poses[0])


@inlining
def pulled_by_functions(drive: Drive, room: DriveRoom, pose: np.ndarray) -> None:
    """Write what the weight and the potential add to momenta at a pose."""
    place(drive, room, pose)
    g, other, force = room.poses[0], room.poses[1], room.force
    pulled_by_weight(drive.kick, force, room.rows[0])
    if not drive.has[1]:
        return
    value, slope = room.covectors[1], room.covectors[2]
    for i in range(len(slope)):
        slope[i] = 0.0
        for j in range(len(drive.weights)):
            for k in range(2):
                multiply(g, drive.moves[i, j, k], other)
                function_at(drive.potential, 0.0, other, room.covectors[0], value)
                slope[i] += (2 * k - 1) * drive.weights[j] * value[0]
    for i in range(len(force)):
        for j in range(len(slope)):
            force[i] += drive.along[i, j] * slope[j]


@inlining
def pushed_by_function(
    drive: Drive, room: DriveRoom, when: tuple[float, int], m: np.ndarray, after: np.ndarray, out: np.ndarray
) -> None:
    """Write what the force at the velocity of the mean of two momenta, and all else, add to what friction leaves.

    A time and a row of the table say when.
    """
    velocity, value = room.covectors[0], room.covectors[1]
    for i in range(len(velocity)):
        velocity[i] = 0.0
        for j in range(len(m)):
            velocity[i] += drive.velocity[i, j] * ((m[j] + after[j]) / 2)
    function_at(drive.force, when[0], room.poses[0], velocity, value)
    for i in range(len(m)):
        out[i] = room.force[i] + drive.kick.rows[when[1], i]
        for j in range(len(value)):
            out[i] += drive.along[i, j] * value[j]


@inlining
def largest(a: np.ndarray, b: np.ndarray) -> float:
    """Return the largest size of the numbers of two rows; NaN or infinity if there is one among them."""
    total = 0.0
    for i in range(len(a)):
        for x in (abs(a[i]), abs(b[i])):
            total = x if not x <= total else total
    return total


@inlining
def drive_momenta(drive: Drive, room: DriveRoom, node: int, row: int, m: np.ndarray, out: np.ndarray) -> int:
    """Write the momenta after half an impulse; return the outcome: 7 if it is not found, 5 if it is not finite.

    A force that does not depend on the velocity is asked twice: then the momenta are explicit.
    """
    if not drive.has[0]:
        return linear(drive.kick, room.force, node, row, m, out)
    first, second = room.momenta[0], room.momenta[1]
    when = node * drive.time_step, min(row, len(drive.kick.rows) - 1)
    pushed_by_function(drive, room, when, m, m, first)
    for i in range(len(m)):
        out[i] = after_friction(drive.kick, m, i) + first[i]
    if not largest(out, out) < math.inf:
        return 5
    code = 0
    for again in range(2):
        if again:
            assign(out, m)
        pushed_by_function(drive, room, when, m, out, second)
        same = not again
        for i in range(len(m)):
            same = same and first[i] == second[i]
        code = 0 if same else midpoint(drive, room, when, m, out, again == 1)
        if code == 0:
            break
    return code


@inlining
def see_slopes(drive: Drive, room: DriveRoom, when: tuple[float, int], m: np.ndarray, out: np.ndarray) -> None:
    """Write the slopes of m' - A m - j((m + m') / 2), by differences from the second impulse on the way."""
    first, second, third, slopes = room.momenta[0], room.momenta[1], room.momenta[2], room.slopes[0]
    size = largest(m, first)
    size = _DIFFERENCE * (size if size > 0 else 1.0)
    for j in range(len(m)):
        before = out[j]
        out[j] = before + size
        pushed_by_function(drive, room, when, m, out, third)
        for i in range(len(m)):
            slopes[i, j] = (1.0 if i == j else 0.0) - (third[i] - second[i]) / size
        out[j] = before


@inlining
def midpoint(
    drive: Drive, room: DriveRoom, when: tuple[float, int], m: np.ndarray, out: np.ndarray, is_new: bool
) -> int:
    """Solve m' = A m + j((m + m') / 2) by Newton's method; return the outcome.

    It has one slope, from the explicit momenta and their impulse; or new slopes, from what stands there, and halves
    corrections until less is missed than before. Those lead to the root that a half impulse over a growing time comes
    to, unless it has met another one.
    """
    origin, change, matrix = room.momenta[3], room.momenta[4], room.slopes[1]
    left = gap(drive, room, m, out)
    for step in range(_MOST if is_new else _ITERATIONS):
        if step == 0 or is_new:
            see_slopes(drive, room, when, m, out)
        if not left < math.inf:
            return 5
        assign(matrix.reshape(-1), room.slopes[0].reshape(-1))
        small = left <= _ROUNDING * largest(m, out)
        if eliminate(matrix, room.gap) == 0:
            return 7
        assign(origin, out)
        assign(change, room.gap[:, 0])
        add_part(out, origin, 1.0, change)
        if small:
            return 0
        before = left
        left = shorten(drive, room, when, m, out, before, is_new)
        if is_new and not left < before:
            return 7
    return 7


@inlining
def shorten(
    drive: Drive, room: DriveRoom, when: tuple[float, int], m: np.ndarray, out: np.ndarray, before: float, is_new: bool
) -> float:
    """Return what momenta miss after a correction; if slopes are renewed, it is halved until they miss less."""
    part = 1.0
    while True:
        pushed_by_function(drive, room, when, m, out, room.momenta[1])
        left = gap(drive, room, m, out)
        if left < before or not is_new or part <= _SHORTEST:
            break
        part /= 2
        add_part(out, room.momenta[3], part, room.momenta[4])
    return left


@inlining
def add_part(out: np.ndarray, origin: np.ndarray, part: float, change: np.ndarray) -> None:
    """Write momenta with a part of a correction."""
    for i in range(len(out)):
        out[i] = origin[i] + part * change[i]


@inlining
def gap(drive: Drive, room: DriveRoom, m: np.ndarray, out: np.ndarray) -> float:
    """Write what momenta miss whose impulse stands in the room; return the largest of it."""
    for i in range(len(m)):
        room.gap[i, 0] = after_friction(drive.kick, m, i) + room.momenta[1, i] - out[i]
    return largest(room.gap[:, 0], room.gap[:, 0])
