"""How far controls end from goals, with exact derivatives: in JAX, many members at once."""

import equinox
import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.types import Array, Float
from nonholo.discrete import Discretization
from nonholo.discrete.definition import Rollout, compile_double, in_double
from nonholo.simulation.traced import rollout

Ends = tuple[Array, Array, Array | None, Array | None]
"""First velocities and poses of members, and the poses and velocities that they are to have, None where free."""


def missed_goals(
    discrete: Discretization, forces: Float[np.ndarray, "m steps k"], ends: Ends, block: int
) -> tuple[Float[np.ndarray, "m c"], Float[np.ndarray, "m c n"]]:
    """Return what goals are missed by, and its derivatives by the forces along the constraint, n = steps k.

    Members go in blocks of one size, for which alone the derivatives are compiled.
    """
    blocks = np.arange(-(-len(forces) // block) * block).reshape(-1, block) % len(forces)
    parts = [in_double(_missed, discrete, *jax.tree.map(lambda x, at=at: x[at], (forces, ends))) for at in blocks]
    values, slopes = (np.concatenate(part)[: len(forces)] for part in zip(*parts, strict=True))
    return values, slopes.reshape(*values.shape, -1)


@equinox.filter_jit
def _missed(discrete: Discretization, forces: Array, ends: Ends) -> tuple[Array, Array]:
    system = discrete.system
    covectors = np.linalg.pinv(system.constraint_subspace).T

    def missed(forces: Array, ends: Ends) -> tuple[Array, Array]:
        (w, g, to_pose, to_velocity), parts = ends, []
        orbit = _orbit(discrete, forces @ covectors, (w, g), len(forces))
        if to_pose is not None:
            parts.append(system.group.log(system.group.inverse(to_pose) @ orbit.configuration[-1]))
        if to_velocity is not None:
            parts.append(system.restricted_velocity(orbit.restricted_momentum[-1]) - to_velocity)
        gap = jnp.concatenate(parts)
        return gap, gap

    slopes, values = jax.vmap(jax.jacrev(missed, has_aux=True))(forces, ends)
    return values, slopes


@compile_double
def driven(discrete: Discretization, controls: Array, start: tuple[Array, Array]) -> Rollout:
    """Return the orbits under body covectors from velocities and poses of members."""
    return jax.vmap(lambda controls, start: _orbit(discrete, controls, start, 1))(controls, start)


def _orbit(discrete: Discretization, controls: Array, start: tuple[Array, Array], every: int) -> Rollout:
    at = dict(zip(("restricted_velocity", "configuration"), start, strict=True))
    return rollout(discrete, **at, controls=controls, steps=len(controls), save_every=every)
