r"""Steps by a branch rule, on the sphere over the displacement variety: the start, the next state, one whole step.

For tops and sleighs. In the coordinates of `_branch_equations` nothing is special at angle $\pi$.
"""

from typing import NamedTuple

import numpy as np

from nonholo import kernels
from nonholo.base.results import Outcome
from nonholo.base.types import Float
from nonholo.discrete._discretization import Discretization
from nonholo.discrete.branching._branches import inverse_discrete_legendre
from nonholo.discrete.branching._equations import Frame
from nonholo.discrete.branching._path import nearest_body
from nonholo.discrete.branching._rules import AbstractBranchRule, Kick, displacement_at, principal_point


class Place(NamedTuple):
    """A state: the point over the displacement, and the canonical momentum along the constraint subspace."""

    point: Float[np.ndarray, "m"]
    momentum: Float[np.ndarray, "k"]


def first_place(
    owner: str,
    discrete: Discretization,
    frame: Frame,
    rule: AbstractBranchRule,
    canonical: Float[np.ndarray, "k"],
    demanded: np.ndarray | None,
) -> tuple[Outcome, Place | None]:
    """Return the state of a start: of a displacement, of a full momentum, or else the principal one."""
    if demanded is None:
        code, point = principal_point(discrete, frame, canonical)
        if code != 0:
            return code, None
        place = Place(point, canonical)
    else:
        W = demanded if demanded.ndim == 2 else inverse_discrete_legendre(discrete, demanded)
        place = _place_of(discrete, frame, W)
    rule.check_start(f"{owner}(branch=...)", discrete, displacement_at(discrete, frame, place.point))
    return Outcome.successful, place


def _place_of(discrete: Discretization, frame: Frame, W: Float[np.ndarray, "N N"]) -> Place:
    """Return the state with a displacement of the variety."""
    system, k = discrete.system, len(frame.stiffness)
    x = frame.point(system.group.inverse(system.frame) @ W @ system.frame)
    rows = frame.equations(np.zeros(len(system.constraint_subspace))).residual(x)[0]
    return Place(x, frame.momentum(rows[:k], rows[k]) / discrete.time_step)


def next_place(discrete: Discretization, frame: Frame, rule: AbstractBranchRule, place: Place) -> tuple[Outcome, Place]:
    """Return the outcome and the state that follows by a rule; the present one where none follows."""
    h = discrete.time_step
    now = frame.equations(h * place.momentum)
    momentum = place.momentum + frame.momentum(*now.kick(place.point)) / h
    code, x = rule.following(Kick(discrete, frame, place.point, now, frame.equations(h * momentum), momentum))
    return code, Place(x, momentum) if code == 0 else place


def goal_of(discrete: Discretization, frame: Frame, momentum: Float[np.ndarray, "k"]) -> Float[np.ndarray, "g"]:
    """Return what the kernel of clear steps makes of a canonical momentum."""
    now = frame.equations(float(discrete.time_step) * momentum)
    return now.target if now.lever is None else np.append(now.target, now.push)


def clear_places(
    discrete: Discretization,
    frame: Frame,
    begin: Float[np.ndarray, "k"],
    goal: Float[np.ndarray, "g"],
    point: Float[np.ndarray, "m"],
    count: int,
) -> tuple[Place, Float[np.ndarray, "C g"]]:
    """Return the states that follow by clear steps to the nearest value, up to `count` of them, and their goals.

    Momenta are summed from the one at which the goals began, so that they do not depend on how steps are cut.
    """
    h, k = float(discrete.time_step), len(frame.stiffness)
    first, now = goal_of(discrete, frame, begin), frame.equations(h * begin)
    goals, points = np.empty((count, len(goal))), np.empty((count, len(point)))
    done = kernels.advance_to_nearest(nearest_body(now), goal, point, goals, points)
    moved = goals[:done] - first
    return Place(points[:done], begin + frame.momentum(moved[:, :k], moved[:, -1]) / h), goals[:done]
