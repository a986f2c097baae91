r"""Momenta of displacements and back, checked: `discrete_legendre`, and the free top by a matrix equation.

One step of Moser and Veselov is the solution of a Riccati equation.
"""

from typing import Any

import numpy as np
import scipy  # its parts load on first use

from nonholo.base.checks import array, choice, error, scale, shape_of, symmetric
from nonholo.base.types import Array, Float
from nonholo.discrete._discretization import Discretization, as_discretization
from nonholo.discrete._scheme import legendre
from nonholo.groups import SO


def discrete_legendre(
    discrete: Discretization, displacement: Float[Array, "... N N"], side: str = "left"
) -> Float[Array, "... dim"]:
    r"""Return the discrete body momentum of a displacement, in physical units.

    $$ \langle P(W), x\rangle = \tfrac{d}{d\varepsilon} l_d(e^{\varepsilon x} W)\big|_0 \ \text{(left)}, \qquad
       \langle P^+(W), x\rangle = \tfrac{d}{d\varepsilon} l_d(W e^{\varepsilon x})\big|_0 \ \text{(right)}, $$

    and $P^+(W) = \mathrm{Ad}^*_W P(W)$: the momentum that arrives at the next state before the constraint force.

    Reference: [fedorov-zenkov-2004], equation (disc.mom.dfn), whose second form has the wrong sign.

    Args:
        discrete: The discretized system.
        displacement: W, an element of the group; a leading axis of many is allowed.
        side: "left" or "right".

    Raises:
        ValueError: A wrong shape, a value that is not finite, an unknown side.

    Example:
        >>> sleigh = discretize(ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.0), time_step=0.5)
        >>> discrete_legendre(sleigh, SE(2).exp(np.array([0.0, 0.5, 0.0])))
        array([0., 1., 0.])
    """
    group = as_discretization("discrete_legendre(discrete=...)", discrete).system.group
    where, shape = "discrete_legendre(displacement=...)", group.identity.shape
    leading = (None,) * (len(shape_of(displacement)) - 2)
    W = array(where, displacement, leading + shape, f"Pass an element of {group} as a matrix.")
    return legendre(discrete, W - group.identity, choice("discrete_legendre(side=...)", side, ("left", "right")))


def moser_veselov_displacement(mass_tensor: Any, momentum: Any, time_step: Array) -> Float[np.ndarray, "n n"]:
    r"""Return the displacement of the free top on SO(n) with a given momentum, on the branch of small steps.

    $$ M = WJ - JW^T, \qquad W = (\tfrac12M + S)J^{-1}, \qquad S^2 + \tfrac12(SM - MS) = \tfrac14M^2 + J^2, $$

    with $M = h\hat P$ and the symmetric positive definite solution S of the Riccati equation, which is J for M = 0.
    An independent way to the first displacement of `simulate(discretize(RigidBody(mass_tensor), h), momentum=...)`.

    Reference: [moser-veselov-1991]; [cardoso-leite-2003] for the Riccati equation.

    Args:
        mass_tensor: J, positive definite (n, n).
        momentum: P, coordinates of so(n)*.
        time_step: h.

    Raises:
        ValueError: A wrong shape, a mass tensor that is not positive definite, a momentum beyond the branch.

    Example:
        >>> W = moser_veselov_displacement(np.diag([1.0, 2.0, 3.0]), [0.3, 0.4, 0.2], time_step=0.1)
        >>> top = nh.discretize(nh.RigidBody(np.diag([1.0, 2.0, 3.0])), time_step=0.1)
        >>> nh.discrete_legendre(top, W).round(12)
        array([0.3, 0.4, 0.2])
    """
    owner = "moser_veselov_displacement"
    where, remedy = f"{owner}(mass_tensor=...)", "Pass the mass tensor J."
    n = max((2, *shape_of(mass_tensor)[-1:]))
    J = symmetric(where, array(where, mass_tensor, (n, n), remedy), remedy)
    if np.linalg.eigvalsh(J)[0] <= 0:
        got = f"an eigenvalue {np.linalg.eigvalsh(J)[0]:.3g}"
        raise error(where, "be positive definite", got, "Flat bodies have no Riccati equation: use `simulate`.")
    group = SO(len(J))
    P = array(f"{owner}(momentum=...)", momentum, (group.dim,), f"Pass {group.dim} coordinates of so(n)*.")
    h = scale(f"{owner}(time_step=...)", time_step, "Pass a positive time step.")
    unit = np.exp2(np.floor(np.log2(np.abs(J).max())))  # of mass: exact
    J, M = J / unit, h * group.hat(P / unit)
    try:
        S = scipy.linalg.solve_continuous_are(-M / 2, np.eye(n), M @ M / 4 + J @ J, np.eye(n))
    except (np.linalg.LinAlgError, ValueError) as failure:  # what is not finite is a ValueError
        where = f"{owner}(momentum=...)"
        raise error(where, "lie on the branch of small steps", f"{failure}", "Take smaller steps.") from None
    return np.linalg.solve(J, (M / 2 + S).T).T
