"""`rollout`: an orbit of the discrete map as a pure JAX function, differentiable in everything that has numbers."""

import dataclasses
from collections.abc import Callable
from typing import Any

import equinox
import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import array, count, error, function, is_traced, shape_of
from nonholo.base.numerics import double_precision
from nonholo.base.progress import interruptibly, number_of_work
from nonholo.base.traced import NodeState, rows_above
from nonholo.base.types import Array
from nonholo.discrete import Discretization, ScalarRoute, as_discretization
from nonholo.discrete.definition import in_double, roll_out, traceable
from nonholo.lagrange_dalembert import checked_value, rolled_in_coordinates
from nonholo.simulation._options import check_forces, refuse_many_matrices
from nonholo.systems import AbstractCoordinateDiscretization, Start, refuse_in_coordinates

_roll_out = equinox.filter_jit(roll_out)
_roll_in_coordinates = equinox.filter_jit(rolled_in_coordinates)
_UNSEEN = 2e-15  # relative, of differences of U
_MANY = 10_000  # steps, which may take longer than a user waits for an answer to Ctrl-C


def rollout(
    discrete: Discretization | AbstractCoordinateDiscretization,
    *,
    steps: int,
    body_velocity: Any = None,
    restricted_velocity: Any = None,
    momentum: Any = None,
    configuration: Any = None,
    controls: Any = None,
    policy: Any = None,
    save_every: int = 1,
) -> Any:
    r"""Run the discrete map as `simulate` does, as a pure JAX function of body, start and controls.

    $$ P(W_k)|_{\mathfrak d} = r_k + \tfrac h2 u_k|_{\mathfrak d}, \qquad
       r_{k+1} = (\mathrm{Ad}^*_{W_k}P(W_k) + \tfrac h2 u_k)|_{\mathfrak d}, \qquad g_{k+1} = g_kW_k. $$

    `Gravity`, `Friction` and the table of a `Forced` system act as in `simulate`, with derivatives by their numbers. A
    potential that is a function acts by its exact derivative, if JAX can trace it (of numba the function of Python).

    The numbers of a `LagrangeDAlembert` or `GroupLagrangeDAlembert` are its `parameters`. In coordinates controls are
    forces u_k, half of whose impulse acts at each end of a step as the rows of a table do.

    A policy closes the loop, $u_k = \pi(t_k, x_k)$ with the configuration at node k and the velocity $v_k$ that belongs
    to the momentum there: u_k is held over step k, as a computer in the loop does. Derivatives by its weights are those
    of the whole closed loop.

    It works under `jax.jit`, `jax.vmap`, `jax.jvp`, `jax.vjp`, `jax.jacfwd`, `jax.grad` and repeated ones, and never
    raises there; only reverse mode of reverse mode has no rule in JAX for searches in a loop: take `jax.hessian`.
    Derivatives are those of the implicit function of a step, to rounding, never of the iteration that
    finds its root; they are finite at rest, and up to displacements of half a turn. Where roots of the map merge, at a
    fold, the step has no derivative: its Jacobian matrix is singular, and beyond it the principal branch ends. The
    outcome reports it; states from there on are NaN and have the derivative NaN, states before keep theirs.

    Eager calls run in 64 bits and return NumPy arrays; traced calls must be 64-bit, or stand inside `allow_float32`.
    The first call compiles, for each kind of system: an eager one without a policy that saves every step for all
    numbers of steps up to 63, or a quarter apart; any other for each number of steps, and `jax.jit` around a function
    of the numbers keeps that to one time. Reverse mode keeps the states between two saved ones only at checkpoints:
    with `save_every=steps` a gradient over millions of steps needs the memory of some thousand, and the work of two
    runs more.

    Args:
        discrete: The discretized system; its numbers may be traced.
        steps: Number of steps N.
        body_velocity: Start with the principal W_0 that has the same momentum along the constraint.
        restricted_velocity: The same, in rows of the constraint subspace.
        momentum: Start with this momentum, full (on the momentum locus) or along the constraint subspace.
        configuration: First pose, a matrix of the group; the identity by default. In coordinates the first ones.
        controls: Body covectors u_k, (steps, dim), in coordinates forces, constant over a step: half of the impulse
            h u_k acts at each end of step k, along the constraint, beside the forces of the system; none by default.
        policy: `policy(time, state)` -> control u_k, in place of controls, with `state.configuration` and
            `state.body_velocity`, written with `jax.numpy`. Its weights may be traced: captured by the function, or the
            leaves of a pytree that is called, such as `jax.tree_util.Partial(policy, weights)`, which compiles once.
        save_every: Steps between saved states.

    Returns:
        The states with their controls; of systems by functions a `CoordinateRollout`. Values are those of `simulate` to
        rounding.

    Raises:
        ValueError: A bad argument, before any work; of traced ones the shape alone is known.
        TypeError: Traced 32-bit input.

    Example:
        How the place that a sleigh reaches depends on its first velocity:

        >>> import jax
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5), 0.1)
        >>> def place(velocity):
        ...     return nh.rollout(sleigh, body_velocity=velocity, steps=20).configuration[-1, :2, 2]
        >>> with jax.enable_x64(True):
        ...     print(jax.jacfwd(place)(np.array([0.5, 1.0, 0.0])).round(3))
        [[-0.228  1.864 -0.091]
         [ 1.719  0.543  0.688]]

        A controller that steers it along a line, and how its gain moves the last distance from the line:

        >>> def distance(gain):
        ...     def hold(time, state):
        ...         pose = state.configuration
        ...         return -gain * jax.numpy.array([pose[1, 2] + pose[1, 0] + state.body_velocity[0], 0.0, 0.0])
        ...     states = nh.rollout(sleigh, body_velocity=np.array([0.5, 1.0, 0.0]), steps=100, policy=hold)
        ...     return states.configuration[-1, 1, 2]
        >>> with jax.enable_x64(True):
        ...     print(distance(2.0).round(4), jax.grad(distance)(2.0).round(4))
        -0.0015 -0.0323
    """
    start = {"body_velocity": body_velocity, "restricted_velocity": restricted_velocity, "momentum": momentum}
    how = {"controls": controls, "policy": policy, "every": save_every}
    return roll("rollout", discrete, steps, configuration=configuration, **start, **how)


