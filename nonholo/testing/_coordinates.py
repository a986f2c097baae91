"""Whether a system moves as its Lagrangian and constraint forms say, and its map by the discrete principle."""

import dataclasses
import functools
import itertools
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from nonholo.analysis import invariants
from nonholo.base.numerics import double_precision
from nonholo.base.types import Float
from nonholo.simulation import flow, simulate
from nonholo.testing import _report as report
from nonholo.testing._report import Check, derivative, gap, largest, measures, need, relative

SYSTEM: list[Check] = []
MAP: list[Check] = []
_OFFSET, _STATES = 1e-3, 5  # between times at which a flow is differentiated


class CoordinateSamples:
    """Motions of a system in coordinates or on a group from one start, and its functions as the user wrote them.

    Args:
        system: The system.
        rng: Where the start comes from.
        configuration: Where it starts; by default what is admissible next to a random place, with what is prescribed.
        time_step: h, of a discretization.
        steps: Number of steps of the orbit.
    """

    def __init__(self, system: Any, rng: np.random.Generator, place: Any, time_step: Any = 1.0, steps: int = 4) -> None:
        self.system, self.time_step, self.steps, n = system, float(time_step), steps, system.dimension
        self.places: Any = system.places
        self._place = self.places.step(rng.normal(size=n), 1.0) if place is None else place
        self._drawn, self._is_random = rng.normal(size=n), place is None
        if place is None:
            for index, motion in system.plain.prescribed:
                self._place[index] = self._value(motion, 0.0)

    def _value(self, function: Callable[..., Any], *arguments: Any) -> np.ndarray:
        with double_precision():
            return np.asarray(function(*arguments))

    def at(self, name: str, *state: Any) -> np.ndarray:
        """Return the value of a function of the system at a state, whose last entry is the time."""
        return self._value(getattr(self.system.plain, name), *(state if self.system.takes_time(name) else state[:-1]))

    def forms(self, q: np.ndarray, t: float) -> Float[np.ndarray, "s n"]:
        """Return the rows of the constraint, before the last ones of prescribed coordinates those of holonomic ones."""
        system, n = self.system.plain, self.system.dimension
        rows = np.zeros((0, n)) if system.constraint_forms is None else self.at("constraint_forms", q, t)
        if system.holonomic is not None:
            rows = np.concatenate([rows, self.gradient(lambda x: self.at("holonomic", self.places.beside(q, x), t)).T])
        return np.concatenate([rows, np.eye(n)[[i for i, _ in system.prescribed]]])

    def force(self, t: float, q: np.ndarray, v: np.ndarray, step: int) -> np.ndarray:
        """Return the force, of a table that of a step."""
        row = np.zeros_like(v) if self.system.table is None else self.system.table.acting(np.array([step]))[0]
        return row if self.system.applied is None else row + self._value(self.system.plain.applied, t, q, v)

    def action(self, before: np.ndarray, after: np.ndarray, t: float) -> np.ndarray:
        """Return the discrete Lagrangian of a step: the user's own, or that of the rule."""
        h, places = self.time_step, self.places
        v = places.departure(before, after) / h
        if (own := self.system.plain.discrete_lagrangian) is not None:
            return self._value(own, *places.ends(before, places.step(v, h), h), h)
        if self.system.rule == "midpoint":
            return h * self.at("lagrangian", (before + after) / 2, v, t + h / 2)
        return h * (self.at("lagrangian", before, v, t) + self.at("lagrangian", after, v, t + h)) / 2

    def gradient(self, function: Callable[[np.ndarray], Any]) -> Float[np.ndarray, "n"]:
        """Return the derivatives at zero of a function of n numbers, a row for each."""
        return np.array([derivative(lambda t, x=x: function(t * x)) for x in np.eye(self.system.dimension)])

    @functools.cached_property
    def _opening(self) -> Any:
        free = dataclasses.replace(self.system, force=None) if self.system.table else self.system  # which has no flow
        return flow(free, times=[0.0], configuration=self._place, momentum=self._drawn, project=self._is_random)

    @property
    def q(self) -> np.ndarray:
        """Where the motions start."""
        return self._opening.configuration[0]

    @functools.cached_property
    def momentum(self) -> Float[np.ndarray, "n"]:
        """A momentum at the start, of velocities of about norm one."""
        return self._drawn / max(1.0, float(np.linalg.norm(self._opening.body_velocity)))

    @functools.cached_property
    def near(self) -> Any:
        """The flow at a few times close together."""
        return self._flow(_OFFSET * np.arange(_STATES))

    def _flow(self, times: Any) -> Any:
        need(self.system.table is None, "one force for each step")
        return flow(self.system, configuration=self.q, momentum=self.momentum, times=times, rtol=1e-13, atol=1e-14)

    @functools.cached_property
    def run(self) -> Any:
        """An orbit of the discretization, or why there is none."""
        try:
            return self._run(self.time_step, self.steps)
        except Exception as failure:  # the functions under test are a user's and may raise anything
            return failure

    @property
    def orbit(self) -> Any:
        """The orbit."""
        return report.result_of(self.run, "the orbit failed")

    def _run(self, time_step: float, steps: int, **start: Any) -> Any:
        start = start or {"configuration": self.q, "momentum": self.momentum}
        return simulate(self.system.discrete_map(time_step), steps=steps, **start)

    @functools.cached_property
    def span(self) -> float:
        """A time in which velocities do not change much, ten time steps at most."""
        return min(report.COUNTS[0] * self.time_step, 1.0)

    @functools.cached_property
    def paths(self) -> list[Any]:
        """One path in more and more steps."""
        report.result_of(self.run, "the orbit failed")
        need(not getattr(self.system.discrete_lagrangian, "is_of_one_step", False), "made for one time step")
        return [self._run(self.span / n, n) for n in report.COUNTS]

    @functools.cached_property
    def end(self) -> Any:
        """The flow at its end."""
        return self._flow([0.0, self.span])


