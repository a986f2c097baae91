"""Closed forms at large times and in special cases, and the path of the blade against 50-digit functions."""

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given
from mpmath import mp, mpf
from problems import systems, velocities

import nonholo as nh
from nonholo.continuous._closed_form import blade_path
from nonholo.systems import AbstractLLSystem

TOP = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
SLEIGHS = [(1.0, 1.0, 0.5, 0.0), (0.9, 0.4, 0.7, 0.35), (1.5, 0.6, -0.5, 0.2), (1.0, 0.75, 0.5, 0.1), (1, 1, 0.02, 0)]


def _closed(system: object, times: object, **start: object) -> nh.Orbit:
    return nh.flow(system, times=times, method="closed_form", **start)


@pytest.mark.parametrize("parameters", SLEIGHS)
def test_path_becomes_a_straight_line(parameters: tuple) -> None:
    """At late and at early times the blade moves along its axis at the speed sqrt(2E/m), to rounding."""
    sleigh = nh.ChaplyginSleigh(*parameters)
    for sign in (1, -1):
        times = sign * np.array([0.0, 3000.0, 1e4, 1e6])
        orbit = _closed(sleigh, times, restricted_velocity=(-0.7, 0.4))
        speed = np.sign(sleigh.a * sign) * np.sqrt(2 * orbit.energy[0] / sleigh.mass)
        direction = np.array([np.cos(orbit.heading[-1]), np.sin(orbit.heading[-1])])
        moved = np.diff(orbit.position[1:], axis=0) - speed * np.diff(times[1:])[:, None] * direction
        assert np.abs(moved).max() <= 1e-15 * abs(times[-1] * speed) * (5 + np.ptp(orbit.heading))


def test_balanced_sleigh_moves_on_a_circle() -> None:
    """For a = 0 the contact point moves on the circle of radius |v1/omega| about a fixed center, whatever b is."""
    orbit = _closed(nh.ChaplyginSleigh(1.0, 1.0, 0.0, 0.7), np.linspace(0, 50, 101), restricted_velocity=(0.4, -1.0))
    facing = np.exp(1j * orbit.heading)
    center = orbit.position @ np.array([1.0, 1.0j]) + 1j * facing * (-1.0 / 0.4)
    assert np.abs(center - center[0]).max() <= 1e-13
    assert np.abs(orbit.heading - 0.4 * orbit.time).max() <= 1e-14


@pytest.mark.parametrize("omega", [1e-12, 1e-6, 0.1])
@pytest.mark.parametrize("a", [-1e-14, 1e-9, 1e-5])
def test_a_center_of_mass_next_to_the_blade(a: float, omega: float) -> None:
    """Short paths have all digits of the series, where antiderivatives of size 1/a and 1/omega are subtracted."""
    start = {"restricted_velocity": (omega, 1.0), "times": np.linspace(0.0, 4.0, 9)}
    sleigh = nh.ChaplyginSleigh(1.0, 0.5, a, 0.3)
    exact, solved = nh.flow(sleigh, method="closed_form", **start), nh.flow(sleigh, **start)
    assert np.abs(exact.position - solved.position).max() <= 4e-15


def test_nearly_balanced_sleigh_is_continuous() -> None:
    """As a tends to zero the closed form tends to the circle, uniformly down to the smallest number."""
    times = np.linspace(0.0, 10.0, 21)
    circle = _closed(nh.ChaplyginSleigh(1.0, 1.0, 0.0), times, restricted_velocity=(1.0, 0.5)).configuration
    for a in (1e-14, -1e-20, 1e-100, 1e-160, 5e-324):
        near = _closed(nh.ChaplyginSleigh(1.0, 1.0, a), times, restricted_velocity=(1.0, 0.5)).configuration
        assert np.abs(near - circle).max() <= 1e-12


@pytest.mark.parametrize("omega", [0.0, 1e-310])
def test_straight_motion(omega: float) -> None:
    """Without rotation, or with less than can grow within the range of numbers, the sleigh moves straight."""
    orbit = _closed(nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.3), [0.0, 7.0], restricted_velocity=(omega, -2.0))
    assert np.abs(orbit.position[-1] - [-14.0, 0.0]).max() <= 1e-14


def test_slow_start_leaves_on_time() -> None:
    """From omega = 1e-200 beside the repelling line omega grows exponentially, until it is no longer small."""
    sleigh, rate = nh.ChaplyginSleigh(1.0, 0.75, 0.5), 0.5
    times = np.linspace(0.0, 800.0, 9)
    orbit = _closed(sleigh, times, restricted_velocity=(1e-200, -1.0))
    assert np.abs(np.log(orbit.body_velocity[:, 0]) - np.log(1e-200) - rate * times).max() <= 1e-10


@pytest.mark.parametrize("sign", [1, -1])
def test_top_ends_on_the_attracting_half_line(sign: int) -> None:
    """A top goes from sqrt(h) c/sqrt(q_c) to its negative, and stays there when cosh overflows."""
    start = np.array([0.3, 0.8])
    orbit = _closed(TOP, [0.0, sign * 300.0, sign * 1e5], restricted_velocity=start)
    c, B = TOP.coupling, TOP.constrained_inertia
    limit = -sign * np.sqrt(start @ B @ start / (c @ B @ c)) * c @ TOP.constraint_subspace
    assert np.abs(orbit.body_velocity[1:] - limit).max() <= 1e-14


