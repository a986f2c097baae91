"""Ends and bounds of `steer` on groups, checked, and its guesses."""

from collections.abc import Mapping
from typing import Any, NamedTuple, cast

import numpy as np

from nonholo.base.checks import array, error, pair, shape_of, shown
from nonholo.base.types import Float
from nonholo.systems import System, in_group

Ends = tuple[np.ndarray, np.ndarray, np.ndarray | None, np.ndarray | None]
"""First velocities and poses of members, and the poses and velocities that they are to have, None where free."""
BLOCK = 32  # members in one call; of more JAX shares single operations among threads, which takes longer
Limits = tuple[np.ndarray, np.ndarray]
"""The least and the largest force, of each row or of each step and row."""


class Guess(NamedTuple):
    """Where IPOPT begins: a motion with its body covectors, or a path of positions; None of what is not there."""

    configuration: Float[np.ndarray, "K ..."] | None = None
    controls: Float[np.ndarray, "steps dim"] | None = None
    path: Float[np.ndarray, "P n"] | None = None

    @property
    def trust(self) -> float:
        """The part of random changes that it is given."""
        return 1.0 if self.configuration is None and self.path is None else 0.1


def checked_guess(guess: Any, steps: int, n: int | None) -> Guess:
    """Return a guess: a `Steering` of one member with as many steps, or positions of n numbers."""
    where, remedy = "steer(guess=...)", "Pass the result of `steer` for one member, or two positions or more."
    if guess is None:
        return Guess()
    controls = getattr(guess, "controls", None)
    if controls is not None:
        if controls.ndim != 2 or len(controls) != steps:
            raise error(where, f"be of one member and {steps} steps", f"controls of shape {controls.shape}", remedy)
        return Guess(np.asarray(guess.orbit.configuration), controls)
    if n is None:
        raise error(where, "be the result of `steer` for a system without a position", shown(guess), remedy)
    path = array(where, guess, (None, n), remedy)
    if len(path) < 2:
        raise error(where, "have two positions or more", f"{len(path)}", remedy)
    return Guess(path=path)


def checked_limits(where: str, bounds: Any, k: int) -> Limits:
    """Return the least and the largest force of each row, (k,) both."""
    remedy = "Pass the least and the largest force, numbers or one for each row."
    if bounds is None:
        return np.full(k, -np.inf), np.full(k, np.inf)
    low, high = (array(where, end, (k,) if np.ndim(end) else (), remedy) + np.zeros(k) for end in pair(where, bounds))
    if not (low <= high).all() or not (low < high).any():
        raise error(where, "leave room between them", shown(bounds), remedy)
    return low, high


def limits_of_steps(bounds: Any, steps: int, k: int) -> Limits:
    """Return the least and the largest force of each step and row, one after the other."""
    low, high = checked_limits("steer(bounds=...)", bounds, k)
    return np.tile(low, steps), np.tile(high, steps)


def check_names(where: str, end: Any) -> None:
    """Refuse an end of a motion that is no dictionary of a configuration and a velocity."""
    if not isinstance(end, Mapping) or not set(end) <= {"configuration", "restricted_velocity"}:
        raise error(where, "name only configuration and restricted_velocity", shown(end), "Pass a dictionary of them.")


def checked_ends(system: System, start: Any, goal: Any, is_free: bool) -> tuple[Ends, bool]:
    """Return ends of members, and whether there is but one; a free goal need not name anything."""
    (w, g), (to_velocity, to_pose) = (
        _end(f"steer({name}=...)", system, x) for name, x in (("start", start), ("goal", goal))
    )
    if to_pose is None and to_velocity is None and not is_free:
        raise error("steer(goal=...)", "name a pose or a velocity", "neither", "Pass configuration=.")
    first = np.zeros(system.rank) if w is None else w, system.group.identity if g is None else g
    return _members((*first, to_pose, to_velocity))


def _end(where: str, system: System, given: Any) -> tuple[np.ndarray | None, np.ndarray | None]:
    """Return the velocities along the constraint and the poses that an end names, one or many of them."""
    check_names(where, given)
    w, g = given.get("restricted_velocity"), given.get("configuration")
    if w is not None:
        shape = (None,) * (len(shape_of(w)) - 1) + (system.rank,)
        w = array(f"{where}['restricted_velocity']", w, shape[-2:], "Pass one number for each admissible direction.")
    if g is not None:
        where, size = f"{where}['configuration']", system.group.identity.shape
        shape = (None,) * (len(shape_of(g)) - 2) + size
        g = array(where, g, shape[-3:], f"Pass elements of {system.group} as matrices.")
        for one in g.reshape(-1, *size):
            in_group(where, system.group, one)
    return w, g


def _members(ends: tuple[np.ndarray | None, ...]) -> tuple[Ends, bool]:
    """Return ends with an axis of members each, and whether none had one."""
    axes = (1, 2, 2, 1)
    sizes = {len(x) for x, axis in zip(ends, axes, strict=True) if x is not None and x.ndim > axis}
    if len(sizes) > 1 or 0 in sizes:
        got = f"{sorted(sizes)} of them"
        raise error("steer(start=..., goal=...)", "have as many members each", got, "Pass one, or one for each.")
    count = max(sizes, default=1)
    each = (x if x is None else np.broadcast_to(x, (count, *x.shape[-n:])) for x, n in zip(ends, axes, strict=True))
    return cast(Any, tuple(each)), not sizes
