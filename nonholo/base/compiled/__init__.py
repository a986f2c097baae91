"""Kernels: by the library that is compiled ahead, by numba, or as they are."""

from nonholo.base.compiled._kernel import (
    FUNCTION,
    Kernel,
    Library,
    compiled_in,
    first_way,
    jitable,
    key_of,
    library_of_kernels,
    njit,
    overload,
    say_once,
    symbol_of,
    tell_numba,
    tokens,
    way_of_kernels,
)
