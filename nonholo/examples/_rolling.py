"""Balls and disks that roll without sliding: on a plane, in a bowl, on a table that turns, upright and tilted."""

from typing import Any

import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import error, number
from nonholo.base.types import Array
from nonholo.examples._example import Example, Numbers, family, ready, system_in
from nonholo.examples._formulas import energy_of, on_circle, rate, wheel
from nonholo.groups import SE, SO
from nonholo.lagrange_dalembert import GroupLagrangeDAlembert, LagrangeDAlembert


@ready("angular_velocity", positive="inertia", inertia="three moments", angular_velocity="three components")
def chaplygin_ball(
    *,
    mass: float = 1.0,
    radius: float = 1.0,
    inertia: tuple[float, float, float] = (0.3, 0.4, 0.5),
    angular_velocity: tuple[float, float, float] = (0.4, 0.3, 1.0),
) -> Example:
    r"""A ball on SE(3) with principal moments of inertia I about its middle, which rolls without sliding.

    $$ L = \tfrac12\omega\cdot I\omega + \tfrac m2|v|^2, \qquad v = r\,\omega\times\gamma, \qquad \gamma = R^Te_3, $$

    v the velocity of the middle seen from the ball. The constraint depends on the pose, so that the discrete principle
    is that of `GroupLagrangeDAlembert`. With the angular momentum about the contact,

    $$ M = I\omega + mr^2\,\gamma\times(\omega\times\gamma), \qquad \dot M = M\times\omega, \quad
       \dot\gamma = \gamma\times\omega: $$

    $R M$ is constant in space, and the energy $\tfrac12\omega\cdot M$.

    Reference: [chaplygin-1903].

    Facts:
        The angular momentum about the contact is constant in space, and so is the energy.
        The middle moves at constant height.

    Args:
        mass: m.
        radius: r.
        inertia: Principal moments I.
        angular_velocity: omega at the start, seen from the ball.

    Raises:
        ValueError: A mass, radius or moment that is not positive, moments of no body, a wrong shape.

    Example:
        >>> ready = nh.examples.chaplygin_ball()
        >>> ready.conserved["momentum along z"](ready.configuration, ready.body_velocity).round(3)
        np.float64(0.5)
    """
    v = np.append(angular_velocity, radius * np.cross(angular_velocity, (0.0, 0.0, 1.0)))

    def momentum(g: Array, v: Array) -> Array:
        R = g[..., :3, :3]
        gamma, omega = R[..., 2, :], v[..., :3]
        own = omega * inertia + mass * radius**2 * np.cross(gamma, np.cross(omega, gamma))
        return (R @ own[..., None])[..., 0]

    conserved = {f"momentum along {axis}": lambda g, v, i=i: momentum(g, v)[..., i] for i, axis in enumerate("xyz")}
    return Example("chaplygin_ball", _rolling_ball(mass, radius, inertia), np.eye(4), v, conserved)


@family
def _rolling_ball() -> GroupLagrangeDAlembert:
    def action(W: Array, time_step: Array, p: Numbers) -> Array:
        moments = p["inertia"]
        masses = jnp.append(jnp.sum(moments) / 2 - moments, p["mass"])
        return masses @ ((W - jnp.eye(4)) ** 2).sum(axis=0) / (2 * time_step)

    def lagrangian(w: Array, p: Numbers) -> Array:
        return (p["inertia"] @ w[:3] ** 2 + p["mass"] * w[3:] @ w[3:]) / 2

    def forms(g: Array, p: Numbers) -> Array:
        return jnp.concatenate([p["radius"] * SO(3).hat(g[2, :3]), jnp.eye(3)], axis=1)

    numbers = {"mass": 1.0, "radius": 1.0, "inertia": np.ones(3)}
    options: Any = {"lagrangian": lagrangian, "parameters": numbers, "name": "Chaplygin's ball"}
    return GroupLagrangeDAlembert(SE(3), action, forms, **options)


