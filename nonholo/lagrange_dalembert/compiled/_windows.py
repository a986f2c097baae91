"""Gather and scatter with indices that are constants: which numbers of an array the windows hold.

The meaning of dimension numbers: https://openxla.org/xla/operation_semantics, "Gather" and "Scatter".
"""

from typing import Any

import numpy as np
from jax.lax import GatherScatterMode

from nonholo.lagrange_dalembert.compiled._scalars import Formulas, UntranslatableError


def array_of(numbers: list[Any], shape: tuple[int, ...]) -> np.ndarray:
    """Return numbers in an array with a shape."""
    result = np.empty(len(numbers), dtype=object)
    result[:] = numbers
    return result.reshape(shape)


def constants_of(array: np.ndarray) -> Any:
    """Return the values of an array of constants."""
    values = [each.value for each in array.ravel()]
    if None in values:
        raise UntranslatableError("an index that is computed")
    return np.array(values).reshape(array.shape)


def gather(
    _f: Formulas, x: np.ndarray, indices: np.ndarray, *, dimension_numbers: Any, slice_sizes: Any, mode: Any, **_: Any
) -> np.ndarray:
    """Return the numbers of windows of an array."""
    d, batch = dimension_numbers, indices.ndim - 1
    batching = d.operand_batching_dims, d.start_indices_batching_dims
    places = _places(x.shape, constants_of(indices), d.start_index_map, batching, slice_sizes, mode)
    unit_axes = (*d.collapsed_slice_dims, *d.operand_batching_dims)
    result = np.squeeze(x.ravel()[places], tuple(batch + axis for axis in unit_axes))
    return np.moveaxis(result, range(batch, result.ndim), d.offset_dims)


def scatter(
    f: Formulas,
    x: np.ndarray,
    indices: np.ndarray,
    updates: np.ndarray,
    *,
    dimension_numbers: Any,
    mode: Any,
    adds: bool = False,
    **_: Any,
) -> np.ndarray:
    """Return an array with windows replaced, or with numbers added to them."""
    d, batch, numbers = dimension_numbers, indices.ndim - 1, x.ravel().tolist()
    unit_axes, windows = (*d.inserted_window_dims, *d.operand_batching_dims), iter(d.update_window_dims)
    sizes = [1 if axis in unit_axes else updates.shape[next(windows)] for axis in range(x.ndim)]
    batching = d.operand_batching_dims, d.scatter_indices_batching_dims
    places = _places(x.shape, constants_of(indices), d.scatter_dims_to_operand_dims, batching, sizes, mode)
    rows = np.moveaxis(updates, d.update_window_dims, range(batch, updates.ndim))
    for place, number in zip(places.ravel().tolist(), rows.ravel().tolist(), strict=True):
        numbers[place] = f("add", numbers[place], number) if adds else number
    return array_of(numbers, x.shape)


def _places(
    shape: tuple[int, ...], indices: np.ndarray, axes: Any, batching: tuple[Any, Any], sizes: Any, mode: Any
) -> np.ndarray:
    """Return the flat places of windows of these sizes, whose corners have the indices along axes."""
    batch = indices.shape[:-1]
    corners = np.zeros((*batch, len(shape)), dtype=int)
    corners[..., list(axes)] = indices
    for axis, along in zip(*batching, strict=True):
        corners[..., axis] = np.indices(batch)[along]
    most = np.array(shape) - sizes
    inside = np.clip(corners, 0, most)
    if mode != GatherScatterMode.CLIP and not np.array_equal(inside, corners):
        raise UntranslatableError("an index out of bounds")
    offsets = np.moveaxis(np.indices(tuple(sizes)), 0, -1)
    windows = inside.reshape(*batch, *(1 for _ in shape), len(shape)) + offsets
    return np.asarray(np.ravel_multi_index(tuple(np.moveaxis(windows, -1, 0)), shape))
