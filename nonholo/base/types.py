"""Words shared by every room: the array type of annotations.

`Array` is a NumPy array or, inside the JAX route, a JAX array or tracer; shapes are written with jaxtyping.
"""

from typing import Any, TypeAlias

from jaxtyping import Bool, Float, Inexact, Int

Array: TypeAlias = Any

__all__ = ["Array", "Bool", "Float", "Inexact", "Int"]
