"""Arrays in all rooms: their type in annotations, and those that nobody writes to.

`Array` is a NumPy array or, inside the JAX route, a JAX array or tracer; shapes are written with jaxtyping.
"""

from typing import Any, TypeAlias

import numpy as np
from jaxtyping import Bool, Float, Inexact, Int

Array: TypeAlias = Any

__all__ = ["Array", "Bool", "Float", "Inexact", "Int", "read_only"]


def read_only(value: Any) -> Any:
    """Return views of arrays, in a dictionary too, to which nobody writes; anything else as it is."""
    if isinstance(value, dict):
        return {name: read_only(entry) for name, entry in value.items()}
    if isinstance(value, np.ndarray):
        value = value.view()
        value.flags.writeable = False
    return value
