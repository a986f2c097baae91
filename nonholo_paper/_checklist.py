"""The list of what has to have a finding: labels, footnotes and errata rows, in the order of the paper.

The names stand in checklist.toml. Each finding names the ones that it decides.
"""

import dataclasses
import functools
import tomllib
from importlib import resources


@dataclasses.dataclass(frozen=True)
class Section:
    """A section of the paper and the names in it.

    Attributes:
        key: "section4", as in the names of its modules of statements.
        title: Its heading, in our spelling.
        labels: Labels and footnotes, in order.
        errata: Rows of the errata, in the order of their table.
        claims: Names of ours for findings without a label in the paper.
    """

    key: str
    title: str
    labels: tuple[str, ...]
    errata: tuple[str, ...]
    claims: tuple[str, ...]

    @property
    def heading(self) -> str:
        """Return number and title.

        Example:
            >>> sections()[3].heading
            'Section 4. The Suslov problem and its multidimensional generalizations'
        """
        number = self.key.removeprefix("section")
        return f"Section {number}. {self.title}" if number != self.key else self.title


@functools.cache
def sections() -> tuple[Section, ...]:
    """Return the sections of the paper in order."""
    table = tomllib.loads((resources.files("nonholo_paper") / "checklist.toml").read_text("utf-8"))
    return tuple(
        Section(key, entry["title"], tuple(entry["labels"]), tuple(entry["errata"]), tuple(entry["claims"]))
        for key, entry in table.items()
    )
