r"""Half impulses of the forced discrete map at nodes, and what they leave of momenta along the constraint.

Let $E(g)$ be the matrix of the admissible body directions, $S^T$, or $\mathrm{Ad}_{g^{-1}}S^T$ of a constraint that is
fixed in space. A kick over the time $\tau$ at a fixed pose and time takes r to $r + E^Tj$ with the impulse

$$ j = \tau\,(-dU + f_k) - C\,E B^{-1}\!\int_0^\tau\! r\,dt \qquad\text{or}\qquad
   j = \tau\,\bigl(-dU + f(t, g, E B^{-1}(r + r')/2)\bigr), \quad B = E^T\mathbb{I}E; $$

exact for friction, by the midpoint rule for a function of the velocity. Both are symmetric: a kick over $-\tau$ takes
back the kick over $\tau$.
"""

from typing import NamedTuple

import numpy as np
import scipy.linalg

from nonholo.base.checks import error
from nonholo.base.results import Outcome, OutcomeError
from nonholo.base.types import Float
from nonholo.systems.forces._forced import Forced
from nonholo.systems.forces._friction import Friction

_FIXED, _NEWTON = 40, 20  # iterations of the midpoint rule: by substitution, then by Newton's method
_ROUNDING = 4 * np.finfo(np.float64).eps
_DIFFERENCE = 1e-7  # relative, of a momentum


class Propagator(NamedTuple):
    r"""What $\dot r = a - D r$ does in a time: $r' = A r + V a$ and $\int r\,dt = V r + W a$.

    Attributes:
        keep: A.
        push: V.
        gather: W.
    """

    keep: Float[np.ndarray, "... k k"]
    push: Float[np.ndarray, "... k k"]
    gather: Float[np.ndarray, "... k k"]


def admissible_directions(forced: Forced, g: Float[np.ndarray, "... N N"]) -> Float[np.ndarray, "... dim k"]:
    """Return E, whose columns are the admissible body velocities at poses."""
    S = np.asarray(forced.constraint_subspace)
    return forced.group.adjoint(forced.group.inverse(g)) @ S.T if forced.is_spatial else S.T


def propagator(forced: Forced, E: Float[np.ndarray, "... dim k"], tau: float) -> Propagator:
    """Return the exact exponentials of friction over a time; A is the identity where there is none."""
    k, inertia = E.shape[-1], np.asarray(forced.inertia_operator)
    if not isinstance(forced.force, Friction):
        one = np.eye(k)
        return Propagator(one, tau * one, tau * tau / 2 * one)
    turned = np.swapaxes(E, -1, -2)
    D = turned @ forced.force.matrix @ E @ np.linalg.inv(turned @ inertia @ E)
    block = np.zeros((*D.shape[:-2], 3 * k, 3 * k))
    block[..., :k, :k] = -tau * D
    block[..., :k, k : 2 * k] = block[..., k : 2 * k, 2 * k :] = tau * np.eye(k)
    found = scipy.linalg.expm(block)
    return Propagator(found[..., :k, :k], found[..., :k, k : 2 * k], found[..., :k, 2 * k :])


def impulses(
    forced: Forced,
    r: Float[np.ndarray, "K k"],
    g: Float[np.ndarray, "K N N"],
    time: Float[np.ndarray, "K"],
    steps: np.ndarray,
    tau: float,
) -> Float[np.ndarray, "K dim"]:
    """Return the impulses of kicks over a time from restricted momenta, body covectors.

    Args:
        forced: The system.
        r: Momenta before the kicks, along the rows of the constraint subspace; after them for a negative time.
        g: Poses.
        time: Times of the nodes.
        steps: Numbers of the steps, whose row of a table acts.
        tau: Half a time step, or its negative.
    """
    constant = forced.potential_force(g) + forced.rows(steps)
    if forced.force is None or forced.table is not None:
        return tau * constant
    E = admissible_directions(forced, g)
    along = np.swapaxes(E, -1, -2)
    to_velocity = E @ np.linalg.inv(along @ np.asarray(forced.inertia_operator) @ E)
    if isinstance(forced.force, Friction):
        parts = propagator(forced, E, tau)
        integral = parts.push @ r[..., None] + parts.gather @ (along @ constant[..., None])
        return tau * constant + forced.force.covector((to_velocity @ integral)[..., 0])
    shape = (len(r), *E.shape[-2:])
    E, to_velocity = np.broadcast_to(E, shape), np.broadcast_to(to_velocity, shape)
    rows = zip(r, g, time, constant, E, to_velocity, strict=True)
    return np.array([_midpoint(forced, tau, *row) for row in rows]).reshape(len(r), forced.group.dim)


def work_of(
    forced: Forced,
    time: Float[np.ndarray, "K"],
    g: Float[np.ndarray, "K N N"],
    velocity: Float[np.ndarray, "K dim"],
    every: int,
) -> Float[np.ndarray, "K"]:
    """Return the work of the force along states, by the trapezoidal rule."""
    if forced.table is not None:
        if every > 1:
            got = f"save_every {every} with a force for each step"
            raise error("Orbit.work", "know every step", got, "Run with save_every=1.")
        acting = forced.rows(np.rint(time[:-1] / np.diff(time)).astype(int))
        powers = [(acting * velocity[at]).sum(axis=1) for at in (slice(None, -1), slice(1, None))]
    else:
        rows = zip(time, g, velocity, strict=True)
        power = np.array([forced.applied_force(*row) @ row[2] for row in rows])
        powers = [power[:-1], power[1:]]
    return np.concatenate([np.zeros(min(1, len(time))), np.cumsum(np.diff(time) * (powers[0] + powers[1]) / 2)])


def _midpoint(
    forced: Forced,
    tau: float,
    r: np.ndarray,
    g: np.ndarray,
    time: float,
    constant: np.ndarray,
    E: np.ndarray,
    to_velocity: np.ndarray,
) -> np.ndarray:
    """Return the impulse of the midpoint rule."""

    def impulse(after: np.ndarray) -> np.ndarray:
        return tau * (constant + forced.applied_force(time, g, to_velocity @ ((r + after) / 2)))

    after, good = r, False
    for _ in range(_FIXED):
        found = impulse(after)
        ahead = r + E.T @ found
        good = bool(np.all(np.abs(ahead - after) <= _ROUNDING * (np.abs(r) + np.abs(ahead)).max(initial=0.0)))
        after = ahead
        if good or not np.all(np.isfinite(after)):
            return found
    return _by_newton(r, lambda x: E.T @ impulse(x), impulse)


def _by_newton(r: np.ndarray, push, impulse) -> np.ndarray:  # noqa: ANN001
    """Return the impulse where substitution does not converge, such as of stiff friction; NaN if this fails too."""
    after, scale = r.copy(), _DIFFERENCE * max(1e-300, np.abs(r).max(initial=0.0))
    for _ in range(_NEWTON):
        missed = after - r - push(after)
        offsets = scale * np.eye(len(r))
        slope = np.stack([(push(after + x) - push(after - x)) / (2 * scale) for x in offsets], axis=1)
        change = np.linalg.lstsq(np.eye(len(r)) - slope, missed)[0]
        after = after - change
        if not np.all(np.isfinite(after)):
            break
        if np.abs(change).max() <= 1e-13 * (np.abs(r) + np.abs(after)).max():
            return impulse(after)
    raise OutcomeError(Outcome.not_converged, "Half impulse of a force that depends on the velocity")
