"""The Chaplygin sleigh that a moving mass drives."""

import functools

import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import number
from nonholo.base.types import Array
from nonholo.examples._example import Example, Numbers, numbers, positives, ready, sized
from nonholo.examples._outlines import wheel
from nonholo.lagrange_dalembert import LagrangeDAlembert

_SIZES = ("mass", "inertia", "moving_mass", "frequency", "a", "ahead", "amplitude")


@ready("configuration", "speed", "turning")
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
    name = "driven_sleigh"
    body = positives(name, mass=mass, inertia=inertia, moving_mass=moving_mass, frequency=frequency)
    given = {"a": a, "ahead": ahead, "amplitude": amplitude, "speed": speed, "turning": turning}
    a, d, A, u, omega = (float(number(f"examples.{name}({what}=...)", value)) for what, value in given.items())
    q = numbers(name, "configuration", configuration, 3, "x, y and theta")
    v = np.array([u * np.cos(q[2]), u * np.sin(q[2]), omega, A * body[3]])
    facts = (
        "The speed grows without bound if the moving mass is on the right side of the contact.",
        "With the line of the moving mass through the contact the speed settles.",
    )
    return Example(name, sized(_system, *body, a, d, A), np.append(q, 0.0), v, facts, {})


@functools.cache
def _system() -> LagrangeDAlembert:
    def lagrangian(q: Array, v: Array, p: Numbers) -> Array:
        m, J, mu, _, a, d, _ = map(p.__getitem__, _SIZES)
        cos, sin, omega, s = jnp.cos(q[2]), jnp.sin(q[2]), v[2], q[3]
        u, w = cos * v[0] + sin * v[1], cos * v[1] - sin * v[0]
        platform = m * (u**2 + (w + a * omega) ** 2) + J * omega**2
        return (platform + mu * ((u - s * omega) ** 2 + (w + d * omega + v[3]) ** 2)) / 2

    def blade(q: Array, p: Numbers) -> Array:
        del p
        return jnp.array([[-jnp.sin(q[2]), jnp.cos(q[2]), 0.0, 0.0]])

    platform = np.array([[-1.0, -0.6], [0.8, -0.6], [1.2, 0.0], [0.8, 0.6], [-1.0, 0.6]])
    contact = np.array([[-0.4, 0.0], [0.4, 0.0]])

    def outline(q: Array, p: Numbers) -> list[Array]:
        size = np.sqrt(p["inertia"] / p["mass"])
        return [[p["a"], 0.0] + size * platform, size * contact, wheel((p["ahead"], q[3]), 0.25 * size)]

    names = ("x", "y", "theta", "s")
    prescribed = {3: lambda time, p: p["amplitude"] * jnp.sin(p["frequency"] * time)}
    return LagrangeDAlembert(
        lagrangian,
        blade,
        dimension=4,
        parameters=dict.fromkeys(_SIZES, 1.0),
        prescribed=prescribed,
        coordinates=names,
        heading="theta",
        outline=outline,
        name="Driven sleigh",
    )
