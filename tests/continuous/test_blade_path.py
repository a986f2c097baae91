"""The integral of tanh(s) exp(i L gd(s)) against 50-digit hypergeometric functions and quadrature."""

import mpmath
import numpy as np
import pytest
from mpmath import mp, mpf

from nonholo.continuous._closed_form import blade_path

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

        found = mp.quad(integrand, mp.linspace(mpf(start), mpf(start) + mpf(elapsed), 40))
        assert abs(found - _reference(ratio, start, elapsed)[1]) <= mpf(10) ** -40


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
