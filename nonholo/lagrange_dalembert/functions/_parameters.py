"""Parameters: numbers of a system by name, which all of its functions take last, and functions with these put in."""

import dataclasses
import difflib
import inspect
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import jax
import numpy as np

from nonholo.base.checks import array, error, instance, is_traced, name, number, shape_of, shown

_WHERE = "LagrangeDAlembert(parameters=...)"


class Parameters(Mapping[str, Any]):
    """Numbers and arrays by name, in an order; equal where names, shapes and numbers are.

    Example:
        >>> Parameters({"mass": 1.0}) == Parameters({"mass": 1}), Parameters({"mass": 1.0})
        (True, {'mass': 1.0})
    """

    def __init__(self, numbers: Any) -> None:
        instance(_WHERE, numbers, Mapping, "be a mapping of names to numbers", "Pass a dict.")
        self._hold({name(_WHERE, key, ("time_step",)): _valid_number(_WHERE, key, x) for key, x in numbers.items()})

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
            remedy = f"It has {', '.join(self)}." if self else "It has none: pass LagrangeDAlembert(parameters=...)."
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


@dataclasses.dataclass(frozen=True, eq=False)
class Bound:
    """A function with its last argument put in: parameters by name."""

    function: Callable[..., Any]
    parameters: Mapping[str, Any]

    def __call__(self, *arguments: Any) -> Any:
        """Return the value."""
        return self.function(*arguments, self.parameters)

    @property
    def __signature__(self) -> inspect.Signature:
        signature = inspect.signature(self.function)
        return signature.replace(parameters=[*signature.parameters.values()][:-1])

    @property
    def is_of_one_step(self) -> bool:
        """Whether it was made for one time step."""
        return getattr(self.function, "is_of_one_step", False)
