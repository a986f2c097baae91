"""Orbits as JAX functions: steps between nodes, long runs with checkpoints, and what saved nodes are.

A node is the state before a step, with the chart of the step and the state after it. Bodies with a closed form run in
the scalars of their kernel, from the identity; other ones in momenta along the constraint and matrices of poses.
"""

import dataclasses
import math
from collections.abc import Callable
from typing import Any, NamedTuple, cast

import jax
import jax.numpy as jnp
import numpy as np

from nonholo import kernels
from nonholo.base.results import Outcome
from nonholo.base.types import Array, Float
from nonholo.discrete._composition import weights
from nonholo.discrete._scheme import Scheme
from nonholo.discrete.definition._marks import marked
from nonholo.discrete.definition._principal import ON_LOCUS, closed_step_of, kernel_root, principal_of
from nonholo.discrete.definition._root import ROOT
from nonholo.discrete.definition._step import displaced, momentum_of, restricted
from nonholo.discrete.routes import ScalarStep
from nonholo.groups import AbstractMatrixGroup

_SHORT = 64  # steps between saved states from which on reverse mode keeps checkpoints alone


class Rollout(NamedTuple):
    """The states of a rollout; arrays as those of an `Orbit`, K = 1 + steps // save_every.

    Attributes:
        time: Times of the states, shape (K,).
        restricted_momentum: Momenta along the rows of the constraint subspace, shape (K, k).
        momentum: Body momenta P_k, shape (K, dim); under controls those of the nodes.
        displacement: W_k, shape (K, N, N).
        configuration: g_k, shape (K, N, N).
        energy: Reduced constrained energies, shape (K,).
        outcome: An `Outcome` as an integer array: the first one that is not successful. From that state on all other
            fields are NaN, and so are their derivatives.
    """

    time: Float[Array, "K"]
    restricted_momentum: Float[Array, "K k"]
    momentum: Float[Array, "K dim"]
    displacement: Float[Array, "K N N"]
    configuration: Float[Array, "K N N"]
    energy: Float[Array, "K"]
    outcome: Array


class _Node(NamedTuple):
    """Momenta and pose of a state, the chart of its step, what follows, and the outcome; it stays at the last good one.

    The cause is a number that what made a step fail has moved.
    """

    m: Array
    g: Array
    y: Array
    after: tuple[Array, Array]
    code: Array
    cause: Array


_Step = Callable[[Array, Array, Array | None, Array | None], _Node]
"""From momenta, pose, a guess of the chart and half an impulse to the node."""
_Advance = Callable[[_Node, tuple[Array | None, Array | None]], tuple[_Node, None]]
"""From a node, half an impulse and whether the step is taken at all to the node after it."""


