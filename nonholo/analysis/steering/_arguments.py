"""Arguments of `steer`, checked: ends, limits and guesses; bounds of states; obstacles and places on the way."""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple, Self, cast

import numpy as np

from nonholo.base.checks import array, error, is_integer, pair, real_or_complex, shape_of, shown
from nonholo.base.numerics import double_precision
from nonholo.base.types import Array, Float
from nonholo.groups import SE
from nonholo.systems import Start, System, direction_lengths, in_group, one_start

Ends = tuple[np.ndarray, np.ndarray, np.ndarray | None, np.ndarray | None]
"""First velocities and poses of members, and the poses and velocities that they are to have, None where free."""
BLOCK = 32  # members in one call; of more JAX shares single operations among threads, which takes longer
Limits = tuple[np.ndarray, np.ndarray]
"""The least and the largest force, of each row or of each step and row."""


class Guess(NamedTuple):
    """Where IPOPT begins: a motion, configurations and body covectors, or a path of positions; None if not there."""

    motion: tuple[Float[np.ndarray, "K ..."], Float[np.ndarray, "steps dim"]] | None = None
    path: Float[np.ndarray, "P n"] | None = None

    @property
    def trust(self) -> float:
        """The part of random changes that it is given."""
        return 1.0 if self.motion is None and self.path is None else 0.1


def _checked_guess(guess: Any, steps: int, n: int) -> Guess:
    """Return a guess: a `Steering` of one member with as many steps, or positions of n numbers."""
    where, remedy = "steer(guess=...)", "Pass the result of `steer` for one member, or two positions or more."
    if guess is None:
        return Guess()
    controls = getattr(guess, "controls", None)
    if controls is not None:
        if controls.ndim != 2 or len(controls) != steps:
            raise error(where, f"be of one member and {steps} steps", f"controls of shape {controls.shape}", remedy)
        return Guess((np.asarray(guess.orbit.configuration), controls))
    if not n:
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


VELOCITIES = "restricted_velocity", "body_velocity", "momentum"
"""Names of the velocity of a body on a group; of other systems all but the first."""


def check_names(where: str, end: Any, velocities: tuple[str, ...] = VELOCITIES) -> None:
    """Refuse an end of a motion that is no dictionary of a configuration and a velocity."""
    if not isinstance(end, Mapping) or not set(end) <= {"configuration", *velocities}:
        names = " or ".join(velocities)
        raise error(where, f"name only configuration and {names}", shown(end), "Pass a dictionary of them.")


def velocities_of(end: Mapping[str, Any]) -> dict[str, Any]:
    """Return what an end names besides the configuration."""
    return {name: value for name, value in end.items() if name != "configuration" and value is not None}


def checked_ends(system: System, start: Any, goal: Any, is_free: bool) -> tuple[Ends, bool]:
    """Return ends of members, and whether there is but one; a free goal need not name anything."""
    w, g = _end("start", system, start)
    to_velocity, to_pose = _end("goal", system, goal)
    if to_pose is None and to_velocity is None and not is_free:
        raise error("steer(goal=...)", "name a pose or a velocity", "neither", "Pass configuration=.")
    first = np.zeros(system.rank) if w is None else w, system.group.identity if g is None else g
    return _members((*first, to_pose, to_velocity))


def _end(name: str, system: System, end: Any) -> tuple[np.ndarray | None, np.ndarray | None]:
    """Return the velocities along the constraint and the poses that an end names, one or many of them."""
    check_names(f"steer({name}=...)", end)
    w, owner = None, f"steer.{name}"
    if velocities := velocities_of(end):
        kind = one_start(owner, **velocities)
        axes = max(1, min(2, len(shape_of(velocities[kind]))))
        w = array(f"{owner}({kind}=...)", velocities[kind], (None,) * axes, "Pass one, or one for each member.")
        momenta = [Start(owner, kind, row).momentum(system, None) for row in np.atleast_2d(w)]
        if kind != "restricted_velocity":
            rows = [system.restricted_velocity(system.from_canonical(each)) for each in momenta]
            w = np.array(rows).reshape(*w.shape[:-1], system.rank)
    g, where, size = end.get("configuration"), f"{owner}(configuration=...)", system.group.identity.shape
    if g is not None:
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


_WHERE = "steer(state_bounds=...)"
_OUTSIDE = 1e-8  # by which a start or a goal may miss them


Rows = tuple[np.ndarray, Any]
"""Coefficients of the numbers of a state, and the unit of what they give, one for each row or for all."""


