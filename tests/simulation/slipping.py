"""Rows that yield, from the definition: continuous equations, hold or slide, with stops where one becomes the other."""

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

import nonholo as nh

_RESTING = 1e-9  # a slip velocity that dry friction ends within about this time


class Continuous:
    """The body of a system with slips, in momenta p of the body frame and poses as matrices."""

    def __init__(self, forced: nh.Forced, force: Callable[..., np.ndarray] | None = None) -> None:
        inside, self.slips, n = forced.system, forced.slips, forced.group.dim
        self.toward = [np.zeros(len(slip.rows)) for slip in self.slips]
        self.group, self.inertia, self.force = inside.group, np.asarray(inside.inertia_operator), force
        rows = np.concatenate([slip.rows for slip in self.slips])
        fixed = [a for a in np.asarray(inside.annihilator) if np.linalg.matrix_rank([*rows, a]) > len(rows)]
        self.fixed, self.potential_force = np.reshape(fixed, (-1, n)), forced.potential_force

    def tied(self, resting: list[bool]) -> np.ndarray:
        """Return the rows that hold."""
        return np.concatenate(
            [self.fixed, *(slip.rows for slip, rests in zip(self.slips, resting, strict=True) if rests)]
        )

    def rate(self, omega: np.ndarray, g: np.ndarray, resting: list[bool]) -> tuple[np.ndarray, list[np.ndarray]]:
        """Return the acceleration and the forces of all contacts, from d/dt (I omega) = ad* + f + sum lambda a."""
        p = self.inertia @ omega
        bent = np.array([p @ self.group.bracket(omega, x) for x in np.eye(self.group.dim)])
        bent = bent + self.potential_force(g) + (0.0 if self.force is None else self.force(g, omega))
        forces = [self.friction(i, omega) for i in range(len(resting))]
        for slip, force, rests in zip(self.slips, forces, resting, strict=True):
            bent = bent + (0.0 if rests else slip.rows.T @ force)
        n, tied = self.group.dim, self.tied(resting)
        matrix = np.block([[self.inertia, -tied.T], [tied, np.zeros((len(tied),) * 2)]])
        solution, at = np.linalg.solve(matrix, np.append(bent, np.zeros(len(tied)))), n + len(self.fixed)
        for i in np.flatnonzero(resting):
            forces[i] = solution[at : at + len(forces[i])]
            at += len(forces[i])
        return solution[:n], forces

    def friction(self, i: int, omega: np.ndarray) -> np.ndarray:
        """Return the force of a contact that slides; of one that has only begun along what it yields to."""
        slip = self.slips[i]
        v = slip.rows @ omega
        one = len(v) == 1 or np.linalg.norm(v) < _RESTING  # of one row it is the same up to the next stop
        along = self.toward[i] if one else v / np.linalg.norm(v)
        return -slip.grip * along - slip.viscous * v

    def parts(self, state: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the velocity and the pose of a state."""
        n, size = self.group.dim, self.group.size
        return state[:n], state[n:].reshape(size, size)

    def run(self, omega: Any, time: float) -> tuple[np.ndarray, np.ndarray, list[str]]:
        """Return the velocity and the pose after a time, and how the contacts were."""
        t, kinds = 0.0, []
        state = np.append(np.asarray(omega, float), np.eye(self.group.size))
        resting = [float(np.linalg.norm(slip.rows @ omega)) < _RESTING for slip in self.slips]
        while t < time:
            self._settle(state, resting)
            kinds.append(" ".join("hold" if rests else "slide" for rests in resting))
            t, state = self._stretch(t, time, state, resting)
        return *self.parts(state), kinds

    def _settle(self, state: np.ndarray, resting: list[bool]) -> None:
        """Let contacts yield whose reactions are beyond their grips, the worst one first; note where slips go."""
        for i, slip in enumerate(self.slips):
            v = slip.rows @ self.parts(state)[0]
            if np.linalg.norm(v) >= _RESTING:
                self.toward[i] = v / np.linalg.norm(v)
        while True:
            _, forces = self.rate(*self.parts(state), resting)
            sizes = zip(resting, forces, self.slips, strict=True)
            over = [rests * (np.linalg.norm(force) - slip.grip) for rests, force, slip in sizes]
            worst = int(np.argmax(over))
            if over[worst] <= 0:
                return
            self._release(worst, forces[worst], resting)

    def _release(self, i: int, force: np.ndarray, resting: list[bool]) -> None:
        """Let a contact yield against the force that held it."""
        resting[i], self.toward[i] = False, -force / np.linalg.norm(force)

    def _stretch(self, t: float, time: float, state: np.ndarray, resting: list[bool]) -> tuple[float, np.ndarray]:
        """Move on until a contact changes, which is changed then."""

        def field(_: float, state: np.ndarray) -> np.ndarray:
            omega, g = self.parts(state)
            return np.append(self.rate(omega, g, resting)[0], g @ self.group.hat(omega))

        def change_of(i: int) -> Any:
            def left(_: float, state: np.ndarray) -> float:
                """Return how far it is to the change."""
                omega, g = self.parts(state)
                if resting[i]:
                    return self.slips[i].grip - float(np.linalg.norm(self.rate(omega, g, resting)[1][i]))
                v = self.slips[i].rows @ omega
                return float(self.toward[i] @ v if len(v) == 1 else np.linalg.norm(v)) - _RESTING

            stop: Any = left
            stop.terminal, stop.direction = True, -1
            return stop

        stops = [change_of(i) for i in range(len(resting))]
        path = solve_ivp(field, (t, time), state, "DOP853", rtol=1e-11, atol=1e-12, events=stops)
        after = path.y[:, -1].copy()
        if path.status == 1:
            self._change(next(i for i, times in enumerate(path.t_events) if len(times)), after, resting)
        return float(path.t[-1]), after

    def _change(self, i: int, state: np.ndarray, resting: list[bool]) -> None:
        """Let a contact yield that held, and one rest that slid."""
        omega, g = self.parts(state)
        if resting[i]:
            self._release(i, self.rate(omega, g, resting)[1][i], resting)
            return
        resting[i] = True
        tied = self.tied(resting)
        into = np.linalg.solve(self.inertia, tied.T)
        omega -= into @ np.linalg.solve(tied @ into, tied @ omega)


def space_body() -> nh.LLSystem:
    """Return a body on SE(3) with three rows, two of which are one contact."""
    tensor = nh.MultidimensionalSleigh(1.5, [0.4, 0.1, -0.2], np.diag([0.5, 0.7, 0.9])).homogeneous_mass_tensor
    rows = [[1.0, 0.0, 0.0, 0.0, 0.2, 0.0], [0.0, 0.0, 0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 0.0, 0.0, 1.0]]
    return nh.LLSystem(nh.SE(3), tensor, annihilator=rows)


def car(steering: float = 0.4) -> nh.LLSystem:
    """Return a plane body on two axles: the rear one at its origin, the front one steered, one length ahead."""
    tensor = nh.ChaplyginSleigh(1.0, 0.3, 0.45).homogeneous_mass_tensor
    front = [np.cos(steering), -np.sin(steering), np.cos(steering)]
    return nh.LLSystem(nh.SE(2), tensor, annihilator=[[0.0, 0.0, 1.0], front])


def random_case(rng: np.random.Generator) -> tuple[nh.Forced, float, np.ndarray]:
    """Return a random body with one to four random contacts, a time step from 0.001 to 3, a start that may slip."""
    group = (nh.SO(3), nh.SE(2), nh.SE(3), nh.SO(4))[rng.integers(4)]
    n, k = group.size, int(rng.integers(1, group.dim))
    A, rows = rng.normal(size=(n, n)), rng.normal(size=(group.dim - k, group.dim))
    system = nh.LLSystem(group, A @ A.T + 0.1 * np.eye(n), annihilator=rows)
    ends = np.sort(rng.choice(len(rows), rng.integers(1, min(4, len(rows)) + 1), replace=False)) + 1
    slips = []
    for own in np.split(rows[: ends[-1]], ends[:-1]):
        grip = (0.0, 10.0 ** rng.uniform(-12, 12), 10.0 ** rng.uniform(-2, 1), 10.0 ** rng.uniform(-2, 1), np.inf)
        viscous = (0.0, 10.0 ** rng.uniform(-3, 8), 10.0 ** rng.uniform(-2, 0))[rng.integers(3)]
        slips.append(nh.Slip(own, grip[rng.integers(5)], viscous))
    m = n - group.is_affine
    heavy = nh.Gravity(rng.normal(size=m), rng.normal(size=m)) if rng.integers(2) else None
    forced = nh.Forced(system, heavy, tuple(slips))
    velocity = rng.normal(size=forced.rank) * (rng.random(forced.rank) < 0.8)
    velocity[k:] *= rng.integers(2)
    return forced, float(10.0 ** rng.uniform(-3, 0.5)), velocity
