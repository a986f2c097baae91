"""Vehicles that turns of joints drive along: roller racer, Twistcar, snakeboard, snake of three links."""

from typing import Any

import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import error
from nonholo.base.types import Array
from nonholo.examples._example import Example, Numbers, family, ready, system_in
from nonholo.examples._formulas import energy_of, pair, rate, speed_ahead, turn
from nonholo.lagrange_dalembert import LagrangeDAlembert


@ready("configuration speed", reals="center amplitude", configuration="x, y and theta")
def roller_racer(
    *,
    mass: float = 1.0,
    inertia: float = 0.2,
    handle_inertia: float = 0.02,
    center: float = 0.2,
    joint: float = 1.0,
    handle: float = 0.3,
    amplitude: float | None = 0.5,
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

    Facts:
        Turning the handle to and fro drives it from rest.
        There is a momentum along the constraint, and it is not conserved.

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
        >>> list(nh.examples.roller_racer(amplitude=None).conserved)
        ['energy']
    """
    body = mass, inertia, handle_inertia, joint, handle, frequency, center, 0.0, 0.0
    return _of_handle("roller_racer", "Roller racer", body, amplitude, configuration, speed)


@ready("configuration speed", reals="center handle_center amplitude", configuration="x, y and theta")
def twistcar(
    *,
    mass: float = 1.0,
    inertia: float = 0.1,
    handle_mass: float = 0.2,
    handle_inertia: float = 0.01,
    center: float = 0.3,
    handle_center: float = 0.1,
    joint: float = 1.0,
    handle: float = 0.2,
    amplitude: float | None = 0.5,
    frequency: float = 2.0,
    configuration: tuple[float, float, float] = (0.0, 0.0, 0.0),
    speed: float = 0.0,
) -> Example:
    r"""The toy that turns of its handle drive: a `roller_racer` whose handle has a mass, forwards or backwards.

    $$ L = \tfrac m2|\dot c|^2 + \tfrac I2\dot\theta^2 + \tfrac{m_h}2|\dot d|^2
         + \tfrac J2(\dot\theta + \dot\varphi)^2, $$

    constraints and coordinates as there; the center of the handle d lies d beyond the pivot, on the line to its axle.
    From rest, turned by $\varphi = A\sin\Omega t$ with a small A, it gains in the mean of a period

    $$ (m + m_h)\,\overline{\dot u} = \tfrac12A^2\Omega^2\Bigl(\frac{\Lambda}{\ell + k}
         - \kappa\Pi\Bigr) + O(A^4), \quad \kappa = \frac k{\ell + k}, \quad
       \Pi = (1 - \kappa)m_hd - \kappa(mc + m_h\ell), $$

    $$ \Lambda = (1 - \kappa)J - \kappa(I + mc^2) + m_h(\ell + d)\bigl((1 - \kappa)d - \kappa\ell\bigr), $$

    whose sign depends on lengths and masses: it goes backwards with these, forwards with a handle of the inertia 0.1.

    Reference: [chakon-or-2017]; this model and its mean acceleration are derived in the tests.

    Facts:
        Turning the handle to and fro drives it from rest.
        There is a momentum along the constraint, and it is not conserved.

    Args:
        mass: m, of the body with its rider.
        inertia: I, of the body about its center of mass.
        handle_mass: m_h.
        handle_inertia: J, of the handle about its center of mass.
        center: c, of the center of mass of the body in front of the rear axle.
        handle_center: d, of the center of mass of the handle beyond the pivot.
        joint: l, of the pivot in front of the rear axle.
        handle: k, from the pivot to the axle of the handle.
        amplitude: A; None for a handle that turns freely.
        frequency: Omega; of a free handle its first turning rate is 0.5.
        configuration: (x, y, theta) at the start.
        speed: u at the start.

    Raises:
        ValueError: A length, mass or inertia that is not positive, a wrong shape.

    Example:
        >>> ready = nh.examples.twistcar()
        >>> ready.coordinates, ready.system.constraints
        (('x', 'y', 'theta', 'phi'), 3)
    """
    body = mass, inertia, handle_inertia, joint, handle, frequency, center, handle_mass, handle_center
    return _of_handle("twistcar", "Twistcar", body, amplitude, configuration, speed)


_HANDLE = ("mass", "inertia", "handle_inertia", "joint", "handle", "frequency", "center")
_HANDLE += ("handle_mass", "handle_center", "amplitude")


def _of_handle(name: str, title: str, body: Any, amplitude: float | None, place: Any, speed: float) -> Example:
    """Return a vehicle with a handle that drives it."""
    turning = 0.5 if amplitude is None else amplitude * body[5]
    heading = -body[4] * turning / (body[3] + body[4])
    q, v = np.append(place, 0.0), np.array([speed * np.cos(place[2]), speed * np.sin(place[2]), heading, turning])
    system = _handle_system(*body, amplitude or 0.0, title=title, is_free=amplitude is None)
    conserved = {"energy": energy_of(system)} if amplitude is None else {}
    return Example(name, system, q, v, conserved)


@family
def _handle_system(title: str, is_free: bool) -> LagrangeDAlembert:
    def lagrangian(q: Array, v: Array, p: Numbers) -> Array:
        cos, sin, turning = jnp.cos(q[2]), jnp.sin(q[2]), v[2] + v[3]
        u, w = cos * v[0] + sin * v[1], cos * v[1] - sin * v[0]
        seat = p["mass"] * (u**2 + (w + p["center"] * v[2]) ** 2) + p["inertia"] * v[2] ** 2
        along = u - p["handle_center"] * turning * jnp.sin(q[3])
        across = w + p["joint"] * v[2] + p["handle_center"] * turning * jnp.cos(q[3])
        return (seat + p["handle_inertia"] * turning**2 + p["handle_mass"] * (along**2 + across**2)) / 2

    def axles(q: Array, p: Numbers) -> Array:
        cos, sin, bent, k = jnp.cos(q[2]), jnp.sin(q[2]), jnp.sin(q[3]), p["handle"]
        front = jnp.array([-bent * cos, -bent * sin, p["joint"] * jnp.cos(q[3]) + k, k])
        return jnp.stack([jnp.array([-sin, cos, 0.0, 0.0]), front])

    def outline(q: Array, p: Numbers) -> list[Array]:
        ell, half = p["joint"], 0.3 * p["joint"]
        seat = np.array([[-0.1 * ell, -0.6 * half], [ell, 0.0], [-0.1 * ell, 0.6 * half]])
        pivot = np.array([ell, 0.0])
        front = pivot + p["handle"] * turn(q[3])[0]
        bar = np.stack([pivot, front])
        return [seat, *pair((0.0, 0.0), half, 0.5 * half), bar, *pair((front[0], front[1]), half, 0.5 * half, q[3])]

    driver = {} if is_free else {3: lambda time, p: p["amplitude"] * jnp.sin(p["frequency"] * time)}
    options = {"heading": "theta", "outline": outline, "prescribed": driver}
    return system_in("x y theta phi", title, _HANDLE, lagrangian, axles, **options)


_BOARD = ("mass", "half_length", "rotor_inertia", "wheel_inertia")


@ready("configuration speed rotor_rate wheel_rate", configuration="x, y, theta, psi and phi")
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

    Facts:
        phi' and theta' + psi' are constant, also in the midpoint rule.
        The momentum along the constraint is constant.
        The motion ends where the wheels are crossed, at phi = pi/2 or -pi/2.

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
    where, q = "examples.snakeboard", np.asarray(configuration)
    m, r, J0 = mass, half_length, rotor_inertia
    if m * r * r <= J0:
        raise error(f"{where}(rotor_inertia=...)", f"be less than m r^2 = {m * r * r:g}", f"{J0:g}", "Lighten it.")
    if not abs(q[4]) < np.pi / 2:
        raise error(f"{where}(configuration=...)", "have |phi| < pi/2", f"{q[4]:g}", "The wheels must not be crossed.")
    v = np.array([speed * np.cos(q[2]), speed * np.sin(q[2]), speed / r * np.tan(q[4]), rotor_rate, wheel_rate])

    def spin(q: Array, v: Array) -> Array:
        return v[..., 2] + v[..., 3]

    def momentum(q: Array, v: Array) -> Array:
        return speed_ahead(q, v) * np.sqrt(m + (m - J0 / r**2) * np.tan(q[..., 4]) ** 2)

    conserved = {"phi'": rate(4), "theta' + psi'": spin, "momentum along the constraint": momentum}
    return Example("snakeboard", _board_system(m, r, J0, wheel_inertia), q, v, conserved)


@family
def _board_system() -> LagrangeDAlembert:
    def lagrangian(q: Array, v: Array, p: Numbers) -> Array:
        m, r, J0, J1 = map(p.__getitem__, _BOARD)
        return jnp.array([m, m, m * r * r, J0, 2 * J1]) @ v**2 / 2 + J0 * v[2] * v[3]

    def forms(q: Array, p: Numbers) -> Array:
        theta, phi, r = q[2], q[4], p["half_length"]

        def row(side: float) -> Array:
            angle = theta + side * phi
            return jnp.array([-jnp.sin(angle), jnp.cos(angle), side * r * jnp.cos(phi), 0.0, 0.0])

        return jnp.stack([row(1.0), row(-1.0)])

    board = np.array([[-1.15, -0.12], [1.15, -0.12], [1.15, 0.12], [-1.15, 0.12]])

    def outline(q: Array, p: Numbers) -> list[Array]:
        r = p["half_length"]
        rotor = 0.45 * r * np.array([[-1.0, 0.0], [1.0, 0.0]]) @ turn(q[3])
        return [r * board, rotor, *pair((r, 0.0), 0.35 * r, 0.3 * r, q[4]), *pair((-r, 0.0), 0.35 * r, 0.3 * r, -q[4])]

    return system_in("x y theta psi phi", "Snakeboard", _BOARD, lagrangian, forms, heading="theta", outline=outline)


@ready("place joints joint_rates", place="x, y and theta", joints="alpha1 and alpha2", joint_rates="both rates")
def snake(
    *,
    half_length: float = 0.5,
    mass: float = 1.0,
    inertia: float = 0.1,
    place: tuple[float, float, float] = (0.0, 0.0, 0.0),
    joints: tuple[float, float] = (0.8, -0.4),
    joint_rates: tuple[float, float] = (0.3, 0.5),
) -> Example:
    r"""Three links with a pair of wheels in the middle of each: middle (x, y), heading theta, joints alpha1, alpha2.

    The links are 2 l long; the first has the heading $\theta - \alpha_1$, the last $\theta + \alpha_2$. Nothing drives
    it, and the joints turn freely.

    $$ L = \sum_{i=1}^3 \tfrac m2|\dot p_i|^2 + \tfrac J2\dot\theta_i^2, \qquad
       -\dot x_i\sin\theta_i + \dot y_i\cos\theta_i = 0 . $$

    Three constraints leave two rates: a principal kinematic system, whose joints determine its motion. With
    $\dot x = u\cos\theta$, $\dot y = u\sin\theta$ and $\omega = \dot\theta$

    $$ u\sin\alpha_1 - l(1 + \cos\alpha_1)\,\omega + l\,\dot\alpha_1 = 0, \qquad
       -u\sin\alpha_2 + l(1 + \cos\alpha_2)\,\omega + l\,\dot\alpha_2 = 0 . $$

    With $\alpha_1 = \alpha_2$ it is an arc, whose axles meet in one point. There it rolls about that point at any rate,
    and its joints move oppositely, $\dot\alpha_1 = -\dot\alpha_2$: the motion passes, and joints do not determine it.

    Reference: [shammas-choset-rizzi-2007].

    Facts:
        The joints determine its motion, but where it is an arc, with both alike: that may roll at any rate.
        The energy is constant.

    Args:
        half_length: l, of each link.
        mass: m, of each link, centered.
        inertia: J, of each link about its center.
        place: (x, y, theta) at the start.
        joints: $\alpha_1$, $\alpha_2$ at the start, not the same, between -pi and pi.
        joint_rates: Their rates.

    Raises:
        ValueError: A length, mass or inertia that is not positive, a wrong shape, an arc.

    Example:
        >>> ready = nh.examples.snake()
        >>> connection = nh.local_connection(ready.system)
        >>> connection.matrix(ready.configuration[3:]).shape
        (3, 2)
    """
    q, a, half = place, np.asarray(joints), half_length
    if not (np.abs(a) < np.pi).all() or abs(a[0] - a[1]) < 1e-6:
        where, remedy = "examples.snake(joints=...)", "Equal angles leave the rate of rolling free: pass others."
        raise error(where, "differ and be between -pi and pi", str(a.tolist()), remedy)
    sign = np.array([1.0, -1.0])
    rows = np.stack([sign * np.sin(a), -sign * half * (1 + np.cos(a))], axis=1)
    u, omega = np.linalg.solve(rows, -half * np.asarray(joint_rates))
    v = np.array([u * np.cos(q[2]), u * np.sin(q[2]), omega, *joint_rates])
    system = _snake_system(half, mass, inertia)
    return Example("snake", system, np.append(q, a), v, {"energy": energy_of(system)})


@family
def _snake_system() -> LagrangeDAlembert:
    def links(q: Array, half: Any) -> tuple[Array, Array, Array]:
        """Return the headings of the links, and matrices from velocities to those of their middles along x and y."""
        headings = q[2] + jnp.stack([-q[3], 0.0 * q[3], q[4]])
        cos, sin = jnp.cos(headings), jnp.sin(headings)
        # p = (x, y) -+ half e(theta) -+ half e(theta of the outer link)
        x = jnp.stack([half * (sin[0] + sin[1]), 0.0 * sin[1], -half * (sin[1] + sin[2])])
        y = jnp.stack([-half * (cos[0] + cos[1]), 0.0 * cos[1], half * (cos[1] + cos[2])])
        ones, zeros, first, last = np.ones(3), np.zeros(3), np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
        across = jnp.stack([ones, zeros, x, -half * sin[0] * first, -half * sin[2] * last], axis=1)
        return headings, across, jnp.stack([zeros, ones, y, half * cos[0] * first, half * cos[2] * last], axis=1)

    def lagrangian(q: Array, v: Array, p: Numbers) -> Array:
        _, x, y = links(q, p["half_length"])
        turning = v[2] + jnp.stack([-v[3], 0.0 * v[3], v[4]])
        return (p["mass"] * ((x @ v) @ (x @ v) + (y @ v) @ (y @ v)) + p["inertia"] * (turning @ turning)) / 2

    def forms(q: Array, p: Numbers) -> Array:
        headings, x, y = links(q, p["half_length"])
        return jnp.cos(headings)[:, None] * y - jnp.sin(headings)[:, None] * x

    numbers = ("half_length", "mass", "inertia")
    return system_in("x y theta alpha1 alpha2", "Snake", numbers, lagrangian, forms, heading="theta", outline=_outline)


def _outline(q: Array, p: Numbers) -> list[Array]:
    """Return the three links, each with its wheels; the middle one first."""
    half = p["half_length"]
    link = half * np.array([[-0.95, -0.15], [0.95, -0.15], [0.95, 0.15], [-0.95, 0.15]])
    parts = [link, *pair((0.0, 0.0), 0.35 * half, 0.35 * half)]
    for side, angle in ((-1.0, -q[3]), (1.0, q[4])):
        middle = side * half * (np.array([1.0, 0.0]) + turn(angle)[0])
        parts += [middle + link @ turn(angle), *pair((middle[0], middle[1]), 0.35 * half, 0.35 * half, angle)]
    return parts
