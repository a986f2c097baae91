"""Compositions by the definition of the step, in JAX: what the compiled compositions are tested against."""

import dataclasses
from typing import Any, cast

import equinox
import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.numerics import applied
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


swept = equinox.filter_jit(_sweep)
_swept_each = equinox.filter_jit(jax.vmap(_sweep, in_axes=(None, 0, 0)))


def whole_steps_by_definition(
    discrete: Scheme, momenta: Float[np.ndarray, "K k"], g: Float[np.ndarray, "K N N"]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Take one step from each row of canonical momenta and poses; return both after it, and the outcomes."""
    system = discrete.system
    (after, moved), _, codes = in_double(_swept_each, discrete, applied(system.inverse_frame_map, momenta), np.array(g))
    bad, after = codes != Outcome.successful, applied(system.frame_map, after)
    return np.where(bad[:, None], np.nan, after), np.where(bad[:, None, None], np.nan, moved), codes
