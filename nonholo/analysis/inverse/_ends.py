"""How far controls end from a goal, with exact derivatives: in JAX."""

from typing import Any

import equinox
import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.types import Array
from nonholo.discrete import Discretization
from nonholo.discrete.definition import in_double
from nonholo.simulation.traced import rollout


def missed_goal(discrete: Discretization, forces: np.ndarray, *ends: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return what the goal is missed by, and its derivatives by the forces along the constraint, row by row."""
    return in_double(_missed, discrete, forces, *ends)


@equinox.filter_jit
def _missed(
    discrete: Discretization, forces: Array, w: Array, g: Array, to_pose: Array | None, to_velocity: Array | None
) -> tuple[Array, Array]:
    system, steps = discrete.system, len(forces)
    covectors = np.linalg.pinv(system.constraint_subspace).T

    def missed(forces: Array) -> tuple[Array, Array]:
        start = {"restricted_velocity": w, "configuration": g}
        orbit = rollout(discrete, **start, controls=forces @ covectors, steps=steps, save_every=steps)
        parts = []
        if to_pose is not None:
            parts.append(system.group.log(system.group.inverse(to_pose) @ orbit.configuration[-1]))
        if to_velocity is not None:
            inertia = jnp.asarray(system.constrained_inertia)
            parts.append(jnp.linalg.solve(inertia, orbit.restricted_momentum[-1]) - to_velocity)
        found = jnp.concatenate(parts)
        return found, found

    slope, value = jax.jacrev(missed, has_aux=True)(forces)
    return value, slope.reshape(len(value), -1)
