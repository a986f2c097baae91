r"""Quadratic equations and the Taylor coefficients of their solutions.

With velocities w the state x obeys $x_m' = \sum_a c_{ma}\,w_a + \sum_q C_{mq}\,z_{a(q)}\,z_{b(q)}$, where z is (w, x)
and a(q) the place of a velocity. If the constraint is fixed in the body, x ends with momenta r, and w = V r. If it is
fixed in space, x ends with the inertia tensor $\mathbb{J}_g = g\mathbb{J}g^T$, and $B(\mathbb{J}_g)\,w = r$ with a
linear map B and constant r: a division of series. Taylor coefficients of products are Cauchy products.

A single motion has eight places of z side by side, several motions have one place of all of them; in both, the terms
of a sum are added in the same order. Code may be compiled for the structure of equations: all tops on one group share
one.
"""

import functools
import threading
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from nonholo.base.compiled import library_of_kernels, overload, way_of_kernels
from nonholo.base.types import Int
from nonholo.kernels._scalar import COMPILED, expand_at, scalar
from nonholo.kernels._small import eliminate
from nonholo.kernels.lanes import EIGHT, load, spread, store

EMITTER = "nonholo.kernels.taylor.emission.code_of"
_MOST = 8  # velocities, if they take a division


def structure_of(counts: tuple[int, int, int], *arrays: Iterable[int]) -> str:
    """Return what code depends on: counts of motions, velocities and numbers of J; `rows`, `first` and `sources`."""
    return ";".join(",".join(map(str, part)) for part in (counts, *arrays))


@functools.cache
def address_of(counts: tuple[int, int, int], *arrays: bytes) -> int:
    """Return the address of the expansion of a structure, from the library or compiled now; 0 if there is none."""
    if counts[2] and counts[1] > _MOST:
        return 0
    structure = structure_of(counts, *(np.frombuffer(each, dtype=np.int64) for each in arrays))
    library, way = library_of_kernels(), way_of_kernels()
    address = library.address(EMITTER, structure) if library else 0
    if address or way == "python":
        return address
    try:
        from nonholo.base.compiled.emission import compile_text
        from nonholo.kernels.taylor.emission import code_of
    except ModuleNotFoundError:  # without the extra `compile` the general kernel does it
        return 0
    return compile_text(code_of(structure, "expansion"), "expansion")


_SMALL = 128  # components, below which rooms are kept


class Quadratic(NamedTuple):
    """Equations as the module states them.

    Attributes:
        velocities: V, (k, k L), for each of L lanes.
        rows: Which products are taken: the place in z of a velocity, and which eight places of z, or, of several
            motions side by side, which place, (2, R).
        first: Where the terms of each row of C and c begin, and the last one ends, (size + 1,).
        sources: Which of the products, or of the velocities behind them, each term needs, (Q,).
        factors: The value of C or c in each term, (1, Q L).
        order: The component of the state of a solution that each component of x is, (size,).
        blocks: The block of each component of x, whose errors are measured together, (size,).
        is_closed: Whether nothing outside moves a block, (blocks,).
        forms: The coefficients of B, (k, k, N N), or none, (0,), if the constraint is fixed in the body.
        tensor: J, (N, N).
        momentum: r, (k,), of a constraint fixed in space.
    """

    velocities: np.ndarray
    rows: np.ndarray
    first: np.ndarray
    sources: np.ndarray
    factors: np.ndarray
    order: np.ndarray
    blocks: np.ndarray
    is_closed: np.ndarray
    forms: np.ndarray
    tensor: np.ndarray
    momentum: np.ndarray


class Room(NamedTuple):
    """Where a kernel works, which allocates nothing.

    Attributes:
        series: Coefficients of z, (order + 1, width).
        sums: Coefficients of the products, and of w behind them, (1, 8 R + k L).
        inertia: Coefficients of B, column by column, (order + 1, k, at least eight).
        matrix: B, then right sides, (k, k).
        inverse: Of B, (k, k).
        change: A sum of a series, (1, width).
        sizes: Of the coefficients of blocks, (order + 1, blocks L).
        steps: The length of a step, (1, L).
        ahead: Times after the beginning of a step, and one component at each, (2, 8).
    """

    series: np.ndarray
    sums: np.ndarray
    inertia: np.ndarray
    matrix: np.ndarray
    inverse: np.ndarray
    change: np.ndarray
    sizes: np.ndarray
    steps: np.ndarray
    ahead: np.ndarray


