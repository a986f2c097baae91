"""Driven systems: equations written by hand, order, prescribed motions, forces and tables, and what is refused."""

from collections.abc import Callable

import jax.numpy as jnp
import numpy as np
import pytest
import scipy.linalg
from comparisons import assert_near
from refusals import refusals
from scipy.integrate import solve_ivp

import nonholo as nh
from nonholo.base.numerics import double_precision
from nonholo.examples import Example
from nonholo.lagrange_dalembert import LagrangeDAlembert

TIMES = np.linspace(0.0, 6.0, 13)


def _solved(rate: Callable, first: list[float]) -> np.ndarray:
    return solve_ivp(rate, (0.0, TIMES[-1]), first, t_eval=TIMES, method="DOP853", rtol=1e-13, atol=1e-14).y


def _sleigh_by_hand(time: float, z: np.ndarray) -> list[float]:
    """The momentum equations of the driven sleigh with its default parameters, and (x, y, theta)."""
    m, J, a, mu, d, A, Om = 1.0, 0.5, 0.3, 0.3, -0.3, 0.5, 1.0
    u, w, theta = z[0], z[1], z[4]
    s, ds, dds = A * np.sin(Om * time), A * Om * np.cos(Om * time), -A * Om**2 * np.sin(Om * time)
    sideways = m * a * w + mu * (d * w + ds)
    matrix = np.array([[m + mu, -mu * s], [-mu * s, J + m * a**2 + mu * s**2 + mu * d**2]])
    changes = np.array([[0.0, -mu * ds], [-mu * ds, 2 * mu * s * ds]]) @ [u, w] + [0.0, mu * d * dds]
    return [*np.linalg.solve(matrix, np.array([w, -u]) * sideways - changes), u * np.cos(theta), u * np.sin(theta), w]


def _racer_by_hand(time: float, z: np.ndarray) -> list[float]:
    """The momentum along the constraint of the roller racer with its default parameters, and (x, y, theta)."""
    m, seat, J, c, ell, k, A, Om = 1.0, 0.2, 0.02, 0.2, 1.0, 0.3, 0.5, 2.0
    u, theta = z[0], z[3]
    phi, dphi, ddphi = A * np.sin(Om * time), A * Om * np.cos(Om * time), -A * Om**2 * np.sin(Om * time)
    below = ell * np.cos(phi) + k
    sigma, dsigma = np.sin(phi) / below, dphi * (np.cos(phi) * below + ell * np.sin(phi) ** 2) / below**2
    turn, dturn = k * dphi / below, k * ddphi / below + k * dphi**2 * ell * np.sin(phi) / below**2
    w = sigma * u - turn  # dw = sigma du + dsigma u - dturn
    about = seat + m * c**2 + J
    rest = sigma * (about * (dsigma * u - dturn) + J * ddphi)
    du = ((w - sigma * u) * m * c * w - rest) / (m + about * sigma**2)
    return [du, u * np.cos(theta), u * np.sin(theta), w]


def _ball_by_hand(_time: float, z: np.ndarray) -> np.ndarray:
    """Momentum about the contact and the vertical, seen from the ball; and the path of the middle with its rotation."""
    M, R = z[:3], z[3:12].reshape(3, 3)
    gamma, inertia = R[2], np.diag([0.3, 0.4, 0.5])
    omega = np.linalg.solve(inertia + np.eye(3) - np.outer(gamma, gamma), M)
    return np.concatenate([np.cross(M, omega), (R @ nh.SO(3).hat(omega)).ravel(), R @ np.cross(omega, gamma)])


