"""The snake of three links on wheels."""

import functools
from typing import Any

import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import error
from nonholo.base.types import Array
from nonholo.examples._example import Example, energy_of, numbers, positives, ready
from nonholo.examples._outlines import pair, turn
from nonholo.lagrange_dalembert import LagrangeDAlembert


@ready("place", "joints", "joint_rates")
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

    Three constraints leave two rates: a principal kinematic system, whose joints say how it moves. With
    $\dot x = u\cos\theta$, $\dot y = u\sin\theta$ and $\omega = \dot\theta$

    $$ u\sin\alpha_1 - l(1 + \cos\alpha_1)\,\omega + l\,\dot\alpha_1 = 0, \qquad
       -u\sin\alpha_2 + l(1 + \cos\alpha_2)\,\omega + l\,\dot\alpha_2 = 0 . $$

    With $\alpha_1 = \alpha_2$ it is an arc, whose axles meet in one point. There it rolls about that point at any rate,
    and its joints move oppositely, $\dot\alpha_1 = -\dot\alpha_2$: the motion passes, and joints do not determine it.

    Reference: [shammas-choset-rizzi-2007].

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
    name = "snake"
    half, m, J = positives(name, half_length=half_length, mass=mass, inertia=inertia)
    q = numbers(name, "place", place, 3, "x, y and theta")
    a = numbers(name, "joints", joints, 2, "alpha1 and alpha2")
    turning = numbers(name, "joint_rates", joint_rates, 2, "the rates of alpha1 and alpha2")
    if not (np.abs(a) < np.pi).all() or abs(a[0] - a[1]) < 1e-6:
        where, remedy = f"examples.{name}(joints=...)", "An arc may roll at any rate: bend the joints differently."
        raise error(where, "differ and be between -pi and pi", str(a.tolist()), remedy)
    sign = np.array([1.0, -1.0])
    rows = np.stack([sign * np.sin(a), -sign * half * (1 + np.cos(a))], axis=1)
    u, omega = np.linalg.solve(rows, -half * turning)
    v = np.array([u * np.cos(q[2]), u * np.sin(q[2]), omega, *turning])
    system = _system(half, m, J)
    facts = (
        "The joints say how it moves, but where it is an arc, with both alike: that may roll at any rate.",
        "The energy is constant.",
    )
    return Example(name, system, np.append(q, a), v, facts, {"energy": energy_of(system.lagrangian)})


@functools.cache
def _system(half: float, m: float, J: float) -> LagrangeDAlembert:
    def links(q: Array) -> tuple[Array, Array, Array]:
        """Return the headings of the links, and matrices from velocities to those of their middles along x and y."""
        headings = q[2] + jnp.stack([-q[3], 0.0 * q[3], q[4]])
        cos, sin = jnp.cos(headings), jnp.sin(headings)
        # p = (x, y) -+ half e(theta) -+ half e(theta of the outer link)
        x = jnp.stack([half * (sin[0] + sin[1]), 0.0 * sin[1], -half * (sin[1] + sin[2])])
        y = jnp.stack([-half * (cos[0] + cos[1]), 0.0 * cos[1], half * (cos[1] + cos[2])])
        ones, zeros, first, last = np.ones(3), np.zeros(3), np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
        across = jnp.stack([ones, zeros, x, -half * sin[0] * first, -half * sin[2] * last], axis=1)
        return headings, across, jnp.stack([zeros, ones, y, half * cos[0] * first, half * cos[2] * last], axis=1)

    def lagrangian(q: Array, v: Array) -> Array:
        _, x, y = links(q)
        turning = v[2] + jnp.stack([-v[3], 0.0 * v[3], v[4]])
        return (m * ((x @ v) @ (x @ v) + (y @ v) @ (y @ v)) + J * (turning @ turning)) / 2

    def forms(q: Array) -> Array:
        headings, x, y = links(q)
        return jnp.cos(headings)[:, None] * y - jnp.sin(headings)[:, None] * x

    looks: dict[str, Any] = {"heading": "theta", "outline": functools.partial(_outline, half), "name": "Snake"}
    return LagrangeDAlembert(
        lagrangian, forms, dimension=5, coordinates=("x", "y", "theta", "alpha1", "alpha2"), **looks
    )


def _outline(half: float, q: Array) -> list[Array]:
    """Return the three links, each with its wheels; the middle one first."""
    link = half * np.array([[-0.95, -0.15], [0.95, -0.15], [0.95, 0.15], [-0.95, 0.15]])
    parts = [link, *pair((0.0, 0.0), 0.35 * half, 0.35 * half)]
    for side, angle in ((-1.0, -q[3]), (1.0, q[4])):
        middle = side * half * (np.array([1.0, 0.0]) + turn(angle)[0])
        parts += [middle + link @ turn(angle), *pair((middle[0], middle[1]), 0.35 * half, 0.35 * half, angle)]
    return parts
