"""The Chaplygin sleigh in a potential well."""

import numpy as np

from nonholo.base.checks import number
from nonholo.base.types import Array, Float
from nonholo.examples._example import Example, positives, ready
from nonholo.systems import ChaplyginSleigh, Forced


@ready("speed", "turning")
def sleigh_in_a_well(
    *,
    mass: float = 1.0,
    inertia: float = 0.5,
    a: float = 0.0,
    stiffness: float = 0.3,
    speed: float = 0.7,
    turning: float = 0.4,
) -> Example:
    r"""A sleigh whose contact is drawn to the origin by a spring.

    $$ m\dot u = ma\,\omega^2 - k\,(x\cos\theta + y\sin\theta), \qquad (J + ma^2)\,\dot\omega = -ma\,u\,\omega, \qquad
       \dot x = u\cos\theta, \quad \dot y = u\sin\theta, \quad \dot\theta = \omega. $$

    The energy $\tfrac12mu^2 + \tfrac12(J + ma^2)\omega^2 + \tfrac k2(x^2 + y^2)$ is constant. With a = 0 the turning
    rate is too, and the speed is that of an oscillator that the heading turns: $\ddot u + \tfrac kmu = -\tfrac
    km\,\omega\,w$, $\dot w = -\omega s$, $\dot s = u + \omega w$ for $s + iw = e^{-i\theta}(x + iy)$, a linear system.

    Reference: equations of the sleigh of [neimark-fufaev-1972] with a force; no source for the well.

    Args:
        mass: m.
        inertia: J, about the center of mass.
        a: Of the center of mass in front of the contact.
        stiffness: k.
        speed: u at the start, which is at the origin.
        turning: omega at the start.

    Raises:
        ValueError: A mass or inertia that is not positive.

    Example:
        >>> ready = nh.examples.sleigh_in_a_well()
        >>> orbit = nh.simulate(nh.discretize(ready.system, 0.05), body_velocity=ready.body_velocity, steps=400)
        >>> bool(np.ptp(orbit.energy) < 1e-12)
        True
    """
    name = "sleigh_in_a_well"
    m, J = positives(name, mass=mass, inertia=inertia)
    given = {"a": a, "stiffness": stiffness, "speed": speed, "turning": turning}
    a, k, u, omega = (float(number(f"examples.{name}({what}=...)", value)) for what, value in given.items())

    import numba

    @numba.njit
    def potential(g: Float[np.ndarray, "3 3"]) -> np.float64:
        return k * (g[0, 2] ** 2 + g[1, 2] ** 2) / 2

    def energy(g: Array, v: Array) -> Array:
        well = k * (g[..., 0, 2] ** 2 + g[..., 1, 2] ** 2)
        return (m * v[..., 1] ** 2 + (J + m * a**2) * v[..., 0] ** 2 + well) / 2

    conserved = {"energy": energy} | ({} if a else {"turning rate": lambda _g, v: v[..., 0]})
    facts = ("The energy is constant.", "With the center of mass at the contact the turning rate is, too.")
    system = Forced(ChaplyginSleigh(m, J, a), potential)
    return Example(name, system, np.eye(3), np.array([omega, u, 0.0]), facts, conserved)