class StateBounds(NamedTuple):
    """Bounds of every state after the start, low <= rows @ numbers <= high, in units.

    Attributes:
        rows: Coefficients of the numbers of a state.
        low: Least values, some of them infinite.
        high: Largest values.
    """

    rows: Float[np.ndarray, "b x"]
    low: Float[np.ndarray, "b"]
    high: Float[np.ndarray, "b"]

    @classmethod
    def of(cls, bounds: Any, names: Mapping[str, Rows], ends: Mapping[str, np.ndarray]) -> Self:
        """Return checked bounds of rows by name.

        Ends are start and goal, (..., x), NaN in what they leave free. A complex row is of an angle: cosine and sine.
        """
        bounds, remedy = {} if bounds is None else bounds, f"Pass {{name: (least, largest)}} of {', '.join(names)}."
        if not isinstance(bounds, Mapping) or not set(bounds) <= set(names):
            raise error(_WHERE, "name components of a state", shown(bounds), remedy)
        parts = {name: cls._one(name, both, *names[name]) for name, both in bounds.items()}
        for name, part in parts.items():
            for end, numbers in ends.items():
                if part.outside(numbers) > _OUTSIDE:
                    off, remedy = (part.excess(numbers) * names[name][1]).max(), "Move it, or make the bounds wider."
                    raise error(f"steer({end}=...)", "lie within state_bounds", f"{name} outside by {off:.3g}", remedy)
        none = cls(np.zeros((0, next(iter(names.values()))[0].shape[1])), np.zeros(0), np.zeros(0))
        return cls(*map(np.concatenate, zip(none, *parts.values(), strict=True)))

    @classmethod
    def _one(cls, name: str, both: Any, rows: np.ndarray, unit: Any) -> Self:
        """Return the bounds of one name: of an angle those of the cosine of its distance from their middle."""
        where = f"{_WHERE}['{name}']"
        low, high = (_limit(where, end, len(rows)) for end in pair(where, both))
        if not (low < high).all():
            raise error(where, "leave room between them", shown(both), "Pass the least and the largest value.")
        if not np.iscomplexobj(rows):
            return cls(rows / np.reshape(unit, (-1, 1)), low / unit, high / unit)
        middle, half = (low + high) / 2, (high - low) / 2
        if not (half < np.pi).all():
            raise error(where, "be less than a turn apart", shown(both), "Leave a heading out that may be any.")
        size = np.sin(np.minimum(half, np.pi / 2))  # which makes what is outside an angle, to first order
        return cls((np.exp(-1j * middle) / size * rows).real, np.cos(half) / size, np.full(1, np.inf))

    def outside(self, numbers: Float[np.ndarray, "... x"]) -> float:
        """Return by how much states are outside, at most."""
        return float(self.excess(numbers).max(initial=0.0))

    def excess(self, numbers: Float[np.ndarray, "... x"]) -> Float[np.ndarray, "... b"]:
        """Return by how much states are outside of each bound, negative within; what is NaN is not."""
        values = np.nan_to_num(numbers) @ self.rows.T
        is_free = (np.isnan(numbers)[..., None, :] & (self.rows != 0)).any(axis=-1)
        return np.where(is_free, 0.0, np.maximum(self.low - values, values - self.high))


def _limit(where: str, value: Any, count: int) -> np.ndarray:
    """Return the least or largest value of each row; infinite ones, which bound nothing, are allowed."""
    remedy = "Pass the least and the largest value, numbers or one for each row; infinity for none."
    raw = real_or_complex(where, value, remedy)
    infinite = np.where(np.isinf(raw), raw, 0.0)
    finite = np.where(infinite, 0.0, raw)
    return array(where, finite, (count,) if raw.ndim else (), remedy) + infinite + np.zeros(count)


def state_units(system: System, duration: float) -> tuple[Float[np.ndarray, "dim"], Float[np.ndarray, "k"]]:
    """Return units of displacements, radians and the length of the body, and velocities that pass these in a time."""
    units = system.displacement_units
    return units, 1 / direction_lengths(system.constraint_subspace, units) / duration


def body_numbers(system: System, duration: float) -> dict[str, Rows]:
    """Return rows by name for the entries of a pose, then momenta along the constraint."""
    size, (lengths, speeds) = system.group.size**2, state_units(system, duration)
    unit = np.eye(size + system.rank)
    velocity = np.linalg.inv(system.constrained_inertia) @ unit[size:]
    return {"restricted_velocity": (velocity, speeds)} | _pose_numbers(system.group, unit[:size], lengths[-1])


