"""Measures and reports of property checks: what was measured against which tolerance, one error for all that failed."""

import dataclasses
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, TypeVar

import numpy as np

from nonholo.base.checks import positive


def gap(value: Any, target: Any) -> float:
    """Return the largest difference between arrays of one shape, relative to one plus the largest entry expected.

    Example:
        >>> gap([0.0, 3.5], [0.0, 3.0])
        0.125
    """
    return _difference(value, target) / (1 + largest(target))


def relative(value: Any, target: Any) -> float:
    """Return the largest difference between arrays of one shape, relative to the largest entry expected.

    Example:
        >>> relative([0.0, 3.5], [0.0, 4.0])
        0.125
    """
    return _difference(value, target) / max(largest(target), np.finfo(np.float64).tiny)


def _difference(value: Any, target: Any) -> float:
    value, target = np.asarray(value), np.asarray(target)
    if value.shape != target.shape:
        raise ValueError(f"shape {value.shape} where {target.shape} is expected")
    return largest(value - target)


def largest(values: Any) -> float:
    """Return the largest absolute value, zero of none.

    Example:
        >>> largest([1.0, -2.0])
        2.0
    """
    return float(np.abs(values).max(initial=0.0))


def derivative(function: Callable[[float], Any], step: float = 1e-3) -> np.ndarray:
    """Return the derivative at zero by the central difference of order four.

    Example:
        >>> bool(abs(derivative(np.exp) - 1) < 1e-12)
        True
    """
    near = np.asarray(function(step)) - np.asarray(function(-step))
    far = np.asarray(function(2 * step)) - np.asarray(function(-2 * step))
    return (8 * near - far) / (12 * step)


Measure = TypeVar("Measure", bound=Callable[[Any], float])


class NotApplicableError(Exception):
    """Raised by a measurement of a property that its object does not claim; the text has the reason."""


def need(condition: object, otherwise: str) -> None:
    """End a measurement of what an object does not claim, and give the reason."""
    if not condition:
        raise NotApplicableError(otherwise)


class Check(NamedTuple):
    """A property that is measured by one number.

    Attributes:
        name: A short name.
        requirement: The property.
        tolerance: The largest number that passes; None if the number is reported only.
        measure: The measurement.
    """

    name: str
    requirement: str
    tolerance: float | None
    measure: Callable[[Any], float]


def measures(table: list[Check], name: str, requirement: str, tolerance: float | None) -> Callable[[Measure], Measure]:
    """Add the decorated measurement to a table of checks, which has the order of the file."""

    def add(measure: Measure) -> Measure:
        table.append(Check(name, requirement, tolerance, measure))
        return measure

    return add


@dataclasses.dataclass(frozen=True)
class Result:
    """The outcome of one check.

    Attributes:
        name: A short name.
        requirement: The property.
        value: The worst value measured; None if nothing could be measured.
        tolerance: The largest value that passes; None if the value is reported only.
        passed: Whether nothing speaks against the property.
        note: Why nothing was measured.

    Example:
        >>> from nonholo.testing import Result
        >>> Result("inverse", "g^-1 g = I", 0.5, 1e-13, passed=False).status
        'FAILED'
    """

    name: str
    requirement: str
    value: float | None
    tolerance: float | None
    passed: bool
    note: str = ""

    @property
    def status(self) -> str:
        """One of "ok", "FAILED", "reported" (no tolerance), "not checked" (the note has the reason)."""
        if not self.passed:
            return "FAILED"
        return "not checked" if self.value is None else "ok" if self.tolerance is not None else "reported"

    def __str__(self) -> str:
        """Return what is required and what was found."""
        words = f"raised {self.note}" if self.value is None else f"measured {self.value:.3g}"
        limit = "" if self.tolerance is None else f", allowed {self.tolerance:.3g}"
        return f"{self.name}: must satisfy {self.requirement}; {words}{limit}"


