"""Tools of scalar kernels: decorators for numba and JAX, a square root for both, and what every structured step offers.

These functions are those of the file that defines a body: plain Python (and so JAX) picks them at call time, numba when
it compiles.
"""

import ctypes
import math
import sys
from collections.abc import Callable
from types import ModuleType
from typing import Any, TypeAlias

import numpy as np

from nonholo.base.compiled import compiled_in, jitable, overload

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

inlining = jitable(**INLINED)
"""Mark a function that writes to arrays of its callers likewise, with the options INLINED."""


def sqrt(x: Any) -> Any:
    """Return the square root of a float or of a traced array."""
    return x.__array_namespace__().sqrt(x) if hasattr(x, "__array_namespace__") else math.sqrt(x)


@overload(sqrt, jit_options=COMPILED, strict=False)
def _compiled_sqrt(x: Any) -> Any:
    return lambda x: math.sqrt(x)


_EXPANSION = ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * 5, ctypes.c_int64)


def function_at(address: Callable[..., None], time: float, g: np.ndarray, w: np.ndarray, out: np.ndarray) -> None:
    """Call a function of a user, which compiled code has the address of."""
    address(time, g, w, out)


def expand_at(address: int, arrays: tuple[np.ndarray, ...], order: int) -> None:
    """Write coefficients up to an order after those of order 0, by the code at an address.

    Args:
        address: Of the code.
        arrays: V or the inverse of B_0; the factors of terms; the coefficients of z; those of B, if there is one, and
            room for its columns.
        order: The last one.
    """
    _EXPANSION(address)(*(each.ctypes.data for each in arrays), order)


compiled_in("nonholo.kernels.by_numba")

Rows: TypeAlias = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Momenta, charts and poses, into which a run takes its steps."""

Body: TypeAlias = tuple[Any, ...]
"""A named tuple of scalars, with two momenta, two Cayley coordinates and up to four numbers of a pose."""


def _file_of(body: type) -> ModuleType:
    return sys.modules[body.__module__]


def residual(p: Body, m1: Any, m2: Any, y1: Any, y2: Any) -> tuple[Any, Any]:
    """Return the equations for the Cayley coordinates y of the displacement with scaled momenta m."""
    return _file_of(type(p)).residual(p, m1, m2, y1, y2)


def correction(p: Body, m1: Any, m2: Any, y1: Any, y2: Any) -> tuple[Any, Any]:
    """Return the Newton correction of y."""
    return _file_of(type(p)).correction(p, m1, m2, y1, y2)


def corrections(p: Body, m1: Any, m2: Any, y1: Any, y2: Any) -> tuple[Any, Any, Any, Any]:
    """Return the Newton correction of y, and the one that follows it with the same slopes."""
    return _file_of(type(p)).corrections(p, m1, m2, y1, y2)


def is_certain(p: Body, m1: Any, m2: Any, y1: Any, y2: Any) -> Any:
    """Return whether a root y is certainly the principal one."""
    return _file_of(type(p)).is_certain(p, m1, m2, y1, y2)


def inertia(p: Body) -> tuple[Any, Any, Any]:
    """Return the inertia along the constraint, B11, B12 and B22: velocities are those of B^-1 times the momenta."""
    return _file_of(type(p)).inertia(p)


def quadratic(p: Body) -> tuple[Any, Any, Any, Any, Any, Any]:
    """Return B11, B12, B22, c and e: roots y obey w m = B y + (c . y') y', y' = (-y2, y1), w = 1 + y1^2 + e y2^2."""
    return _file_of(type(p)).quadratic(p)


def increment(p: Body, m1: Any, m2: Any, y1: Any, y2: Any) -> tuple[Any, Any]:
    """Return the change of the scaled momenta in one step."""
    return _file_of(type(p)).increment(p, m1, m2, y1, y2)


def move(p: Body, y1: Any, y2: Any, q0: Any, q1: Any, q2: Any, q3: Any) -> tuple[Any, Any, Any, Any]:
    """Return the compact pose after one displacement."""
    return _file_of(type(p)).move(p, y1, y2, q0, q1, q2, q3)


def tangent(p: Body, m1: Any, m2: Any, y1: Any, y2: Any) -> tuple[Any, Any, Any, Any]:
    """Return the derivative of the momenta after a step by those before it: those after it are minus those at -y."""
    d1, d2 = increment(p, m1, m2, y1, y2)
    a11, a12, a21, a22 = _file_of(type(p)).slopes(p, -m1 - d1, -m2 - d2, -y1, -y2)
    b11, b12, b21, b22 = _file_of(type(p)).slopes(p, m1, m2, y1, y2)
    det = b11 * b22 - b12 * b21
    first, second = (a11 * b22 - a12 * b21) / det, (a12 * b11 - a11 * b12) / det
    return first, second, (a21 * b22 - a22 * b21) / det, (a22 * b11 - a21 * b12) / det


def principal(p: Body, m1: float, m2: float) -> tuple[int, float, float]:
    """Return the outcome and the root reached from momentum zero along s m."""
    return _file_of(type(p)).principal(p, m1, m2)


def _compile(function: Callable[..., Any]) -> None:
    def choose(p: Any, *_: Any) -> Any:
        return getattr(_file_of(p.instance_class), function.__name__)

    overload(function, jit_options=COMPILED, strict=False)(choose)


for _function in (inertia, quadratic, residual, correction, corrections, is_certain, increment, move):
    _compile(_function)


def _choose_principal(p: Any, *_: Any) -> Any:
    solver = _file_of(p.instance_class).principal
    return lambda p, m1, m2: solver(p, m1, m2)


overload(principal, jit_options=COMPILED, strict=False)(_choose_principal)
