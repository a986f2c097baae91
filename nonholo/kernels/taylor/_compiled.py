"""Expansions that are compiled for the structure of their equations: all tops on one group share one."""

import ctypes
import functools
from collections.abc import Iterable

import numpy as np

from nonholo.base.compiled import compiled_in, library_of_kernels, way_of_kernels

EMITTER = "nonholo.kernels.taylor.emission.code_of"
_EXPANSION = ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * 3, ctypes.c_int64)


def call(address: int, velocities: np.ndarray, factors: np.ndarray, series: np.ndarray) -> None:
    """Write the coefficients after those of the state at the beginning, by the code at an address."""
    _EXPANSION(address)(velocities.ctypes.data, factors.ctypes.data, series.ctypes.data, len(series) - 1)


compiled_in("nonholo.kernels.taylor.addresses")


def structure_of(lanes: int, velocities: int, *arrays: Iterable[int]) -> str:
    """Return what code depends on: how many motions and velocities there are, and `rows`, `first` and `found`."""
    return ";".join(",".join(map(str, part)) for part in ((lanes, velocities), *arrays))


@functools.cache
def address_of(lanes: int, velocities: int, *arrays: bytes) -> int:
    """Return the address of the expansion of a structure, from the library or compiled now; 0 if there is none."""
    structure = structure_of(lanes, velocities, *(np.frombuffer(each, dtype=np.int64) for each in arrays))
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
