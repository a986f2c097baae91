"""The compiled loop over members: blocks of 32, in loops over the block that the compiler turns into vectors.

A block is one array of rows of 32 numbers, one number for each member: offsets between rows are then constants, so that
the compiler sees that rows do not overlap. Every member takes the steps that it would take alone, independent
of the others: its corrections end when it has converged, and a root that is not certain goes to the scalar
`principal`. Since arithmetic is strict, its bits are those that it has in `_driver`.
"""

from typing import Any, NamedTuple, TypeAlias

import numpy as np

from nonholo.base.compiled import njit, overload
from nonholo.kernels import _driver
from nonholo.kernels._scalar import COMPILED, Body, correction, increment, is_certain, move, principal, scalar, sqrt

Table: TypeAlias = np.ndarray | None
LANES = 32
_M, _K, _Y, _U, _V, _Q = 0, 64, 128, 192, 256, 320  # momenta, compensations, three charts (2 rows each), pose (4)
_N, _L, _W, _OPEN = 448, 512, 576, 640  # next momenta, compensations and chart; whether a member needs more work
_AXES, _ROW = 672, 1088  # the numbers of `MemberAxes` (13 rows); states as they are saved (8)
_SIZE = 1344
_LOOK = 1024  # steps between two looks at whether to stop


class MemberRows(NamedTuple):
    """The record of a run for each member; a member that fails leaves its later states as they are.

    Attributes:
        momenta: Canonical momenta, (members, states, 2).
        charts: Chart coordinates, (members, states, 2).
        poses: Poses, (members, states, 4); without states if they are not wanted.
        codes: Outcomes, zero before the run, (members,).
        counts: Numbers of good steps, (members,).
    """

    momenta: np.ndarray
    charts: np.ndarray
    poses: np.ndarray
    codes: np.ndarray
    counts: np.ndarray


class MemberAxes(NamedTuple):
    """How the record of members is taken to canonical numbers.

    Attributes:
        numbers: The factor of the kernel's momenta, the matrices to canonical momenta and charts row by row, and the
            compact pose of the canonical axes, (members, 13), or (1, 13) where those of all members are the same.
        has_rows: Whether the canonical rows are other ones than the kernel's.
        space: How many dimensions the space has in which the canonical frame is turned, 2 or 3; 0 where it is not.
    """

    numbers: np.ndarray
    has_rows: bool
    space: int


@scalar
def quaternion_product(pose: tuple[Any, ...], turn: tuple[Any, ...]) -> tuple[Any, Any, Any, Any]:
    """Return Hamilton's product of two quaternions, divided by its length, its scalar non-negative."""
    (a, b, c, d), (w, x, y, z) = pose, turn
    s, u = a * w - b * x - c * y - d * z, a * x + b * w + c * z - d * y
    v, t = a * y - b * z + c * w + d * x, a * z + b * y - c * x + d * w
    length, sign = sqrt(s * s + u * u + v * v + t * t), 1.0 - 2.0 * (s < 0)
    return s / length * sign, u / length * sign, v / length * sign, t / length * sign


@scalar
def motion_product(pose: tuple[Any, ...], turn: tuple[Any, ...]) -> tuple[Any, Any, Any, Any]:
    """Return (cos, sin, x, y) of the product of two motions, whose headings are normalized first."""
    (c, s, x, y), (d, t, u, v) = pose, turn
    length, other = sqrt(c * c + s * s), sqrt(d * d + t * t)
    c, s, d, t = c / length, s / length, d / other, t / other
    return c * d - s * t, s * d + c * t, c * u - s * v + x, s * u + c * v + y


@scalar
def canonical(state: tuple[Any, ...], axes: tuple[Any, ...], has_rows: bool, space: int) -> Any:
    """Return momenta, chart and pose of the kernel in canonical numbers: `axes` has those of `MemberAxes`."""
    m1, m2, y1, y2, q0, q1, q2, q3 = state
    unit, a, b, c, d, e, f, g, h, t0, t1, t2, t3 = axes
    m1, m2 = m1 / unit, m2 / unit
    if has_rows:
        m1, m2, y1, y2 = a * m1 + b * m2, c * m1 + d * m2, e * y1 + f * y2, g * y1 + h * y2
    if space == 3:
        q0, q1, q2, q3 = quaternion_product((q0, q1, q2, q3), (t0, t1, t2, t3))
    if space == 2:
        q0, q1, q2, q3 = motion_product((q0, q1, q2, q3), (t0, t1, t2, t3))
    return m1, m2, y1, y2, q0, q1, q2, q3