@measures(SYSTEM, "momentum", "p = dL/dv, by differences", 1e-8)
def _momentum(s: CoordinateSamples) -> float:
    q, v, t, p = _middle(s)
    return relative(p, s.gradient(lambda w: s.at("lagrangian", q, v + w, t)))


@measures(SYSTEM, "energy", "E = v p - L", 1e-11)
def _energy(s: CoordinateSamples) -> float:
    q, v, t, p = _middle(s)
    energy = v @ p - s.at("lagrangian", q, v, t)
    return abs(s.near.energy[2] - energy) / (abs(energy) + abs(v @ p))


@measures(SYSTEM, "velocity", "the flow moves with its velocity", 1e-8)
def _velocity(s: CoordinateSamples) -> float:
    q = s.near.configuration
    return gap(_slope([s.places.departure(q[2], after) for after in q]), s.near.body_velocity[2])


@measures(SYSTEM, "constraint", "A v = b along the flow", 1e-11)
def _constraint(s: CoordinateSamples) -> float:
    return largest(s.near.constraint_residual) / (1 + largest(s.near.body_velocity))


@measures(SYSTEM, "equations of motion", "p' = ad*_v p + dL/dq + f + sum lambda_j A^j, by differences", 1e-6)
def _equations(s: CoordinateSamples) -> float:
    q, v, t, p = _middle(s)
    turn = 0.0 if (group := getattr(s.system, "group", None)) is None else group.coad(v, p)
    along = turn + s.gradient(lambda x: s.at("lagrangian", s.places.beside(q, x), v, t)) + s.force(t, q, v, 0)
    return gap(_slope(s.near.momentum), along + s.near.multipliers[2] @ s.forms(q, t))


@measures(SYSTEM, "balance", "the energy changes by the work of forces: relative to both", 1e-4)
def _balance(s: CoordinateSamples) -> float:
    left = s.near.energy - s.near.energy[0] - s.near.work
    return largest(left) / (_OFFSET * (1e-3 + largest(s.near.energy)) + largest(s.near.work))


def _middle(s: CoordinateSamples) -> tuple[np.ndarray, np.ndarray, float, np.ndarray]:
    return s.near.configuration[2], s.near.body_velocity[2], s.near.time[2], s.near.momentum[2]


def _slope(rows: Sequence[np.ndarray]) -> Float[np.ndarray, "n"]:
    return derivative(lambda t: rows[2 + round(t / _OFFSET)], _OFFSET)


@measures(MAP, "orbit", "a run goes through: steps that are missing", 0.0)
def _orbit(s: CoordinateSamples) -> float:
    return float(s.steps + 1 - len(report.result_of(s.run)))


@measures(MAP, "discrete constraint", "F(q_k, q_(k+1)) = 0", 1e-11)
def _discrete_constraint(s: CoordinateSamples) -> float:
    return largest(s.orbit.constraint_residual) / (1 + largest(s.orbit.body_velocity))


