"""Blades: the knife edge on a slope, and sleighs that a moving mass drives or a spring holds."""

from typing import Any

import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import error
from nonholo.base.types import Array, Float
from nonholo.examples._example import Example, Numbers, family, ready, system_in
from nonholo.examples._formulas import rate, speed_ahead, wheel
from nonholo.lagrange_dalembert import LagrangeDAlembert
from nonholo.systems import ChaplyginSleigh, Forced

_EDGE = ("mass", "inertia", "slope_acceleration")


@ready("configuration speed turning", reals="slope_acceleration", configuration="x, y and phi")
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

    Facts:
        phi' is constant, also in the midpoint rule.
        u phi' - G sin phi is constant; in the midpoint rule u - (G h / sin(h phi')) sin phi in the middle of steps.
        From rest the blade draws a cycloid.

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
    name, q = "knife_edge_on_incline", np.asarray(configuration)
    G, u0, omega = slope_acceleration, speed, turning
    if omega == 0:
        remedy = "A blade that does not turn falls on a straight line."
        raise error(f"examples.{name}(turning=...)", "not be zero", "0", remedy)
    c = G / omega
    w = u0 - c * np.sin(q[2])

    def antiderivative(phi: Array) -> Array:
        along = w * np.sin(phi) + c * np.sin(phi) ** 2 / 2
        across = -w * np.cos(phi) + c * (phi - np.sin(2 * phi) / 2) / 2
        return np.stack([along, across], axis=-1) / omega

    def exact(time: Array) -> Array:
        phi = q[2] + omega * np.asarray(time)
        return np.concatenate([q[:2] + antiderivative(phi) - antiderivative(q[2]), phi[..., None]], axis=-1)

    def drive(q: Array, v: Array) -> Array:
        return speed_ahead(q, v) * v[..., 2] - G * np.sin(q[..., 2])

    conserved = {"phi'": rate(2), "u phi' - G sin phi": drive}
    v = np.array([u0 * np.cos(q[2]), u0 * np.sin(q[2]), omega])
    return Example(name, _edge_system(mass, inertia, G), q, v, conserved, exact)


@family
def _edge_system() -> LagrangeDAlembert:
    def lagrangian(q: Array, v: Array, p: Numbers) -> Array:
        m, J, G = map(p.__getitem__, _EDGE)
        return jnp.array([m, m, J]) @ v**2 / 2 + m * G * q[0]

    def forms(q: Array, p: Numbers) -> Array:
        return jnp.array([[jnp.sin(q[2]), -jnp.cos(q[2]), 0.0]])

    blade = np.array([[-1.0, 0.0], [1.0, 0.0]])
    options: Any = {"heading": "phi", "outline": lambda _, p: [np.sqrt(p["inertia"] / p["mass"]) * blade]}
    return system_in("x y phi", "Knife edge on an incline", _EDGE, lagrangian, forms, **options)


_SLEIGH = ("mass", "inertia", "moving_mass", "frequency", "a", "ahead", "amplitude")


