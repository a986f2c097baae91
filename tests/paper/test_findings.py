"""Every finding of the paper holds."""

import pytest

from nonholo_paper._registry import Entry, entries

SLOW = [
    *("footnote-6_1", "footnote-3", "*.fig", "suslov-space-axes", "det.delta.phi", "surface[12]", "ell", "quartic"),
    *("bi-asymptotic", "regularity", "discrete_EPS", "small-value", "between-the-separatrices", "Suslov_eq"),
    *("elementary-heading", "asymptotic-angle", "C35", "half-plane", "S6", "S36_0", "S43", "top-solvability"),
]


@pytest.mark.profile("paper", cases=SLOW)
@pytest.mark.parametrize("entry", entries(), ids=lambda entry: entry.finding.label)
def test_finding_holds(entry: Entry) -> None:
    """The right statement holds to its tolerance, and what is printed wrong fails."""
    measured = entry.finding.measure()
    assert entry.finding.holds(measured), measured
