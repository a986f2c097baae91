"""Iterated Lie brackets of a basis of admissible velocities, in Taylor polynomials about a configuration.

Polynomials are dictionaries from powers, such as (0, 0, 2) for x_0^2 x_2, to arrays.
"""

import functools
import itertools
import math
from collections import Counter
from collections.abc import Callable, Iterator
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from scipy.linalg import qr

from nonholo.base.numerics import double_precision
from nonholo.base.types import Array, Float

Polynomial = dict[tuple[int, ...], Array]
Rows = tuple[Callable[[Any, Array], Array], Any]
"""A function of a system and a configuration, and the system, whose constraint forms it gives."""


def forms_at(forms: Rows, q: Float[np.ndarray, "n"]) -> Float[np.ndarray, "s n"]:
    """Return the constraint forms as rows of length one."""
    rows = _taylor(forms, q, 0)[()]
    return rows / np.maximum(np.linalg.norm(rows, axis=1, keepdims=True), np.finfo(float).tiny)


def brackets(forms: Rows, q: Float[np.ndarray, "n"], longest: int) -> Iterator[Float[np.ndarray, "n words"]]:
    """Yield the brackets [X_i, [X_j, ... ]] of each length, one for each word, as columns.

    The basis is X = (I, Y(q)), the identity in coordinates that the constraints leave free at q.
    """
    n, order = len(q), longest - 1
    basis = _basis(forms_at(forms, q), _taylor(forms, q, order), order)
    fields, slopes = basis, _slopes(basis, n)
    yield basis[()]
    for _ in range(order):
        along, across = _product(_slopes(fields, n), basis, order), _product(slopes, fields, order)
        fields = {
            power: (along[power] - np.swapaxes(across[power], 1, 2)).reshape(n, -1) for power in along.keys() & across
        }
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
def _taylor(forms: Rows, q: Float[np.ndarray, "n"], order: int) -> Polynomial:
    """Return the constraint forms as a polynomial about q."""
    derivatives = [np.asarray(tensor) for tensor in _derivatives(forms, order)(jnp.asarray(q))]
    return {
        power: derivatives[degree][(..., *power)] / math.prod(map(math.factorial, Counter(power).values()))
        for degree in range(order + 1)
        for power in itertools.combinations_with_replacement(range(len(q)), degree)
    }


@functools.cache
def _derivatives(forms: Rows, order: int) -> Callable[[Array], list[Array]]:
    """Return the compiled derivatives of the constraint forms up to an order."""
    rows, system = forms
    derivatives: list[Callable[..., Any]] = [functools.partial(rows, system)]
    for _ in range(order):
        derivatives.append(jax.jacfwd(derivatives[-1]))
    return jax.jit(lambda q: [each(q) for each in derivatives])
