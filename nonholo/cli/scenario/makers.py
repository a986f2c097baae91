"""Tables of which a class or a function makes something: arguments are the keys, docstrings say what they mean."""

import functools
import inspect
import re
from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import Field, WithJsonSchema, create_model, model_validator

import nonholo
from nonholo.cli.scenario.sections import Numbers, Section, checked_by

if TYPE_CHECKING:
    from nonholo.groups import AbstractMatrixGroup

Maker = Callable[..., Any]
_NAME = re.compile(r"(SO|SE|Translations)\((\d{1,4})\)")
_HOW = 'must be a name such as "SO(4)", "SE(3)" or "SE(2) x Translations(2)", or a table with a basis'
_ENTRY = re.compile(r"^    (\w+): (.*(?:\n {8,}.*)*)", re.MULTILINE)


def arguments(make: Maker) -> dict[str, inspect.Parameter]:
    """Return the arguments of a class or a function by name."""
    return dict(inspect.signature(make).parameters)


def meanings(make: Maker) -> dict[str, str]:
    """Return what a docstring says of each argument.

    Example:
        >>> import nonholo
        >>> meanings(nonholo.Gravity)["point"]
        'x, n body coordinates.'
    """
    _, _, entries = (inspect.getdoc(make) or "").partition("Args:\n")
    entries, *_ = entries.split("\n\n")
    return {name: " ".join(text.split()) for name, text in _ENTRY.findall(entries)}


def summary(make: Maker) -> str:
    """Return the first line of a docstring."""
    return (inspect.getdoc(make) or "").partition("\n")[0]


class GroupTable(Section):
    """A group of the user's own: matrices that span its Lie algebra, and the form that it preserves, if any."""

    basis: Numbers
    form: Numbers | None = None


def group_of(text: Any) -> "AbstractMatrixGroup":
    """Return the group that a scenario names or spans.

    Example:
        >>> group_of("SE(2) x Translations(2)")
        ProductGroup(SE(2), Translations(2))
    """
    if isinstance(text, dict):
        table = GroupTable.model_validate(text)
        return nonholo.MatrixGroup(table.basis, table.form)
    factors = [_factor(name.strip()) for name in str(text).split(" x ")]
    return factors[0] if len(factors) == 1 else nonholo.ProductGroup(*factors)


def _factor(name: str) -> "AbstractMatrixGroup":
    try:
        if named := _NAME.fullmatch(name):
            return getattr(nonholo, named[1])(int(named[2]))
    except ValueError:
        pass
    raise ValueError(f"{_HOW}. Got {name!r}")


Group = Annotated[Any, checked_by(group_of), WithJsonSchema({"type": "group"})]


class MadeTable(Section):
    """A table of which something is made, once when it is read, so that the library's refusals are reported."""

    make: ClassVar[Maker]
    others: ClassVar[tuple[Maker, ...]] = ()
    """Other ways to make the same, of other keys."""

    @property
    def values(self) -> dict[str, Any]:
        """What is given, by the names of the arguments."""
        return self.model_dump(exclude_none=True, exclude={"kind"})

    @functools.cached_property
    def made(self) -> Any:
        """What the table makes."""
        values = self.values
        ways = (type(self).make, *type(self).others)
        for make in ways:
            known = arguments(make)
            needed = {name for name, each in known.items() if each.default is each.empty}
            if needed <= values.keys() <= known.keys():
                return _called(make, {name: group_of(x) if name == "group" else x for name, x in values.items()})
        words = " or ".join(", ".join(arguments(make)) for make in ways)
        raise ValueError(f"must hold the keys {words}. Got {', '.join(values) or 'none'}")

    @model_validator(mode="after")
    def _can_be_made(self) -> Any:
        _ = self.made
        return self


def _called(make: Maker, values: dict[str, Any]) -> Any:
    try:
        return make(**values)
    except ValueError:
        raise
    except Exception as failure:  # of a function of the user's own
        raise ValueError(f"cannot be made of this: {type(failure).__name__}: {failure}") from failure


def table_of(word: str, make: Maker, kind: bool = False, plain: bool = True) -> type[MadeTable]:
    """Return the table whose keys are the arguments of a class or a function.

    Args:
        word: What it is called in a scenario.
        make: The class or function; other constructors of a class, `from_inertia`, give more keys.
        kind: Whether the table says what it is by a key.
        plain: Whether values are numbers, lists of them or groups, as everywhere in the library.
    """
    others = tuple(getattr(make, name) for name in ("from_inertia",) if hasattr(make, name))
    fields: dict[str, Any] = {"kind": (str, ...)} if kind else {}
    for way in (make, *others):
        about = meanings(way)
        for name, each in arguments(way).items():
            is_shared = all(name in arguments(other) for other in (make, *others))
            default = each.default if is_shared else None
            if default is each.empty:
                default = ...
            elif isinstance(default, tuple):
                default = list(default)
            shape = Group if name == "group" else Numbers if plain else Any
            fields.setdefault(name, (shape, Field(default, description=about.get(name))))
    table = create_model(word, __base__=MadeTable, __doc__=summary(make), **fields)
    table.make, table.others = make, others
    return table
