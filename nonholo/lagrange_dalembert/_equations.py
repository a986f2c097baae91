r"""The equations: discrete Lagrangian and constraints by rule, momenta as their derivatives, the scaled matrix.

They are the same in coordinates and on groups; `system.places` has what differs. Steps are described by a place x and a
velocity v with $q' = q + hv$ or $g' = g\,e^{hv}$.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.types import Array
from nonholo.lagrange_dalembert._system import LagrangeDAlembert
from nonholo.lagrange_dalembert.functions import takes_time

_CORRECTIONS = 8  # of a velocity, Newton's: one where L is quadratic, and constraints are linear


def _value_at(function: Any, system: LagrangeDAlembert, x: Array, *velocity: Array) -> Array:
    """Return the value of a user's function at a place, with the time if it takes it."""
    time = (time_of(x),) if takes_time(function, 1 + len(velocity)) else ()
    return jnp.asarray(function(x[:-1] if system.is_driven else x, *velocity, *time), dtype=x.dtype)


def time_of(x: Array) -> Array:
    """Return the time of a place of a driven system."""
    return x[(-1, *(0 for _ in x.shape[1:]))]


def lagrangian(system: LagrangeDAlembert, x: Array, v: Array) -> Array:
    """Return L."""
    return _value_at(system.lagrangian, system, x, v)


def holonomic(system: LagrangeDAlembert, x: Array) -> Array:
    r"""Return $\Phi$, nothing without holonomic constraints."""
    return jnp.zeros(0) if system.holonomic is None else _value_at(system.holonomic, system, x)


def place_residual(system: LagrangeDAlembert, x: Array) -> Array:
    """Return the distance of a place from holonomic constraints, then from prescribed coordinates."""
    return jnp.concatenate([holonomic(system, x), *(x[i : i + 1] - s(x[-1]) for i, s in system.prescribed)])


def holonomic_residual(system: LagrangeDAlembert, x: Array) -> Array:
    r"""Return $\Phi$ in the rows of all constraints; the others have zero."""
    return jnp.pad(holonomic(system, x), (system.velocity_constraints, len(system.prescribed)))


def forms(system: LagrangeDAlembert, x: Array) -> Array:
    """Return the rows A, none for a free system; then come gradients of holonomic ones, and prescribed coordinates."""
    n, function = system.dimension, system.constraint_forms
    rows = [jnp.zeros((0, n)) if function is None else _value_at(function, system, x)]
    if system.holonomic is not None:
        rows.append(jax.jacfwd(holonomic, argnums=1)(system, x)[:, :n])
    if system.prescribed:
        rows.append(jnp.eye(n)[np.array([i for i, _ in system.prescribed])])
    return jnp.concatenate(rows)


def constraint(system: LagrangeDAlembert, x: Array, v: Array) -> Array:
    """Return A v - b."""
    _, rates = jax.jvp(lambda y: holonomic(system, y), (x,), (system.places.rate(x, v),))
    own = _velocity_constraint(system, x, v)
    return jnp.concatenate([own, rates, *(v[i : i + 1] - jax.grad(s)(x[-1]) for i, s in system.prescribed)])


def _velocity_constraint(system: LagrangeDAlembert, x: Array, v: Array) -> Array:
    """Return A v - b of the constraint forms."""
    if system.constraint_forms is None:
        return jnp.zeros(0)
    rates = _value_at(system.constraint_forms, system, x) @ v
    if system.constraint_velocities is None:
        return rates
    return rates - jnp.asarray(system.constraint_velocities(x[:-1], x[-1]), dtype=x.dtype)


def discrete_lagrangian(system: LagrangeDAlembert, x: Array, v: Array, h: Array) -> Array:
    """Return L_d of a place and what stands for the displacement: v, on a group W."""
    places = system.places
    if system.discrete_lagrangian is not None:
        return jnp.asarray(system.discrete_lagrangian(*places.ends(x, v, h), h))
    if system.rule == "midpoint":
        return h * lagrangian(system, places.ahead(x, v, h / 2), v)
    return h * (lagrangian(system, x, v) + lagrangian(system, places.ahead(x, v, h), v)) / 2


