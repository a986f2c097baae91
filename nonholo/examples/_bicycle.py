"""The bicycle of Whipple: two frames, two wheels, a rider who holds on."""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.numerics import double_precision
from nonholo.base.types import Array, Float
from nonholo.examples._example import Example, Numbers, family, ready, system_in
from nonholo.examples._formulas import energy_of, of_states, wheel
from nonholo.groups import SO
from nonholo.lagrange_dalembert import LagrangeDAlembert

_Wheel = tuple[float, float, float, float]
_Body = tuple[float, float, float, float, float, float, float]
_CORNERS = np.array([[-1.0, -0.4], [0.0, -1.0], [1.0, -0.6], [1.0, 0.6], [0.0, 1.0], [-1.0, 0.4]])  # of a rider


@ready(
    "place speed lean_rate steer_rate",
    reals="trail tilt",
    positive="rear_wheel front_wheel",
    **dict.fromkeys(("rear_wheel", "front_wheel"), "radius, mass and two moments of inertia"),
    **dict.fromkeys(("rear_frame", "front_frame"), "place, mass and inertia"),
    place="x, y and theta",
)
def bicycle(
    *,
    wheelbase: float = 1.02,
    trail: float = 0.08,
    tilt: float = np.pi / 10,
    gravity: float = 9.81,
    rear_wheel: _Wheel = (0.3, 2.0, 0.0603, 0.12),
    rear_frame: _Body = (0.3, 0.9, 85.0, 9.2, 11.0, 2.8, -2.4),
    front_frame: _Body = (0.9, 0.7, 4.0, 0.05892, 0.06, 0.00708, 0.00756),
    front_wheel: _Wheel = (0.35, 3.0, 0.1405, 0.28),
    place: tuple[float, float, float] = (0.0, 0.0, 0.0),
    speed: float = 4.6,
    lean_rate: float = 0.5,
    steer_rate: float = 0.0,
) -> Example:
    r"""A bicycle that nobody steers: rear contact (x, y), heading theta, lean, pitch, steer, wheel angles rear, front.

    Four rigid bodies, the rider part of the rear frame, roll on two thin wheels without slip, free. Lean and steer are
    positive to the right, the pitch of the frame nose down, and wheels turn forward; the rear wheel is measured from
    the vertical, the front wheel from its frame. With the lowest point c of the front wheel, in axes of its frame,

    $$ L = T - V, \qquad \dot x = r_R\cos\theta\,\dot\rho, \quad \dot y = r_R\sin\theta\,\dot\rho, \qquad
       v_F + \omega_F\times c = 0 . $$

    The vertical part of the last is the derivative of the height of c; the map keeps that height itself, to rounding.
    Small lean $\phi$ and steer $\delta$ at the speed v obey

    $$ M\ddot q + vC_1\dot q + (gK_0 + v^2K_2)\,q = 0, \qquad q = (\phi, \delta), $$

    with the matrices of the source. The defaults are those of its benchmark, and the start that of IFToMM's. It rides
    upright by itself, with weave and capsize damped, at speeds between 4.292382536 and 6.024262015 m/s.

    Reference: [meijaard-papadopoulos-ruina-schwab-2007]; the nonlinear equations
    [basu-mandal-chatterjee-papadopoulos-2007].

    Facts:
        With the defaults it rides upright by itself at speeds between 4.292382536 and 6.024262015 m/s.
        The energy and the height of the front contact are constant; of the map the height is, to rounding.

    Args:
        wheelbase: Distance of the contacts of the upright bicycle.
        trail: Of the front contact behind the steering axis, on the ground.
        tilt: Of the steering axis against the vertical, backward.
        gravity: g.
        rear_wheel: Radius, mass, moments of inertia about a diameter and about the axle.
        rear_frame: Of the rear frame with the rider: place of its center of mass in front of the rear contact and above
            the ground, mass, moments of inertia about the axes ahead, left and up, and the product $I_{xz}$.
        front_frame: The same of the fork with the handlebar.
        front_wheel: As the rear wheel.
        place: (x, y, theta) at the start, which is upright.
        speed: v.
        lean_rate: Of the lean at the start.
        steer_rate: Of the steer at the start.

    Raises:
        ValueError: A length, mass, gravity or inertia of a wheel that is not positive, a wrong shape.

    Example:
        >>> ready = nh.examples.bicycle(speed=5.0)
        >>> ready.coordinates, ready.system.constraints
        (('x', 'y', 'theta', 'lean', 'pitch', 'steer', 'rear', 'front'), 5)
    """
    q, v, rolling = np.append(place, np.zeros(5)), speed, (speed / rear_wheel[0], speed / front_wheel[0])
    yaw = -trail * np.cos(tilt) / wheelbase * steer_rate
    start = np.array([v * np.cos(q[2]), v * np.sin(q[2]), yaw, lean_rate, 0.0, steer_rate, *rolling])
    rows = map(np.array, (rear_wheel, rear_frame, front_frame, front_wheel))
    system = _system(wheelbase, trail, tilt, *rows, gravity)
    height = of_states(lambda q, v: _Machine(system.parameters).height(q) + 0.0 * v[0])
    conserved = {"energy": energy_of(system), "height of the front contact": height}
    return Example("bicycle", system, q, start, conserved, time_step=0.02)


