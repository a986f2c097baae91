"""The parts of every table of a scenario: plain numbers, no unknown keys, one of several keys, a table by its kind."""

import difflib
import math
from collections.abc import Callable, Iterable, Iterator
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError, WithJsonSchema, model_validator
from pydantic_core import InitErrorDetails, PydanticCustomError

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Count = Annotated[int, Field(gt=0, le=10**15)]
UNKNOWN = "unknown_key"


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
    elif not is_finite(value):
        yield {"type": "finite_number", "loc": place, "input": value}


def is_finite(value: float) -> bool:
    """Return whether a number is one in double precision; an integer may have thousands of digits."""
    try:
        return math.isfinite(value)
    except OverflowError:
        return False


Numbers = Annotated[Any, checked_by(check_numbers), WithJsonSchema({"type": "numbers"})]
"""A number, a vector or a matrix; how many it must be says the library."""


class Section(BaseModel):
    """A table of a scenario: no unknown keys, no silent conversions. The string below a key describes it."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, use_attribute_docstrings=True)

    @model_validator(mode="wrap")
    @classmethod
    def _suggest(cls, table: Any, handler: Callable[[Any], Any]) -> Any:
        """Name the known key that an unknown one resembles."""
        try:
            return handler(table)
        except ValidationError as failure:
            flaws = [_details_of(entry, cls.model_fields) for entry in failure.errors(include_url=False)]
            raise ValidationError.from_exception_data(cls.__name__, flaws) from None


def _details_of(entry: Any, keys: Iterable[str]) -> InitErrorDetails:
    flaw: Any = {"type": entry["type"], "loc": entry["loc"], "input": entry["input"], "ctx": entry.get("ctx", {})}
    if entry["type"] == "extra_forbidden" and len(entry["loc"]) == 1:
        text = f"is not a known key. {suggestion(str(entry['loc'][0]), keys)}"
        return flaw | {"type": PydanticCustomError(UNKNOWN, "{text}", {"text": text})}
    if entry["type"] == UNKNOWN:
        return flaw | {"type": PydanticCustomError(UNKNOWN, "{text}", entry["ctx"])}
    return flaw


def by_kind(table_of: Callable[[str], type[Section]], remedy: Callable[[str], str]) -> AfterValidator:
    """Return the check of a table by its kind; `table_of` raises a `KeyError` for an unknown one."""

    def read(table: Any) -> Any:
        if isinstance(table, Section):
            return table
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
