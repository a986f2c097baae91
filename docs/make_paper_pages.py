"""Write docs/paper.md and docs/errata.md from the findings of the paper: `python docs/make_paper_pages.py`."""

import re
from collections import Counter
from pathlib import Path

import jinja2

from nonholo_paper import Entry, Finding, Section, Verdict, entries, sections

DOCS = Path(__file__).parent
NAMES = ("paper.md", "errata.md")


def page(name: str) -> str:
    """Return the text of a page."""
    loader = jinja2.FileSystemLoader(DOCS / "templates")
    environment = jinja2.Environment(loader=loader, autoescape=False, undefined=jinja2.StrictUndefined)  # noqa: S701 (Markdown)
    return environment.get_template(f"{name}.j2").render(
        sections=sections(),
        findings=findings,
        verdicts=verdicts,
        errata=errata,
        count=len(entries()),
        rows=sum(len(section.errata) for section in sections()),
    )


def verdicts(*, errata: bool) -> str:
    """Return the table of what is said of statements: of all findings, or of the rows of the errata."""
    words = [_deciding(number)[0].verdict for section in sections() for number in section.errata]
    count = Counter(words if errata else [entry.finding.verdict for entry in entries()])
    rows = [_row(f"**{word}**", word.meaning, str(count[word])) for word in Verdict if count[word]]
    return "\n".join([f"| | meaning | {'rows' if errata else 'findings'} |", "|---|---|---:|", *rows])


def findings(section: Section) -> str:
    """Return the table of the findings of a section."""
    own = [entry for entry in entries() if entry.section is section]
    rows = [_row(_where(entry), *_texts(entry), f"{entry.finding.tolerance:.0e}") for entry in own]
    return "\n".join(["| place and label | printed | | right, or added | holds to |", "|---|---|---|---|---|", *rows])


def errata(*keys: str) -> str:
    """Return the table of the errata of sections."""
    numbers = [number for key in keys for section in sections() if section.key == key for number in section.errata]
    rows = [_erratum(number) for number in numbers]
    return "\n".join(["| no. | place | printed | | right | finding |", "|---|---|---|---|---|---|", *rows])


def _erratum(number: str) -> str:
    """Return the row of an erratum: the words of the finding that is most its own, the labels of all that decide it."""
    deciding = _deciding(number)
    labels = ", ".join(dict.fromkeys(f"`{finding.label}`" for finding in deciding))
    return _row(number, deciding[0].source, deciding[0].claim, deciding[0].verdict, deciding[0].corrected or "", labels)


def _deciding(number: str) -> list[Finding]:
    """Return the findings that decide a row of the errata, the one with its label first."""
    deciding = [entry.finding for entry in entries() if number in entry.finding.errata]
    if not deciding:
        raise ValueError(f"No finding decides row {number} of the errata.")
    return sorted(deciding, key=lambda finding: (finding.label != number, len(finding.errata)))


def _where(entry: Entry) -> str:
    picture = f", `figures/{entry.figure.name}`" if entry.figure else ""
    return f"{entry.finding.source}: `{entry.finding.label}`{picture}"


def _texts(entry: Entry) -> tuple[str, str, str]:
    return entry.finding.claim, entry.finding.verdict, entry.finding.corrected or ""


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
