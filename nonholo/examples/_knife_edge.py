"""The knife edge on an inclined plane."""

import functools

import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import error, number, scale
from nonholo.base.types import Array
from nonholo.examples._example import Example, Numbers, numbers, rate, ready, sized
from nonholo.lagrange_dalembert import LagrangeDAlembert

_SIZES = ("mass", "inertia", "slope_acceleration")


@ready("configuration", "speed", "turning")
def knife_edge_on_incline(
    *,
    mass: float = 1.0,
    inertia: float = 1.0,
    slope_acceleration: float = 1.0,
    configuration: tuple[float, float, float] = (0.0, 0.0, 0.0),
    speed: float = 0.0,
    turning: float = 1.0,
) -> Example:
    r"""A blade on a slope that falls along x: contact point (x, y), which is the center of mass, and heading phi.

    $$ L = \tfrac m2(\dot x^2 + \dot y^2) + \tfrac J2\dot\varphi^2 + m G x, \qquad
       \dot x\sin\varphi - \dot y\cos\varphi = 0, \qquad G = g\sin\alpha. $$

    The turning rate $\omega$ is constant. With $c = G/\omega$ and $w = u_0 - c\sin\varphi_0$ the speed along the blade
    is $u = w + c\sin\varphi$, and from $\varphi_0$ to $\varphi$ the place changes by the changes of

    $$ x = \tfrac1\omega\bigl(w\sin\varphi + \tfrac c2\sin^2\varphi\bigr), \qquad
       y = \tfrac1\omega\bigl(-w\cos\varphi + \tfrac c2(\varphi - \tfrac12\sin2\varphi)\bigr). $$

    From rest at $\varphi_0 = 0$ this is a cycloid: the blade does not slide down the slope, x stays between 0 and
    $G/(2\omega^2)$, and it drifts sideways at the mean speed $G/(2\omega)$.

    The midpoint rule keeps $\omega$, and of each step the number $u - c_h\sin\varphi$ with $c_h = Gh/\sin h\omega$ in
    place of c, u and $\varphi$ in its middle: it draws cycloids too.

    Reference: [bloch-2003], section 1.6; [neimark-fufaev-1972].

    Args:
        mass: m.
        inertia: J, about the contact point.
        slope_acceleration: G, the acceleration of gravity times the sine of the slope.
        configuration: (x, y, phi) at the start.
        speed: u_0, along the blade.
        turning: omega, not zero.

    Raises:
        ValueError: A mass or inertia that is not positive, a turning rate zero, a wrong shape.

    Example:
        >>> ready = nh.examples.knife_edge_on_incline(turning=2.0)
        >>> float(ready.exact(np.linspace(0, 100, 10_001))[:, 0].max().round(6))
        0.125
    """
    where = "examples.knife_edge_on_incline"
    m = float(scale(f"{where}(mass=...)", mass, "Pass the mass."))
    J = float(scale(f"{where}(inertia=...)", inertia, "Pass the moment of inertia."))
    G = float(number(f"{where}(slope_acceleration=...)", slope_acceleration))
    u0, omega = float(number(f"{where}(speed=...)", speed)), float(number(f"{where}(turning=...)", turning))
    if omega == 0:
        raise error(f"{where}(turning=...)", "not be zero", "0", "A blade that does not turn falls on a straight line.")
    q = numbers("knife_edge_on_incline", "configuration", configuration, 3, "x, y and phi")
    c = G / omega
    w = u0 - c * np.sin(q[2])

    def antiderivative(phi: Array) -> Array:
        along = w * np.sin(phi) + c * np.sin(phi) ** 2 / 2
        across = -w * np.cos(phi) + c * (phi - np.sin(2 * phi) / 2) / 2
        return np.stack([along, across], axis=-1) / omega

    def exact(time: Array) -> Array:
        phi = q[2] + omega * np.asarray(time)
        moved = q[:2] + antiderivative(phi) - antiderivative(q[2])
        return np.concatenate([moved, phi[..., None]], axis=-1)

    def drive(q: Array, v: Array) -> Array:
        along = v[..., 0] * np.cos(q[..., 2]) + v[..., 1] * np.sin(q[..., 2])
        return along * v[..., 2] - G * np.sin(q[..., 2])

    conserved = {"phi'": rate(2), "u phi' - G sin phi": drive}
    facts = (
        "phi' is constant, also in the midpoint rule.",
        "u phi' - G sin phi is constant; in the midpoint rule u - (G h / sin(h phi')) sin phi in the middle of steps.",
        "From rest the blade draws a cycloid.",
    )
    v = np.array([u0 * np.cos(q[2]), u0 * np.sin(q[2]), omega])
    return Example("knife_edge_on_incline", sized(_system, m, J, G), q, v, facts, conserved, exact)


@functools.cache
def _system() -> LagrangeDAlembert:
    def lagrangian(q: Array, v: Array, p: Numbers) -> Array:
        m, J, G = map(p.__getitem__, _SIZES)
        return jnp.array([m, m, J]) @ v**2 / 2 + m * G * q[0]

    def forms(q: Array, p: Numbers) -> Array:
        del p
        return jnp.array([[jnp.sin(q[2]), -jnp.cos(q[2]), 0.0]])

    names = ("x", "y", "phi")
    blade = np.array([[-1.0, 0.0], [1.0, 0.0]])
    return LagrangeDAlembert(
        lagrangian,
        forms,
        dimension=3,
        coordinates=names,
        heading="phi",
        outline=lambda _, p: [np.sqrt(p["inertia"] / p["mass"]) * blade],
        parameters=dict.fromkeys(_SIZES, 1.0),
        name="Knife edge on an incline",
    )
