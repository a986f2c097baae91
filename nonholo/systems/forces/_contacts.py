"""Several contacts: which of them hold, and the friction of those that slide.

Reference: docs/theory/forces.md, Theorem 18.4.
"""

import dataclasses
import functools
from typing import NamedTuple

import numpy as np

from nonholo.base.types import Bool, Float
from nonholo.systems.forces._friction import Slip

_MOST, _SWEEPS = 40, 200  # corrections of a direction, and of the slips of several contacts
_ROUNDING = 1e-15  # relative, of an impulse
Slips = Float[np.ndarray, "s"]
"""Velocities, momenta or forces along the rows of contacts."""
SlipMap = Float[np.ndarray, "s s"]
Law = tuple[slice, float, float]
"""The places of the rows of a contact, the most that dry friction is there, and viscous friction."""


@dataclasses.dataclass(frozen=True, eq=False)
class Contacts:
    """Contacts of a body, whose slips have momenta M v.

    Attributes:
        inertia: M, (s, s).
        slips: The rows of each and its friction.
    """

    inertia: SlipMap
    slips: tuple[Slip, ...]

    @functools.cached_property
    def each(self) -> tuple[tuple[slice, Slip], ...]:
        """The places of the rows of each, and its friction."""
        ends = np.cumsum([0, *(len(one.rows) for one in self.slips)])
        return tuple(zip(map(slice, ends[:-1], ends[1:]), self.slips, strict=True))

    def sizes(self, slips: Float[np.ndarray, "K s"]) -> Float[np.ndarray, "K m"]:
        """Return the sizes of slips or impulses at each."""
        return np.stack([np.linalg.norm(slips[:, at], axis=1) for at, _ in self.each], axis=1)

    def directions(self, slips: Slips) -> Slips:
        """Return the unit directions of slips."""
        return np.concatenate([slips[at] / (np.linalg.norm(slips[at]) or 1.0) for at, _ in self.each])

    def places(self, rests: Bool[np.ndarray, "m"]) -> Bool[np.ndarray, "s"]:
        """Return the places of the rows of some."""
        return np.repeat(rests, [len(one.rows) for one in self.slips])

    def stop(self, momenta: Slips, rests: Bool[np.ndarray, "m"]) -> Slips:
        """Return momenta of slips after impulses that end those of some, or rates without acceleration of these."""
        places, after = self.places(rests), momenta.copy()
        inertia = self.inertia[:, ~places]
        after[places] = inertia[places] @ np.linalg.solve(inertia[~places], momenta[~places])
        return after


class Mode(NamedTuple):
    """Which contacts hold, and where the others slide.

    Attributes:
        contacts: The contacts.
        least: The speeds up to which slips are at rest.
        rests: Which hold.
        ways: Unit directions of slips; that of one row stays up to the next stop.
    """

    contacts: Contacts
    least: Float[np.ndarray, "m"]
    rests: Bool[np.ndarray, "m"]
    ways: Slips

    @classmethod
    def of(cls, contacts: Contacts, v: Slips, least: Float[np.ndarray, "m"]) -> "Mode":
        """Return the mode of slip velocities alone, in which all that are at rest hold."""
        rests = (contacts.sizes(v[None])[0] <= least) | np.isinf([one.grip for one in contacts.slips])
        return cls(contacts, least, rests, contacts.directions(v))

    def forces(self, v: Slips, free: Slips) -> Slips:
        """Return friction along ways, of several rows only as slips vanish, and reactions against free rates."""
        force = np.zeros_like(v)
        for (at, one), rest, slow in zip(self.contacts.each, self.rests, self.least, strict=True):
            size, way = np.linalg.norm(v[at]), self.ways[at]
            if not rest:
                way = way if len(way) == 1 else (v[at] + max(slow - size, 0.0) * way) / (max(size, slow) or 1.0)
                force[at] = -one.grip * way - one.viscous * v[at]
        return np.where(self.contacts.places(self.rests), self.contacts.stop(free + force, self.rests) - free, force)

    def settle(self, v: Slips, free: Slips) -> "Mode":
        """Return the mode in which those at rest hold or begin to slide: the one solution for their accelerations."""
        contacts, rests = self.contacts, self.rests
        laws = [(at, one.grip if rest else 0.0, 0.0) for rest, (at, one) in zip(rests, contacts.each, strict=True)]
        others_push = np.where(contacts.places(rests), 0.0, self.forces(v, free))
        after = friction(contacts.inertia, free + others_push, laws)[0]
        holds = rests & (contacts.sizes(after[None])[0] == 0)
        ways = np.where(contacts.places(rests & ~holds), contacts.directions(after), self.ways)
        return self._replace(rests=holds, ways=ways)


