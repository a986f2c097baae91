r"""A system seen from its body: constraints and inertia, by JAX, over $(\xi, \dot s)$; and brackets of velocities.

These and their derivatives by the shape are all that is compiled; the rest is linear algebra (`_equations.py`).

Iterated Lie brackets of a basis of admissible velocities are Taylor polynomials about a configuration: dictionaries
from powers, such as (0, 0, 2) for x_0^2 x_2, to arrays.
"""

import dataclasses
import functools
import itertools
import math
from collections import Counter
from collections.abc import Callable, Iterator
from typing import Any, ClassVar

import jax
import jax.numpy as jnp
import numpy as np
from scipy.linalg import qr

from nonholo.analysis.locomotion._equations import unit_rows
from nonholo.base.numerics import double_precision
from nonholo.base.traced import call_in_blocks
from nonholo.base.types import Array, Float
from nonholo.groups import SE, AbstractMatrixGroup
from nonholo.lagrange_dalembert import checked_rows, checked_value, equations

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

    system: Any

    @property
    def group(self) -> AbstractMatrixGroup:
        """The group."""
        return self.system.group

    def rows(self, _pose: Array, s: Array) -> Array:
        """Return the constraints as rows W = (B, C)."""
        n = self.group.dim + len(s)
        forms = self.system.constraint_forms
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
        return jnp.asarray(self.system.lagrangian(s, *jnp.split(u, [self.group.dim])), float)


def call(function: Callable[..., Any], reduction: Any, *points: Array) -> Any:
    """Return the values of a function at points, whose leading axes are free, as NumPy arrays in 64 bits."""
    leading = np.broadcast_shapes(*(point.shape[:-1] for point in points))
    flat = [np.broadcast_to(p, (*leading, p.shape[-1])).reshape(math.prod(leading), p.shape[-1]) for p in points]
    run = _compile(function, reduction)
    with double_precision():
        columns = call_in_blocks(lambda *rows: jax.tree.leaves(run(*rows)), _BLOCK, *flat)
    values = [column.reshape(*leading, *column.shape[1:]) for column in columns]
    return values if len(values) > 1 else values[0]


@functools.cache
def _compile(function: Callable[..., Any], reduction: Any) -> Callable[..., Any]:
    return jax.jit(jax.vmap(functools.partial(function, reduction)))


def _coordinates(r: Planar, pose: Array, others: Array) -> Array:
    return jnp.zeros(3 + len(others)).at[np.array(r.pose)].set(pose).at[np.array(r.shape)].set(others)


def _velocities(r: Planar, pose: Array, u: Array) -> Array:
    cos, sin = jnp.cos(pose[2]), jnp.sin(pose[2])
    return _coordinates(r, jnp.stack([cos * u[1] - sin * u[2], sin * u[1] + cos * u[2], u[0]]), u[3:])


def momenta(r: Planar | Reduced, s: Array, u: Array) -> Array:
    """Return the derivative of the Lagrangian by u."""
    return jax.grad(r.lagrangian, 2)(_HERE, s, u)


def constraint_terms(r: Planar | Reduced, s: Array) -> tuple[Array, Array]:
    """Return W and its derivatives by the shape, whose axis is the last."""
    at_identity = functools.partial(r.rows, _HERE)
    return at_identity(s), jax.jacfwd(at_identity)(s)


def inertia_terms(r: Planar | Reduced, s: Array) -> tuple[Array, Array]:
    """Return the inertia M of a quadratic Lagrangian and its derivatives by the shape."""

    def inertia(s: Array) -> Array:  # momenta are linear
        return jax.vmap(functools.partial(momenta, r, s))(jnp.eye(r.group.dim + len(s)))

    return inertia(s), jax.jacfwd(inertia)(s)


def moving_shape(gait: Callable[[Array], Array], time: Array) -> tuple[Array, Array]:
    """Return the shape of a gait and its velocity, at a time in an array of one."""
    return jax.jvp(gait, (time[0],), (jnp.ones_like(time[0]),))


def check_gait(gait: Any, m: int) -> None:
    """Refuse a gait that is no function time -> shape."""
    time = (jax.ShapeDtypeStruct((), float),)
    checked_value("geometric_phase(gait=...)", gait, "the time", time, (m,), "the time")


def traced_functions(body: Any) -> Iterator[tuple[str, Any]]:
    """Yield the functions of a `ShapedBody` by name; refuse those with values of other shapes."""
    m, dim = len(body.shape_coordinates), body.group.dim
    s, xi = jax.ShapeDtypeStruct((m,), float), jax.ShapeDtypeStruct((dim,), float)
    what, called_with = "the shape", f"{m} shape variables"
    if body.constraint_forms is not None:
        where = "ShapedBody(constraint_forms=...)"
        remedy = f"Return rows over {dim} components of the body velocity, then {m} of the shape."
        forms = checked_rows(where, body.constraint_forms, what, (s,), dim + m - 1, (dim + m,), remedy)
        yield "constraint_forms", forms
    if body.lagrangian is not None:
        where, of, arrays = "ShapedBody(lagrangian=...)", f"{what} and both velocities", f"{called_with}, {dim}, {m}"
        yield "lagrangian", checked_value(where, body.lagrangian, of, (s, xi, s), (), arrays)


