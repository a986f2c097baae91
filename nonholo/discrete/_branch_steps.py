r"""Steps by a branch rule, on the sphere over the displacement variety: the start, the next state, one whole step.

For tops and sleighs. In the coordinates of `_branch_equations` nothing is special at angle $\pi$.
"""

from typing import NamedTuple

import numpy as np

from nonholo._results import Outcome
from nonholo._types import Float
from nonholo.discrete._branch_equations import Equations, Frame
from nonholo.discrete._branch_path import followed
from nonholo.discrete._branch_rules import BranchRule, check_regions, chosen
from nonholo.discrete._branch_values import SAME, Roots, branches_of, principal_increment, roots_over
from nonholo.discrete._branches import inverse_discrete_legendre
from nonholo.discrete._discretization import Discretization


class Place(NamedTuple):
    """A state: the point over the displacement, and the canonical momentum along the constraint subspace."""

    point: Float[np.ndarray, "m"]
    momentum: Float[np.ndarray, "k"]


def first_place(
    owner: str,
    discrete: Discretization,
    frame: Frame,
    rule: BranchRule,
    canonical: Float[np.ndarray, "k"],
    demanded: np.ndarray | None,
) -> tuple[Outcome, Place | None]:
    """Return the state of a start: of a displacement, of a full momentum, or else the principal one."""
    if demanded is None:
        code, X = principal_increment(discrete, canonical)
        if code != 0:
            return code, None
        place = Place(frame.point(X + discrete.system.group.identity), canonical)
    else:
        W = demanded if demanded.ndim == 2 else inverse_discrete_legendre(discrete, demanded)
        place = _place_of(discrete, frame, W)
    check_regions(owner, discrete, rule, displacement_at(discrete, frame, place.point))
    return Outcome.successful, place


def _place_of(discrete: Discretization, frame: Frame, W: Float[np.ndarray, "N N"]) -> Place:
    """Return the state with a displacement of the variety."""
    system, k = discrete.system, len(frame.stiffness)
    x = frame.point(system.group.inverse(system.frame) @ W @ system.frame)
    rows = frame.equations(np.zeros(len(system.constraint_subspace))).residual(x)[0]
    return Place(x, frame.momentum(rows[:k], rows[k]) / discrete.time_step)


def displacement_at(discrete: Discretization, frame: Frame, x: np.ndarray) -> Float[np.ndarray, "N N"]:
    """Return the displacement over a point, in the user's frame."""
    system = discrete.system
    return system.frame @ frame.increment(x) @ system.group.inverse(system.frame) + system.group.identity


def next_place(discrete: Discretization, frame: Frame, rule: BranchRule, place: Place) -> tuple[Outcome, Place]:
    """Return the outcome and the state that follows by a rule; the present one where none follows."""
    h = discrete.time_step
    now = frame.equations(h * place.momentum)
    momentum = place.momentum + frame.momentum(*now.kick(place.point)) / h
    ahead = frame.equations(h * momentum)
    if rule == "nearest":
        code, x = followed(now, ahead, place.point)
        return code, Place(x, momentum) if code == 0 else place
    roots = roots_over(discrete, frame, momentum)
    present = displacement_at(discrete, frame, place.point)
    found = branches_of(discrete, momentum, roots)
    code, index = chosen(rule, found, present, lambda: _nearest_of(now, roots, place.point))
    return code, Place(roots.found[index].point.real, momentum) if code == 0 else place


def _nearest_of(now: Equations, roots: Roots, x: np.ndarray) -> int | None:
    """Return the index of the root that the present point is followed to; None if it is lost."""
    code, end = followed(now, roots.equations, x)
    missed = [min(np.linalg.norm(end - root.point), np.linalg.norm(end + root.point)) for root in roots.found]
    best = int(np.argmin(missed))
    return best if code == 0 and missed[best] <= SAME * np.linalg.norm(end) else None