@dataclasses.dataclass(frozen=True, repr=False)
class Report:
    """The outcomes of all checks of one object, in order; printed as a table.

    Attributes:
        owner: The check and its object.
        results: One for each property.

    Example:
        >>> report = nh.testing.check_group(nh.SO(3), compiled=False)
        >>> report.passed, report["exp"].tolerance
        (True, 1e-12)
        >>> print(report)
        check_group(SO(3)): all ... checks passed
        ...
    """

    owner: str
    results: tuple[Result, ...]

    @property
    def passed(self) -> bool:
        """Whether every check passed."""
        return not self.failed

    @property
    def failed(self) -> tuple[Result, ...]:
        """The results that failed."""
        return tuple(result for result in self.results if not result.passed)

    def __getitem__(self, name: str) -> Result:
        """Return the result with a name."""
        return {result.name: result for result in self.results}[name]

    def __repr__(self) -> str:
        count = sum(result.status in ("ok", "FAILED") for result in self.results)
        verdict = f"{len(self.failed)} of {count} checks FAILED" if self.failed else f"all {count} checks passed"
        rows = [("", "measured", "allowed", "", "property"), *map(_cells, self.results)]
        widths = [max(len(row[i]) for row in rows) for i in range(4)]
        lines = ["  ".join([*map(str.ljust, row, widths), row[4]]).rstrip() for row in rows]
        return "\n  ".join([f"{self.owner}: {verdict}", *lines])


def _cells(result: Result) -> tuple[str, ...]:
    value = "" if result.value is None else f"{result.value:.2g}"
    limit = "" if result.tolerance is None or result.value is None else f"{result.tolerance:.2g}"
    note = f" ({result.note})" if result.note else ""
    return result.name, value, limit, result.status, result.requirement + note


def run_checks(owner: str, checks: Sequence[Check], subject: Any, factor: float, throw: bool) -> Report:
    """Run every check, also after failures of others; a check that raises has failed.

    Args:
        owner: The check and its object, for messages.
        checks: The measurements.
        subject: Their argument.
        factor: On every tolerance.
        throw: Raise if a check failed.

    Raises:
        AssertionError: With `throw`: names every check that failed.
    """
    factor = float(positive("check_...(tolerance_factor=...)", factor, "Pass a positive factor on every tolerance."))
    report = Report(owner, tuple(_result_of(check, subject, factor) for check in checks))
    if throw and report.failed:
        lines = "\n  ".join(map(str, report.failed))
        raise AssertionError(f"`{owner}` failed {len(report.failed)} of {len(checks)} checks.\n  {lines}")
    return report


def _result_of(check: Check, subject: Any, factor: float) -> Result:
    tolerance = None if check.tolerance is None else factor * check.tolerance
    try:
        value = float(check.measure(subject))
    except NotApplicableError as reason:
        return Result(check.name, check.requirement, None, tolerance, True, str(reason))
    except Exception as failure:  # the code under test is a user's and may raise anything
        line = (str(failure).splitlines() or [""])[0]
        return Result(check.name, check.requirement, None, tolerance, False, f"{type(failure).__name__}: {line}")
    return Result(check.name, check.requirement, value, tolerance, tolerance is None or value <= tolerance)


EXACT = 1e-11  # errors below it are rounding, and have no order
SECOND = "errors against the flow fall with the square of the step: |slope - 2|"
COUNTS = (10, 20, 40)  # steps for the path whose order is measured


def result_of(outcome: Any, otherwise: str | None = None) -> Any:
    """Return what a run made, or raise what it raised: in one check, for which the others have nothing to judge."""
    if isinstance(outcome, Exception):
        is_for_all = otherwise is None or isinstance(outcome, NotApplicableError)
        raise outcome if is_for_all else NotApplicableError(otherwise)
    return outcome


def slope(errors: list[float]) -> float:
    """Return the order of errors in the numbers of steps, from the last two."""
    return float(np.log(errors[-2] / errors[-1]) / np.log(COUNTS[-1] / COUNTS[-2]))


def off_two(errors: list[float]) -> float:
    """Return the distance of the order of errors from two; zero of rounding."""
    return abs(slope(errors) - 2) if errors[-1] > EXACT else 0.0
