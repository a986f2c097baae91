"""The midpoint retraction of `schemes.py` for the top, by hand for numba, as one writes it who counts nanoseconds."""

import numba
import numpy as np

from peers.problems import Problem, top_constants


@numba.njit(cache=True)
def _run(inverse: np.ndarray, c: np.ndarray, h: float, steps: int, velocities: np.ndarray, poses: np.ndarray) -> None:
    a11, a12, a22 = inverse[0, 0], inverse[0, 1], inverse[1, 1]
    w1, w2 = velocities[0, 0], velocities[0, 1]
    q0, q1, q2, q3 = 1.0, 0.0, 0.0, 0.0
    k = h / 2
    for n in range(steps):
        poses[n, 0], poses[n, 1], poses[n, 2], poses[n, 3] = q0, q1, q2, q3
        velocities[n, 0], velocities[n, 1] = w1, w2
        x1, x2 = w1, w2  # velocity (omega1, omega2) in the middle of the step
        for _ in range(8):
            s = c[0] * x1 + c[1] * x2
            u1, u2 = a12 * x1 + a22 * x2, -(a11 * x1 + a12 * x2)
            f1, f2 = x1 - w1 - k * s * u1, x2 - w2 - k * s * u2
            j11, j12 = 1 - k * (c[0] * u1 + s * a12), -k * (c[1] * u1 + s * a22)
            j21, j22 = -k * (c[0] * u2 - s * a11), 1 - k * (c[1] * u2 - s * a12)
            det = j11 * j22 - j12 * j21
            d1, d2 = (j12 * f2 - j22 * f1) / det, (j21 * f1 - j11 * f2) / det
            x1 += d1
            x2 += d2
            if d1 * d1 + d2 * d2 <= 1e-18 * (x1 * x1 + x2 * x2):
                break
        w1, w2 = 2 * x1 - w1, 2 * x2 - w2
        t1, t2 = k * x1, k * x2
        unit = 1 / np.sqrt(1 + t1 * t1 + t2 * t2)
        q0, q1, q2, q3 = (
            (q0 - q1 * t1 - q2 * t2) * unit,
            (q1 + q0 * t1 - q3 * t2) * unit,
            (q2 + q0 * t2 + q3 * t1) * unit,
            (q3 + q1 * t2 - q2 * t1) * unit,
        )
    poses[steps, 0], poses[steps, 1], poses[steps, 2], poses[steps, 3] = q0, q1, q2, q3
    velocities[steps, 0], velocities[steps, 1] = w1, w2


def compiled_midpoint(problem: Problem, h: float, steps: int) -> tuple[np.ndarray, np.ndarray]:
    """Return body velocities and quaternions of all steps."""
    velocities, poses = np.zeros((steps + 1, 3)), np.empty((steps + 1, 4))
    velocities[0] = problem.velocity
    inverse, c = top_constants()
    _run(inverse, c, h, steps, velocities, poses)
    return velocities, poses
