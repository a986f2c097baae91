r"""Branch rules: which of the values of the discrete map a run takes. One class a rule; what a rule needs, it says.

The values themselves come from `_values`, following one of them from `_equations`. Compiled and traced runs of
"principal" and "nearest" solve their steps where they are; all others ask `following`.
"""

import abc
import dataclasses
from collections.abc import Callable
from typing import ClassVar, NamedTuple, TypeAlias

import numpy as np

from nonholo.base.calls import call
from nonholo.base.checks import choice, error, is_integer, shown
from nonholo.base.results import Outcome
from nonholo.base.types import Float
from nonholo.discrete._discretization import Discretization
from nonholo.discrete.branching._equations import Equations, Frame, follow, has_frame
from nonholo.discrete.branching._values import (
    SAME,
    Branches,
    Roots,
    branches_of,
    is_regular,
    principal_increment,
    regions,
    roots_over,
)

Chooser: TypeAlias = Callable[[Branches, np.ndarray], int | None]
BranchRule: TypeAlias = str | Chooser
_REGIONS = ("inner", "outer")
_TIED = 1e-9  # relative difference of two norms that rounding may have made


class Kick(NamedTuple):
    """A step of which all is known but its new displacement.

    Attributes:
        discrete: The discretized system.
        frame: The frame of its branches.
        point: The point over the present displacement.
        now: The equations that it solves.
        ahead: Those that the new one has to solve.
        momentum: The new canonical momentum along the constraint subspace.
    """

    discrete: Discretization
    frame: Frame
    point: Float[np.ndarray, "m"]
    now: Equations
    ahead: Equations
    momentum: Float[np.ndarray, "k"]

    @property
    def present(self) -> Float[np.ndarray, "N N"]:
        """The present displacement, in the user's frame."""
        return displacement_at(self.discrete, self.frame, self.point)


Following: TypeAlias = tuple[Outcome, Float[np.ndarray, "m"]]


class AbstractBranchRule(abc.ABC):
    """Which value of the map a step takes.

    Attributes:
        name: Its name in an orbit.
        is_principal: Whether it is the principal value, which has compiled runs, parts of steps and events.
        is_nearest: Whether it follows the present value, for which there is a kernel.
        needs_all_values: Whether it chooses among all values, which has to be done outside of a JAX transformation.
    """

    name: str
    is_principal: ClassVar[bool] = False
    is_nearest: ClassVar[bool] = False
    needs_all_values: ClassVar[bool] = True

    def check(self, where: str, discrete: Discretization) -> None:
        """Refuse a discretization that does not have the rule: by default one of whose values not all are known."""
        _check_values_known(where, discrete, self.name)

    def check_start(self, where: str, discrete: Discretization, displacement: Float[np.ndarray, "N N"]) -> None:
        """Refuse a start that the rule cannot continue from; by default there is none."""
        del where, discrete, displacement

    @abc.abstractmethod
    def following(self, kick: Kick) -> Following:
        """Return the outcome and the point over the new displacement."""


@dataclasses.dataclass(frozen=True)
class Principal(AbstractBranchRule):
    """The root that momentum zero reaches along a ray."""

    name: str = "principal"
    is_principal: ClassVar[bool] = True
    needs_all_values: ClassVar[bool] = False

    def check(self, where: str, discrete: Discretization) -> None:
        """Every discretization has it."""

    def following(self, kick: Kick) -> Following:
        """Return the verified principal root."""
        return principal_point(kick.discrete, kick.frame, kick.momentum)


@dataclasses.dataclass(frozen=True)
class Nearest(AbstractBranchRule):
    """The root that the present displacement reaches while the momentum moves along a segment."""

    name: str = "nearest"
    is_nearest: ClassVar[bool] = True
    needs_all_values: ClassVar[bool] = False

    def check(self, where: str, discrete: Discretization) -> None:
        """Every left-invariant constraint has it."""
        _check_left_invariant(where, discrete, self.name)

    def following(self, kick: Kick) -> Following:
        """Follow the present point."""
        return follow(kick.now, kick.ahead, kick.point)


@dataclasses.dataclass(frozen=True)
class Extreme(AbstractBranchRule):
    """The real value whose full momentum is smallest (sign 1) or largest (-1)."""

    name: str
    sign: int

    def following(self, kick: Kick) -> Following:
        """Choose by the norm; a tie is not decided."""
        roots, values = _values(kick)
        real = np.flatnonzero(values.is_real)
        if len(real) == 0:
            return _only(kick, roots, values, [])
        norms = self.sign * np.linalg.norm(values.momentum[real], axis=1)
        ties = real[norms <= norms.min() + _TIED * np.abs(norms).max()]
        return _only(kick, roots, values, ties.tolist())


