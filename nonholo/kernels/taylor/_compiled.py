"""Expansions that are compiled for the structure of their equations: all tops on one group share one."""

import ctypes
import functools
from collections.abc import Iterable

import numpy as np

from nonholo.base.compiled import compiled_in, library_of_kernels, way_of_kernels

EMITTER = "nonholo.kernels.taylor.emission.code_of"
_EXPANSION = ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * 5, ctypes.c_int64)
_MOST = 8  # velocities, if they take a division


def call(address: int, arrays: tuple[np.ndarray, ...], order: int) -> None:
    """Write coefficients up to an order after those of order 0, by the code at an address.

    Args:
        address: Of the code.
        arrays: V or the inverse of B_0; the factors of terms; the coefficients of z; those of B, if there is one, and
            room for its columns.
        order: The last one.
    """
    _EXPANSION(address)(*(each.ctypes.data for each in arrays), order)


compiled_in("nonholo.kernels.taylor.addresses")


def structure_of(counts: tuple[int, int, int], *arrays: Iterable[int]) -> str:
    """Return what code depends on: counts of motions, velocities and numbers of J; `rows`, `first` and `found`."""
    return ";".join(",".join(map(str, part)) for part in (counts, *arrays))


@functools.cache
def address_of(counts: tuple[int, int, int], *arrays: bytes) -> int:
    """Return the address of the expansion of a structure, from the library or compiled now; 0 if there is none."""
    if counts[2] and counts[1] > _MOST:
        return 0
    structure = structure_of(counts, *(np.frombuffer(each, dtype=np.int64) for each in arrays))
    library, way = library_of_kernels(), way_of_kernels()
    address = library.address(EMITTER, structure) if library else 0
    if address or way == "python":
        return address
    try:
        from nonholo.base.compiled.emission import compiled
        from nonholo.kernels.taylor.emission import code_of
    except ModuleNotFoundError:  # without the extra `compile` the general kernel does it
        return 0
    return compiled(code_of(structure, "expansion"), "expansion")
