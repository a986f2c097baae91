"""When a finding holds, by what was measured."""

import math

import pytest

from nonholo.reproduction._finding import Finding, Measured, Printed, finding


def _finding(as_printed: Printed) -> Finding:
    corrected = None if as_printed is True else "right"
    claim = finding("label", "remark", "Section 1", "claim", as_printed=as_printed, corrected=corrected, tolerance=1e-9)
    return claim(lambda: Measured(0.0))


@pytest.mark.parametrize(("defect", "holds"), [(0.0, True), (1e-9, True), (2e-9, False), (math.nan, False)])
@pytest.mark.parametrize("as_printed", [True, False, "misprint"])
def test_right_statement_is_met_to_the_tolerance(as_printed: Printed, defect: float, holds: bool) -> None:
    """A finding whose right statement is off by more than the tolerance, or by an undefined defect, does not hold."""
    assert _finding(as_printed).holds(Measured(defect, printed=1.0)) is holds


@pytest.mark.parametrize(("printed", "holds"), [(None, False), (1e-8, False), (9e-7, False), (2e-6, True)])
@pytest.mark.parametrize("as_printed", [False, "misprint"])
def test_wrong_statement_fails_clearly(as_printed: Printed, printed: float | None, holds: bool) -> None:
    """What is printed wrong has to be off by more than a thousand tolerances."""
    assert _finding(as_printed).holds(Measured(0.0, printed)) is holds


@pytest.mark.parametrize(("as_printed", "corrected"), [(True, "right"), (False, None), ("misprint", None)])
def test_correction_comes_with_what_is_wrong(as_printed: Printed, corrected: str | None) -> None:
    """A correction of what is right, and a wrong statement without one, are refused."""
    with pytest.raises(ValueError, match=r"'label' must have `corrected` exactly where"):
        finding("label", "remark", "1", "claim", as_printed=as_printed, corrected=corrected, tolerance=1e-9)
