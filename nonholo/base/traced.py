"""Functions as JAX traces them; runs as JAX functions, with checkpoints, lost values and implicit derivatives.

A node is what is known of a state and of the step from it, as a named tuple of the caller's. It has `after`, what the
next step begins with, `y`, by which its root is guessed, the outcome `code`, and `cause`, a number that what made a
step fail has moved. A node stays at the last good one.
"""

import copy
import functools
import hashlib
import math
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple, Self, cast

import jax
import jax.numpy as jnp
import numpy as np
from jax.ad_checkpoint import checkpoint_name
from jax.experimental import io_callback
from jax.extend.core import jaxpr_as_fun

from nonholo.base.checks import is_traced
from nonholo.base.progress import number_is_over
from nonholo.base.types import Array, Float

_HUGE = 1e300
_MANY = 2048  # steps that take much longer than the question whether they are wanted
_SHORT = 64  # steps between saved states from which on reverse mode keeps checkpoints alone
_FEWEST, _MOST = 64, 10_000  # rows of a program that serves others, too: more take longer than to compile
FEW = 32  # states, each of which takes long
_ROOT = "root of a step"  # what a checkpoint keeps, so that no root is searched for twice


_OPAQUE = "custom_jvp_call", "custom_vjp_call", "stop_gradient", " at 0x"
"""Calls whose derivatives are not those of what they compute, and objects of this process."""


