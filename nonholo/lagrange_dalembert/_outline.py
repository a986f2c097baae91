"""How a body in the plane looks from above: what pictures draw, and which coordinate is its heading."""

from typing import Any

import numpy as np

from nonholo.base.checks import array, error, shown
from nonholo.base.types import Float

Parts = tuple[Float[np.ndarray, "P 2"], ...]
_REMEDY = "Pass the corners of each part in body axes: [[(-0.1, -0.1), (0.2, 0.0), (-0.1, 0.1)], ...]."


def check_heading(where: str, heading: Any, coordinates: tuple[str, ...]) -> None:
    """Refuse a heading that is no coordinate of a body with a place in the plane."""
    if heading is not None and not {"x", "y", heading} <= set(coordinates) - ({heading} & {"x", "y"}):
        remedy = 'Name the coordinates: coordinates=("x", "y", "theta"), heading="theta".'
        raise error(where, f"be a coordinate beside x and y of {', '.join(coordinates)}", shown(heading), remedy)


def checked_outline(where: str, given: Any) -> Any:
    """Return an outline: a function as it is, parts as arrays."""
    return given if callable(given) else as_parts(where, given)


def as_parts(where: str, given: Any) -> Parts:
    """Return the parts of an outline, at least two points each."""
    try:
        rows = tuple(given)
    except TypeError:
        raise error(where, "be a list of parts", shown(given), _REMEDY) from None
    parts = tuple(array(where, part, (None, 2), _REMEDY) for part in rows)
    if any(len(part) < 2 for part in parts):
        raise error(where, "have parts of at least two points", "one point", _REMEDY)
    return parts