def member(p: Body, table: Table, j: int) -> Body:
    """Return the body of a member of a block, a column of the table of parameters; without a table that of all."""
    return p if table is None else type(p)(*table[j::LANES])


def _common(p: Any, table: Any, j: Any) -> Any:
    return p


def _reader(count: int) -> Any:
    """Return the function that reads this many fields of a member, one after another: numba knows how many."""
    if count == 1:
        return scalar(lambda table, j: (table[j],))
    before, row = _reader(count - 1), LANES * (count - 1)
    return scalar(lambda table, j: (*before(table, j), table[row + j]))


def _own(body: type[Body]) -> Any:
    read = _reader(len(body._fields))  # pyright: ignore

    def own(p: Any, table: Any, j: Any) -> Any:
        return body(*read(table, j))

    return own


def _is_none(kind: Any) -> bool:
    """Return whether a type of numba is that of None."""
    from numba import types

    return isinstance(kind, types.NoneType)


@overload(member, jit_options=COMPILED, strict=False)
def _compiled_member(p: Any, table: Any, j: Any) -> Any:
    if _is_none(table):
        return _common
    return _own(p.instance_class)


_own_axes = _reader(13)


def table_of(tables: Table, block: int) -> Table:
    """Return the table of a block."""
    return None if tables is None else tables[block]


@overload(table_of, jit_options=COMPILED, strict=False)
def _compiled_table_of(tables: Any, block: Any) -> Any:
    def none(tables: Any, block: Any) -> Any:
        return None

    def row(tables: Any, block: Any) -> Any:
        return tables[block]

    return none if _is_none(tables) else row


@njit(nogil=True, **COMPILED)
def _correct(p: Body, table: Table, s: np.ndarray) -> None:
    """Correct the guesses of the members that have not converged, until there are none or it takes too long."""
    s[_OPEN:_AXES] = 1.0
    for _ in range(_driver.CORRECTIONS):
        left = 0
        for j in range(LANES):
            y1, y2 = s[_W + j], s[_W + 32 + j]
            d1, d2 = correction(member(p, table, j), s[_N + j], s[_N + 32 + j], y1, y2)
            going = s[_OPEN + j] != 0.0
            y1 += d1 if going else 0.0
            y2 += d2 if going else 0.0
            s[_W + j], s[_W + 32 + j] = y1, y2
            further = going & ~_driver.converged(d1, d2, y1, y2)
            s[_OPEN + j] = 1.0 if further else 0.0
            left += further
        if left == 0:
            break


@njit(nogil=True, **COMPILED)
def _verify(p: Body, table: Table, s: np.ndarray) -> int:
    """Mark the members whose root is not certain, and return their number."""
    left = 0
    for j in range(LANES):
        sure = is_certain(member(p, table, j), s[_N + j], s[_N + 32 + j], s[_W + j], s[_W + 32 + j])
        further = (s[_OPEN + j] != 0.0) | ~sure
        s[_OPEN + j] = 1.0 if further else 0.0
        left += further
    return left


@njit(nogil=True, **COMPILED)
def _rescue(
    p: Body, table: Table, axes: MemberAxes, s: np.ndarray, first: int, good: int, every: int, rows: MemberRows
) -> None:
    """Find the marked roots from momentum zero; a member without one ends after its good steps.

    Lanes behind the last member, and those of members that have ended, are at rest: they have no root to find.
    """
    for j in range(min(LANES, len(rows.codes) - first)):
        if s[_OPEN + j] == 0.0 or rows.codes[first + j] != 0:
            continue
        code, s[_W + j], s[_W + 32 + j] = principal(member(p, table, j), s[_N + j], s[_N + 32 + j])
        if code != 0:
            if every == 0 and good >= 0:
                _turn(axes, s)
                _save(s, j, rows, first + j, 0)
            rows.codes[first + j], rows.counts[first + j] = code, max(good, 0)
            s[j:_AXES:LANES] = 0.0  # at rest, so that what is left of the member costs no corrections
            s[_Q + j] = 1.0


