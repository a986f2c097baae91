"""The robot on two driven wheels: a differential drive, free or with torques and friction."""

import functools
from typing import Any

import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import error, number
from nonholo.base.types import Array
from nonholo.examples._example import Example, numbers, positives, ready
from nonholo.examples._outlines import wheel
from nonholo.lagrange_dalembert import LagrangeDAlembert


@ready("configuration", "speed", "turning")
def two_wheeled_robot(
    *,
    mass: float = 1.0,
    inertia: float = 0.5,
    offset: float = 0.3,
    half_width: float = 0.5,
    wheel_radius: float = 0.25,
    wheel_inertia: float = 0.01,
    configuration: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0),
    speed: float = -0.5,
    turning: float = 1.0,
    torques: Any = None,
    friction: float = 0.0,
) -> Example:
    r"""A differential drive: middle of the axle (x, y), heading theta, wheel angles right and left.

    $$ L = \tfrac m2(\dot x^2 + \dot y^2) + m\ell\,\dot\theta(\dot y\cos\theta - \dot x\sin\theta)
         + \tfrac12(J + m\ell^2)\dot\theta^2 + \tfrac12 J_w(\dot\varphi_r^2 + \dot\varphi_l^2), $$

    $$ -\dot x\sin\theta + \dot y\cos\theta = 0, \qquad
       \dot x\cos\theta + \dot y\sin\theta = \tfrac R2(\dot\varphi_r + \dot\varphi_l), \qquad
       \dot\theta = \tfrac R{2c}(\dot\varphi_r - \dot\varphi_l). $$

    The last one is integrable: $\theta - \tfrac R{2c}(\varphi_r - \varphi_l)$ is constant. Speed u and turning rate
    $\omega$ move as those of a Chaplygin sleigh with $M = m + 2J_w/R^2$, $K = J + m\ell^2 + 2J_wc^2/R^2$,

    $$ M\dot u = m\ell\,\omega^2, \qquad K\dot\omega = -m\ell\,u\,\omega, \qquad
       u = u_\infty\tanh\kappa(t - t_0), \quad \omega = \omega_0\,\mathrm{sech}\,\kappa(t - t_0), $$

    with $u_\infty = \mathrm{sgn}(\ell)\sqrt{2E/M}$, $|\omega_0| = \sqrt{2E/K}$, $\kappa = m\ell u_\infty/K$. With the
    center of mass on the axle both are constant and the robot drives on a circle.

    Motors turn the wheels against viscous friction with the torques $\tau_r - d\,\dot\varphi_r$ and
    $\tau_l - d\,\dot\varphi_l$; then, with $\dot\varphi = (u \pm c\,\omega)/R$,

    $$ M\dot u = m\ell\,\omega^2 + (\tau_r + \tau_l)/R - 2du/R^2, \qquad
       K\dot\omega = -m\ell\,u\,\omega + (\tau_r - \tau_l)\,c/R - 2dc^2\omega/R^2. $$

    Reference: [neimark-fufaev-1972] for the equations; [bloch-2003], section 1.7, for the sleigh.

    Args:
        mass: m, with the wheels.
        inertia: J, about the center of mass.
        offset: l, of the center of mass in front of the axle.
        half_width: c, half the distance of the wheels.
        wheel_radius: R.
        wheel_inertia: J_w, of one wheel about its axle.
        configuration: (x, y, theta, right, left) at the start.
        speed: u at the start.
        turning: omega at the start.
        torques: A function of the time that returns $(\tau_r, \tau_l)$, written with `jax.numpy`; or two numbers.
        friction: d, of each wheel.

    Raises:
        ValueError: A parameter that is not positive, a wrong shape, a negative friction.

    Example:
        >>> ready = nh.examples.two_wheeled_robot()
        >>> discrete = ready.system.discretize(0.05)
        >>> orbit = discrete.simulate(
        ...     configuration=ready.configuration, body_velocity=ready.body_velocity, steps=1000)
        >>> float(np.ptp(ready.conserved["axle"](orbit.configuration, orbit.body_velocity)).round(9))
        0.0
    """
    name = "two_wheeled_robot"
    wheels = {"half_width": half_width, "wheel_radius": wheel_radius, "wheel_inertia": wheel_inertia}
    m, J, c, R, Jw = positives(name, mass=mass, inertia=inertia, **wheels)
    given = {"offset": offset, "speed": speed, "turning": turning, "friction": friction}
    ell, u, omega, d = (float(number(f"examples.{name}({what}=...)", value)) for what, value in given.items())
    if d < 0:
        raise error(f"examples.{name}(friction=...)", "not be negative", f"{d:g}", "Pass the friction of a wheel.")
    q = numbers(name, "configuration", configuration, 5, "x, y, theta, right and left")
    M, K = m + 2 * Jw / R**2, J + m * ell**2 + 2 * Jw * c**2 / R**2
    v = np.array([u * np.cos(q[2]), u * np.sin(q[2]), omega, (u + c * omega) / R, (u - c * omega) / R])

    def energy(q: Array, v: Array) -> Array:
        along = v[..., 0] * np.cos(q[..., 2]) + v[..., 1] * np.sin(q[..., 2])
        return (M * along**2 + K * v[..., 2] ** 2) / 2

    def axle(q: Array, v: Array) -> Array:
        del v
        return q[..., 2] - R / (2 * c) * (q[..., 3] - q[..., 4])

    motors = _motors(torques)
    free = motors is None and d == 0
    conserved = {"axle": axle, **({"energy of the sleigh": energy} if free else {})}
    facts = (
        "Speed and turning rate are those of a Chaplygin sleigh.",
        "One constraint is integrable: theta - R (right - left) / (2 c) is constant, also in the midpoint rule.",
        "The discrete energy settles to a constant; it does not drift.",
    )
    system = _system(m, J + m * ell**2, ell, c, R, Jw, motors, d)
    return Example(name, system, q, v, facts, conserved)


