"""A fraction of a step by the definition of the discrete map. Imported on first use, since JAX loads slowly."""

import dataclasses

import equinox
import numpy as np

from nonholo.base.types import Array
from nonholo.discrete import Discretization, weights
from nonholo.discrete.definition import displaced, in_double, momentum_of, principal_displacement, restricted

_root = equinox.filter_jit(principal_displacement)


def partial_step(
    discrete: Discretization, fraction: float, r: np.ndarray, g: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return momentum, chart and pose after a fraction of a step from a momentum and a pose, in the user's frame."""
    one, parts = dataclasses.replace(discrete, order=2), weights(discrete.order)
    for part in fraction * parts:
        y, code = in_double(_root, one, part * r, g)
        r, g = in_double(_moved, one, y, g)
        r, g = (np.where(code == 0, x, np.nan) for x in (r / part, g))
    y, code = in_double(_root, one, parts[0] * r, g)
    return r, np.where(code == 0, y, np.nan), g


@equinox.filter_jit
def _moved(discrete: Discretization, y: Array, g: Array) -> tuple[Array, Array]:
    """Return the momentum along the constraint and the pose after a displacement."""
    W = displaced(discrete, y)
    after = discrete.system.moved(g, W)
    return restricted(discrete, momentum_of(discrete, y, g, "right"), after), after
