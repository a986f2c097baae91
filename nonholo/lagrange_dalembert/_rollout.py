"""Orbits as JAX functions of parameters, start and controls; derivatives of the implicit function."""

import functools
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.results import as_table
from nonholo.base.traced import NodeState, implicit, marked_rows, rows_of, run_nodes, with_policy
from nonholo.base.types import Array, Float
from nonholo.lagrange_dalembert import _equations as equations
from nonholo.lagrange_dalembert._newton import orientation, solve
from nonholo.lagrange_dalembert.functions import place


class CoordinateRollout(NamedTuple):
    """The states of a rollout; arrays as those of a `CoordinateOrbit` or `GroupOrbit`, K = 1 + steps // save_every.

    Attributes:
        time: Times of the states, shape (K,).
        configuration: q_k, shape (K, n), or g_k, (K, N, N).
        body_velocity: (q_{k+1} - q_k) / time_step, or log(W_k) / time_step, shape (K, n).
        momentum: P_k, shape (K, n).
        energy: Energies, shape (K,).
        controls: Forces u_k of the step from each state, of controls or a policy, shape (K, n); zero after the last.
        outcome: An `Outcome` as an integer array: the first one that is not successful. From that state on all other
            fields are NaN, and so are their derivatives.
    """

    time: Float[Array, "K"]
    configuration: Float[Array, "K ..."]
    body_velocity: Float[Array, "K n"]
    momentum: Float[Array, "K n"]
    energy: Float[Array, "K"]
    controls: Float[Array, "K n"]
    outcome: Array
    __repr__ = as_table


class _Node(NamedTuple):
    """A place, the velocity of its step with that of the step before, what follows, outcome, cause of a failure, u."""

    x: Array
    y: tuple[Array, Array]
    after: tuple[Array, Array]
    code: Array
    cause: Array
    control: Array | None


def roll(
    sizes: tuple[int, int], controls: Any, start: tuple[Any, ...], family: Any, numbers: Any, h: Any, work: Any = None
) -> CoordinateRollout:
    """Return the orbit from a start, which has a name, coordinates and a value, with the outcome up to each state.

    Controls are a row for each step, or a policy. `work` is the number by which many steps ask whether they are still
    wanted; None where they are differentiated.
    """
    system, (name, q, value), (steps, every) = family.bound(*numbers), start, sizes
    n = family.dimension
    x, value = place(family, jnp.asarray(q), 0.0), jnp.asarray(value)
    p = equations.momentum(system, x, value) if name == "body_velocity" else value
    still, x_still, value_still = jax.lax.stop_gradient((numbers, x, value))
    search_system = family.bound(*still)
    near = value_still if name == "body_velocity" else equations.inverse_legendre(search_system, x_still, value_still)
    sign, _ = orientation(search_system, x_still, near, h)

    def step(x: Array, p: Array, before: tuple[Array, Array], row: Array | None) -> _Node:
        control = None if row is None else control_of(row, lambda: _state_at(system, x, p))
        push = 0.0 if control is None else h / 2 * control
        near, last = before
        z, code = step_root(family, (numbers, h, x, p + push), (near, 2 * near - last, sign))
        v = z[:n]
        after, arriving = equations.arrival(system, x, v, h)
        return _Node(x, (v, near), (after, arriving + push), code, jnp.sum(z), control)

    rows, control_of = with_policy(controls, h, rows_of(controls, steps, n))
    nothing = None if rows is None else jnp.zeros(n)
    begin = _Node(x, (near, near), (x, p), jnp.zeros((), jnp.result_type(int)), jnp.sum(near), nothing)
    nodes = run_nodes(step, begin, rows, sizes, work)

    states = jax.vmap(functools.partial(_decoded, system, h))(nodes.x, nodes.y[0], nodes.control)
    acting = jnp.zeros_like(states[0]) if rows is None else nodes.control
    good = (marked_rows(each, nodes.cause, nodes.code == 0) for each in (*states, acting))
    return CoordinateRollout(h * every * jnp.arange(1 + steps // every), *good, outcome=nodes.code)


def _state_at(system: Any, x: Array, p: Array) -> NodeState:
    """Return what a policy sees of a place with a momentum."""
    return NodeState(x[:-1] if system.is_driven else x, equations.inverse_legendre(system, x, p))


def _decoded(system: Any, h: Array, x: Array, v: Array, row: Array | None) -> tuple[Array, Array, Array, Array]:
    """Return configuration, velocity, momentum and energy of a node."""
    p = equations.momenta(system, x, v, h)[0] - (0.0 if row is None else h / 2 * row)
    if not system.is_driven and row is None:
        return x, v, p, equations.discrete_energy(system, x, v, h)
    state = _state_at(system, x, p)
    return state.configuration, v, p, equations.energy(system, x, state.body_velocity)


@functools.partial(jax.custom_jvp, nondiff_argnums=(0,))
def step_root(family: Any, arguments: tuple[Any, ...], search: tuple[Array, ...]) -> tuple[Array, Array]:
    """Return velocity with multipliers of the step from a place with a momentum, and the outcome.

    The search begins near a velocity, with a guess, and keeps an orientation; derivatives do not see it.
    """
    numbers, h, x, p = arguments
    v, multipliers, code = solve(family.bound(*numbers), h, x, p, *search)
    return jnp.concatenate([v, multipliers]), code


@step_root.defjvp
def _implicit(family: Any, primals: Any, tangents: Any) -> tuple[Any, Any]:
    def residual(z: Array, numbers: tuple[Array, ...], h: Array, x: Array, p: Array) -> Array:
        return equations.step_balance(family.bound(*numbers), (x, p), z, h)

    z, code = step_root(family, *primals)
    z, change = implicit(residual, z, primals[0], tangents[0])
    return (z, code), (change, np.zeros(code.shape, jax.dtypes.float0))