@njit(nogil=True, **COMPILED)
def _predict(p: Body, table: Table, s: np.ndarray) -> None:
    """Write the next momenta and guess the next charts."""
    for j in range(LANES):
        m1, m2, y1, y2 = s[_M + j], s[_M + 32 + j], s[_Y + j], s[_Y + 32 + j]
        d1, d2 = increment(member(p, table, j), m1, m2, y1, y2)
        s[_N + j], s[_L + j] = _driver.kahan_sum(m1, s[_K + j], d1, _driver.SETTLED * abs(m2))
        s[_N + 32 + j], s[_L + 32 + j] = _driver.kahan_sum(m2, s[_K + 32 + j], d2, _driver.SETTLED * abs(m1))
    for j in range(2 * LANES):
        s[_W + j] = 3 * (s[_Y + j] - s[_U + j]) + s[_V + j]


@njit(nogil=True, **COMPILED)
def _accept(p: Body, table: Table, s: np.ndarray, has_poses: bool) -> None:
    """Move on to the next momenta and charts, and with them the poses."""
    if has_poses:
        for j in range(LANES):
            own, y1, y2 = member(p, table, j), s[_Y + j], s[_Y + 32 + j]
            q0, q1, q2, q3 = move(own, y1, y2, s[_Q + j], s[_Q + 32 + j], s[_Q + 64 + j], s[_Q + 96 + j])
            s[_Q + j], s[_Q + 32 + j], s[_Q + 64 + j], s[_Q + 96 + j] = q0, q1, q2, q3
    for j in range(2 * LANES):
        s[_M + j], s[_K + j] = s[_N + j], s[_L + j]
        s[_V + j], s[_U + j], s[_Y + j] = s[_U + j], s[_Y + j], s[_W + j]


@njit(nogil=True, **COMPILED)
def _turn(axes: MemberAxes, s: np.ndarray) -> None:
    """Take the states of a block to canonical numbers."""
    numbers = s[_AXES:_ROW]
    for j in range(LANES):
        m1, m2, y1, y2 = s[_M + j], s[_M + 32 + j], s[_Y + j], s[_Y + 32 + j]
        state = m1, m2, y1, y2, s[_Q + j], s[_Q + 32 + j], s[_Q + 64 + j], s[_Q + 96 + j]
        own = _own_axes(numbers, j)
        m1, m2, y1, y2, q0, q1, q2, q3 = canonical(state, own, axes.has_rows, axes.space)
        s[_ROW + j], s[_ROW + 32 + j], s[_ROW + 64 + j], s[_ROW + 96 + j] = m1, m2, y1, y2
        s[_ROW + 128 + j], s[_ROW + 160 + j], s[_ROW + 192 + j], s[_ROW + 224 + j] = q0, q1, q2, q3


@njit(nogil=True, **COMPILED)
def _save(s: np.ndarray, j: int, rows: MemberRows, i: int, state: int) -> None:
    """Write the state of a member of the block to a member of the rows."""
    rows.momenta[i, state, 0], rows.momenta[i, state, 1] = s[_ROW + j], s[_ROW + 32 + j]
    rows.charts[i, state, 0], rows.charts[i, state, 1] = s[_ROW + 64 + j], s[_ROW + 96 + j]
    if rows.poses.shape[1]:
        for q in range(4):
            rows.poses[i, state, q] = s[_ROW + 128 + 32 * q + j]


@njit(nogil=True, **COMPILED)
def _save_good(axes: MemberAxes, s: np.ndarray, rows: MemberRows, first: int, state: int) -> None:
    """Write the states of the members of the block that have not failed."""
    _turn(axes, s)
    for j in range(min(LANES, len(rows.codes) - first)):
        if rows.codes[first + j] == 0:
            _save(s, j, rows, first + j, state)


