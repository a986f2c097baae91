"""Steps by the definition, in JAX: to the principal value or the nearest one, of compositions, and parts of steps.

`step` is one step of the discrete map as a pure JAX function.
"""

import dataclasses
from typing import Any, NamedTuple

import equinox
import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import array, error, is_traced, shape_of, shown
from nonholo.base.numerics import applied
from nonholo.base.results import Outcome
from nonholo.base.types import Array, Float
from nonholo.discrete import branching
from nonholo.discrete._discretization import Discretization, as_discretization
from nonholo.discrete._scheme import Scheme, weights
from nonholo.discrete.definition import _step
from nonholo.discrete.definition._step import compile_double, in_double
from nonholo.discrete.routes import AbstractBodyStepper, Compact, ScalarRoute, ScalarStep
from nonholo.orbit import First, Rows, State, keep_row, write_first
from nonholo.systems import refuse_fixed_in_space


def _sweep(discrete: Scheme, r: Array, g: Array) -> tuple[tuple[Array, Array], Array, Array]:
    """Return momentum and pose after a whole step, the chart of its first substep and the outcome."""

    def advance(carry: tuple[Array, ...], weight: Array) -> tuple[tuple[Array, ...], Array]:
        (*now, code), part = carry, discrete.part(weight)
        y, outcome = _step.principal_displacement(part, *now)
        good, ahead = (code == 0) & (outcome == 0), _step.push(part, y, now[1])
        after = (jnp.where(good, new, old) for new, old in zip(ahead, now, strict=True))
        return (*after, jnp.where(code == 0, outcome, code)), y

    start = (r, g, jnp.zeros((), dtype=jnp.result_type(int)))
    (*state, code), charts = jax.lax.scan(advance, start, jnp.asarray(weights(discrete.order)))
    return (state[0], state[1]), charts[0], code


sweep = equinox.filter_jit(_sweep)
_swept_each = equinox.filter_jit(jax.vmap(_sweep, in_axes=(None, 0, 0)))


def whole_steps_by_definition(discrete: Scheme, momenta: np.ndarray, g: np.ndarray) -> Compact:
    """Take one step from each row of canonical momenta and poses; return both after it, and the outcomes."""
    system = discrete.system
    (after, poses), _, codes = in_double(_swept_each, discrete, applied(system.inverse_frame_map, momenta), np.array(g))
    bad, after = codes != Outcome.successful, applied(system.frame_map, after)
    return np.where(bad[:, None], np.nan, after), np.where(bad[:, None, None], np.nan, poses), codes


@compile_double
def next_charts(discrete: Scheme, charts: Float[Array, "K m"], g: Float[Array, "K N N"]) -> Float[Array, "K m"]:
    """Return the charts after one step to the principal value from each chart and pose."""
    return jax.vmap(lambda *state: _step.principal_displacement(discrete, *_step.push(discrete, *state))[0])(charts, g)


