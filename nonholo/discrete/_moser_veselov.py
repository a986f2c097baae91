r"""The free top by a matrix equation: one step of Moser and Veselov as the solution of a Riccati equation."""

from typing import Any

import numpy as np
import scipy  # its parts load on first use

from nonholo.base.checks import array, error, scale, shape_of, symmetric
from nonholo.base.types import Array, Float
from nonholo.groups import SO


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
        raise error(
            f"{owner}(momentum=...)", "lie on the branch of small steps", f"{failure}", "Take smaller steps."
        ) from None
    return np.linalg.solve(J, (M / 2 + S).T).T