def roll(
    owner: str, discrete: Any, steps: int, *, controls: Any = None, policy: Any = None, every: int = 1, **start: Any
) -> Any:
    """Return the states of `rollout` for a function that errors name."""
    numbers = {"steps": steps, "save_every": every}
    sizes = tuple(count(f"{owner}({name}=...)", x, "Pass a number of steps.") for name, x in numbers.items())
    if isinstance(discrete, AbstractCoordinateDiscretization):
        refuse_in_coordinates(owner, restricted_velocity=(start.pop("restricted_velocity", None), None))
        run, arguments = _roll_in_coordinates, _in_coordinates
    else:
        as_discretization(f"{owner}(discrete=...)", discrete, compositions=True, forced=True)
        run, arguments = _roll_out, _on_group
    if policy is not None:
        function(where := f"{owner}(policy=...)", policy, "time", "state")
        if controls is not None:
            raise error(where, "be left out beside controls", "both", "Add the controls in the policy.")
    drive = controls if policy is None else policy
    return _call(run, sizes, *arguments(discrete, Start.of(owner, **start), sizes, drive))


class _Potential(equinox.Module):
    """A potential that is a function of a pose, and traced, beside a body; `Gravity` has the same functions."""

    function: Callable[..., Array] = equinox.field(static=True)
    weights: tuple[Array, ...]
    inertia: Array

    def check(self, group: Any) -> None:
        """Accept any group: the function was checked."""

    def energy(self, group: Any, g: Array) -> Array:
        """Return U."""
        del group
        return jnp.vectorize(lambda g: self.function(g, *self.weights), signature="(n,n)->()")(g)

    def covector(self, group: Any, g: Array) -> Array:
        """Return -dU."""
        slope = jax.grad(lambda xi, g: self.energy(group, g @ group.exp(xi)))
        return -jnp.vectorize(slope, signature="(d),(n,n)->(d)")(jnp.zeros(group.dim, g.dtype), g)

    def mean_covector(self, group: Any, g: Array, W: Array) -> Array:
        """Return -dU in the middle of a step, and what it lacks along the displacement."""
        X, pull = group.vee((W - group.inverse(W)) / 2), self.covector(group, g @ group.exp(group.log(W) / 2))
        before, after, along = self.energy(group, g), self.energy(group, g @ W), self.inertia @ X
        change, twice = after - before + pull @ X, along @ X
        is_seen = (twice > 0) & (jnp.abs(change) > _UNSEEN * (jnp.abs(before) + jnp.abs(after)))
        return pull - jnp.where(is_seen, change / jnp.where(is_seen, twice, 1.0), 0.0) * along


def with_traced_potential(owner: str, discrete: Any) -> Any:
    """Return a discretization whose potential, if it is a function, is one that JAX differentiates."""
    forced = discrete.forces
    if forced is None or forced.own_potential is None:
        return discrete
    function = getattr(forced.own_potential, "py_func", forced.own_potential)
    pose, of = jax.ShapeDtypeStruct(forced.group.identity.shape, float), f"poses of {forced.group}"
    own = checked_value(f"{owner}(discrete=...)", function, of, (pose,), (), of)
    with double_precision():
        apart, weights = jax.closure_convert(function, pose)
    own = _Potential(apart if weights else own, tuple(weights), forced.inertia_operator)
    terms = tuple(own if callable(each) else each for each in forced.terms)
    return dataclasses.replace(discrete, system=dataclasses.replace(forced, potential=terms))