def rolled(
    discrete: Scheme,
    closed: ScalarStep | None,
    start: tuple[str, Array, Array],
    controls: Array | None,
    sizes: tuple[int, int],
) -> Rollout:
    """Return the orbit from a start, which has a name, a value and a pose; `sizes` are `steps` and `save_every`."""
    (name, value, g), (steps, every), system = start, sizes, discrete.system
    r, g = _along(discrete, name, jnp.asarray(value), jnp.asarray(g)), jnp.asarray(g)
    impulses = kicks = None
    if controls is not None:
        nothing = jnp.zeros((1, system.group.dim), r.dtype)
        impulses = kicks = jnp.concatenate([controls * discrete.time_step / 2, nothing])
    if closed is not None and discrete.order == 2:
        step, C, at = _closed_step(discrete, closed, g)
        kicks = None if kicks is None else kicks @ (C @ system.constraint_subspace).T
        start = C @ r, jnp.asarray([1.0, 0.0, 0.0, 0.0], r.dtype), 2
    else:
        step = _composed_step(discrete, closed) if discrete.order > 2 else _matrix_step(discrete)
        start, at = (r, g, len(discrete.variety.chart)), _as_it_is
    nodes = _run(step, start, kicks, sizes)
    given = value if name == "momentum" and value.shape == (system.group.dim,) else None
    time = discrete.time_step * every * jnp.arange(1 + steps // every)
    impulses = None if impulses is None else impulses[::every]
    return _decoded(discrete, nodes, jax.vmap(at)(nodes), given, impulses, time)


def _as_it_is(node: _Node) -> tuple[Array, ...]:
    return node.m, node.y, node.g, node.after[1]


def _along(discrete: Scheme, name: str, value: Array, g: Array) -> Array:
    """Return the momenta along the constraint at the start."""
    system = discrete.system
    if name == "restricted_velocity":
        return system.restricted_momentum(value, g)
    if name == "momentum" and value.shape == (system.rank,):
        return value
    return system.restrict_at(jnp.asarray(system.inertia_operator) @ value if name == "body_velocity" else value, g)


def _closed_step(discrete: Scheme, closed: ScalarStep, g: Array) -> tuple[_Step, Array, Callable[[_Node], Any]]:
    """Return the step of a kernel, the matrix of its momenta, and what its nodes are in the user's frame."""
    (body, C, rows), system = closed_step_of(discrete, closed), discrete.system
    group, frame = system.group, jnp.asarray(system.form_frame)

    def step(m: Array, q: Array, guess: Array | None, kick: Array | None) -> _Node:
        kick = jnp.zeros_like(m) if kick is None else kick
        pushed = m + kick
        y, code = kernel_root(body, pushed, guess)
        after = pushed + jnp.stack(kernels.increment(body, *pushed, *y)) + kick
        return _Node(m, q, y, (after, jnp.stack(kernels.move(body, *y, *q))), code, jnp.sum(y))

    def at(node: _Node) -> tuple[Array, ...]:
        pose = g @ frame @ group.matrix_from_pose(node.g) @ group.inverse(frame)
        return jnp.linalg.solve(C, node.m), node.y if rows is None else node.y @ rows, pose, pose

    return step, C, at


def _matrix_step(discrete: Scheme) -> _Step:
    """Return the step by the matrix equations."""

    def step(r: Array, g: Array, guess: Array | None, kick: Array | None) -> _Node:
        del guess  # there is no certificate
        pushed = r if kick is None else r + restricted(discrete, kick, g)
        y, code = principal_of(discrete, None, pushed, g)
        following, after = _moved(discrete, pushed, y, g)
        following = following if kick is None else following + restricted(discrete, kick, after)
        return _Node(r, g, y, (following, after), code, jnp.sum(y))

    return step


def _composed_step(discrete: Scheme, closed: ScalarStep | None) -> _Step:
    """Return a step of higher order: the step of order 2 of several lengths, one after the other."""

    def substep(carry: tuple[Array, Array, Array], weight: Array) -> tuple[tuple[Array, Array, Array], Array]:
        r, g, code = carry
        part: Any = dataclasses.replace(cast(Any, discrete), time_step=weight * discrete.time_step, order=2)
        y, found = principal_of(part, closed and closed._replace(scale=weight * closed.scale), r, g)
        good, code = (code == 0) & (found == 0), jnp.where(code == 0, found, code)
        ahead, after = _moved(part, r, y, g)
        return (jnp.where(good, ahead, r), jnp.where(good, after, g), code), y

    def step(r: Array, g: Array, guess: Array | None, kick: Array | None) -> _Node:
        del guess, kick
        begun = (r, g, jnp.zeros((), jnp.result_type(int)))
        (*after, code), charts = jax.lax.scan(substep, begun, jnp.asarray(weights(discrete.order), r.dtype))
        return _Node(r, g, charts[0], (after[0], after[1]), code, jnp.sum(charts))

    return step


def _moved(discrete: Scheme, r: Array, y: Array, g: Array) -> tuple[Array, Array]:
    """Return momenta along the constraint and pose after a displacement that has momenta r along it.

    The momenta change by the difference of two, in which the error of the root is not seen.
    """
    system = discrete.system
    after = _rectified(system.group, system.moved(g, displaced(discrete, y)))
    arriving = restricted(discrete, momentum_of(discrete, y, g, "right"), after)
    return r + (arriving - restricted(discrete, momentum_of(discrete, y, g, "left"), g)), after


def _rectified(group: AbstractMatrixGroup, g: Array) -> Array:
    """Return a pose whose rounding errors across a group of isometries are squared: R (3 - R* R) / 2."""
    if not group.has_skew_part:
        return g
    n = group.size if group.form is not None or np.any(group.basis[:, -1]) else group.size - 1
    R = g[:n, :n]
    square = group.form_adjoint(g) @ g if n == group.size else R.T @ R
    return g.at[:n, :n].set(R @ (3 * jnp.eye(n, dtype=g.dtype) - square) / 2)


def _run(step: _Step, start: tuple[Array, Array, int], kicks: Array | None, sizes: tuple[int, int]) -> _Node:
    """Return the saved nodes from momenta, a pose and the size of a chart."""
    (m, g, size), (steps, every), advance = start, sizes, _advance_of(step)
    nothing = jnp.zeros(size, m.dtype)
    begin = _Node(m, g, nothing, (m, g), jnp.zeros((), jnp.result_type(int)), jnp.sum(nothing))

    def stretch(node: _Node, pushes: Array | None) -> tuple[_Node, _Node]:
        node = advance(node, (pushes, None))[0] if every == 1 else _advanced(advance, node, pushes, every)
        return node, node

    if every == 1:
        return jax.lax.scan(stretch, begin, kicks, length=steps + 1)[1]
    first, _ = advance(begin, (None if kicks is None else kicks[0], None))
    saved = steps // every
    pushes = None if kicks is None else kicks[1 : 1 + saved * every].reshape(saved, every, -1)
    _, later = jax.lax.scan(stretch, first, pushes, length=saved)
    return jax.tree.map(lambda one, more: jnp.concatenate([one[None], more]), first, later)


def _advance_of(step: _Step) -> _Advance:
    """Return the step from node to node, which reverse mode computes once more but for its root."""

    def advance(node: _Node, row: tuple[Array | None, Array | None]) -> tuple[_Node, None]:
        kick, acts = row
        found = step(*node.after, node.y, kick)
        acts = jnp.asarray(True) if acts is None else acts
        code = jnp.where((node.code == 0) & acts, found.code, node.code)
        kept = jax.tree.map(lambda new, old: jnp.where((code == 0) & acts, new, old), found, node)
        cause = jnp.where(node.code == code, node.cause, found.cause)
        return kept._replace(code=code, cause=cause), None

    kept = jax.checkpoint_policies.save_only_these_names(ROOT)
    return jax.checkpoint(advance, prevent_cse=False, policy=kept)


def _advanced(advance: _Advance, node: _Node, kicks: Array | None, steps: int) -> _Node:
    """Take steps; many of them in stretches whose insides reverse mode computes once more."""
    if steps <= _SHORT:
        return jax.lax.scan(advance, node, (kicks, None), length=steps)[0]
    each = math.isqrt(steps - 1) + 1
    number = -(-steps // each)
    acts = (jnp.arange(number * each) < steps).reshape(number, each)
    if kicks is not None:
        kicks = jnp.pad(kicks, ((0, number * each - steps), (0, 0))).reshape(number, each, -1)
    stretch = jax.checkpoint(lambda node, rows: jax.lax.scan(advance, node, rows), prevent_cse=False)
    return jax.lax.scan(lambda node, rows: (stretch(node, rows)[0], None), node, (kicks, acts))[0]


def _decoded(
    discrete: Scheme,
    nodes: _Node,
    states: tuple[Array, ...],
    momentum: Array | None,
    impulses: Array | None,
    time: Array,
) -> Rollout:
    """Return what saved momenta, charts, poses and those that follow are, from the first one without a step on NaN.

    A full momentum of the start must be that of the first node.
    """
    system, first = discrete.system, cast(Any, discrete)
    if discrete.order > 2:
        first = dataclasses.replace(first, time_step=float(weights(discrete.order)[0]) * discrete.time_step, order=2)

    def at(r: Array, y: Array, g: Array, after: Array) -> tuple[Array, ...]:
        whole = discrete.order > 2 or system.is_spatial
        W = system.group.inverse(g) @ after if whole else displaced(discrete, y)
        return r, momentum_of(first, y, g, "left"), W, g, system.constrained_energy(r, g)

    (r, P, W, g, energy), code = jax.vmap(at)(*states), nodes.code
    P = P if impulses is None else P - impulses
    if momentum is not None:
        missed = jnp.sum((P[0] - momentum) ** 2) > ON_LOCUS**2 * jnp.sum(momentum**2)
        code = jnp.where((code == 0) & missed, int(Outcome.off_momentum_locus), code)

    def marked_rows(rows: Array) -> Array:
        return jax.vmap(marked)(
            rows, jnp.broadcast_to(nodes.cause.reshape(-1, *[1] * (rows.ndim - 1)), rows.shape), code == 0
        )

    return Rollout(time, *map(marked_rows, (r, P, W, g, energy)), outcome=code[-1])
