"""Every finding of the paper holds."""

import pytest

from nonholo_paper._registry import Entry, entries

SLOW = {"S6", "bi-asymptotic", "suslov-space-axes", "top-solvability", "C35"}
QUICK = [entry for entry in reversed(entries()) if entry.figure is None and entry.finding.label not in SLOW]
HERE = (
    *{entry.finding.measure.__module__: entry for entry in QUICK}.values(),
    *{(entry.finding.kind, entry.finding.verdict): entry for entry in QUICK}.values(),
)
"""The first finding of each part of the paper, and of each verdict on each kind of statement."""


def _profile(entry: Entry) -> list[pytest.MarkDecorator]:
    """Return where a finding is tried: those of the default run have no mark."""
    return [] if entry in HERE else [pytest.mark.profile("paper", instead="test_finding_holds")]


@pytest.mark.parametrize(
    "entry", [pytest.param(entry, marks=_profile(entry), id=entry.finding.label) for entry in entries()]
)
def test_finding_holds(entry: Entry) -> None:
    """The right statement holds to its tolerance, and what is printed wrong fails."""
    measured = entry.finding.measure()
    assert entry.finding.holds(measured), measured
