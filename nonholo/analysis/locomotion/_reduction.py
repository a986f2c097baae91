r"""A system seen from its body: constraints and inertia, by JAX, over $(\xi, \dot s)$.

These and their derivatives by the shape are all that is compiled; the rest is linear algebra (`_equations.py`).
"""

import dataclasses
import functools
from collections.abc import Callable
from typing import Any, ClassVar, TypeAlias

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.numerics import double_precision
from nonholo.base.types import Array
from nonholo.groups import SE, AbstractMatrixGroup
from nonholo.lagrange_dalembert import check_forms, check_value, equations

_HERE = np.zeros(3)  # the identity, where it is asked for
_TERMS = 8  # as many as the longest brackets need
_BLOCK = 256  # points of a call: one compilation for any number of them


@dataclasses.dataclass(frozen=True)
class Planar:
    """A system in the plane, in coordinates.

    Attributes:
        system: The system.
        pose: Indices of x, y and theta.
        shape: Indices of the other coordinates.
    """

    system: Any
    pose: tuple[int, int, int]
    shape: tuple[int, ...]
    group: ClassVar[AbstractMatrixGroup] = SE(2)

    def rows(self, pose: Array, s: Array) -> Array:
        """Return the constraints at a pose (x, y, theta) as rows W = (B, C)."""
        columns = jax.vmap(functools.partial(_velocities, self, pose), out_axes=1)(jnp.eye(3 + len(s)))
        return equations.forms(self.system, _coordinates(self, pose, s)) @ columns

    def lagrangian(self, pose: Array, s: Array, u: Array) -> Array:
        r"""Return the Lagrangian at a pose, of u = $(\xi, \dot s)$."""
        return jnp.asarray(self.system.lagrangian(_coordinates(self, pose, s), _velocities(self, pose, u)), float)


@dataclasses.dataclass(frozen=True)
class Reduced:
    """A `ShapedBody`, for which all poses are alike."""

    body: Any

    @property
    def group(self) -> AbstractMatrixGroup:
        """The group."""
        return self.body.group

    def rows(self, _pose: Array, s: Array) -> Array:
        """Return the constraints as rows W = (B, C)."""
        n = self.group.dim + len(s)
        forms = self.body.constraint_forms
        return jnp.zeros((0, n)) if forms is None else jnp.asarray(forms(s), float)

    def constraint_forms(self, q: Array) -> Array:
        r"""Return the rows over $(\dot x, \dot s)$ at q = (x, s), with $g = e^x$: exact in derivatives at x = 0.

        There $\xi = \dot x - \tfrac1{2!}[x, \dot x] + \tfrac1{3!}[x, [x, \dot x]] - \dots$
        """
        x, s = jnp.split(q, [self.group.dim])
        term = xi = jnp.eye(len(x))
        for k in range(2, _TERMS + 1):
            term = -self.group.bracket(x, term) / k
            xi = xi + term
        W = self.rows(x, s)
        return jnp.concatenate([W[:, : len(x)] @ xi.T, W[:, len(x) :]], 1)

    def lagrangian(self, _pose: Array, s: Array, u: Array) -> Array:
        r"""Return the Lagrangian of u = $(\xi, \dot s)$."""
        return jnp.asarray(self.body.lagrangian(s, *jnp.split(u, [self.group.dim])), float)


Reduction: TypeAlias = Planar | Reduced


def call(function: Callable[..., Any], reduction: Any, *points: Array) -> Any:
    """Return the values of a function at points, whose leading axes are free, as NumPy arrays in 64 bits."""
    leading = np.broadcast_shapes(*(point.shape[:-1] for point in points))
    count = int(np.prod(leading))
    flat = [np.broadcast_to(p, (*leading, p.shape[-1])).reshape(count, p.shape[-1]) for p in points]
    blocks = max(1, -(-count // _BLOCK))
    whole = [np.concatenate([p, np.zeros((blocks * _BLOCK - count, p.shape[1]))]) for p in flat]
    run = _compile(function, reduction)
    with double_precision():
        parts = zip(*(np.split(p, blocks) for p in whole), strict=True)
        values = [jax.tree.map(np.asarray, run(*part)) for part in parts]
    return jax.tree.map(lambda *x: np.concatenate(x)[:count].reshape((*leading, *x[0].shape[1:])), *values)


@functools.cache
def _compile(function: Callable[..., Any], reduction: Any) -> Callable[..., Any]:
    return jax.jit(jax.vmap(functools.partial(function, reduction)))


def _coordinates(r: Planar, pose: Array, others: Array) -> Array:
    return jnp.zeros(3 + len(others)).at[np.array(r.pose)].set(pose).at[np.array(r.shape)].set(others)


def _velocities(r: Planar, pose: Array, u: Array) -> Array:
    cos, sin = jnp.cos(pose[2]), jnp.sin(pose[2])
    return _coordinates(r, jnp.stack([cos * u[1] - sin * u[2], sin * u[1] + cos * u[2], u[0]]), u[3:])


def rows(r: Reduction, pose: Array, s: Array) -> Array:
    """Return the constraints at a pose."""
    return r.rows(pose, s)


def lagrangian(r: Reduction, pose: Array, s: Array, u: Array) -> Array:
    """Return the Lagrangian at a pose."""
    return r.lagrangian(pose, s, u)


def momenta(r: Reduction, s: Array, u: Array) -> Array:
    """Return the derivative of the Lagrangian by u."""
    return jax.grad(lagrangian, 3)(r, _HERE, s, u)


def constraint_terms(r: Reduction, s: Array) -> tuple[Array, Array]:
    """Return W and its derivatives by the shape, whose axis is the last."""
    at_identity = functools.partial(rows, r, _HERE)
    return at_identity(s), jax.jacfwd(at_identity)(s)


def inertia_terms(r: Reduction, s: Array) -> tuple[Array, Array]:
    """Return the inertia M of a quadratic Lagrangian and its derivatives by the shape."""

    def inertia(s: Array) -> Array:  # momenta are linear
        return jax.vmap(functools.partial(momenta, r, s))(jnp.eye(r.group.dim + len(s)))

    return inertia(s), jax.jacfwd(inertia)(s)


def moving_shape(gait: Callable[[Array], Array], time: Array) -> tuple[Array, Array]:
    """Return the shape of a gait and its velocity, at a time in an array of one."""
    return jax.jvp(gait, (time[0],), (jnp.ones_like(time[0]),))


def check_gait(gait: Any, m: int) -> None:
    """Refuse a gait that is no function time -> shape."""
    with double_precision():
        check_value("geometric_phase(gait=...)", gait, (m,), (jax.ShapeDtypeStruct((), float),), "the time", "the time")


def check_functions(body: Any) -> None:
    """Refuse functions of a `ShapedBody` with values of other shapes."""
    m, dim = len(body.shape_coordinates), body.group.dim
    s, xi = jax.ShapeDtypeStruct((m,), float), jax.ShapeDtypeStruct((dim,), float)
    what, called_with = "the shape", f"{m} shape variables"
    with double_precision():
        if body.constraint_forms is not None:
            remedy = f"Return rows over {dim} components of the body velocity, then {m} of the shape."
            check_forms("ShapedBody(constraint_forms=...)", body.constraint_forms, dim + m, (s,), what, remedy)
        if body.lagrangian is not None:
            of = f"{what} and both velocities"
            check_value("ShapedBody(lagrangian=...)", body.lagrangian, (), (s, xi, s), of, f"{called_with}, {dim}, {m}")
