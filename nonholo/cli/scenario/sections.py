"""The parts of every table of a scenario: plain numbers, no unknown keys, a table by its kind; problems in words.

Each problem comes with its file or option and its key path.
"""

import difflib
import inspect
import re
import reprlib
import sys
from collections.abc import Callable, Iterable, Iterator
from typing import Annotated, Any, NamedTuple

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError, WithJsonSchema, model_validator
from pydantic_core import InitErrorDetails, PydanticCustomError

Finite = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Count = Annotated[int, Field(gt=0, le=10**15)]
UNKNOWN = "unknown_key"
_CORE = re.compile(r"`[\w.]+\((\w+)=\.\.\.\)` (.*)", re.DOTALL)
_TEXTS = {"missing": "is missing", "model_type": "must be a table", "model_attributes_type": "must be a table"}
Key = tuple[int | str, ...]
_ENTRY = re.compile(r"^    (\w+): (.*(?:\n {8,}.*)*)", re.MULTILINE)


def meanings(make: Callable[..., Any]) -> dict[str, str]:
    """Return what a docstring says of each argument or attribute.

    Example:
        >>> import nonholo
        >>> meanings(nonholo.Gravity)["point"]
        'x, n body coordinates.'
    """
    _, *entries = re.split(r"(?:Args|Attributes):\n", inspect.getdoc(make) or "", maxsplit=1)
    entries, *_ = "".join(entries).split("\n\n")
    return {name: " ".join(text.split()) for name, text in _ENTRY.findall(entries)}


def summary(make: Callable[..., Any]) -> str:
    """Return the first line of a docstring."""
    return (inspect.getdoc(make) or "").partition("\n")[0]


def suggestion(name: str, names: Iterable[str], most: int = 1) -> str:
    """Return the name that was probably meant, or a few, or all of them."""
    close = difflib.get_close_matches(name, names := list(names), n=most)
    return f"Did you mean {' or '.join(close)}?" if close else f"Known: {', '.join(names)}."


def checked_by(make: Callable[[Any], object]) -> AfterValidator:
    """Return the check of a value that stays as it is written, but of which something can be made."""

    def check(value: Any) -> Any:
        make(value)
        return value

    return AfterValidator(check)


def check_numbers(value: Any) -> None:
    """Refuse what is neither a finite number nor a list of lists of them, each entry at its place."""
    if flaws := list(_flaws(value, ())):
        raise ValidationError.from_exception_data("numbers", flaws)


def _flaws(value: Any, place: tuple[int, ...]) -> Iterator[InitErrorDetails]:
    if isinstance(value, list):
        for index, entry in enumerate(value):
            yield from _flaws(entry, (*place, index))
    elif isinstance(value, bool) or not isinstance(value, int | float):
        yield {"type": "float_type", "loc": place, "input": value}
    elif not abs(value) <= sys.float_info.max:  # an integer may have thousands of digits
        yield {"type": "finite_number", "loc": place, "input": value}


Numbers = Annotated[Any, checked_by(check_numbers), WithJsonSchema({"type": "numbers"})]
"""A number, a vector or a matrix; how many it must be says the library."""


class Section(BaseModel):
    """A table of a scenario: no unknown keys, no silent conversions. Its docstring describes the keys."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        own = cls.__annotations__
        own |= {x: Annotated[own[x], Field(description=text)] for x, text in meanings(cls).items() if x in own}
        cls.__doc__ = summary(cls)

    @model_validator(mode="wrap")
    @classmethod
    def _suggest(cls, table: Any, handler: Callable[[Any], Any]) -> Any:
        """Name the known key that an unknown one resembles."""
        try:
            return handler(table)
        except ValidationError as failure:
            keys = [field.alias or name for name, field in cls.model_fields.items()]
            flaws = [_details_of(entry, keys) for entry in failure.errors(include_url=False)]
            raise ValidationError.from_exception_data(cls.__name__, flaws) from None


def _details_of(entry: Any, keys: Iterable[str]) -> InitErrorDetails:
    flaw: Any = {"type": entry["type"], "loc": entry["loc"], "input": entry["input"], "ctx": entry.get("ctx", {})}
    if entry["type"] == "extra_forbidden" and len(entry["loc"]) == 1:
        text = f"is not a known key. {suggestion(str(entry['loc'][0]), keys)}"
        return flaw | {"type": PydanticCustomError(UNKNOWN, "{text}", {"text": text})}
    return flaw | {"type": PydanticCustomError(UNKNOWN, "{text}", entry["ctx"])} if entry["type"] == UNKNOWN else flaw


def by_kind(table_of: Callable[[str], type[Section]], remedy: Callable[[str], str]) -> AfterValidator:
    """Return the check of a table by its kind; `table_of` raises a `KeyError` for an unknown one."""

    def read(table: Any) -> Any:
        if not isinstance(table, dict):
            flaw: InitErrorDetails = {"type": "model_type", "input": table, "ctx": {"class_name": ""}}
            raise ValidationError.from_exception_data("", [flaw])
        kind = table.get("kind")
        try:
            model = table_of(kind) if isinstance(kind, str) else None
        except KeyError:
            model = None
        if model is None:
            got = "none" if kind is None else repr(kind)
            raise ValueError(f"must have a known kind. Got {got}. {remedy(str(kind))}")
        return model.model_validate(table)

    return AfterValidator(read)


class Problem(NamedTuple):
    """One thing wrong, and where it was said: a file or an option, and a key path."""

    source: str
    key: str
    text: str

    def __str__(self) -> str:
        return ": ".join(part for part in self if part)


class ScenarioError(Exception):
    """A scenario that cannot be run, with everything that is wrong with it."""

    def __init__(self, problems: list[Problem]) -> None:
        super().__init__("\n".join(map(str, problems)))
        self.problems = problems


class Origin(NamedTuple):
    """Where a document comes from: its name in messages, and the options that gave some of its key paths."""

    source: str
    options: dict[str, str]

    def error(self, *flaws: tuple[str, str]) -> ScenarioError:
        """Return the error of what is wrong: key paths and texts."""
        return ScenarioError([Problem(self._owner(key), key, text) for key, text in flaws])

    def error_of(self, failure: ValidationError, table: Key = ()) -> ScenarioError:
        """Return the error of a validation, all within a table."""
        return self.error(*(_flaw(dict(entry), table) for entry in failure.errors(include_url=False)))

    def _owner(self, key: str) -> str:
        """Return the option that gave the value at a key path, or the source."""
        for path, option in self.options.items():
            if key == path or key.startswith((f"{path}.", f"{path}[")) or path.startswith(f"{key}."):
                return option
        return self.source


def _flaw(entry: dict[str, Any], table: Key) -> tuple[str, str]:
    key = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in (*table, *entry["loc"])).lstrip(".")
    if entry["type"] == "value_error":
        return split_core(key, str(entry["ctx"]["error"]))
    if entry["type"] == UNKNOWN:
        return key, entry["msg"]
    text = _TEXTS.get(entry["type"]) or entry["msg"].replace("Input should", "must", 1)
    return key, text if entry["type"] == "missing" else f"{text}. Got {reprlib.repr(entry['input'])}"


def split_core(section: str, message: str) -> tuple[str, str]:
    """Return the key path of the argument that an error of the library names, and what it says; else the section."""
    match = _CORE.fullmatch(message)
    return (f"{section}.{match[1]}", match[2]) if match else (section, message)
