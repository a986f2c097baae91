r"""Steps of a constraint form that may yield: at each step that of all forms, or one without it, under friction.

With B the form and the momentum p of a node, $\pi$ its part along B, the step of all forms needs the impulses
$\kappa - \pi$ at its beginning and $\nu$ at its end: $\kappa$ and $-\nu$ are the parts of $P$ and $P^+$. The form holds
if $|\kappa - \pi + \nu| \le h\mu + \tfrac h2c|v|$ with the grip $\mu$. Otherwise it slides,

$$ P = p + \tfrac12B(q)j + \dots, \qquad p' = P^+ + \tfrac12B(q')j, \qquad -j\in h\mu\,\partial|u| + hc\,u, $$

at the slip velocity u of the step, which its discrete constraint misses.

Reference: docs/theory/lagrange-dalembert.md, Proposition 15.3.
"""

import dataclasses
import functools
from typing import Any, ClassVar

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.results import OUTCOMES, Outcome
from nonholo.base.types import Array
from nonholo.lagrange_dalembert import _equations as equations
from nonholo.lagrange_dalembert._discretization import CoordinateStepper
from nonholo.lagrange_dalembert._flow import bordered_solution
from nonholo.lagrange_dalembert._functions import in_blocks, in_double
from nonholo.orbit import AbstractStepper, First, Rows, State
from nonholo.systems import friction

_MOST, _ROUNDING = 40, 1e-14  # corrections of an impulse; relative

Beginning = tuple[int, np.ndarray, float, State | None]
"""The outcome, the velocity of a step, the impulse j of its friction; the state of a run if it holds."""