@ready("place velocity spin", place="x and y", velocity="x and y")
def ball_in_bowl(
    *,
    mass: float = 1.0,
    radius: float = 0.2,
    inertia: float = 0.016,
    reach: float = 1.0,
    gravity: float = 1.0,
    place: tuple[float, float] = (0.6, 0.0),
    velocity: tuple[float, float] = (0.0, 0.4),
    spin: float = 3.0,
) -> Example:
    r"""A uniform ball that rolls in a round bowl: middle (x, y) seen from above, turns alpha, beta, gamma.

    The turns are integrals of the angular velocity about the axes of space: equations of a uniform ball contain no more
    of its orientation. With the middle at $c = \rho n$ from that of the bowl, in its lower half, and z its height,

    $$ L = \tfrac m2|\dot c|^2 + \tfrac J2|\omega|^2 - mgz, \qquad \dot c = -r\,\omega\times n, $$

    of which the horizontal part suffices. The spin $s = \omega\cdot n$ is constant, and

    $$ n\times\ddot n = \kappa s\,\dot n + \frac{mr^2}{J + mr^2}\,\frac1\rho\,n\times g, \qquad
       \kappa = \frac{Jr}{\rho\,(J + mr^2)}: $$

    without spin that is a spherical pendulum of the length $\rho$ with five sevenths of the weight. So the energy and
    $e_z\cdot(n\times\dot n) - \kappa s\,n_z$ are constant, too.

    Reference: [neimark-fufaev-1972].

    Facts:
        Without spin it moves like a spherical pendulum with five sevenths of its weight.
        Spin, energy and a momentum about the vertical are constant.

    Args:
        mass: m.
        radius: r.
        inertia: J, about a diameter.
        reach: rho, the radius of the bowl less that of the ball.
        gravity: g.
        place: (x, y) at the start, less than rho from the axis.
        velocity: (x', y') at the start.
        spin: s, about the normal that points down and out.

    Raises:
        ValueError: A mass, radius, inertia or gravity that is not positive, a place beyond the rim, a wrong shape.

    Example:
        >>> ready = nh.examples.ball_in_bowl()
        >>> list(ready.conserved)
        ['spin', 'momentum', 'energy']
    """
    c = np.asarray(place)
    if not c @ c < reach**2:
        where, demand = "examples.ball_in_bowl(place=...)", f"be less than {reach:g} from the axis"
        raise error(where, demand, str(c.tolist()), "Start in the bowl.")
    q = np.append(c, np.zeros(3))
    n, dn = _normal(reach, q, np.append(velocity, np.zeros(3)))
    kappa = inertia * radius / (reach * (inertia + mass * radius**2))

    def spinning(q: Array, v: Array) -> Array:
        return (_normal(reach, q, v)[0] * v[..., 2:]).sum(axis=-1)

    def momentum(q: Array, v: Array) -> Array:
        n, dn = _normal(reach, q, v)
        return np.cross(n, dn)[..., 2] - kappa * spinning(q, v) * n[..., 2]

    system = _bowl_system(mass, radius, inertia, reach, gravity)
    conserved = {"spin": spinning, "momentum": momentum, "energy": energy_of(system)}
    turns = spin * n - reach / radius * np.cross(n, dn)
    return Example("ball_in_bowl", system, q, np.append(velocity, turns), conserved)


def _normal(rho: float, q: Array, v: Array) -> tuple[Array, Array]:
    """Return the outward normals at places, and their rates."""
    depth = np.sqrt(rho**2 - q[..., 0] ** 2 - q[..., 1] ** 2)
    falling = (q[..., 0] * v[..., 0] + q[..., 1] * v[..., 1]) / depth
    n, dn = (np.stack(each, axis=-1) for each in ((q[..., 0], q[..., 1], -depth), (v[..., 0], v[..., 1], falling)))
    return n / rho, dn / rho


_BOWL = ("mass", "radius", "inertia", "reach", "gravity")


