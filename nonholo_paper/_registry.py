"""All findings, in the order of the paper, and the choice of some of them by name."""

import dataclasses
import difflib
import functools
import importlib
import pkgutil
from collections.abc import Iterable, Iterator

from nonholo_paper import statements
from nonholo_paper._checklist import Section, sections
from nonholo_paper._finding import Finding
from nonholo_paper.figures import Figure, figures


@dataclasses.dataclass(frozen=True)
class Entry:
    """A finding with its section, and its picture if it has one."""

    finding: Finding
    section: Section
    figure: Figure | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """Return the names by which it can be chosen: its label, its rows of the errata, its picture."""
        picture = (self.figure.name,) if self.figure else ()
        return tuple(dict.fromkeys((self.finding.label, *self.finding.errata, *picture)))  # a label may be a row


class UnknownLabelError(ValueError):
    """A name that no finding has."""


@functools.cache
def entries() -> tuple[Entry, ...]:
    """Return every finding in the order of the paper; those without a label stand where their module has them."""
    ranks = {label: rank for rank, label in enumerate(label for part in sections() for label in part.labels)}
    ranked: list[tuple[int, int, Entry]] = []
    for series in (*_statements(), _pictures()):
        first = (ranks[entry.finding.label] for entry in series if entry.finding.label in ranks)
        rank = next(first, len(ranks))
        for entry in series:
            rank = ranks.get(entry.finding.label, rank)
            ranked.append((_number(entry.section), rank, entry))
    return tuple(entry for *_, entry in sorted(ranked, key=lambda triple: triple[:2]))


def select(names: Iterable[str]) -> tuple[Entry, ...]:
    """Return the findings with given labels, rows of the errata or names of pictures.

    Raises:
        UnknownLabelError: No finding has one of the names; the message lists near ones.
    """
    wanted = set(names)
    reference = {name for entry in entries() for name in entry.names}
    for name in sorted(wanted - reference):
        near = difflib.get_close_matches(name, sorted(reference), n=3, cutoff=0.5)
        remedy = f"Did you mean {' or '.join(near)}?" if near else "The labels are those of docs/paper.md."
        raise UnknownLabelError(f"The paper has no finding {name!r}. {remedy}")
    return tuple(entry for entry in entries() if wanted & set(entry.names))


def _statements() -> Iterator[list[Entry]]:
    for module in sorted(pkgutil.iter_modules(statements.__path__), key=lambda info: info.name):
        loaded = importlib.import_module(f"{statements.__name__}.{module.name}")
        home = next(section for section in sections() if section.key == module.name.partition("_")[0])
        result = [value for value in vars(loaded).values() if isinstance(value, Finding)]
        yield [Entry(finding, _section(finding, home)) for finding in result]


def _pictures() -> list[Entry]:
    result: list[Entry] = []
    for figure in figures().values():
        home = result[-1].section if result else sections()[0]
        result.append(Entry(figure.finding, _section(figure.finding, home), figure))
    return result


def _section(finding: Finding, home: Section) -> Section:
    """Return the section that lists a label; of a row of the errata, the section of its module or picture."""
    listed = (section for section in sections() if finding.label in section.labels + section.claims)
    return next(listed, home)


def _number(section: Section) -> int:
    return sections().index(section)
