"""Motions under controls, in JAX: what they miss of goals, with exact derivatives, and steps near a reference orbit."""

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


def goal_gaps(
    discrete: Discretization, forces: Float[np.ndarray, "m steps k"], ends: Ends, block: int
) -> tuple[Float[np.ndarray, "m c"], Float[np.ndarray, "m c n"]]:
    """Return what goals are missed by, and its derivatives by the forces along the constraint, n = steps k.

    Members go in blocks of one size, for which alone the derivatives are compiled.
    """
    blocks = np.arange(-(-len(forces) // block) * block).reshape(-1, block) % len(forces)
    parts = [in_double(_gaps, discrete, *jax.tree.map(lambda x, at=at: x[at], (forces, ends))) for at in blocks]
    values, slopes = (np.concatenate(part)[: len(forces)] for part in zip(*parts, strict=True))
    return values, slopes.reshape(*values.shape, -1)


@equinox.filter_jit
def _gaps(discrete: Discretization, forces: Array, ends: Ends) -> tuple[Array, Array]:
    system = discrete.system
    covectors = np.linalg.pinv(system.constraint_subspace).T

    def gap_of(forces: Array, ends: Ends) -> tuple[Array, Array]:
        (w, g, to_pose, to_velocity), parts = ends, []
        orbit = _orbit(discrete, forces @ covectors, (w, g), len(forces))
        if to_pose is not None:
            parts.append(system.group.log(system.group.inverse(to_pose) @ orbit.configuration[-1]))
        if to_velocity is not None:
            parts.append(system.restricted_velocity(orbit.restricted_momentum[-1]) - to_velocity)
        gap = jnp.concatenate(parts)
        return gap, gap

    slopes, values = jax.vmap(jax.jacrev(gap_of, has_aux=True))(forces, ends)
    return values, slopes


@compile_double
def driven(discrete: Discretization, controls: Array, start: tuple[Array, Array]) -> Rollout:
    """Return the orbits under body covectors from velocities and poses of members."""
    return jax.vmap(lambda controls, start: _orbit(discrete, controls, start, 1))(controls, start)


def _orbit(discrete: Discretization, controls: Array, start: tuple[Array, Array], every: int) -> Rollout:
    at = dict(zip(("restricted_velocity", "configuration"), start, strict=True))
    return rollout(discrete, **at, controls=controls, steps=len(controls), save_every=every)


State = tuple[Array, Array]
"""A velocity along the constraint and a pose, or those of many nodes."""


def _error(discrete: Discretization, reference: State, state: State) -> Array:
    """Return log(g*^-1 g) and w - w*."""
    group = discrete.system.group
    return jnp.concatenate([group.log(group.inverse(reference[1]) @ state[1]), state[0] - reference[0]])


def _step(discrete: Discretization, state: State, covector: Array) -> tuple[Rollout, State]:
    """Return both nodes of a step, and the state after it."""
    pair = rollout(discrete, restricted_velocity=state[0], configuration=state[1], controls=covector[None], steps=1)
    return pair, (discrete.system.restricted_velocity(pair.restricted_momentum[1]), pair.configuration[1])


@compile_double
def linearize_steps(
    discrete: Discretization, nodes: State, controls: Float[Array, "steps dim"]
) -> tuple[Float[Array, "steps n n"], Float[Array, "steps n k"]]:
    """Return the derivatives of the error after each step by the error before it and by the forces of the step."""
    system = discrete.system
    dim, covectors = system.group.dim, jnp.asarray(np.linalg.pinv(system.constraint_subspace).T)

    def after(error: Array, force: Array, before: State, reference: State, covector: Array) -> Array:
        state = before[0] + error[dim:], before[1] @ system.group.exp(error[:dim])
        return _error(discrete, reference, _step(discrete, state, covector + force @ covectors)[1])

    def at(before: State, reference: State, covector: Array) -> tuple[Array, Array]:
        nothing = jnp.zeros(dim + system.rank, covector.dtype), jnp.zeros(system.rank, covector.dtype)
        return jax.jacfwd(after, (0, 1))(*nothing, before, reference, covector)

    before, following = (jax.tree.map(lambda x, part=part: x[part], nodes) for part in (slice(-1), slice(1, None)))
    return jax.vmap(at)(before, following, controls)


@compile_double
def closed_loop(
    discrete: Discretization, nodes: State, start: State, tables: tuple[Array, ...], limits: tuple[Array, Array]
) -> tuple[Rollout, Float[Array, "steps k"], Float[Array, "K n"]]:
    """Return the motion from a start, the forces, and the errors; tables are forces, gains, pushes, misreadings."""
    covectors = jnp.asarray(np.linalg.pinv(discrete.system.constraint_subspace).T)

    def step(state: State, row: tuple[State, tuple[Array, ...]]) -> tuple[State, tuple[Rollout, Array, Array]]:
        reference, (force, gain, push, misread) = row
        error = _error(discrete, reference, state)
        force = jnp.clip(force - gain @ (error + misread), *limits)
        pair, state = _step(discrete, state, force @ covectors + push)
        return state, (pair, force, error)

    rows = jax.tree.map(lambda x: x[:-1], nodes), tables
    end, (pairs, forces, errors) = jax.lax.scan(step, tuple(map(jnp.asarray, start)), rows)
    codes, time = pairs.outcome, discrete.time_step * jnp.arange(1 + len(forces))
    pairs = pairs._replace(outcome=pairs.time)  # of the same shape as all else, for a moment
    orbit = jax.tree.map(lambda x: jnp.concatenate([x[:, 0], x[-1:, 1]]), pairs)
    orbit = orbit._replace(time=time, outcome=codes[jnp.argmax(codes != 0)])
    last = _error(discrete, jax.tree.map(lambda x: x[-1], nodes), end)
    return orbit, forces, jnp.concatenate([errors, last[None]])
