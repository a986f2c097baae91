"""Vehicles with driven or steered wheels: the car, the robot on two wheels, the tractor with trailers."""

from typing import Any

import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import array, error
from nonholo.base.types import Array
from nonholo.examples._example import Example, Numbers, family, ready, scales, system_in
from nonholo.examples._formulas import energy_of, on_circle, pair, rate, speed_ahead, turn, wheel
from nonholo.lagrange_dalembert import LagrangeDAlembert

_CAR = ("mass", "inertia", "wheelbase", "wheel_radius", "wheel_inertia", "steering_inertia")


@ready("configuration speed steering_rate", configuration="x, y, theta, psi and phi")
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

    So $\dot\theta = (\rho/\ell)\tan\varphi\,\dot\psi$: the constraints alone determine how rolling and steering move
    the car. Without control $\dot\varphi$ and $u\sqrt{m + J_w/\rho^2 + (J/\ell^2)\tan^2\varphi}$ are constant, u the
    speed of the rear axle; with the steering at rest the car drives on a circle of radius $\ell/\tan\varphi$. Where the
    front wheels are across, at $|\varphi| = \pi/2$, the car cannot roll. The angle phi is that of one wheel in the
    middle; pictures turn each front wheel across the line to the center of the circle, so that none slips.

    Reference: [kelly-murray-1995]; [bloch-2003].

    Facts:
        phi' and the momentum along the constraint are constant.
        With the steering at rest it drives on a circle of radius wheelbase / tan phi.
        Rolling and steering bring it to every pose: growth (2, 3, 4, 5).

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
    q, u, turn = np.asarray(configuration), speed, steering_rate
    m, J, ell, R, Jw = mass, inertia, wheelbase, wheel_radius, wheel_inertia
    if not abs(q[4]) < np.pi / 2:
        where, remedy = "examples.kinematic_car(configuration=...)", "The front wheels must not be across."
        raise error(where, "have |phi| < pi/2", f"{q[4]:g}", remedy)
    omega = u / ell * np.tan(q[4])
    v = np.array([u * np.cos(q[2]), u * np.sin(q[2]), omega, u / R, turn])

    def momentum(q: Array, v: Array) -> Array:
        return speed_ahead(q, v) * np.sqrt(m + Jw / R**2 + J / ell**2 * np.tan(q[..., 4]) ** 2)

    conserved = {"phi'": rate(4), "momentum along the constraint": momentum}
    system = _car_system(m, J, ell, R, Jw, steering_inertia)
    return Example("kinematic_car", system, q, v, conserved, None if turn else on_circle(q, v, u))


@family
def _car_system() -> LagrangeDAlembert:
    def lagrangian(q: Array, v: Array, p: Numbers) -> Array:
        m, J, _, _, Jw, Js = map(p.__getitem__, _CAR)
        return jnp.array([m, m, J, Jw, Js]) @ v**2 / 2

    def forms(q: Array, p: Numbers) -> Array:
        cos, sin, angle, ell, R = jnp.cos(q[2]), jnp.sin(q[2]), q[2] + q[4], p["wheelbase"], p["wheel_radius"]
        front = jnp.array([-jnp.sin(angle), jnp.cos(angle), ell * jnp.cos(q[4]), 0.0, 0.0])
        return jnp.stack([jnp.array([-sin, cos, 0.0, 0.0, 0.0]), front, jnp.array([cos, sin, 0.0, -R, 0.0])])

    board = np.array([[-0.2, -0.22], [1.2, -0.22], [1.2, 0.22], [-0.2, 0.22]])

    def outline(q: Array, p: Numbers) -> list[Array]:
        ell, R = p["wheelbase"], p["wheel_radius"]
        cos, sin, places = np.cos(q[4]), np.sin(q[4]), ((ell, -0.3 * ell), (ell, 0.3 * ell))
        front = [wheel(at, 2 * R, np.arctan2(at[0] * sin, at[0] * cos - at[1] * sin)) for at in places]
        return [ell * board, *pair((0.0, 0.0), 0.3 * ell, 2 * R), *front]

    return system_in("x y theta psi phi", "Kinematic car", _CAR, lagrangian, forms, heading="theta", outline=outline)


