"""The tangent map along an orbit, and the exponents at which neighbors part."""

from typing import Any

import numpy as np

from nonholo.analysis.linearization import step_tangents
from nonholo.base.checks import error, instance, shown
from nonholo.base.types import Float
from nonholo.continuous import ContinuousFlow, flow_tangents
from nonholo.discrete import Discretization
from nonholo.orbit import AbstractOrbit, Orbit, as_orbit

_WHERE = "Orbit.tangent"


def tangent(orbit: Orbit) -> Float[np.ndarray, "L k k"]:
    r"""Return the derivative of each state of an orbit by the one before, $\partial r_{k+1}/\partial r_k$.

    Of the discrete map, without JAX from closed derivatives along the displacement variety,

    $$ \frac{\partial r_{k+1}}{\partial r_k} = F'(W_k^{-1})\,F'(W_k)^{-1}, \qquad
       F(W) = P(W)|_{\mathfrak d},\quad r_{k+1} = -F(W_k^{-1}), $$

    for a left-invariant system, difference "matrix", constraint "skew" and order 2; of other maps by JAX. Where forces
    depend on the pose, or the constraint is fixed in space, a state is $(\xi, r)$ with $\xi$ of the pose
    $g\,e^\xi$, (K - 1, dim + k, dim + k). Of a flow without forces, of a constraint fixed in the body, from the Taylor
    series of its equation of variation, between its times.

    Args:
        orbit: Made by `simulate` with every step saved, or by `flow`. An orbit in coordinates has its own `tangent`.

    Raises:
        ValueError: Another kind of orbit, a map under a table or a function of Python or numba.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5), 0.1)
        >>> orbit = nh.simulate(sleigh, restricted_velocity=(0.0, 1.0), steps=1)
        >>> orbit.tangent[0].round(3)
        array([[0.961, 0.   ],
               [0.   , 1.   ]])
    """
    as_orbit(_WHERE, orbit, "of one in coordinates take `orbit.tangent`.")
    discrete, system = orbit.motion, orbit.system
    if orbit.has_impacts.any():
        raise error(_WHERE, "have no impacts", "some", "Ask it of the part of the orbit before the first one.")
    if isinstance(discrete, ContinuousFlow) and not system.is_spatial and not system.is_forced:
        return flow_tangents(_WHERE, system, orbit.restricted_momentum, orbit.time)
    if not isinstance(discrete, Discretization) or _acts_from_outside(discrete.forces):
        remedy = "Differentiate `nh.rollout` by JAX."
        raise error(_WHERE, "belong to a free flow, or to a map whose forces are numbers", shown(discrete), remedy)
    if not orbit.has_every_step:
        raise error(_WHERE, "have every step", f"{len(orbit)} states with others between", "Run with save_every=1.")
    if _has_closed_derivatives(discrete):
        return discrete.displacement_decoder.tangent(orbit.canonical_chart[:-1])
    return step_tangents(orbit)


def _has_closed_derivatives(discrete: Discretization) -> bool:
    return discrete.conserves_energy and discrete.order == 2 and discrete.forces is None


def _acts_from_outside(forces: Any) -> bool:
    """Return whether forces do more than the state does: by a table, or by a function that is not traced."""
    return forces is not None and (forces.needs_function or forces.table is not None)


def lyapunov_exponents(orbit: AbstractOrbit) -> Float[np.ndarray, "k"]:
    r"""Return the finite-time Lyapunov exponents along an orbit, largest first.

    $$ \lambda_i = \frac{1}{t_K - t_0}\sum_k \log R^{(k)}_{ii}, \qquad
       \frac{\partial r_{k+1}}{\partial r_k}\,Q^{(k)} = Q^{(k+1)}R^{(k+1)}, $$

    Benettin's method: an orthonormal frame is carried by the tangent map (`Orbit.tangent`) and made orthonormal again
    at each step. Their sum is the mean rate at which volumes of states grow: of momenta, where nothing else decides
    them, in coordinates of configurations with admissible velocities.

    Args:
        orbit: One that has a `tangent`.

    Raises:
        ValueError: An orbit without a tangent map, or of a single state.

    Example:
        A sleigh tends to its straight motion: one momentum keeps what it is, the other decays.

        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5), 0.1)
        >>> nh.lyapunov_exponents(nh.simulate(sleigh, restricted_velocity=(0.0, 1.0), steps=200)).round(3) + 0.0
        array([ 0. , -0.4])
    """
    remedy = "Pass what `simulate` or `flow` returned."
    steps = instance("lyapunov_exponents(orbit=...)", orbit, AbstractOrbit, "be an orbit", remedy).tangent
    if not len(steps):
        raise error("lyapunov_exponents(orbit=...)", "have a step", "one state", "Run longer.")
    frame, growth = np.eye(steps.shape[-1]), np.zeros(steps.shape[-1])
    for step in steps:
        frame, triangle = np.linalg.qr(step @ frame)
        growth += np.log(np.abs(triangle.diagonal()))
    return np.sort(growth / float(orbit.time[-1] - orbit.time[0]))[::-1]
