"""The tractor with trailers."""

import functools
from typing import Any

import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import array, error, number
from nonholo.base.types import Array
from nonholo.examples._example import Example, numbers, positives, rate, ready
from nonholo.examples._outlines import pair, turn
from nonholo.lagrange_dalembert import LagrangeDAlembert


@ready("place", "angles", "speed", "turning")
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
    name, where = "trailers", "examples.trailers"
    lengths = array(f"{where}(hitches=...)", hitches, (None,), "Pass one length for each trailer.")
    if not len(lengths):
        raise error(f"{where}(hitches=...)", "have at least one length", "none", "Pass one for each trailer.")
    d = tuple(positives(name, **{f"hitches[{i}]": length for i, length in enumerate(lengths)}))
    bodies = {"mass": mass, "inertia": inertia, "trailer_mass": trailer_mass, "trailer_inertia": trailer_inertia}
    m, J, trailer, turned = positives(name, **bodies)
    given = np.zeros(len(d) + 1) if angles is None else angles
    headings = numbers(name, "angles", given, len(d) + 1, "the heading of the tractor, then those of the trailers")
    u, omega = (float(number(f"{where}({what}=...)", x)) for what, x in {"speed": speed, "turning": turning}.items())
    rates, along = [omega], u
    for length, bend in zip(d, headings[:-1] - headings[1:], strict=True):
        rates.append(along * np.sin(bend) / length)
        along *= np.cos(bend)
    q = np.append(numbers(name, "place", place, 2, "x and y"), headings)
    v = np.array([u * np.cos(headings[0]), u * np.sin(headings[0]), *rates])
    masses, moments = (m, *len(d) * (trailer,)), (J, *len(d) * (turned,))

    def energy(q: Array, v: Array) -> Array:
        angles, ahead = q[..., 2:], v[..., 0] * np.cos(q[..., 2]) + v[..., 1] * np.sin(q[..., 2])
        speeds = ahead[..., None] * np.cumprod(np.cos(angles[..., :-1] - angles[..., 1:]), axis=-1)
        own = m * ahead**2 + trailer * (speeds**2).sum(axis=-1)
        return (own + v[..., 2:] ** 2 @ np.array(moments)) / 2

    facts = (
        "The turning of the tractor is constant, also in the midpoint rule, and so is the energy of the flow.",
        "Its speed and turning alone say how all trailers move; they can bring them anywhere.",
    )
    return Example(name, _system(d, masses, moments), q, v, facts, {"theta'": rate(2), "energy": energy})


@functools.cache
def _system(d: tuple[float, ...], masses: tuple[float, ...], moments: tuple[float, ...]) -> LagrangeDAlembert:
    n = len(d) + 1
    behind = np.tril(np.tile([0.0, *d], (n, 1)))  # of each axle, how far it is behind along each heading

    def velocities(q: Array) -> tuple[Array, Array]:
        """Return matrices from velocities to those of the axles along x and along y."""
        cos, sin = jnp.cos(q[2:]), jnp.sin(q[2:])
        ones, zeros = np.ones((n, 1)), np.zeros((n, 1))
        return jnp.hstack([ones, zeros, behind * sin]), jnp.hstack([zeros, ones, -behind * cos])

    def lagrangian(q: Array, v: Array) -> Array:
        x, y = velocities(q)
        return (np.array(masses) @ ((x @ v) ** 2 + (y @ v) ** 2) + np.array(moments) @ v[2:] ** 2) / 2

    def forms(q: Array) -> Array:
        x, y = velocities(q)
        return jnp.cos(q[2:])[:, None] * y - jnp.sin(q[2:])[:, None] * x

    looks: dict[str, Any] = {"heading": "theta", "outline": functools.partial(_outline, d), "name": "Trailers"}
    names = ("x", "y", "theta", *(f"theta{i}" for i in range(1, n)))
    return LagrangeDAlembert(lagrangian, forms, dimension=n + 2, coordinates=names, **looks)


def _outline(d: tuple[float, ...], q: Array) -> list[Array]:
    """Return the cab with its wheels, and of each trailer the box, the bar and the wheels."""
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
