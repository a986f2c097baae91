"""The definition route: momenta as derivatives of the discrete Lagrangian, the step as a root of its equations.

Written from the definitions for any discrete Lagrangian, in JAX; the closed forms are tested against it.
"""

import functools
from collections.abc import Callable

import equinox
import jax
import jax.numpy as jnp
import numpy as np

from nonholo._progress import progress_bar
from nonholo._results import Outcome
from nonholo._types import Array, Float
from nonholo.discrete._discretization import Discretization
from nonholo.discrete._precision import in_double
from nonholo.discrete._root import principal_root


def reduced_discrete_lagrangian(discrete: Discretization) -> Callable[[Array], Array]:
    """Return the function W -> l_d(W), which includes the factor time_step."""
    system, h = discrete.system, discrete.time_step
    if callable(discrete.difference):
        return discrete.difference

    def of_matrix(W: Array) -> Array:
        X = W - jnp.eye(W.shape[-1])
        return jnp.trace(X @ jnp.asarray(system.homogeneous_mass_tensor) @ X.T) / (2 * h)

    def of_logarithm(W: Array) -> Array:
        x = system.group.log(W)
        return x @ jnp.asarray(system.inertia_operator) @ x / (2 * h)

    return of_matrix if discrete.difference == "matrix" else of_logarithm


def legendre_by_derivative(discrete: Discretization, W: Float[Array, "... N N"], side: str) -> Float[Array, "... dim"]:
    """Return the momenta P(W) (left) or Ad*_W P(W) (right) by automatic differentiation."""
    return in_double(functools.partial(_legendre, side=side), discrete, W)


@equinox.filter_jit
def _legendre(discrete: Discretization, W: Array, side: str) -> Array:
    group, lagrangian = discrete.system.group, reduced_discrete_lagrangian(discrete)

    def momentum(V: Array) -> Array:
        def varied(x: Array) -> Array:
            g = group.exp(x)
            return lagrangian(g @ V if side == "left" else V @ g)

        return jax.grad(varied)(jnp.zeros(group.dim, V.dtype))

    flat = jnp.reshape(W, (-1, *W.shape[-2:]))
    return jnp.reshape(jax.vmap(momentum)(flat), (*W.shape[:-2], group.dim))


def displaced(discrete: Discretization, y: Float[Array, "k"]) -> Float[Array, "N N"]:
    """Return the displacement with Cayley coordinates y in rows of the constraint subspace."""
    return discrete.system.group.cayley(2 * y @ jnp.asarray(discrete.system.constraint_subspace))


def principal_displacement(discrete: Discretization, restricted: Float[Array, "k"]) -> tuple[Array, Array]:
    """Return Cayley coordinates of the principal displacement with these momenta along d, and the outcome."""

    def residual(y: Array, r: Array) -> Array:
        return discrete.system.restrict(_legendre(discrete, displaced(discrete, y), "left")) - r

    return principal_root(residual, restricted)


def next_charts_by_definition(discrete: Discretization, cayley: Float[np.ndarray, "K k"]) -> Float[np.ndarray, "K k"]:
    """Return the canonical Cayley coordinates that follow, one step from each row."""
    C = discrete.system.frame_map
    _, charts, _ = in_double(equinox.filter_jit(jax.vmap(_step, in_axes=(None, 0))), discrete, cayley @ C)
    return charts @ np.linalg.inv(C)


def _step(discrete: Discretization, y: Array) -> tuple[Array, Array, Array]:
    r = discrete.system.restrict(_legendre(discrete, displaced(discrete, y), "right"))
    following, code = principal_displacement(discrete, r)
    return r, following, code


def run_by_definition(
    discrete: Discretization, reduced: np.ndarray, pose: np.ndarray, steps: int, every: int, progress: bool
) -> tuple[tuple[np.ndarray, np.ndarray, np.ndarray], Outcome, int]:
    """Run the step; return the saved canonical states, the outcome and the number of good steps."""
    C = discrete.system.frame_map
    restricted = np.linalg.solve(C, reduced)
    y, code = in_double(equinox.filter_jit(principal_displacement), discrete, restricted)
    saved = [(restricted, y, pose)] if code == 0 else []
    done = 0
    with progress_bar("steps", progress) as report:
        while code == 0 and done < steps:
            batch = min(every, steps - done)
            good, code, r, y, pose = in_double(_advance, discrete, np.int64(batch), y, pose)
            done += int(good)
            if code == 0 and batch == every:
                saved.append((r, y, pose))
            report(done, steps)
    rows = [np.array(column) for column in zip(*saved, strict=True)] or [np.empty((0, reduced.size))] * 2 + [pose[:0]]
    return (rows[0] @ C.T, rows[1] @ np.linalg.inv(C), rows[2]), Outcome(int(code)), done


@equinox.filter_jit
def _advance(discrete: Discretization, steps: Array, y: Array, pose: Array) -> tuple[Array, ...]:
    group, system = discrete.system.group, discrete.system
    back = jnp.asarray(group.inverse(system.frame))

    def body(carry: tuple[Array, ...]) -> tuple[Array, ...]:
        done, _, _, y, pose = carry
        r, following, code = _step(discrete, y)
        W = back @ displaced(discrete, y) @ system.frame
        moved = group.pose_from_matrix(group.matrix_from_pose(pose) @ W)
        good = code == 0
        return done + good, code, r, jnp.where(good, following, y), jnp.where(good, moved, pose)

    start = (jnp.asarray(0), jnp.asarray(0), jnp.zeros_like(y), jnp.asarray(y), jnp.asarray(pose))
    return jax.lax.while_loop(lambda c: (c[0] < steps) & (c[1] == 0), body, start)
