"""The map is not that of a smooth flow: its conjugacy invariant, against 50 digits and under changes of the orbit."""

from typing import Any

import mpmath
import numpy as np
import pytest

import nonholo as nh
from nonholo.analysis._asymptotics import _phases

CASES = {"heavy": (0.2, 1.0, 2.25), "light": (1.0, 0.3, (1.9 * 0.3) ** 2)}  # J, m a^2, level g at m = h = 1


def _sleigh(J: float, M: float, g: float) -> tuple[nh.Discretization, float]:
    return nh.discretize(nh.ChaplyginSleigh(1.0, J, np.sqrt(M)), 1.0), g / (2 * M)


def _following(J: Any, a: Any, r: tuple) -> tuple:
    """Return the momenta (pi, p_1) after a step, m = h = 1, by Newton's method on the cubic."""
    pi, p = r
    hat, t = a * p + 2 * a * a, pi / (2 * J + a * p + 2 * a * a)
    for _ in range(100):
        move = (((hat * t - pi) * t + 2 * J + hat) * t - pi) / ((3 * hat * t - 2 * pi) * t + 2 * J + hat)
        t -= move
        if abs(move) < mpmath.mpf(10) ** -mpmath.mp.dps * abs(t) * 100:
            break
    versine = 2 * t * t / (1 + t * t)
    return pi - 2 * a * t * (p + a * versine), p + 2 * a * versine


def _difference(inertia: float, moment: float, r: Any) -> Any:
    """Return s_+ - s_- from the logarithms of far momenta, backwards through T^-1(r) = -T(-r)."""
    J, a = mpmath.mpf(inertia), mpmath.sqrt(mpmath.mpf(moment))
    now = tuple(map(mpmath.mpf, r))
    whole = J + a * a
    speed = mpmath.sqrt(now[0] ** 2 / whole + now[1] ** 2)
    rate = mpmath.log((2 * whole - a * speed) / (2 * whole + a * speed))
    ends = []
    for sign in (1, -1):
        ahead, steps = (sign * now[0], sign * now[1]), 0
        while abs(ahead[0]) > mpmath.mpf(10) ** -25:  # what is left out is of the order of the square
            ahead, steps = _following(J, a, ahead), steps + 1
        ends.append(mpmath.log(abs(ahead[0])) / rate - steps)
    return ends[0] + ends[1]


@pytest.mark.parametrize("name", CASES)
def test_difference_against_fifty_digits(name: str) -> None:
    """s_+ - s_- of two orbits of the sleigh, to 1e-12; they differ by more than a tenth of the amplitude."""
    J, M, g = CASES[name]
    discrete, energy = _sleigh(J, M, g)
    mu = nh.flow_obstruction(discrete, energy, samples=2).multiplier
    found, exact = [], []
    with mpmath.workdps(50):
        for angle in (0.1, 0.4):
            r = np.sqrt(2 * energy) * np.array([np.sqrt(J + M) * np.cos(angle), np.sin(angle)])
            before, after = _phases(discrete, mu, r)
            found.append(after - before)
            exact.append(float(_difference(J, M, r)))
    assert np.abs(np.subtract(found, exact)).max() <= 1e-12
    assert abs(found[0] - found[1]) > 0.1 * nh.flow_obstruction(discrete, energy).amplitude


@pytest.mark.parametrize(("name", "amplitude"), [("heavy", 4.46e-3), ("light", 2.70e-4)])
def test_the_map_of_the_sleigh_is_not_that_of_a_flow(name: str, amplitude: float) -> None:
    """False in the paper's conclusions: explicit solutions. The difference would be constant for a smooth flow."""
    discrete, energy = _sleigh(*CASES[name])
    assert energy < nh.single_valued_region(discrete).energy
    assert nh.flow_obstruction(discrete, energy, samples=64).amplitude == pytest.approx(amplitude, rel=5e-3)


def test_the_map_of_the_top_is_not_that_of_a_flow() -> None:
    """Nor is that of a regular top, below its saddle."""
    discrete = nh.discretize(nh.SuslovTop([[1.0, 0.0, 0.6], [0.0, 0.5, 0.0], [0.6, 0.0, 0.6]]), 1.0)
    found = nh.critical_energies(discrete)
    assert found.regular
    assert found.saddle is not None
    assert nh.flow_obstruction(discrete, 0.95 * found.saddle).amplitude > 2e-3


def test_it_is_beyond_all_orders() -> None:
    """With the time step the amplitude falls as its 28th and then its 34th power; at h = 0.4 rounding is left."""
    steps, amplitudes = [1.0, 0.8, 0.6, 0.4], []
    for h in steps:
        discrete = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, np.sqrt(0.3)), h)
        amplitudes.append(nh.flow_obstruction(discrete, CASES["light"][2] / 0.6).amplitude)
    slopes = np.diff(np.log(amplitudes)) / np.diff(np.log(steps))
    assert slopes[0] > 25
    assert slopes[1] > slopes[0] + 5
    assert amplitudes[-1] <= 1e-12