@family
def _bowl_system() -> LagrangeDAlembert:
    def lagrangian(q: Array, v: Array, p: Numbers) -> Array:
        m, _, J, rho, g = map(p.__getitem__, _BOWL)
        depth = jnp.sqrt(rho**2 - q[0] ** 2 - q[1] ** 2)
        falling = (q[0] * v[0] + q[1] * v[1]) / depth
        return (m * (v[0] ** 2 + v[1] ** 2 + falling**2) + J * (v[2:] @ v[2:])) / 2 + m * g * depth

    def forms(q: Array, p: Numbers) -> Array:
        r, rho = p["radius"], p["reach"]
        x, y, z = q[0] / rho, q[1] / rho, -jnp.sqrt(rho**2 - q[0] ** 2 - q[1] ** 2) / rho
        ahead = jnp.stack([1.0 + 0 * x, 0 * x, 0 * x, r * z, -r * y])
        return jnp.stack([ahead, jnp.stack([0 * x, 1.0 + 0 * x, -r * z, 0 * x, r * x])])

    return system_in("x y alpha beta gamma", "Ball in a bowl", _BOWL, lagrangian, forms)


@ready("place velocity", reals="table_rate", place="x and y", velocity="x' and y'")
def ball_on_turntable(
    *,
    mass: float = 1.0,
    radius: float = 1.0,
    inertia: float = 0.4,
    table_rate: float = 1.0,
    place: tuple[float, float] = (1.0, 0.0),
    velocity: tuple[float, float] = (0.0, 0.5),
) -> Example:
    r"""A uniform ball that rolls without sliding on a table which is driven round: middle (x, y), turns alpha, beta.

    The turns are integrals of the angular velocity about the x and y axes of space. They are no coordinates of the
    orientation, but the equations of a uniform ball contain no more of it; its spin about the vertical is constant.

    $$ L = \tfrac m2(\dot x^2 + \dot y^2) + \tfrac J2(\dot\alpha^2 + \dot\beta^2), \qquad
       \dot x - r\dot\beta = -\Omega y, \quad \dot y + r\dot\alpha = \Omega x . $$

    The constraint moves: the table does work, and the energy is not constant. The middle runs on a circle at the rate
    $\kappa = \Omega\,J/(J + mr^2)$, two sevenths of that of the table for a solid ball: $\ddot x = -\kappa\dot y$,
    $\ddot y = \kappa\dot x$. In the midpoint rule it does, too, and each step turns by $2\arctan(h\kappa/2)$.

    Reference: [neimark-fufaev-1972].

    Facts:
        The middle runs on a circle, at 2/7 of the rate of the table.
        So it does in the midpoint rule.

    Args:
        mass: m.
        radius: r.
        inertia: J, about a diameter.
        table_rate: Omega.
        place: (x, y) of the middle at the start, from the axis of the table.
        velocity: (x', y') at the start, in space.

    Raises:
        ValueError: A mass, radius or inertia that is not positive, a wrong shape.

    Example:
        >>> ready = nh.examples.ball_on_turntable(table_rate=3.5 * np.pi)
        >>> np.abs(ready.exact(np.array([2.0]))[0, :2] - ready.configuration[:2]).max() < 1e-14
        np.True_
    """
    (x, y), (u, w) = place, velocity
    m, r, J, Omega = mass, radius, inertia, table_rate
    kappa = Omega * J / (J + m * r**2)

    def exact(time: Array) -> Array:
        t = np.asarray(time)
        middle = _circle(x + 1j * y, u + 1j * w, kappa, t)
        # the constraint, integrated: r (beta - i alpha) = z - z0 - i Omega integral of z
        turns = (middle - (x + 1j * y) - 1j * Omega * _area(x + 1j * y, u + 1j * w, kappa, t)) / r
        return np.stack([middle.real, middle.imag, -turns.imag, turns.real], axis=-1)

    conserved = {
        "x' + kappa y": lambda q, v: v[..., 0] + kappa * q[..., 1],
        "y' - kappa x": lambda q, v: v[..., 1] - kappa * q[..., 0],
    }
    q, v = np.array([x, y, 0.0, 0.0]), np.array([u, w, (Omega * x - w) / r, (u + Omega * y) / r])
    return Example("ball_on_turntable", _turntable_system(m, r, J, Omega), q, v, conserved, exact)


def _circle(z: complex, velocity: complex, kappa: float, t: Array) -> Array:
    half = kappa * t / 2
    return z + velocity * t * np.sinc(half / np.pi) * np.exp(1j * half)


