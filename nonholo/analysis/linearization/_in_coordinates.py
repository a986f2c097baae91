"""Motions in coordinates, and on groups by functions of the pose, beside a state. Needs JAX."""

import functools
from typing import Any

import numpy as np

from nonholo.analysis.linearization._reduction import Local
from nonholo.lagrange_dalembert import CoordinateFlow, tangents
from nonholo.systems import in_coordinates

_OTHERS, _SPREAD = 3, 0.3


def beside_state(owner: str, subject: Any, configuration: Any, velocity: Any) -> tuple[Local, Any]:
    """Return the changes beside a state of a system or of its map, and the function that gives states beside it."""
    motion = subject if in_coordinates(subject) else CoordinateFlow(subject)
    x, v = tangents.begin(motion, owner, configuration, velocity)
    later = tangents.following(motion, x, v)
    rng, size = np.random.default_rng(0), len(v) + motion.system.is_driven
    xi, w = _SPREAD * rng.uniform(-1, 1, (_OTHERS, size)), _SPREAD * rng.uniform(-1, 1, (_OTHERS, len(v)))
    places, velocities = tangents.beside(motion, x, v, xi, (np.abs(v).max() or 1.0) * w)
    velocities = np.concatenate([np.tile(v, (1 + len(later), 1)), velocities])
    found = tangents.slopes(motion, np.concatenate([x[None], later, places]), velocities)
    local = Local(_names(motion.system, size), size, np.append(np.zeros(size), v), *found, len(later))
    return local, functools.partial(_shifted, motion, x, v)


def _shifted(motion: Any, x: np.ndarray, v: np.ndarray, xi: np.ndarray, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    places, velocities = tangents.beside(motion, x, v, xi[None], w[None])
    return places[0][: len(v)] if motion.system.is_driven else places[0], velocities[0]


def _names(system: Any, size: int) -> tuple[str, ...]:
    if not system.coordinates:
        return *(f"xi{i}" for i in range(1, 1 + size)), *(f"v{i}" for i in range(1, 1 + size))
    return *system.coordinates, *("time",) * system.is_driven, *(f"{name}'" for name in system.coordinates)
