"""The disk that rolls upright, and the one that rolls and tilts."""

import functools
from typing import Any

import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import error, number
from nonholo.base.types import Array
from nonholo.examples._example import Example, Numbers, energy_of, rate, ready, system_in, wheel, with_numbers
from nonholo.lagrange_dalembert import LagrangeDAlembert


@ready("configuration rates", configuration="x, y, theta and phi", rates="theta' and phi'")
def rolling_disk(
    *,
    mass: float = 1.0,
    radius: float = 1.0,
    rolling_inertia: float = 0.5,
    turning_inertia: float = 0.25,
    configuration: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0),
    rates: tuple[float, float] = (1.0, 0.5),
) -> Example:
    r"""A disk that rolls upright without sliding: contact point (x, y), rolling angle theta, heading phi.

    $$ L = \tfrac m2(\dot x^2 + \dot y^2) + \tfrac I2\dot\theta^2 + \tfrac J2\dot\varphi^2, \qquad
       \dot x = R\cos\varphi\,\dot\theta, \quad \dot y = R\sin\varphi\,\dot\theta. $$

    Both rates are constant, and the contact point moves on a circle of radius $R|\dot\theta/\dot\varphi|$. In the
    midpoint rule both are constant too. Its steps are equal chords, turned by $h\dot\varphi$ each, of a circle of
    radius $R\,|\dot\theta_h|\,h / (2\sin(h|\dot\varphi|/2))$; a start from $\dot\theta$ rolls at the rate
    $\dot\theta_h = \dot\theta\,(mR^2 + I)/(mR^2\cos(h\dot\varphi/2) + I)$, which has the same momentum.

    Reference: [bloch-2003], section 1.4.

    Facts:
        theta' and phi' are constant, also in the midpoint rule.
        The contact point moves on a circle.

    Args:
        mass: m.
        radius: R.
        rolling_inertia: I, about the axis of the disk.
        turning_inertia: J, about a diameter.
        configuration: (x, y, theta, phi) at the start.
        rates: (theta', phi') at the start.

    Raises:
        ValueError: A mass, radius or inertia that is not positive, a wrong shape.

    Example:
        >>> ready = nh.examples.rolling_disk(rates=(1.0, np.pi))
        >>> bool(np.abs(ready.exact(np.array([2.0]))[0, :2]).max() < 1e-15)
        True
    """
    q, R, (roll, turn) = np.asarray(configuration), radius, rates

    def exact(time: Array) -> Array:
        t = np.asarray(time)
        # the chord of the arc: its length is that of the arc times sinc, also for phi' = 0
        chord = R * roll * t * np.sinc(turn * t / (2 * np.pi))
        middle = q[3] + turn * t / 2
        x, y = q[0] + chord * np.cos(middle), q[1] + chord * np.sin(middle)
        return np.stack([x, y, q[2] + roll * t, q[3] + turn * t], axis=-1)

    conserved = {"theta'": rate(2), "phi'": rate(3)}
    v = np.array([R * np.cos(q[3]) * roll, R * np.sin(q[3]) * roll, roll, turn])
    system = with_numbers(_disk_system, mass, R, rolling_inertia, turning_inertia)
    return Example("rolling_disk", system, q, v, conserved, exact)


@functools.cache
def _disk_system() -> LagrangeDAlembert:
    def lagrangian(q: Array, v: Array, p: Numbers) -> Array:
        return jnp.array([p["mass"], p["mass"], p["rolling_inertia"], p["turning_inertia"]]) @ v**2 / 2

    def forms(q: Array, p: Numbers) -> Array:
        R = p["radius"]
        return jnp.array([[1.0, 0.0, -R * jnp.cos(q[3]), 0.0], [0.0, 1.0, -R * jnp.sin(q[3]), 0.0]])

    options: Any = {"heading": "phi", "outline": lambda _, p: [wheel((0.0, 0.0), 2 * p["radius"], width=0.1)]}
    options["parameters"] = dict.fromkeys(("mass", "radius", "rolling_inertia", "turning_inertia"), 1.0)
    return system_in("x y theta phi", "Rolling disk", lagrangian, forms, **options)


