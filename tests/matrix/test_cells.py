"""What works with what: every ability with every kind of motion, its value against the same value by another way."""

import contextlib
from pathlib import Path

import matplotlib.pyplot as plt
import pytest
from matrix.abilities import ABILITIES, case
from matrix.kinds import KINDS
from matrix.verdicts import CELLS, RULES
from scripts import ROOT, script

QUICK = (
    *("sleigh, SE(3)", "LL by matrices", "Veselova top", "order 4", "rule nearest"),
    *("gravity", "friction, table", "force in Python"),
)
CUT = (
    *("thinned", "iterate", "store", "extend", "resume", "save and load", "ensemble", "flow store", "sweep"),
    *("events", "events in stores", "events in iterators", "crossings", "ensemble with events"),
)
HERE = ["top, n = 3-*", "sleigh, SE(2)-*", "particle-*", *(f"{kind}-{ability}" for kind in QUICK for ability in CUT)]
BROKEN = {cell for cell, rule in CELLS.items() if rule is not None and rule.is_broken}


@pytest.mark.profile("routes", keep=HERE)
@pytest.mark.parametrize(("kind", "ability"), CELLS)
def test_cell(
    kind: str, ability: str, tmp_path: Path, request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It works; what is impossible, and what is broken still, is refused in words of the library."""
    rule = CELLS[kind, ability]
    if "wide" in KINDS[kind].traits:  # on every machine
        monkeypatch.setattr("nonholo.base.limits.memory_limit", lambda: 8e9)
    if rule is not None and rule.is_broken:
        request.applymarker(pytest.mark.xfail(strict=True, reason=rule.reason))
    refused = rule is not None and not rule.is_broken
    with pytest.raises((ValueError, TypeError), match=rule.refusal) if refused else contextlib.nullcontext():
        ABILITIES[ability](case(kind), tmp_path)
    plt.close("all")


def test_few_cells_are_broken() -> None:
    """At least 97 of 100 cells that are possible work, and no rule is there for nothing."""
    possible = sum(rule is None or rule.is_broken for rule in CELLS.values())
    assert len(BROKEN) <= 0.03 * possible
    assert {*CELLS.values()} == {None, *RULES}


def test_the_page_is_up_to_date() -> None:
    """The page in the repository is the one that the script writes: `python docs/make_matrix_page.py`."""
    assert (ROOT / "docs/reference/what-works-with-what.md").read_text() == script("docs/make_matrix_page.py").page()
