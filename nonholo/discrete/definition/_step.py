"""The definition route: momenta as derivatives of the discrete Lagrangian, the step as a root of its equations.

Written from the definitions for any group, any discrete Lagrangian and any displacement variety, in JAX; the compiled
steps are tested against it. With a right-invariant constraint the unknown is U = g W g^-1; the equations depend on g.

Functions of one matrix, the library's or the user's, in JAX: values, derivatives along the group, momenta. The
principal displacement for JAX is that of the closed form of a body where it has one, which its kernel shares.
"""

from collections.abc import Callable
from typing import Any

import equinox
import jax
import jax.numpy as jnp
import numpy as np

from nonholo import kernels
from nonholo.base.results import Outcome, OutcomeError
from nonholo.base.traced import TracedFunction
from nonholo.base.types import Array, Float
from nonholo.discrete._scheme import Scheme, legendre
from nonholo.discrete.definition._precision import compile_double, in_double
from nonholo.discrete.definition._root import followed_root, principal_root
from nonholo.discrete.routes import ScalarStep
from nonholo.groups import AbstractMatrixGroup

_SAMPLES = 16
_EVEN = 1e-10  # relative difference of values that counts as rounding


def sample_displacements(discrete: Scheme, count: int) -> Float[np.ndarray, "count N N"]:
    """Draw displacements from the variety, the principal ones of velocities that turn by about 0.3 in a step."""
    system, rng = discrete.system, np.random.default_rng(0)
    velocities = rng.normal(size=(count, len(system.constraint_subspace)))
    velocities *= 0.3 / (discrete.time_step * np.linalg.norm(velocities, axis=1, keepdims=True))
    momenta = velocities @ np.asarray(system.constrained_inertia)
    displacements, codes = in_double(_displacements, discrete, momenta, system.group.identity)
    if codes.any():
        raise OutcomeError(Outcome(int(codes.max())), "A displacement of a step of 0.3")
    return displacements


@equinox.filter_jit
def _displacements(discrete: Scheme, momenta: Array, g: Array) -> tuple[Array, Array]:
    charts, codes = jax.vmap(lambda r: principal_displacement(discrete, r, g))(momenta)
    return jax.vmap(lambda y: displacement_of(discrete, y))(charts), codes


def displacement_of(discrete: Scheme, y: Float[Array, "m"]) -> Float[Array, "N N"]:
    """Return the element of the variety, in the user's frame, with canonical chart coordinates y."""
    return discrete.system.from_canonical_frame(discrete.variety.displaced(y))


def momentum_of(discrete: Scheme, y: Array, g: Array, side: str) -> Array:
    """Return the body momentum (left) or the one that arrives (right) of a displacement at a pose."""
    group, system = discrete.system.group, discrete.system
    X = discrete.variety.increment(y)
    if system.is_spatial:
        return legendre(discrete, group.inverse(g) @ X @ g, side)
    return legendre(discrete, system.from_canonical_frame(X), side)


def restricted(discrete: Scheme, momentum: Array, g: Array) -> Array:
    """Return the components of a body momentum along the constraint, in space where that is fixed in space."""
    momentum = discrete.system.constraint_momentum(momentum, g)
    return jnp.asarray(discrete.system.constraint_subspace, dtype=momentum.dtype) @ momentum


def principal_displacement(discrete: Scheme, r: Float[Array, "k"], g: Array) -> tuple[Array, Array]:
    """Return chart coordinates of the principal displacement with these momenta along d, and the outcome."""
    return principal_root(equations_at(discrete, g), r, discrete.variety.chart.shape[0])


def nearest_displacement(discrete: Scheme, y: Float[Array, "m"], r: Float[Array, "k"]) -> tuple[Array, Array]:
    """Return chart coordinates of the displacement that y reaches when its momenta along d move straight to r."""
    g = discrete.system.group.identity
    before = restricted(discrete, momentum_of(discrete, y, g, "left"), g)
    return followed_root(equations_at(discrete, g), (y, before), r)


