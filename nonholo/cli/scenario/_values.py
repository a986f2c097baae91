"""Values of a design as a scenario writes them: lists and ranges of a grid, distributions of a random design."""

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import nonholo
from nonholo.base.checks import is_integer, shown
from nonholo.base.limits import bounded_count
from nonholo.cli.scenario.sections import checked_by

if TYPE_CHECKING:
    import numpy as np

    from nonholo.ensembles import AbstractDistribution

_RANGE = "{from = 0.1, to = 10.0, count = 50}"
_SPACINGS = ("linear", "logarithmic")
_PAIRS = {
    "uniform": "uniform = [low, high]",
    "log_uniform": "log_uniform = [low, high]",
    "normal": "normal = [mean, deviation]",
    "mass_tensor": "mass_tensor = [least, largest eigenvalue]",
}
_SIZED = ("normal", "direction", "mass_tensor")
_NEED_SIZE = {"direction": "vectors", "mass_tensor": "matrices"}
_KINDS: "dict[str, Callable[[Any, Any], AbstractDistribution]]" = {
    "uniform": lambda bounds, _: nonholo.Uniform(*bounds),
    "log_uniform": lambda bounds, _: nonholo.LogUniform(*bounds),
    "normal": lambda moments, size: nonholo.Normal(*moments, size=size),
    "direction": lambda length, size: nonholo.Direction(size, length),
    "mass_tensor": lambda bounds, size: nonholo.MassTensor(size, *bounds),
    "choice": lambda values, _: nonholo.Choice(values),
}
"""The distributions by their words, each made of its argument and its size."""


def is_range(given: Any) -> bool:
    """Tell whether values of a grid are a range, whose count can be scaled."""
    return isinstance(given, dict)


def along(given: Any) -> "np.ndarray":
    """Return the values along one axis of a grid.

    Example:
        >>> along({"from": 1.0, "to": 100.0, "count": 3, "spacing": "logarithmic"})
        array([  1.,  10., 100.])
    """
    return _range(given) if is_range(given) else _list(given)


def _range(given: dict[str, Any]) -> "np.ndarray":
    import numpy as np

    _known(given, ["from", "to", "count", "spacing"], ["from", "to", "count"], _RANGE)
    begin, end, spacing = given["from"], given["to"], given.get("spacing", "linear")
    if not (_is_number(begin) and _is_number(end)):
        raise ValueError(f"must have numbers at from and to. Got {begin!r} and {end!r}")
    count = _count(given["count"])
    if spacing not in _SPACINGS:
        raise ValueError(f'must have spacing "linear" or "logarithmic". Got {spacing!r}')
    if spacing == "logarithmic" and not (begin > 0 and end > 0):
        raise ValueError(f"must have positive bounds for logarithmic spacing. Got {begin} and {end}")
    return (np.geomspace if spacing == "logarithmic" else np.linspace)(begin, end, count)


def _count(given: Any) -> int:
    if not is_integer(given) or given < 1:
        raise ValueError(f"must have a positive integer as count. Got {shown(given)}")
    try:
        return bounded_count("count", given, 64.0, "Pass how many values.")
    except ValueError as failure:
        raise ValueError(f"must have a count that is possible: {failure}") from None


def _list(given: Any) -> "np.ndarray":
    import numpy as np

    requirement = f"must be a list of numbers, vectors or matrices of one shape, or a range such as {_RANGE}"
    if not isinstance(given, list) or not given or not _are_numbers(given):
        raise ValueError(f"{requirement}. Got {given!r}")
    try:
        return np.array(given, dtype=float)
    except ValueError:
        raise ValueError(f"{requirement}. Got {given!r}") from None


def _are_numbers(given: Any) -> bool:
    if isinstance(given, list):
        return all(_are_numbers(entry) for entry in given)
    return _is_number(given)


def _is_number(given: Any) -> bool:
    return isinstance(given, int | float) and not isinstance(given, bool) and math.isfinite(given)


def drawn(given: Any) -> "AbstractDistribution":
    """Return the distribution that a table describes.

    Example:
        >>> drawn({"uniform": [0.1, 1.0]})
        Uniform(low=0.1, high=1.0)
        >>> drawn({"direction": 0.3, "size": 2})
        Direction(size=2, length=0.3)
    """
    names = [name for name in given if name in _KINDS] if isinstance(given, dict) else []
    if len(names) != 1:
        raise ValueError(f"must hold one of {', '.join(_KINDS)}, as in {{uniform = [0.1, 1.0]}}. Got {given!r}")
    kind = names[0]
    _check_drawn(kind, given)
    try:
        return _KINDS[kind](given[kind], given.get("size"))
    except ValueError as failure:
        raise ValueError(f"{kind}: {str(failure).partition('` ')[2] or failure}") from None


def _check_drawn(kind: str, given: dict[str, Any]) -> None:
    """Refuse a table of a distribution with other keys, no pair where it needs one, or no size."""
    _known(given, [kind, "size"] if kind in _SIZED else [kind], [kind], f"{{{kind} = ...}}")
    argument = given[kind]
    if kind in _PAIRS and not (isinstance(argument, list) and len(argument) == 2):
        raise ValueError(f"must be {_PAIRS[kind]}. Got {argument!r}")
    if kind in _NEED_SIZE and "size" not in given:
        raise ValueError(f"needs size = ..., the length of the {_NEED_SIZE[kind]}, or a value in its own table")


def needs_size(given: Any) -> bool:
    """Tell whether a distribution lacks the size that its own table can give it."""
    return isinstance(given, dict) and "size" not in given and bool(set(_NEED_SIZE) & set(given))


def _known(given: dict[str, Any], keys: list[str], needed: list[str], example: str) -> None:
    unknown, missing = [key for key in given if key not in keys], [key for key in needed if key not in given]
    if unknown or missing:
        fault = f"without {', '.join(missing)}" if missing else f"with {', '.join(unknown)}"
        raise ValueError(f"must have the keys of {example}. Got a table {fault}")


Along: TypeAlias = Annotated[Any, checked_by(along)]
"""Values along one axis of a grid."""
Drawn: TypeAlias = Annotated[Any, checked_by(drawn)]
"""The distributions that members of a random design draw from."""