def _twistcar_by_hand(time: float, z: np.ndarray) -> np.ndarray:
    """Newton's and Euler's equations of both bodies of the Twistcar, with forces of wheels and pivot as unknowns."""
    (m, J, c), (mh, Jh, d), ell, k, A, Om = (1.0, 0.1, 0.3), (0.2, 0.01, 0.1), 1.0, 0.2, 0.5, 2.0
    rate, w, phi = z[3:5], z[5], A * np.sin(Om * time)
    turning, ddphi, theta = w + A * Om * np.cos(Om * time), -A * Om**2 * np.sin(Om * time), z[2]

    def arm(length: float, angle: float, rate: float) -> np.ndarray:
        """Return a vector, its derivative by the angle, and its centripetal acceleration."""
        e = np.array([np.cos(angle), np.sin(angle)])
        return length * np.array([e, [-e[1], e[0]], -(rate**2) * e])

    n, m_h = arm(1.0, theta, w)[1], arm(1.0, theta + phi, turning)[1]
    (rc, nc, ac), (rl, nl, al) = arm(c, theta, w), arm(ell, theta, w)
    (rd, nd, ad), (rk, nk, ak) = arm(d, theta + phi, turning), arm(k, theta + phi, turning)
    pivot = rate + w * nl  # velocities
    rows, right = np.zeros((8, 8)), np.zeros(8)  # x'', y'', theta'', rear force, pivot force, torque, front force
    rows[:2, :2], rows[:2, 2], rows[:2, 3], rows[:2, 4:6], right[:2] = m * np.eye(2), m * nc, -n, -np.eye(2), -m * ac
    lever = rl - rc
    rows[2, 2:7] = [J, rc[0] * n[1] - rc[1] * n[0], lever[1], -lever[0], 1.0]
    rows[3:5, :2], rows[3:5, 2], rows[3:5, 4:6], rows[3:5, 7] = mh * np.eye(2), mh * (nl + nd), np.eye(2), -m_h
    right[3:5] = -mh * (al + ad + ddphi * nd)
    lever = rk - rd
    rows[5, 2], rows[5, 4:] = Jh, [rd[1], -rd[0], -1.0, -(lever[0] * m_h[1] - lever[1] * m_h[0])]
    right[5] = -Jh * ddphi
    rows[6, :2], right[6] = n, w * np.array([n[1], -n[0]]) @ rate
    rows[7, :2], rows[7, 2] = m_h, m_h @ (nl + nk)
    ahead = np.array([m_h[1], -m_h[0]])
    right[7] = -m_h @ (al + ak + ddphi * nk) + turning * ahead @ (pivot + turning * nk)
    return np.concatenate([z[3:], np.linalg.solve(rows, right)[:3]])


@pytest.mark.profile("routes", instead="test_paths_are_those_derived_by_hand")
@pytest.mark.parametrize(("handle_inertia", "sign"), [(0.01, -1.0), (0.1, 1.0)])
def test_the_twistcar_goes_where_masses_send_it(handle_inertia: float, sign: float) -> None:
    """In the mean of periods it gains speed as the docstring says, up to the fourth power of the amplitude."""
    ready = nh.examples.twistcar(amplitude=0.01, handle_inertia=handle_inertia)
    m, J, mh, Jh, c, d, ell, k = 1.0, 0.1, 0.2, handle_inertia, 0.3, 0.1, 1.0, 0.2
    kappa = k / (ell + k)
    push = (1 - kappa) * mh * d - kappa * (m * c + mh * ell)
    turn = (1 - kappa) * Jh - kappa * (J + m * c**2) + mh * (ell + d) * ((1 - kappa) * d - kappa * ell)
    gain = 0.01**2 * 4.0 / 2 * (turn / (ell + k) - kappa * push) / (m + mh)
    assert gain * sign > 0
    orbit = ready.flow(times=np.pi * np.arange(11))  # whole periods
    speed = orbit.body_velocity[:, 0] * np.cos(orbit.configuration[:, 2])
    speed += orbit.body_velocity[:, 1] * np.sin(orbit.configuration[:, 2])
    np.testing.assert_allclose(np.diff(speed) / np.pi, gain, 1e-3)


def _robot_by_hand(time: float, z: np.ndarray) -> list[float]:
    """Speed and turning rate of the two-wheeled robot with its default parameters, torques and friction; the pose."""
    m, J, ell, c, R, Jw, d = 1.0, 0.5, 0.3, 0.5, 0.25, 0.01, 0.02
    u, w, theta = z[0], z[1], z[4]
    right, left = 0.1 + 0.05 * np.sin(time), 0.1 - 0.03 * time
    M, K = m + 2 * Jw / R**2, J + m * ell**2 + 2 * Jw * c**2 / R**2
    du = m * ell * w**2 + (right + left) / R - 2 * d * u / R**2
    dw = -m * ell * u * w + (right - left) * c / R - 2 * d * c**2 * w / R**2
    return [du / M, dw / K, u * np.cos(theta), u * np.sin(theta), w]


