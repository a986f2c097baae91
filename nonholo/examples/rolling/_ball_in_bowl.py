"""The ball in a bowl."""

import functools

import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import error, number
from nonholo.base.types import Array
from nonholo.examples._example import Example, energy_of, numbers, positives, ready
from nonholo.lagrange_dalembert import LagrangeDAlembert


@ready("place", "velocity", "spin")
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

    The turns are integrals of the angular velocity about the axes of space: equations of a uniform ball know no more of
    its orientation. With the middle at $c = \rho n$ from that of the bowl, in its lower half, and z its height,

    $$ L = \tfrac m2|\dot c|^2 + \tfrac J2|\omega|^2 - mgz, \qquad \dot c = -r\,\omega\times n, $$

    of which the horizontal part suffices. The spin $s = \omega\cdot n$ is constant, and

    $$ n\times\ddot n = \kappa s\,\dot n + \frac{mr^2}{J + mr^2}\,\frac1\rho\,n\times g, \qquad
       \kappa = \frac{Jr}{\rho\,(J + mr^2)}: $$

    without spin that is a spherical pendulum of the length $\rho$ with five sevenths of the weight. So the energy and
    $e_z\cdot(n\times\dot n) - \kappa s\,n_z$ are constant, too.

    Reference: [neimark-fufaev-1972].

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
    name, where = "ball_in_bowl", "examples.ball_in_bowl"
    sizes = {"mass": mass, "radius": radius, "inertia": inertia, "reach": reach, "gravity": gravity}
    m, r, J, rho, g = positives(name, **sizes)
    c, v = (numbers(name, what, x, 2, "x and y") for what, x in (("place", place), ("velocity", velocity)))
    s = float(number(f"{where}(spin=...)", spin))
    if not c @ c < rho**2:
        raise error(f"{where}(place=...)", f"be less than {rho:g} from the axis", str(c.tolist()), "Start in the bowl.")
    q = np.append(c, np.zeros(3))
    n, dn = _normal(rho, q, np.append(v, np.zeros(3)))
    rates = np.append(v, s * n - rho / r * np.cross(n, dn))
    kappa = J * r / (rho * (J + m * r**2))

    def spinning(q: Array, v: Array) -> Array:
        return (_normal(rho, q, v)[0] * v[..., 2:]).sum(axis=-1)

    def momentum(q: Array, v: Array) -> Array:
        n, dn = _normal(rho, q, v)
        return np.cross(n, dn)[..., 2] - kappa * spinning(q, v) * n[..., 2]

    system = _system(m, r, J, rho, g)
    conserved = {"spin": spinning, "momentum": momentum, "energy": energy_of(system.lagrangian)}
    facts = (
        "Without spin it moves like a spherical pendulum with five sevenths of its weight.",
        "Spin, energy and a momentum about the vertical are constant.",
    )
    return Example(name, system, q, rates, facts, conserved)


def _normal(rho: float, q: Array, v: Array) -> tuple[Array, Array]:
    """Return the outward normals at places, and their rates."""
    depth = np.sqrt(rho**2 - q[..., 0] ** 2 - q[..., 1] ** 2)
    falling = (q[..., 0] * v[..., 0] + q[..., 1] * v[..., 1]) / depth
    n, dn = (np.stack(each, axis=-1) for each in ((q[..., 0], q[..., 1], -depth), (v[..., 0], v[..., 1], falling)))
    return n / rho, dn / rho


@functools.cache
def _system(m: float, r: float, J: float, rho: float, g: float) -> LagrangeDAlembert:
    def lagrangian(q: Array, v: Array) -> Array:
        depth = jnp.sqrt(rho**2 - q[0] ** 2 - q[1] ** 2)
        falling = (q[0] * v[0] + q[1] * v[1]) / depth
        return (m * (v[0] ** 2 + v[1] ** 2 + falling**2) + J * (v[2:] @ v[2:])) / 2 + m * g * depth

    def forms(q: Array) -> Array:
        x, y, z = q[0] / rho, q[1] / rho, -jnp.sqrt(rho**2 - q[0] ** 2 - q[1] ** 2) / rho
        ahead = jnp.stack([1.0 + 0 * x, 0 * x, 0 * x, r * z, -r * y])
        return jnp.stack([ahead, jnp.stack([0 * x, 1.0 + 0 * x, -r * z, 0 * x, r * x])])

    names = ("x", "y", "alpha", "beta", "gamma")
    return LagrangeDAlembert(lagrangian, forms, dimension=5, coordinates=names, name="Ball in a bowl")