def friction(slope: SlipMap, free: Slips, laws: list[Law]) -> tuple[Slips, Slips]:
    r"""Return x and j of $Ax = b + j$, $-j_i \in m_i\,\partial|x_i| + c_ix_i$: the only ones where A is monotone.

    Contact by contact, and by Newton's method where no slip changes its direction; NaN where that does not end.
    """
    x, j = np.zeros_like(free), np.zeros_like(free)
    for _ in range(_SWEEPS):
        for at, most, viscous in laws:
            others = x.copy()
            others[at] = 0.0
            x[at], j[at] = friction_of_one(slope[at, at], free[at] - slope[at] @ others, most, viscous)
        size = np.linalg.norm(free) + np.linalg.norm(slope) * np.linalg.norm(x)
        if len(laws) == 1 or np.linalg.norm(slope @ x - free - j) <= _ROUNDING * size:
            return x, j
        ahead = _correct(slope, free, laws, x)
        if all(x[at] @ ahead[at] > 0 or not x[at].any() for at, *_ in laws):
            x = ahead
    return x, np.full_like(j, np.nan)


def update_slope(slope: SlipMap, way: Slips, change: Slips, least: float) -> SlipMap:
    """Return a slope with a change of the impulse along a way, by Broyden; changes by rounding are ignored."""
    if np.linalg.norm(change) < least or not way @ change > 0:
        return slope
    return slope + np.outer(change - slope @ way, way) / (way @ way)


def _correct(slope: np.ndarray, free: np.ndarray, laws: list[Law], x: np.ndarray) -> np.ndarray:
    """Return slips after a correction by Newton's method of those that are not zero."""
    matrix, gap = slope.copy(), free - slope @ x
    for at, most, viscous in laws:
        one, length = np.eye(len(x))[at, at], np.linalg.norm(x[at])
        if length == 0:
            matrix[at], matrix[at, at], gap[at] = 0.0, one, 0.0
            continue
        way = x[at] / length
        gap[at] -= most * way + viscous * x[at]
        matrix[at, at] += viscous * one + most / length * (one - np.outer(way, way))
    return x + np.linalg.solve(matrix, gap)


def friction_of_one(slope: SlipMap, free: Slips, most: float, viscous: float) -> tuple[Slips, Slips]:
    r"""Return x and j of $Ax = b + j$, $-j \in m\,\partial|x| + cx$ at one contact.

    With $y = (|x|(A + c) + m)^{-1}b$ it is $x = |x|y$ at |y| = 1, and x = 0 if |b| <= m. The size of y falls as |x|
    grows, and its inverse is concave where A is symmetric: Newton's method from below.
    """
    if np.linalg.norm(free) <= most:
        return 0 * free, -free
    if len(free) == 1:
        push = most * np.sign(free)
        return (free - push) / (slope[0] + viscous), -push - viscous * (free - push) / (slope[0] + viscous)
    one = np.eye(len(free))
    stiff = slope + viscous * one
    size = (np.linalg.norm(free) - most) / np.linalg.norm(stiff)
    y, length = free, 1.0
    for _ in range(_MOST):
        y = np.linalg.solve(size * stiff + most * one, free)
        falls, length = y @ np.linalg.solve(size * stiff + most * one, stiff @ y), np.linalg.norm(y)
        change = length**2 * (length - 1) / falls
        if abs(change) <= _ROUNDING * size:
            break
        size = max(size + change, size / 2)
    return size * y, -(most / length + viscous * size) * y
