"""Write docs/reference/what-works-with-what.md from the tables that tests/matrix runs: run this file."""

import string
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "tests"))
from matrix.abilities import ABILITIES  # noqa: E402
from matrix.alone import ALONE  # noqa: E402
from matrix.kinds import Kind  # noqa: E402
from matrix.verdicts import CELLS, RULES, TABLES, Rule  # noqa: E402


def page() -> str:
    """Return the text of the page."""
    rules = [rule for rule in CELLS.values() if rule is not None]
    broken = sum(rule.is_broken for rule in rules)
    return _PAGE.format(
        cells=len(CELLS),
        work=len(CELLS) - len(rules),
        impossible=len(rules) - broken,
        broken=broken,
        **{f"{key}{i}": text for i, table in enumerate(TABLES, 1) for key, text in _parts(*table).items()},
        alone="\n".join(f"| {kind} | {' | '.join(ways)} |" for kind, ways in ALONE.items()),
        reasons="\n".join(f"{_number(rule)}. {rule.reason}" for rule in RULES),
    )


def _parts(kinds: dict[str, Kind], abilities: list[str]) -> dict[str, str]:
    """Return the list of the kinds, and head, line and rows of their table."""
    letters = dict(zip(kinds, string.ascii_uppercase, strict=False))
    return {
        "kinds": "\n".join(f"| {letter} | {kind} | {kinds[kind].about} |" for kind, letter in letters.items()),
        "names": ", ".join(f"{letter} {kind}" for kind, letter in letters.items()),
        "head": "|".join(letters.values()),
        "line": "---|" * len(letters),
        "rows": "\n".join(_row(kinds, ability) for ability in abilities),
    }


def _row(kinds: dict[str, Kind], ability: str) -> str:
    about = (ABILITIES[ability].__doc__ or "").strip()
    cells = (CELLS[kind, ability] for kind in kinds)
    marks = "|".join("+" if rule is None else f"{_number(rule)}{'!' * rule.is_broken}" for rule in cells)
    return f"| **{ability}**: {about} |{marks}|"


def _number(rule: Rule) -> int:
    return 1 + RULES.index(rule)


_PAGE = """# What works with what

Every ability of the library with every kind of motion, and with ready systems: {cells} cells, each of which a
test runs (`tests/matrix`). {work} work, which means that their value equals the same value by another way, the one that
the row names; {impossible} cannot be, and are refused in words; {broken} are refused without a reason in mechanics or
mathematics, and marked by an exclamation mark. A number in a table says why, below the second one.

## Kinds of motion

| | kind | how it is made |
|---|---|---|
{kinds1}

| ability, and what its value is compared with |{head1}|
|---|{line1}
{rows1}

## Ready systems

Those of `nh.examples`, and one on a group that a force of the time drives: {names2}.

| ability, and what its value is compared with |{head2}|
|---|{line2}
{rows2}

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