def make_room(f: Quadratic, order: int, lanes: tuple[int, ...]) -> Room:
    """Return room for the series of some lanes."""
    return _room(_sizes(f, order), len(lanes))


def kept_room(f: Quadratic, order: int) -> Room:
    """Return room for one series, which this thread keeps if it is small."""
    sizes = _sizes(f, order)
    return _room_of(threading.get_ident(), sizes) if len(f.blocks) < _SMALL else _room(sizes, 1)


def _sizes(f: Quadratic, order: int) -> tuple[int, ...]:
    return len(f.velocities), len(f.blocks), f.rows.shape[1], len(f.forms), len(f.is_closed), order


def _room(sizes: tuple[int, ...], L: int) -> Room:
    k, size, products, forms, blocks, order = sizes
    places = k + size
    width = L * (places if L > 1 else places + -places % len(EIGHT))
    return Room(
        _aligned_zeros(order + 1, width),
        _aligned_zeros(1, len(EIGHT) * products + k * L),
        np.zeros((order + 1, forms, max(forms, len(EIGHT)))),
        np.zeros((forms, forms)),
        np.zeros((forms, forms)),
        np.zeros((1, width)),
        np.zeros((order + 1, blocks * L)),
        np.zeros((1, L)),
        np.zeros((2, 2 * len(EIGHT))),
    )


@functools.lru_cache(maxsize=16)
def _room_of(_thread: int, sizes: tuple[int, ...]) -> Room:
    return _room(sizes, 1)