def equations_at(discrete: Scheme, g: Array) -> Callable[[Array, Array], Array]:
    """Return the function of chart coordinates and momenta along d that vanishes at a displacement."""
    variety = discrete.variety

    def residual(y: Array, target: Array) -> Array:
        gap = restricted(discrete, momentum_of(discrete, y, g, "left"), g) - target
        return jnp.concatenate([gap, variety.equations(variety.displaced(y))])

    return residual


@compile_double
def next_charts(discrete: Scheme, charts: Float[Array, "K m"], g: Float[Array, "K N N"]) -> Float[Array, "K m"]:
    """Return the charts after one step to the principal value from each chart and pose."""
    return jax.vmap(lambda *state: principal_displacement(discrete, *push(discrete, *state))[0])(charts, g)


def push(discrete: Scheme, y: Array, g: Array) -> tuple[Array, Array]:
    """Return restricted momentum and pose after a displacement."""
    W = displacement_of(discrete, y)
    after = discrete.system.moved(g, W)
    return restricted(discrete, momentum_of(discrete, y, g, "right"), after), after


def trace(function: Callable[[Array], Array], group: AbstractMatrixGroup) -> TracedFunction:
    """Return a function of a matrix of a group with the numbers that it reads now."""
    return TracedFunction(function, (jax.ShapeDtypeStruct(group.identity.shape, float),))


@compile_double
def value_and_slope(lagrangian: Callable[[Array], Array], group: AbstractMatrixGroup) -> tuple[Any, Any]:
    """Return a discrete Lagrangian and its derivative along the group at the identity."""
    return jax.value_and_grad(lambda x: lagrangian(group.exp(x)))(jnp.zeros(group.dim))


@compile_double
def map_each(function: Callable[[Array], Array], W: Float[Array, "K N N"]) -> Any:
    """Return the values of a function of one matrix at each of several."""
    return jax.vmap(function)(W)


def is_even(function: Callable[[Array], Array], group: AbstractMatrixGroup) -> bool:
    """Return whether a function takes the same value at W and its inverse, tried at random elements."""
    W = group.exp(0.5 * np.random.default_rng(0).normal(size=(_SAMPLES, group.dim)) / np.sqrt(group.dim))
    there, back = map_each(function, W), map_each(function, group.inverse(W))
    return bool(np.abs(there - back).max() <= _EVEN * np.abs(there).max())


@compile_double
def momenta_by_derivative(
    lagrangian: Callable[[Array], Array], group: AbstractMatrixGroup, W: Float[Array, "... N N"], side: str
) -> Float[Array, "... dim"]:
    """Return the momenta P(W) (left) or Ad*_W P(W) (right) of a discrete Lagrangian by automatic differentiation."""

    def momentum(V: Array) -> Array:
        def variation(x: Array) -> Array:
            g = group.exp(x)
            return lagrangian(g @ V if side == "left" else V @ g)

        return jax.grad(variation)(jnp.zeros(group.dim, V.dtype))

    flat = jnp.reshape(W, (-1, *W.shape[-2:]))
    return jnp.reshape(jax.vmap(momentum)(flat), (*W.shape[:-2], group.dim))


ON_LOCUS = 1e-6  # relative distance from the momentum locus that a computed momentum may have


def traceable(number: Array) -> Array:
    """Return a number as a scalar array: JAX would compile the step again for each value of a Python float."""
    return np.float64(number) if isinstance(number, float) else number


def kernel_root(body: kernels.Body, m: Float[Array, "2"], guess: Array | None = None) -> tuple[Array, Array]:
    """Return the principal root over momenta of a kernel, and the outcome; the search looks at a guess first."""

    def residual(y: Array, m: Array) -> Array:
        return jnp.stack(kernels.residual(body, *m, *y))

    return principal_root(residual, m, 2, lambda y, m: kernels.is_certain(body, *m, *y), guess)


def principal_of(discrete: Scheme, scalar: ScalarStep | None, r: Float[Array, "k"], g: Array) -> tuple[Array, Array]:
    """Return canonical chart coordinates of the principal displacement with momenta r along d, and the outcome."""
    if scalar is None:
        return principal_displacement(discrete, r, g)
    y, code = kernel_root(scalar.body, jnp.asarray(scalar.momentum_map(discrete.system)) @ r)
    return scalar.canonical_chart(y), code
