"""The parts of every table of a scenario: checked numbers, no unknown keys, one of several keys."""

from collections.abc import Callable
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

Number = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Count = Annotated[int, Field(gt=0, le=10**15)]
Vector = list[Number]
Matrix = list[Vector]


def checked_by(make: Callable[[Any], object]) -> AfterValidator:
    """Return the check of a value that stays as it is written, but of which something can be made."""

    def check(given: Any) -> Any:
        make(given)
        return given

    return AfterValidator(check)


class Section(BaseModel):
    """A table of a scenario: no unknown keys, no silent conversions. The string below a key says what it means."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, use_attribute_docstrings=True)


def exactly_one(section: Section, names: tuple[str, ...]) -> None:
    """Refuse a table that holds none or several of the keys."""
    given = [name for name in names if getattr(section, name) is not None]
    if len(given) != 1:
        raise ValueError(f"must hold exactly one of {', '.join(names)}. Got {' and '.join(given) or 'none'}.")