def _robot() -> Example:
    torques = lambda time: (0.1 + 0.05 * jnp.sin(time), 0.1 - 0.03 * time)  # noqa: E731
    return nh.examples.two_wheeled_robot(torques=torques, friction=0.02)


BY_HAND: dict[str, tuple[Callable[[], Example], Callable, list[float], slice]] = {
    "driven sleigh": (nh.examples.driven_sleigh, _sleigh_by_hand, [0.5, 0.3, 0.0, 0.0, 0.0], np.s_[2:]),
    "roller racer": (nh.examples.roller_racer, _racer_by_hand, [0.0, 0.0, 0.0, 0.0], np.s_[1:]),
    "Twistcar": (nh.examples.twistcar, _twistcar_by_hand, [], np.s_[:3]),
    "robot": (_robot, _robot_by_hand, [-0.5, 1.0, 0.0, 0.0, 0.0], np.s_[2:]),
}


@pytest.mark.profile("routes", keep=["roller racer"])
@pytest.mark.parametrize("name", BY_HAND)
def test_paths_are_those_derived_by_hand(name: str) -> None:
    """Path and heading of the flow, to 1e-10: by momenta along the constraint, or Newton's and Euler's equations.

    The axle of the robot keeps its angle.
    """
    things, rate, first, path = BY_HAND[name]
    ready = things()
    result = ready.flow(times=TIMES, rtol=1e-13, atol=1e-14)
    by_hand = _solved(rate, first or [*ready.configuration[:3], *ready.body_velocity[:3]])[path]
    assert np.abs(result.configuration[:, :3] - by_hand.T).max() <= 1e-10
    if name == "robot":
        assert list(ready.conserved) == ["axle"]
        assert np.ptp(ready.conserved["axle"](result.configuration, result.body_velocity)) <= 1e-11


def test_torques_of_the_robot() -> None:
    """Without torques and friction nothing drives it; two numbers are constant torques; others are refused."""
    robot = nh.examples.two_wheeled_robot
    assert not robot().system.is_driven
    assert robot(torques=lambda time: (time, 0.0)).system.description is None  # no store holds a function
    assert robot(torques=(0.3, 0.1)).system.description[1]["torques"] == [0.3, 0.1]
    force = robot(torques=(0.3, 0.1), friction=0.5).system.plain.force
    with double_precision():
        pushed = np.asarray(force(jnp.asarray(2.0), jnp.zeros(5), jnp.arange(5.0)))
    assert np.allclose(pushed, [0, 0, 0, 0.3 - 1.5, 0.1 - 2.0], rtol=0, atol=1e-15)
    with pytest.raises(ValueError, match=r"two_wheeled_robot\(torques=...\)` must have shape \(2,\)"):
        robot(torques=(0.3, 0.1, 0.2))
    with pytest.raises(ValueError, match=r"two_wheeled_robot\(friction=...\)` must not be negative. Got -0.1"):
        robot(friction=-0.1)


@pytest.mark.profile("long", instead="test_paths_are_those_derived_by_hand")
def test_the_ball_moves_as_derived_by_hand() -> None:
    """Path and rotation of the flow, to 1e-10, momentum in space and energy constant."""
    ready = nh.examples.chaplygin_ball()
    first = ready.conserved
    start = [first[f"momentum along {axis}"](ready.configuration, ready.body_velocity) for axis in "xyz"]
    by_hand = _solved(_ball_by_hand, [*start, *np.eye(3).ravel(), 0.0, 0.0, 0.0])
    result = ready.flow(times=TIMES, rtol=1e-13, atol=1e-14)
    assert np.abs(result.configuration[:, :3, :3].reshape(-1, 9) - by_hand[3:12].T).max() <= 1e-10
    assert np.abs(result.configuration[:, :3, 3] - by_hand[12:].T).max() <= 1e-10
    assert np.ptp(result.energy) <= 1e-11
    integrals = [values(result.configuration, result.body_velocity) for values in first.values()]
    assert np.ptp(integrals, axis=1).max() <= 1e-11


