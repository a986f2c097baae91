"""Write docs/paper.md and docs/errata.md from the findings of the paper: `python docs/make_paper_pages.py`."""

import re
from pathlib import Path

import jinja2

from nonholo.reproduction._checklist import Section, sections
from nonholo.reproduction._registry import Entry, entries

DOCS = Path(__file__).parent
NAMES = ("paper.md", "errata.md")
_VERDICTS = {True: "as printed", "misprint": "misprint", False: "**refuted**"}


def page(name: str) -> str:
    """Return the text of a page."""
    loader = jinja2.FileSystemLoader(DOCS / "templates")
    environment = jinja2.Environment(loader=loader, autoescape=False, undefined=jinja2.StrictUndefined)  # noqa: S701 (Markdown)
    return environment.get_template(f"{name}.j2").render(
        sections=sections(),
        findings=findings,
        errata=errata,
        count=len(entries()),
        rows=sum(len(section.errata) for section in sections()),
    )


def findings(section: Section) -> str:
    """Return the table of the findings of a section."""
    own = [entry for entry in entries() if entry.section is section]
    rows = [_row(_where(entry), *_texts(entry), f"{entry.finding.tolerance:.0e}") for entry in own]
    return "\n".join(["| place and label | printed | | right | holds to |", "|---|---|---|---|---|", *rows])


def errata(*keys: str) -> str:
    """Return the table of the errata of sections."""
    numbers = [number for key in keys for section in sections() if section.key == key for number in section.errata]
    rows = [_erratum(number) for number in numbers]
    return "\n".join(["| no. | place | printed | right | finding |", "|---|---|---|---|---|", *rows])


def _erratum(number: str) -> str:
    """Return the row of an erratum: the words of the finding that is most its own, the labels of all that decide it."""
    deciding = [entry.finding for entry in entries() if number in entry.finding.errata]
    if not deciding:
        raise ValueError(f"No finding decides row {number} of the errata.")
    own = min(deciding, key=lambda finding: (finding.label != number, finding.as_printed is True, len(finding.errata)))
    claim = " (**claim**)" if own.as_printed is False else ""
    labels = ", ".join(dict.fromkeys(f"`{finding.label}`" for finding in deciding))
    return _row(number, own.source + claim, own.claim, own.corrected or "right as printed", labels)


def _where(entry: Entry) -> str:
    picture = f", `figures/{entry.figure.name}`" if entry.figure else ""
    return f"{entry.finding.source}: `{entry.finding.label}`{picture}"


def _texts(entry: Entry) -> tuple[str, str, str]:
    return entry.finding.claim, _VERDICTS[entry.finding.as_printed], entry.finding.corrected or ""


def _row(*cells: str) -> str:
    return f"| {' | '.join(_cell(text) for text in cells)} |"


def _cell(text: str) -> str:
    """Return a text in which no bar ends the cell."""
    parts = re.split(r"(\$[^$]+\$)", " ".join(text.split()))
    return "".join(_formula(part) if part.startswith("$") else part.replace("|", r"\|") for part in parts)


def _formula(text: str) -> str:
    return text.replace(r"\|", r"\Vert ").replace("|", r"\vert ")


def main() -> None:
    """Write the pages."""
    for name in NAMES:
        (DOCS / name).write_text(page(name), "utf-8")


if __name__ == "__main__":
    main()
