"""What a way is to keep to beside start and goal: obstacles, places at steps; checked arguments and what is missed."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from nonholo.analysis.steering._state_bounds import StateBounds
from nonholo.base.checks import array, error, is_integer, pair, shape_of, shown
from nonholo.base.types import Array, Float


class Way(NamedTuple):
    """Discs or balls to keep clear of, places to pass, and bounds of all states.

    Attributes:
        centers: Of obstacles.
        radii: Of obstacles.
        outline: Body points that keep clear of them.
        via: Places of the body frame, by number of the step after which it is there.
        bounds: Of states; None where they are free.
    """

    centers: Float[np.ndarray, "obstacles n"]
    radii: Float[np.ndarray, "obstacles"]
    outline: Float[np.ndarray, "points n"]
    via: dict[int, Float[np.ndarray, "n"]]
    bounds: StateBounds | None = None

    @classmethod
    def of(cls, n: int | None, steps: int, obstacles: Any, outline: Any, via: Any) -> "Way":
        """Return checked arguments of `steer`, for positions of n numbers; None where bodies have none."""
        if n is None:
            if not (obstacles is None and outline is None and via is None):
                remedy = "Leave obstacles, outline and via out: only bodies on SE(n) or with x and y are somewhere."
                raise error("steer(discrete=...)", "have a position", "a system without", remedy)
            return cls(np.zeros((0, 0)), np.zeros(0), np.zeros((1, 0)), {})
        where, remedy = "steer(obstacles=...)", f"Pass centers (obstacles, {n}), and one radius or one for each."
        centers, radii = pair(where, ((np.zeros((0, n)), 1.0) if obstacles is None else obstacles))
        centers = array(where, centers, (None, n), remedy)
        radii = array(where, radii, () if shape_of(radii) == () else (len(centers),), remedy)
        if not (radii > 0).all():
            raise error(where, "have positive radii", shown(radii), remedy)
        where = "steer(outline=...)"
        outline = array(where, np.zeros((1, n)) if outline is None else outline, (None, n), "Pass points of the body.")
        if not len(outline):
            raise error(where, "have a point", "none", "Leave it out for the origin of the body frame.")
        return cls(centers, np.broadcast_to(radii, len(centers)), outline, _places(n, steps, via))

    def blocked(self, points: Float[np.ndarray, "... points n"]) -> float:
        """Return how deep points of the outline lie in an obstacle; zero where all are clear."""
        apart = np.linalg.norm(points[..., None, :] - self.centers, axis=-1) - self.radii
        return max(0.0, -float(apart.min(initial=np.inf)))

    def outside(self, numbers: Float[np.ndarray, "... x"]) -> float:
        """Return by how much states are out of their bounds, at most."""
        return 0.0 if self.bounds is None else self.bounds.outside(numbers)

    def missed(self, points: Float[np.ndarray, "K points n"], positions: Float[np.ndarray, "K n"]) -> float:
        """Return by how much a motion comes too near to an obstacle, or misses a place, whichever is more.

        States are clear of obstacles; a step over one, by half of its radius on a straight line, comes too near too.
        """
        depth = self.radii - _apart(points[:-1, :, None], points[1:, :, None], self.centers)
        leaps = float(np.where(depth > self.radii / 2, depth, 0.0).max(initial=0.0))
        off = [float(np.abs(positions[step] - place).max()) for step, place in self.via.items()]
        return max(self.blocked(points), leaps, *off, 0.0)

    def check(self, name: str, points: Float[np.ndarray, "... points n"] | None) -> None:
        """Refuse a start or a goal inside of an obstacle."""
        if points is not None and (depth := self.blocked(points)) > 0:
            got = f"a point {depth:.3g} inside of one"
            raise error(f"steer({name}=...)", "be clear of obstacles", got, "Move it, or make the obstacle smaller.")


def _apart(begin: np.ndarray, end: np.ndarray, centers: np.ndarray) -> np.ndarray:
    """Return the distances of points from the straight lines between others."""
    along, off = end - begin, centers - begin
    square = (along**2).sum(axis=-1)
    part = np.clip((off * along).sum(axis=-1) / np.where(square > 0, square, 1.0), 0.0, 1.0)
    return np.linalg.norm(off - part[..., None] * along, axis=-1)


def _places(n: int, steps: int, via: Any) -> dict[int, np.ndarray]:
    where, remedy = "steer(via=...)", f"Pass {{step: position}}, steps from 1 to {steps}."
    if via is None:
        return {}
    if not isinstance(via, Mapping) or not all(is_integer(step) and 0 < step <= steps for step in via):
        raise error(where, "name places by the number of a step", shown(via), remedy)
    return {int(step): array(where, place, (n,), remedy) for step, place in via.items()}


def evenly(at: Mapping[int, Float[np.ndarray, "n"]], steps: int) -> Float[np.ndarray, "K n"]:
    """Return a path that is evenly between points at some steps."""
    order = sorted(at)
    columns = np.array([at[step] for step in order]).T
    return np.array([np.interp(np.arange(steps + 1), order, column) for column in columns]).T


def resampled(path: Float[np.ndarray, "P n"], steps: int) -> Float[np.ndarray, "K n"]:
    """Return as many points of a path as there are states, at equal distances along it."""
    far = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1)))
    return np.array([np.interp(np.linspace(0, far[-1], steps + 1), far, column) for column in path.T]).T


def body_points(g: Float[Array, "... N N"], outline: Float[Array, "points n"]) -> Float[Array, "... points n"]:
    """Return where points of a body are at poses."""
    n = outline.shape[-1]
    return g[..., None, :n, -1] + outline @ g[..., :n, :n].swapaxes(-1, -2)


def planar_points(
    system: Any, q: Float[Array, "... n"], outline: Float[Array, "points 2"]
) -> Float[Array, "... points 2"]:
    """Return where points of a body with coordinates x and y are, turned by the heading where it has one."""
    names, xp = system.coordinates, q.__array_namespace__()
    x, y = (q[..., names.index(name)] for name in ("x", "y"))
    turn = xp.zeros_like(x) if system.heading is None else q[..., names.index(system.heading)]
    c, s = xp.cos(turn), xp.sin(turn)
    rows = xp.stack([xp.stack([c, s], axis=-1), xp.stack([-s, c], axis=-1)], axis=-2)
    return xp.stack([x, y], axis=-1)[..., None, :] + outline @ rows
