"""Orbits as JAX functions: steps between nodes, long runs with checkpoints, and the equations of a step.

A node is the state before a step, with the chart of the step and the state after it. Bodies with a closed form run in
the scalars of their kernel, from the identity; other ones in momenta along the constraint and matrices of poses. In
`step_residual` nothing is solved for: momenta, chart, pose and force are unknown at once.
"""

import functools
from collections.abc import Callable
from typing import Any, NamedTuple, cast

import jax
import jax.numpy as jnp
import numpy as np

from nonholo import kernels
from nonholo.base.results import Outcome, as_table
from nonholo.base.traced import NodeState, implicit, marked_rows, rows_of, run_nodes, with_policy
from nonholo.base.types import Array, Float
from nonholo.discrete._scheme import Scheme, free_rows, weights
from nonholo.discrete.definition import _step
from nonholo.discrete.definition._step import compile_double
from nonholo.discrete.routes import ScalarStep
from nonholo.systems import Forced

_CLOSE, _MOST = 1e-9, 20  # of the last correction before two that count; corrections


class Rollout(NamedTuple):
    """The states of a rollout; arrays as those of an `Orbit`, K = 1 + steps // save_every.

    Attributes:
        time: Times of the states, shape (K,).
        restricted_momentum: Momenta along the rows of the constraint subspace, shape (K, k).
        momentum: Body momenta P_k, shape (K, dim); under controls those of the nodes.
        displacement: W_k, shape (K, N, N).
        configuration: g_k, shape (K, N, N).
        energy: Reduced constrained energies, shape (K,).
        controls: Body covectors u_k of the step from each state, of controls or a policy, with the table of the
            system, shape (K, dim); after the last step that of the table alone.
        outcome: An `Outcome` as an integer array: the first one that is not successful. From that state on all other
            fields are NaN, and so are their derivatives.
    """

    time: Float[Array, "K"]
    restricted_momentum: Float[Array, "K k"]
    momentum: Float[Array, "K dim"]
    displacement: Float[Array, "K N N"]
    configuration: Float[Array, "K N N"]
    energy: Float[Array, "K"]
    controls: Float[Array, "K dim"]
    outcome: Array
    __repr__ = as_table


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
    control: Array | None = None


_Step = Callable[[Array, Array, Array | None, Array | None], _Node]
"""From momenta, pose, a guess of the chart and the control of the step to the node."""
_Pair = tuple[Array, Array]
_State = tuple[Array, Array, Any]
"""Momenta along the constraint, a pose and the body covector of the step."""
_Impulse = Callable[[Array, Array, Array], Array]
"""From momenta along the constraint, pose and control to half the impulse of a step, a body covector."""
_Forces = tuple[_Impulse | None, Forced | None]
"""Kicks at the nodes, half the impulse of a step, or forces that act by equal half impulses at the displacement."""