def discrete_constraints(system: LagrangeDAlembert, x: Array, v: Array, h: Array) -> Array:
    """Return F(q, q + h v).

    Holonomic constraints hold at the end of the step, prescribed coordinates move by exactly what is prescribed.
    """
    places = system.places
    if system.discrete_constraints is not None:
        own = jnp.asarray(system.discrete_constraints(*places.ends(x, places.step(v, h), h), h))
    elif system.rule == "midpoint":
        own = _velocity_constraint(system, places.ahead(x, v, h / 2), v)
    else:
        own = (_velocity_constraint(system, x, v) + _velocity_constraint(system, places.ahead(x, v, h), v)) / 2
    at_end = [] if system.holonomic is None else [holonomic(system, system.places.ahead(x, v, h)) / h]
    steps = (v[i : i + 1] - (s(x[-1] + h) - s(x[-1])) / h for i, s in system.prescribed)
    return jnp.concatenate([own, *at_end, *steps])


def constraint_of(system: LagrangeDAlembert, h: Array | None, x: Array, v: Array) -> Array:
    """Return what the constraint of a step, or without a time step of the flow, lacks."""
    return constraint(system, x, v) if h is None else discrete_constraints(system, x, v, h)


def corrected_velocity(system: LagrangeDAlembert, h: Array | None, x: Array, v: Array) -> Array:
    """Return a velocity next to another one at which nothing lacks."""

    def correct(_: Array, w: Array) -> Array:
        slope = jax.jacfwd(constraint_of, argnums=3)(system, h, x, w)
        return w - jnp.linalg.pinv(slope) @ constraint_of(system, h, x, w)

    return jax.lax.fori_loop(0, _CORRECTIONS, correct, v)


def momenta(system: LagrangeDAlembert, x: Array, v: Array, h: Array) -> tuple[Array, Array]:
    r"""Return $P = -D_1 L_d - f^-$ and $P^+ = D_2 L_d + f^+$."""
    step = system.places.step(v, h)
    slopes = jax.grad(discrete_lagrangian, argnums=(1, 2))(system, x, step, h)
    leaving, arriving = system.places.momenta(x, step, h, *slopes)
    if system.force is None:
        return leaving, arriving
    at_start, at_end = impulses(system, x, v, h)
    return leaving - at_start, arriving + at_end


def balance(values: tuple[Array, Array], p: Array, multipliers: Array, rows: Array) -> Array:
    r"""Return what $P = p + \sum_j \mu_j A^j$, F = 0 lack, of values of P and F."""
    P, F = values
    return jnp.concatenate([P - p - multipliers @ rows, F])


def step_balance(system: LagrangeDAlembert, state: tuple[Array, Array], z: Array, h: Array) -> Array:
    """Return what vanishes if z, a velocity with multipliers, is the step from a place with a momentum."""
    (x, p), v = state, z[: system.dimension]
    values = momenta(system, x, v, h)[0], discrete_constraints(system, x, v, h)
    return balance(values, p, z[system.dimension :], forms(system, x))


def arrival(system: LagrangeDAlembert, x: Array, v: Array, h: Array) -> tuple[Array, Array]:
    """Return the place and the momentum after a step."""
    return ahead(system, x, v, h), momenta(system, x, v, h)[1]


def step_residual(
    system: LagrangeDAlembert, state: tuple[Array, Array], z: Array, after: tuple[Array, Array], force: Array, h: Array
) -> Array:
    """Return what vanishes if z is the step between two states, places with momenta, under a constant force."""
    (x, p), (end, following), kick, v = state, after, h / 2 * force, z[: system.dimension]
    gaps = momenta(system, x, v, h)[1] + kick - following, (system.places.ahead(x, v, h) - end).ravel()
    return jnp.concatenate([step_balance(system, (x, p + kick), z, h), *gaps])


def impulses(system: LagrangeDAlembert, x: Array, v: Array, h: Array) -> tuple[Array, Array]:
    """Return half the impulse of a step at each of its ends: of a table, half its row at both."""
    row = 0.0 if system.table is None else system.table.row(time_of(x) / h)
    if system.applied is None:
        return h / 2 * row, h / 2 * row
    end = system.places.ahead(x, v, h)
    return h / 2 * (row + applied(system, x, v)), h / 2 * (row + applied(system, end, v))


def applied(system: LagrangeDAlembert, x: Array, v: Array) -> Array:
    """Return the force f(t, q, v); zero without a function, for a table belongs to steps."""
    function = system.applied
    return jnp.zeros_like(v) if function is None else jnp.asarray(function(time_of(x), x[:-1], v), dtype=x.dtype)


def slopes(system: LagrangeDAlembert, x: Array, v: Array) -> tuple[Array, Array]:
    r"""Return $\partial L/\partial x$ and $\partial L/\partial v$."""
    return jax.grad(lagrangian, argnums=(1, 2))(system, x, v)


def momentum(system: LagrangeDAlembert, x: Array, v: Array) -> Array:
    r"""Return $\partial L/\partial v$."""
    return slopes(system, x, v)[1]