@njit(nogil=True, **COMPILED)
def _begin(p: Body, table: Table, axes: np.ndarray, momenta: np.ndarray, poses: np.ndarray, s: np.ndarray) -> int:
    """Fill a block, at rest where there are no members, and correct the first roots; return how many are uncertain."""
    s[:] = 0.0
    s[_Q : _Q + LANES] = 1.0
    for j in range(LANES):
        own = j if j < len(momenta) and len(axes) > 1 else 0
        for k in range(axes.shape[1]):
            s[_AXES + 32 * k + j] = axes[own, k]
    for j in range(len(momenta)):
        s[_N + j], s[_N + 32 + j] = momenta[j, 0], momenta[j, 1]
        for q in range(4):
            s[_Q + 32 * q + j] = poses[j, q]
    _correct(p, table, s)
    return _verify(p, table, s)


@njit(nogil=True, **COMPILED)
def _run_block(
    p: Body,
    table: Table,
    axes: MemberAxes,
    s: np.ndarray,
    first: int,
    steps: int,
    every: int,
    rows: MemberRows,
    stop: np.ndarray,
) -> None:
    """Take all steps of a block whose first roots are found, or those until it shall stop."""
    for k in range(2 * LANES):
        s[_M + k] = s[_N + k]
        s[_Y + k], s[_U + k], s[_V + k] = s[_W + k], s[_W + k], s[_W + k]
    if every > 0:
        _save_good(axes, s, rows, first, 0)
    for count in range(1, steps + 1):
        _predict(p, table, s)
        _correct(p, table, s)
        if _verify(p, table, s) > 0:
            _rescue(p, table, axes, s, first, count - 1, every, rows)
        _accept(p, table, s, rows.poses.shape[1] > 0)
        if every > 0 and count % every == 0:
            _save_good(axes, s, rows, first, count // every)
        if count % _LOOK == 0 and stop[0]:
            return
    _finish(axes, s, first, steps, every, rows)


@njit(nogil=True, **COMPILED)
def _finish(axes: MemberAxes, s: np.ndarray, first: int, steps: int, every: int, rows: MemberRows) -> None:
    """Write the last states where no others are, and how many steps the members took that have not failed."""
    if every == 0:
        _save_good(axes, s, rows, first, 0)
    for i in range(first, min(first + LANES, len(rows.codes))):
        if rows.codes[i] == 0:
            rows.counts[i] = steps


@njit(nogil=True, **COMPILED)
def advance_members(
    p: Body,
    tables: Table,
    axes: MemberAxes,
    momenta: np.ndarray,
    poses: np.ndarray,
    steps: int,
    every: int,
    rows: MemberRows,
    stop: np.ndarray,
) -> None:
    """Take steps from scaled momenta (members, 2) and poses (members, 4) into canonical rows, in one thread.

    Args:
        p: The body of all members; with tables only its kind counts.
        tables: Parameters by block, (blocks, 32 fields), see `tables_of`; None if all members are one body.
        axes: How rows are taken to canonical numbers.
        momenta: First momenta.
        poses: First poses.
        steps: Number of steps.
        every: Save the first state and each `every`-th one after it; with 0 only the last one of each member.
        rows: Where to.
        stop: One truth value, that another thread may set: then the work ends, and the rows are good for nothing.
    """
    s = np.empty(_SIZE)
    for block in range((len(momenta) + LANES - 1) // LANES):
        first = block * LANES
        table = table_of(tables, block)
        part = slice(first, min(first + LANES, len(momenta)))
        own = axes.numbers[part] if len(axes.numbers) > 1 else axes.numbers
        if _begin(p, table, own, momenta[part], poses[part], s) > 0:
            _rescue(p, table, axes, s, first, -1, every, rows)
        _run_block(p, table, axes, s, first, steps, every, rows, stop)
        if stop[0]:
            return


def tables_of(fields: np.ndarray) -> np.ndarray:
    """Return the parameters of bodies (fields, members) block by block; the last member fills up the last block."""
    count, members = fields.shape
    columns = np.pad(fields, ((0, 0), (0, -members % LANES)), mode="edge")
    return np.ascontiguousarray(columns.reshape(count, -1, LANES).swapaxes(0, 1)).reshape(-1, count * LANES)