def _area(z: complex, velocity: complex, kappa: float, t: Array) -> Array:
    """Return the integral of the place, accurate also where kappa is zero."""
    half = kappa * t / 2
    # (e^{i s} - 1 - i s) / (i s)^2 = (sinc(s/2) e^{is/2} - 1) / (i s), s = kappa t
    small = np.abs(half) < 1e-4
    s = np.where(small, 1.0, 2 * half)
    quotient = np.where(small, 0.5 + 1j * half / 3, (np.sinc(half / np.pi) * np.exp(1j * half) - 1) / (1j * s))
    return z * t + velocity * t**2 * quotient


@family
def _turntable_system() -> LagrangeDAlembert:
    def lagrangian(q: Array, v: Array, p: Numbers) -> Array:
        return jnp.array([p["mass"], p["mass"], p["inertia"], p["inertia"]]) @ v**2 / 2

    def forms(q: Array, p: Numbers) -> Array:
        r = p["radius"]
        return jnp.array([[1.0, 0.0, 0.0, -r], [0.0, 1.0, r, 0.0]])

    def velocities(q: Array, _time: Array, p: Numbers) -> Array:
        return p["table_rate"] * jnp.stack([-q[1], q[0]])

    numbers, options = ("mass", "radius", "inertia", "table_rate"), {"constraint_velocities": velocities}
    return system_in("x y alpha beta", "Ball on a turntable", numbers, lagrangian, forms, **options)


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
    v = np.array([R * np.cos(q[3]) * roll, R * np.sin(q[3]) * roll, roll, turn])
    system = _disk_system(mass, R, rolling_inertia, turning_inertia)
    return Example("rolling_disk", system, q, v, {"theta'": rate(2), "phi'": rate(3)}, on_circle(q, v, R * roll, 3))


@family
def _disk_system() -> LagrangeDAlembert:
    def lagrangian(q: Array, v: Array, p: Numbers) -> Array:
        return jnp.array([p["mass"], p["mass"], p["rolling_inertia"], p["turning_inertia"]]) @ v**2 / 2

    def forms(q: Array, p: Numbers) -> Array:
        R = p["radius"]
        return jnp.array([[1.0, 0.0, -R * jnp.cos(q[3]), 0.0], [0.0, 1.0, -R * jnp.sin(q[3]), 0.0]])

    options: Any = {"heading": "phi", "outline": lambda _, p: [wheel((0.0, 0.0), 2 * p["radius"], width=0.1)]}
    numbers = ("mass", "radius", "rolling_inertia", "turning_inertia")
    return system_in("x y theta phi", "Rolling disk", numbers, lagrangian, forms, **options)


@ready("configuration turning lean_rate rolling", configuration="x, y, theta, lean and roll")
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

    Facts:
        At constant lean it runs on a circle; the default start does.
        Upright it rolls on without falling if it is faster than sqrt(g R / 3), a uniform disk.

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

    v = np.array([R * np.cos(q[2]) * roll, R * np.sin(q[2]) * roll, turn, falling, roll])
    system = _tilting_system(m, R, axle, J, g)
    circle = on_circle(q, v, R * roll) if steady else None
    return Example(name, system, q, v, {"energy": energy_of(system)}, circle)


_TILTING = ("mass", "radius", "rolling_inertia", "turning_inertia", "gravity")


@family
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

    names = "x y theta lean roll"
    return system_in(names, "Tilting disk", _TILTING, lagrangian, forms, heading="theta", outline=_outline)


def _outline(q: Array, p: Numbers) -> list[Array]:
    """Return the rim and a spoke as they look from above, and the piece of the rim that touches the ground."""
    R = p["radius"]
    angle = np.linspace(0.0, 2 * np.pi, 49)
    across = -R * np.sin(q[3])  # of the middle, to the left
    rim = np.stack([R * np.sin(angle), across * (1 - np.cos(angle))], axis=1)
    spoke = np.array([[0.0, across], [R * np.sin(q[4]), across * (1 + np.cos(q[4]))]])
    return [rim, wheel((0.0, 0.0), 0.6 * R, width=0.1), spoke]