Polynomial = dict[tuple[int, ...], Array]
Rows = tuple[Callable[[Any, Array], Array], Any]
"""A function of a system and a configuration, and the system, whose constraint forms it gives."""


def forms_at(forms: Rows, q: Float[np.ndarray, "n"], units: Float[np.ndarray, "n"]) -> Float[np.ndarray, "s n"]:
    """Return the constraint forms as rows of length one, in units of coordinates."""
    return unit_rows(_taylor(forms, q, units, 0)[()])


def reach(forms: Rows, q: Float[np.ndarray, "n"], units: Float[np.ndarray, "n"]) -> float:
    """Return in how many units the constraint forms turn by a radian; between what is 1 in the user's."""
    polynomial, one = _taylor(forms, q, units, 1), 1 / units
    lengths = np.linalg.norm(polynomial[()], axis=1)
    slopes = [np.linalg.norm(rows, axis=1) for power, rows in polynomial.items() if power]
    rate = max(float((each / np.where(lengths > 0, lengths, 1.0)).max(initial=0.0)) for each in slopes)
    return float(np.clip(1 / rate if rate > 0 else np.inf, one.min(), one.max()))


def brackets(
    forms: Rows, q: Float[np.ndarray, "n"], units: Float[np.ndarray, "n"], longest: int
) -> Iterator[Float[np.ndarray, "n words"]]:
    """Yield the brackets [X_i, [X_j, ... ]] of each length, one for each word, as columns.

    The basis is X = (I, Y(q)), the identity in coordinates that the constraints leave free at q.
    """
    n, order = len(q), longest - 1
    basis = _basis(forms_at(forms, q, units), _taylor(forms, q, units, order), order)
    fields, slopes = basis, _slopes(basis, n)
    yield basis[()]
    for _ in range(order):
        along, across = _product(_slopes(fields, n), basis, order), _product(slopes, fields, order)
        both = along.keys() & across
        fields = {power: (along[power] - np.swapaxes(across[power], 1, 2)).reshape(n, -1) for power in both}
        yield fields[()]


def _basis(forms: Float[np.ndarray, "s n"], rows: Polynomial, order: int) -> Polynomial:
    """Return a basis of what the rows admit, by their inverse at the point, which gains an order in each round."""
    factors: Any = qr(forms, pivoting=True, mode="r")
    dependent, free = np.split(factors[1], [len(forms)])
    inverse = np.linalg.inv(rows[()][:, dependent])
    rows = {power: inverse @ row for power, row in rows.items()}
    change = {power: row[:, dependent] for power, row in rows.items() if power}
    solution = constant = {power: -row[:, free] for power, row in rows.items()}
    for _ in range(order):
        later = _product(change, solution, order)
        solution = {power: row - later.get(power, 0.0) for power, row in constant.items()}
    basis = {power: np.zeros((forms.shape[1], len(free))) for power in solution}
    for power, row in solution.items():
        basis[power][dependent] = row
    basis[()][free] = np.eye(len(free))
    return basis


def _slopes(p: Polynomial, n: int) -> Polynomial:
    """Return the derivatives by all coordinates, along a last axis."""
    slopes = {}
    for power, value in p.items():
        for i, times in Counter(power).items():
            left = list(power)
            left.remove(i)
            slopes.setdefault(tuple(left), np.zeros((*value.shape, n)))[..., i] += times * value
    return slopes


def _product(a: Polynomial, b: Polynomial, order: int) -> Polynomial:
    """Return the product of arrays a, along their last axis, with matrices b; what is beyond an order is dropped."""
    product: Polynomial = {}
    for (power, value), (other, factor) in itertools.product(a.items(), b.items()):
        if len(power) + len(other) <= order:
            whole = tuple(sorted(power + other))
            product[whole] = product.get(whole, 0.0) + value @ factor
    return product


@double_precision()
def _taylor(forms: Rows, q: Float[np.ndarray, "n"], units: Float[np.ndarray, "n"], order: int) -> Polynomial:
    """Return the constraint forms as a polynomial about q in coordinates with units."""
    derivatives = [np.asarray(tensor) for tensor in _derivatives(forms, order)(jnp.asarray(q), jnp.asarray(units))]
    return {
        power: derivatives[degree][(..., *power)] / math.prod(map(math.factorial, Counter(power).values()))
        for degree in range(order + 1)
        for power in itertools.combinations_with_replacement(range(len(q)), degree)
    }


@functools.cache
def _derivatives(forms: Rows, order: int) -> Callable[[Array, Array], list[Array]]:
    """Return the compiled derivatives of the constraint forms up to an order."""
    rows, system = forms

    def beside(y: Array, q: Array, units: Array) -> Array:
        return rows(system, q + units * y) * units

    derivatives: list[Callable[..., Any]] = [beside]
    for _ in range(order):
        derivatives.append(jax.jacfwd(derivatives[-1]))
    return jax.jit(lambda q, units: [each(jnp.zeros_like(q), q, units) for each in derivatives])
