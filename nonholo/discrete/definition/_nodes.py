"""The equations of a step in all its unknowns, where nothing is solved for: momenta, chart, pose and force at once."""

from typing import cast

import jax.numpy as jnp
import numpy as np

from nonholo.base.types import Array
from nonholo.discrete._scheme import Scheme
from nonholo.discrete.definition._rollout import half_impulse, impulse_of, is_balanced
from nonholo.discrete.definition._step import displaced, equations_at, momentum_of, restricted
from nonholo.groups import AbstractMatrixGroup
from nonholo.systems import Forced


def step_residual(
    discrete: Scheme,
    forced: Forced | None,
    state: tuple[Array, Array],
    y: Array,
    after: tuple[Array, Array],
    force: Array,
) -> Array:
    """Return what vanishes if y is the chart of a step between two states under a constant body covector.

    A state is a pose and the momenta of its node along the constraint; the discretization is that of the free system.
    Poses may be any matrices whose constant rows are those of the group: it is kept by the equations.
    """
    (g, r), (ahead, following), system = state, after, discrete.system
    arriving = restricted(discrete, momentum_of(discrete, y, g, "right"), ahead)
    if is_balanced(discrete, forced):
        push = restricted(discrete, half_impulse(discrete, cast(Forced, forced), y, g, force), g)
        pushed, arriving = r + push, arriving + push
    else:
        impulse, _ = impulse_of(discrete, forced, jnp.zeros((0, system.group.dim)), 0)
        pushed = r + restricted(discrete, impulse(r, g, force), g)
        arriving = arriving + restricted(discrete, impulse(arriving, ahead, force), ahead)
    moved = system.moved(g, displaced(discrete, y)) - ahead
    root = equations_at(discrete, g)(y, pushed)
    return jnp.concatenate([root, arriving - following, moved[: free_rows(system.group)].ravel()])


def free_rows(group: AbstractMatrixGroup) -> int:
    """Return how many rows of the matrices of a group are not the same for all."""
    return group.size if group.form is not None or np.any(group.basis[:, -1]) else group.size - 1
