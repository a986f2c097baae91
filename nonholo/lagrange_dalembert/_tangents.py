r"""How states near a state move: derivatives of the rates of the flow and of the changes in a step.

A state is a place with a velocity. Coordinates are seen from where the state is; a pose from a frame that moves along,
as $g\,e^\xi$.
"""

import functools
from collections.abc import Callable
from typing import Any, cast

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import error
from nonholo.base.traced import FEW, call_in_blocks
from nonholo.base.types import Array, Float
from nonholo.lagrange_dalembert import _equations as equations
from nonholo.lagrange_dalembert._discretization import checked_state, set_out
from nonholo.lagrange_dalembert._flow import acceleration, nearest_place
from nonholo.lagrange_dalembert._newton import orientation
from nonholo.lagrange_dalembert._rollout import step_root
from nonholo.lagrange_dalembert.functions import in_double, in_rows, places, room
from nonholo.systems.forces import refuse_table

LATER = np.array([0.3719, 0.9173])  # times, not in a ratio that a rotation may have

Slopes = tuple[Array, Array, Array]
"""Changes of a state, their derivatives by place and velocity, and those of the constraints, holonomic ones last."""


def begin(motion: Any, owner: str, configuration: Any, velocity: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return the checked place and velocity of a flow, or of the step that a map begins with."""
    system = motion.system
    refuse_table(f"{owner}(system=...)", system.table)
    still = np.zeros(system.shapes[1])
    x, v = checked_state(system, configuration, {"body_velocity": still if velocity is None else velocity}, 0.0, owner)
    if motion.time_step is None:
        return x, v
    h = np.float64(motion.time_step)
    (_, v, _), _, code = in_double(set_out, system, h, x, v, room("_start").momentum(system, x, v))
    return x, np.where(code == 0, v, np.nan)


def beside(motion: Any, x: np.ndarray, v: np.ndarray, xi: np.ndarray, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the states at places beside x, with the admissible velocities next to v + w."""
    return in_double(_beside, motion.system, motion.time_step, x, v, xi, w)


def following(motion: Any, x: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Return where the frame of a steady motion is at later times, of a map after steps."""
    h = motion.time_step
    times = LATER if h is None else h * np.arange(1.0, 1 + len(LATER))
    return np.stack([motion.system.places.frame(x, v, t) for t in times])


def departing(motion: Any, x: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Return the velocities of the nodes at which steps begin."""
    momenta, _ = in_rows(equations.momenta, motion.system, x, v, motion.time_step)
    return in_rows(equations.inverse_legendre, motion.system, x, momenta)


def units(system: Any, x: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Return units of the velocities in which each has the same kinetic energy."""
    return in_double(equations.acceleration_matrix, system, x, v)[1].velocity


def slopes(
    motion: Any, x: Float[np.ndarray, "K ..."], v: Float[np.ndarray, "K n"]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return how states change beside given ones; NaN where there is no next step."""
    each = functools.partial(in_double, _each, motion.system, motion.time_step)
    return cast(Any, tuple(call_in_blocks(each, FEW, x, v)))


def among_admissible(
    maps: Float[np.ndarray, "L d d"], rows: Float[np.ndarray, "K c d"], units: Float[np.ndarray, "d"]
) -> Float[np.ndarray, "L f f"]:
    """Return derivatives in bases, orthonormal in units, of the changes on which the rows vanish."""
    bases = np.linalg.svd(rows * units)[2][:, rows.shape[1] :].swapaxes(1, 2)
    return bases[1:].swapaxes(1, 2) @ (maps * (units / units[:, None])) @ bases[:-1]


def changes(orbit: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray, int]:
    """Return the derivative of each state by the one before, constraints of changes, units and how many are of places.

    In the units all velocities have the same kinetic energy at the first state.
    """
    motion, system, time = orbit.motion, orbit.system, orbit.time
    where, n = "Orbit.tangent", orbit.body_velocity.shape[1]
    if orbit.has_impacts.any():
        raise error(where, "have no impacts", "some", "Pass the part of the orbit before the first one.")
    if orbit.is_discrete and not orbit.has_every_step:
        raise error(where, "have all states of the run", f"{len(orbit)} of them", "Run with save_every=1.")
    if not len(orbit):
        raise error(where, "have a state", "none", "Run longer.")
    x, v = places(system, orbit.configuration, time), orbit.body_velocity
    _, slope, rows = slopes(motion, x, v)
    if orbit.is_discrete:
        maps = slope[:-1] + np.eye(slope.shape[-1])
    else:
        maps = room("_integration").transitions(system, x, v, time)
    matters = np.r_[:n, n + system.is_driven : slope.shape[-1]]  # all but the time, and places that it prescribes
    matters = np.setdiff1d(matters, [index for index, _ in system.plain.prescribed])
    maps, rows = maps[:, matters][:, :, matters], rows[..., matters]
    unit = units(system, x[0], v[0])
    sizes = np.concatenate([unit, np.ones(int(system.is_driven)), unit])[matters]
    return maps, rows, sizes, int(np.searchsorted(matters, n + system.is_driven))


def _beside(system: Any, h: Array | None, x: Array, v: Array, xis: Array, ws: Array) -> tuple[Array, Array]:
    def one(offset: tuple[Array, Array]) -> tuple[Array, Array]:
        xi, w = offset
        place = system.places.beside(x, xi)
        if system.holonomic is not None:
            place = nearest_place(system, place)
        return place, equations.corrected_velocity(system, h, place, v + w)

    return jax.lax.map(one, (xis, ws))


def flow_slopes(system: Any, x: Array, v: Array) -> Slopes:
    """Return the rates beside a state of the flow, their derivatives, and those of the constraint."""

    def change(xi: Array, w: Array) -> Array:
        beside = system.places.beside(x, xi)
        return jnp.concatenate([system.places.departure_rate(v, xi, w), acceleration(system, beside, w)[0]])

    return _slopes_of(system, None, change, x, v)


def _step_slopes(system: Any, h: Array, x: Array, v: Array) -> Slopes:
    def change(xi: Array, w: Array) -> Array:
        beside = system.places.beside(x, xi)
        after, p = equations.arrival(system, beside, w, h)
        w_after = _step_velocity(system, h, after, p, (beside, w))
        xi_after = system.places.departure(system.places.frame(x, v, h), after)
        return jnp.concatenate([xi_after - xi, w_after - w])

    return _slopes_of(system, h, change, x, v)


def _each(system: Any, h: Array | None, xs: Array, vs: Array) -> Slopes:
    """Return the slopes at states, one after another: the bits of each do not depend on the others."""
    one = functools.partial(flow_slopes, system) if h is None else functools.partial(_step_slopes, system, h)
    return jax.lax.map(lambda state: one(*state), (xs, vs))


def _slopes_of(system: Any, h: Array | None, change: Callable[[Array, Array], Array], x: Array, v: Array) -> Slopes:
    size = len(v) + system.is_driven

    def both(z: Array) -> tuple[tuple[Array, Array], Array]:
        xi, w = z[:size], z[size:]
        value, place = change(xi, w), system.places.beside(x, xi)
        limits = jnp.concatenate([equations.constraint_of(system, h, place, w), equations.holonomic(system, place)])
        return (value, limits), value

    (slope, rows), value = jax.jacfwd(both, has_aux=True)(jnp.append(jnp.zeros(size), v))
    return value, slope, rows


def _step_velocity(system: Any, h: Array, x: Array, p: Array, near: tuple[Array, Array]) -> Array:
    """Return the velocity of the step from a place with a momentum, next to a state; NaN where there is none."""
    place, v = jax.lax.stop_gradient(near)
    z, code = step_root(system, ((), h, x, p), (v, v, orientation(system, place, v, h)[0]))
    return jnp.where(code == 0, z[: len(v)], jnp.nan)


def node_velocities(system: Any, time: np.ndarray, q: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Return the admissible velocities of momenta at configurations, (K, n) all three."""
    return in_rows(equations.inverse_legendre, system, places(system, q, time), p)


def forced_slopes(motion: Any, q: np.ndarray, v: np.ndarray, forces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the derivatives of the node after each step by that before it, in admissible directions, and by forces.

    A node is a configuration with the velocity of its momentum. A force is constant over its step. Of K nodes the
    derivatives are (K - 1, 2 n, 2 n) and (K - 1, 2 n, n).
    """
    h, system = motion.time_step, motion.system
    x = places(system, q, h * np.arange(len(q)))
    return in_double(_forced_slopes, system, np.float64(h), x[:-1], v[:-1], forces)


def _forced_slopes(system: Any, h: Array, *rows: Array) -> tuple[Array, Array]:
    n = system.dimension

    def beside(z: Array, x: Array) -> Array:
        return system.places.beside(x, jnp.pad(z[:n], (0, int(system.is_driven))))

    def after(z: Array, force: Array, x: Array, v: Array) -> Array:
        place, w, kick = beside(z, x), v + z[n:], h / 2 * force
        p = equations.momentum(system, place, w) + kick
        end, arriving = equations.arrival(system, place, _step_velocity(system, h, place, p, (x, v)), h)
        there = system.places.departure(jax.lax.stop_gradient(end), end)[:n]
        return jnp.append(there, equations.inverse_legendre(system, end, arriving + kick))

    def limits(z: Array, x: Array, v: Array) -> Array:
        place = beside(z, x)
        return jnp.append(equations.constraint(system, place, v + z[n:]), equations.place_residual(system, place))

    def one(row: tuple[Array, Array, Array]) -> tuple[Array, Array]:
        (x, v, force), still = row, jnp.zeros(2 * n)
        A, B = jax.jacfwd(after, (0, 1))(still, force, x, v)
        unit = equations.acceleration_matrix(system, x, v)[1].velocity
        sizes = jnp.outer(jnp.array([h, 1.0]), unit).ravel()  # so that units do not matter
        across = jax.jacfwd(limits)(still, x, v) * sizes
        return A - (A * sizes) @ jnp.linalg.pinv(across) @ (across / sizes), B

    return jax.lax.map(one, rows)
