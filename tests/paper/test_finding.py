"""When a finding holds, by what was measured, and what it has to bring."""

import math

import pytest

from nonholo_paper._finding import Finding, Measured, finding
from nonholo_paper._verdict import Verdict

ERRATA = [verdict for verdict in Verdict if verdict.is_erratum]
ADDED = [Verdict.SETTLED, Verdict.REMARK]


def _finding(verdict: Verdict, claim: str = "\u201cclaim\u201d", **changed: object) -> Finding:
    given = {
        "corrected": None if verdict is Verdict.AS_PRINTED else "right",
        "errata": ("S1",) if verdict.is_erratum else (),
        **changed,
    }
    build = finding("label", "remark", "Section 1", claim, verdict=verdict, tolerance=1e-9, **given)
    return build(lambda: Measured(0.0))


def test_verdicts() -> None:
    """Four words say that something is to be corrected; each word has a meaning of its own."""
    names = {"MISPRINT", "HYPOTHESIS", "EXCEPTIONS", "FALSE", "CONTRADICTED"}
    assert {verdict.name for verdict in ERRATA} == names
    assert len({verdict.meaning for verdict in Verdict}) == len(Verdict)


@pytest.mark.parametrize(("defect", "holds"), [(0.0, True), (1e-9, True), (2e-9, False), (math.nan, False)])
@pytest.mark.parametrize("verdict", Verdict)
def test_right_statement_is_met_to_the_tolerance(verdict: Verdict, defect: float, holds: bool) -> None:
    """A finding whose right statement is off by more than the tolerance, or by an undefined defect, does not hold."""
    assert _finding(verdict).holds(Measured(defect, printed=1.0)) is holds


@pytest.mark.parametrize(("printed", "holds"), [(1e-8, False), (9e-7, False), (2e-6, True), (math.nan, False)])
@pytest.mark.parametrize("verdict", Verdict)
def test_what_is_denied_fails_clearly(verdict: Verdict, printed: float, holds: bool) -> None:
    """What is denied has to be off by more than a thousand tolerances, whatever the verdict."""
    assert _finding(verdict).holds(Measured(0.0, printed)) is holds


@pytest.mark.parametrize("verdict", Verdict)
def test_an_erratum_shows_that_the_printed_statement_fails(verdict: Verdict) -> None:
    """Without a defect of the printed statement an erratum does not hold; the others deny nothing."""
    assert _finding(verdict).holds(Measured(0.0)) is not verdict.is_erratum


@pytest.mark.parametrize("verdict", Verdict)
def test_correction_comes_with_what_is_not_right(verdict: Verdict) -> None:
    """A correction of what is right, and anything else without one, are refused."""
    wrong = "right" if verdict is Verdict.AS_PRINTED else None
    with pytest.raises(ValueError, match=r"'label' must have `corrected` exactly where"):
        _finding(verdict, corrected=wrong)


@pytest.mark.parametrize("verdict", Verdict)
def test_row_comes_with_what_is_to_be_corrected(verdict: Verdict) -> None:
    """An erratum without a row, and a row of anything else, are refused."""
    with pytest.raises(ValueError, match=r"'label' must have a row of the errata exactly where"):
        _finding(verdict, errata=() if verdict.is_erratum else ("S1",))


@pytest.mark.parametrize("verdict", [*ERRATA, *ADDED])
def test_what_is_not_right_as_printed_is_quoted(verdict: Verdict) -> None:
    """A claim in other words than the paper's is refused where something is said against it or added."""
    with pytest.raises(ValueError, match="'label' must quote the paper"):
        _finding(verdict, claim="claim")
