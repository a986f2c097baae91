r"""Linear equations in as few states as there are: without dependent velocities and ignorable coordinates.

Changes of a state obey $C_x\,\delta x + C_v\,\delta v = 0$. With the velocities split into dependent and other ones,
$\delta v_D = -C_{vD}^{-1}(C_x\,\delta x + C_{vI}\,\delta v_I)$. A coordinate is ignorable if no velocity depends on it,
directly or by the rate of another one; it is left out, and may move.
"""

import itertools
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import scipy.linalg

from nonholo.base.types import Bool, Float, Int

_MOST = 1000  # choices of velocities
_SHARE = 0.05  # least singular value of the dependent columns of orthonormal constraints; a good choice has more
_UNSEEN = 1e-11  # of the largest derivative
_STEADY = 1e-7  # of a state


class Local(NamedTuple):
    """Changes beside some states: the steady one, the same later, and others that show what depends on what.

    Attributes:
        names: Those of m numbers of a state: first coordinates seen from its place, then velocities or momenta.
        places: How many of them are coordinates.
        state: The steady state, shape (m,).
        change: Rates of the states, or what a step adds to them, shape (K, m).
        slope: Their derivatives by the states, shape (K, m, m).
        rows: Derivatives of the constraints, shape (K, s, m); those of holonomic ones by velocities are zero.
        later: How many of the states after the first one are the steady motion at later times.
    """

    names: tuple[str, ...]
    places: int
    state: Float[np.ndarray, "m"]
    change: Float[np.ndarray, "K m"]
    slope: Float[np.ndarray, "K m m"]
    rows: Float[np.ndarray, "K s m"]
    later: int


class Reduced(NamedTuple):
    """The linear equations of the states that matter.

    Attributes:
        states: Numbers of these states.
        matrix: Derivatives of their changes.
        defect: Their changes, which vanish in a steady motion.
        directions: Changes of the whole state, a column for each of these states.
        is_steady: Whether they do, and the derivatives stay the same.
        ignorable: Numbers of the coordinates that are left out.
    """

    states: Int[np.ndarray, "d"]
    matrix: Float[np.ndarray, "d d"]
    defect: Float[np.ndarray, "d"]
    directions: Float[np.ndarray, "m d"]
    is_steady: bool
    ignorable: Int[np.ndarray, "_"]


def reduced(local: Local) -> Reduced:
    """Return the equations in the velocities that leave the fewest coordinates, steady if there are such."""
    rows, places = local.rows[0], local.places
    of_places = ~rows[:, places:].any(axis=1)  # holonomic constraints
    holonomic = list(next(_choices(rows[of_places, :places])))
    choices = _choices(rows[~of_places, places:])
    equations = (_without(local, holonomic + [places + i for i in dependent]) for dependent in choices)
    return min(equations, key=lambda each: (not each.is_steady, len(each.states)))


def _choices(rows: Float[np.ndarray, "s n"]) -> Iterator[tuple[int, ...]]:
    """Return sets of velocities that may depend on the others, those of the first coordinates first."""
    s, n = rows.shape
    across = np.linalg.qr(rows.T)[0]
    order: Any = scipy.linalg.qr(across.T, mode="r", pivoting=True)[-1] if s else ()
    for choice in itertools.islice(itertools.combinations(range(n), s), _MOST):
        if not s or np.linalg.svd(across[list(choice)], compute_uv=False)[-1] > _SHARE:
            yield choice
    yield tuple(map(int, order[:s]))


def _without(local: Local, dependent: list[int]) -> Reduced:
    independent = np.setdiff1d(np.arange(len(local.state)), dependent)
    dependence = -np.linalg.solve(local.rows[:, :, dependent], local.rows[:, :, independent])
    slope = local.slope[:, independent][:, :, independent] + local.slope[:, independent][:, :, dependent] @ dependence
    change, count = local.change[:, independent], 1 + local.later
    matters = _influences(_depends(slope), int((independent < local.places).sum()))
    states = independent[matters]
    matrix, defects = slope[:count, matters][:, :, matters], change[:count, matters]
    largest, z = np.abs(local.slope[0]).max(), 1 + np.abs(local.state[states])
    bound = _STEADY * np.abs(matrix[0]) @ z + _UNSEEN * largest * z.max(initial=0.0)
    same = np.abs(matrix - matrix[0]).max(initial=0.0) <= _STEADY * largest
    is_steady = bool(same and np.all(np.abs(defects) <= bound))
    worst = defects[np.argmax(np.abs(defects).max(axis=1, initial=0.0))]
    free = independent[independent < local.places]
    directions = np.eye(len(local.state))[:, independent]
    directions[dependent] = dependence[0]
    return Reduced(states, matrix[0], worst, directions[:, matters], is_steady, np.setdiff1d(free, states))


def _depends(slope: Float[np.ndarray, "K d d"]) -> Bool[np.ndarray, "d d"]:
    """Return which change depends on which state, at any state where the derivatives are finite."""
    finite = slope[np.isfinite(slope).all(axis=(1, 2))]
    return np.any(np.abs(finite) > _UNSEEN * np.abs(finite).max(axis=(1, 2), initial=0.0, keepdims=True), axis=0)


def _influences(depends: Bool[np.ndarray, "d d"], places: int) -> Bool[np.ndarray, "d"]:
    """Return which states the velocities depend on, directly or by other states; velocities are among them."""
    matters = np.arange(len(depends)) >= places
    while np.any(more := depends[matters].any(axis=0) & ~matters):
        matters |= more
    return matters
