"""Where a run starts: canonical restricted momentum from a velocity, a displacement or a momentum, all checked."""

from typing import Any

import numpy as np

from nonholo._checks import array, error, shape_of
from nonholo._results import Outcome, OutcomeError
from nonholo._types import Float
from nonholo.discrete._discretization import Discretization
from nonholo.discrete._legendre import legendre
from nonholo.discrete._variety import equations_of
from nonholo.groups import AbstractMatrixGroup
from nonholo.systems import System

_TOLERANCE = 1e-9  # relative, for matrices and momenta that a user computed in floating point


def initial_momentum(
    owner: str,
    system: System,
    g: Float[np.ndarray, "N N"] | None,
    *,
    body_velocity: Any = None,
    restricted_velocity: Any = None,
    momentum: Any = None,
) -> Float[np.ndarray, "k"]:
    """Return the canonical momentum along the constraint subspace that a velocity or a momentum has at a pose."""
    k, dim = system.rank, system.group.dim
    if momentum is not None:
        where = f"{owner}(momentum=...)"
        size = k if shape_of(momentum) == (k,) else dim
        value = array(where, momentum, (size,), f"Pass {dim} body momenta or the {k} along the constraint subspace.")
        return _of_finite_energy(owner, system, g, value if size == k else system.restrict_at(value, g))
    if body_velocity is not None:
        velocity = _admissible(f"{owner}(body_velocity=...)", system, g, body_velocity)
        return _of_finite_energy(owner, system, g, system.restrict_at(system.inertia_operator @ velocity, g))
    where = f"{owner}(restricted_velocity=...)"
    rows = array(where, restricted_velocity, (k,), "Pass one number per admissible direction.")
    return _of_finite_energy(owner, system, g, system.restricted_momentum(rows, g))


def _to_body(system: System, g: np.ndarray | None) -> np.ndarray:
    """Return the matrix from velocities in which the constraint is constant to body velocities."""
    return system.carried(system.group.identity if g is None else system.group.inverse(g))


def _of_finite_energy(owner: str, system: System, g: np.ndarray | None, restricted: np.ndarray) -> np.ndarray:
    with np.errstate(over="ignore", invalid="ignore"):
        energy = system.constrained_energy(restricted, g)
    if not np.isfinite(energy):
        raise error(f"{owner}(...)", "start with a finite energy", f"{energy}", "Start slower, or use other units.")
    return system.to_canonical(restricted)


def _admissible(where: str, system: System, g: np.ndarray | None, body_velocity: Any) -> np.ndarray:
    velocity = array(where, body_velocity, (system.group.dim,), "Use `vee` to turn a matrix into coordinates.")
    carried = np.linalg.solve(_to_body(system, g), velocity)
    forbidden = system.annihilator @ carried
    if np.abs(forbidden).max(initial=0.0) > _TOLERANCE * np.abs(carried).max():
        nearest = _to_body(system, g) @ (carried - np.linalg.pinv(system.annihilator) @ forbidden)
        got = f"residual {np.array2string(forbidden, precision=6)}"
        raise error(where, "satisfy the constraint", got, f"The nearest admissible velocity is {nearest.tolist()}.")
    return velocity


def one_start(owner: str, **starts: Any) -> None:
    """Refuse a call that names no start or several."""
    given = [name for name, value in starts.items() if value is not None]
    if len(given) != 1:
        got = " and ".join(given) if given else "none"
        raise error(f"{owner}(...)", "be given exactly one of " + ", ".join(starts), got, "Choose one start.")


def initial_state(
    discrete: Discretization, g: Float[np.ndarray, "N N"] | None, *, displacement: Any = None, **starts: Any
) -> tuple[Float[np.ndarray, "k"], Float[np.ndarray, "N N"] | Float[np.ndarray, "dim"] | None]:
    """Return the canonical restricted momentum of a start, and what the first state must reproduce, if anything.

    A displacement or a full momentum determines W_0 or P_0 completely; the run checks that the principal root agrees.
    """
    one_start("simulate", **starts, displacement=displacement)
    system = discrete.system
    if displacement is not None:
        W = on_variety("simulate(displacement=...)", discrete, g, displacement)
        found = legendre(discrete, W - system.group.identity, "left")
        return initial_momentum("simulate", system, g, momentum=system.restrict_at(found, g)), W
    momentum, k = starts.get("momentum"), system.rank
    full = momentum is not None and shape_of(momentum) != (k,)
    return initial_momentum("simulate", system, g, **starts), np.asarray(momentum, dtype=np.float64) if full else None


def check_first_state(demanded: np.ndarray, displacement: np.ndarray, momentum: np.ndarray) -> None:
    """Refuse a start whose displacement or full momentum is not that of the principal root."""
    found, outcome = (
        (displacement, Outcome.branch_unverified) if demanded.ndim == 2 else (momentum, Outcome.off_momentum_locus)
    )
    if np.linalg.norm(demanded - found) > _TOLERANCE * np.linalg.norm(found):
        raise OutcomeError(outcome, "Start of the run")


def in_group(where: str, group: AbstractMatrixGroup, element: Any) -> np.ndarray:
    """Return a matrix of the group, refused with its distance from the group."""
    g = array(where, element, group.identity.shape, f"Pass an element of {group} as a matrix.")
    distance = float(group.residual(g))
    if not distance <= _TOLERANCE * np.linalg.norm(g):
        remedy = "Build it with `exp` or `cayley`."
        raise error(where, f"lie in {group}", f"a matrix at distance {distance:.3g}", remedy)
    return g


def on_variety(where: str, discrete: Discretization, g: np.ndarray | None, displacement: Any) -> np.ndarray:
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
