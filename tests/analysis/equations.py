"""Equations of flows and maps: rates of momenta, the cubic of sleighs, steps in many digits, a bead on a hoop."""

from collections.abc import Callable
from typing import Any

import jax.numpy as jnp
import mpmath
import numpy as np

import nonholo as nh
from nonholo.base.types import Array
from nonholo.systems import AbstractLLSystem

G = 9.81
_ITERATIONS = 10  # which double the digits


def momentum_rate(system: AbstractLLSystem) -> Callable[[np.ndarray], np.ndarray]:
    """Return the rate of momenta along the flow."""
    field, pose = nh.vector_field(system), system.group.identity.ravel()
    return lambda r: field(0.0, np.concatenate([r, pose]))[: len(r)]


def momenta_of_energy(system: AbstractLLSystem, energy: float, angles: np.ndarray) -> np.ndarray:
    """Return momenta of one energy all around, of a system with two directions."""
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return circle @ np.linalg.cholesky(system.constrained_inertia).T * np.sqrt(2 * energy)


def cubic(sleigh: nh.ChaplyginSleigh, h: float, restricted: np.ndarray) -> np.ndarray:
    """Return the coefficients of the cubic in t = tan(D/2) over a momentum."""
    pi, p_1 = h * (restricted[0] + sleigh.b * restricted[1]), h * restricted[1]
    hat = sleigh.a * p_1 + 2 * sleigh.mass * sleigh.a**2
    return np.array([hat, -pi, 2 * sleigh.inertia + hat, -pi])


def sleigh_step(mass: Any, inertia: Any, a: Any, momenta: Any) -> tuple[Any, tuple[Any, Any]]:
    """Return t = tan(D/2), a root of the cubic, and (h pi, h p_1) after the step."""
    pi, p = momenta
    hat = a * p + 2 * mass * a * a
    t = pi / (2 * inertia + hat)
    for _ in range(_ITERATIONS):
        t -= (((hat * t - pi) * t + 2 * inertia + hat) * t - pi) / ((3 * hat * t - 2 * pi) * t + 2 * inertia + hat)
    versine = 2 * t * t / (1 + t * t)
    return t, (pi - 2 * a * t * (p + a * mass * versine), p + 2 * a * mass * versine)


def top_step(inertia: mpmath.matrix, coupling: list[Any], m: mpmath.matrix) -> tuple[mpmath.matrix, mpmath.matrix]:
    """Return y with B y + (c . y_perp) y_perp = (1 + |y|^2) m, and h r/2 after the step from m."""
    y = mpmath.lu_solve(inertia, m)
    for _ in range(_ITERATIONS):
        s, square, turned = _across(coupling, y)
        slope = inertia + s * mpmath.matrix([[0, -1], [1, 0]]) + turned * mpmath.matrix([[coupling[1], -coupling[0]]])
        y = y - mpmath.lu_solve(slope - 2 * m * y.T, inertia * y + s * turned - square * m)
    s, square, turned = _across(coupling, y)
    return y, m - 2 * s / square * turned


def _across(c: list[Any], y: mpmath.matrix) -> tuple[Any, Any, mpmath.matrix]:
    return c[1] * y[0] - c[0] * y[1], 1 + y[0] ** 2 + y[1] ** 2, mpmath.matrix([-y[1], y[0]])


def hoop(angle: Callable[[Array], Array]) -> nh.LagrangeDAlembert:
    """Return a bead on a hoop of radius 1 that turns about its vertical diameter as prescribed."""

    def lagrangian(q: Array, v: Array) -> Array:
        return (v[0] ** 2 + (v[1] * jnp.sin(q[0])) ** 2) / 2 + G * jnp.cos(q[0])

    return nh.LagrangeDAlembert(lagrangian, None, dimension=2, prescribed={1: angle}, coordinates=("bead", "hoop"))