@dataclasses.dataclass(frozen=True)
class Region(AbstractBranchRule):
    """The value in one part of the invariant curve of a top; the nearest where there are several."""

    name: str

    def check(self, where: str, discrete: Discretization) -> None:
        """Refuse systems whose invariant curves have no parts."""
        super().check(where, discrete)
        if not is_regular(discrete):
            kind = type(discrete.system).__name__
            got = f"{self.name!r} for {kind}, whose invariant curves have no inner and outer part"
            remedy = "Pass 'nearest'. Only a SuslovTop with n = 3 and det B > 2|c|^2 has regions."
            raise error(where, "be a rule without regions", got, remedy)

    def check_start(self, where: str, discrete: Discretization, displacement: Float[np.ndarray, "N N"]) -> None:
        """Refuse a start whose energy level is connected."""
        if regions(discrete, displacement[None])[0] not in _REGIONS:
            high = "an energy from the saddle's on, where both parts of the invariant curve are connected"
            remedy = "Pass 'nearest', or start slower (`critical_energies` has the saddle's energy)."
            raise error(where, "have a start in the inner or the outer region", f"{self.name!r} and {high}", remedy)

    def following(self, kick: Kick) -> Following:
        """Choose by the region, then by continuation."""
        roots, values = _values(kick)
        inside = np.flatnonzero(values.is_real & (values.region == self.name)).tolist()
        if len(inside) > 1:
            nearest = _nearest_of(kick, roots)
            inside = [nearest] if nearest in inside else inside
        return _only(kick, roots, values, inside)


@dataclasses.dataclass(frozen=True)
class Chosen(AbstractBranchRule):
    """The value that a function of the user chooses."""

    function: Chooser
    name: str = "callable"

    def check(self, where: str, discrete: Discretization) -> None:
        """Refuse systems of whose values not all are known."""
        _check_values_known(where, discrete, self.function)

    def following(self, kick: Kick) -> Following:
        """Ask the function, and refuse an answer that is no real value."""
        roots, values = _values(kick)
        index = call("branch(found, present)", self.function, values, kick.present)
        if index is None:
            return _only(kick, roots, values, [])
        if not is_integer(index) or not 0 <= index < len(values) or not values.is_real[index]:
            remedy = "Choose among np.flatnonzero(found.is_real), or return None."
            raise error("branch(found, present)", "return the index of a real branch or None", shown(index), remedy)
        return _only(kick, roots, values, [int(index)])


PRINCIPAL = Principal()
_RULES = (PRINCIPAL, Nearest(), Extreme("smallest", 1), Extreme("largest", -1), *map(Region, _REGIONS))
_BY_NAME: dict[str, AbstractBranchRule] = {rule.name: rule for rule in _RULES}


def branch_rule(owner: str, branch: BranchRule) -> AbstractBranchRule:
    """Return the rule that a user names or gives as a function."""
    if callable(branch):
        return Chosen(branch)
    remedy = "Or pass a function of the branches and the present displacement."
    return _BY_NAME[choice(f"{owner}(branch=...)", branch, tuple(_BY_NAME), remedy)]


def checked_rule(owner: str, discrete: Discretization, branch: BranchRule) -> AbstractBranchRule:
    """Return a branch rule that a discretization has, or refuse it with the reason."""
    rule = branch_rule(owner, branch)
    rule.check(f"{owner}(branch=...)", discrete)
    return rule


def principal_point(discrete: Discretization, frame: Frame, canonical: Float[np.ndarray, "k"]) -> Following:
    """Return the outcome and the point over the verified principal displacement of a canonical momentum."""
    code, X = principal_increment(discrete, canonical)
    return code, np.empty(0) if code != 0 else frame.point(X + discrete.system.group.identity)


def displacement_at(discrete: Discretization, frame: Frame, x: np.ndarray) -> Float[np.ndarray, "N N"]:
    """Return the displacement over a point, in the user's frame."""
    system = discrete.system
    return system.frame @ frame.increment(x) @ system.group.inverse(system.frame) + system.group.identity


def _check_left_invariant(where: str, discrete: Discretization, branch: BranchRule) -> None:
    if discrete.system.is_spatial:
        changing = "a right-invariant constraint, whose equations change with the pose from step to step"
        raise error(where, "be 'principal'", f"{shown(branch)} for {changing}", "Leave it out.")


def _check_values_known(where: str, discrete: Discretization, branch: BranchRule) -> None:
    _check_left_invariant(where, discrete, branch)
    if not has_frame(discrete):
        got = f"{shown(branch)} for {type(discrete.system).__name__}, of whose values not all are known"
        remedy = "All are known of a SuslovTop, ChaplyginSleigh or MultidimensionalSleigh with difference 'matrix'."
        raise error(where, "be 'principal' or 'nearest'", got, remedy)


def _values(kick: Kick) -> tuple[Roots, Branches]:
    roots = roots_over(kick.discrete, kick.frame, kick.momentum)
    return roots, branches_of(kick.discrete, kick.momentum, roots)


def _only(kick: Kick, roots: Roots, values: Branches, choices: list[int]) -> Following:
    """Return the one value that is left, or why there is none."""
    if not choices:
        return Outcome.no_real_branch, kick.point
    if len(choices) > 1 or values.multiplicity[choices[0]] > 1:
        return Outcome.branch_unverified, kick.point
    return Outcome.successful, roots.zeros[choices[0]].point.real


def _nearest_of(kick: Kick, roots: Roots) -> int | None:
    """Return the index of the root that the present point is followed to; None if it is lost."""
    code, end = follow(kick.now, roots.equations, kick.point)
    distances = [min(np.linalg.norm(end - root.point), np.linalg.norm(end + root.point)) for root in roots.zeros]
    best = int(np.argmin(distances))
    return best if code == 0 and distances[best] <= SAME * np.linalg.norm(end) else None
