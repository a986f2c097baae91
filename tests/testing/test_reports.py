"""Reports: what is judged, what is only told, and how it reads."""

import numpy as np
import pytest

import nonholo as nh
from nonholo.testing import check_group
from nonholo.testing._report import Check, NotApplicableError, Report, derivative, gap, relative, run_checks


def unfit(_: object) -> float:
    """Refuse to be measured."""
    raise NotApplicableError("no wheels")


def broken(_: object) -> float:
    """Raise what no one expects."""
    raise ZeroDivisionError("of nothing\nwith a second line")


CHECKS = [
    Check("small", "x = 0", 1e-3, lambda x: x),
    Check("shown", "x is reported", None, lambda x: x),
    Check("wheels", "wheels roll", 1e-3, unfit),
    Check("broken", "it runs", 1e-3, broken),
    Check("undefined", "x is a number", 1e-3, lambda _: np.nan),
]


def report(value: float, factor: float = 1.0) -> Report:
    """Return a report of all checks."""
    return run_checks("check_it(that)", CHECKS, value, factor, throw=False)


def test_what_passes() -> None:
    """A value within its tolerance, a value without one and a property that is not claimed pass; NaN does not."""
    results = {result.name: result.status for result in report(1e-4).results}
    expected = {"small": "ok", "shown": "reported", "wheels": "not checked", "broken": "FAILED", "undefined": "FAILED"}
    assert results == expected
    assert not report(1e-4).passed
    assert run_checks("check_it(that)", CHECKS[:3], 1e-4, 1.0, throw=True).passed


def test_the_factor_of_tolerances() -> None:
    """Tolerances can be widened together."""
    assert report(1e-2)["small"].status == "FAILED"
    assert report(1e-2, factor=100.0)["small"].status == "ok"


def test_the_error_names_every_failure() -> None:
    """Owner, requirement, measured value or exception, allowed value: one line for each failure, none for others."""
    with pytest.raises(AssertionError) as raised:
        run_checks("check_it(that)", CHECKS, 0.5, 1.0, throw=True)
    assert str(raised.value).splitlines() == [
        "`check_it(that)` failed 3 of 5 checks.",
        "  small: must satisfy x = 0; measured 0.5, allowed 0.001",
        "  broken: must satisfy it runs; raised ZeroDivisionError: of nothing, allowed 0.001",
        "  undefined: must satisfy x is a number; measured nan, allowed 0.001",
    ]


def test_the_table() -> None:
    """One aligned line for each check, the verdict first, reasons in brackets."""
    lines = str(report(1e-4)).splitlines()
    assert lines[0] == "check_it(that): 2 of 3 checks FAILED"
    assert len({line.index("x") for line in lines if line.endswith(("x = 0", "x is reported"))}) == 1
    assert lines[4].split() == ["wheels", "not", "checked", "wheels", "roll", "(no", "wheels)"]


def test_shapes_are_not_broadcast() -> None:
    """Arrays of different shape are an error, though NumPy could stretch one to the other."""
    for compare in (gap, relative):
        with pytest.raises(ValueError, match=r"shape \(1,\) where \(3,\)"):
            compare(np.zeros(1), np.zeros(3))


def test_derivatives_are_of_order_four() -> None:
    """The central difference is exact for polynomials of degree four."""
    assert derivative(lambda t: 2 * t + 3 * t**2 + 5 * t**4, 0.5) == pytest.approx(2.0, abs=1e-14)


@pytest.mark.parametrize("rng", ["today", -1, None])
def test_random_numbers_come_from_an_integer_or_a_generator(rng: object) -> None:
    """Another `rng` is refused by name."""
    with pytest.raises(ValueError, match=r"rng=\.\.\.\)` must be a natural number or a numpy.random.Generator"):
        check_group(nh.SO(3), rng=rng)  # pyright: ignore[reportArgumentType]
