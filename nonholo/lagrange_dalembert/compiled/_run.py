"""Runs by compiled equations; what these leave open goes to JAX, step by step."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from nonholo.kernels import (
    CoordinateBody,
    advance_coordinates,
    coordinate_body,
    each_root,
    each_row,
    set_out_coordinates,
)
from nonholo.lagrange_dalembert._precision import compiling
from nonholo.lagrange_dalembert.compiled._programs import programs, values

State = tuple[Any, Any, Any]
ROWS = 1024
"""Saved states of one call of JAX: one size of table, one compilation."""


def _body(system: Any, h: Any, q: Any, v: Any, *, at_node: bool = False) -> CoordinateBody | None:
    place, n = np.shape(q), len(v)
    code = programs(system, place, n, at_node=at_node)
    return code and coordinate_body(code[:3], code.settled, math.prod(place), n, system.constraints, float(h))


def set_out(definition: Callable[..., Any], system: Any, h: Any, q: Any, v: Any, p: Any) -> Any:
    """Return the state, the orientation and the outcome of the root next to v with a momentum.

    `definition(q, v, p)` finds it by JAX.
    """
    with compiling(system):
        body = _body(system, h, q, v)
        sign = set_out_coordinates(body, *map(np.array, (np.ravel(q), p, v))) if body else 0.0  # one type of arrays
        if body:
            advance_coordinates(body, np.empty(0), sign, 0, 0, 1, *3 * [np.empty((0, 0))])  # which compiles it now
    if body is None or sign == 0:
        return definition(q, v, p)
    first = body.root[: len(v)].copy()
    return (q, first, first), np.float64(sign), np.int64(0)


def advance(
    definition: Callable[..., Any], system: Any, h: Any, state: State, sign: Any, every: int, table: tuple[Any, ...]
) -> tuple[int, State, Any]:
    """Run `every` steps for each row of a table, into flat places, velocities and impulses.

    `definition(state, sign, rows, every)` does it by JAX. A step that is not trusted here it takes alone, so that the
    bits of an orbit do not depend on the rows that are kept.

    Returns:
        The good steps, those of the first `ROWS` rows at most, the state there and the outcome.
    """
    rows, body = len(table[0]), _body(system, h, *state[:2])
    if body is None:
        rows = min(rows, ROWS)
        good, after, code, columns = definition(state, sign, np.int64(rows), np.int64(every))
        begun = min(rows, int(good) // every + 1)
        for column, entries in zip(table, columns, strict=True):
            column[:begun] = entries[:begun].reshape(begun, column.shape[1])
        return int(good), after, code
    shape, ends = np.shape(state[0]), [body.place, body.place + body.velocity]

    def unpacked(flat: np.ndarray) -> State:
        q, v, before = np.split(flat, ends)
        return q.reshape(shape), v, before

    flat, total, code = np.concatenate([np.ravel(x) for x in state]), rows * every, np.int64(0)
    done = advance_coordinates(body, flat, float(sign), 0, total, every, *table)
    while done < total:
        _, after, code, (*_, impulses) = definition(unpacked(flat), sign, np.int64(1), np.int64(1))
        if code:
            break
        if done % every == 0:
            table[2][done // every] = impulses[0]
        flat = np.concatenate([np.ravel(x) for x in after])
        done = advance_coordinates(body, flat, float(sign), done + 1, total, every, *table)
    return int(done), unpacked(flat), code


def decoded(function: Callable[..., Any], system: Any, h: Any, q: np.ndarray, v: np.ndarray) -> list[Any] | None:
    """Return function(system, h, q, v) of each state, of a driven system with the velocity at the node besides.

    Returns:
        None where there are no formulas, or doubts.
    """
    nodes = _nodes(system, h, q, v) if system.is_driven and len(q) else ()
    if nodes is None:
        return None
    columns = [np.full(len(q), float(h)), q, v, *nodes]
    code = values(function, system, *(column.shape[1:] for column in columns))
    if code is None:
        return None
    sizes = [math.prod(shape) for shape in code.shapes]
    table = np.empty((len(q), sum(sizes) + 1))
    each_row(code.function, np.column_stack([x.reshape(len(q), math.prod(x.shape[1:])) for x in columns]), table)
    if np.any(table[:, -1] != 0):
        return None
    parts = np.split(table[:, :-1], np.cumsum(sizes)[:-1], axis=1)
    return [part.reshape(len(q), *shape) for part, shape in zip(parts, code.shapes, strict=True)]


def _nodes(system: Any, h: Any, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray] | None:
    """Return the velocities that belong to the momenta at the nodes; None where they are not trusted."""
    body, velocities = _body(system, h, q[0], v[0], at_node=True), np.empty_like(v)
    return (velocities,) if body and each_root(body, q, v, velocities) else None