class _Machine(NamedTuple):
    """A bicycle by its parameters, and how it moves; vectors in axes of the rear frame or, turned, of the front one."""

    p: Numbers

    @property
    def pivot(self) -> Float[Array, "3"]:
        """Where the steering axis meets the ground, from the rear axle, upright."""
        return jnp.array([self.p["wheelbase"] + self.p["trail"], 0.0, -self.p["rear_wheel"][0]])

    def of_fork(self, x: Any, z: Any) -> Float[Array, "3"]:
        """Return a point of the upright front frame from the pivot, in its axes."""
        return self.axes @ jnp.array([x - self.p["wheelbase"] - self.p["trail"], 0.0, z])

    @property
    def axle(self) -> Float[Array, "3"]:
        """The front axle from the pivot."""
        return self.of_fork(self.p["wheelbase"], self.p["front_wheel"][0])

    @property
    def axes(self) -> Float[Array, "3 3"]:
        cos, sin = jnp.cos(self.p["tilt"]), jnp.sin(self.p["tilt"])
        return jnp.array([[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]])

    def inertias(self) -> list[Float[Array, "3 3"]]:
        """Return the tensors of rear wheel, rear frame, front frame and front wheel, each in its axes."""

        def tensor(xx: Any, yy: Any, zz: Any, xz: Any = 0.0) -> Array:
            return jnp.array([[xx, 0.0, xz], [0.0, yy, 0.0], [xz, 0.0, zz]])

        frame, fork = (tensor(*self.p[name][3:]) for name in ("rear_frame", "front_frame"))
        wheels = (self.p[name][2:] for name in ("rear_wheel", "front_wheel"))
        rear, front = (tensor(across, axle, across) for across, axle in wheels)
        return [rear, frame, self.axes @ fork @ self.axes.T, front]

    def to_fork(self, q: Array, vector: Array) -> Array:
        """Return a vector of the rear frame in axes of the front one."""
        cos, sin, (x, y, z) = jnp.cos(q[5]), jnp.sin(q[5]), self.axes @ vector
        return jnp.stack([cos * x - sin * y, sin * x + cos * y, z])

    def up(self, q: Array) -> Array:
        """Return the vertical."""
        return _pitch(q, jnp.stack([0.0 * q[3], jnp.sin(q[3]), jnp.cos(q[3])]))

    def motion(self, q: Array, v: Array) -> tuple[Array, Array, Array, Array]:
        """Return the velocity of the rear axle and the turning of the rear frame; of the pivot and the front frame."""
        (ahead, left), lean = _from_heading(q[2], v[:2]), jnp.sin(q[3])
        r, rise = self.p["rear_wheel"][0], jnp.cos(q[3])
        axle = _pitch(q, jnp.stack([ahead + r * lean * v[2], rise * left - r * v[3], -lean * left]))
        omega = _pitch(q, jnp.stack([v[3], v[4] + lean * v[2], rise * v[2]]))
        fork_rate = self.to_fork(q, omega) - v[5] * np.array([0.0, 0.0, 1.0])
        return axle, omega, self.to_fork(q, axle + jnp.cross(omega, self.pivot)), fork_rate

    def lowest(self, q: Array) -> tuple[Array, Array]:
        """Return the vertical and the lowest point of the front wheel from its axle, in axes of the front frame."""
        up = self.to_fork(q, self.up(q))
        level = up * np.array([1.0, 0.0, 1.0])
        return up, -self.p["front_wheel"][0] * level / jnp.sqrt(level @ level)

    def height(self, q: Array) -> Array:
        """Return the height of the lowest point of the front wheel."""
        up, low = self.lowest(q)
        return self.p["rear_wheel"][0] * jnp.cos(q[3]) + self.up(q) @ self.pivot + up @ (self.axle + low)

    def slip(self, q: Array, v: Array) -> Array:
        """Return the velocities of the contacts: of the rear one two, of the front one along, across and up."""
        _, _, pivot, omega = self.motion(q, v)
        up, low = self.lowest(q)
        contact = pivot + jnp.cross(omega, self.axle + low) + v[7] * jnp.cross(np.array([0.0, 1.0, 0.0]), low)
        along = jnp.stack([up[2], 0.0 * up[1], -up[0]])
        ahead, left = _from_heading(q[2], v[:2])
        rolling = ahead - self.p["rear_wheel"][0] * v[6]
        return jnp.stack([rolling, left, along @ contact, contact[1], up @ contact])


