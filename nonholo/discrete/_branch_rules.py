r"""Branch rules: which of the values of the discrete map a run takes, and which rules a discretisation has.

The values themselves come from `_branch_values`, following one of them from `_branch_path`. "principal" is not decided
here but where steps are solved.
"""

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np

from nonholo._checks import choice, error, is_integer, shown
from nonholo._results import Outcome
from nonholo.discrete._branch_equations import has_frame
from nonholo.discrete._branch_values import Branches
from nonholo.discrete._discretization import Discretization
from nonholo.discrete._regions import is_regular, regions

Chooser: TypeAlias = Callable[[Branches, np.ndarray], int | None]
BranchRule: TypeAlias = str | Chooser
RULES = ("principal", "nearest", "smallest", "largest", "inner", "outer")
_OF_REGIONS = ("inner", "outer")
_TIED = 1e-9  # relative difference of two norms that rounding may have made


def checked_rule(owner: str, discrete: Discretization, branch: Any) -> Any:
    """Return a branch rule that a discretisation has, or refuse it with the reason."""
    where = f"{owner}(branch=...)"
    if not callable(branch):
        choice(where, branch, RULES, "Or pass a function of the branches and the present displacement.")
    if branch != "principal":
        _check_known(where, discrete, branch)
    return branch


def _check_known(where: str, discrete: Discretization, branch: Any) -> None:
    if discrete.system.is_spatial:
        got = (
            f"{shown(branch)} for a right-invariant constraint, whose equations change with the pose from step to step"
        )
        raise error(where, "be 'principal'", got, "Leave it out.")
    if branch != "nearest" and not has_frame(discrete):
        got = f"{shown(branch)} for {type(discrete.system).__name__}, of whose values not all are known"
        remedy = "All are known of a SuslovTop, ChaplyginSleigh or MultidimensionalSleigh with difference 'matrix'."
        raise error(where, "be 'principal' or 'nearest'", got, remedy)
    if branch in _OF_REGIONS and not is_regular(discrete):
        got = (
            f"{shown(branch)} for {type(discrete.system).__name__}, whose invariant curves have no inner and outer part"
        )
        remedy = "Pass 'nearest'. Only a SuslovTop with n = 3 and det B > 2|c|^2 has regions."
        raise error(where, "be a rule without regions", got, remedy)


def check_regions(owner: str, discrete: Discretization, branch: BranchRule, displacement: np.ndarray) -> None:
    """Refuse "inner" and "outer" for a start whose energy level is connected."""
    if branch in _OF_REGIONS and regions(discrete, displacement[None])[0] not in _OF_REGIONS:
        got = (
            f"{shown(branch)} and an energy from the saddle's on, where both parts of the invariant curve are connected"
        )
        remedy = "Pass 'nearest', or start slower (`critical_energies` has the saddle's energy)."
        raise error(f"{owner}(branch=...)", "have a start in the inner or the outer region", got, remedy)


def chosen(
    rule: BranchRule, found: Branches, present: np.ndarray, nearest: Callable[[], int | None]
) -> tuple[Outcome, int]:
    """Return the index of the value that a rule takes, or why there is none.

    Args:
        rule: Any but "principal" and "nearest".
        found: All values.
        present: The present displacement.
        nearest: Tells the index of the nearest value, for a region where there are three.
    """
    real = np.flatnonzero(found.is_real)
    if callable(rule):
        taken = _by_user(rule, found, present)
    elif rule in _OF_REGIONS:
        taken = [int(i) for i in real if found.region[i] == rule]
        followed = nearest() if len(taken) > 1 else None
        taken = [followed] if followed in taken else taken
    else:
        taken = _extreme(found, real, -1 if rule == "largest" else 1)
    if not taken:
        return Outcome.no_real_branch, -1
    if len(taken) > 1 or found.multiplicity[taken[0]] > 1:
        return Outcome.branch_unverified, -1
    return Outcome.successful, int(taken[0])


def _extreme(found: Branches, real: np.ndarray, sign: int) -> list[int]:
    """Return the real values whose full momentum is smallest (sign 1) or largest (-1): several if they tie."""
    norms = sign * np.linalg.norm(found.momentum[real], axis=1)
    if len(real) == 0:
        return []
    return real[norms <= norms.min() + _TIED * np.abs(norms).max()].tolist()


def _by_user(rule: Chooser, found: Branches, present: np.ndarray) -> list[int]:
    index = rule(found, present)
    if index is None:
        return []
    if not is_integer(index) or not 0 <= index < len(found) or not found.is_real[index]:
        remedy = "Choose among np.flatnonzero(found.is_real), or return None."
        raise error("branch(found, present)", "return the index of a real branch or None", shown(index), remedy)
    return [int(index)]
