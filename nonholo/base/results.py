"""Outcomes of a run: one enumeration, whose texts are the messages that users read; and how results are printed.

Three failures are never confused: the solve did not converge, the root lies on another branch, the branch ends here.
"""

import dataclasses
import enum
import textwrap
from typing import Any, TypeVar, dataclass_transform

import numpy as np

_T = TypeVar("_T")
_WIDE = 110  # characters of a value
_MANY = 40  # numbers of an array that is not printed


@dataclass_transform(frozen_default=True, eq_default=False, field_specifiers=(dataclasses.field,))
def result(kind: type[_T]) -> type[_T]:
    """Make a frozen dataclass of values that are found, printed as a table unless it prints itself."""
    if "__repr__" not in vars(kind):
        kind.__repr__ = as_table
    return dataclasses.dataclass(frozen=True, eq=False)(kind)


def as_table(self: Any) -> str:
    """Return the values of a dataclass or a named tuple as lines."""
    names = getattr(self, "_fields", None) or [field.name for field in dataclasses.fields(self) if field.repr]
    margin = max(map(len, names)) + 4
    rows = (f"{name:>{margin - 2}}: {_cell(getattr(self, name), ' ' * margin)}" for name in names)
    return "\n".join([type(self).__name__, *rows])


def _cell(value: Any, margin: str) -> str:
    if getattr(value, "size", 0) > _MANY:  # of JAX, too
        return f"shape {value.shape}"
    if isinstance(value, np.ndarray):
        return np.array2string(value, _WIDE, 6, prefix=margin)
    if isinstance(value, tuple) and value and dataclasses.is_dataclass(value[0]):
        return f"{len(value)} of {type(value[0]).__name__}"
    text = f"{value:.6g}" if isinstance(value, float) else str(value)
    return textwrap.shorten(text, _WIDE, placeholder=" ...")


class Outcome(enum.IntEnum):
    """The end of a step or a run.

    Arrays of outcomes hold the integer value; `message` has the event, its reason and a remedy.

    Example:
        >>> print(Outcome.no_real_branch, int(Outcome.successful))
        no_real_branch 0
    """

    successful = 0
    no_real_branch = 1
    branch_unverified = 2
    not_converged = 3
    off_momentum_locus = 4
    nonfinite = 5
    too_stiff = 6
    no_half_impulse = 7
    lasting_contact = 8

    def __str__(self) -> str:
        return self.name

    @property
    def message(self) -> str:
        """The message: what happened, why, and what to try."""
        return _MESSAGES[self]


OUTCOMES = tuple(Outcome)
"""By number."""
_MESSAGES = {
    Outcome.successful: "Every step succeeded.",
    Outcome.no_real_branch: (
        "The branch folds before it reaches this momentum, so the next step has no real solution. A branch rule may "
        "also have found none. The map is multivalued and folds at large step angles. Try a smaller time_step or a "
        "slower motion."
    ),
    Outcome.branch_unverified: (
        "A root was found, but it could not be verified as the root that the branch rule selects: it lies on another "
        "branch, it ties with one, or the path to it runs through a singular point. Try a smaller time_step. "
        "branch='nearest' continues a run off the principal branch."
    ),
    Outcome.not_converged: (
        "The iteration for the next state did not converge, though no fold was met. "
        "Try smaller steps or looser tolerances, and check that the system is well scaled."
    ),
    Outcome.off_momentum_locus: (
        "The momentum is not the discrete momentum of any displacement on the principal branch. "
        "Pass its components along the constraint subspace instead, or a momentum made by discrete_legendre."
    ),
    Outcome.nonfinite: (
        "A number overflowed or became undefined, or a force or potential returned one that is; or rounding moved a "
        "growing pose off its group. Try a smaller time_step, a shorter run or other units."
    ),
    Outcome.no_half_impulse: (
        "The implicit equation for the half impulse of the force has no solution: the force at the velocity in the "
        "middle must equal that impulse. A force that grows faster than the velocity, or jumps, may have none. "
        "Try a smaller time_step, or a force that is continuous."
    ),
    Outcome.lasting_contact: (
        "The body comes to stay at a wall: impacts follow each other faster and faster, infinitely many in finite "
        "time, or the motion after one leads back through the wall. How it slides or rests there is not modeled. "
        "Try a larger restitution, a shorter run or, if a step has more than 200 impacts, a smaller time_step."
    ),
    Outcome.too_stiff: (
        "The steps of the solver became too short to come to an end: the force changes much faster than the motion, as "
        "strong friction does, or it jumps again and again. Try `simulate` with Forced(..., scheme='variational'), in "
        "which `Friction` is exact at any time_step, a smoother force, a shorter time or a larger rtol."
    ),
}


class OutcomeError(RuntimeError):
    """A run that cannot continue; `outcome` has the reason and `orbit`, where there is one, every good step.

    `said` has the failure of a user's function, where that ended the run.

    Example:
        >>> str(OutcomeError(Outcome.nonfinite, "Step 7"))
        'Step 7: nonfinite. A number overflowed or became undefined, or a force ...'
    """

    def __init__(self, outcome: Outcome, where: str, orbit: object | None = None, reason: str = "") -> None:
        super().__init__(f"{where}: {outcome.name}. {reason or outcome.message}")
        self.outcome = outcome
        self.where = where
        self.orbit = orbit
        self.said = reason

    def __reduce__(self) -> Any:
        return type(self), (self.outcome, self.where, self.orbit, self.said)


def conclude(orbit: Any, time_step: float, good: int, steps: int, throw: bool) -> Any:
    """Return the orbit of a run; with `throw`, raise if it ended early, naming the step."""
    if throw and orbit.outcome:
        where = f"Step {good + 1} of {steps}" if good or len(orbit) else "Start of the run"
        route = getattr(orbit.motion, "route", None) if orbit.outcome == Outcome.nonfinite else None
        faults = " ".join(getattr(route, "faults", {}).values())
        raise OutcomeError(orbit.outcome, f"{where} (time_step {time_step:g})", orbit, faults)
    return orbit


def conclude_flow(orbit: Any, time: Any, errors: tuple[float, float], acting: str = "", reason: str = "") -> Any:
    """Return a flow, or raise if it ended before the last of its times; `acting` names the force on it."""
    if orbit.outcome != Outcome.successful:
        (rtol, atol), count = errors, len(orbit)
        ahead = time[min(count, len(time) - 1)]  # the last state itself may be one that is not finite
        where = f"Flow from time {time[count - 1]:g} to {ahead:g}{acting} (rtol {rtol:g}, atol {atol:g})"
        raise OutcomeError(orbit.outcome, where, orbit, reason)
    return orbit