def _from_heading(heading: Array, vector: Array) -> Array:
    """Return a vector of the plane in axes that are turned."""
    cos, sin, (x, y) = jnp.cos(heading), jnp.sin(heading), vector
    return jnp.stack([cos * x + sin * y, cos * y - sin * x])


def _pitch(q: Array, vector: Array) -> Array:
    """Return a vector of the leaning axes in those of the rear frame."""
    cos, sin, (x, y, z) = jnp.cos(q[4]), jnp.sin(q[4]), vector
    return jnp.stack([cos * x - sin * z, y, sin * x + cos * z])


@family
def _system() -> LagrangeDAlembert:
    def lagrangian(q: Array, v: Array, p: Numbers) -> Array:
        machine = _Machine(p)
        (R, rear, *_), (_, front, *_) = p["rear_wheel"], p["front_wheel"]
        (x, z, frame, *_), (x_fork, z_fork, fork, *_) = p["rear_frame"], p["front_frame"]
        body, bars, tensors = jnp.array([x, 0.0, z - R]), machine.of_fork(x_fork, z_fork), machine.inertias()
        masses = rear, frame, fork, front
        axle, omega, pivot, fork_rate = machine.motion(q, v)
        of_fork = (pivot + jnp.cross(fork_rate, at) for at in (bars, machine.axle))
        velocities = axle, axle + jnp.cross(omega, body), *of_fork
        leaning = jnp.stack([v[3], jnp.sin(q[3]) * v[2] + v[6], jnp.cos(q[3]) * v[2]])
        turnings = leaning, omega, fork_rate, fork_rate + v[7] * np.array([0.0, 1.0, 0.0])
        bodies = zip(masses, velocities, tensors, turnings, strict=True)
        kinetic = sum(mass * (u @ u) + w @ tensor @ w for mass, u, tensor, w in bodies) / 2
        up = machine.up(q)
        heights = up @ (frame * body + (fork + front) * machine.pivot) + sum(masses) * R * jnp.cos(q[3])
        return kinetic - p["gravity"] * (heights + machine.to_fork(q, up) @ (fork * bars + front * machine.axle))

    def forms(q: Array, p: Numbers) -> Array:
        return jax.jacfwd(lambda v: _Machine(p).slip(q, v))(jnp.zeros(8))

    def discrete(q: Array, q_next: Array, h: Array, p: Numbers) -> Array:
        machine = _Machine(p)
        level = machine.slip((q + q_next) / 2, (q_next - q) / h)[:4]
        return jnp.stack([*level, machine.height(q_next) - machine.height(q)])

    numbers = dict.fromkeys(("wheelbase", "trail", "tilt"), 1.0) | {"rear_wheel": np.ones(4), "rear_frame": np.ones(7)}
    numbers |= {"front_frame": np.ones(7), "front_wheel": np.ones(4), "gravity": 1.0}
    options: Any = {"heading": "theta", "outline": _outline, "discrete_constraints": discrete}
    return system_in("x y theta lean pitch steer rear front", "Bicycle", numbers, lagrangian, forms, **options)


def _outline(q: Array, p: Numbers) -> list[Array]:
    """Return the rider, the frame, the handlebar, and the wheels where they touch the ground, seen from above."""
    machine = _Machine(p)
    with double_precision():
        axes, base, hub = map(np.asarray, (machine.axes, machine.pivot, machine.axle))
    lean, pitch, steer = SO(3).exp(np.diag([*q[3:5], -q[5]]))
    frame, R, w = lean @ pitch, p["rear_wheel"][0], p["wheelbase"]
    fork, axle = frame @ axes.T @ steer, lean @ (0.0, 0.0, R)
    pivot, across = axle + frame @ base, fork[:, 1]
    low = across * across[2] - (0.0, 0.0, 1.0)
    contact = pivot + fork @ hub + p["front_wheel"][0] * low / np.linalg.norm(low)
    x, top, *_ = p["rear_frame"]
    head, z, size = pivot + fork @ (0.0, 0.0, top), top - R, w * np.array([0.12, 0.2])
    rider = axle + np.array([[x + size[0] * ahead, size[1] * left, z] for ahead, left in _CORNERS]) @ frame.T
    bars = head + 0.25 * w * np.stack([across, -across])
    front = wheel((contact[0], contact[1]), 2 * p["front_wheel"][0], np.arctan2(-across[0], across[1]), 0.1)
    return [rider[:, :2], np.stack([axle, head])[:, :2], bars[:, :2], wheel((0.0, 0.0), 2 * R, width=0.1), front]
