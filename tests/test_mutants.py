"""The table of errors made by hand fits the repository; `python tests/mutants.py` tries them."""

from collections import Counter

import pytest
from mutants import ROOT, Mutant, mutants
from profiles import room_of

_LEAST = 60
_NO_ROOMS = {"__init__"}  # names alone


def _rooms() -> set[str]:
    entries = (ROOT / "nonholo").iterdir()
    rooms = {entry.stem for entry in entries if entry.suffix == ".py" or (entry / "__init__.py").is_file()}
    return (rooms | {"paper"}) - _NO_ROOMS


@pytest.mark.parametrize("mutant", mutants(), ids=lambda mutant: mutant.name)
def test_row_applies(mutant: Mutant) -> None:
    """What a row replaces stands once in its file, and something else instead; its tests exist, its room is right."""
    assert mutant.occurrences() == 1
    assert mutant.new != mutant.old
    assert mutant.tests
    assert all((ROOT / place).exists() for place in mutant.tests)
    assert room_of(mutant.file) == mutant.name.partition(".")[0]


def test_every_room_has_errors() -> None:
    """Each room has at least two rows, and the table at least sixty."""
    counts = Counter(mutant.name.partition(".")[0] for mutant in mutants())
    assert {room for room, count in counts.items() if count >= 2} == _rooms()
    assert counts.total() >= _LEAST
