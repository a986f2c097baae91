"""The rattleback, or celt: a boat that turns one way only."""

import functools
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from nonholo.base.numerics import double_precision
from nonholo.base.types import Array
from nonholo.examples._example import Example, energy_of, ready, system_in
from nonholo.lagrange_dalembert import LagrangeDAlembert


@ready(
    "tilt spin rates",
    reals="center product spin",
    positive="semi_axes inertia",
    semi_axes="three numbers",
    inertia="three numbers",
    tilt="lean and pitch",
    rates="rates of lean and pitch",
)
def rattleback(
    *,
    semi_axes: tuple[float, float, float] = (20.0, 3.0, 2.0),
    center: float = 1.0,
    inertia: tuple[float, float, float] = (2.0, 16.0, 17.0),
    product: float = 0.2,
    gravity: float = 980.665,
    tilt: tuple[float, float] = (0.01, 0.0),
    spin: float = 5.0,
    rates: tuple[float, float] = (0.0, 0.0),
) -> Example:
    r"""An ellipsoid of unequal axes that rolls without sliding: center of mass (x, y), heading theta, lean, pitch.

    The axes of the ellipsoid, ahead, left and up, are not those of inertia: hence the product $I_{12}$. With the
    vertical $\gamma = (-\sin\chi\cos\phi, \sin\phi, \cos\chi\cos\phi)$ of lean and pitch, seen from the body,
    $D = \mathrm{diag}(a, b, c)^2$ and the center of mass below the middle by $\ell$,

    $$ L = \tfrac12|v|^2 + \tfrac12\omega\cdot I\omega - gz, \qquad z = \sqrt{\gamma\cdot D\gamma} - \ell\gamma_3,
       \qquad v = \omega\times\frac{\partial z}{\partial\gamma}, $$

    of which the horizontal part is the constraint, the vertical one the derivative of z. Turned in the wrong direction,
    by `spin` with the defaults, it begins to rattle, stops and turns back. Energy is constant.

    Reference: [kane-levinson-1982], whose parameters are the defaults, in centimeters, seconds and per unit of mass,
    seen with its axis c upwards.

    Args:
        semi_axes: a, b, c.
        center: l, between 0 and c.
        inertia: Moments of inertia by mass about the axes of the ellipsoid, through the center of mass.
        product: $I_{12}$ by mass.
        gravity: g.
        tilt: Lean and pitch at the start.
        spin: theta' at the start.
        rates: Of lean and pitch at the start.

    Raises:
        ValueError: An axis, a moment or a gravity that is not positive, a wrong shape.

    Example:
        >>> ready = nh.examples.rattleback()
        >>> ready.coordinates, ready.body_velocity[2].item()
        (('x', 'y', 'theta', 'lean', 'pitch'), 5.0)
    """
    boat, q, angles = _Boat(semi_axes, center), np.array([0.0, 0.0, 0.0, *tilt]), np.array([spin, *rates])
    system = _system(boat, inertia, product, gravity)
    with double_precision():
        v = np.append(np.asarray(boat.rolling(jnp.asarray(q))) @ angles, angles)
    facts = ("Turned in the wrong direction it rattles, stops, and turns back.", "The energy is constant.")
    conserved = {"energy": energy_of(system.lagrangian)}
    return Example("rattleback", system, q, v, facts, conserved, time_step=0.002, steps=5000)


class _Boat(NamedTuple):
    """The ellipsoid, and how it rolls."""

    axes: tuple[float, ...]
    low: float

    def support(self, q: Array) -> tuple[Array, Array, Array]:
        """Return the height of the center of mass, its gradient by the vertical, and the vertical, in body axes."""
        (lean, rise), (sin, cos) = (jnp.sin(q[3]), jnp.cos(q[3])), (jnp.sin(q[4]), jnp.cos(q[4]))
        up, D = jnp.stack([-sin * rise, lean, cos * rise]), np.array(self.axes) ** 2
        width = jnp.sqrt(up @ (D * up))
        return width - self.low * up[2], D * up / width - self.low * np.array([0.0, 0.0, 1.0]), up

    def turns(self, q: Array) -> Array:
        """Return the angular velocities of one unit of each rate of an angle, as columns in body axes."""
        ahead = jnp.stack([jnp.cos(q[4]), 0.0 * q[4], jnp.sin(q[4])])
        return jnp.stack([self.support(q)[2], ahead, np.array([0.0, 1.0, 0.0])], axis=1)

    def rolling(self, q: Array) -> Array:
        """Return the matrix from rates of the angles to the velocity ahead and to the left."""
        (lean, rise), (sin, cos) = (jnp.sin(q[3]), jnp.cos(q[3])), (jnp.sin(q[4]), jnp.cos(q[4]))
        level = jnp.stack([jnp.stack([cos, 0.0 * cos, sin]), jnp.stack([sin * lean, rise, -cos * lean])])
        return level @ jnp.cross(self.turns(q).T, self.support(q)[1]).T


@functools.cache
def _system(boat: _Boat, moments: tuple[float, ...], I12: float, g: float) -> LagrangeDAlembert:
    tensor = np.diag(moments) + I12 * np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])

    def lagrangian(q: Array, v: Array) -> Array:
        height, gradient, up = boat.support(q)
        omega = boat.turns(q) @ v[2:]
        velocity = jnp.stack([v[0], v[1], gradient @ jnp.cross(up, omega)])
        return (velocity @ velocity + omega @ tensor @ omega) / 2 - g * height

    def forms(q: Array) -> Array:
        cos, sin = jnp.cos(q[2]), jnp.sin(q[2])
        return jnp.concatenate([jnp.eye(2), -jnp.array([[cos, -sin], [sin, cos]]) @ boat.rolling(q)], axis=1)

    looks = {"heading": "theta", "outline": functools.partial(_outline, boat)}
    return system_in("x y theta lean pitch", "Rattleback", lagrangian, forms, **looks)


def _outline(boat: _Boat, _q: Array) -> list[Array]:
    """Return the rim as it looks from above, and the long axis ahead."""
    a, b, _ = boat.axes
    angle = np.linspace(0.0, 2 * np.pi, 41)
    return [np.stack([a * np.cos(angle), b * np.sin(angle)], axis=1), np.array([[0.5 * a, 0.0], [a, 0.0]])]