def _spread(h: float) -> Any:
    """Return how far s_+ - s_- varies over eight starts within a step of the light sleigh, time step h; 60 digits."""
    J, M, g = CASES["light"]
    speed, inertia = mpmath.sqrt(g / mpmath.mpf(M)) * h, mpmath.mpf(J) + mpmath.mpf(M)
    a = mpmath.sqrt(mpmath.mpf(M))

    def along(t: mpmath.mpf) -> tuple:
        return mpmath.sqrt(inertia) * speed * mpmath.sech(t), speed * mpmath.tanh(t)

    first = mpmath.mpf("0.1")
    pi, p = _following(mpmath.mpf(J), a, along(first))
    period = mpmath.asinh(p * mpmath.sqrt(inertia) / pi) - first
    found = [_difference(J, M, along(first + period * k / 8)) for k in range(8)]
    return max(found) - min(found)


@pytest.mark.profile("problems", instead="test_difference_against_fifty_digits")
@pytest.mark.parametrize(("h", "shorter"), [(0.6, 0.5), (0.5, 0.4), (0.4, 0.3)])
def test_it_falls_as_an_exponential_of_the_inverse_step(h: float, shorter: float) -> None:
    """Its logarithm falls as -pi^2/(nu h), up to five parts in a hundred that become less with h."""
    rate = np.sqrt(CASES["light"][2]) / 1.3  # nu = M u/(a I) with a u = sqrt(g), m = 1
    with mpmath.workdps(60):
        fall = float(mpmath.log(_spread(h) / _spread(shorter)))
    ratio = fall / (np.pi**2 / rate * (1 / shorter - 1 / h))
    assert 1 < ratio < 1 + 0.13 * h * h


@pytest.mark.parametrize("angle", [-0.9, 0.2, 1.1])
def test_time_that_a_step_takes(angle: float) -> None:
    """A step takes h (1 + (h^2/12)(nu^2 + 3 (J/I) omega^2)) of the flow's time, to six digits of the second term."""
    with mpmath.workdps(40):
        J, a, h = mpmath.mpf(1), mpmath.sqrt(mpmath.mpf("0.3")), mpmath.mpf("1e-3")
        inertia, speed = J + a * a, mpmath.mpf("1.1")
        rate = a * speed / inertia
        before = mpmath.sqrt(inertia) * speed * mpmath.cos(angle), speed * mpmath.sin(angle)
        after = tuple(x / h for x in _following(J, a, (h * before[0], h * before[1])))
        first, last = (mpmath.asinh(mpmath.sqrt(inertia) * p / pi) / rate for pi, p in (before, after))
        turning = (before[0] + after[0]) / 2 / inertia
        expected = (rate**2 + 3 * J / inertia * turning**2) / 12
        assert abs((last - first - h) / h**3 / expected - 1) <= 1e-6


@pytest.mark.parametrize("name", CASES)
def test_it_is_a_function_of_the_phase(name: str) -> None:
    """One step on, both coordinates have grown by 1; the difference is the same."""
    discrete, energy = _sleigh(*CASES[name])
    orbit = nh.heteroclinic(discrete, energy=energy, side=-1).orbit
    now = int(np.flatnonzero(orbit.time == 0)[0])
    mu = nh.flow_obstruction(discrete, energy, samples=2).multiplier
    here, later = (np.array(_phases(discrete, mu, orbit.restricted_momentum[now + k])) for k in (0, 3))
    assert np.abs(later - here - 3).max() <= 1e-11


def test_both_sides_of_the_sleigh_are_mirror_images() -> None:
    """The offset b and the sign of omega do not matter: only m, J, a, h and the energy do."""
    plain = nh.flow_obstruction(nh.discretize(nh.ChaplyginSleigh(1.0, 0.2, 1.0), 1.0), 1.125)
    for sleigh in (nh.ChaplyginSleigh(1.0, 0.2, 1.0, 0.7), nh.ChaplyginSleigh(1.0, 0.2, -1.0)):
        other = nh.flow_obstruction(nh.discretize(sleigh, 1.0), 1.125)
        assert np.abs(other.difference - plain.difference).max() <= 1e-12
        assert np.abs(other.phase - plain.phase).max() <= 1e-12


def test_levels_without_it_are_refused() -> None:
    """Balanced bodies, orbits that change sides and other systems are refused."""
    with pytest.raises(ValueError, match="have attracting equilibria"):
        nh.flow_obstruction(nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.0), 0.1), 1.0)
    with pytest.raises(ValueError, match="keep orbits on their side"):
        nh.flow_obstruction(nh.discretize(nh.ChaplyginSleigh(1.0, 0.1, 0.4), 1.0), 2.0)
    with pytest.raises(ValueError, match="top with n = 3 or of a sleigh"):
        nh.flow_obstruction(nh.discretize(nh.SuslovTop(np.eye(4)), 0.1), 1.0)