def _on_group(discrete: Any, start: Start, sizes: tuple[int, ...], controls: Any) -> tuple[Any, ...]:
    """Return the arguments of a rollout on a group; of traced starts the shapes are checked."""
    discrete = with_traced_potential(start.owner, discrete)
    refuse_many_matrices(f"{start.owner}(steps=...)", discrete, 1 + sizes[0] // sizes[1], "Raise save_every.")
    value, g = _checked_start(discrete, start)
    if controls is not None:
        group = discrete.system.group
        controls = _checked_controls(start.owner, controls, sizes[0], (group.dim,), group.identity.shape)
        if discrete.order > 2:
            got = f"order {discrete.order}"
            raise error(f"{start.owner}(controls=...)", "have a step of order 2", got, "Use discretize(..., order=2).")
    check_forces(start.owner, discrete, sizes[0], in_jax=True)
    free, scalar, forced = definition_of(discrete)
    return controls, (start.name, value, g), free, scalar, forced


def definition_of(discrete: Any) -> tuple[Any, Any, Any]:
    """Return the discretization of the free system, the closed form of its step or None, and the system with forces."""
    free = dataclasses.replace(discrete, system=discrete.system.inside)
    route = dataclasses.replace(free, order=2).route
    return free, jax.tree.map(traceable, route.step) if isinstance(route, ScalarRoute) else None, discrete.forces


def _checked_controls(owner: str, controls: Any, steps: int, size: tuple[int], shape: tuple[int, ...]) -> Any:
    """Return controls as an array, or a policy with all traced numbers among its leaves."""
    if not callable(controls):
        return array(f"{owner}(controls=...)", controls, (steps, *size), "Pass a force for each step.")
    where, of = f"{owner}(policy=...)", "a time and a state"
    point = jax.ShapeDtypeStruct((), float), NodeState(*(jax.ShapeDtypeStruct(x, float) for x in (shape, size)))
    own = checked_value(where, controls, of, point, size, of)
    with double_precision():
        apart, weights = jax.closure_convert(lambda *at: controls(*at), *point)  # a pytree has no hash
    if weights:
        return jax.tree_util.Partial(_policy_of, apart, weights)
    return own if jax.tree_util.all_leaves([controls]) else controls  # numbers of a pytree are arguments


def _policy_of(apart: Callable[..., Array], weights: list[Array], time: Array, state: NodeState) -> Array:
    """Return the control of a policy whose numbers are apart."""
    return apart(time, state, *weights)


def _call(run: Callable[..., Any], sizes: tuple[int, ...], controls: Any, *arguments: Any) -> Any:
    """Return the states; many steps that are not traced end where nobody wants them any more.

    Few numbers of steps are compiled: others, without a policy, which is not asked after the last step, run on.
    """
    (steps, every), rows = sizes, 1 + sizes[0] // sizes[1]
    is_open = any(map(is_traced, jax.tree.leaves((controls, arguments))))
    if every == 1 and not is_open and not callable(controls):
        sizes = rows_above(rows) - 1, 1
        controls = controls if controls is None else np.pad(controls, ((0, sizes[0] - steps), (0, 0)))

    def asking() -> Any:
        with number_of_work() as number:
            return jax.block_until_ready(in_double(run, sizes, controls, *arguments, np.asarray(number)))

    is_short = steps < _MANY or is_open
    states = in_double(run, sizes, controls, *arguments) if is_short else interruptibly(asking)
    return type(states)(*(x[:rows] for x in states[:-1]), outcome=states.outcome[rows - 1, ...])


def _in_coordinates(discrete: Any, start: Start, sizes: tuple[int, ...], controls: Any) -> tuple[Any, ...]:
    """Return the arguments of a rollout in coordinates; of traced starts the shapes are checked."""
    system, numbers = discrete.system, discrete.system.numbers
    if not any(map(is_traced, (start.value, start.configuration, *numbers))):
        with jax.ensure_compile_time_eval():  # what is known is checked where jax.jit traces the call, too
            discrete.first(start, with_poses=True)
    value = array(start.where, start.value, (system.dimension,))
    q = system.places.configuration(f"{start.owner}(configuration=...)", start.configuration)
    if controls is not None:
        controls = _checked_controls(start.owner, controls, sizes[0], (system.dimension,), system.shapes[0])
    numbers, h = jax.tree.map(traceable, numbers), np.float64(discrete.time_step)
    return controls, (start.name, q, value), system.form, numbers, h


def _checked_start(discrete: Discretization, start: Start) -> tuple[Array, Array]:
    """Return the value of the start and the pose; of traced ones the shapes alone are checked."""
    system, group = discrete.system, discrete.system.group
    if not any(map(is_traced, (start.value, start.configuration, *jax.tree.leaves(discrete)))):
        start.momentum(system, start.pose(group))
    where, remedy = f"{start.owner}(configuration=...)", f"Pass an element of {group} as a matrix."
    pose = group.identity if start.configuration is None else start.configuration
    g = array(where, pose, group.identity.shape, remedy)
    is_along = start.name == "momentum" and shape_of(start.value) == (system.rank,)
    along = is_along or start.name == "restricted_velocity"
    return array(start.where, start.value, (system.rank if along else group.dim,)), g
