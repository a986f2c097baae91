"""Half-planes of a body with two admissible directions, and its level curves.

Level curves are arcs over intervals of directions, the two solutions of a quadratic, joined where they meet: an arc
ends in a fold, where it continues as the other solution, or on the equator, where its mirror image begins.
"""

import dataclasses
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from nonholo.base.types import Array, Float
from nonholo.systems import NormalForm


class HalfPlanes(NamedTuple):
    r"""Numbers whose signs tell half-planes; they are zero for every motion of a balanced body.

    Attributes:
        side: Positive in $\Delta_+$, negative in $\Delta_-$, zero on the line of equilibria.
        forward: Positive in $\Theta_+$, which contains the attracting equilibria, negative in $\Theta_-$.
    """

    side: Float[Array, "..."]
    forward: Float[Array, "..."]


@dataclasses.dataclass(frozen=True, eq=False)
class PlanarBody:
    """The parts of `Disc` and `Strip`.

    Attributes:
        form: The body.
        frame: The axes of the form as seen from the user's frame.
        to_rows: Takes momenta along the user's rows to momenta along those of the form.
    """

    form: NormalForm
    frame: Float[np.ndarray, "3 3"]
    to_rows: Float[np.ndarray, "2 2"]


FOLD, EQUATOR = "fold", "equator"
_SAME = 1e-8  # angle below which two middles of arcs are one


class Arc(NamedTuple):
    """One solution over an interval.

    Attributes:
        sign: Which of the two solutions, -1 or 1.
        start: First direction.
        stop: Last direction.
        ends: The kinds of the two, FOLD or EQUATOR; empty for an arc that closes on itself.
    """

    sign: int
    start: float
    stop: float
    ends: tuple[str, ...] = ()

    def directions(self, count: int) -> Float[np.ndarray, "K"]:
        """Return directions, denser at the ends, where an arc has the shape of a square root."""
        if not self.ends:
            return np.linspace(self.start, self.stop, count)
        middle, half = (self.start + self.stop) / 2, (self.stop - self.start) / 2
        return np.clip(middle - half * np.cos(np.linspace(0.0, np.pi, count)), self.start, self.stop)


class Place(NamedTuple):
    """An arc on one side of the equator, 1 or -1, and whether it is run through forwards."""

    arc: Arc
    side: int
    forward: bool

    def following(self, arcs: list[Arc]) -> "Place":
        """Return what continues the curve: the sense is reversed at every end."""
        arc = self.arc
        if not arc.ends:
            return self
        end, direction = (arc.ends[1], arc.stop) if self.forward else (arc.ends[0], arc.start)
        if end == EQUATOR:
            return Place(arc, -self.side, not self.forward)
        others = [a for a in arcs if a.sign == -arc.sign and a.ends]
        other = min(others, key=lambda a: _apart(direction, a.stop if self.forward else a.start), default=arc)
        return Place(other, self.side, not self.forward)

    def is_same(self, other: "Place") -> bool:
        """Return whether both are one arc on one side, full turns and the sense apart."""
        arc, that = self.arc, other.arc
        middles = (arc.start + arc.stop) / 2, (that.start + that.stop) / 2
        same = arc.sign == that.sign and self.side == other.side
        return same and (not arc.ends or _apart(*middles) < _SAME)

    @property
    def antipode(self) -> "Place":
        """The same displacements with the other sign of the unit vector."""
        arc = self.arc._replace(start=self.arc.start + np.pi, stop=self.arc.stop + np.pi)
        return Place(arc, -self.side, self.forward)


def closed_curves(
    arcs: list[Arc], points: Callable[[Arc, np.ndarray, int], Float[np.ndarray, "K c"]], count: int
) -> tuple[Float[np.ndarray, "K c"], ...]:
    """Return the closed curves that arcs make up, one of each antipodal pair; directions have the period 2 pi.

    Arcs beyond the first half turn are copies of the others; `points` gives the points of an arc on a side.
    """
    curves, past = [], []
    for arc in arcs:
        place, pieces = Place(arc, 1, forward=True), []
        while not any(place.is_same(other) for other in past):
            pieces.append(place)
            past += [place, place.antipode]
            place = place.following(arcs)
        if pieces:
            curves.append(_chain(pieces, points, count))
    return tuple(curves)


def _apart(x: float, y: float) -> float:
    """Return the angle between two directions."""
    return abs((x - y + np.pi) % (2 * np.pi) - np.pi)


def _chain(pieces: list[Place], points: Callable, count: int) -> Float[np.ndarray, "K c"]:
    rows = []
    for place in pieces:
        run = points(place.arc, place.arc.directions(count), place.side)
        rows.append(run if place.forward else run[::-1])
    curve = np.concatenate([rows[0], *(row[1:] for row in rows[1:])])
    curve[-1] = curve[0]  # equal but for the square root of rounding
    return curve