@dataclasses.dataclass(frozen=True, eq=False)
class SlipStepper(AbstractStepper[Any]):
    """The steps of a form that may yield.

    A row has the momentum of its node, without the half impulse of the form. The impulse of friction, whether the form
    holds, and the state of the run that holds are the stepper's own numbers.

    Attributes:
        motion: The discretization.
    """

    motion: Any
    lead: ClassVar[int] = 0
    part_refused = "a form that may yield"  # type: ignore[assignment]
    in_threads = False
    branch = "nearest"

    @functools.cached_property
    def steppers(self) -> tuple[CoordinateStepper, CoordinateStepper]:
        """The steppers of all forms, and of the others."""
        system, h = self.motion.system, self.motion.time_step
        return CoordinateStepper(system.holding.discrete_map(h)), CoordinateStepper(system.free.discrete_map(h))

    @functools.cached_property
    def columns(self) -> dict[str, int]:  # type: ignore[override]
        """The names and sizes of what a row holds."""
        place, rate, impulse = self.steppers[0].columns.values()
        return {"place": place, "body_velocity": rate, "momentum": rate, "multipliers": impulse}

    def _ask(self, function: Any, *arguments: Any) -> Any:
        own, system = self.motion.system.slip.rows[0], self.steppers[0].motion.system
        return in_double(function, system, *arguments, np.pad(own, (0, system.constraints - len(own))))

    def begin(self, x: np.ndarray, p: np.ndarray, near: np.ndarray, hold: State | None = None) -> Beginning:
        """Begin a step from a node, that which holds if it is known."""
        slip, h, outcome = self.motion.system.slip, np.float64(self.motion.time_step), Outcome.successful
        if hold is None:
            hold, outcome = self.steppers[0].start(First((p, x, near)))
        v = hold[len(x) :][: len(near)]
        if outcome != Outcome.successful:
            return outcome, v, 0.0, hold
        (pi, inertia), (_, _, first, last, form, *_) = self._ask(_node, x, p), self._ask(_ends, h, x, v)
        if abs(first - pi + last) <= h * (slip.grip + slip.viscous / 2 * abs(pi / inertia)):
            return 0, v, 0.0, hold
        impulse, slope, most, viscous = 2 * (first - pi), 2 * inertia, h * slip.grip, h * slip.viscous
        u = 0.0
        for _ in range(_MOST):  # corrections of the impulse j(u), whose slope is that of the last two
            goal = friction(np.array([[slope]]), np.array([slope * u - impulse]), [(slice(1), most, viscous)])[1][0]
            if abs(goal - impulse) <= _ROUNDING * (abs(goal) + slope * np.linalg.norm(form) * np.linalg.norm(v)):
                return 0, v, goal, None
            start, outcome = self.steppers[1].start(First((p + goal / 2 * form, x, near)))
            v = start[len(x) :][: len(near)]
            if outcome != Outcome.successful:
                return outcome, v, goal, None
            after = self._ask(_ends, h, x, v)[5]
            slope = (goal - impulse) / (after - u) if (goal - impulse) * (after - u) > 0 else slope
            impulse, u = goal, after
        return Outcome.not_converged, v, impulse, None

    def start(self, first: First) -> tuple[State, Outcome]:
        """Return the state at the first root."""
        p, x, v = first.numbers
        beginning = self.begin(x, p, v)
        return self._state(x, p, beginning), OUTCOMES[beginning[0]]

    def advance(self, state: State, steps: int, every: int, rows: Rows) -> tuple[int, int]:
        """Take steps one by one."""
        states, code = [state.copy()], 0
        while len(states) <= steps and code == 0:
            after, code = self._after(states[-1])
            states += [after] * (code == 0)
        for column, entries in zip(rows, self._parts(np.array(states[::every]).T), strict=False):
            column[: entries.shape[1]] = entries.T
        state[:] = states[-1]
        return len(states) - 1, code

    def _after(self, state: State) -> tuple[State, int]:
        """Return the state after a step and the outcome; write the impulses of the step into the state before it."""
        x, v, _, impulses, (j,), (holds,), hold = self._parts(state)
        _, arriving, _, last, _, _, form, x, forms = self._ask(_ends, np.float64(self.motion.time_step), x, v)
        p, run, code = arriving + (last if holds else j / 2) * form, None, 0
        if holds:
            run, nowhere = hold.copy(), tuple(np.empty((2, n)) for n in self.steppers[0].columns.values())
            code, x = self.steppers[0].advance(run, 1, 1, nowhere)[1], run[: len(x)]
        beginning = self.begin(x, p, v, run) if code == 0 else (code, v, j, None)
        leaving = self._ask(_ends, np.float64(self.motion.time_step), x, beginning[1])[0]
        impulses[:] = np.linalg.lstsq(forms.T, leaving - arriving)[0]
        return self._state(x, p, beginning), int(beginning[0])

    def _state(self, x: np.ndarray, p: np.ndarray, beginning: Beginning) -> State:
        _, v, j, hold = beginning
        own = [j, hold is not None], np.zeros(self.steppers[0].width + len(p) + 1) if hold is None else hold
        return np.concatenate([x, v, p, np.zeros(self.columns["multipliers"]), *own])

    def _parts(self, state: np.ndarray) -> list[np.ndarray]:
        return np.split(state, np.cumsum([*self.columns.values(), 1, 1]))

    def orbit(self, rows: Rows, step: int, every: int, outcome: Outcome) -> Any:
        """Return rows as an orbit."""
        (q, v, p, impulses), system = rows, self.motion.system
        orbit = self.steppers[1].states(q, v, impulses, step, every, outcome)
        return dataclasses.replace(orbit, system=system, momentum=p, energy=in_blocks(_energies, system.free, q, p)[0])


def _node(system: Any, x: Array, p: Array, row: Array) -> tuple[Array, Array]:
    """Return the momentum of a slip in a momentum, and that of a unit slip."""
    w, A, dual = equations.inverse_legendre(system, x, p), equations.forms(system, x), row / (row @ row)
    across = jnp.linalg.pinv(A).T @ (p - equations.momentum(system, x, w))
    return dual @ across, dual @ bordered_solution(system, x, w, jnp.zeros_like(p), dual)[1]


def _ends(system: Any, h: Array, x: Array, v: Array, row: Array) -> tuple[Array, ...]:
    """Return P, $P^+$, the impulses of a step that holds, the form and the slip; form, place and forms at its end."""
    (leaving, arriving), end = equations.momenta(system, x, v, h), equations.ahead(system, x, v, h)
    first, last = _node(system, x, leaving, row)[0], -_node(system, end, arriving, row)[0]
    form, forms = row @ equations.forms(system, x), equations.forms(system, end)
    slip = row @ equations.discrete_constraints(system, x, v, h)
    return leaving, arriving, first, last, form, slip, row @ forms, end, forms


def _energies(system: Any, x: Array, p: Array) -> tuple[Array]:
    """Return the energies of nodes."""
    return (jax.vmap(lambda x, p: equations.energy(system, x, equations.inverse_legendre(system, x, p)))(x, p),)
