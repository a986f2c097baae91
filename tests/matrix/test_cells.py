"""What works with what: every ability with every kind of motion, its value against the same value by another way."""

import contextlib
from collections.abc import Callable
from pathlib import Path

import compilers
import pytest
from matrix.abilities import ABILITIES, case
from matrix.kinds import KINDS
from matrix.ready import ALL
from matrix.verdicts import CELLS, QUESTIONS, RULES
from scripts import ROOT, script

QUICK = (
    *("sleigh, SE(3)", "LL by matrices", "Veselova top", "order 4", "rule nearest"),
    *("gravity", "friction, table", "force in Python"),
)
CUT = (
    *("thinned", "iterate", "store", "extend", "resume", "save and load", "ensemble", "flow store", "sweep"),
    *("events", "events in stores", "events in iterators", "crossings", "ensemble with events"),
)
BRIEF = {"vector field", "linearize", "equilibria", "tangent maps"}
"""Questions that take some seconds; the others take longer."""
BROKEN = {cell for cell, rule in CELLS.items() if rule is not None and rule.is_broken}


OLD = [cell for cell in CELLS if cell[0] in KINDS and cell[1] not in QUESTIONS]
WHOLE = {"top, n = 3", "sleigh, SE(2)", "particle"}
HERE = [
    *(f"{kind}-{ability}" for kind, ability in OLD if kind in WHOLE and ability != "gradient"),  # test_rollout has them
    *(f"{kind}-{ability}" for place, kind in enumerate(QUICK) for ability in CUT[place % 3 :: 3]),
]
NEW = [cell for cell in CELLS if cell not in OLD]
LONG = [f"{kind}-{ability}" for kind, ability in NEW if ability in {*QUESTIONS} - BRIEF or kind == "bicycle"]


@pytest.mark.profile("routes", keep=HERE)
@pytest.mark.parametrize(("kind", "ability"), OLD)
def test_cell(kind: str, ability: str, run_cell: Callable[[str, str], None]) -> None:
    """It works; what is impossible, and what is broken still, is refused in words of the library."""
    run_cell(kind, ability)


@pytest.mark.profile("routes", keep=["particle-vector field", "particle-linearize"])
@pytest.mark.parametrize(("kind", "ability"), [cell for cell in NEW if "-".join(cell) not in LONG])
def test_ready_system(kind: str, ability: str, run_cell: Callable[[str, str], None]) -> None:
    """The same of what is asked of ready systems."""
    run_cell(kind, ability)


@pytest.mark.profile("long", instead="test_ready_system")
@pytest.mark.parametrize(("kind", "ability"), [cell for cell in NEW if "-".join(cell) in LONG])
def test_ready_system_in_all(kind: str, ability: str, run_cell: Callable[[str, str], None]) -> None:
    """The same of what takes longer."""
    compilers.release_programs()
    run_cell(kind, ability)


@pytest.fixture
def run_cell(
    tmp_path: Path, request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch
) -> Callable[[str, str], None]:
    """Return what runs a cell."""

    def run(kind: str, ability: str) -> None:
        rule = CELLS[kind, ability]
        if "wide" in ALL[kind].traits:  # on every machine
            monkeypatch.setattr("nonholo.base.limits.memory_limit", lambda: 8e9)
        if rule is not None and rule.is_broken:
            request.applymarker(pytest.mark.xfail(strict=True, raises=(ValueError, TypeError), reason=rule.reason))
        refused = rule is not None and not rule.is_broken
        with pytest.raises((ValueError, TypeError), match=rule.refusal) if refused else contextlib.nullcontext():
            ABILITIES[ability](case(kind), tmp_path)

    return run


def test_few_cells_are_broken() -> None:
    """At least 97 of 100 cells that are possible work, and no rule is there for nothing."""
    possible = sum(rule is None or rule.is_broken for rule in CELLS.values())
    assert len(BROKEN) <= 0.03 * possible
    assert {*CELLS.values()} == {None, *RULES}


def test_the_page_is_up_to_date() -> None:
    """The page in the repository is the one that the script writes: `python docs/make_matrix_page.py`."""
    assert (ROOT / "docs/reference/what-works-with-what.md").read_text() == script("docs/make_matrix_page.py").page()
