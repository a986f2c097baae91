"""`nonholo paper`: recompute the paper and write its page."""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from typer import Option, echo

from nonholo.cli import screen
from nonholo.cli.screen.errors import FAILED, USAGE, leave, store_errors

if TYPE_CHECKING:
    from nonholo_paper import Result


def paper(
    output: Annotated[Path, Option("-o", "--output", metavar="DIR", help="Empty, new, or a page.")] = Path("paper"),
    only: Annotated[
        list[str] | None,
        Option("--only", metavar="LABEL", help="A label, a row of the errata or a figure; repeatable."),
    ] = None,
    is_list: Annotated[bool, Option("--list", help="List labels and verdicts; measure and write nothing.")] = False,
) -> None:
    """Recompute every statement and figure of the paper; write a page with claims and measured values.

    DIR gets index.html, findings.json and figures/. Exits with code 1 if a finding fails.

    nonholo paper
    nonholo paper --list
    nonholo paper -o part --only sus_int --only st
    """
    from nonholo.base.checks import needs
    from nonholo.base.progress import progress_bar

    with store_errors(USAGE), needs("paper", "nonholo paper"):
        from nonholo_paper import check_folder, entries, evaluate_all, select, write_folder

        selection = select(only) if only else entries()
        if is_list:
            rows = ((", ".join(e.names), e.finding.kind, e.finding.verdict, e.finding.source) for e in selection)
            screen.tables.show_table(("--only", "kind", "verdict", "where"), rows)
            return
        check_folder(output)
    with progress_bar("findings", sys.stderr.isatty()) as report:
        results = evaluate_all(selection, report)
    with store_errors(FAILED):
        write_folder(output, results, f"Only a part, chosen with --only: {', '.join(only)}." if only else "")
    if only:
        columns = "label", "verdict", "defect", "of what is denied", "tolerance", "holds", "seconds"
        screen.tables.show_table(columns, _findings(results))
    else:
        screen.tables.show_table(("section", "findings", "hold", "seconds"), _sections(results))
    echo(output / "index.html")
    if failures := [result.entry.finding.label for result in results if not result.holds]:
        leave(f"{len(failures)} of {len(results)} findings fail: {', '.join(failures)}.", FAILED)


def _findings(results: "list[Result]") -> Iterator[tuple[str, ...]]:
    for result in results:
        finding, measures = result.entry.finding, result.measured
        numbers = (measures and measures.corrected, measures and measures.printed, finding.tolerance)
        words = ("" if number is None else f"{number:.1e}" for number in numbers)
        yield finding.label, finding.verdict, *words, "yes" if result.holds else "no", f"{result.seconds:.2f}"


def _sections(results: "list[Result]") -> Iterator[tuple[str, ...]]:
    for heading in dict.fromkeys(result.entry.section.heading for result in results):
        own = [result for result in results if result.entry.section.heading == heading]
        holding, seconds = sum(result.holds for result in own), sum(result.seconds for result in own)
        yield heading, str(len(own)), str(holding), f"{seconds:.1f}"