@dataclasses.dataclass(frozen=True, eq=False)
class DefinitionStepper(AbstractBodyStepper):
    """Rows are momenta, charts and matrices of poses in the user's frame; a composition is a whole step ahead of them.

    Attributes:
        branch: "principal" or "nearest".
    """

    branch: str = "principal"

    @property
    def sizes(self) -> tuple[int, int, int]:
        """Numbers of momenta, chart coordinates and matrix entries."""
        return self.motion.route.sizes

    def start(self, first: First) -> tuple[State, Outcome]:
        """Solve for the principal displacement, or take the one that is demanded of a run to the nearest value."""
        system = self.motion.system
        group, frame, (reduced, pose) = system.group, system.frame, first.numbers
        r, g = applied(system.inverse_frame_map, reduced), group.matrix_from_pose(pose) @ group.inverse(frame)
        if self.motion.order > 2:
            ahead, y, code = in_double(sweep, self.motion, r, g)
            return np.concatenate((r, y, g.ravel(), *self._normal(ahead))), Outcome(int(code))
        y, number = np.zeros(len(self.motion.variety.chart)), -1
        if self.branch == "nearest" and first.demand is not None and first.demand.ndim == 2:
            y, number = _coordinates(self.motion, system.to_canonical_frame(first.demand)), 0
        _, code, r, y, g = self._take(number, 0, r, y, g)
        return np.concatenate((r, y, g.ravel())), Outcome(int(code))

    def advance(self, state: State, steps: int, every: int, rows: Rows) -> tuple[int, int]:
        """Take steps from one saved row to the next."""
        write_first(state, rows)
        step, total, code = self._whole_steps if self.motion.order > 2 else self._plain, 0, 0
        while code == 0 and total < steps:
            good, code = step(state, every)
            total += good
            if good == every:
                write_first(state, tuple(column[total // every :] for column in rows))
        if total % every == 0:
            keep_row(state, rows, total // every)
        return total, code

    def _plain(self, state: State, steps: int) -> tuple[int, int]:
        k, m = self.motion.system.rank, len(self.motion.variety.chart)
        good, code, r, y, g = self._take(0, steps, state[:k], state[k : k + m], self._matrix(state[k + m :]))
        state[:] = np.concatenate((r, y, g.ravel()))
        return int(good), int(code)

    def _whole_steps(self, state: State, steps: int) -> tuple[int, int]:
        """Take steps one by one: a state is good if the whole step that starts there could be taken."""
        k, width = self.motion.system.rank, self.width
        for number in range(steps):
            r, g = state[width : width + k].copy(), self._matrix(state[width + k :]).copy()
            ahead, y, code = in_double(sweep, self.motion, r, g)
            if code != 0:
                return number, int(code)
            state[:] = np.concatenate((r, y, g.ravel(), *self._normal(ahead)))
        return steps, 0

    def decode(self, momenta: np.ndarray, charts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return canonical momenta and charts."""
        return applied(self.motion.system.frame_map, momenta), charts

    def decode_poses(self, poses: np.ndarray) -> np.ndarray:
        """Return compact canonical poses."""
        system = self.motion.system
        return system.group.pose_from_matrix(self._matrix(poses) @ system.frame)

    def _take(self, number: int, steps: int, r: np.ndarray, y: np.ndarray, g: np.ndarray) -> Any:
        return in_double(_advance, self.motion, self.branch == "nearest", np.int64(number), np.int64(steps), r, y, g)

    def _matrix(self, rows: np.ndarray) -> np.ndarray:
        size = self.motion.system.group.size
        return rows.reshape(*rows.shape[:-1], size, size)

    def _normal(self, ahead: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Return momentum and pose one sweep ahead, the pose freed of rounding errors."""
        group = self.motion.system.group
        return ahead[0], group.matrix_from_pose(group.normalize_pose(group.pose_from_matrix(ahead[1]))).ravel()


def _coordinates(discrete: Scheme, W: np.ndarray) -> np.ndarray:
    """Return the chart coordinates of a displacement, refused where there are none."""
    try:
        return discrete.variety.coordinates(W)
    except np.linalg.LinAlgError:
        got, remedy = "a half-turn, which has no Cayley coordinates", "Start from another displacement or a velocity."
        raise error("simulate(displacement=...)", "turn by less than a half", got, remedy) from None


@equinox.filter_jit
def _advance(
    discrete: Scheme, nearest: bool, number: Array, steps: Array, r: Array, y: Array, g: Array
) -> tuple[Array, ...]:
    """Take steps; before the first one, if `number` is -1 and y zero, find the displacement with momenta r at g.

    From zero the nearest value is the principal one, and the root is compiled once for both.
    """
    group, principal = discrete.system.group, _step.principal_displacement

    def body(carry: tuple[Array, ...]) -> tuple[Array, ...]:
        count, _, *now = carry
        r, g = _step.push(discrete, now[1], now[2])
        g = group.matrix_from_pose(group.normalize_pose(group.pose_from_matrix(g)))
        r, g = (jnp.where(count < 0, old, new) for new, old in ((r, now[0]), (g, now[2])))
        y, code = _step.nearest_displacement(discrete, now[1], r) if nearest else principal(discrete, r, g)
        code = jnp.where(jnp.all(jnp.isfinite(g)), code, int(Outcome.nonfinite))
        good = code == 0
        return count + good, code, *(jnp.where(good, new, old) for new, old in zip((r, y, g), now, strict=True))

    start = (jnp.asarray(number), jnp.asarray(0), jnp.asarray(r), jnp.asarray(y), jnp.asarray(g))
    return jax.lax.while_loop(lambda c: (c[0] < steps) & (c[1] == 0), body, start)


_root = equinox.filter_jit(_step.principal_displacement)
_push = equinox.filter_jit(_step.push)


def leap(discrete: Scheme, m: np.ndarray, pose: np.ndarray, parts: np.ndarray) -> Any:
    """Return the outcome, the chart of the first part of a step, and canonical momenta and pose after all parts."""
    one, system, frame, code, chart = discrete.part(1.0), discrete.system, discrete.system.frame, 0, None
    r, g = applied(system.inverse_frame_map, m), pose.reshape(frame.shape) @ system.group.inverse(frame)
    for part in parts:
        y, outcome = in_double(_root, one, part * r, g)
        r, g = in_double(_push, one, y, g)
        r, code, chart = r / part, code or int(outcome), y if chart is None else chart
    return code, chart, applied(system.frame_map, r), (g @ frame).ravel()


class StepResult(NamedTuple):
    """The state after a step.

    Attributes:
        momentum: P_{k+1}, shape (dim,).
        displacement: W_{k+1}, whose momentum is P_{k+1}.
        multipliers: The impulses between P_k and P_{k+1}, shape (s,).
        outcome: An `Outcome` as an integer array; where it is not `successful` the other fields are NaN.
    """

    momentum: Float[Array, "dim"]
    displacement: Float[Array, "N N"]
    multipliers: Float[Array, "s"]
    outcome: Array


def step(discrete: Discretization, momentum: Any, branch: branching.BranchRule = "principal") -> StepResult:
    r"""Take one step of the discrete map: from $P_k$ to $P_{k+1}$, with the displacement $W_{k+1}$ at the new momentum.

    $$ P_{k+1} = \mathrm{Ad}^*_{W_k} P_k + \sum_j \lambda_j a^j, \qquad P_k = P(W_k),\ P_{k+1} = P(W_{k+1}). $$

    A pure function: it works under `jax.jit`, `jax.vmap` and `jax.grad` (with respect to the momentum and to the
    numbers of the system) and never raises there. Eager calls run in 64 bits and return NumPy arrays; traced calls must
    be 64-bit, or stand inside `allow_float32`.

    Reference: [fedorov-zenkov-2004], equation (disc.momentum.eqn).

    Args:
        discrete: The discretized system.
        momentum: P_k on the momentum locus, or its components along the constraint subspace.
        branch: As in `simulate`. With "principal" and "nearest" a step can be traced; "nearest" then starts at the
            principal displacement of the momentum, as it always does for components along the subspace.

    Returns:
        The new state and the outcome.

    Raises:
        ValueError: A wrong shape, a value that is not finite, an unknown branch or one that the system does not
            have, a right-invariant constraint (whose step depends on the configuration: use `simulate`); with another
            branch than "principal" a full momentum off the locus.
        TypeError: Traced 32-bit input.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5), time_step=0.1)
        >>> after = nh.step(sleigh, np.array([0.0, 1.0, 0.0]))
        >>> after.momentum, int(after.outcome)
        (array([0., 1., 0.]), 0)
    """
    as_discretization("step(discrete=...)", discrete)
    got = f"{type(discrete.system).__name__}, whose step depends on the configuration"
    refuse_fixed_in_space("step(discrete=...)", discrete.system, "Use simulate(..., steps=1).", got)
    k, dim = discrete.system.constraint_subspace.shape
    size = k if shape_of(momentum) == (k,) else dim
    where = "step(momentum=...)"
    value = array(where, momentum, (size,), f"Pass {dim} body momenta or the {k} along the constraint subspace.")
    in_jax = any(is_traced(x) for x in jax.tree.leaves((discrete, value)))
    rule = branching.checked_rule("step", discrete, branch)
    if in_jax and not (rule.is_principal or rule.is_nearest):
        got = f"{shown(branch)} under a JAX transformation"
        raise error("step(branch=...)", "be 'principal' or 'nearest'", got, "Take this step outside of it.")
    if rule.is_principal or in_jax or not branching.has_frame(discrete):
        route = discrete.route
        scalar_step = jax.tree.map(_step.traceable, route.step) if isinstance(route, ScalarRoute) else None
        return in_double(_one_step, discrete, scalar_step, not rule.is_principal, value)
    return StepResult(*branching.step_by_rule(discrete, rule, value))


@equinox.filter_jit
def _one_step(discrete: Discretization, scalar_step: ScalarStep | None, nearest: bool, momentum: Array) -> StepResult:
    system = discrete.system
    subspace = jnp.asarray(system.constraint_subspace)
    full, nowhere = momentum.shape[0] != subspace.shape[0], system.group.identity
    y, code = _step.principal_of(discrete, scalar_step, subspace @ momentum if full else momentum, nowhere)
    if full:
        gap = _step.momentum_of(discrete, y, nowhere, "left") - momentum
        is_off = jnp.sum(gap**2) > _step.ON_LOCUS**2 * jnp.sum(momentum**2)
        code = jnp.where((code == 0) & is_off, int(Outcome.off_momentum_locus), code)
    arriving = _step.momentum_of(discrete, y, nowhere, "right")
    if nearest:
        following, later = _step.nearest_displacement(discrete, y, subspace @ arriving)
    else:
        following, later = _step.principal_of(discrete, scalar_step, subspace @ arriving, nowhere)
    code = jnp.where(code == 0, later, code)
    after = _step.momentum_of(discrete, following, nowhere, "left")
    multipliers = (after - arriving) @ jnp.linalg.pinv(jnp.asarray(system.annihilator))
    good = code == 0
    W = _step.displacement_of(discrete, following)
    return StepResult(*(jnp.where(good, x, jnp.nan) for x in (after, W, multipliers)), outcome=code)
