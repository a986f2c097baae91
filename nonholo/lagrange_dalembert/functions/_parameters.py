"""Parameters: numbers of a system by name, which all of its functions take last."""

import difflib
from collections.abc import Iterator, Mapping
from typing import Any

import jax
import numpy as np

from nonholo.base.checks import array, checked_name, error, instance, is_traced, number, shape_of, shown


class Parameters(Mapping[str, Any]):
    """Numbers and arrays by name, in an order; equal where names, shapes and numbers are.

    Example:
        >>> Parameters({"mass": 1.0}) == Parameters({"mass": 1}), Parameters({"mass": 1.0})
        (True, {'mass': 1.0})
    """

    def __init__(self, numbers: Any, owner: str = "LagrangeDAlembert") -> None:
        where = f"{owner}(parameters=...)"
        instance(where, numbers, Mapping, "be a mapping of names to numbers", "Pass a dict.")
        self._hold(
            {checked_name(where, key, ("time_step",)): _valid_number(where, key, x) for key, x in numbers.items()}
        )

    def _hold(self, numbers: dict[str, Any]) -> None:
        self._numbers = numbers
        self._key = tuple(
            (key, np.shape(value), id(value) if is_traced(value) else np.asarray(value).tobytes())
            for key, value in numbers.items()
        )

    def __getitem__(self, name: str) -> Any:
        return self._numbers[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._numbers)

    def __len__(self) -> int:
        return len(self._numbers)

    def __repr__(self) -> str:
        return f"{{{', '.join(f'{key!r}: {_brief(value)}' for key, value in self.items())}}}"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Parameters) and self._key == other._key

    def __hash__(self) -> int:
        return hash(self._key)

    @property
    def structure(self) -> dict[str, jax.ShapeDtypeStruct]:
        """Their shapes."""
        return {key: jax.ShapeDtypeStruct(np.shape(value), float) for key, value in self.items()}

    @property
    def nothing(self) -> "Parameters":
        """Zeros of the same names and shapes."""
        return Parameters({key: np.zeros(np.shape(value)) for key, value in self.items()})

    def replace(self, where: str, numbers: Mapping[str, Any]) -> "Parameters":
        """Return them with other numbers of the same names and shapes."""
        for key in numbers.keys() - self.keys():
            near = difflib.get_close_matches(key, self, n=1)
            remedy = f"It has {', '.join(self)}." if self else "It has none: make it with parameters=..."
            raise error(
                where, "name parameters of the system", shown(key), f"Did you mean {near[0]}?" if near else remedy
            )
        other, own = object.__new__(Parameters), self._numbers
        changes = {key: _valid_number(where, key, value, np.shape(own[key])) for key, value in numbers.items()}
        other._hold(own | changes)
        return other


def _brief(value: Any) -> str:
    return f"shape {np.shape(value)}" if is_traced(value) or np.ndim(value) else repr(float(value))


def _valid_number(where: str, key: str, value: Any, shape: tuple[int, ...] | None = None) -> Any:
    """Return a number, or an array of the given shape or any."""
    where, shape = where.replace("...", f"{{{key!r}: ...}}"), shape_of(value) if shape is None else shape
    return array(where, value, shape, "Pass real numbers.") if shape else number(where, value)