@measures(MAP, "prescribed", "prescribed coordinates are where they have to be", 1e-12)
def _drivers(s: CoordinateSamples) -> float:
    need(s.system.prescribed, "nothing is prescribed")
    pairs = ((s.orbit.configuration[:, i], motion) for i, motion in s.system.plain.prescribed)
    return max(gap(rows, [s._value(motion, t) for t in s.orbit.time]) for rows, motion in pairs)


@measures(MAP, "holonomic", "Phi(q_k, t_k) = 0 at each state", 1e-12)
def _holonomic(s: CoordinateSamples) -> float:
    need(s.system.holonomic, "no constraint is holonomic")
    states = zip(s.orbit.configuration, s.orbit.time, strict=True)
    return max(largest(s.at("holonomic", q, t)) / (1 + largest(q)) for q, t in states)


@measures(MAP, "start", "the first momentum along the constraint is that of the start", 1e-11)
def _start(s: CoordinateSamples) -> float:
    rows = s.forms(s.orbit.configuration[0], 0.0)
    gap_of_momenta = s.orbit.momentum[0] - s.momentum
    across = np.linalg.lstsq(rows.T, gap_of_momenta)[0] @ rows
    return largest(gap_of_momenta - across) / (1 + largest(s.momentum))


@measures(MAP, "discrete principle", "P_(k+1) - P+_k = sum lambda_j A^j, by differences of the Lagrangian", 1e-7)
def _principle(s: CoordinateSamples) -> float:
    leaving, arriving = np.array([_ends(s, k) for k in range(s.steps)]).transpose(1, 0, 2)
    nodes = zip(s.orbit.multipliers, s.orbit.configuration[1:], s.orbit.time[1:], strict=True)
    across = np.array([impulse @ s.forms(q, t) for impulse, q, t in nodes])
    return largest(leaving[1:] - arriving[:-1] - across[:-1]) / (1 + largest(leaving))


def _ends(s: CoordinateSamples, k: int) -> tuple[np.ndarray, np.ndarray]:
    """Return -D_1 L_d - f^- and D_2 L_d + f^+ of a step, by differences."""
    (q, after), (t, later) = s.orbit.configuration[k : k + 2], s.orbit.time[k : k + 2]
    beside, v, h = s.places.beside, s.orbit.body_velocity[k], s.time_step
    below = s.gradient(lambda x: s.action(beside(q, x), after, t))
    above = s.gradient(lambda x: s.action(q, beside(after, x), t))
    return -below - h / 2 * s.force(t, q, v, k), above + h / 2 * s.force(later, after, v, k)


@measures(MAP, "reversal", "a motion that nothing drives goes back the way it came", 1e-9)
def _reversal(s: CoordinateSamples) -> float:
    need(invariants(s.orbit).work is None, "forces, or what drives it, act")
    need(s.system.discrete_constraints is None, "custom discrete constraints")
    q = s.orbit.configuration
    there, back = ([s.action(*ends, 0.0) for ends in itertools.pairwise(x)] for x in (q, q[::-1]))
    need(relative(back[::-1], there) < 1e-12, "L_d is another one backwards")
    displacement = s.places.displacement(-s.orbit.body_velocity[-2], s.time_step)
    back = s._run(s.time_step, s.steps - 1, configuration=q[-1], displacement=displacement)
    return gap(back.configuration[::-1], q[1:])


@measures(MAP, "order of momenta", report.SECOND, 0.15)
def _order_of_momenta(s: CoordinateSamples) -> float:
    return report.off_two([relative(orbit.restricted_momentum[-1], s.end.restricted_momentum[-1]) for orbit in s.paths])


@measures(MAP, "order of configurations", report.SECOND, 0.15)
def _order_of_configurations(s: CoordinateSamples) -> float:
    return report.off_two([gap(orbit.configuration[-1], s.end.configuration[-1]) for orbit in s.paths])


@measures(MAP, "order of the balance", "energy less work changes by the square of the step: |slope - 2|", 0.15)
def _order_of_balance(s: CoordinateSamples) -> float:
    left = [orbit.energy - orbit.energy[0] - orbit.work for orbit in s.paths]
    pairs = zip(left, s.paths, strict=True)
    return report.off_two([largest(each) / (1 + largest(orbit.energy)) for each, orbit in pairs])
