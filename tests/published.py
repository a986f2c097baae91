"""Numbers that others published about the bicycle, and the same of this library; also for `benchmarks/foreign.py`."""

import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from accelerations import acceleration, admissible

import nonholo as nh
from nonholo.base.numerics import double_precision
from nonholo.base.types import Array

LEAN, STEER, REAR, G = 3, 5, 6, 9.81
M = [[80.81722, 2.31941332208709], [2.31941332208709, 0.29784188199686]]
C1 = [[0.0, 33.86641391492494], [-0.85035641456978, 1.68540397397560]]
K0 = [[-80.95, -2.59951685249872], [-2.59951685249872, -0.80329488458618]]
K2 = [[0.0, 76.59734589573222], [0.0, 2.65431523794604]]
"""Equations (A.27) of the benchmark, in 14 decimals."""
EIGENVALUES = {
    0: (-3.13164324790656, -5.53094371765393, 3.13164324790656, 5.53094371765393),
    1: (-3.13423125066578, -7.11008014637442, 3.52696170990070 + 0.80774027519930j),
    2: (-3.07158645641514, -8.67387984831735, 2.68234517512745 + 1.68066296590675j),
    3: (-2.63366137253667, -10.35101467245920, 1.70675605663975 + 2.31582447384325j),
    4: (-1.42944427361326, -12.15861426576447, 0.41325331521125 + 3.07910818603206j),
    5: (-0.32286642900409, -14.07838969279822, -0.77534188219585 + 4.46486771378823j),
    6: (-0.00406690076970, -16.08537123098026, -1.52644486584142 + 5.87673060598709j),
    7: (0.10268170574766, -18.15788466125262, -2.13875644258362 + 7.19525913329805j),
    8: (0.14327879765713, -20.27940894394569, -2.69348683581097 + 8.46037971396931j),
    9: (0.15790184030917, -22.43788559040858, -3.21675402252485 + 9.69377351531791j),
    10: (0.16105338653172, -24.62459635017404, -3.72016840437287 + 10.90681139476287j),
}
"""Table 2 of the benchmark, one of each pair."""


@functools.cache
def derivatives() -> Callable[..., Any]:
    """Return the derivatives of the accelerations of lean and steer, compiled once, as a function of the speed."""
    system, freely = nh.examples.bicycle().system.plain, jnp.array([LEAN, STEER])

    def rates(state: Array, torque: Array, speed: Array) -> Array:
        q = jnp.zeros(8).at[freely].set(state[:2])  # the pitch is of second order
        v = admissible(system, q, (REAR, LEAN, STEER), jnp.stack([speed / 0.3, state[2], state[3]]))
        return acceleration(system, q, v, jnp.zeros(8).at[freely].set(torque))[freely]

    return jax.jit(jax.jacfwd(rates, argnums=(0, 1)))


def reduced(speed: float) -> tuple[Array, Array]:
    """Return accelerations of lean and steer, differentiated by (lean, steer, their rates), and by their torques."""
    with double_precision():
        by_state, by_torque = derivatives()(jnp.zeros(4), jnp.zeros(2), jnp.asarray(speed))
        return np.asarray(by_state), np.asarray(by_torque)


def rolling_disk(gravity: float, rates: Array, lean: float) -> Array:
    """Return accelerations of heading, lean and rolling of a uniform thin disk of radius one, as sympy#27631 has them.

    The issue is about the page "A rolling disk using the Lagrange method", whose three equations leave out the rolling.
    """
    turning, falling, rolling = rates
    sin, cos = np.sin(lean), np.cos(lean)
    turned = -2 * falling * rolling / cos
    fallen = 4 * gravity * sin / 5 + np.sin(2 * lean) * turning**2 / 2 + 6 * cos * turning * rolling / 5
    return np.array([turned, fallen, -(10 * cos * turning - 12 * sin / cos * rolling) * falling / 6])


SPEEDS = 4.29238253634111, 6.02426201538837
"""Above the first weave, below the second capsize is damped."""


def linear_equations() -> tuple[Array, Array, Array, Array]:
    """Return M, C1, K0 and K2 of the linear equations of `nh.examples.bicycle`."""
    (still, mobility), (moving, _) = reduced(0.0), reduced(1.0)
    mass = np.linalg.inv(mobility)
    return mass, -mass @ moving[:, 2:], -mass @ still[:, :2] / G, -mass @ (moving - still)[:, :2]


def spectrum(speed: float) -> Array:
    """Return its eigenvalues."""
    return np.linalg.eigvals(np.block([[np.zeros((2, 2)), np.eye(2)], [reduced(speed)[0]]]))


def turning_state() -> tuple[float, float, Array, Array]:
    """Return height and slip of the front contact of a published state, and its accelerations: ours, those of others.

    Theirs have the lean from the horizontal, the pitch from upside down, wheels backward and from their frames.
    """
    lean, pitch, steer = np.pi / 2 - 0.9501292851472, 3.1257073014894 - np.pi, -0.2311385135743
    rear, front = 8.9129896614890 - 0.0119185528069, 8.0133620584155
    rates = 0.7830033527065, -0.6068425835418, -0.0119185528069, -0.4859824687093, rear, front
    rear, front = 1.8472554144217 + 0.1205543897884, 2.4548072904550
    published = 0.8353281706379, 7.8555281128244, 0.1205543897884, 4.6198904039403, rear, front
    ready = nh.examples.bicycle()
    system = ready.system.plain
    q, v = np.array([0.0, 0.0, 0.0, lean, pitch, steer, 0.0, 0.0]), np.array([0.3 * rates[4], 0.0, *rates])
    with double_precision():
        slip = np.abs(system.constraint_forms(jnp.asarray(q)) @ v).max()
        result = np.asarray(jax.jit(functools.partial(acceleration, system))(jnp.asarray(q), jnp.asarray(v)))
    height = ready.conserved["height of the front contact"](q, v)
    return float(height), float(slip), result[2:], np.array(published)