def _motors(torques: Any) -> Any:
    """Return torques as a function of the time, or None."""
    if torques is None or callable(torques):
        return torques
    right, left = numbers("two_wheeled_robot", "torques", torques, 2, "a function of the time, or two torques").tolist()
    return lambda time: (right + 0.0 * time, left + 0.0 * time)


@functools.cache
def _system(
    m: float, about_axle: float, ell: float, c: float, R: float, Jw: float, motors: Any, d: float
) -> LagrangeDAlembert:
    def lagrangian(q: Array, v: Array) -> Array:
        across = v[1] * jnp.cos(q[2]) - v[0] * jnp.sin(q[2])
        return jnp.array([m, m, about_axle, Jw, Jw]) @ v**2 / 2 + m * ell * v[2] * across

    def forms(q: Array) -> Array:
        cos, sin = jnp.cos(q[2]), jnp.sin(q[2])
        turn = R / (2 * c)
        return jnp.array([[-sin, cos, 0.0, 0.0, 0.0], [cos, sin, 0.0, -R / 2, -R / 2], [0.0, 0.0, 1.0, -turn, turn]])

    def force(time: Array, q: Array, v: Array) -> Array:
        del q
        right, left = (0.0, 0.0) if motors is None else motors(time)
        return jnp.array([0.0, 0.0, 0.0, right - d * v[3], left - d * v[4]])

    chassis = c * np.array([[-0.7, -0.75], [0.7, -0.75], [1.2, -0.3], [1.2, 0.3], [0.7, 0.75], [-0.7, 0.75]])
    return LagrangeDAlembert(
        lagrangian,
        forms,
        dimension=5,
        force=None if motors is None and d == 0 else force,
        coordinates=("x", "y", "theta", "right", "left"),
        heading="theta",
        outline=[chassis, wheel((0.0, -c), 2 * R), wheel((0.0, c), 2 * R)],
        name="Two-wheeled robot",
    )
