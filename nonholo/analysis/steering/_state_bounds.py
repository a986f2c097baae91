"""Bounds of states along a motion: the least and the largest value of linear functions of their numbers."""

from collections.abc import Mapping
from typing import Any, NamedTuple, Self

import numpy as np

from nonholo.analysis.steering._arguments import Ends
from nonholo.base.checks import array, error, pair, shown
from nonholo.base.types import Float
from nonholo.groups import SE
from nonholo.systems import System

_WHERE = "steer(state_bounds=...)"
_OUTSIDE = 1e-8  # by which a start or a goal may miss them


class StateBounds(NamedTuple):
    """What is bounded: low <= rows @ numbers <= high, of every state after the start.

    Attributes:
        rows: Coefficients of the numbers of a state.
        low: Least values, some of them infinite.
        high: Largest values.
    """

    rows: Float[np.ndarray, "b x"]
    low: Float[np.ndarray, "b"]
    high: Float[np.ndarray, "b"]

    @classmethod
    def of(cls, given: Any, names: Mapping[str, np.ndarray], ends: Mapping[str, np.ndarray]) -> Self | None:
        """Return checked bounds of rows by name, None where there are none.

        Ends are start and goal, (..., x), NaN in what they leave free. A complex row is of an angle: cosine and sine.
        """
        if given is None:
            return None
        remedy = f"Pass {{name: (least, largest)}} of {', '.join(names)}."
        if not isinstance(given, Mapping) or not set(given) <= set(names):
            raise error(_WHERE, "name what a state has", shown(given), remedy)
        parts = {name: cls._one(name, both, names[name]) for name, both in given.items()}
        for name, part in parts.items():
            for end, numbers in ends.items():
                if (off := part.outside(numbers)) > _OUTSIDE:
                    got, remedy = f"{name} outside by {off:.3g}", "Move it, or make the bounds wider."
                    raise error(f"steer({end}=...)", "lie within state_bounds", got, remedy)
        none = cls(np.zeros((0, next(iter(names.values())).shape[1])), np.zeros(0), np.zeros(0))
        return cls(*map(np.concatenate, zip(none, *parts.values(), strict=True)))

    @classmethod
    def _one(cls, name: str, both: Any, rows: np.ndarray) -> Self:
        """Return the bounds of one name: of an angle those of the cosine of its distance from their middle."""
        where = f"{_WHERE}['{name}']"
        low, high = (_limit(where, end, len(rows)) for end in pair(where, both))
        if not (low < high).all():
            raise error(where, "leave room between them", shown(both), "Pass the least and the largest value.")
        if not np.iscomplexobj(rows):
            return cls(rows, low, high)
        middle, half = (low + high) / 2, (high - low) / 2
        if not (half < np.pi).all():
            raise error(where, "be less than a turn apart", shown(both), "Leave a heading out that may be any.")
        size = np.sin(np.minimum(half, np.pi / 2))  # which makes what is outside an angle, to first order
        return cls((np.exp(-1j * middle) / size * rows).real, np.cos(half) / size, np.full(1, np.inf))

    def outside(self, numbers: Float[np.ndarray, "... x"]) -> float:
        """Return by how much states are outside, at most; what is NaN is not."""
        values = np.nan_to_num(numbers) @ self.rows.T
        is_free = (np.isnan(numbers)[..., None, :] & (self.rows != 0)).any(axis=-1)
        excess = np.where(is_free, 0.0, np.maximum(self.low - values, values - self.high))
        return float(excess.max(initial=0.0))


def _limit(where: str, given: Any, count: int) -> np.ndarray:
    """Return the least or largest value of each row; infinite ones, which bound nothing, are allowed."""
    remedy = "Pass the least and the largest value, numbers or one for each row; infinity for none."
    try:
        infinite = np.where(np.isinf(given), given, 0.0)
    except (TypeError, ValueError):
        infinite = np.zeros(())
    finite = np.where(infinite, 0.0, given) if infinite.any() else given
    return array(where, finite, (count,) if np.ndim(finite) else (), remedy) + infinite + np.zeros(count)


def body_numbers(system: System) -> dict[str, np.ndarray]:
    """Return rows by name for the entries of a pose, then momenta along the constraint."""
    group, N = system.group, system.group.size
    unit = np.eye(N * N + system.rank)
    entries, momenta = unit[: N * N].reshape(N, N, -1), unit[N * N :]
    names = {"restricted_velocity": np.linalg.inv(system.constrained_inertia) @ momenta}
    if group.is_affine:
        names |= {name: entries[i, -1:] for i, name in zip(range(N - 1), "xyz", strict=False)}
    return names | ({"theta": entries[:1, 0] + 1j * entries[1:2, 0]} if group == SE(2) else {})


def bounds_of_body(given: Any, system: System, ends: Ends) -> StateBounds | None:
    """Return checked bounds of states on a group, in which all starts and goals lie."""
    w, g, to_pose, to_velocity = ends
    pose = np.full_like(g, np.nan) if to_pose is None else to_pose
    velocity = np.full_like(w, np.nan) if to_velocity is None else to_velocity
    numbers = [
        body_states(*x) for x in ((g, system.restricted_momentum(w)), (pose, system.restricted_momentum(velocity)))
    ]
    return StateBounds.of(given, body_numbers(system), dict(zip(("start", "goal"), numbers, strict=True)))


def body_states(poses: Float[np.ndarray, "... N N"], momenta: Float[np.ndarray, "... k"]) -> np.ndarray:
    """Return the numbers of states on a group."""
    return np.concatenate([poses.reshape(*poses.shape[:-2], -1), momenta], axis=-1)


def coordinate_numbers(system: Any) -> dict[str, np.ndarray]:
    """Return rows by name for velocities, then coordinates."""
    unit, n = np.eye(2 * system.dimension), system.dimension
    return {"body_velocity": unit[:n]} | {name: unit[n + i, None] for i, name in enumerate(system.coordinates)}
