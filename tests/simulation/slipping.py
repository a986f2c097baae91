"""Rows that yield, from the definition: continuous equations, hold or slide, with stops where one becomes the other."""

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

import nonholo as nh

_RESTING = 1e-9  # a slip velocity that dry friction ends within about this time


class Continuous:
    """The body of a system with slip, in momenta p of the body frame and poses as matrices."""

    def __init__(self, forced: nh.Forced, force: Callable[..., np.ndarray] | None = None) -> None:
        inside, slip = forced.system, forced.slip
        assert slip is not None
        self.toward = np.zeros(len(slip.rows))
        self.group, self.inertia, self.force = inside.group, np.asarray(inside.inertia_operator), force
        self.rows, self.grip, self.viscous = slip.rows, float(slip.grip), float(slip.viscous)
        self.every = np.asarray(inside.annihilator)
        self.fixed = np.array([a for a in self.every if np.linalg.matrix_rank([*self.rows, a]) > len(self.rows)])
        self.potential_force = forced.potential_force

    def rate(self, omega: np.ndarray, g: np.ndarray, held: bool) -> tuple[np.ndarray, np.ndarray]:
        """Return the acceleration and the reactions in the rows, from d/dt (I omega) = ad* + f + sum lambda a."""
        p = self.inertia @ omega
        bent = np.array([p @ self.group.bracket(omega, x) for x in np.eye(self.group.dim)])
        bent = bent + self.potential_force(g) + (0.0 if self.force is None else self.force(g, omega))
        tied = self.every if held else self.fixed.reshape(-1, self.group.dim)
        if not held:
            bent = bent + self.rows.T @ self.friction(omega)
        n, m = self.group.dim, len(tied)
        matrix = np.block([[self.inertia, -tied.T], [tied, np.zeros((m, m))]])
        found = np.linalg.solve(matrix, np.append(bent, np.zeros(m)))
        return found[:n], np.linalg.lstsq(self.rows.T, tied.T @ found[n:], rcond=None)[0] if held else np.zeros(0)

    def friction(self, omega: np.ndarray) -> np.ndarray:
        """Return the forces of rows that slide; of those that have only begun along what they yield to."""
        v = self.rows @ omega
        one = len(v) == 1 or np.linalg.norm(v) < _RESTING  # of one row it is the same up to the next stop
        along = self.toward if one else v / np.linalg.norm(v)
        return -self.grip * along - self.viscous * v

    def run(self, omega: Any, time: float) -> tuple[np.ndarray, np.ndarray, list[str]]:
        """Return the velocity and the pose after a time, and how the rows were."""
        n, size, t, kinds = self.group.dim, self.group.size, 0.0, []
        state, held = np.append(np.asarray(omega, float), np.eye(size)), None
        while t < time:
            v = self.rows @ state[:n]
            if held is None:
                held = bool(np.linalg.norm(v) == 0)
            if held:
                _, reaction = self.rate(state[:n], state[n:].reshape(size, size), True)
                held = bool(np.linalg.norm(reaction) <= self.grip)
                if not held:
                    self.toward = -reaction / np.linalg.norm(reaction)
            if np.linalg.norm(v) >= _RESTING:
                self.toward = v / np.linalg.norm(v)
            kinds.append("hold" if held else "slide")
            t, state, held = self._stretch(t, time, state, held)
        return state[:n], state[n:].reshape(size, size), kinds

    def _stretch(self, t: float, time: float, state: np.ndarray, held: bool) -> tuple[float, np.ndarray, bool | None]:
        n, size = self.group.dim, self.group.size

        def field(_: float, y: np.ndarray) -> np.ndarray:
            g = y[n:].reshape(size, size)
            return np.append(self.rate(y[:n], g, held)[0], g @ self.group.hat(y[:n]))

        def yields(_: float, y: np.ndarray) -> float:
            return self.grip - float(np.linalg.norm(self.rate(y[:n], y[n:].reshape(size, size), True)[1]))

        def rests(_: float, y: np.ndarray) -> float:
            v = self.rows @ y[:n]
            return float(self.toward @ v if len(v) == 1 else np.linalg.norm(v)) - _RESTING

        stop: Any = yields if held else rests
        stop.terminal, stop.direction = True, -1
        found = solve_ivp(field, (t, time), state, "DOP853", rtol=1e-11, atol=1e-12, events=stop)
        after = found.y[:, -1].copy()
        if found.status != 1:
            return time, after, held
        if held:
            self.toward = -self.rate(after[:n], after[n:].reshape(size, size), True)[1] / self.grip
            return float(found.t[-1]), after, False
        v, dual = self.rows @ after[:n], self.inertia
        tied = np.concatenate([self.fixed.reshape(-1, n), self.rows])
        into = np.linalg.solve(dual, tied.T)
        jump = np.append(np.zeros(len(tied) - len(v)), v)
        after[:n] -= into @ np.linalg.solve(tied @ into, jump)
        return float(found.t[-1]), after, True


def space_body() -> nh.LLSystem:
    """Return a body on SE(3) with three rows, two of which are one contact."""
    tensor = nh.MultidimensionalSleigh(1.5, [0.4, 0.1, -0.2], np.diag([0.5, 0.7, 0.9])).homogeneous_mass_tensor
    rows = [[1.0, 0.0, 0.0, 0.0, 0.2, 0.0], [0.0, 0.0, 0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 0.0, 0.0, 1.0]]
    return nh.LLSystem(nh.SE(3), tensor, annihilator=rows)


def random_case(rng: np.random.Generator) -> tuple[nh.Forced, float, np.ndarray]:
    """Return a random body with random rows that may yield, a time step from 0.001 to 3, and a start that may slip."""
    group = (nh.SO(3), nh.SE(2), nh.SE(3), nh.SO(4))[rng.integers(4)]
    n, k = group.size, int(rng.integers(1, group.dim))
    A, rows = rng.normal(size=(n, n)), rng.normal(size=(group.dim - k, group.dim))
    system = nh.LLSystem(group, A @ A.T + 0.1 * np.eye(n), annihilator=rows)
    grip = (0.0, 10.0 ** rng.uniform(-12, 12), 10.0 ** rng.uniform(-2, 1), 10.0 ** rng.uniform(-2, 1), np.inf)
    viscous = (0.0, 10.0 ** rng.uniform(-3, 8), 10.0 ** rng.uniform(-2, 0))[rng.integers(3)]
    slip = nh.Slip(rows[: rng.integers(1, len(rows) + 1)], grip[rng.integers(5)], viscous)
    m = n - group.is_affine
    heavy = nh.Gravity(rng.normal(size=m), rng.normal(size=m)) if rng.integers(2) else None
    forced = nh.Forced(system, heavy, slip)
    velocity = rng.normal(size=forced.rank) * (rng.random(forced.rank) < 0.8)
    velocity[k:] *= rng.integers(2)
    return forced, float(10.0 ** rng.uniform(-3, 0.5)), velocity
