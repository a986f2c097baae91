"""How small changes of a state grow along an orbit: the derivatives of its states, and Lyapunov exponents."""

from typing import Any

import numpy as np

from nonholo.analysis._linearize import door
from nonholo.base.checks import error, shown
from nonholo.base.types import Float
from nonholo.continuous import ContinuousFlow, flow_tangents
from nonholo.discrete import Discretization
from nonholo.orbit import AbstractOrbit, Orbit, any_orbit, as_orbit
from nonholo.systems import alike_in_time, direction_lengths, refuse_slip

_WHERE = "Orbit.tangent"
_HIDDEN = 1e-10  # growth of one direction relative to that of another one, of which rounding leaves six digits


def tangent(orbit: Orbit) -> Float[np.ndarray, "L k k"]:
    r"""Return the derivative of each state of an orbit by the one before, $\partial r_{k+1}/\partial r_k$.

    Of the discrete map, without JAX from closed derivatives along the displacement variety,

    $$ \frac{\partial r_{k+1}}{\partial r_k} = F'(W_k^{-1})\,F'(W_k)^{-1}, \qquad
       F(W) = P(W)|_{\mathfrak d},\quad r_{k+1} = -F(W_k^{-1}), $$

    for a left-invariant system, difference "matrix", constraint "skew" and order 2; of other maps by JAX. Where forces
    depend on the pose, or the constraint is fixed in space, a state is $(\xi, r)$ with $\xi$ of the pose
    $g\,e^\xi$, (K - 1, dim + k, dim + k). Of a flow without forces, of a constraint fixed in the body, from the Taylor
    series of its equation of variation, between its times; of other flows by Runge-Kutta steps of that equation.

    Args:
        orbit: Made by `simulate` with every step saved, or by `flow`. An orbit in coordinates has its own `tangent`.

    Raises:
        ValueError: Another kind of orbit, a map under a table or a force that is a function.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5), 0.1)
        >>> orbit = nh.simulate(sleigh, restricted_velocity=(0.0, 1.0), steps=1)
        >>> orbit.tangent[0].round(3)
        array([[0.961, 0.   ],
               [0.   , 1.   ]])
    """
    as_orbit(_WHERE, orbit, "of one in coordinates take `orbit.tangent`.")
    discrete, system = orbit.motion, orbit.system
    refuse_slip(_WHERE, system)
    if orbit.has_impacts.any():
        raise error(_WHERE, "have no impacts", "some", "Pass the part of the orbit before the first one.")
    if isinstance(discrete, ContinuousFlow):
        if system.is_spatial or system.is_forced:
            return door(_WHERE).along_flow(orbit)
        return flow_tangents(_WHERE, system, orbit.restricted_momentum, orbit.time)
    if not isinstance(discrete, Discretization) or _acts_from_outside(discrete.forces):
        remedy = "Differentiate `nh.rollout` by JAX."
        raise error(_WHERE, "belong to a flow, or to a map without forces of the time", shown(discrete), remedy)
    if not orbit.has_every_step:
        raise error(_WHERE, "have all states of the run", f"{len(orbit)} of them", "Run with save_every=1.")
    if _has_closed_derivatives(discrete):
        return discrete.displacement_decoder.tangent(orbit.canonical_chart[:-1])
    return door(_WHERE).along(orbit)


def _has_closed_derivatives(discrete: Discretization) -> bool:
    return discrete.conserves_energy and discrete.order == 2 and discrete.forces is None


def _acts_from_outside(forces: Any) -> bool:
    """Return whether forces do more than the state does: by a table, or by a function of the time."""
    return forces is not None and (forces.table is not None or forces.function is not None)


def lyapunov_exponents(orbit: AbstractOrbit) -> Float[np.ndarray, "k"]:
    r"""Return the finite-time Lyapunov exponents along an orbit, largest first.

    $$ \lambda_i = \frac{1}{t_K - t_0}\sum_k \log R^{(k)}_{ii}, \qquad
       \frac{\partial r_{k+1}}{\partial r_k}\,Q^{(k)} = Q^{(k+1)}R^{(k+1)}, $$

    Benettin's method: a frame, orthonormal in the body's units, is carried by the tangent map (`Orbit.tangent`) and
    made orthonormal again at each step. Their sum is the mean rate at which volumes of states grow: of momenta, where
    nothing else decides them, in coordinates of configurations with admissible velocities. An exponent of a map is
    minus infinity where a step takes a direction away.

    Args:
        orbit: One that has a `tangent`.

    Raises:
        ValueError: An orbit without a tangent map, or of a single state; a flow with times so far apart that rounding
            hides a direction that decays.

    Example:
        A sleigh tends to its straight motion: one momentum keeps what it is, the other decays.

        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5), 0.1)
        >>> nh.lyapunov_exponents(nh.simulate(sleigh, restricted_velocity=(0.0, 1.0), steps=200)).round(3) + 0.0
        array([ 0. , -0.4])
    """
    steps = _tangent_in_units(any_orbit(where := "lyapunov_exponents(orbit=...)", orbit))
    if not len(steps):
        raise error(where, "have a step", "one state", "Run longer.")
    if not orbit.is_discrete and not ((conditions := np.linalg.cond(steps)) <= 1 / _HIDDEN).all():
        got = f"a tangent map of condition {conditions.max():.3g}"
        raise error(where, "have times between which all directions are seen", got, "Pass more times to `flow`.")
    frame, growth = np.eye(steps.shape[-1]), np.zeros(steps.shape[-1])
    for step in steps:
        frame, triangle = np.linalg.qr(step @ frame)
        with np.errstate(divide="ignore"):
            growth += np.log(np.abs(triangle.diagonal()))
    return np.sort(growth / float(orbit.time[-1] - orbit.time[0]))[::-1]


def _tangent_in_units(orbit: AbstractOrbit) -> Float[np.ndarray, "L d d"]:
    """Return the derivatives of states in units of the body and of a time."""
    if not isinstance(orbit, Orbit):
        from nonholo.lagrange_dalembert import tangents

        maps, rows, units, places = tangents.changes(orbit)
        return tangents.among_admissible(maps, rows, alike_in_time(maps, units, places, np.ptp(orbit.time)))
    system, maps = orbit.system, orbit.tangent
    lengths = direction_lengths(system.constraint_subspace, system.displacement_units)
    momenta = lengths * np.mean(np.diagonal(system.constrained_inertia) / lengths**2)
    units = np.append(system.displacement_units, momenta)[-maps.shape[-1] :]
    units = alike_in_time(maps, units, len(units) - len(momenta), np.ptp(orbit.time))
    return maps * (units / units[:, None])
