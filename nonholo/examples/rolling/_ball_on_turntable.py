"""The ball on a table that turns."""

import functools

import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import number
from nonholo.base.types import Array
from nonholo.examples._example import Example, numbers, positives, ready
from nonholo.lagrange_dalembert import LagrangeDAlembert


@ready("place", "velocity")
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
    orientation, but the equations of a uniform ball know no more of it; its spin about the vertical is constant.

    $$ L = \tfrac m2(\dot x^2 + \dot y^2) + \tfrac J2(\dot\alpha^2 + \dot\beta^2), \qquad
       \dot x - r\dot\beta = -\Omega y, \quad \dot y + r\dot\alpha = \Omega x . $$

    The constraint moves: the table does work, and the energy is not constant. The middle runs on a circle at the rate
    $\kappa = \Omega\,J/(J + mr^2)$, two sevenths of that of the table for a solid ball: $\ddot x = -\kappa\dot y$,
    $\ddot y = \kappa\dot x$. In the midpoint rule it does, too, and each step turns by $2\arctan(h\kappa/2)$.

    Reference: [neimark-fufaev-1972].

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
    name = "ball_on_turntable"
    m, r, J = positives(name, mass=mass, radius=radius, inertia=inertia)
    Omega = float(number(f"examples.{name}(table_rate=...)", table_rate))
    x, y = numbers(name, "place", place, 2, "x and y")
    u, w = numbers(name, "velocity", velocity, 2, "x' and y'")
    kappa = Omega * J / (J + m * r**2)

    def exact(time: Array) -> Array:
        t = np.asarray(time)
        middle = _circle(x + 1j * y, u + 1j * w, kappa, t)
        # the constraint, integrated: r (beta - i alpha) = z - z0 - i Omega integral of z
        turned = (middle - (x + 1j * y) - 1j * Omega * _area(x + 1j * y, u + 1j * w, kappa, t)) / r
        return np.stack([middle.real, middle.imag, -turned.imag, turned.real], axis=-1)

    conserved = {
        "x' + kappa y": lambda q, v: v[..., 0] + kappa * q[..., 1],
        "y' - kappa x": lambda q, v: v[..., 1] - kappa * q[..., 0],
    }
    facts = ("The middle runs on a circle, at 2/7 of the rate of the table.", "So it does in the midpoint rule.")
    q, v = np.array([x, y, 0.0, 0.0]), np.array([u, w, (Omega * x - w) / r, (u + Omega * y) / r])
    return Example(name, _system(m, r, J, Omega), q, v, facts, conserved, exact)


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


@functools.cache
def _system(m: float, r: float, J: float, Omega: float) -> LagrangeDAlembert:
    def lagrangian(q: Array, v: Array) -> Array:
        del q
        return jnp.array([m, m, J, J]) @ v**2 / 2

    def forms(q: Array) -> Array:
        del q
        return jnp.array([[1.0, 0.0, 0.0, -r], [0.0, 1.0, r, 0.0]])

    return LagrangeDAlembert(
        lagrangian,
        forms,
        dimension=4,
        constraint_velocities=lambda q, _time: Omega * jnp.stack([-q[1], q[0]]),
        coordinates=("x", "y", "alpha", "beta"),
        name="Ball on a turntable",
    )
