r"""Steps of constraint forms that may yield: at each step that of all forms, or one without them, under friction.

With B the forms and the momentum p of a node, $\pi$ its parts along B, the step of all forms needs the impulses
$\kappa - \pi$ at its beginning and $\nu$ at its end: $\kappa$ and $-\nu$ are the parts of $P$ and $P^+$. The forms hold
if $|\kappa - \pi + \nu| \le h\mu + \tfrac h2c|v|$ with the grip $\mu$. Otherwise they slide,

$$ P = p + \tfrac12B(q)^Tj + \dots, \qquad p' = P^+ + \tfrac12B(q')^Tj, \qquad -j\in h\mu\,\partial|u| + hc\,u, $$

at the slip velocity u of the step, which their discrete constraint misses.

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
from nonholo.systems import friction, update_slope

_MOST, _ROUNDING, _SEEN = 40, 1e-14, 1e-14  # corrections of an impulse; relative; of what changes a slope

Beginning = tuple[int, np.ndarray, np.ndarray, State | None]
"""The outcome, the velocity of a step, the impulse j of its friction; the state of a run if it holds."""


@dataclasses.dataclass(frozen=True, eq=False)
class SlipStepper(AbstractStepper[Any]):
    """The steps of forms that may yield.

    A row has the momentum of its node, without the half impulse of the forms. The impulse of friction, whether they
    hold, and the state of the run that holds are the stepper's own numbers.

    Attributes:
        motion: The discretization.
    """

    motion: Any
    lead: ClassVar[int] = 0
    part_refused = "forms that may yield"  # type: ignore[assignment]
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
        own, system = self.motion.system.slip.rows, self.steppers[0].motion.system
        return in_double(function, system, *arguments, np.pad(own, ((0, 0), (0, system.constraints - own.shape[1]))))

    def begin(self, x: np.ndarray, p: np.ndarray, near: np.ndarray, hold: State | None = None) -> Beginning:
        """Begin a step from a node, that which holds if it is known."""
        slip, h, outcome = self.motion.system.slip, np.float64(self.motion.time_step), Outcome.successful
        if hold is None:
            hold, outcome = self.steppers[0].start(First((p, x, near)))
        v = hold[len(x) :][: len(near)]
        still = np.zeros(len(slip.rows))
        if outcome != Outcome.successful:
            return outcome, v, still, hold
        (pi, inertia), (_, _, first, last, forms, *_) = self._ask(_node, x, p), self._ask(_ends, h, x, v)
        size = np.linalg.norm
        if size(first - pi + last) <= h * (slip.grip + slip.viscous / 2 * size(np.linalg.solve(inertia, pi))):
            return 0, v, still, hold
        impulse, slope, u, law = 2 * (first - pi), 2 * inertia, still, (slice(None), h * slip.grip, h * slip.viscous)
        for _ in range(_MOST):  # corrections of the impulse j(u), whose slope is that of the last ones
            goal = friction(slope, slope @ u - impulse, [law])[1]
            if size(goal - impulse) <= _ROUNDING * (size(goal) + size(slope) * size(np.abs(forms) @ np.abs(v))):
                return 0, v, goal, None
            start, outcome = self.steppers[1].start(First((p + goal / 2 @ forms, x, near)))
            v = start[len(x) :][: len(near)]
            if outcome != Outcome.successful:
                return outcome, v, goal, None
            after = self._ask(_ends, h, x, v)[5]
            slope = update_slope(slope, after - u, goal - impulse, float(_SEEN * size(goal)))
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
        x, v, _, impulses, j, (holds,), hold = self._parts(state)
        _, arriving, _, last, _, _, own, x, forms = self._ask(_ends, np.float64(self.motion.time_step), x, v)
        p, run, code = arriving + (last if holds else j / 2) @ own, None, 0
        if holds:
            run, nowhere = hold.copy(), tuple(np.empty((2, n)) for n in self.steppers[0].columns.values())
            code, x = self.steppers[0].advance(run, 1, 1, nowhere)[1], run[: len(x)]
        beginning = self.begin(x, p, v, run) if code == 0 else (code, v, j, None)
        leaving = self._ask(_ends, np.float64(self.motion.time_step), x, beginning[1])[0]
        impulses[:] = np.linalg.lstsq(forms.T, leaving - arriving)[0]
        return self._state(x, p, beginning), int(beginning[0])

    def _state(self, x: np.ndarray, p: np.ndarray, beginning: Beginning) -> State:
        _, v, j, hold = beginning
        own = j, [hold is not None], np.zeros(self.steppers[0].width + len(p) + 1) if hold is None else hold
        return np.concatenate([x, v, p, np.zeros(self.columns["multipliers"]), *own])

    def _parts(self, state: np.ndarray) -> list[np.ndarray]:
        return np.split(state, np.cumsum([*self.columns.values(), len(self.motion.system.slip.rows), 1]))

    def orbit(self, rows: Rows, step: int, every: int, outcome: Outcome) -> Any:
        """Return rows as an orbit."""
        (q, v, p, impulses), system = rows, self.motion.system
        orbit = self.steppers[1].states(q, v, impulses, step, every, outcome)
        return dataclasses.replace(orbit, system=system, momentum=p, energy=in_blocks(_energies, system.free, q, p)[0])


def _node(system: Any, x: Array, p: Array, rows: Array) -> tuple[Array, Array]:
    """Return the momenta of slips in a momentum, and the matrix of those of unit slips."""
    w, A, dual = equations.inverse_legendre(system, x, p), equations.forms(system, x), jnp.linalg.pinv(rows).T
    across = jnp.linalg.pinv(A).T @ (p - equations.momentum(system, x, w))
    units = jax.vmap(lambda off: bordered_solution(system, x, w, jnp.zeros_like(p), off)[1])(dual)
    return dual @ across, dual @ units.T


def _ends(system: Any, h: Array, x: Array, v: Array, rows: Array) -> tuple[Array, ...]:
    """Return P, $P^+$, the impulses of a step that holds, own forms and slips; own forms, place and all at its end."""
    (leaving, arriving), end = equations.momenta(system, x, v, h), equations.ahead(system, x, v, h)
    first, last = _node(system, x, leaving, rows)[0], -_node(system, end, arriving, rows)[0]
    own, forms = rows @ equations.forms(system, x), equations.forms(system, end)
    slips = rows @ equations.discrete_constraints(system, x, v, h)
    return leaving, arriving, first, last, own, slips, rows @ forms, end, forms


def _energies(system: Any, x: Array, p: Array) -> tuple[Array]:
    """Return the energies of nodes."""
    return (jax.vmap(lambda x, p: equations.energy(system, x, equations.inverse_legendre(system, x, p)))(x, p),)
