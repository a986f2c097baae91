"""Bodies of scenarios: systems of the library, its ready examples, functions in a module of the user's own.

A table is of a class or a function, whose arguments are the keys; its docstring describes them.
"""

import contextlib
import functools
import importlib.util
import inspect
import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, ClassVar

from pydantic import Field, WithJsonSchema, create_model, model_validator

import nonholo
from nonholo.base.checks import needs
from nonholo.cli.scenario.sections import Numbers, Section, checked_by, meanings, suggestion, summary
from nonholo.groups import AbstractMatrixGroup
from nonholo.systems import SYSTEMS

Maker = Callable[..., Any]
_NAME = re.compile(r"(SO|SE|Translations)\((\d{1,4})\)")
_HOW = 'must be a name such as "SO(4)", "SE(3)" or "SE(2) x Translations(2)", or a table with a basis'


def arguments(make: Maker) -> dict[str, inspect.Parameter]:
    """Return the arguments of a class or a function by name."""
    return dict(inspect.signature(make).parameters)


class GroupTable(Section):
    """A group of the user's own: matrices that span its Lie algebra, and the form that it preserves, if any."""

    basis: Numbers
    form: Numbers | None = None


def group_of(text: Any) -> AbstractMatrixGroup:
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


def _factor(name: str) -> AbstractMatrixGroup:
    with contextlib.suppress(ValueError):
        if match := _NAME.fullmatch(name):
            return getattr(nonholo, match[1])(int(match[2]))
    raise ValueError(f"{_HOW}. Got {name!r}")


Group = Annotated[Any, checked_by(group_of), WithJsonSchema({"type": "group"})]


class MadeTable(Section):
    """A table of which something is made, once when it is read, so that the library's refusals are reported."""

    make: ClassVar[Maker]
    ways: ClassVar[tuple[Maker, ...]]  # the same, then others, of other keys

    @property
    def keywords(self) -> dict[str, Any]:
        """The arguments that the table has, by their names."""
        return self.model_dump(exclude_none=True, exclude={"kind"})

    @functools.cached_property
    def creation(self) -> Any:
        """The body that the table describes."""
        values = self.keywords
        for make in type(self).ways:
            known_arguments = arguments(make)
            necessary = {name for name, each in known_arguments.items() if each.default is each.empty}
            if necessary <= values.keys() <= known_arguments.keys():
                return _call(make, {name: group_of(x) if name == "group" else x for name, x in values.items()})
        words = " or ".join(", ".join(arguments(make)) for make in type(self).ways)
        raise ValueError(f"must hold the keys {words}. Got {', '.join(values) or 'none'}")

    @model_validator(mode="after")
    def _can_be_made(self) -> Any:
        _ = self.creation
        return self


def _call(make: Maker, values: dict[str, Any]) -> Any:
    try:
        return make(**values)
    except ValueError:
        raise
    except Exception as failure:  # of a function of the user's own
        raise ValueError(f"cannot be made of this: {type(failure).__name__}: {failure}") from failure


@functools.cache
def table_of(word: str, make: Maker, kind: bool = False, plain: bool = True) -> type[MadeTable]:
    """Return the table whose keys are the arguments of a class or a function.

    Args:
        word: Its name in a scenario.
        make: The class or function; other constructors of a class, `from_inertia`, give more keys.
        kind: Whether a key of the table names it.
        plain: Whether values are numbers, lists of them or groups, as everywhere in the library.
    """
    ways = (make, make.from_inertia) if hasattr(make, "from_inertia") else (make,)
    fields: dict[str, Any] = {"kind": (str, ...)} if kind else {}
    common = set.intersection(*({*arguments(way)} for way in ways))
    for way in ways:
        about = meanings(way)
        for name, each in arguments(way).items():
            shape = Group if name == "group" else Numbers if plain else Any
            meaning = about.get(name, f"As in `{way.__qualname__}`.")
            fields.setdefault(name, (shape, Field(_default_of(each) if name in common else None, description=meaning)))
    table = create_model(word, __base__=MadeTable, __doc__=summary(make), **fields)
    table.make, table.ways = make, ways
    return table


def _default_of(argument: inspect.Parameter) -> Any:
    """Return the default of an argument as TOML writes it; `...` for one that must be given."""
    default = argument.default
    return ... if default is argument.empty else [*default] if isinstance(default, tuple) else default


SHORT = {
    "suslov": "SuslovTop",
    "sleigh": "ChaplyginSleigh",
    "multidimensional_sleigh": "MultidimensionalSleigh",
    "rigid_body": "RigidBody",
    "veselova": "VeselovaTop",
    "left_invariant": "LLSystem",
    "right_invariant": "LRSystem",
}
"""Kinds that are called by another word than their class."""
_SYSTEMS: dict[str, Maker] = {each.__name__: each for each in SYSTEMS}
_NICKNAMES = {"top": "suslov or veselova", "body": "rigid_body", "skate": "sleigh"}
_OWN: dict[str, Maker] = {}


def kinds() -> list[str]:
    """Return every kind of body; those of the examples load JAX."""
    return [*_OWN, *SHORT, *_SYSTEMS, *examples()]


def nearest_kind(name: str) -> str:
    """Return which kind was probably meant, or all of them, and the option for the user's own kinds."""
    near = _NICKNAMES.get(name.lower())
    remedy = f"Did you mean {near}?" if near else suggestion(name.lower(), kinds(), most=2)
    return remedy if _OWN else f"{remedy} Your own functions are kinds with --module my_robot.py."


def own_kinds() -> list[str]:
    """Return the kinds of a module of the user's own, and those of systems: a class by one word."""
    return [*_OWN, *SHORT, *(name for name in _SYSTEMS if name not in SHORT.values())]


def body_table(kind: str) -> type[MadeTable]:
    """Return the table of a kind of body.

    Raises:
        KeyError: There is none of this name.
    """
    if kind in _OWN:
        return table_of(kind, _OWN[kind], kind=True, plain=False)
    name = SHORT.get(kind, kind)
    return table_of(kind, _SYSTEMS[name] if name in _SYSTEMS else examples()[kind], kind=True)


@functools.cache
def examples() -> dict[str, Maker]:
    """Return the functions of the ready examples by name."""
    with needs("jax", "nonholo.examples"):
        ready: Any = nonholo.examples
        return {name: getattr(ready, name) for name in ready.__all__ if name.islower()}


def is_example(name: str) -> bool:
    """Return whether a kind starts by itself: an example, or what a user's own function makes."""
    return name in _OWN or name not in (*SHORT, *_SYSTEMS)


def import_own(path: Path | None) -> dict[str, Maker]:
    """Run the user's module at a path: each public function and class in it is a kind of body."""
    _OWN.clear()
    if path is not None:
        module = _module_at(path)
        for name, value in vars(module).items():
            if callable(value) and not name.startswith("_") and value.__module__ == module.__name__:
                _OWN[name] = value
    return _OWN


def _module_at(path: Path) -> Any:
    name = path.stem
    if not (path.suffix == ".py" and name.isidentifier() and path.is_file()):
        raise ValueError(f"`--module` must be the path of a Python file. Got '{path}'. Pass one such as my_robot.py.")
    if (spec := importlib.util.find_spec(name)) is None:
        sys.path.insert(0, str(path.resolve().parent))  # where other processes find it too
    elif spec.origin != str(path.resolve()):
        got = f"'{path}', but there is a module {name} at {spec.origin}"
        raise ValueError(f"`--module` must have a name that no other module has. Got {got}. Rename it.")
    return importlib.import_module(name)