def roll_out(
    sizes: tuple[int, int],
    controls: Any,
    start: tuple[str, Array, Array],
    discrete: Scheme,
    scalar: ScalarStep | None,
    forced: Forced | None,
    work: Array | None = None,
) -> Rollout:
    """Return the orbit from a start, which has a name, a value and a pose, with the outcome up to each state.

    The discretization is that of the free system, `forced` the system with its forces. Controls are a row for each
    step, or a policy. `work` is the number by which
    many steps ask whether they are still wanted; None where they are differentiated.
    """
    (name, value, g), (steps, every) = start, sizes
    r, g = _along(discrete, name, jnp.asarray(value), jnp.asarray(g)), jnp.asarray(g)
    forces, rows = forces_of(discrete, forced, controls, steps)
    if forces[1] is None and scalar is not None and discrete.order == 2:
        step, C, at = _closed_step(discrete, scalar, g, forces[0])
        m, pose, size = C @ r, jnp.asarray([1.0, 0.0, 0.0, 0.0], r.dtype), 2
    else:
        step, at = _in_stages(discrete, scalar, forces), lambda node: (node.m, node.y, node.g, node.after[1])
        m, pose, size = r, g, len(discrete.variety.chart)
    rows, control_of = with_policy(controls, discrete.time_step, rows)
    code, nothing = jnp.zeros((), jnp.result_type(int)), jnp.zeros(size, m.dtype)
    none = None if rows is None else jnp.zeros(discrete.system.group.dim, m.dtype)
    begin = _Node(m, pose, nothing, (m, pose), code, jnp.sum(nothing), none)

    def closed_step(m: Array, g: Array, guess: Array | None, row: Array | None) -> _Node:
        def now() -> NodeState:  # what a policy sees
            r, _, place, _ = at(begin._replace(m=m, g=g))
            return NodeState(place, discrete.system.directions(place) @ discrete.system.restricted_velocity(r, place))

        control = None if row is None else control_of(row, now)
        return step(m, g, guess, control)._replace(control=control)

    nodes = run_nodes(closed_step, begin, rows, sizes, work)
    demand = value if name == "momentum" and value.shape == (discrete.system.group.dim,) else None
    time = discrete.time_step * every * jnp.arange(1 + steps // every)
    states = jax.vmap(at)(nodes)
    pushes = _half_impulses(discrete, forces, states, nodes.control)
    potential = jnp.zeros(()) if forced is None else forced.potential_energy(states[2])
    return _decode(discrete, nodes, states, demand, (pushes, potential), time)


def _half_impulses(discrete: Scheme, forces: _Forces, states: tuple[Array, ...], rows: Array | None) -> Array:
    """Return the half impulses at saved nodes."""
    impulse, balance = forces
    if balance is not None:
        return jax.vmap(functools.partial(half_impulse, discrete.first_part, balance))(states[1], states[2], rows)
    return jnp.zeros(()) if impulse is None else jax.vmap(impulse)(states[0], states[2], rows)


def forces_of(discrete: Scheme, forced: Forced | None, controls: Any, steps: int) -> tuple[_Forces, Any]:
    """Return the forces around steps of a free discretization, and the body covectors of steps; None where free.

    Nothing of them acts over what follows the last step.
    """
    half, rows = discrete.time_step / 2, rows_of(controls, steps, discrete.system.group.dim)
    if forced is None:
        return (None if rows is None else (lambda _r, _g, row: half * row), None), rows
    rows = (0.0 if rows is None else rows) + forced.rows(np.arange(steps + 1))
    if forced.is_balanced(cast(Any, discrete).conserves_energy, discrete.order > 2):
        return (None, forced), rows
    kick = None if forced.is_spatial else forced.kick_at(forced.group.identity, half)

    def impulse(r: Array, g: Array, row: Array) -> Array:
        return forced.impulse(r, forced.potential_force(g) + row, half, kick or forced.kick_at(g, half))

    return (impulse, None), rows


def half_impulse(discrete: Scheme, forced: Forced, y: Array, g: Array, row: Array) -> Float[Array, "dim"]:
    """Return half the impulse of a balanced step by the chart of its displacement, a body covector."""
    h = discrete.time_step
    return h / 2 * forced.mean_force(g, _step.displacement_of(discrete, y), h, row)


def _along(discrete: Scheme, name: str, value: Array, g: Array) -> Array:
    """Return the momenta along the constraint at the start."""
    system = discrete.system
    if name == "restricted_velocity":
        return system.restricted_momentum(value, g)
    if name == "momentum" and value.shape == (system.rank,):
        return value
    return system.restrict_at(jnp.asarray(system.inertia_operator) @ value if name == "body_velocity" else value, g)


def _closed_step(
    discrete: Scheme, scalar: ScalarStep, g: Array, impulse: _Impulse | None
) -> tuple[_Step, Array, Callable[[_Node], Any]]:
    """Return the step of a kernel, the matrix of its momenta, and what its nodes are in the user's frame."""
    body, system, C = scalar.body, discrete.system, jnp.asarray(scalar.momentum_map(discrete.system))
    group, frame, inverse = system.group, jnp.asarray(system.form_frame), jnp.linalg.inv(C)

    def pose(q: Array) -> Array:
        return g @ frame @ group.matrix_from_pose(q) @ group.inverse(frame)

    def kick(m: Array, q: Array, row: Array | None) -> Array:
        return m if impulse is None else m + C @ (system.constraint_subspace @ impulse(inverse @ m, pose(q), row))

    def step(m: Array, q: Array, guess: Array | None, row: Array | None) -> _Node:
        m_half = kick(m, q, row)
        y, code = _step.kernel_root(body, m_half, guess)
        after = jnp.stack(kernels.move(body, *y, *q))
        arriving = kick(m_half + jnp.stack(kernels.increment(body, *m_half, *y)), after, row)
        return _Node(m, q, y, (arriving, after), code, jnp.sum(y))

    def at(node: _Node) -> tuple[Array, ...]:
        place = pose(node.g)
        return jnp.linalg.solve(C, node.m), scalar.canonical_chart(node.y), place, place

    return step, C, at


def _arrival(part: Any, forces: _Forces, state: _State, y: Array) -> tuple[Array, Array, Array]:
    """Return what vanishes at the chart of the step of order 2 from a state, and momenta and pose after it."""
    (impulse, balance), (r, g, row), push = forces, state, 0.0
    if balance is not None:
        push = _step.restricted(part, half_impulse(part, balance, y, g, row), g)
    elif impulse is not None:
        push = _step.restricted(part, impulse(r, g, row), g)
    gap, (ahead, after) = _step.equations_at(part, g)(y, r + push), _move(part, r + push, y, g)
    if impulse is not None:
        push = _step.restricted(part, impulse(ahead, after, row), after)
    return gap, ahead + push, after


def _in_stages(discrete: Scheme, scalar: ScalarStep | None, forces: _Forces) -> _Step:
    """Return the step of one or several lengths."""

    def stage(carry: tuple[Any, ...], weight: Array) -> tuple[tuple[Any, ...], Array]:
        r, g, code, row = carry
        part, own = discrete.part(weight), scalar and scalar._replace(scale=weight * scalar.scale)
        y, outcome, ahead, after = _stage(forces, part, own, (r, g, row))
        good, code = (code == 0) & (outcome == 0), jnp.where(code == 0, outcome, code)
        return (jnp.where(good, ahead, r), jnp.where(good, after, g), code, row), y

    def step(r: Array, g: Array, guess: Array | None, row: Array | None) -> _Node:
        del guess
        begin, stages = (r, g, jnp.zeros((), jnp.result_type(int)), row), weights(discrete.order)
        (r_next, after, code, _), charts = jax.lax.scan(stage, begin, jnp.asarray(stages, r.dtype))
        return _Node(r, g, charts[0], (r_next, after), code, jnp.sum(charts))

    return step


def _stage(forces: _Forces, part: Any, scalar: ScalarStep | None, state: _State) -> tuple[Array, ...]:
    """Take the step of order 2, under kicks at its nodes, balanced forces or none.

    Return its chart and outcome, and momenta and pose after it.
    """
    (impulse, balance), (r, g, row) = forces, state
    if balance is None:
        kick = 0.0 if impulse is None else _step.restricted(part, impulse(r, g, row), g)
        y, outcome = _step.principal_of(part, scalar, r + kick, g)
    else:
        y, outcome = _balanced_root(balance, part, scalar, state)
    return y, outcome, *_arrival(part, forces, state, y)[1:]


def _balanced_root(forced: Forced, part: Any, scalar: ScalarStep | None, state: _State) -> tuple[Array, Array]:
    """Return the chart over momenta r + j whose half impulses j are those at its displacement, and the outcome.

    Newton's method from the free displacement, which derivatives do not see.
    """
    problem = part, forced, state
    constants, still = jax.tree.map(jax.lax.stop_gradient, (problem, scalar))

    def better(carry: tuple[Array, Array, Array]) -> tuple[Array, Array, Array]:
        y, _, count = carry
        change = jnp.linalg.solve(jax.jacfwd(_balanced_gap)(y, *constants), _balanced_gap(y, *constants))
        return y - change, jnp.max(jnp.abs(change)), count + 1

    free, code = _step.principal_of(constants[0], still, constants[2][0], constants[2][1])
    begin = jnp.where(code == 0, free, 0 * free), jnp.asarray(jnp.inf, free.dtype), 0
    y, last, _ = jax.lax.while_loop(lambda c: (c[1] > _CLOSE) & (c[2] < _MOST), better, begin)
    code = jnp.where((code == 0) & ~(last <= _CLOSE), int(Outcome.not_converged), code)
    return _correct(problem, jnp.where(code == 0, y, 0.0)), code


@jax.custom_jvp
def _correct(problem: tuple[Any, Forced, _State], y: Array) -> Array:
    """Return the root next to a chart, with the derivatives of the implicit function.

    Where JAX forgets the rule, as in reverse mode of reverse mode, the corrections have two more of them.
    """
    slope = jax.jacfwd(_balanced_gap)(y, *problem)
    for _ in range(2):
        y = y - jnp.linalg.solve(slope, _balanced_gap(y, *problem))
    return y


@_correct.defjvp
def _implicit(primals: Any, tangents: Any) -> tuple[Array, Array]:
    return implicit(_balanced_gap, _correct(*primals), primals[0], tangents[0])


def _balanced_gap(y: Array, part: Any, forced: Forced, state: _State) -> Array:
    """Return what vanishes at the chart of a step under forces at its displacement."""
    return _arrival(part, (None, forced), state, y)[0]


def _move(discrete: Scheme, r: Array, y: Array, g: Array) -> tuple[Array, Array]:
    """Return momenta along the constraint and pose after a displacement that has momenta r along it.

    The momenta change by the difference of two, in which the error of the root is not seen.
    """
    system, group = discrete.system, discrete.system.group
    after = system.moved(g, _step.displacement_of(discrete, y))
    if group.has_skew_part:  # rounding errors across a group of isometries are squared: R (3 - R* R) / 2
        n = free_rows(group)
        R = after[:n, :n]
        square = group.form_adjoint(after) @ after if n == group.size else R.T @ R
        after = after.at[:n, :n].set(R @ (3 * jnp.eye(n, dtype=after.dtype) - square) / 2)
    arriving = _step.restricted(discrete, _step.momentum_of(discrete, y, g, "right"), after)
    return r + (arriving - _step.restricted(discrete, _step.momentum_of(discrete, y, g, "left"), g)), after


def _decode(
    discrete: Scheme, nodes: _Node, states: tuple[Array, ...], momentum: Array | None, forces: Any, time: Array
) -> Rollout:
    """Return what saved momenta, charts, poses and those that follow are, from the first one without a step on NaN.

    A full momentum of the start must be that of the first node. The forces are half impulses and potential energies.
    """
    system, first = discrete.system, discrete.first_part

    def at(r: Array, y: Array, g: Array, after: Array) -> tuple[Array, ...]:
        whole = discrete.order > 2 or system.is_spatial
        W = system.group.inverse(g) @ after if whole else _step.displacement_of(discrete, y)
        return r, _step.momentum_of(first, y, g, "left"), W, g, system.constrained_energy(r, g)

    (r, P, W, g, energy), code = jax.vmap(at)(*states), nodes.code
    P, energy = P - forces[0], energy + forces[1]
    if momentum is not None:
        is_off = jnp.sum((P[0] - momentum) ** 2) > _step.ON_LOCUS**2 * jnp.sum(momentum**2)
        code = jnp.where((code == 0) & is_off, int(Outcome.off_momentum_locus), code)

    acting = jnp.zeros_like(P) if nodes.control is None else nodes.control
    rows = (marked_rows(each, nodes.cause, code == 0) for each in (r, P, W, g, energy, acting))
    return Rollout(time, *rows, outcome=code)


@compile_double
def step_slopes(
    discrete: Scheme, scalar: ScalarStep | None, forced: Forced | None, *states: Array
) -> Float[Array, "K m m"]:
    r"""Return the derivative of each state after a step by that before it: $(\xi, s)$ is pose g e^xi, momenta r + s.

    States are momenta along the constraint, poses, and charts, with which nothing is solved for; the parts of a
    composition search for their own.
    """
    forces, row = forces_of(discrete, forced, None, 0)[0], jnp.zeros(discrete.system.group.dim)

    def of_parts(r: Array, g: Array, _: Array) -> Array:
        def stage(carry: tuple[Array, ...], weight: Array) -> tuple[tuple[Array, ...], None]:
            slope, r, g = carry
            part, own = discrete.part(weight), scalar and scalar._replace(scale=weight * scalar.scale)
            y, _, ahead, after = _stage(forces, part, own, (r, g, row))
            return (_slope_of(part, forces, (r, g, row), y) @ slope, ahead, after), None

        begin = jnp.eye(len(row) + len(r)), r, g
        return jax.lax.scan(stage, begin, jnp.asarray(weights(discrete.order)))[0][0]

    if discrete.order > 2:
        return jax.vmap(of_parts)(*states)
    return jax.vmap(lambda r, g, y: _slope_of(discrete, forces, (r, g, row), y))(*states)


def _slope_of(part: Any, forces: _Forces, state: _State, y: Array) -> Float[Array, "m m"]:
    """Return the derivative of the state after a step of order 2 by that before it, of the implicit function."""
    (r, g, row), group = state, part.system.group

    def arrival(z: Array, y: Array) -> tuple[Array, Array, Array]:
        return _arrival(part, forces, (r + z[group.dim :], g @ group.exp(z[: group.dim]), row), y)

    still = jnp.zeros(group.dim + len(r))
    _, _, end = arrival(still, y)

    def there(z: Array, y: Array) -> tuple[Array, Array]:
        gap, ahead, after = arrival(z, y)
        return gap, jnp.append(group.log(group.inverse(end) @ after), ahead)

    (gap, across), (along, through) = jax.jacfwd(there, (0, 1))(still, y)
    return along - through @ jnp.linalg.solve(across, gap)


def step_residual(discrete: Scheme, forced: Forced | None, state: _Pair, y: Array, after: _Pair, force: Array) -> Array:
    """Return what vanishes if y is the chart of a step between two states under a constant body covector.

    A state is a pose and the momenta of its node along the constraint; the discretization is that of the free system.
    Poses may be any matrices whose constant rows are those of the group: it is kept by the equations.
    """
    (g, r), (ahead, following), system = state, after, discrete.system
    arriving = _step.restricted(discrete, _step.momentum_of(discrete, y, g, "right"), ahead)
    (impulse, balance), _ = forces_of(discrete, forced, jnp.zeros((0, system.group.dim)), 0)
    if impulse is None:
        push = _step.restricted(discrete, half_impulse(discrete, cast(Forced, balance), y, g, force), g)
        r_half, arriving = r + push, arriving + push
    else:
        r_half = r + _step.restricted(discrete, impulse(r, g, force), g)
        arriving = arriving + _step.restricted(discrete, impulse(arriving, ahead, force), ahead)
    gap = system.moved(g, _step.displacement_of(discrete, y)) - ahead
    root = _step.equations_at(discrete, g)(y, r_half)
    return jnp.concatenate([root, arriving - following, gap[: free_rows(system.group)].ravel()])
