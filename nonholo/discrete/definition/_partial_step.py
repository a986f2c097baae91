"""A fraction of a step by the definition of the discrete map, in JAX."""

import dataclasses
from typing import Any, cast

import equinox
import numpy as np

from nonholo.base.numerics import applied
from nonholo.base.types import Float
from nonholo.discrete._composition import weights
from nonholo.discrete._scheme import Scheme
from nonholo.discrete.definition._precision import in_double
from nonholo.discrete.definition._step import principal_displacement, pushed
from nonholo.orbit import Orbit

_root = equinox.filter_jit(principal_displacement)
_moved = equinox.filter_jit(pushed)


def parts_by_definition(
    discrete: Scheme, states: Orbit, poses: np.ndarray, fractions: Float[np.ndarray, "K"]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return canonical momenta, charts and poses after fractions of the steps from states; NaN where none starts."""
    group, frame, C = discrete.system.group, discrete.system.frame, discrete.system.frame_map
    g = group.matrix_from_pose(poses) @ group.inverse(frame)
    r = applied(discrete.system.inverse_frame_map, states.reduced_momentum)
    found = [_partial_step(discrete, *row) for row in zip(fractions, r, g, strict=True)]
    momenta, charts, moved = (np.array(column) for column in zip(*found, strict=True))
    return applied(C, momenta), charts, group.pose_from_matrix(moved @ frame)


def _partial_step(
    discrete: Scheme, fraction: float, r: np.ndarray, g: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return momentum, chart and pose after a fraction of a step from a momentum and a pose, in the user's frame."""
    order = cast(Any, discrete).order
    one, parts = dataclasses.replace(cast(Any, discrete), order=2), weights(order)
    for part in fraction * parts:
        y, code = in_double(_root, one, part * r, g)
        r, g = in_double(_moved, one, y, g)
        r, g = (np.where(code == 0, x, np.nan) for x in (r / part, g))
    y, code = in_double(_root, one, parts[0] * r, g)
    return r, np.where(code == 0, y, np.nan), g
