"""The car on four wheels, its front wheels steered."""

import functools

import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import error
from nonholo.base.types import Array
from nonholo.examples._example import Example, Numbers, numbers, positives, rate, ready, sized
from nonholo.examples._outlines import pair, wheel
from nonholo.lagrange_dalembert import LagrangeDAlembert

_SIZES = ("mass", "inertia", "wheelbase", "wheel_radius", "wheel_inertia", "steering_inertia")


@ready("configuration", "speed", "steering_rate")
def kinematic_car(
    *,
    mass: float = 1.0,
    inertia: float = 0.3,
    wheelbase: float = 1.0,
    wheel_radius: float = 0.25,
    wheel_inertia: float = 0.01,
    steering_inertia: float = 0.01,
    configuration: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.3),
    speed: float = 1.0,
    steering_rate: float = 0.0,
) -> Example:
    r"""A car: middle of its rear axle (x, y), heading theta, angle psi of the rear wheels, steering angle phi.

    $$ L = \tfrac m2(\dot x^2 + \dot y^2) + \tfrac J2\dot\theta^2 + \tfrac{J_w}2\dot\psi^2
         + \tfrac{J_s}2\dot\varphi^2, $$

    $$ -\dot x\sin\theta + \dot y\cos\theta = 0, \qquad
       -\dot x\sin(\theta + \varphi) + \dot y\cos(\theta + \varphi) + \ell\cos\varphi\,\dot\theta = 0, \qquad
       \dot x\cos\theta + \dot y\sin\theta = \rho\,\dot\psi . $$

    So $\dot\theta = (\rho/\ell)\tan\varphi\,\dot\psi$: the constraints alone say how rolling and steering move the car.
    Without control $\dot\varphi$ and $u\sqrt{m + J_w/\rho^2 + (J/\ell^2)\tan^2\varphi}$ are constant, u the speed of
    the rear axle; with the steering at rest the car drives on a circle of radius $\ell/\tan\varphi$. Where the front
    wheels are across, at $|\varphi| = \pi/2$, the car cannot roll. The angle phi is that of one wheel in the middle;
    pictures turn each front wheel across the line to the center of the circle, so that none slips.

    Reference: [kelly-murray-1995]; [bloch-2003].

    Args:
        mass: m, as if its center were in the middle of the rear axle.
        inertia: J, about that point.
        wheelbase: l, between the axles.
        wheel_radius: rho.
        wheel_inertia: J_w, of the rear wheels about their axle.
        steering_inertia: J_s, of the front wheels as they are steered.
        configuration: (x, y, theta, psi, phi) at the start, phi between -pi/2 and pi/2.
        speed: u at the start.
        steering_rate: phi', which stays.

    Raises:
        ValueError: A parameter that is not positive, a steering angle out of range.

    Example:
        >>> ready = nh.examples.kinematic_car(wheelbase=2.0)
        >>> round(ready.body_velocity[2].item(), 6), round(np.tan(0.3).item() / 2, 6)
        (0.154668, 0.154668)
    """
    name = "kinematic_car"
    wheels = {"wheel_radius": wheel_radius, "wheel_inertia": wheel_inertia, "steering_inertia": steering_inertia}
    m, J, ell, R, Jw, Js = positives(name, mass=mass, inertia=inertia, wheelbase=wheelbase, **wheels)
    q = numbers(name, "configuration", configuration, 5, "x, y, theta, psi and phi")
    if not abs(q[4]) < np.pi / 2:
        where, remedy = f"examples.{name}(configuration=...)", "The front wheels must not be across."
        raise error(where, "have |phi| < pi/2", f"{q[4]:g}", remedy)
    u, turn = numbers(name, "...", (speed, steering_rate), 2, "speed and rate as numbers")
    omega = u / ell * np.tan(q[4])
    v = np.array([u * np.cos(q[2]), u * np.sin(q[2]), omega, u / R, turn])

    def momentum(q: Array, v: Array) -> Array:
        along = v[..., 0] * np.cos(q[..., 2]) + v[..., 1] * np.sin(q[..., 2])
        return along * np.sqrt(m + Jw / R**2 + J / ell**2 * np.tan(q[..., 4]) ** 2)

    def circle(time: Array) -> Array:
        half = omega * time / 2
        chord = u * time * np.sinc(half / np.pi)
        place = chord * np.array([np.cos(q[2] + half), np.sin(q[2] + half)])
        return q + np.array([*place, 2 * half, u / R * time, 0 * time]).T

    conserved = {"phi'": rate(4), "momentum along the constraint": momentum}
    facts = (
        "phi' and the momentum along the constraint are constant.",
        "With the steering at rest it drives on a circle of radius wheelbase / tan phi.",
        "Rolling and steering bring it to every pose: growth (2, 3, 4, 5).",
    )
    return Example(name, sized(_system, m, J, ell, R, Jw, Js), q, v, facts, conserved, None if turn else circle)


@functools.cache
def _system() -> LagrangeDAlembert:
    def lagrangian(q: Array, v: Array, p: Numbers) -> Array:
        del q
        m, J, _, _, Jw, Js = map(p.__getitem__, _SIZES)
        return jnp.array([m, m, J, Jw, Js]) @ v**2 / 2

    def forms(q: Array, p: Numbers) -> Array:
        cos, sin, turned, ell, R = jnp.cos(q[2]), jnp.sin(q[2]), q[2] + q[4], p["wheelbase"], p["wheel_radius"]
        front = jnp.array([-jnp.sin(turned), jnp.cos(turned), ell * jnp.cos(q[4]), 0.0, 0.0])
        return jnp.stack([jnp.array([-sin, cos, 0.0, 0.0, 0.0]), front, jnp.array([cos, sin, 0.0, -R, 0.0])])

    names = ("x", "y", "theta", "psi", "phi")
    board = np.array([[-0.2, -0.22], [1.2, -0.22], [1.2, 0.22], [-0.2, 0.22]])

    def outline(q: Array, p: Numbers) -> list[Array]:
        ell, R = p["wheelbase"], p["wheel_radius"]
        cos, sin, places = np.cos(q[4]), np.sin(q[4]), ((ell, -0.3 * ell), (ell, 0.3 * ell))
        front = [wheel(at, 2 * R, np.arctan2(at[0] * sin, at[0] * cos - at[1] * sin)) for at in places]
        return [ell * board, *pair((0.0, 0.0), 0.3 * ell, 2 * R), *front]

    looks = {"coordinates": names, "heading": "theta", "outline": outline, "name": "Kinematic car"}
    return LagrangeDAlembert(lagrangian, forms, dimension=5, parameters=dict.fromkeys(_SIZES, 1.0), **looks)
