"""Impulses of forces by their definition, and the equations of motion piece by piece."""

import dataclasses
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import scipy.integrate

from nonholo.base.types import Float
from nonholo.continuous import vector_field
from nonholo.orbit import Orbit
from nonholo.systems import AbstractSystem, Forced


def impulses_of(
    forced: Forced, orbit: Orbit, leaving: Float[np.ndarray, "K dim"], time_step: float
) -> tuple[Float[np.ndarray, "K dim"], Float[np.ndarray, "K dim"]]:
    r"""Return the half impulses before and after each step of an orbit, from its own momenta.

    A kick takes r to $r + E^Tj$. Friction acts all the while, $\dot j = F(r + E^Tj)$; any other force with the
    velocity of the mean of both momenta, if need be beside it.

    Args:
        forced: What moves.
        orbit: Its orbit, with all steps; the momenta of its states are those at the nodes.
        leaving: Momenta of the displacements.
        time_step: h.
    """
    group, g, W = forced.group, orbit.configuration, orbit.displacement
    ends, arriving = np.concatenate([g[1:], g[-1:] @ W[-1:]]), group.coadjoint(W, leaving)
    time, nodes, half = orbit.time.tolist(), orbit.restricted_momentum, time_step / 2
    first, last = [], []
    for k in range(len(orbit)):
        first.append(_impulse(forced, g[k], time[k], nodes[k], forced.directions(g[k]).T @ leaving[k], k, half))
    for k in range(len(orbit) - 1):
        before = forced.directions(ends[k]).T @ arriving[k]
        last.append(_impulse(forced, ends[k], time[k + 1], before, nodes[k + 1], k, half))
    return np.array(first), np.array([*last, np.full(group.dim, np.nan)])


def _impulse(
    forced: Forced, g: np.ndarray, time: float, before: np.ndarray, after: np.ndarray, step: int, tau: float
) -> Float[np.ndarray, "dim"]:
    E = forced.directions(g)
    to_velocity = E @ np.linalg.inv(E.T @ np.asarray(forced.inertia_operator) @ E)
    constant = forced.potential_force(g) + forced.rows(np.array([step]))[0]
    constant = constant + forced.driving_force(time, g, to_velocity @ ((before + after) / 2))
    if (friction := forced.friction) is None:
        return tau * constant

    def rate(_: Any, j: np.ndarray) -> np.ndarray:
        return constant + friction.covector(to_velocity @ (before + E.T @ j))

    size = 1e-14 * (1.0 + np.abs(before).max())
    return scipy.integrate.solve_ivp(rate, (0.0, tau), np.zeros(len(E)), "DOP853", rtol=1e-13, atol=size).y[:, -1]


def fields_of(
    system: AbstractSystem, times: list[float], end: float
) -> Iterator[tuple[Callable[..., Any], list[float]]]:
    """Give vector fields with the times at which each is wanted: one, of a table a field for each of ten rows."""
    forced, pieces = system.forces, 10
    if forced is None or forced.table is None:
        yield vector_field(system), [0.0, *times, end]
        return
    for k, row in enumerate(forced.rows(np.arange(pieces))):
        acting = dataclasses.replace(forced, force=lambda *state, row=row: row + forced.applied_force(*state))
        yield vector_field(acting), [0.0, *times] if k == 0 else [k * end / pieces, (k + 1) * end / pieces]