def _aligned_zeros(rows: int, width: int) -> np.ndarray:
    """Return zeros that begin where eight numbers do that a processor loads at once."""
    room = np.zeros(rows * width + len(EIGHT))
    offset = -(room.ctypes.data // room.itemsize) % len(EIGHT)
    return room[offset : offset + rows * width].reshape(rows, width)


def sparse_products(
    left: Int[np.ndarray, "Q"], right: Int[np.ndarray, "Q"], width: int
) -> tuple[Int[np.ndarray, "2 R"], Int[np.ndarray, "Q"]]:
    """Return which products are taken, a number of places at once, and which of them each term needs.

    Args:
        left: The place of the velocity in each term.
        right: The place of the other factor.
        width: How many places stand side by side.
    """
    rows, sources = np.unique(np.stack([left, right // width]), axis=1, return_inverse=True)
    return np.ascontiguousarray(rows), sources.reshape(-1) * width + right % width


def expansion_of(f: Quadratic, lanes: tuple[int, ...]) -> int:
    """Return the address of the code that is compiled for the structure of equations; 0 if there is none."""
    counts = len(lanes), len(f.velocities), f.forms.size and f.tensor.size
    return address_of(counts, f.rows.tobytes(), f.first.tobytes(), f.sources.tobytes())


@scalar
def expand(f: Quadratic, expansion: int, state: np.ndarray, room: Room, lanes: tuple[int, ...]) -> None:
    """Write the Taylor coefficients of the solution from a state, by compiled code at an address, or if that is 0."""
    if len(lanes) == 1 and len(f.forms) > 0:
        _see_tensor(f.tensor, len(f.blocks) - f.tensor.size, state)
    series, before = room.series, len(f.velocities)
    for m in range(len(f.blocks)):
        store(series, 0, before + m, lanes, load(state, 0, m, lanes))
    if expansion != 0:
        _write_velocities(f, 0, room, lanes)
        matrix = room.inverse if len(f.forms) > 0 else f.velocities
        expand_at(expansion, (matrix, f.factors, series, f.forms, room.inertia), len(series) - 1)
        return
    for j in range(len(series) - 1):
        _write_velocities(f, j, room, lanes)
        for q in range(f.rows.shape[1]):
            _convolve(f.rows, q, series, j, lanes, room.sums)
        for a in range(before):
            store(room.sums, 0, room.sums.shape[1] // len(lanes) - before + a, lanes, load(series, j, a, lanes))
        _collect(f, room.sums, j, series, lanes)


@scalar
def _see_tensor(tensor: np.ndarray, before: int, state: np.ndarray) -> None:
    """Write the inertia tensor in space, which its own equations carry through one step, from the pose."""
    N, g = len(tensor), state[0]
    for i in range(N):
        for j in range(N):
            total = 0.0
            for a in range(N):
                half = 0.0
                for b in range(N):
                    half += tensor[a, b] * g[j * N + b]
                total += g[i * N + a] * half
            state[0, before + i * N + j], state[1, before + i * N + j] = total, 0.0


def _write_velocities(f: Any, order: Any, room: Any, lanes: Any) -> Any:
    """Write a coefficient of w: with numba one of the two that follow, by the axes of the forms."""
    (_divide if f.forms.ndim == 3 else _apply)(f, order, room, lanes)


@overload(_write_velocities, jit_options=COMPILED)
def _choose(f: Any, order: Any, room: Any, lanes: Any) -> Any:
    """Choose when a kernel is compiled."""
    return _divide if f.types[f.fields.index("forms")].ndim == 3 else _apply


def _apply(f: Any, order: Any, room: Any, lanes: Any) -> Any:
    """Write the coefficient of w = V r."""
    V, series, k, before = f.velocities, room.series, len(f.velocities), len(f.blocks)
    for a in range(k):
        velocity = spread(0.0, lanes)
        for i in range(k):
            velocity = velocity + load(V, a, i, lanes) * load(series, order, before + i, lanes)
        store(series, order, a, lanes, velocity)


def _divide(f: Any, order: Any, room: Any, lanes: Any) -> Any:
    """Write the coefficient of w in B w = r: B_0 w_j = r_j - B_1 w_(j-1) - ... - B_j w_0, with the inverse of B_0."""
    k, inertia, series, matrix, inverse = len(f.momentum), room.inertia, room.series, room.matrix, room.inverse
    before = k + len(f.blocks) - f.forms.shape[2]
    for a in range(k):
        for b in range(k):
            inertia[order, b, a] = _entry(f.forms, a, b, series, order, before)
            if order == 0:
                matrix[a, b], inverse[a, b] = inertia[0, b, a], 1.0 if a == b else 0.0
    if order == 0:
        eliminate(matrix, inverse)
    for a in range(k):
        matrix[0, a] = (f.momentum[a] if order == 0 else 0.0) - _earlier(inertia, series, a, order)
    for a in range(k):
        total = 0.0
        for b in range(k):
            total += inverse[a, b] * matrix[0, b]
        series[order, a] = total


@scalar
def _entry(forms: np.ndarray, a: int, b: int, series: np.ndarray, order: int, before: int) -> float:
    """Return an entry of B of a coefficient of the tensor."""
    entry = 0.0
    for e in range(forms.shape[2]):
        entry += forms[a, b, e] * series[order, before + e]
    return entry


@scalar
def _earlier(inertia: np.ndarray, series: np.ndarray, a: int, order: int) -> float:
    """Return a row of B_1 w_(j-1) + ... + B_j w_0."""
    even, odd = 0.0, 0.0
    for b in range(inertia.shape[1]):
        for i in range(1, order, 2):
            odd += inertia[i, b, a] * series[order - i, b]
            even += inertia[i + 1, b, a] * series[order - i - 1, b]
        if order % 2 == 1:
            odd += inertia[order, b, a] * series[0, b]
    return odd + even


@scalar
def _convolve(
    rows: np.ndarray, q: int, series: np.ndarray, order: int, lanes: tuple[int, ...], sums: np.ndarray
) -> None:
    """Write the sums of z_a[i] z_b[order - i] of a row of products, with the newest coefficients last."""
    a, b, even, odd = rows[0, q], rows[1, q], spread(0.0, EIGHT), spread(0.0, EIGHT)
    for i in range(1, order - 1, 2):
        odd = odd + _product(series, i, a, order - i, b, lanes)
        even = even + _product(series, i + 1, a, order - i - 1, b, lanes)
    if order % 2 == 0 and order > 0:
        odd = odd + _product(series, order - 1, a, 1, b, lanes)
    outer = _product(series, 0, a, order, b, lanes)
    if order > 0:
        outer = outer + _product(series, order, a, 0, b, lanes)
    store(sums, 0, q, EIGHT, odd + even + outer)


@scalar
def _product(series: np.ndarray, i: int, a: int, j: int, b: int, lanes: tuple[int, ...]) -> Any:
    return spread(load(series, i, a, lanes), EIGHT) * load(series, j, b, EIGHT)


@scalar
def _collect(f: Quadratic, sums: np.ndarray, order: int, series: np.ndarray, lanes: tuple[int, ...]) -> None:
    """Write the next coefficients of x: those of its rates, divided."""
    before, first, divisor = len(f.velocities), f.first, spread(order + 1.0, lanes)
    for m in range(len(first) - 1):
        rate = spread(0.0, lanes)
        for i in range(first[m], first[m + 1]):
            rate = rate + load(f.factors, 0, i, lanes) * load(sums, 0, f.sources[i], lanes)
        store(series, order + 1, before + m, lanes, rate / divisor)
