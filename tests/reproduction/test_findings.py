"""Every finding of the paper holds."""

import pytest

from nonholo.reproduction._registry import Entry, entries

SLOW = [
    "footnote-6_1",
    "*.fig",
    "suslov-space-axes",
    "C36",
    "C35",
    "C9",
    "det.delta.phi",
    "surface[12]",
    "ell",
    "quartic",
]


@pytest.mark.profile("paper", cases=SLOW)
@pytest.mark.parametrize("entry", entries(), ids=lambda entry: entry.finding.label)
def test_finding_holds(entry: Entry) -> None:
    """The right statement holds to its tolerance, and what is printed wrong fails."""
    measured = entry.finding.measure()
    assert entry.finding.holds(measured), measured
