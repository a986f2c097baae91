"""Write docs/reference/what-works-with-what.md from the tables that tests/matrix runs: run this file."""

import string
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "tests"))
from matrix.abilities import ABILITIES  # noqa: E402
from matrix.alone import ALONE  # noqa: E402
from matrix.kinds import KINDS  # noqa: E402
from matrix.verdicts import CELLS, RULES, Rule  # noqa: E402

_LETTERS = dict(zip(KINDS, string.ascii_uppercase, strict=False))


def page() -> str:
    """Return the text of the page."""
    rules = [rule for rule in CELLS.values() if rule is not None]
    broken = sum(rule.is_broken for rule in rules)
    return _PAGE.format(
        cells=len(CELLS),
        work=len(CELLS) - len(rules),
        impossible=len(rules) - broken,
        broken=broken,
        kinds="\n".join(f"| {letter} | {kind} | {KINDS[kind].about} |" for kind, letter in _LETTERS.items()),
        head=" | ".join(_LETTERS.values()),
        line="---|" * len(_LETTERS),
        rows="\n".join(map(_row, ABILITIES)),
        alone="\n".join(f"| {kind} | {' | '.join(ways)} |" for kind, ways in ALONE.items()),
        reasons="\n".join(f"{_number(rule)}. {rule.reason}" for rule in RULES),
    )


def _row(ability: str) -> str:
    about = (ABILITIES[ability].__doc__ or "").strip()
    cells = (CELLS[kind, ability] for kind in KINDS)
    marks = " | ".join("+" if rule is None else f"{_number(rule)}" for rule in cells)
    return f"| **{ability}**: {about} | {marks} |"


def _number(rule: Rule) -> int:
    return 1 + RULES.index(rule)


_PAGE = """# What works with what

Every ability of the library with every kind of motion: {cells} cells, each of which a test runs
(`tests/matrix`). {work} work, which means that their value equals the same value by another way, the one that the row
names; {impossible} cannot be, and are refused in words; {broken} are refused without a reason in mechanics or
mathematics. A number in the table says why, below it.

| | kind | how it is made |
|---|---|---|
{kinds}

| ability, and what its value is compared with | {head} |
|---|{line}
{rows}

{reasons}

## How fast without the extra `compile`

How the kernels run in an installation of the core alone, on a machine whose wheel has the library of kernels: all
from the library, or some as Python, about a hundred times slower, with the same bits. Flows under functions are solved
by SciPy. A test runs each where neither numba nor any other extra can be imported (`tests/test_light_core.py`).

| kind | `simulate` | `flow` | `ensemble` |
|---|---|---|---|
{alone}
"""


if __name__ == "__main__":
    (ROOT / "docs" / "reference" / "what-works-with-what.md").write_text(page())
