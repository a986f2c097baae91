"""Cusps, multipliers, turns and axes of the discrete maps, against the maps themselves in 40 digits."""

from collections.abc import Iterator

import mpmath
import numpy as np
import pytest

import nonholo as nh

MASS, INERTIA, OFFSET, STEP = 1.3, 0.7, 0.4, 0.9
SLEIGH = nh.discretize(nh.ChaplyginSleigh(MASS, INERTIA, OFFSET), STEP)
TOP = nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), STEP)
SETTLED = mpmath.mpf(10) ** -16  # distance from the equilibria at which the rest of an orbit changes no digit

NEWTON = 10  # iterations, which double the digits


def _sleigh_orbit(r: tuple) -> Iterator[tuple]:
    """Yield (t, h pi, h p_1) of the sleigh forever, t = tan(D/2) by Newton's method on the cubic."""
    m, J, a = (mpmath.mpf(x) for x in (MASS, INERTIA, OFFSET))
    pi, p = r
    while True:
        hat = a * p + 2 * m * a * a
        t = pi / (2 * J + hat)
        for _ in range(NEWTON):
            t -= (((hat * t - pi) * t + 2 * J + hat) * t - pi) / ((3 * hat * t - 2 * pi) * t + 2 * J + hat)
        yield t, pi, p
        versine = 2 * t * t / (1 + t * t)
        pi, p = pi - 2 * a * t * (p + a * m * versine), p + 2 * a * m * versine


def _top_orbit(r: tuple) -> Iterator[tuple]:
    """Yield (y, h r/2) of the top forever, y by Newton's method on B y + s y_perp = (1 + |y|^2) m, s = c . y_perp."""
    B = mpmath.matrix([[mpmath.mpf(x) for x in row] for row in TOP.system.constrained_inertia.tolist()])
    c = [mpmath.mpf(x) for x in TOP.system.coupling.tolist()]
    m = mpmath.matrix(r)
    while True:
        y = mpmath.lu_solve(B, m)
        for _ in range(NEWTON):
            s, square = c[1] * y[0] - c[0] * y[1], 1 + y[0] ** 2 + y[1] ** 2
            turned = mpmath.matrix([-y[1], y[0]])
            slope = B + s * mpmath.matrix([[0, -1], [1, 0]]) + turned * mpmath.matrix([[c[1], -c[0]]]) - 2 * m * y.T
            y = y - mpmath.lu_solve(slope, B * y + s * turned - square * m)
        yield y, m
        s, square = c[1] * y[0] - c[0] * y[1], 1 + y[0] ** 2 + y[1] ** 2
        m = m - 2 * s / square * mpmath.matrix([-y[1], y[0]])


def test_turn_of_a_discrete_sleigh() -> None:
    """The sum of all step angles, from the repelling to the attracting end; T^-1(r) = -T(-r) leads back."""
    orbit = nh.simulate(SLEIGH, restricted_velocity=(0.5, 0.2), steps=2)
    with mpmath.workdps(40):
        start = [STEP * mpmath.mpf(x) for x in orbit.restricted_momentum[0].tolist()]
        total = mpmath.mpf(0)
        for sign in (1, -1):
            states = _sleigh_orbit((sign * start[0], sign * start[1]))
            t, pi, _ = next(states)  # backwards, from -r on, that of the step before, inverted
            while abs(pi) > SETTLED:
                total += sign * 2 * mpmath.atan(t)
                t, pi, _ = next(states)
        expected = float(total)
    assert abs(nh.asymptotics(orbit).heading_turn - expected) <= 1e-12


@pytest.mark.profile("problems", instead="test_turn_of_a_discrete_sleigh")
def test_axes_in_space_of_a_discrete_top() -> None:
    """The product of all rotations in 40 digits carries the limit axes to those that `asymptotics` finds."""
    orbit = nh.simulate(TOP, restricted_velocity=(0.5, 0.4), steps=2)
    found, ends = nh.asymptotics(orbit), []
    with mpmath.workdps(40):
        start = [STEP / 2 * mpmath.mpf(x) for x in orbit.restricted_momentum[0].tolist()]
        for sign in (1, -1):
            states = _top_orbit((sign * start[0], sign * start[1]))
            y, m = next(states)
            pose, before = mpmath.eye(3), 0 * m
            while mpmath.norm(m - before) > SETTLED:
                pose, before = pose * _rotation(y), m
                y, m = next(states)
            ends.append(np.array(pose.tolist(), dtype=float))
    assert np.abs(ends[0] @ found.axis_after - found.spatial_axis_after).max() <= 1e-12
    assert np.abs(ends[1] @ found.axis_before - found.spatial_axis_before).max() <= 1e-12


def _rotation(y: mpmath.matrix) -> mpmath.matrix:
    """Return the rotation about (-y2, y1, 0) by twice the arc tangent of |y|."""
    z0 = 1 / mpmath.sqrt(1 + y[0] ** 2 + y[1] ** 2)
    z = [z0 * y[0], z0 * y[1]]
    return mpmath.matrix(
        [
            [1 - 2 * z[0] * z[0], -2 * z[0] * z[1], 2 * z0 * z[0]],
            [-2 * z[0] * z[1], 1 - 2 * z[1] * z[1], 2 * z0 * z[1]],
            [-2 * z0 * z[0], -2 * z0 * z[1], 2 * z0 * z0 - 1],
        ]
    )
