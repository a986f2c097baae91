"""The start of a run: canonical restricted momentum from a start, with a displacement on the variety, all checked."""

from typing import Any

import numpy as np

from nonholo.base.checks import error, shape_of
from nonholo.base.results import Outcome, OutcomeError
from nonholo.base.types import Float
from nonholo.discrete._composition import refuse_composition
from nonholo.discrete._legendre import legendre
from nonholo.discrete._scheme import Scheme
from nonholo.discrete._variety import equations_of
from nonholo.orbit import First, Orbit
from nonholo.systems import Start, in_group, of_finite_energy, refuse_forces

_TOLERANCE = 1e-9  # relative, for matrices and momenta that a user computed in floating point


def first_of_run(discrete: Any, start: Start, *, posed: bool) -> First:
    """Return the checked start of a run, with a pose or without: it may be large."""
    group = discrete.system.group
    g = start.pose(group) if posed or start.configuration is not None else None
    g = g if posed else None
    reduced, demanded = initial_state(discrete, start, g)
    return First((reduced, np.empty(0) if g is None else start.canonical_pose(discrete.system, g)), demanded)


def initial_state(
    discrete: Scheme, start: Start, g: Float[np.ndarray, "N N"] | None
) -> tuple[Float[np.ndarray, "k"], Float[np.ndarray, "N N"] | Float[np.ndarray, "dim"] | None]:
    """Return the canonical restricted momentum of a start, and what the first state must reproduce, if anything.

    A displacement or a full momentum determines W_0 or P_0 completely; the run checks that the principal root agrees.
    """
    system = discrete.system
    if start.name == "displacement":
        remedy = "A whole step does not lie on the variety: start from a momentum or a velocity."
        refuse_composition(start.where, discrete, remedy)
        refuse_forces(start.where, discrete.system)
        W = on_variety(start.where, discrete, g, start.value)
        momentum = legendre(discrete, W - system.group.identity, "left")
        return of_finite_energy(start.owner, system, g, system.restrict_at(momentum, g)), W
    full = start.name == "momentum" and shape_of(start.value) != (system.rank,)
    return start.momentum(system, g), np.asarray(start.value, dtype=np.float64) if full else None


def check_first_state(demanded: np.ndarray, there: Orbit) -> None:
    """Refuse a start whose displacement or full momentum is not that of the principal root, which is the first one."""
    if demanded.ndim == 2:
        found, outcome = there.displacement[0], Outcome.branch_unverified
    else:
        found, outcome = there.momentum[0], Outcome.off_momentum_locus
    if np.linalg.norm(demanded - found) > _TOLERANCE * np.linalg.norm(found):
        raise OutcomeError(outcome, "Start of the run", there.chosen(slice(0, 0)))


def on_variety(where: str, discrete: Scheme, g: np.ndarray | None, displacement: Any) -> np.ndarray:
    """Return a displacement whose place on the variety is checked, refused with its forbidden part."""
    system, group = discrete.system, discrete.system.group
    W = in_group(where, group, displacement)
    seen = g @ W @ group.inverse(g) if system.is_spatial else W
    logarithm = group.log(seen)
    if discrete.variety.exact:
        forbidden, what = system.annihilator @ logarithm, "a logarithm with forbidden part"
        remedy = "Build it as `group.exp(x)` with x admissible."
    else:
        frame = system.frame
        forbidden, what = equations_of(discrete.variety, group.inverse(frame) @ seen @ frame), "equations with residual"
        remedy = "Start from a velocity, or take a row of `orbit.displacement`: exp d is not this variety."
    if np.linalg.norm(forbidden) > _TOLERANCE * max(1.0, float(np.linalg.norm(logarithm))):
        got = f"{what} {np.array2string(forbidden, precision=6)}"
        raise error(where, "lie on the displacement variety", got, remedy)
    return W
