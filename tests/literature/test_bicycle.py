"""The bicycle against published numbers: the linear equations of its benchmark, and the nonlinear ones of others."""

import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
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
    system, freely = nh.examples.bicycle().system, jnp.array([LEAN, STEER])

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


def test_the_linear_equations_are_those_of_the_benchmark() -> None:
    """M from torques, C1, K0 and K2 from derivatives at two speeds: 12 digits of the largest entry of each."""
    (still, mobility), (moving, _) = reduced(0.0), reduced(1.0)
    mass = np.linalg.inv(mobility)
    found = mass, -mass @ moving[:, 2:], -mass @ still[:, :2] / G, -mass @ (moving - still)[:, :2]
    for matrix, published in zip(found, (M, C1, K0, K2), strict=True):
        assert np.abs(matrix - published).max() <= 1e-12 * np.abs(published).max()


@pytest.mark.parametrize("speed", EIGENVALUES)
def test_eigenvalues_are_those_of_the_table(speed: int) -> None:
    """To the last of its 14 decimals but one."""
    found = np.linalg.eigvals(np.block([[np.zeros((2, 2)), np.eye(2)], [reduced(float(speed))[0]]]))
    listed = {complex(x) for x in EIGENVALUES[speed]} | {complex(x).conjugate() for x in EIGENVALUES[speed]}
    assert max(min(abs(x - y) for y in found) for x in listed) <= 2e-12


def test_it_rides_upright_between_weave_and_capsize() -> None:
    """The largest real part of an eigenvalue changes sign at the two published speeds."""

    def growth(speed: float) -> float:
        blocks = np.block([[np.zeros((2, 2)), np.eye(2)], [reduced(speed)[0]]])
        return float(np.linalg.eigvals(blocks).real.max())

    for inside, speed, outside in ((1e-9, 4.292382536341, -1e-9), (-1e-9, 6.024262015388, 1e-9)):
        assert growth(speed + inside) < 0.0 < growth(speed + outside)


def test_accelerations_far_from_upright_are_published() -> None:
    """Of a turning, leaning, steered state: table 1 of Basu-Mandal et al., in its 13 digits, turned into our axes."""
    # theirs: lean from the horizontal, pitch from upside down, wheels backward and from their frames
    lean, pitch, steer = np.pi / 2 - 0.9501292851472, 3.1257073014894 - np.pi, -0.2311385135743
    rear, front = 8.9129896614890 - 0.0119185528069, 8.0133620584155
    rates = 0.7830033527065, -0.6068425835418, -0.0119185528069, -0.4859824687093, rear, front
    published = 0.8353281706379, 7.8555281128244, 0.1205543897884, 4.6198904039403
    rear, front = 1.8472554144217 + 0.1205543897884, 2.4548072904550
    ready = nh.examples.bicycle()
    with double_precision():
        q, v = jnp.array([0.0, 0.0, 0.0, lean, pitch, steer, 0.0, 0.0]), jnp.array([0.3 * rates[4], 0.0, *rates])
        assert np.abs(ready.system.constraint_forms(q) @ v).max() <= 1e-12
        found = np.asarray(jax.jit(functools.partial(acceleration, ready.system))(q, v))[2:]
    assert abs(ready.conserved["height of the front contact"](np.asarray(q), np.asarray(v))) <= 1e-13
    assert np.abs(found - np.array([*published, rear, front])).max() <= 2e-12


@pytest.mark.profile("routes", instead="test_accelerations_far_from_upright_are_published")
def test_the_map_keeps_the_contact_and_rides_as_the_flow() -> None:
    """The front wheel stays on the ground to rounding, where the midpoint rule alone would lift it; order two."""
    ready = nh.examples.bicycle()
    exact = ready.flow(times=(0.0, 1.0), rtol=1e-13, atol=1e-14)
    height = ready.conserved["height of the front contact"]
    errors = []
    for steps in (100, 200):
        orbit = ready.simulate(steps=steps, time_step=1.0 / steps)
        assert np.abs(height(orbit.configuration, orbit.body_velocity)).max() <= 1e-14
        errors.append(np.abs(orbit.configuration[-1] - exact.configuration[-1]).max())
    assert abs(np.log2(errors[0] / errors[1]) - 2.0) <= 0.1
    energy = ready.conserved["energy"](exact.configuration, exact.body_velocity)
    assert np.ptp(energy) <= 1e-11 * energy[0]
