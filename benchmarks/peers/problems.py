"""The two bodies that everything is compared on, a reference of 18 digits, and how times and errors are measured."""

import statistics
import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

import nonholo as nh

TOP = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
SLEIGH = nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5)


class State(NamedTuple):
    """Body velocities and poses (matrices of the group) at some times."""

    velocity: np.ndarray
    pose: np.ndarray


class Problem(NamedTuple):
    """A body, its start at the identity, the end of the run and the equations of motion as a quadratic form."""

    name: str
    system: nh.SuslovTop | nh.ChaplyginSleigh
    velocity: tuple[float, float, float]
    end: float
    quadratic: np.ndarray
    first: np.ndarray
    state: Callable[[np.ndarray], State]


def top_constants() -> tuple[np.ndarray, np.ndarray]:
    r"""Return B^{-1} and c of $B\,(\omega_2, -\omega_1)' = -(c\cdot\omega)\,(\omega_1, \omega_2)$."""
    J = TOP.mass_tensor
    return np.linalg.inv(J[:2, :2] + J[2, 2] * np.eye(2)), J[:2, 2]


def quaternion_matrix(q: np.ndarray) -> np.ndarray:
    """Return the rotation of a quaternion, scalar first, normalized first."""
    w, x, y, z = q / np.sqrt(np.sum(q * q))
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def planar_matrix(cosine: float, sine: float, x: float, y: float) -> np.ndarray:
    """Return a pose of the plane."""
    return np.array([[cosine, -sine, x], [sine, cosine, y], [0.0, 0.0, 1.0]])


def _top_state(z: np.ndarray) -> State:
    return State(np.array([z[0], z[1], 0]), quaternion_matrix(z[2:6]))


def _sleigh_state(z: np.ndarray) -> State:
    return State(np.array([z[0], z[1], 0]), planar_matrix(*z[2:6]))


def _top() -> Problem:
    """Return the top: z = (omega1, omega2, quaternion)."""
    inverse, c = top_constants()
    form, half = np.zeros((6, 6, 6), dtype=np.longdouble), np.longdouble(0.5)
    for i in range(2):
        for j in range(2):
            form[1, i, j] -= inverse[0, i] * c[j]
            form[0, i, j] += inverse[1, i] * c[j]
    for row, one, two, signs in ((2, 3, 4, (-1, -1)), (3, 2, 5, (1, -1)), (4, 5, 2, (1, 1)), (5, 4, 3, (-1, 1))):
        form[row, one, 0], form[row, two, 1] = signs[0] * half, signs[1] * half
    start = np.array([0.4, 0.9, 1, 0, 0, 0])
    return Problem("Suslov top", TOP, (0.4, 0.9, 0.0), 100.0, form, start, _top_state)


def _sleigh() -> Problem:
    """Return the sleigh: z = (omega, v, cos theta, sin theta, x, y)."""
    rate = SLEIGH.mass * SLEIGH.a / (SLEIGH.inertia + SLEIGH.mass * SLEIGH.a**2)
    form = np.zeros((6, 6, 6), dtype=np.longdouble)
    form[0, 0, 1], form[1, 0, 0] = -rate, SLEIGH.a
    form[2, 3, 0], form[3, 2, 0] = -1, 1
    form[4, 2, 1], form[5, 3, 1] = 1, 1
    start = np.array([1.0, -0.6, 1, 0, 0, 0])
    return Problem("Chaplygin sleigh", SLEIGH, (1.0, -0.6, 0.0), 20.0, form, start, _sleigh_state)


def reference(problem: Problem, end: float, step: float = 0.125, order: int = 34) -> State:
    """Return the state at the end by Taylor series in extended precision, independent of the library and of peers."""
    z, h = problem.first.astype(np.longdouble), np.longdouble(step)
    steps = round(end / step)
    assert steps * step == end
    for _ in range(steps):
        series = [z]
        for n in range(order):
            older = np.array(series)
            series.append(np.einsum("ijk,nj,nk->i", problem.quadratic, older, older[::-1]) / (n + 1))
        z = np.zeros_like(z)
        for term in reversed(series):
            z = z * h + term
    return problem.state(z)


def error(problem: Problem, result: State, wanted: State) -> float:
    """Return the largest difference in body velocity and pose."""
    assert result.pose.shape == wanted.pose.shape, problem.name
    return float(max(np.abs(result.velocity - wanted.velocity).max(), np.abs(result.pose - wanted.pose).max()))


def energy_error(problem: Problem, velocities: np.ndarray) -> float:
    """Return the largest relative change of energy."""
    energy = np.einsum("ka,ab,kb->k", velocities, problem.system.inertia_operator, velocities) / 2
    return float(np.abs(energy / energy[0] - 1).max())


def by_library(problem: Problem, time_step: float, steps: int, save_every: int = 1, order: int = 2) -> nh.Orbit:
    """Run the discrete map."""
    discrete = nh.discretize(problem.system, time_step, order=order)
    return nh.simulate(discrete, body_velocity=problem.velocity, steps=steps, save_every=save_every)


def last(orbit: nh.Orbit) -> State:
    """Return the last state of an orbit of the library."""
    return State(orbit.body_velocity[-1], orbit.configuration[-1])


def seconds(run: Callable[[], object]) -> float:
    """Return the wall time of a call."""
    begin = time.perf_counter()
    run()
    return time.perf_counter() - begin


def in_turns(runs: dict[str, Callable[[], object]], rounds: int) -> dict[str, list[float]]:
    """Return times of several runs, taken in turns so that a busy machine slows all of them."""
    times: dict[str, list[float]] = {name: [] for name in runs}
    for _ in range(rounds):
        for name, run in runs.items():
            times[name].append(seconds(run))
    return times


def median_ratio(above: list[float], below: list[float]) -> float:
    """Return the median of ratios of paired times."""
    return statistics.median(a / b for a, b in zip(above, below, strict=True))


PROBLEMS = (_top(), _sleigh())
