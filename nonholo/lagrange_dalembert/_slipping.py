r"""Steps of constraint forms that may yield: at each step that of all forms, or one without some, under friction.

With B the forms of all contacts and the momentum p of a node, $\pi$ its parts along B, the step of all forms needs the
impulses $\kappa - \pi$ at its beginning and $\nu$ at its end: $\kappa$ and $-\nu$ are the parts of $P$ and $P^+$. A
contact i holds if $|\kappa_i - \pi_i + \nu_i| \le h\mu_i + \tfrac h2c_i|v_i|$ with the grip $\mu_i$. Otherwise some
slide, while the forms of the others stay in the step, by impulses that do not exceed this either:

$$ P = p + \tfrac12B(q)^Tj + \dots, \qquad p' = P^+ + \tfrac12B(q')^Tj, \qquad
   -j_i\in h\mu_i\,\partial|u_i| + hc_i\,u_i, $$

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
from nonholo.base.types import Array, Float
from nonholo.lagrange_dalembert import _equations as equations
from nonholo.lagrange_dalembert._discretization import CoordinateStepper
from nonholo.lagrange_dalembert.functions import in_blocks, in_double
from nonholo.orbit import AbstractStepper, First, Rows, State
from nonholo.systems.forces import Contacts, friction, update_slope

_MOST, _ROUNDING, _SEEN = 40, 1e-14, 1e-14  # corrections of an impulse; relative; of what changes a slope

Beginning = tuple[int, np.ndarray, np.ndarray, Any, State | None]
"""The outcome, velocity and impulse j of the friction of a step, which contacts hold; if all, the state of a run."""


@dataclasses.dataclass(frozen=True, eq=False)
class SlipStepper(AbstractStepper[Any]):
    """The steps of forms that may yield.

    A row has the momentum of its node, without the half impulse of the forms. The impulse of friction, which contacts
    hold, and the state of the run in which all do are the stepper's own numbers.

    Attributes:
        motion: The discretization.
    """

    motion: Any
    lead: ClassVar[int] = 0
    part_refused = "forms that may yield"  # type: ignore[assignment]
    in_threads = False
    branch = "nearest"

    @functools.cached_property
    def stepper_of(self) -> Any:
        """The function from which contacts hold to the stepper of their forms and of those that never yield."""

        @functools.cache
        def stepper_of(*holds: bool) -> CoordinateStepper:
            yields = [one for one, stays in zip(self.slips, holds, strict=True) if not stays]
            return CoordinateStepper(self.motion.system.without(yields).discrete_map(self.motion.time_step))

        return stepper_of

    @property
    def slips(self) -> Any:
        """The contacts."""
        return self.motion.system.slips

    @functools.cached_property
    def rows(self) -> np.ndarray:
        """Their rows, of all forms."""
        return np.concatenate([one.rows for one in self.slips])

    @functools.cached_property
    def whole(self) -> CoordinateStepper:
        """The stepper of all forms."""
        return self.stepper_of(*[True] * len(self.slips))

    @functools.cached_property
    def columns(self) -> dict[str, int]:  # type: ignore[override]
        """The names and sizes of what a row holds."""
        place, rate, impulse = self.whole.columns.values()
        return {"place": place, "body_velocity": rate, "momentum": rate, "multipliers": impulse}

    def _ask(self, function: Any, *arguments: Any, holds: Any = None) -> Any:
        """Call a function of the system in which these contacts hold, or all, with their rows."""
        system, rows = self.whole.motion.system, self.rows
        if holds is not None:
            system = self.stepper_of(*holds).motion.system
            stays = Contacts(np.empty(0), self.slips).places(holds)
            rows = rows[stays][:, ~rows[~stays].any(axis=0)]
        return in_double(function, system, *arguments, np.pad(rows, ((0, 0), (0, system.constraints - rows.shape[1]))))

    def begin(self, x: np.ndarray, p: np.ndarray, near: np.ndarray, hold: State | None = None) -> Beginning:
        """Begin a step from a node, that which holds if it is known."""
        h, outcome, holds = np.float64(self.motion.time_step), Outcome.successful, np.ones(len(self.slips), bool)
        if hold is None:
            hold, outcome = self.whole.start(First((p, x, near)))
        v = hold[x.size :][: len(near)]
        still = np.zeros(len(self.rows))
        if outcome != Outcome.successful:
            return outcome, v, still, holds, hold
        (pi, inertia), (_, _, first, last, forms, *_) = self._ask(_node, x, p), self._ask(_ends, h, x, v)
        contacts, impulses = Contacts(inertia, self.slips), first - pi + last
        moving = contacts.sizes(np.linalg.solve(inertia, pi)[None])[0]
        most = np.array([h * (one.grip + one.viscous / 2 * size) for one, size in zip(self.slips, moving, strict=True)])
        yields = contacts.sizes(impulses[None])[0] > most
        if not yields.any():
            return 0, v, still, holds, hold
        laws = [(at, size, h / 2 * one.viscous) for size, (at, one) in zip(most, contacts.each, strict=True)]
        slides = contacts.sizes(friction(inertia, -impulses, laws)[0][None])[0] > 0
        yields = slides if slides.any() else yields
        while yields.any():  # once more where others then bear too much
            holds = holds & ~yields
            beginning = self._slide((x, p, near, v), holds, contacts, (first - pi, forms))
            if beginning[0] != 0:
                return beginning
            yields = holds & (contacts.sizes(self._reactions(x, p, beginning)[None])[0] > most)
        return beginning

    def _slide(self, node: Any, holds: np.ndarray, contacts: Contacts, along: Any) -> Beginning:
        """Begin a step in which some contacts slide, from impulses at its beginning that would hold them, and forms."""
        (x, p, near, v), (first, forms) = node, along
        h, size = np.float64(self.motion.time_step), np.linalg.norm
        slides = ~contacts.places(holds)
        moving = [one for one, stays in zip(self.slips, holds, strict=True) if not stays]
        slope, u = 2 * contacts.inertia[np.ix_(slides, slides)], np.zeros(int(slides.sum()))
        impulse, j = 2 * first[slides], np.zeros(len(slides))
        laws = [(at, h * one.grip, h * one.viscous) for at, one in Contacts(slope, tuple(moving)).each]
        for _ in range(_MOST):  # corrections of the impulse j(u), whose slope is that of the last ones
            goal = friction(slope, slope @ u - impulse, laws)[1]
            if size(goal - impulse) <= _ROUNDING * (size(goal) + size(slope) * size(np.abs(forms) @ np.abs(v))):
                j[slides] = goal
                return 0, v, j, holds, None
            start, outcome = self.stepper_of(*holds).start(First((p + goal / 2 @ forms[slides], x, near)))
            v = start[x.size :][: len(near)]
            if outcome != Outcome.successful:
                return outcome, v, j, holds, None
            after = self._ask(_ends, h, x, v)[5][slides]
            slope = update_slope(slope, after - u, goal - impulse, float(_SEEN * size(goal)))
            impulse, u = goal, after
        return Outcome.not_converged, v, j, holds, None

    def _reactions(self, x: np.ndarray, p: np.ndarray, beginning: Beginning) -> np.ndarray:
        """Return the impulses by which contacts hold in a step in which others slide."""
        _, v, j, holds, _ = beginning
        leaving, arriving, _, _, own, _, ends, end, _ = self._ask(_ends, np.float64(self.motion.time_step), x, v)
        before = self._across(holds, x, leaving) - self._across(holds, x, p + j / 2 @ own)
        return before - self._across(holds, end, arriving + j / 2 @ ends)

    def _across(self, holds: np.ndarray, x: np.ndarray, p: np.ndarray) -> np.ndarray:
        """Return the parts of a momentum along the forms of contacts that hold while others slide."""
        parts = np.zeros(len(self.rows))
        if holds.any():
            parts[Contacts(np.empty(0), self.slips).places(holds)] = self._ask(_node, x, p, holds=holds)[0]
        return parts

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
        x, v, _, impulses, j, holds, hold = self._parts(state)
        x, holds, h = x.reshape(self.motion.system.place_shape), holds.astype(bool), np.float64(self.motion.time_step)
        _, arriving, _, last, _, _, own, end, forms = self._ask(_ends, h, x, v)
        p, run, code = arriving + (last if holds.all() else j / 2) @ own, None, 0
        if holds.all():
            run, nowhere = hold.copy(), tuple(np.empty((2, n)) for n in self.whole.columns.values())
            code, end = self.whole.advance(run, 1, 1, nowhere)[1], run[: x.size].reshape(x.shape)
        else:
            p = p - self._across(holds, end, p) @ own
        beginning = self.begin(end, p, v, run) if code == 0 else (code, v, j, holds, None)
        impulses[:] = np.linalg.lstsq(forms.T, self._ask(_ends, h, end, beginning[1])[0] - arriving)[0]
        return self._state(end, p, beginning), int(beginning[0])

    def _state(self, x: np.ndarray, p: np.ndarray, beginning: Beginning) -> State:
        _, v, j, holds, hold = beginning
        own = j, holds, np.zeros(self.whole.width + len(p) + 1) if hold is None else hold
        return np.concatenate([x.ravel(), v, p, np.zeros(self.columns["multipliers"]), *own])

    def _parts(self, state: np.ndarray) -> list[np.ndarray]:
        return np.split(state, np.cumsum([*self.columns.values(), len(self.rows), len(self.slips)]))

    def matrices(self, rows: Rows) -> Float[np.ndarray, "K N N"]:
        """Return the poses."""
        return self.whole.matrices(rows)

    def orbit(self, rows: Rows, step: int, every: int, outcome: Outcome) -> Any:
        """Return rows as an orbit."""
        (q, v, p, impulses), system = rows, self.motion.system
        orbit = self.stepper_of(*[False] * len(self.slips)).orbit((q, v, impulses), step, every, outcome)
        energy = in_blocks(_energy, system.free, q.reshape(-1, *system.place_shape), p)[0]
        return dataclasses.replace(orbit, system=system, momentum=p, energy=energy)


def _node(system: Any, x: Array, p: Array, rows: Array) -> tuple[Array, Array]:
    """Return the momenta of slips in a momentum, and the matrix of those of unit slips."""
    w, A, dual = equations.inverse_legendre(system, x, p), equations.forms(system, x), jnp.linalg.pinv(rows).T
    across = jnp.linalg.pinv(A).T @ (p - equations.momentum(system, x, w))
    units = jax.vmap(lambda off: equations.bordered_solution(system, x, w, jnp.zeros_like(p), off)[1])(dual)
    return dual @ across, dual @ units.T


def _ends(system: Any, h: Array, x: Array, v: Array, rows: Array) -> tuple[Array, ...]:
    """Return P, $P^+$, the impulses of a step that holds, own forms and slips; own forms, place and all at its end."""
    (leaving, arriving), end = equations.momenta(system, x, v, h), equations.ahead(system, x, v, h)
    first, last = _node(system, x, leaving, rows)[0], -_node(system, end, arriving, rows)[0]
    own, forms = rows @ equations.forms(system, x), equations.forms(system, end)
    slips = rows @ equations.discrete_constraints(system, x, v, h)
    return leaving, arriving, first, last, own, slips, rows @ forms, end, forms


def _energy(system: Any, x: Array, p: Array) -> tuple[Array]:
    """Return the energy of a node."""
    return (equations.energy(system, x, equations.inverse_legendre(system, x, p)),)