@pytest.mark.parametrize("along", [0.7, -0.7])
def test_top_at_its_poles_does_not_move(along: float) -> None:
    """Started exactly on a permanent rotation, the repelling one too, the momentum is constant forever."""
    top = nh.SuslovTop([[1.1, 0.0, 0.45], [0.0, 0.7, 0.0], [0.45, 0.0, 0.9]])
    orbit = _closed(top, [0.0, 50.0, 100.0], restricted_velocity=(along, 0.0))
    assert np.ptp(orbit.momentum, axis=0).max() == 0


@pytest.mark.parametrize("coupling", [0.0, 5e-324, 1e-300])
def test_balanced_top_keeps_its_velocity(coupling: float) -> None:
    """For c = 0 the body velocity is constant and the pose an exponential, to rounding also for negligible c."""
    top = nh.SuslovTop([[1.0, 0.0, coupling], [0.0, 2.0, coupling], [coupling, coupling, 3.0]])
    orbit = _closed(top, [0.0, 2.0], restricted_velocity=(0.5, -0.2))
    assert np.abs(orbit.configuration[-1] - top.group.exp(2 * orbit.body_velocity[0])).max() <= 1e-9


@given(systems, velocities)
def test_closed_form_of_random_systems(system: AbstractLLSystem, velocity: np.ndarray) -> None:
    """Closed form and numerical flow agree to 1e-8, backwards too, unless a sleigh turns too slowly for the latter."""
    assume(abs(velocity[0]) > 1e-2 or not system.has_blade)
    for end in (2.0, -2.0):
        start = {"restricted_velocity": velocity, "times": np.linspace(0.0, end, 5)}
        numerical = nh.flow(system, **start, rtol=1e-12, atol=1e-14)
        closed = nh.flow(system, **start, method="closed_form")
        assert np.abs(numerical.configuration - closed.configuration).max() <= 1e-8
        assert np.abs(numerical.body_velocity - closed.body_velocity).max() <= 1e-8
        if system.has_blade:
            assert np.abs(numerical.heading - closed.heading).max() <= 1e-8


RATIOS = [1.0001, 2.0, 2.6, 7.3, 200.0]
STARTS = [0.0, 0.3, -0.92, 5.0, -20.0, 150.0]
ELAPSED = [1e-6, 0.1, -0.5, 1.5, -4.0, 60.0, -200.0]


def _gudermannian(s: mpf) -> mpf:
    return 2 * mp.atan(mp.tanh(s / 2))


def _antiderivative(ratio: mpf, s: mpf) -> mpmath.mpc:
    phi, b = _gudermannian(s), ratio / 2
    euler = mp.hyp2f1(1, 1, 1 + b, (1 + mp.j * mp.sinh(s)) / 2) * mp.exp(-mp.j * phi) / (2 * mp.cos(phi))
    return mp.exp(mp.j * ratio * phi) * (2 * euler - 1) / ratio


def _reference(ratio: float, start: float, elapsed: float) -> tuple[mpf, mpmath.mpc]:
    with mp.workdps(int(80 + ratio / 3 + abs(start) + abs(elapsed))):
        L, first, last = mpf(ratio), mpf(start), mpf(start) + mpf(elapsed)
        phi = _gudermannian(first)
        moved = _antiderivative(L, last) - _antiderivative(L, first)
        return _gudermannian(last) - phi, mp.exp(-mp.j * L * phi) * moved


@pytest.mark.profile("problems", keep=["2.0--3.0-7.0"])
@pytest.mark.parametrize(("ratio", "start", "elapsed"), [(1.3, -0.7, 2.0), (2.0, -3.0, 7.0), (20.0, -2.0, 4.5)])
def test_antiderivative_by_quadrature(ratio: float, start: float, elapsed: float) -> None:
    """The hypergeometric reference of this file is the integral, to 40 digits of a Gauss-Legendre quadrature."""
    with mp.workdps(50):
        phi = _gudermannian(mpf(start))

        def integrand(s: mpf) -> mpmath.mpc:
            return mp.tanh(s) * mp.exp(mp.j * mpf(ratio) * (_gudermannian(s) - phi))

        result = mp.quad(integrand, mp.linspace(mpf(start), mpf(start) + mpf(elapsed), 40))
        assert abs(result - _reference(ratio, start, elapsed)[1]) <= mpf(10) ** -40


@pytest.mark.profile("problems", keep=["-20.0-2.6"])
@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("start", STARTS)
def test_blade_path(ratio: float, start: float) -> None:
    """Angles and paths are right to the last digits.

    Rounding exp(start) costs |start| eps of the angle. Turning by L times an angle of order one, each rounded, rotates
    the path by L eps: hence the factor 1 + L. Short paths are differences of numbers of order one.
    """
    angles, paths = blade_path(ratio, start, np.array(ELAPSED))
    for elapsed, angle, path in zip(ELAPSED, angles, paths, strict=True):
        expected_angle, expected_path = _reference(ratio, start, elapsed)
        assert abs(angle - expected_angle) <= 1e-15 * (1 + abs(start)) * abs(expected_angle)
        assert abs(mpmath.mpmathify(complex(path)) - expected_path) <= 4e-15 * (1 + ratio) * max(1.0, abs(elapsed))


def test_uniform_in_the_ratio() -> None:
    """At the border of its two regions both expansions agree to 1e-14, up to ratios of 1e12."""
    for ratio in np.geomspace(1.0001, 1e12, 60):
        border = np.log(max(2.5, ratio))
        _, paths = blade_path(ratio, border, border * np.array([-1e-9, 1e-9]))
        assert np.abs(paths - border * np.array([-1e-9, 1e-9]) * np.tanh(border)).max() <= 1e-14 * max(1.0, border)
