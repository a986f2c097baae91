"""Groups as a scenario writes them: a name such as "SO(4)", a product of names, or a table with a basis."""

import re
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Discriminator, Tag

import nonholo
from nonholo.cli.scenario.sections import Matrix, Section, checked_by

if TYPE_CHECKING:
    from nonholo.groups import AbstractMatrixGroup

_NAME = re.compile(r"(SO|SE|Translations)\((\d{1,4})\)")
_HOW = 'must be a name such as "SO(4)", "SE(3)" or "SE(2) x Translations(2)", or a table with a basis'
NAME, TABLE = "group by name", "group by basis"
"""Parts that pydantic adds to the key path of a group."""


class GroupTable(Section):
    """A group of the user's own: matrices that span its Lie algebra, and the form that it preserves, if any."""

    basis: list[Matrix]
    form: Matrix | None = None


def group_of(given: str | GroupTable) -> "AbstractMatrixGroup":
    """Return the group that a scenario names or spans.

    Example:
        >>> group_of("SE(2) x Translations(2)")
        ProductGroup(SE(2), Translations(2))
    """
    if isinstance(given, GroupTable):
        return nonholo.MatrixGroup(given.basis, given.form)
    factors = [_factor(name.strip()) for name in given.split(" x ")]
    return factors[0] if len(factors) == 1 else nonholo.ProductGroup(*factors)


def _factor(name: str) -> "AbstractMatrixGroup":
    found = _NAME.fullmatch(name)
    try:
        if found:
            return getattr(nonholo, found[1])(int(found[2]))
    except ValueError:
        pass
    raise ValueError(f"{_HOW}. Got {name!r}")


def _tag(given: Any) -> str:
    return TABLE if isinstance(given, dict | GroupTable) else NAME


Group = Annotated[
    Annotated[str, Tag(NAME)] | Annotated[GroupTable, Tag(TABLE)], Discriminator(_tag), checked_by(group_of)
]
