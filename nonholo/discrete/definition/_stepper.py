"""Steps by the definition, in JAX: to the principal value or the nearest one, of compositions, and parts of steps."""

import dataclasses
from typing import Any

import equinox
import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import error
from nonholo.base.numerics import applied
from nonholo.base.results import Outcome
from nonholo.base.types import Array
from nonholo.discrete._scheme import Scheme, weights
from nonholo.discrete.definition import _step
from nonholo.discrete.definition._precision import in_double
from nonholo.discrete.routes import AbstractBodyStepper, Compact
from nonholo.orbit import First, Rows, State, keep_row, write_first


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
        system = self.motion.system
        return system.rank, len(self.motion.variety.chart), system.group.size**2

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
        nearest = self.branch == "nearest"
        return in_double(_advance, self.motion, nearest, np.int64(number), np.int64(steps), r, y, g)

    def _matrix(self, rows: np.ndarray) -> np.ndarray:
        size = self.motion.system.group.size
        return rows.reshape(*rows.shape[:-1], size, size)

    def _normal(self, ahead: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Return momentum and pose one sweep ahead, the pose freed of rounding errors."""
        group = self.motion.system.group
        g = group.matrix_from_pose(group.normalize_pose(group.pose_from_matrix(ahead[1])))
        return ahead[0], g.ravel()


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