class TracedFunction:
    """A function with the numbers that it reads when this is made; equal are those of the same program.

    JAX traces it once. Arrays of other shapes, or in 32 bits, go to the function itself.

    Attributes:
        function: The function, whose present numbers are read.
        program: The function as JAX traces it, with copies of the arrays that it captures.
        constants: These arrays.
        shape: That of its value.
        is_of_one_step: Whether it was made for one time step.
    """

    def __init__(self, function: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
        functools.update_wrapper(cast(Any, self), function)  # with its attributes, such as `friction`
        self.__dict__.pop("digest", None)  # of a traced one that it wraps
        self.function, self.arguments = function, arguments
        with jax.enable_x64(True):  # of a function of its own: JAX remembers those that it has traced
            self.program = jax.make_jaxpr(jax.jit(lambda *x: _array(function(*x))))(*arguments)
        self.shape, self.is_of_one_step = self.program.out_avals[0].shape, getattr(function, "is_of_one_step", False)
        lists = [each.consts for each in _programs_in(self.program) if hasattr(each, "consts")]
        for each in lists:
            each[:] = map(copy.deepcopy, each)
        self.constants = [x for each in lists for x in each]

    def __call__(self, *arguments: Any) -> Any:
        """Return the value."""
        leaves = jax.tree.leaves(arguments)
        fits = [np.shape(x) for x in leaves] == [x.shape for x in self.program.in_avals]
        if not fits or jnp.result_type(float) != np.float64 or any(map(jnp.iscomplexobj, leaves)):
            return self.function(*arguments)
        leaves = (jnp.asarray(x, float) for x in leaves)
        return jaxpr_as_fun(self.program)(*leaves)[0]

    @property
    def primitives(self) -> set[str]:
        """The names of all operations that the program applies, with those of programs that it calls."""
        return {step.primitive.name for each in _programs_in(self.program) for step in each.eqns}

    def __repr__(self) -> str:
        return repr(self.function)

    def __eq__(self, other: object) -> bool:
        return self is other or (self.digest is not None and self.digest == getattr(other, "digest", None))

    def __hash__(self) -> int:
        return id(self) if self.digest is None else hash(self.digest)

    def __reduce__(self) -> Any:
        return TracedFunction, (self.function, self.arguments)

    def __deepcopy__(self, memo: Any) -> Self:
        return self

    @functools.cached_property
    def digest(self) -> str | None:
        """A digest of the program and its numbers; None of one that does not show all that it does."""
        text = str(self.program)
        if any(name in text for name in _OPAQUE) or any(map(is_traced, self.constants)):
            return None
        arrays = ((np.shape(x), str(np.asarray(x).dtype), np.asarray(x).tobytes()) for x in self.constants)
        return hashlib.sha256(repr((self.is_of_one_step, text, *arrays)).encode()).hexdigest()


def _programs_in(program: Any) -> Iterator[Any]:
    """Yield this program and those that it calls."""
    yield program
    for step in program.eqns:
        for inner in jax.tree.leaves(list(step.params.values())):
            if hasattr(inner, "eqns"):
                yield from _programs_in(inner)


def _array(value: Any) -> Any:
    """Return a value as an array; lists are refused, because the functions are called again without this help."""
    if isinstance(value, list | tuple):
        raise TypeError(f"it returned a {type(value).__name__}, jnp.array makes an array of it")
    return jnp.asarray(value)


class NodeState(NamedTuple):
    """The state that a policy sees at a node: the configuration, and the velocity of the momentum there."""

    configuration: Array
    body_velocity: Array


Step = Callable[..., Any]
"""From what a step begins with, a guess of its root and its control to the node."""
_Advance = Callable[[Any, tuple[Array | None, Array | None]], tuple[Any, None]]
"""From a node, a control and whether the step is taken at all to the node after it."""


@jax.custom_jvp
def nan_unless(value: Array, cause: Array, good: Array) -> Array:
    """Return a finite value where it is good, and NaN elsewhere.

    There the derivative is NaN along all that moves the value or the cause of the failure; cotangents that are zero
    stay zero, since what comes later depends on nothing there.
    """
    del cause
    return jnp.where(good, value, jnp.nan)


@nan_unless.defjvp
def _tangent(primals: tuple[Array, ...], tangents: tuple[Array, ...]) -> tuple[Array, Array]:
    (value, cause, good), (change, cause_change, _) = primals, tangents
    many, none = jnp.where(good, 1.0, _HUGE).astype(value.dtype), jnp.where(good, 1.0, 0.0).astype(value.dtype)
    change = change + jnp.where(good, 0.0, 1.0).astype(value.dtype) * cause_change
    overflown = change * many * many  # zero or infinite where it is not good, and so is the transpose
    return nan_unless(value, cause, good), overflown * none * many * many


def marked_rows(rows: Array, cause: Array, good: Array) -> Array:
    """Return the rows that are good, each with a cause, and NaN in the others."""
    return jax.vmap(nan_unless)(rows, jnp.broadcast_to(cause.reshape(-1, *[1] * (rows.ndim - 1)), rows.shape), good)


def implicit(
    residual: Callable[..., Array],
    root: Float[Array, "m"],
    at: tuple[Any, ...],
    changes: tuple[Any, ...],
    solve: Callable[[Array, Array], Array] = jnp.linalg.solve,
) -> tuple[Float[Array, "m"], Float[Array, "m"]]:
    """Return a root of residual(y, *at) as checkpoints keep it, and how it moves with all that the residual depends on.

    It is the derivative of the implicit function, which does not depend on the search.
    """
    y = checkpoint_name(root, _ROOT)
    _, change = jax.jvp(lambda *numbers: residual(y, *numbers), at, changes)
    return y, -solve(jax.jacfwd(residual)(y, *at), change[:, None])[:, 0]


def call_in_blocks(function: Callable[..., Any], size: int, *columns: np.ndarray) -> list[np.ndarray]:
    """Call a function of many states in blocks of one size, so that it is compiled once."""
    count = len(columns[0])
    missing = (-count % size) or (0 if count else size)
    rows = [np.concatenate([x, np.broadcast_to(x[-1] if count else 0.0, (missing, *x.shape[1:]))]) for x in columns]
    parts = [function(*(x[i : i + size] for x in rows)) for i in range(0, len(rows[0]), size)]
    return [np.concatenate(column)[:count] for column in zip(*parts, strict=True)]


def rows_above(count: int) -> int:
    """Return a number of rows, from a count to a quarter more or 64, so that few programs are compiled; of many itself.

    Example:
        >>> [rows_above(count) for count in (1, 64, 65, 1000, 10_001)]
        [64, 64, 128, 1024, 10001]
    """
    unit = max(_FEWEST, (1 << count.bit_length()) // 8) if count <= _MOST else 1
    return -(-count // unit) * unit


def rows_of(controls: Any, steps: int, size: int) -> Array | None:
    """Return the controls of steps, and none after the last one: zeros, to which a policy adds; None without any."""
    if controls is None:
        return None
    return jnp.zeros((steps + 1, size)) if callable(controls) else jnp.pad(controls, ((0, 1), (0, 0)))


def with_policy(
    controls: Any, time_step: Array, rows: Array | None
) -> tuple[Array | None, Callable[[Array, Callable[[], NodeState]], Array]]:
    """Return rows of nodes, and the control from a row and a state; rows are controls, to which a policy adds its own.

    Nothing acts over what follows the last step.
    """
    if not callable(controls) or rows is None:
        return rows, lambda row, _: row
    steps = jnp.arange(len(rows))
    rows = jnp.column_stack([time_step * steps, steps < len(rows) - 1, rows])

    def control(row: Array, state: Callable[[], NodeState]) -> Array:
        own = jnp.asarray(controls(row[0], state()), row.dtype)
        return row[2:] + jnp.where(row[1] > 0, own, 0.0)

    return rows, control


def run_nodes(step: Step, begin: Any, controls: Array | None, sizes: tuple[int, int], work: Array | None) -> Any:
    """Return the saved nodes after one whose `after` is the start.

    Args:
        step: The function that takes a step.
        begin: A node with the start.
        controls: A row for each step and one for what follows the last; None without.
        sizes: Number of steps, and of those between saved nodes.
        work: The number by which many steps ask whether they are still wanted; None where they are differentiated.
    """
    (steps, every), advance = sizes, _advance_of(step)

    def stretch(node: Any, rows: Array | None) -> tuple[Any, Any]:
        node = advance(node, (rows, None))[0] if every == 1 else _take_steps(advance, node, rows, every, work)
        return node, node

    if every == 1:
        return jax.lax.scan(stretch, begin, controls, length=steps + 1)[1]
    first, _ = advance(begin, (None if controls is None else controls[0], None))
    count = steps // every
    rows = None if controls is None else controls[1 : 1 + count * every].reshape(count, every, -1)
    _, later = jax.lax.scan(stretch, first, rows, length=count)
    return jax.tree.map(lambda one, more: jnp.concatenate([one[None], more]), first, later)


def _advance_of(step: Step) -> _Advance:
    """Return the step from node to node, which reverse mode computes once more but for its root."""

    def advance(node: Any, row: tuple[Array | None, Array | None]) -> tuple[Any, None]:
        control, acts = row
        following = step(*node.after, node.y, control)
        acts = jnp.asarray(True) if acts is None else acts
        code = jnp.where((node.code == 0) & acts, following.code, node.code)
        last = jax.tree.map(lambda new, old: jnp.where((code == 0) & acts, new, old), following, node)
        cause = jnp.where(node.code == code, node.cause, following.cause)
        return last._replace(code=code, cause=cause), None

    policy = jax.checkpoint_policies.save_only_these_names(_ROOT)
    return jax.checkpoint(advance, prevent_cse=False, policy=policy)


def _take_steps(advance: _Advance, node: Any, controls: Array | None, steps: int, work: Array | None) -> Any:
    """Take steps; many of them in stretches whose insides reverse mode computes once more."""
    if steps <= _SHORT:
        return jax.lax.scan(advance, node, (controls, None), length=steps)[0]
    each = math.isqrt(steps - 1) + 1
    number = -(-steps // each)
    acts = (jnp.arange(number * each) < steps).reshape(number, each)
    if controls is not None:
        controls = jnp.pad(controls, ((0, number * each - steps), (0, 0))).reshape(number, each, -1)
    stretch = jax.checkpoint(lambda node, rows: jax.lax.scan(advance, node, rows), prevent_cse=False)
    inner = _unless_over(stretch, work, each)
    whole = _unless_over(
        lambda node, rows: jax.lax.scan(lambda *part: (inner(*part)[0], None), node, rows), work, steps
    )
    return whole(node, (controls, acts))[0]


def _unless_over(take: _Advance, work: Array | None, steps: int) -> _Advance:
    """Return a function that takes many steps, or none where nobody wants them any more."""
    if work is None or steps < _MANY:
        return take

    def if_wanted(node: Any, rows: Any) -> tuple[Any, None]:
        over = io_callback(lambda number: np.bool_(number_is_over(number)), jax.ShapeDtypeStruct((), bool), work)
        return jax.lax.cond(over, lambda: (node, None), lambda: take(node, rows))

    return if_wanted
