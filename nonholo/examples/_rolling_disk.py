"""The vertical rolling disk."""

import functools

import jax.numpy as jnp
import numpy as np

from nonholo.base.types import Array
from nonholo.examples._example import Example, Numbers, numbers, positives, rate, ready, sized
from nonholo.examples._outlines import wheel
from nonholo.lagrange_dalembert import LagrangeDAlembert


@ready("configuration", "rates")
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
    inertias = {"rolling_inertia": rolling_inertia, "turning_inertia": turning_inertia}
    body = positives("rolling_disk", mass=mass, radius=radius, **inertias)
    R = body[1]
    q = numbers("rolling_disk", "configuration", configuration, 4, "x, y, theta and phi")
    roll, turn = numbers("rolling_disk", "rates", rates, 2, "theta' and phi'")

    def exact(time: Array) -> Array:
        t = np.asarray(time)
        # the chord of the arc: its length is that of the arc times sinc, also for phi' = 0
        chord = R * roll * t * np.sinc(turn * t / (2 * np.pi))
        middle = q[3] + turn * t / 2
        x, y = q[0] + chord * np.cos(middle), q[1] + chord * np.sin(middle)
        return np.stack([x, y, q[2] + roll * t, q[3] + turn * t], axis=-1)

    conserved = {"theta'": rate(2), "phi'": rate(3)}
    facts = ("theta' and phi' are constant, also in the midpoint rule.", "The contact point moves on a circle.")
    v = np.array([R * np.cos(q[3]) * roll, R * np.sin(q[3]) * roll, roll, turn])
    return Example("rolling_disk", sized(_system, *body), q, v, facts, conserved, exact)


@functools.cache
def _system() -> LagrangeDAlembert:
    def lagrangian(q: Array, v: Array, p: Numbers) -> Array:
        del q
        return jnp.array([p["mass"], p["mass"], p["rolling_inertia"], p["turning_inertia"]]) @ v**2 / 2

    def forms(q: Array, p: Numbers) -> Array:
        R = p["radius"]
        return jnp.array([[1.0, 0.0, -R * jnp.cos(q[3]), 0.0], [0.0, 1.0, -R * jnp.sin(q[3]), 0.0]])

    names = ("x", "y", "theta", "phi")
    return LagrangeDAlembert(
        lagrangian,
        forms,
        dimension=4,
        coordinates=names,
        heading="phi",
        outline=lambda _, p: [wheel((0.0, 0.0), 2 * p["radius"], width=0.1)],
        parameters=dict.fromkeys(("mass", "radius", "rolling_inertia", "turning_inertia"), 1.0),
        name="Rolling disk",
    )
