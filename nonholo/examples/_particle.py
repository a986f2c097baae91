"""The nonholonomic particle."""

import functools

import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import scale
from nonholo.base.types import Array
from nonholo.examples._example import Example, Numbers, numbers, rate, ready, sized
from nonholo.lagrange_dalembert import LagrangeDAlembert


@ready("configuration", "planar_velocity")
def particle(
    *,
    mass: float = 1.0,
    configuration: tuple[float, float, float] = (0.0, 0.0, 0.0),
    planar_velocity: tuple[float, float] = (1.0, 1.0),
) -> Example:
    r"""The free particle in space with the constraint z' = y x'.

    $$ L = \tfrac m2(\dot x^2 + \dot y^2 + \dot z^2), \qquad \dot z = y\,\dot x. $$

    With $\dot y = b$ and $c = \dot x\sqrt{1 + y^2}$, both constant, $y = y_0 + bt$ and

    $$ x - x_0 = \tfrac cb(\operatorname{arsinh} y - \operatorname{arsinh} y_0), \qquad
       z - z_0 = \tfrac cb\bigl(\sqrt{1 + y^2} - \sqrt{1 + y_0^2}\bigr). $$

    Reference: [bates-sniatycki-1993]; [cortes-martinez-2001].

    Args:
        mass: m.
        configuration: (x, y, z) at the start.
        planar_velocity: (x', y') at the start.

    Raises:
        ValueError: A mass that is not positive, a wrong shape.

    Example:
        >>> ready = nh.examples.particle()
        >>> orbit = ready.system.flow(
        ...     configuration=ready.configuration, body_velocity=ready.body_velocity, times=(0, 5))
        >>> bool(np.allclose(orbit.configuration, ready.exact(orbit.time), rtol=0, atol=1e-9))
        True
    """
    m = float(scale("examples.particle(mass=...)", mass, "Pass the mass."))
    q = numbers("particle", "configuration", configuration, 3, "x, y and z")
    a, b = numbers("particle", "planar_velocity", planar_velocity, 2, "x' and y'")
    y0 = q[1]
    c = a * np.sqrt(1 + y0**2)

    def exact(time: Array) -> Array:
        t = np.asarray(time)
        y = y0 + b * t
        # the quotients (f(y) - f(y0))/b in a form that stays accurate for b = 0
        root, root0 = np.sqrt(1 + y**2), np.sqrt(1 + y0**2)
        z = c * t * (y + y0) / (root + root0)
        x = c * t / root0 if b == 0 else c / b * (np.arcsinh(y) - np.arcsinh(y0))
        return np.stack([q[0] + x, y, q[2] + z], axis=-1)

    conserved = {"y'": rate(1), "x' sqrt(1 + y^2)": lambda q, v: v[..., 0] * np.sqrt(1 + q[..., 1] ** 2)}
    facts = ("y' and x' sqrt(1 + y^2) are constant.", "The discrete energy settles to a constant; it does not drift.")
    v = np.array([a, b, y0 * a])
    return Example("particle", sized(_system, m), q, v, facts, conserved, exact)


@functools.cache
def _system() -> LagrangeDAlembert:
    def lagrangian(q: Array, v: Array, p: Numbers) -> Array:
        del q
        return p["mass"] * (v @ v) / 2

    def forms(q: Array, p: Numbers) -> Array:
        del p
        return jnp.array([[-q[1], 0.0, 1.0]])

    about = {"coordinates": ("x", "y", "z"), "name": "Nonholonomic particle"}
    return LagrangeDAlembert(lagrangian, forms, dimension=3, parameters={"mass": 1.0}, **about)
