"""The deltoid by the roots of the cubic; cusps, multipliers, turns and axes of the maps in 40 digits."""

from collections.abc import Iterator

import mpmath
import numpy as np
import pytest
from refusals import refusals

import nonholo as nh
from nonholo.analysis import deltoid
from nonholo.analysis.planar import planar_variety

SLEIGHS = {
    "sleigh": nh.ChaplyginSleigh(1.3, 0.7, 0.5, 0.3),
    "backward": nh.ChaplyginSleigh(1.3, 0.7, -0.4, 0.2),
    "heavy": nh.ChaplyginSleigh(6.0, 1.0, 0.7),
}


def cubic(sleigh: nh.ChaplyginSleigh, h: float, restricted: np.ndarray) -> np.ndarray:
    """Return the coefficients of the cubic in t = tan(Delta/2)."""
    pi, p_1 = h * (restricted[0] + sleigh.b * restricted[1]), h * restricted[1]
    phat = sleigh.a * p_1 + 2 * sleigh.mass * sleigh.a**2
    return np.array([phat, -pi, 2 * sleigh.inertia + phat, -pi])


@pytest.mark.parametrize("sleigh", SLEIGHS.values(), ids=SLEIGHS)
def test_counts_are_those_of_the_cubic(sleigh: nh.ChaplyginSleigh) -> None:
    """At 2000 random momenta about the deltoid the count is the number of real roots; both counts occur often."""
    found = deltoid(nh.discretize(sleigh, 0.4))
    low, high = found.cusps.min(axis=0), found.cusps.max(axis=0)
    momenta = np.random.default_rng(0).uniform(low - (high - low) / 5, high + (high - low) / 5, size=(2000, 2))
    counts = found.real_branches(momenta)
    roots = [np.roots(cubic(sleigh, 0.4, r)) for r in momenta]
    assert np.array_equal(counts, [np.count_nonzero(abs(t.imag) < 1e-9) for t in roots])
    assert np.mean(counts == 3) > 0.1
    assert np.mean(counts == 1) > 0.1


@pytest.mark.parametrize("sleigh", SLEIGHS.values(), ids=SLEIGHS)
def test_two_roots_meet_on_the_boundary(sleigh: nh.ChaplyginSleigh) -> None:
    """The discriminant of the cubic vanishes on the boundary, relative to its terms."""
    found = deltoid(nh.discretize(sleigh, 0.4))
    for r in found.boundary(50):
        a, b, c, d = cubic(sleigh, 0.4, r)
        terms = np.array([18 * a * b * c * d, -4 * b**3 * d, b * b * c * c, -4 * a * c**3, -27 * a * a * d * d])
        assert abs(terms.sum()) <= 1e-12 * max(1.0, np.abs(terms).max())


@pytest.mark.parametrize("sleigh", SLEIGHS.values(), ids=SLEIGHS)
def test_cusps(sleigh: nh.ChaplyginSleigh) -> None:
    """In (h pi, phat) they are (0, -2J) and (+-3 sqrt(3) J/4, J/4); the boundary has them at its thirds."""
    found = deltoid(nh.discretize(sleigh, 0.4))
    J, shift = sleigh.inertia, 2 * sleigh.mass * sleigh.a**2
    planes = [(0.0, -2 * J), (3 * np.sqrt(3) / 4 * J, J / 4), (-3 * np.sqrt(3) / 4 * J, J / 4)]
    for cusp, (pi, phat) in zip(found.cusps, planes, strict=True):
        p_1 = (phat - shift) / sleigh.a / 0.4
        assert np.allclose(cusp, [pi / 0.4 - sleigh.b * p_1, p_1], rtol=1e-13, atol=1e-13)
    assert np.allclose(found.boundary(4)[[0, 1, 2]], found.cusps, atol=1e-12)


@pytest.mark.parametrize("sleigh", SLEIGHS.values(), ids=SLEIGHS)
def test_discriminant_is_the_product_of_differences(sleigh: nh.ChaplyginSleigh) -> None:
    """For roots U = exp(i Delta) of the cubic in U it is the product of |U_j - U_k|^2, where all are real angles."""
    found = deltoid(nh.discretize(sleigh, 0.4))
    inside = 0.4 * found.cusps[0] + 0.35 * found.cusps[1] + 0.25 * found.cusps[2]
    t = np.roots(cubic(sleigh, 0.4, inside)).real
    U = (1 + 1j * t) ** 2 / (1 + t * t)
    product = np.prod([abs(U[j] - U[k]) ** 2 for j, k in ((0, 1), (0, 2), (1, 2))])
    assert np.isclose(found.discriminant(inside), product, rtol=1e-9)


@pytest.mark.parametrize("sleigh", SLEIGHS.values(), ids=SLEIGHS)
def test_resting_ellipse_has_no_translation(sleigh: nh.ChaplyginSleigh) -> None:
    """It is the momentum of turns about the foot of the center of mass, by the definition; V_1 = 0 there if b = 0."""
    discrete = nh.discretize(sleigh, 0.4)
    angle = np.linspace(0.0, 2 * np.pi, 13)
    W = planar_variety(discrete.system).displacement(np.stack([angle, 0 * angle], axis=1))
    expected = sleigh.restrict(nh.discrete_legendre(discrete, W))
    assert np.allclose(deltoid(discrete).resting(13), expected, atol=1e-13)


def test_steps_of_an_orbit_are_counted_once() -> None:
    """A slow orbit, whose momenta satisfy the sharp bound of the theory page, has one real value at every step."""
    sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
    orbit = nh.simulate(sleigh, body_velocity=(0.3, -1.0, 0.0), steps=50)
    assert np.all(deltoid(sleigh).real_branches(orbit.restricted_momentum) == 1)


# Tops and balanced sleighs.
test_refuses_other_systems = refusals(
    (nh.SuslovTop(np.diag([1.0, 2.0, 3.0])), r"`deltoid\(discrete=...\)` must be of a sleigh"),
    (nh.ChaplyginSleigh(1.0, 1.0, 0.0), r"must have a != 0. .*two real values"),
    ask=lambda system: deltoid(nh.discretize(system, 0.1)),
)


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
