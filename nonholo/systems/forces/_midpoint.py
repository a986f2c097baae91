"""The implicit midpoint rule for half an impulse of a force that depends on the velocity."""

from collections.abc import Callable

import numpy as np

from nonholo.base.results import Outcome, OutcomeError
from nonholo.base.types import Float

_ITERATIONS = 30  # of Newton's method with one slope
_ROUNDING = 1e-12  # relative, before the last correction
_DIFFERENCE = 1e-7  # relative, of a momentum


def midpoint_impulse(
    impulse_at: Callable[[np.ndarray], np.ndarray],
    r: Float[np.ndarray, "k"],
    E: Float[np.ndarray, "dim k"],
    to_velocity: Float[np.ndarray, "dim k"],
) -> Float[np.ndarray, "dim"]:
    """Return the impulse at the velocity of the mean of the momenta before and after it; NaN where there is none.

    Raises:
        OutcomeError: The iteration does not converge.
    """

    def impulse(after: np.ndarray) -> np.ndarray:
        return impulse_at(to_velocity @ ((r + after) / 2))

    first = E.T @ impulse(r)
    offsets = _DIFFERENCE * (np.abs(np.append(r, first)).max() or 1.0) * np.eye(len(r))
    slopes = [E.T @ (impulse(r + x) - impulse(r - x)) / (2 * x.max()) for x in offsets]
    slope, after = np.eye(len(r)) - np.nan_to_num(np.transpose(slopes)), r + np.nan_to_num(first)
    for _ in range(_ITERATIONS):
        missed = r + E.T @ impulse(after) - after
        if not np.all(np.isfinite(missed)):
            return np.full(len(E), np.nan)
        small = np.abs(missed).max() <= _ROUNDING * np.abs(np.append(r, after)).max()
        after = after + np.linalg.lstsq(slope, missed)[0]
        if small:
            return impulse(after)
    raise OutcomeError(Outcome.not_converged, "Half impulse of a force that depends on the velocity")