def _pose_numbers(group: Any, rows: Float[np.ndarray, "NN x"], length: float) -> dict[str, Rows]:
    """Return rows by name from those for the entries of a pose."""
    entries, axes = rows.reshape(group.size, group.size, -1), "xyz"[: group.size - 1] if group.is_affine else ""
    names = {name: (entries[i, -1:], length) for i, name in enumerate(axes)}
    return names | ({"theta": (entries[:1, 0] + 1j * entries[1:2, 0], 1.0)} if group == SE(2) else {})


def bounds_of_body(bounds: Any, system: System, ends: Ends, duration: float) -> StateBounds:
    """Return checked bounds of states on a group, in which all starts and goals lie."""
    w, g, to_pose, to_velocity = ends
    pose = np.full_like(g, np.nan) if to_pose is None else to_pose
    velocity = np.full_like(w, np.nan) if to_velocity is None else to_velocity
    start, goal = body_states(g, system.restricted_momentum(w)), body_states(pose, system.restricted_momentum(velocity))
    return StateBounds.of(bounds, body_numbers(system, duration), {"start": start, "goal": goal})


def body_states(poses: Float[np.ndarray, "... N N"], momenta: Float[np.ndarray, "... k"]) -> np.ndarray:
    """Return the numbers of states on a group."""
    return np.concatenate([poses.reshape(*poses.shape[:-2], -1), momenta], axis=-1)


def coordinate_numbers(system: Any, sizes: Float[np.ndarray, "n"], duration: float) -> dict[str, Rows]:
    """Return rows by name for velocities, then coordinates or the entries of a pose, for a way of some size."""
    n = system.dimension
    unit = np.eye(n + math.prod(system.shapes[0]))
    velocity = {"body_velocity": (unit[:n], sizes / duration)}
    if not system.coordinates:
        return velocity | _pose_numbers(system.group, unit[n:], sizes[-1])
    return velocity | {name: (unit[n + i, None], sizes[i]) for i, name in enumerate(system.coordinates)}


def numbers_of_position(system: Any) -> list[int]:
    """Return which numbers of a configuration are its position; none where bodies have none."""
    if names := getattr(system, "coordinates", ()):
        return list(map(names.index, "xy")) if {"x", "y"} <= set(names) else []
    size = system.group.size
    return list(range(size - 1, size**2 - 1, size)) if system.group.is_affine else []


class Way(NamedTuple):
    """Discs or balls to keep clear of, places to pass, and bounds of all states.

    Attributes:
        centers: Of obstacles.
        radii: Of obstacles.
        outline: Body points that keep clear of them, or a function of the configuration that returns them.
        via: Places of the body frame, by number of the step after which it is there.
        guess: Where IPOPT begins.
        bounds: Of states; None where they are free.
    """

    centers: Float[np.ndarray, "obstacles n"]
    radii: Float[np.ndarray, "obstacles"]
    outline: Any
    via: dict[int, Float[np.ndarray, "n"]]
    guess: Guess = Guess()
    bounds: Any = None

    @classmethod
    def of(cls, system: Any, steps: int, obstacles: Any, outline: Any, via: Any, guess: Any) -> "Way":
        """Return checked arguments of `steer` for a system."""
        n = len(numbers_of_position(system))
        hint = _checked_guess(guess, steps, n)
        if not n:
            if not (obstacles is None and outline is None and via is None):
                remedy = "Leave obstacles, outline and via out: only bodies on SE(n) or with x and y have a position."
                raise error("steer(discrete=...)", "have a position", "a system without", remedy)
            return cls(np.zeros((0, 0)), np.zeros(0), np.zeros((1, 0)), {}, hint)
        where, remedy = "steer(obstacles=...)", f"Pass centers (obstacles, {n}), and one radius or one for each."
        centers, radii = pair(where, ((np.zeros((0, n)), 1.0) if obstacles is None else obstacles))
        centers = array(where, centers, (None, n), remedy)
        radii = array(where, radii, () if shape_of(radii) == () else (len(centers),), remedy)
        if not (radii > 0).all():
            raise error(where, "have positive radii", shown(radii), remedy)
        outline = _checked_outline(system, n, outline)
        return cls(centers, np.broadcast_to(radii, len(centers)), outline, _places(n, steps, via), hint)

    def positions(self, ends: Mapping[int, Float[np.ndarray, "n"]], steps: int) -> Float[np.ndarray, "K n"]:
        """Return positions to begin with: along the path of the guess, or evenly between the ends and the places."""
        if self.guess.path is not None:
            return resample(self.guess.path, steps)
        at = dict(sorted({**ends, **self.via}.items()))
        columns = np.array(list(at.values())).T
        return np.array([np.interp(np.arange(steps + 1), list(at), column) for column in columns]).T

    def penetration(self, points: Float[np.ndarray, "... points n"]) -> float:
        """Return how deep points of the outline lie in an obstacle; zero where all are clear."""
        apart = np.linalg.norm(points[..., None, :] - self.centers, axis=-1) - self.radii
        return max(0.0, -float(apart.min(initial=np.inf)))

    def gap(self, points: Float[np.ndarray, "K points n"], positions: Float[np.ndarray, "K n"]) -> float:
        """Return by how much a motion comes too near to an obstacle, or misses a place, whichever is more.

        States are clear of obstacles; a step over one, by half of its radius on a straight line, comes too near too.
        """
        begin, along = points[:-1, :, None], points[1:, :, None] - points[:-1, :, None]
        off, square = self.centers - begin, (along**2).sum(axis=-1)
        part = np.clip((off * along).sum(axis=-1) / np.where(square > 0, square, 1.0), 0.0, 1.0)
        depth = self.radii - np.linalg.norm(off - part[..., None] * along, axis=-1)
        leaps = float(np.where(depth > self.radii / 2, depth, 0.0).max(initial=0.0))
        off = [float(np.abs(positions[step] - place).max()) for step, place in self.via.items()]
        return max(self.penetration(points), leaps, *off, 0.0)

    def check(self, name: str, points: Float[np.ndarray, "... points n"] | None) -> None:
        """Refuse a start or a goal inside of an obstacle."""
        if points is not None and (depth := self.penetration(points)) > 0:
            got = f"a point {depth:.3g} inside of one"
            raise error(f"steer({name}=...)", "be clear of obstacles", got, "Move it, or make the obstacle smaller.")


