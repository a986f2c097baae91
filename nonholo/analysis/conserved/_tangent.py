"""The tangent map along an orbit, and the exponents at which neighbors part."""

import numpy as np

from nonholo.base.checks import error, shown
from nonholo.base.types import Float
from nonholo.continuous import ContinuousFlow, flow_tangents
from nonholo.discrete import Discretization
from nonholo.orbit import Orbit, as_orbit

_WHERE, _REMEDY = "Orbit.tangent", "one in coordinates has none."


def tangent(orbit: Orbit) -> Float[np.ndarray, "L k k"]:
    r"""Return $\partial r_{k+1}/\partial r_k$ for every state of an orbit but the last; no JAX is needed.

    Of the discrete map, from closed derivatives along the displacement variety,

    $$ \frac{\partial r_{k+1}}{\partial r_k} = F'(W_k^{-1})\,F'(W_k)^{-1}, \qquad
       F(W) = P(W)|_{\mathfrak d},\quad r_{k+1} = -F(W_k^{-1}), $$

    for a left-invariant system, difference "matrix", constraint "skew", order 2, and every step saved; `nh.rollout` has
    the derivatives of all others. Of a flow, from the Taylor series of its equation of variation, between its times.

    Args:
        orbit: Made by `simulate`, or by `flow` for a system with a constraint fixed in the body.

    Raises:
        ValueError: Another kind of orbit.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5), 0.1)
        >>> orbit = nh.simulate(sleigh, restricted_velocity=(0.0, 1.0), steps=1)
        >>> orbit.tangent[0].round(3)
        array([[0.961, 0.   ],
               [0.   , 1.   ]])
    """
    as_orbit(_WHERE, orbit, _REMEDY)
    discrete, system = orbit.motion, orbit.system
    if orbit.has_impacts.any():
        raise error(_WHERE, "have no impacts", "some", "Ask it of the part of the orbit before the first one.")
    if isinstance(discrete, ContinuousFlow) and not system.is_spatial and not system.is_forced:
        return flow_tangents(_WHERE, system, orbit.restricted_momentum, orbit.time)
    if not isinstance(discrete, Discretization) or not _has_closed_derivatives(discrete):
        remedy = "Differentiate `nh.rollout` by JAX, or run with the default difference and constraint."
        raise error(_WHERE, "be asked of a map with closed derivatives", shown(discrete), remedy)
    if not orbit.has_every_step:
        raise error(_WHERE, "have every step", f"{len(orbit)} states with others between", "Run with save_every=1.")
    return discrete.displacement_decoder.tangent(orbit.canonical_chart[:-1])


def _has_closed_derivatives(discrete: Discretization) -> bool:
    return discrete.conserves_energy and discrete.order == 2 and discrete.forces is None


def lyapunov_exponents(orbit: Orbit) -> Float[np.ndarray, "k"]:
    r"""Return the finite-time Lyapunov exponents of the momenta along an orbit, largest first.

    $$ \lambda_i = \frac{1}{t_K - t_0}\sum_k \log R^{(k)}_{ii}, \qquad
       \frac{\partial r_{k+1}}{\partial r_k}\,Q^{(k)} = Q^{(k+1)}R^{(k+1)}, $$

    Benettin's method: an orthonormal frame is carried by the tangent map (`Orbit.tangent`) and made orthonormal again
    at each step. Their sum is the mean rate at which volumes of momenta grow.

    Args:
        orbit: As `Orbit.tangent` takes it.

    Raises:
        ValueError: An orbit without a tangent map, or of a single state.

    Example:
        A sleigh tends to its straight motion: one momentum keeps what it is, the other decays.

        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5), 0.1)
        >>> nh.lyapunov_exponents(nh.simulate(sleigh, restricted_velocity=(0.0, 1.0), steps=200)).round(3) + 0.0
        array([ 0. , -0.4])
    """
    steps = as_orbit(_WHERE, orbit, _REMEDY).tangent
    if not len(steps):
        raise error("lyapunov_exponents(orbit=...)", "have a step", "one state", "Run longer.")
    frame, growth = np.eye(steps.shape[-1]), np.zeros(steps.shape[-1])
    for step in steps:
        frame, triangle = np.linalg.qr(step @ frame)
        growth += np.log(np.abs(triangle.diagonal()))
    return np.sort(growth / float(orbit.time[-1] - orbit.time[0]))[::-1]
