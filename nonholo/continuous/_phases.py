"""The continuous motion of rows that may yield: smooth phases, in each of which every contact holds or slides.

A contact that holds yields where its reaction reaches the grip, toward what the reaction opposed. One that slides comes
to rest where its slip ends. Which contacts hold then is the one solution for their accelerations.

Reference: docs/theory/forces.md, "Slipping in flows".
"""

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import scipy  # its parts load on first use

from nonholo.base.results import Outcome
from nonholo.base.types import Float
from nonholo.systems import Contacts, Mode

Field = Callable[[float, np.ndarray], np.ndarray]
_LOOKS = 0.25, 0.5, 0.75, 1.0  # parts of a step, at which it is seen whether a contact changes
_MOST = 1000  # phases
_REST = 1e-9  # of the speed that a grip takes from its own slip in the whole time
_ROUNDING = 1e-12  # relative, of a grip
_STIFF = 1e4  # times in which viscous friction slows a slip down
_LEAST_IMPLICIT = 1e-9  # relative, for some hundred steps of order 5


def phases(steps: Any, contacts: Contacts, at: slice, field: Field, start: np.ndarray, span: Any, rtol: float) -> Any:
    """Return the ends of the steps, what interpolates within them, and the outcome: too stiff after too many phases.

    Args:
        steps: Solves equations up to a stop.
        contacts: The contacts.
        at: The places of their momenta in a state.
        field: The equations without the forces of contacts.
        start: The first state.
        span: The first and the last time.
        rtol: The relative error of a step.
    """
    nodes, pieces, speed = [span[0]], [], _REST * (span[1] - span[0])
    least = np.array([min(one.grip, 1e300) * speed / np.trace(contacts.inertia[p, p]) for p, one in contacts.each])
    mode = Mode.of(contacts, np.linalg.solve(contacts.inertia, start[at]), least)
    phase = Phase(mode, at, field, start.copy()).settle(span[0])
    for _ in range(_MOST):
        is_stiff = phase.is_stiff(span[1] - span[0])
        error, rest = max(rtol, _LEAST_IMPLICIT * is_stiff), (nodes[-1], span[1])
        own, parts, outcome = steps(phase.derivative, phase.start, rest, error, is_stiff=is_stiff, stop=phase.stop)
        state, length = parts[-1](own[-1]) if parts else phase.start, len(set(own)) - 1
        nodes, pieces = nodes + own[1 : length + 1], pieces + parts[:length]
        if outcome != Outcome.successful or not phase.ends:
            return nodes, pieces, outcome
        phase = phase.change(own[-1], state)
    return nodes, pieces, Outcome.too_stiff


@dataclasses.dataclass(frozen=True, eq=False)
class Phase:
    """A time in which no contact changes.

    Attributes:
        mode: Which contacts hold, and where the others slide.
        at: The places of momenta of slips in a state.
        field: The equations without the forces of contacts.
        start: The first state.
        ends: Gets the contact that ends it.
    """

    mode: Mode
    at: slice
    field: Field
    start: np.ndarray
    ends: list[int] = dataclasses.field(default_factory=list)

    def is_stiff(self, span: float) -> bool:
        """Return whether a cone yields, whose way is stiff at first, or viscous friction is much faster than a span."""
        (contacts, least, rests, _), v = self.mode, self.velocities(self.start)
        slow = (contacts.sizes(v[None])[0] <= least) & [len(one.rows) > 1 for one in contacts.slips]
        fast = [one.viscous * span > _STIFF * np.trace(contacts.inertia[p, p]) for p, one in contacts.each]
        return bool((~rests & (slow | fast)).any())

    def velocities(self, state: np.ndarray) -> Float[np.ndarray, "s"]:
        """Return the slip velocities of a state."""
        return np.linalg.solve(self.mode.contacts.inertia, state[self.at])

    def derivative(self, time: float, state: np.ndarray) -> np.ndarray:
        """Return the equations of motion."""
        rate = self.field(time, state)
        rate[self.at] += self.mode.forces(self.velocities(state), rate[self.at])
        return rate

    def forces(self, time: float, state: np.ndarray) -> Float[np.ndarray, "s"]:
        """Return the forces of contacts at a state."""
        return self.mode.forces(self.velocities(state), self.field(time, state)[self.at])

    def gaps(self, time: float, state: np.ndarray) -> Float[np.ndarray, "m"]:
        """Return what is left of grips that hold, and the speeds of slips that have not ended."""
        (contacts, least, rests, ways), v = self.mode, self.velocities(state)
        reactions, sizes = contacts.sizes(np.stack([self.forces(time, state), v]))
        along = [ways[p] @ v[p] if len(ways[p]) == 1 else sizes[i] - least[i] for i, (p, _) in enumerate(contacts.each)]
        return np.where(rests, [(1 + _ROUNDING) * one.grip for one in contacts.slips] - reactions, along)

    def stop(self, piece: Any) -> float:
        """Return where in a step a contact changes, or its end."""
        begin, before, own = piece.t_old, self.gaps(piece.t_old, piece(piece.t_old)), self.mode
        for time in piece.t_old + (piece.t - piece.t_old) * np.array(_LOOKS):
            now = self.gaps(time, piece(time))
            places = np.flatnonzero((now < 0) & (own.rests | (before > 0) | (now < -own.least)))
            if len(places):
                times = [self._root(piece, int(i), begin, time) if before[i] > 0 else begin for i in places]
                self.ends.append(int(places[np.argmin(times)]))
                return min(*times, float(np.nextafter(piece.t, piece.t_old)))
            begin, before = time, now
        return piece.t

    def _root(self, piece: Any, i: int, begin: float, end: float) -> float:
        tight = np.spacing(max(abs(begin), abs(end)))
        return scipy.optimize.brentq(lambda time: self.gaps(time, piece(time))[i], begin, end, xtol=tight)

    def change(self, time: float, state: np.ndarray) -> "Phase":
        """Return the phase after the contact that ends this one has changed."""
        i, rests, ways = self.ends[0], self.mode.rests.copy(), self.mode.ways.copy()
        place = self.mode.contacts.each[i][0]
        if rests[i]:
            force = self.forces(time, state)[place]
            ways[place] = -force / np.linalg.norm(force)
        rests[i] = not rests[i]
        return Phase(self.mode._replace(rests=rests, ways=ways), self.at, self.field, state).settle(time)

    def settle(self, time: float) -> "Phase":
        """Return the phase from the same state, in which some of the contacts at rest yield at once."""
        state, at = self.start, self.at
        state[at] = self.mode.contacts.stop(state[at], self.mode.rests)
        return dataclasses.replace(self, mode=self.mode.settle(self.velocities(state), self.field(time, state)[at]))
