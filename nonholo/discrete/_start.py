"""Where a run starts: canonical restricted momentum from a velocity, a displacement or a momentum, all checked."""

from typing import Any

import numpy as np

from nonholo._checks import array, error
from nonholo._results import Outcome, OutcomeError
from nonholo._types import Float
from nonholo.discrete._discretization import Discretization
from nonholo.discrete._legendre import legendre
from nonholo.groups import AbstractMatrixGroup
from nonholo.systems import AbstractLLSystem

_TOLERANCE = 1e-9  # relative, for matrices and momenta that a user computed in floating point


def initial_momentum(
    owner: str,
    system: AbstractLLSystem,
    body_velocity: Any = None,
    restricted_velocity: Any = None,
    momentum: Any = None,
) -> Float[np.ndarray, "k"]:
    """Return the canonical momentum along the constraint subspace that a velocity or a momentum has."""
    subspace = system.constraint_subspace
    k, dim = subspace.shape
    if momentum is not None:
        where = f"{owner}(momentum=...)"
        size = k if np.shape(momentum) == (k,) else dim
        value = array(where, momentum, (size,), f"Pass {dim} body momenta or the {k} along the constraint subspace.")
        return _of_finite_energy(owner, system, system.frame_map @ (value if size == k else system.restrict(value)))
    if body_velocity is not None:
        velocity = _admissible(f"{owner}(body_velocity=...)", system, body_velocity)
    else:
        where = f"{owner}(restricted_velocity=...)"
        velocity = array(where, restricted_velocity, (k,), "Pass one number per admissible direction.") @ subspace
    canonical = system.group.adjoint(system.group.inverse(system.frame)) @ velocity
    reduced = system.canonical.restrict(system.canonical.inertia_operator @ canonical)
    return _of_finite_energy(owner, system, reduced)


def _of_finite_energy(owner: str, system: AbstractLLSystem, reduced: np.ndarray) -> np.ndarray:
    with np.errstate(over="ignore", invalid="ignore"):
        energy = system.canonical.constrained_energy(reduced)
    if not np.isfinite(energy):
        raise error(f"{owner}(...)", "start with a finite energy", f"{energy}", "Start slower, or use other units.")
    return reduced


def _admissible(where: str, system: AbstractLLSystem, body_velocity: Any) -> np.ndarray:
    velocity = array(where, body_velocity, (system.group.dim,), "Use `vee` to turn a matrix into coordinates.")
    forbidden = system.annihilator @ velocity
    if np.abs(forbidden).max() > _TOLERANCE * np.abs(velocity).max():
        nearest = velocity - np.linalg.pinv(system.annihilator) @ forbidden
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
    discrete: Discretization,
    *,
    body_velocity: Any = None,
    restricted_velocity: Any = None,
    displacement: Any = None,
    momentum: Any = None,
) -> tuple[Float[np.ndarray, "k"], Float[np.ndarray, "N N"] | Float[np.ndarray, "dim"] | None]:
    """Return the canonical restricted momentum of a start, and what the first state must reproduce, if anything.

    A displacement or a full momentum determines W_0 or P_0 completely; the run checks that the principal root agrees.
    """
    one_start(
        "simulate",
        body_velocity=body_velocity,
        restricted_velocity=restricted_velocity,
        displacement=displacement,
        momentum=momentum,
    )
    system = discrete.system
    if displacement is not None:
        W = on_variety("simulate(displacement=...)", system, displacement)
        found = legendre(discrete, W - system.group.identity, "left")
        return initial_momentum("simulate", system, momentum=found), W
    reduced = initial_momentum("simulate", system, body_velocity, restricted_velocity, momentum)
    full = momentum is not None and np.shape(momentum) == (system.group.dim,)
    return reduced, np.asarray(momentum, dtype=np.float64) if full else None


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
    distance = np.linalg.norm(g - group.matrix_from_pose(group.pose_from_matrix(g)))
    if not distance <= _TOLERANCE * np.linalg.norm(g):
        raise error(
            where, f"lie in {group}", f"a matrix at distance {distance:.3g}", "Build it with `exp` or `cayley`."
        )
    return g


def on_variety(where: str, system: AbstractLLSystem, displacement: Any) -> np.ndarray:
    """Return a displacement on exp d, refused with the forbidden part of its logarithm."""
    W = in_group(where, system.group, displacement)
    logarithm = system.group.log(W)
    forbidden = system.annihilator @ logarithm
    if np.linalg.norm(forbidden) > _TOLERANCE * max(1.0, float(np.linalg.norm(logarithm))):
        got = f"a logarithm with forbidden part {np.array2string(forbidden, precision=6)}"
        raise error(where, "lie on the displacement variety", got, "Build it as `group.exp(x)` with x admissible.")
    return W