@pytest.mark.profile("routes", instead="test_paths_are_those_derived_by_hand")
@pytest.mark.parametrize("name", ["heavy_suslov_top", "sleigh_in_a_well"])
def test_integrals_under_a_potential(name: str) -> None:
    """Constant along the flow."""
    ready = getattr(nh.examples, name)()
    orbit = nh.flow(ready.system, body_velocity=ready.body_velocity, times=TIMES)
    for integral in ready.conserved.values():
        assert np.ptp(integral(orbit.configuration, orbit.body_velocity)) <= 1e-11


def test_the_sleigh_in_a_well_obeys_a_linear_system() -> None:
    """With its center of mass at the contact: speed and place seen from the sleigh, by the exponential of a matrix."""
    ready, k, omega = nh.examples.sleigh_in_a_well(), 0.3, 0.4
    matrix = np.array([[0.0, -k, 0.0], [1.0, 0.0, omega], [0.0, -omega, 0.0]])
    result = nh.flow(ready.system, body_velocity=ready.body_velocity, times=TIMES)
    for time, g, velocity in zip(TIMES, result.configuration, result.body_velocity, strict=True):
        u, s, w = scipy.linalg.expm(time * matrix) @ [0.7, 0.0, 0.0]
        assert np.abs(g[:2, :2].T @ g[:2, 2] - [s, w]).max() <= 1e-10
        assert np.abs(velocity - [omega, u, 0.0]).max() <= 1e-10


def _blade(q):  # noqa: ANN001, ANN202
    return jnp.array([[-jnp.sin(q[2]), jnp.cos(q[2]), 0.0]])


def _skate(**more) -> LagrangeDAlembert:  # noqa: ANN003
    return LagrangeDAlembert(lambda _q, v: (v[0] ** 2 + v[1] ** 2 + 0.3 * v[2] ** 2) / 2, _blade, dimension=3, **more)


def test_forces_act_beside_own_discrete_functions() -> None:
    """The midpoint rule written as functions of both ends has the driven motion of the rule itself."""

    def action(q, p, h):  # noqa: ANN001, ANN202
        return h * _skate().lagrangian((q + p) / 2, (p - q) / h)

    own = {"discrete_lagrangian": action, "discrete_constraints": lambda q, p, h: _blade((q + p) / 2) @ (p - q) / h}
    forces = nh.Friction([0.1, 0.2, 0.3]), np.random.default_rng(0).normal(size=(20, 3))
    start = {"configuration": (0.0, 0.0, 0.0), "body_velocity": (1.0, 0.0, 0.5), "steps": 20}
    both = (nh.simulate(nh.discretize(_skate(force=forces, **each), 0.1), **start) for each in ({}, own))
    assert_near(*both, 1e-13, "configuration", "momentum", "multipliers", "energy")


_RACER, _RUB = nh.examples.roller_racer(), nh.Friction([0.1, 0.1, 0.1])
_RACING = nh.discretize(_RACER.system, 0.1)


def _raced(q: object, v: object) -> object:
    return nh.simulate(_RACING, configuration=q, body_velocity=v, steps=1)


# Each with what is wanted: starts off the motion, functions of its own, indices, tables, forces twice.
test_what_a_driven_system_refuses = refusals(
    (lambda: _raced((0.0, 0.0, 0.0, 0.1), _RACER.body_velocity), "agree with prescribed motions"),
    (lambda: _raced(_RACER.configuration, (0.0, 0.0, 0.0, 0.0)), "nearest admissible"),
    (
        lambda: _skate(constraint_velocities=lambda _q, t: t[None], discrete_constraints=lambda q, p: (p - q)[:1]),
        "be left out where L or A has the time",
    ),
    (lambda: _skate(prescribed={3: jnp.sin}), "indices from 0 to 2"),
    (lambda: _skate(force=np.zeros((4, 2))), "force"),
    (lambda: nh.Forced(nh.Forced(_skate(), None, _RUB), None, _RUB), "have no force yet"),
    (lambda: nh.Forced(nh.examples.chaplygin_ball().system, None, nh.Slip([[1.0, 0.0]], 1.0)), "rows of 3 numbers"),
)