def discrete_energy(system: LagrangeDAlembert, x: Array, v: Array, h: Array, node: Any = None) -> Array:
    r"""Return $E = -\partial L_d/\partial h$ at fixed end points; where h is not known to L_d, E at the midpoint.

    Of a driven system it is E at the node, of the velocity that belongs to the momentum P, solved for or passed.
    """
    if system.is_driven:
        w = inverse_legendre(system, x, momenta(system, x, v, h)[0]) if node is None else node
        return energy(system, x, w)
    if getattr(system.discrete_lagrangian, "is_of_one_step", False):
        return energy(system, x + h * v / 2, v)
    displacement, of = system.places.displacement(v, h), system.places.step_of
    return -jax.grad(lambda step: discrete_lagrangian(system, x, of(displacement, step), step))(h)


def energy(system: LagrangeDAlembert, x: Array, v: Array) -> Array:
    r"""Return $v\cdot\partial L/\partial v - L$."""
    return v @ momentum(system, x, v) - lagrangian(system, x, v)


def ahead(system: LagrangeDAlembert, x: Array, v: Array, h: Array) -> Array:
    """Return the place after a step, without the rounding errors that lead away from a group."""
    return system.places.normalize(system.places.ahead(x, v, h))


def force(system: LagrangeDAlembert, x: Array, v: Array) -> Array:
    r"""Return $\partial L/\partial q + f$ less the change of $\partial L/\partial v$ with q and t."""
    (along_x, p), (_, drift) = jax.jvp(lambda y: slopes(system, y, v), (x,), (system.places.rate(x, v),))
    return system.places.force(v, p, x, along_x) - drift + applied(system, x, v)


def inverse_legendre(system: LagrangeDAlembert, x: Array, p: Array) -> Array:
    """Return the admissible velocity with the components of a momentum along the constraint."""

    def correct(_: Array, v: Array) -> Array:
        return v + bordered_solution(system, x, v, p - momentum(system, x, v), -constraint(system, x, v))[0]

    return jax.lax.fori_loop(0, _CORRECTIONS, correct, jnp.zeros_like(p))


class Scaled(NamedTuple):
    """Units of a bordered matrix: of velocities, and of the rows of both borders."""

    velocity: Array
    forms: Array
    constraints: Array


def bordered_matrix(mass: Array, right: Array, below: Array, kinetic: Array) -> tuple[Array, Scaled]:
    r"""Return $\begin{pmatrix} M & -A^T \\ F & 0 \end{pmatrix}$ without units, and the units.

    Velocities are measured in units of $|\partial^2 L/\partial v_i^2|^{-1/2}$ (1 where it vanishes), which does not
    degenerate where M does; the rows of A and F get length one.
    """
    unit = 1 / jnp.sqrt(jnp.where(jnp.diag(kinetic) == 0, 1.0, jnp.abs(jnp.diag(kinetic))))
    lengths = [jnp.sqrt(jnp.sum((rows * unit) ** 2, axis=1)) for rows in (right, below)]
    a, f = (jnp.where(length == 0, 1.0, length) for length in lengths)
    upper = jnp.concatenate([mass * unit * unit[:, None], -(right * unit).T / a], axis=1)
    lower = jnp.concatenate([below * unit / f[:, None], jnp.zeros((len(right), len(right)))], axis=1)
    return jnp.concatenate([upper, lower]), Scaled(unit, a, f)


def bordered_solution(system: LagrangeDAlembert, x: Array, v: Array, force: Array, off: Array) -> tuple[Array, Array]:
    r"""Solve $M w - A^T\lambda$ = force, A w = off."""
    n, (matrix, units) = len(force), acceleration_matrix(system, x, v)
    solution = jnp.linalg.solve(matrix, jnp.concatenate([force * units.velocity, off / units.constraints]))
    return solution[:n] * units.velocity, solution[n:] / units.forms


def mass_matrix(system: LagrangeDAlembert, x: Array, v: Array) -> Array:
    r"""Return $\partial^2 L/\partial v^2$."""
    return jax.jacfwd(momentum, argnums=2)(system, x, v)


def acceleration_matrix(system: LagrangeDAlembert, q: Array, v: Array) -> tuple[Array, Scaled]:
    """Return the scaled matrix of the continuous equations: the regularity matrix for h -> 0."""
    return matrix_of_mass(system, q, mass_matrix(system, q, v))


def matrix_of_mass(system: LagrangeDAlembert, q: Array, mass: Array) -> tuple[Array, Scaled]:
    """Return the same matrix of a mass matrix at a place."""
    A = forms(system, q)
    return bordered_matrix(mass, A, A, mass)