def _checked_outline(system: Any, n: int, outline: Any) -> Any:
    """Return checked points of the body, by default its origin; in coordinates also a function of them."""
    where, origin = "steer(outline=...)", np.zeros((1, n))
    if callable(outline):
        if getattr(system, "coordinates", ()):
            return outline
        remedy = "Bodies on groups have no shape: pass points."
        raise error(where, "be points of a body on a group", "a function", remedy)
    points = array(where, origin if outline is None else outline, (None, n), "Pass points of the body.")
    if not len(points):
        raise error(where, "have a point", "none", "Leave it out for the origin of the body frame.")
    return points


def _places(n: int, steps: int, via: Any) -> dict[int, np.ndarray]:
    where, remedy = "steer(via=...)", f"Pass {{step: position}}, steps from 1 to {steps}."
    if via is None:
        return {}
    if not isinstance(via, Mapping) or not all(is_integer(step) and 0 < step <= steps for step in via):
        raise error(where, "name places by the number of a step", shown(via), remedy)
    return {int(step): array(where, place, (n,), remedy) for step, place in via.items()}


def resample(path: Float[np.ndarray, "P n"], steps: int) -> Float[np.ndarray, "K n"]:
    """Return as many points of a path as there are states, at equal distances along it."""
    far = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1)))
    return np.array([np.interp(np.linspace(0, far[-1], steps + 1), far, column) for column in path.T]).T


def body_points(g: Float[Array, "... N N"], outline: Float[Array, "points n"]) -> Float[Array, "... points n"]:
    """Return where points of a body are at poses."""
    n = outline.shape[-1]
    return g[..., None, :n, -1] + outline @ g[..., :n, :n].swapaxes(-1, -2)


def points_at(system: Any, q: Float[Array, "..."], outline: Any) -> Float[Array, "... points n"]:
    """Return where points of a body are at poses, or with coordinates x and y, turned by the heading if it has one.

    The points are given, or a function of the configuration that JAX traces.
    """
    if not system.coordinates:
        return body_points(q, outline)
    names, xp = system.coordinates, q.__array_namespace__()
    x, y = (q[..., names.index(name)] for name in ("x", "y"))
    turn = xp.zeros_like(x) if system.heading is None else q[..., names.index(system.heading)]
    c, s = xp.cos(turn), xp.sin(turn)
    rows = xp.stack([xp.stack([c, s], axis=-1), xp.stack([-s, c], axis=-1)], axis=-2)
    at = q[..., : system.dimension]
    if callable(outline) and isinstance(q, np.ndarray):
        with double_precision():
            points = np.array([outline(each) for each in at.reshape(-1, at.shape[-1])])
        points = points.reshape(*at.shape[:-1], *outline.shape)
    else:
        points = outline(at) if callable(outline) else outline
    return xp.stack([x, y], axis=-1)[..., None, :] + points @ rows