@ready("configuration speed turning", reals="a ahead amplitude", configuration="x, y and theta")
def driven_sleigh(
    *,
    mass: float = 1.0,
    inertia: float = 0.5,
    a: float = 0.3,
    moving_mass: float = 0.3,
    ahead: float = -0.3,
    amplitude: float = 0.5,
    frequency: float = 1.0,
    configuration: tuple[float, float, float] = (0.0, 0.0, 0.0),
    speed: float = 0.5,
    turning: float = 0.3,
) -> Example:
    r"""A sleigh with a point mass that is moved to and fro across the blade: contact (x, y), heading theta, offset s.

    $$ L = \tfrac m2|\dot c|^2 + \tfrac J2\dot\theta^2 + \tfrac\mu2|\dot r|^2, \qquad
       -\dot x\sin\theta + \dot y\cos\theta = 0, \qquad s = A\sin\Omega t, $$

    with the center of mass c at the body point (a, 0) and the moving mass at r = (d, s). With speed u along the blade
    and turning rate $\omega$ its momenta $p_u = (m + \mu)u - \mu s\omega$, $p_\omega = (J + ma^2)\omega - \mu su +
    \mu s^2\omega + \mu d(d\omega + \dot s)$ obey

    $$ \dot p_u = \omega p_w, \qquad \dot p_\omega = -u p_w, \qquad p_w = ma\,\omega + \mu(d\,\omega + \dot s). $$

    Where the moving mass is level with the blade's contact (d = 0) the speed settles; elsewhere it may grow without
    bound; with the defaults it was seen to grow up to t = 10^4.

    Reference: [bizyaev-borisov-mamaev-2017], where the system and its acceleration are studied.

    Facts:
        The speed grows without bound if the moving mass is on the right side of the contact.
        With the line of the moving mass through the contact the speed settles.

    Args:
        mass: m, of the platform.
        inertia: J, of the platform about its center of mass.
        a: Of the center of mass of the platform in front of the contact.
        moving_mass: mu.
        ahead: d, of the line on which the mass moves in front of the contact.
        amplitude: A.
        frequency: Omega.
        configuration: (x, y, theta) at the start.
        speed: u at the start.
        turning: omega at the start.

    Raises:
        ValueError: A mass, inertia or frequency that is not positive, a wrong shape.

    Example:
        >>> ready = nh.examples.driven_sleigh(amplitude=0.5, frequency=2.0)
        >>> ready.coordinates, ready.body_velocity.tolist()
        (('x', 'y', 'theta', 's'), [0.5, 0.0, 0.3, 1.0])
    """
    body = mass, inertia, moving_mass, frequency, a, ahead, amplitude
    q = np.append(configuration, 0.0)
    v = np.array([speed * np.cos(q[2]), speed * np.sin(q[2]), turning, amplitude * frequency])
    return Example("driven_sleigh", _sleigh_system(*body), q, v, {})


@family
def _sleigh_system() -> LagrangeDAlembert:
    def lagrangian(q: Array, v: Array, p: Numbers) -> Array:
        m, J, mu, _, a, d, _ = map(p.__getitem__, _SLEIGH)
        cos, sin, omega, s = jnp.cos(q[2]), jnp.sin(q[2]), v[2], q[3]
        u, w = cos * v[0] + sin * v[1], cos * v[1] - sin * v[0]
        platform = m * (u**2 + (w + a * omega) ** 2) + J * omega**2
        return (platform + mu * ((u - s * omega) ** 2 + (w + d * omega + v[3]) ** 2)) / 2

    def blade(q: Array, p: Numbers) -> Array:
        return jnp.array([[-jnp.sin(q[2]), jnp.cos(q[2]), 0.0, 0.0]])

    platform = np.array([[-1.0, -0.6], [0.8, -0.6], [1.2, 0.0], [0.8, 0.6], [-1.0, 0.6]])
    contact = np.array([[-0.4, 0.0], [0.4, 0.0]])

    def outline(q: Array, p: Numbers) -> list[Array]:
        size = np.sqrt(p["inertia"] / p["mass"])
        return [[p["a"], 0.0] + size * platform, size * contact, wheel((p["ahead"], q[3]), 0.25 * size)]

    driver = {3: lambda time, p: p["amplitude"] * jnp.sin(p["frequency"] * time)}
    options: Any = {"heading": "theta", "outline": outline, "prescribed": driver}
    return system_in("x y theta s", "Driven sleigh", _SLEIGH, lagrangian, blade, **options)


@ready("speed turning", reals="a stiffness")
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

    Facts:
        The energy is constant.
        With the center of mass at the contact the turning rate is, too.

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
    m, J, k = mass, inertia, stiffness

    import numba

    @numba.njit
    def potential(g: Float[np.ndarray, "3 3"]) -> np.float64:
        return k * (g[0, 2] ** 2 + g[1, 2] ** 2) / 2

    def energy(g: Array, v: Array) -> Array:
        return (m * v[..., 1] ** 2 + (J + m * a**2) * v[..., 0] ** 2 + k * (g[..., :2, 2] ** 2).sum(axis=-1)) / 2

    conserved = {"energy": energy} | ({} if a else {"turning rate": lambda _g, v: v[..., 0]})
    system = Forced(ChaplyginSleigh(m, J, a), potential)
    return Example("sleigh_in_a_well", system, np.eye(3), np.array([turning, speed, 0.0]), conserved)
