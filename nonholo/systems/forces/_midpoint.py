"""The implicit midpoint rule for half an impulse of a force that depends on the velocity."""

from collections.abc import Callable

import numpy as np

from nonholo.base.results import Outcome, OutcomeError
from nonholo.base.types import Float

_ITERATIONS = 30  # of Newton's method with one slope
_MOST, _PARTS = 100, 0.5 ** np.arange(40)  # corrections with new slopes, and parts of one
_ROUNDING = 1e-12  # relative, before the last correction
_DIFFERENCE = 1e-7  # relative, of a momentum

Function = Callable[[np.ndarray], np.ndarray]


def midpoint_impulse(
    impulse_at: Callable[[np.ndarray], np.ndarray],
    r: Float[np.ndarray, "k"],
    E: Float[np.ndarray, "dim k"],
    to_velocity: Float[np.ndarray, "dim k"],
) -> Float[np.ndarray, "dim"]:
    """Return the impulse at the velocity of the mean of the momenta before and after it; NaN where there is none.

    Raises:
        OutcomeError: There is no such impulse nearby.
    """

    def impulse(after: np.ndarray) -> np.ndarray:
        return impulse_at(to_velocity @ ((r + after) / 2))

    def missed(after: np.ndarray) -> np.ndarray:
        return r + E.T @ impulse(after) - after

    def slope_at(after: np.ndarray) -> np.ndarray:
        slopes = [E.T @ (impulse(after + x) - impulse(after - x)) / (2 * x.max()) for x in offsets]
        return np.eye(len(r)) - np.nan_to_num(np.transpose(slopes))

    first = E.T @ impulse(r)
    offsets = _DIFFERENCE * (np.abs(np.append(r, first)).max() or 1.0) * np.eye(len(r))
    slope = slope_at(r)
    after = _root(missed, lambda _: slope, r, r + np.nan_to_num(first), _ITERATIONS, shortens=False)
    if after is None:
        after = _root(missed, slope_at, r, r, _MOST, shortens=True)
    if after is None:
        raise OutcomeError(Outcome.no_half_impulse, "Half impulse of a force that depends on the velocity")
    return impulse(after)


def _root(
    missed: Function, slope_at: Function, r: np.ndarray, after: np.ndarray, most: int, *, shortens: bool
) -> np.ndarray | None:
    """Return the momenta after the impulse by Newton's method, which may halve corrections that miss more; or None."""
    for _ in range(most):
        gap = missed(after)
        left = np.abs(gap).max()
        if not left < np.inf:
            return np.full_like(r, np.nan) if shortens else None
        change, parts = np.linalg.lstsq(slope_at(after), gap)[0], _PARTS if shortens else _PARTS[:1]
        if left <= _ROUNDING * np.abs(np.append(r, after)).max():
            return after + change
        better = (part for part in parts if not shortens or np.abs(missed(after + part * change)).max() < left)
        if (part := next(better, None)) is None:
            return None
        after = after + part * change
    return None
