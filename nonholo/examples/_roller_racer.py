"""The roller racer, free or driven by its handle."""

import functools

import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import number
from nonholo.base.types import Array
from nonholo.examples._example import Example, numbers, positives, ready
from nonholo.examples._outlines import pair, turn
from nonholo.lagrange_dalembert import LagrangeDAlembert


@ready("configuration", "speed")
def roller_racer(
    *,
    mass: float = 1.0,
    inertia: float = 0.2,
    handle_inertia: float = 0.02,
    center: float = 0.2,
    joint: float = 1.0,
    handle: float = 0.3,
    amplitude: float = 0.5,
    frequency: float = 2.0,
    configuration: tuple[float, float, float] = (0.0, 0.0, 0.0),
    speed: float = 0.0,
) -> Example:
    r"""A seat on an axle and a handle on another, joined by a pivot: rear axle (x, y), heading theta, handle angle phi.

    $$ L = \tfrac m2|\dot c|^2 + \tfrac I2\dot\theta^2 + \tfrac J2(\dot\theta + \dot\varphi)^2, \qquad
       -\dot x\sin\theta + \dot y\cos\theta = 0, \qquad
       -u\sin\varphi + (\ell\cos\varphi + k)\,\dot\theta + k\,\dot\varphi = 0, $$

    u the speed along the seat, the center of mass c in front of the rear axle, the pivot $\ell$ in front of it, and the
    light handle with its axle k beyond the pivot. The rider turns the handle, $\varphi = A\sin\Omega t$, and that alone
    drives the racer from rest. With $\sigma = \sin\varphi/(\ell\cos\varphi + k)$ the momentum along the constraint is
    not conserved,

    $$ \dot p_u + \sigma\,\dot p_\omega = (\dot\theta - \sigma u)\,mc\,\dot\theta, \qquad
       p_u = mu, \quad p_\omega = (I + mc^2)\dot\theta + J(\dot\theta + \dot\varphi). $$

    With amplitude=None the handle is free and the energy is conserved.

    Reference: [krishnaprasad-tsakiris-2001].

    Args:
        mass: m, of the seat with its rider.
        inertia: I, of the seat about its center of mass.
        handle_inertia: J, of the handle, whose mass is neglected.
        center: c, of the center of mass in front of the rear axle.
        joint: l, of the pivot in front of the rear axle.
        handle: k, from the pivot to the axle of the handle.
        amplitude: A; None for a handle that turns freely.
        frequency: Omega; of a free handle its first turning rate is 0.5.
        configuration: (x, y, theta) at the start.
        speed: u at the start.

    Raises:
        ValueError: A length, mass or inertia that is not positive, a wrong shape.

    Example:
        >>> ready = nh.examples.roller_racer()
        >>> ready.coordinates, ready.system.constraints
        (('x', 'y', 'theta', 'phi'), 3)
    """
    name = "roller_racer"
    sizes = {"mass": mass, "inertia": inertia, "handle_inertia": handle_inertia, "joint": joint, "handle": handle}
    body = positives(name, **sizes, frequency=frequency)
    c, u = (float(number(f"examples.{name}({what}=...)", x)) for what, x in {"center": center, "speed": speed}.items())
    A = None if amplitude is None else float(number(f"examples.{name}(amplitude=...)", amplitude))
    q = numbers(name, "configuration", configuration, 3, "x, y and theta")
    turning = 0.5 if A is None else A * body[5]
    heading = -body[4] * turning / (body[3] + body[4])
    v = np.array([u * np.cos(q[2]), u * np.sin(q[2]), heading, turning])
    system = _system(*body, c, A)
    facts = (
        "Turning the handle to and fro drives it from rest.",
        "There is a momentum along the constraint, and it is not conserved.",
    )
    conserved = {} if system.is_driven else {"energy": lambda q, v: _energy(body, c, q, v)}
    return Example(name, system, np.append(q, 0.0), v, facts, conserved)


def _energy(body: list[float], c: float, q: Array, v: Array) -> Array:
    m, seat, J, *_ = body
    u = np.cos(q[..., 2]) * v[..., 0] + np.sin(q[..., 2]) * v[..., 1]
    return (m * u**2 + (seat + m * c**2) * v[..., 2] ** 2 + J * (v[..., 2] + v[..., 3]) ** 2) / 2


@functools.cache
def _system(
    m: float, seat_inertia: float, J: float, ell: float, k: float, Omega: float, c: float, A: float | None
) -> LagrangeDAlembert:
    def lagrangian(q: Array, v: Array) -> Array:
        cos, sin = jnp.cos(q[2]), jnp.sin(q[2])
        u, w = cos * v[0] + sin * v[1], cos * v[1] - sin * v[0]
        return (m * (u**2 + (w + c * v[2]) ** 2) + seat_inertia * v[2] ** 2 + J * (v[2] + v[3]) ** 2) / 2

    def axles(q: Array) -> Array:
        cos, sin = jnp.cos(q[2]), jnp.sin(q[2])
        bent = jnp.sin(q[3])
        front = jnp.array([-bent * cos, -bent * sin, ell * jnp.cos(q[3]) + k, k])
        return jnp.stack([jnp.array([-sin, cos, 0.0, 0.0]), front])

    prescribed = {} if A is None else {3: lambda time: A * jnp.sin(Omega * time)}
    names = ("x", "y", "theta", "phi")
    half = 0.3 * ell
    seat = np.array([[-0.1 * ell, -0.6 * half], [ell, 0.0], [-0.1 * ell, 0.6 * half]])

    def outline(q: Array) -> list[Array]:
        pivot, front = np.array([ell, 0.0]), np.array([ell, 0.0]) + k * turn(q[3])[0]
        bar = np.stack([pivot, front])
        return [seat, *pair((0.0, 0.0), half, 0.5 * half), bar, *pair((front[0], front[1]), half, 0.5 * half, q[3])]

    return LagrangeDAlembert(
        lagrangian,
        axles,
        dimension=4,
        prescribed=prescribed,
        coordinates=names,
        heading="theta",
        outline=outline,
        name="Roller racer",
    )
