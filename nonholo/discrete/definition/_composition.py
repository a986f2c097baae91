"""Compositions by the definition of the step, in JAX: what the compiled compositions are tested against."""

import dataclasses
from typing import Any, cast

import equinox
import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.numerics import applied
from nonholo.base.progress import progress_bar
from nonholo.base.results import Outcome
from nonholo.base.types import Array, Float
from nonholo.discrete._composition import weights
from nonholo.discrete._scheme import Scheme
from nonholo.discrete.definition._precision import in_double
from nonholo.discrete.definition._step import displaced, momentum_of, principal_displacement, restricted

State = tuple[Array, Array]


def _substep(discrete: Scheme, weight: Array, r: Array, g: Array) -> tuple[Array, Array, Array, Array]:
    """Return momentum and pose after a substep, the chart of its displacement and the outcome."""
    part: Any = dataclasses.replace(cast(Any, discrete), time_step=weight * discrete.time_step, order=2)
    y, code = principal_displacement(part, r, g)
    W = displaced(part, y)
    after = discrete.system.moved(g, W)
    return restricted(part, momentum_of(part, y, g, "right"), after), after, y, code


def _sweep(discrete: Scheme, r: Array, g: Array) -> tuple[State, Array, Array]:
    """Return momentum and pose after a whole step, the chart of its first substep and the outcome."""

    def advance(carry: tuple[Array, ...], weight: Array) -> tuple[tuple[Array, ...], Array]:
        *now, code = carry
        *ahead, y, found = _substep(discrete, weight, *now)
        good = (code == 0) & (found == 0)
        chosen = (jnp.where(good, new, old) for new, old in zip(ahead, now, strict=True))
        return (*chosen, jnp.where(code == 0, found, code)), y

    start = (r, g, jnp.zeros((), dtype=jnp.result_type(int)))
    (*state, code), charts = jax.lax.scan(advance, start, jnp.asarray(weights(discrete.order)))
    return (state[0], state[1]), charts[0], code


_swept = equinox.filter_jit(_sweep)
_swept_each = equinox.filter_jit(jax.vmap(_sweep, in_axes=(None, 0, 0)))


def whole_steps_by_definition(
    discrete: Scheme, momenta: Float[np.ndarray, "K k"], g: Float[np.ndarray, "K N N"]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Take one step from each row of canonical momenta and poses; return both after it, and the outcomes."""
    system = discrete.system
    (after, moved), _, codes = in_double(_swept_each, discrete, applied(system.inverse_frame_map, momenta), np.array(g))
    bad, after = codes != Outcome.successful, applied(system.frame_map, after)
    return np.where(bad[:, None], np.nan, after), np.where(bad[:, None, None], np.nan, moved), codes


def run_composed_by_definition(
    discrete: Scheme, reduced: np.ndarray, pose: np.ndarray, steps: int, every: int, progress: bool
) -> tuple[tuple[np.ndarray, np.ndarray, np.ndarray], Outcome, int]:
    """Run whole steps; return the saved canonical states, the outcome and the number of good steps.

    A state is good if the whole step that starts there could be taken.
    """
    group, C, frame = discrete.system.group, discrete.system.frame_map, discrete.system.frame
    now = np.linalg.solve(C, reduced), group.matrix_from_pose(pose) @ group.inverse(frame)
    rows, done, code = [], -1, 0
    with progress_bar("steps", progress) as report:
        while code == 0 and done < steps:
            ahead, y, code = in_double(_swept, discrete, *now)
            if code == 0:
                done += 1
                if done % every == 0:
                    rows.append((now[0], y, now[1]))
                now = ahead[0], group.matrix_from_pose(group.normalize_pose(group.pose_from_matrix(ahead[1])))
                report(done, steps)
    if not rows:
        none = np.empty((0, len(discrete.variety.chart)))
        return (np.empty((0, reduced.size)), none, np.empty((0, pose.size))), Outcome(int(code)), 0
    momenta, charts, poses = (np.array(column) for column in zip(*rows, strict=True))
    return (applied(C, momenta), charts, group.pose_from_matrix(poses @ frame)), Outcome(int(code)), done