@ready("configuration turning lean_rate rolling", reals="turning lean_rate", configuration="x, y, theta, lean and roll")
def tilting_disk(
    *,
    mass: float = 1.0,
    radius: float = 1.0,
    rolling_inertia: float = 0.5,
    turning_inertia: float = 0.25,
    gravity: float = 1.0,
    configuration: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.3, 0.0),
    turning: float = -0.3,
    lean_rate: float = 0.0,
    rolling: float | None = None,
) -> Example:
    r"""A thin disk that rolls without sliding, and may fall: contact (x, y), heading theta, lean, rolling angle roll.

    The lean $\phi$ is positive to the right; the rolling angle $\rho$ is measured from the highest point. With the
    turning $\Omega = \dot\theta$ and the whole rate about the axle, $\omega = \dot\rho + \Omega\sin\phi$,

    $$ L = \tfrac m2|v|^2 + \tfrac J2(\dot\phi^2 + \Omega^2\cos^2\phi) + \tfrac I2\omega^2 - mgR\cos\phi, \qquad
       \dot x = R\cos\theta\,\dot\rho, \quad \dot y = R\sin\theta\,\dot\rho, $$

    v the velocity of the middle. The balance of momentum and angular momentum is

    $$ (J + mR^2)\ddot\phi = (I + mR^2)\,\omega\,\Omega\cos\phi - J\Omega^2\sin\phi\cos\phi + mgR\sin\phi, \qquad
       (I + mR^2)\,\dot\omega = -mR^2\,\Omega\cos\phi\,\dot\phi, $$

    and $J(\Omega\cos\phi)^{\textstyle\cdot} = (J\Omega\sin\phi - I\omega)\,\dot\phi$. At constant lean,

    $$ (J\Omega\sin\phi - (I + mR^2)\,\omega)\,\Omega\cos\phi = mgR\sin\phi, $$

    the contact runs on a circle of radius $R|\dot\rho/\Omega|$. Upright it rolls straight on without falling if
    $I(I + mR^2)\,\omega^2 > mgRJ$: a uniform disk faster than $\sqrt{gR/3}$.

    Lagrange's equations of the three angles alone, without the rolling as a constraint, are others (sympy#27631).

    Reference: [neimark-fufaev-1972]; [bloch-2003], section 1.4.

    Args:
        mass: m.
        radius: R.
        rolling_inertia: I, about the axle.
        turning_inertia: J, about a diameter.
        gravity: g.
        configuration: (x, y, theta, lean, roll) at the start, the lean between -pi/2 and pi/2.
        turning: $\Omega$ at the start.
        lean_rate: $\dot\phi$ at the start.
        rolling: $\dot\rho$ at the start; None for that of the circle with this lean and turning.

    Raises:
        ValueError: A mass, radius, inertia or gravity that is not positive, a disk that lies, a circle without turning.

    Example:
        >>> ready = nh.examples.tilting_disk()
        >>> orbit = ready.flow(times=(0.0, 5.0))
        >>> bool(np.allclose(orbit.configuration, ready.exact(orbit.time), rtol=0, atol=1e-9))
        True
    """
    name, q, turn, falling = "tilting_disk", np.asarray(configuration), turning, lean_rate
    m, R, axle, J, g = mass, radius, rolling_inertia, turning_inertia, gravity
    if not abs(q[3]) < np.pi / 2:
        raise error(f"examples.{name}(configuration=...)", "have |lean| < pi/2", f"{q[3]:g}", "The disk must not lie.")
    sin, steady = np.sin(q[3]), rolling is None and falling == 0.0
    if rolling is None:
        if turn == 0.0:
            raise error(f"examples.{name}(turning=...)", "not be zero on a circle", "0", "Pass `rolling`, too.")
        rolling = (J * turn * sin - m * g * R * np.tan(q[3]) / turn) / (axle + m * R**2) - turn * sin
    roll = float(number(f"examples.{name}(rolling=...)", rolling))

    def circle(time: Array) -> Array:
        half = turn * np.asarray(time) / 2
        chord = R * roll * np.asarray(time) * np.sinc(half / np.pi)
        place = chord * np.array([np.cos(q[2] + half), np.sin(q[2] + half)])
        return q + np.array([*place, 2 * half, 0.0 * half, roll * np.asarray(time)]).T

    facts = (
        "At constant lean it runs on a circle; the default start does.",
        "Upright it rolls on without falling if it is faster than sqrt(g R / 3), a uniform disk.",
    )
    v = np.array([R * np.cos(q[2]) * roll, R * np.sin(q[2]) * roll, turn, falling, roll])
    system = with_numbers(_tilting_system, m, R, axle, J, g)
    exact = circle if steady else None
    return Example(name, system, q, v, {"energy": energy_of(system.plain.lagrangian)}, exact, facts=facts)


_TILTING = ("mass", "radius", "rolling_inertia", "turning_inertia", "gravity")


@functools.cache
def _tilting_system() -> LagrangeDAlembert:
    def lagrangian(q: Array, v: Array, p: Numbers) -> Array:
        m, R, axle, J, g = map(p.__getitem__, _TILTING)
        cos, sin, rise, lean = jnp.cos(q[2]), jnp.sin(q[2]), jnp.cos(q[3]), jnp.sin(q[3])
        ahead, left = cos * v[0] + sin * v[1], cos * v[1] - sin * v[0]
        middle = (ahead + R * lean * v[2]) ** 2 + (left - R * rise * v[3]) ** 2 + (R * lean * v[3]) ** 2
        turning = J * (v[3] ** 2 + (rise * v[2]) ** 2) + axle * (v[4] + lean * v[2]) ** 2
        return (m * middle + turning) / 2 - m * g * R * rise

    def forms(q: Array, p: Numbers) -> Array:
        ahead, left = -p["radius"] * jnp.cos(q[2]), -p["radius"] * jnp.sin(q[2])
        return jnp.array([[1.0, 0.0, 0.0, 0.0, ahead], [0.0, 1.0, 0.0, 0.0, left]])

    options: Any = {"heading": "theta", "outline": _outline, "parameters": dict.fromkeys(_TILTING, 1.0)}
    return system_in("x y theta lean roll", "Tilting disk", lagrangian, forms, **options)


def _outline(q: Array, p: Numbers) -> list[Array]:
    """Return the rim and a spoke as they look from above, and the piece of the rim that touches the ground."""
    R = p["radius"]
    angle = np.linspace(0.0, 2 * np.pi, 49)
    across = -R * np.sin(q[3])  # of the middle, to the left
    rim = np.stack([R * np.sin(angle), across * (1 - np.cos(angle))], axis=1)
    spoke = np.array([[0.0, across], [R * np.sin(q[4]), across * (1 + np.cos(q[4]))]])
    return [rim, wheel((0.0, 0.0), 0.6 * R, width=0.1), spoke]
