"""Tools of scalar kernels: a decorator for numba and JAX, and a square root for both."""

import math
from typing import Any

from nonholo.base.compiled import jitable, overload

COMPILED: Any = {"error_model": "numpy"}
"""Options of the scalar kernels: no exceptions on division; arithmetic is strict (docs/conventions.md, "Bits")."""

BORROWING: Any = {**COMPILED, "_nrt": False, "forceinline": False}
"""Options of kernels that only write to arrays of their callers, and return numbers: what makes an array is refused.

numba counts the references to each array at each call, which takes longer than the arithmetic of a small matrix.
Without `forceinline` they would take it from their callers.
"""

INLINED: Any = {**BORROWING, "forceinline": True}
"""The same for functions with many arrays that are called in few places: passing them along takes time, too."""

PIECES = 100_000
"""Most pieces of a path that is followed: some tens are usual, and no loop of a kernel is without end."""

scalar = jitable(**COMPILED)
"""Mark a scalar function: numba inlines it, plain Python and JAX call it as it is."""


borrowing = jitable(**BORROWING)
"""Mark a function that writes to arrays of its callers, with the options BORROWING."""

inlined = jitable(**INLINED)
"""Mark a function that writes to arrays of its callers likewise, with the options INLINED."""


def sqrt(x: Any) -> Any:
    """Return the square root of a float or of a traced array."""
    return x.__array_namespace__().sqrt(x) if hasattr(x, "__array_namespace__") else math.sqrt(x)


@overload(sqrt, jit_options=COMPILED, strict=False)
def _compiled_sqrt(x: Any) -> Any:
    return lambda x: math.sqrt(x)