@ready("configuration speed turning", reals="offset friction", configuration="x, y, theta, right and left")
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

    Facts:
        Speed and turning rate are those of a Chaplygin sleigh.
        One constraint is integrable: theta - R (right - left) / (2 c) is constant, also in the midpoint rule.
        The discrete energy settles to a constant; it does not drift.

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
        >>> orbit = ready.simulate(time_step=0.05, steps=1000)
        >>> float(np.ptp(ready.conserved["axle"](orbit.configuration, orbit.body_velocity)).round(9))
        0.0
    """
    m, J, c, R, Jw = mass, inertia, half_width, wheel_radius, wheel_inertia
    q, ell, u, omega, d = np.asarray(configuration), offset, speed, turning, friction
    if d < 0:
        where = "examples.two_wheeled_robot(friction=...)"
        raise error(where, "not be negative", f"{d:g}", "Pass the friction of a wheel.")
    M, K = m + 2 * Jw / R**2, J + m * ell**2 + 2 * Jw * c**2 / R**2
    v = np.array([u * np.cos(q[2]), u * np.sin(q[2]), omega, (u + c * omega) / R, (u - c * omega) / R])

    def energy(q: Array, v: Array) -> Array:
        return (M * speed_ahead(q, v) ** 2 + K * v[..., 2] ** 2) / 2

    def axle(q: Array, v: Array) -> Array:
        return q[..., 2] - R / (2 * c) * (q[..., 3] - q[..., 4])

    free = torques is None and d == 0
    conserved = {"axle": axle, **({"energy of the sleigh": energy} if free else {})}
    motors = torques if callable(torques) else None
    driving = () if free else (d,) if motors else (d, _torques(torques))
    system = _robot_system(m, J, ell, c, R, Jw, *driving, motors=motors, is_free=free)
    return Example("two_wheeled_robot", system, q, v, conserved)


_ROBOT = ("mass", "inertia", "offset", "half_width", "wheel_radius", "wheel_inertia")


def _torques(value: Any) -> Array:
    """Return two torques, none if there are none."""
    where, remedy = "examples.two_wheeled_robot(torques=...)", "Pass a function of the time, or two torques."
    return array(where, (0.0, 0.0) if value is None else value, (2,), remedy)


@family
def _robot_system(motors: Any, is_free: bool) -> LagrangeDAlembert:
    def lagrangian(q: Array, v: Array, p: Numbers) -> Array:
        m, J, ell, _, _, Jw = map(p.__getitem__, _ROBOT)
        across = v[1] * jnp.cos(q[2]) - v[0] * jnp.sin(q[2])
        return jnp.array([m, m, J + m * ell**2, Jw, Jw]) @ v**2 / 2 + m * ell * v[2] * across

    def forms(q: Array, p: Numbers) -> Array:
        cos, sin, R = jnp.cos(q[2]), jnp.sin(q[2]), p["wheel_radius"]
        turn = jnp.divide(R, 2 * p["half_width"])  # of the family, whose numbers are zero, without a warning
        return jnp.array([[-sin, cos, 0.0, 0.0, 0.0], [cos, sin, 0.0, -R / 2, -R / 2], [0.0, 0.0, 1.0, -turn, turn]])

    def force(time: Array, q: Array, v: Array, p: Numbers) -> Array:
        right, left = motors(time) if motors else p["torques"]
        return jnp.array([0.0, 0.0, 0.0, right - p["friction"] * v[3], left - p["friction"] * v[4]])

    chassis = np.array([[-0.7, -0.75], [0.7, -0.75], [1.2, -0.3], [1.2, 0.3], [0.7, 0.75], [-0.7, 0.75]])

    def outline(_: Array, p: Numbers) -> list[Array]:
        c, diameter = p["half_width"], 2 * p["wheel_radius"]
        return [c * chassis, wheel((0.0, -c), diameter), wheel((0.0, c), diameter)]

    driven = {} if is_free else {"friction": 0.0} | ({} if motors else {"torques": np.zeros(2)})
    numbers = dict.fromkeys(_ROBOT, 1.0) | driven
    options: Any = {"heading": "theta", "outline": outline, "force": None if is_free else force}
    return system_in("x y theta right left", "Two-wheeled robot", numbers, lagrangian, forms, **options)


@ready("place angles speed turning", place="x and y")
def trailers(
    *,
    hitches: tuple[float, ...] = (1.0, 1.0, 1.0),
    mass: float = 1.0,
    inertia: float = 0.2,
    trailer_mass: float = 0.5,
    trailer_inertia: float = 0.1,
    place: tuple[float, float] = (0.0, 0.0),
    angles: tuple[float, ...] | None = None,
    speed: float = 1.0,
    turning: float = 0.4,
) -> Example:
    r"""A tractor that pulls n trailers: its axle (x, y) and heading theta, headings theta1, theta2 ... of the trailers.

    Each trailer has one axle, which is d behind the axle in front of it; nothing drives the tractor.

    $$ L = \sum_i \tfrac12 m_i|\dot p_i|^2 + \tfrac12 J_i\dot\theta_i^2, \qquad p_i = p_{i-1} - d_i\,e(\theta_i), \qquad
       \dot p_i\cdot e(\theta_i)^\perp = 0, $$

    e a unit vector, so that speeds along the axles and headings obey

    $$ u_i = u_{i-1}\cos(\theta_{i-1} - \theta_i), \qquad d_i\dot\theta_i = u_{i-1}\sin(\theta_{i-1} - \theta_i). $$

    The turning $\dot\theta$ of the tractor and the energy are constant; of the map the turning is.

    Reference: [murray-sastry-1993]; [bloch-2003].

    Facts:
        The turning of the tractor is constant, also in the midpoint rule, and so is the energy of the flow.
        Its speed and turning alone determine how all trailers move; they can bring them anywhere.

    Args:
        hitches: The lengths d, one for each trailer.
        mass: Of the tractor, centered on its axle.
        inertia: Of the tractor about the middle of its axle.
        trailer_mass: Of each trailer, as if centered on its axle.
        trailer_inertia: Of each trailer about the middle of its axle.
        place: (x, y) at the start.
        angles: All headings at the start, that of the tractor first; None for zeros.
        speed: Of the tractor along its heading at the start.
        turning: theta' at the start.

    Raises:
        ValueError: No trailer, a length, mass or inertia that is not positive, a wrong shape.

    Example:
        >>> ready = nh.examples.trailers(hitches=(1.0, 0.5))
        >>> ready.coordinates, ready.system.constraints
        (('x', 'y', 'theta', 'theta1', 'theta2'), 3)
    """
    where = "examples.trailers"
    if not len(lengths := array(f"{where}(hitches=...)", hitches, (None,), "Pass one length for each trailer.")):
        raise error(f"{where}(hitches=...)", "have at least one length", "none", "Pass one for each trailer.")
    d = scales(f"{where}(hitches=...)", lengths)
    remedy, n = "Pass the heading of the tractor, then those of the trailers.", len(d) + 1
    headings = array(f"{where}(angles=...)", np.zeros(n) if angles is None else angles, (n,), remedy)
    u, rates, along = speed, [turning], speed
    for length, bend in zip(d, headings[:-1] - headings[1:], strict=True):
        rates.append(along * np.sin(bend) / length)
        along *= np.cos(bend)
    q = np.append(place, headings)
    v = np.array([u * np.cos(headings[0]), u * np.sin(headings[0]), *rates])

    system = _trailer_system(np.array(d), mass, inertia, trailer_mass, trailer_inertia, n=n)
    return Example("trailers", system, q, v, {"theta'": rate(2), "energy": energy_of(system)})


@family
def _trailer_system(n: int) -> LagrangeDAlembert:
    ones, zeros, follows = np.ones((n, 1)), np.zeros((n, 1)), np.tril(np.ones((n, n)))[:, 1:]

    def velocities(q: Array, p: Numbers) -> tuple[Array, Array]:
        """Return matrices from velocities to those of the axles along x and along y."""
        cos, sin = jnp.cos(q[2:]), jnp.sin(q[2:])
        behind = jnp.hstack([zeros, follows * p["hitches"]])  # of each axle, how far it is behind along each heading
        return jnp.hstack([ones, zeros, behind * sin]), jnp.hstack([zeros, ones, -behind * cos])

    def lagrangian(q: Array, v: Array, p: Numbers) -> Array:
        x, y = velocities(q, p)
        masses, moments = (jnp.array([p[name], *(n - 1) * (p[f"trailer_{name}"],)]) for name in ("mass", "inertia"))
        return (masses @ ((x @ v) ** 2 + (y @ v) ** 2) + moments @ v[2:] ** 2) / 2

    def forms(q: Array, p: Numbers) -> Array:
        x, y = velocities(q, p)
        return jnp.cos(q[2:])[:, None] * y - jnp.sin(q[2:])[:, None] * x

    numbers = {"hitches": np.ones(n - 1)} | dict.fromkeys(("mass", "inertia", "trailer_mass", "trailer_inertia"), 1.0)
    names = " ".join(f"theta{i}" for i in range(1, n))
    return system_in(f"x y theta {names}", "Trailers", numbers, lagrangian, forms, heading="theta", outline=_outline)


def _outline(q: Array, p: Numbers) -> list[Array]:
    """Return the cab with its wheels, and of each trailer the box, the bar and the wheels."""
    d = p["hitches"]
    size, place = 0.5 * min(d), np.zeros(2)
    cab = size * np.array([[-0.5, -0.6], [0.9, -0.45], [0.9, 0.45], [-0.5, 0.6]])
    parts = [cab, *pair((0.0, 0.0), 0.6 * size, 0.6 * size)]
    box = size * np.array([[-0.8, -0.22], [0.8, -0.22], [0.8, 0.22], [-0.8, 0.22]])
    for length, angle in zip(d, q[3:] - q[2], strict=True):
        axle = place - length * turn(angle)[0]
        parts += [axle + box @ turn(angle), np.stack([place, axle])]
        parts += pair((axle[0], axle[1]), 0.6 * size, 0.6 * size, angle)
        place = axle
    return parts
