r"""Following one root of the equations of `_branch_equations` while the momentum moves along a segment.

Reference: docs/theory/branches.md, "Following a value".
"""

import dataclasses

import numpy as np

from nonholo import kernels
from nonholo.base.results import Outcome
from nonholo.base.types import Float
from nonholo.discrete.branching._equations import Equations

_LONGEST = 0.1  # a predicted move per continuation step, on the sphere
_CLOSE = 0.1  # part of the predicted move that the corrector may add
_SMALL = 1e-3  # a corrector's move that is always accepted where the predicted one is smaller
_CORRECTIONS = 6  # of Newton's method
_CONVERGED = 1e-11  # a correction after which the next one is below rounding
_SHORTEST = 1e-10  # continuation step below which the root is given up
_FOLD = 1e-2  # regularity below which a root that cannot be followed has met a fold
_SINGULAR = 1e-8  # regularity of a root that cannot be followed at all
_CLEAR = 10.0  # times that, for a bound of it that rounding has moved
_TRANSVERSAL = 1e-6  # part of the momentum's motion across a fold below which the singular point is no fold
_FAR = 1e5  # length of a displacement that counts as infinite


def followed(start: Equations, end: Equations, x: Float[np.ndarray, "m"]) -> tuple[Outcome, Float[np.ndarray, "m"]]:
    """Follow a real root of the first equations to the second ones, which differ in target and push alone.

    Returns:
        The outcome, and the root or the last point that was reached.
    """
    if start.regularity(x) < _SINGULAR:
        return Outcome.branch_unverified, x
    direction = _motion(start, end)
    slope = start.slope(x)
    side, s, size = np.sign(np.linalg.det(slope)), 0.0, 1.0
    while s < 1.0:
        tangent = np.linalg.solve(slope, direction)
        pace = _length(tangent, x)
        size = min(size, 1.0 - s, _LONGEST / pace if pace > 0 else 1.0)
        ahead = 1.0 if size == 1.0 - s else s + size
        found = _corrected(_between(start, end, ahead), x + size * tangent, size * pace)
        if found is not None and np.sign(np.linalg.det(end.slope(found))) == side:
            x, s, size, slope = found, ahead, 2 * size, end.slope(found)
        elif size > _SHORTEST:
            size /= 4
        else:
            return _why_it_ended(_between(start, end, s), direction, x), x
    return Outcome.successful, x


def nearest_body(equations: Equations) -> kernels.NearestBody:
    """Return what a kernel follows the roots of equations by, whatever their target and push."""
    slides, inertia = equations.lever is not None, equations.stiffness + equations.arm**2
    how = (_LONGEST, _CLOSE, _SMALL, _CORRECTIONS, _CONVERGED, _SHORTEST, _CLEAR * _SINGULAR)
    return kernels.NearestBody(inertia, equations.coupling, equations.arm, slides, *how)


def _motion(start: Equations, end: Equations) -> Float[np.ndarray, "m"]:
    """Return how the right-hand sides move, in the order of the residual."""
    pushed = [] if start.lever is None else [end.push - start.push]
    return np.array([*(end.target - start.target), *pushed, 0.0])


def _between(start: Equations, end: Equations, s: float) -> Equations:
    if s == 1.0:
        return end
    target, push = start.target + s * (end.target - start.target), start.push + s * (end.push - start.push)
    return dataclasses.replace(start, target=target, push=push)


def _length(move: np.ndarray, x: np.ndarray) -> float:
    """Return the size of a move, of the length u relative to u where that is large."""
    return float(np.linalg.norm(move / np.maximum(1.0, np.abs(x))))


def _corrected(equations: Equations, guess: np.ndarray, predicted: float) -> Float[np.ndarray, "m"] | None:
    """Return the root next to a guess by Newton's method; None if it is further away than the prediction allows."""
    x, allowed = guess, max(_CLOSE * predicted, min(_SMALL, predicted))
    for _ in range(_CORRECTIONS):
        try:
            correction = np.linalg.solve(equations.slope(x), equations.residual(x)[0])
        except np.linalg.LinAlgError:
            return None
        x = x - correction
        if not _length(x - guess, guess) <= allowed + _CONVERGED:
            return None
        if _length(correction, x) <= _CONVERGED:
            return x
    return None


def _why_it_ended(equations: Equations, direction: np.ndarray, x: np.ndarray) -> Outcome:
    """Tell a fold from another singular point, from a root that goes to infinity, and from a failure to converge."""
    if not np.all(np.isfinite(x)):
        return Outcome.nonfinite
    if np.abs(x).max() > _FAR:
        return Outcome.branch_unverified
    if equations.regularity(x) > _FOLD:
        return Outcome.not_converged
    left = np.linalg.svd(equations.slope(x))[0][:, -1]
    across = abs(left @ direction) > _TRANSVERSAL * np.linalg.norm(direction)
    return Outcome.no_real_branch if across else Outcome.branch_unverified
