"""The snakeboard without a rider's control."""

import functools

import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import error
from nonholo.base.types import Array
from nonholo.examples._example import Example, Numbers, numbers, positives, rate, ready, sized
from nonholo.examples._outlines import pair, turn
from nonholo.lagrange_dalembert import LagrangeDAlembert

_SIZES = ("mass", "half_length", "rotor_inertia", "wheel_inertia")


@ready("configuration", "speed", "rotor_rate", "wheel_rate")
def snakeboard(
    *,
    mass: float = 1.0,
    half_length: float = 1.0,
    rotor_inertia: float = 0.5,
    wheel_inertia: float = 0.1,
    configuration: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 1.0),
    speed: float = 1.0,
    rotor_rate: float = 0.4,
    wheel_rate: float = -0.05,
) -> Example:
    r"""A board on two steered wheel pairs with a rotor: place (x, y), heading theta, rotor angle psi, steering phi.

    The front wheels are turned by phi, the rear ones by -phi. With the usual simplification of the inertias

    $$ L = \tfrac m2(\dot x^2 + \dot y^2) + \tfrac12 m r^2\dot\theta^2 + \tfrac12 J_0\dot\psi^2 + J_0\dot\psi\dot\theta
         + J_1\dot\varphi^2, $$

    $$ -\sin(\theta \pm \varphi)\,\dot x + \cos(\theta \pm \varphi)\,\dot y \pm r\cos\varphi\,\dot\theta = 0 . $$

    So the board moves along its axis with a speed u, and $\dot\theta = (u/r)\tan\varphi$. Without control
    $\dot\varphi$ and $J_0(\dot\theta + \dot\psi)$ are constant, and with the energy so is the momentum along the
    constraint, $u\sqrt{m + (m - J_0/r^2)\tan^2\varphi}$. The forms are dependent at $|\varphi| = \pi/2$,
    where the wheels are crossed: there the motion ends, with `branch_unverified`.

    Reference: [bloch-krishnaprasad-marsden-murray-1996].

    Args:
        mass: m.
        half_length: r, from the center to the wheels.
        rotor_inertia: J_0, less than m r^2.
        wheel_inertia: J_1, of one wheel pair.
        configuration: (x, y, theta, psi, phi) at the start, phi between -pi/2 and pi/2.
        speed: u at the start.
        rotor_rate: psi' at the start.
        wheel_rate: phi', which stays.

    Raises:
        ValueError: A parameter that is not positive, a rotor that is too heavy, a steering angle out of range.

    Example:
        >>> ready = nh.examples.snakeboard()
        >>> [round(float(f(ready.configuration, ready.body_velocity)), 6) for f in ready.conserved.values()]
        [-0.05, 1.957408, 1.487535]
    """
    where, inertias = "examples.snakeboard", {"rotor_inertia": rotor_inertia, "wheel_inertia": wheel_inertia}
    m, r, J0, J1 = positives("snakeboard", mass=mass, half_length=half_length, **inertias)
    if m * r * r <= J0:
        raise error(f"{where}(rotor_inertia=...)", f"be less than m r^2 = {m * r * r:g}", f"{J0:g}", "Lighten it.")
    q = numbers("snakeboard", "configuration", configuration, 5, "x, y, theta, psi and phi")
    if not abs(q[4]) < np.pi / 2:
        raise error(f"{where}(configuration=...)", "have |phi| < pi/2", f"{q[4]:g}", "The wheels must not be crossed.")
    u, rotor, wheel = numbers("snakeboard", "...", (speed, rotor_rate, wheel_rate), 3, "speed and rates as numbers")
    v = np.array([u * np.cos(q[2]), u * np.sin(q[2]), u / r * np.tan(q[4]), rotor, wheel])

    def spin(q: Array, v: Array) -> Array:
        del q
        return v[..., 2] + v[..., 3]

    def momentum(q: Array, v: Array) -> Array:
        along = v[..., 0] * np.cos(q[..., 2]) + v[..., 1] * np.sin(q[..., 2])
        return along * np.sqrt(m + (m - J0 / r**2) * np.tan(q[..., 4]) ** 2)

    conserved = {"phi'": rate(4), "theta' + psi'": spin, "momentum along the constraint": momentum}
    facts = (
        "phi' and theta' + psi' are constant, also in the midpoint rule.",
        "The momentum along the constraint is constant.",
        "The motion ends where the wheels are crossed, at |phi| = pi/2.",
    )
    return Example("snakeboard", sized(_system, m, r, J0, J1), q, v, facts, conserved)


@functools.cache
def _system() -> LagrangeDAlembert:
    def lagrangian(q: Array, v: Array, p: Numbers) -> Array:
        del q
        m, r, J0, J1 = map(p.__getitem__, _SIZES)
        return jnp.array([m, m, m * r * r, J0, 2 * J1]) @ v**2 / 2 + J0 * v[2] * v[3]

    def forms(q: Array, p: Numbers) -> Array:
        theta, phi, r = q[2], q[4], p["half_length"]

        def row(side: float) -> Array:
            turned = theta + side * phi
            return jnp.array([-jnp.sin(turned), jnp.cos(turned), side * r * jnp.cos(phi), 0.0, 0.0])

        return jnp.stack([row(1.0), row(-1.0)])

    names = ("x", "y", "theta", "psi", "phi")
    board = np.array([[-1.15, -0.12], [1.15, -0.12], [1.15, 0.12], [-1.15, 0.12]])

    def outline(q: Array, p: Numbers) -> list[Array]:
        r = p["half_length"]
        rotor = 0.45 * r * np.array([[-1.0, 0.0], [1.0, 0.0]]) @ turn(q[3])
        return [r * board, rotor, *pair((r, 0.0), 0.35 * r, 0.3 * r, q[4]), *pair((-r, 0.0), 0.35 * r, 0.3 * r, -q[4])]

    return LagrangeDAlembert(
        lagrangian,
        forms,
        dimension=5,
        parameters=dict.fromkeys(_SIZES, 1.0),
        coordinates=names,
        heading="theta",
        outline=outline,
        name="Snakeboard",
    )
