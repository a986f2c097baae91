"""Which discretisations have a closed-form kernel, and in which units it works."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nonholo import kernels
from nonholo._results import Outcome, OutcomeError
from nonholo._types import Array, Float
from nonholo.systems import AbstractLLSystem, ChaplyginSleigh, SuslovTop

if TYPE_CHECKING:
    from nonholo.discrete._discretization import Discretization


class Structured(NamedTuple):
    """A kernel's body and the factor from physical momenta to the kernel's scaled ones."""

    body: kernels.Body
    scale: Array


def structured(discrete: "Discretization") -> Structured | None:
    """Return the closed form of a discretisation, or None if it has none."""
    if discrete.difference != "matrix":
        return None
    system: AbstractLLSystem = discrete.system.canonical
    if isinstance(system, SuslovTop):
        body = kernels.suslov_body(system.constrained_inertia, system.coupling)
        return Structured(body, discrete.time_step / 2)
    if isinstance(system, ChaplyginSleigh):
        numbers = (system.mass, system.inertia, system.a)
        concrete = all(isinstance(x, np.floating) for x in numbers)
        return Structured(kernels.SleighBody(*map(float, numbers) if concrete else numbers), discrete.time_step)
    return None


def next_charts(
    discrete: "Discretization", reduced_momentum: Float[np.ndarray, "K k"], cayley: Float[np.ndarray, "K k"]
) -> Float[np.ndarray, "K k"]:
    """Return the displacements that follow, one step from each state."""
    closed = structured(discrete)
    if closed is None:
        from nonholo.discrete._definition import next_charts_by_definition

        return next_charts_by_definition(discrete, cayley)
    _, charts, codes = kernels.step_each(closed.body, closed.scale * reduced_momentum, cayley, cayley, True)
    if codes.any():
        raise OutcomeError(Outcome(int(codes.max())), "Step after a saved state")
    return charts


def reversal_defects(
    discrete: "Discretization", reduced_momentum: Float[np.ndarray, "K k"], cayley: Float[np.ndarray, "K k"]
) -> Float[np.ndarray, "K"]:
    """Return, for each state, how far one step forward and one back (W to its inverse) miss it, relative to it.

    The map is multivalued and its principal value is not always the way back: the nearest value counts. Infinite where
    the iteration for it fails, NaN where there is no step forward.
    """
    closed = structured(discrete)
    if closed is None:
        raise ValueError(
            "`reversal_defects` needs a closed-form discretisation. Got another. Pass difference='matrix'."
        )
    scaled = closed.scale * reduced_momentum
    momenta, charts, ahead = kernels.step_each(closed.body, scaled, cayley, cayley, True)
    after, _, _ = kernels.step_each(closed.body, momenta, charts, charts, False)
    back, returned, behind = kernels.step_each(closed.body, -after, -charts, -cayley, False)
    missed = np.maximum(_largest(returned + cayley) / _largest(cayley), _largest(back + momenta) / _largest(momenta))
    return np.where(ahead != 0, np.nan, np.where(behind != 0, np.inf, missed))


def _largest(rows: np.ndarray) -> np.ndarray:
    return np.abs(rows).max(axis=1)
