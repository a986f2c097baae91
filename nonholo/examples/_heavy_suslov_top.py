"""The Suslov top in the potential of Klebsch and Tisserand."""

import functools

import numpy as np

from nonholo.base.types import Array, Float
from nonholo.examples._example import Example, ready
from nonholo.systems import Forced, SuslovTop


@ready("velocity", positive="inertia", inertia="three moments", stiffness="three numbers", velocity="two components")
def heavy_suslov_top(
    *,
    inertia: tuple[float, float, float] = (1.0, 1.2, 0.8),
    stiffness: tuple[float, float, float] = (0.5, 1.0, 2.0),
    velocity: tuple[float, float] = (0.6, 0.4),
) -> Example:
    r"""A top that may not spin about its third axis, in the quadratic potential of Klebsch and Tisserand.

    $$ I\dot\omega = I\omega\times\omega + \gamma\times\nabla U(\gamma) + \lambda e_3, \quad \omega_3 = 0, \qquad
       \dot\gamma = \gamma\times\omega, \qquad U = \tfrac12(c_1\gamma_1^2 + c_2\gamma_2^2 + c_3\gamma_3^2) $$

    with the vertical $\gamma = R^Te_3$ seen from the body and principal moments I; the third axis is the
    forbidden one.
    The two equations separate,

    $$ I_1\omega_1^2 - (c_3 - c_2)\gamma_2^2, \qquad I_2\omega_2^2 - (c_3 - c_1)\gamma_1^2, $$

    are constant, and so half of their sum, the energy but for $c_3/2$.

    Reference: [hu-santoprete-2017]; the integrals follow at once from the equations above.

    Args:
        inertia: Principal moments I.
        stiffness: c.
        velocity: (omega_1, omega_2) at the start, where the third axis is vertical.

    Raises:
        ValueError: A moment that is not positive, moments of no body, a wrong shape.

    Example:
        >>> ready = nh.examples.heavy_suslov_top()
        >>> discrete = nh.discretize(ready.system, 0.01)
        >>> orbit = nh.simulate(discrete, body_velocity=ready.body_velocity, steps=1000)
        >>> kept = ready.conserved["of the first axis"](orbit.configuration, orbit.body_velocity)
        >>> bool(np.ptp(kept) < 1e-3)
        True
    """
    c = np.asarray(stiffness)

    def integral(g: Array, v: Array, turning: int, tilting: int) -> Array:
        return inertia[turning] * v[..., turning] ** 2 - (c[2] - c[tilting]) * g[..., 2, tilting] ** 2

    conserved = {
        "of the first axis": functools.partial(integral, turning=0, tilting=1),
        "of the second axis": functools.partial(integral, turning=1, tilting=0),
    }

    import numba

    @numba.njit
    def potential(g: Float[np.ndarray, "3 3"]) -> np.float64:
        return c @ g[2] ** 2 / 2

    facts = ("The equations separate: there are two quadratic integrals.", "Every solution is one of quadratures.")
    system = Forced(SuslovTop.from_inertia(np.diag(inertia)), potential)
    return Example("heavy_suslov_top", system, np.eye(3), np.append(velocity, 0.0), facts, conserved)
