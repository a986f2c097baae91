"""The deltoid by the roots of the cubic; cusps, multipliers, turns and axes of the maps in 40 digits."""

import mpmath
import numpy as np
import pytest
from analysis.equations import cubic, sleigh_step, top_step
from refusals import refusals

import nonholo as nh
from nonholo.analysis import deltoid
from nonholo.analysis.planar import planar_variety

SLEIGHS = {
    "sleigh": nh.ChaplyginSleigh(1.3, 0.7, 0.5, 0.3),
    "backward": nh.ChaplyginSleigh(1.3, 0.7, -0.4, 0.2),
    "heavy": nh.ChaplyginSleigh(6.0, 1.0, 0.7),
}
each = pytest.mark.parametrize("sleigh", SLEIGHS.values(), ids=SLEIGHS)


@each
def test_counts_are_those_of_the_cubic(sleigh: nh.ChaplyginSleigh) -> None:
    """At 2000 random momenta about the deltoid the count is the number of real roots; both counts occur often."""
    result = deltoid(nh.discretize(sleigh, 0.4))
    low, high = result.cusps.min(axis=0), result.cusps.max(axis=0)
    momenta = np.random.default_rng(0).uniform(low - (high - low) / 5, high + (high - low) / 5, size=(2000, 2))
    counts = result.real_branches(momenta)
    roots = [np.roots(cubic(sleigh, 0.4, r)) for r in momenta]
    assert np.array_equal(counts, [np.count_nonzero(abs(t.imag) < 1e-9) for t in roots])
    assert np.mean(counts == 3) > 0.1
    assert np.mean(counts == 1) > 0.1


@each
def test_two_roots_meet_on_the_boundary(sleigh: nh.ChaplyginSleigh) -> None:
    """The discriminant of the cubic vanishes on the boundary, relative to its terms."""
    result = deltoid(nh.discretize(sleigh, 0.4))
    for r in result.boundary(50):
        a, b, c, d = cubic(sleigh, 0.4, r)
        terms = np.array([18 * a * b * c * d, -4 * b**3 * d, b * b * c * c, -4 * a * c**3, -27 * a * a * d * d])
        assert abs(terms.sum()) <= 1e-12 * max(1.0, np.abs(terms).max())


@each
def test_cusps(sleigh: nh.ChaplyginSleigh) -> None:
    """In (h pi, phat) they are (0, -2J) and (+-3 sqrt(3) J/4, J/4); the boundary has them at its thirds."""
    result = deltoid(nh.discretize(sleigh, 0.4))
    J, shift = sleigh.inertia, 2 * sleigh.mass * sleigh.a**2
    planes = [(0.0, -2 * J), (3 * np.sqrt(3) / 4 * J, J / 4), (-3 * np.sqrt(3) / 4 * J, J / 4)]
    for cusp, (pi, phat) in zip(result.cusps, planes, strict=True):
        p_1 = (phat - shift) / sleigh.a / 0.4
        assert np.allclose(cusp, [pi / 0.4 - sleigh.b * p_1, p_1], rtol=1e-13, atol=1e-13)
    assert np.allclose(result.boundary(4)[[0, 1, 2]], result.cusps, atol=1e-12)


@each
def test_discriminant_is_the_product_of_differences(sleigh: nh.ChaplyginSleigh) -> None:
    """For roots U = exp(i Delta) of the cubic in U it is the product of |U_j - U_k|^2, where all are real angles."""
    result = deltoid(nh.discretize(sleigh, 0.4))
    inside = 0.4 * result.cusps[0] + 0.35 * result.cusps[1] + 0.25 * result.cusps[2]
    t = np.roots(cubic(sleigh, 0.4, inside)).real
    U = (1 + 1j * t) ** 2 / (1 + t * t)
    product = np.prod([abs(U[j] - U[k]) ** 2 for j, k in ((0, 1), (0, 2), (1, 2))])
    assert np.isclose(result.discriminant(inside), product, rtol=1e-9)


@each
def test_resting_ellipse_has_no_translation(sleigh: nh.ChaplyginSleigh) -> None:
    """It is the momentum of turns about the foot of the center of mass, by the definition; V_1 = 0 there if b = 0."""
    discrete = nh.discretize(sleigh, 0.4)
    angle = np.linspace(0.0, 2 * np.pi, 13)
    W = planar_variety(discrete.system).displacement(np.stack([angle, 0 * angle], axis=1))
    expected = sleigh.restrict(nh.discrete_legendre(discrete, W))
    assert np.allclose(deltoid(discrete).resting(13), expected, atol=1e-13)


# Tops and balanced sleighs.
test_refuses_other_systems = refusals(
    (nh.SuslovTop(np.diag([1.0, 2.0, 3.0])), r"`deltoid\(discrete=...\)` must be of a sleigh in the plane"),
    (nh.ChaplyginSleigh(1.0, 1.0, 0.0), r"must have a != 0. .*two real branches"),
    ask=lambda system: deltoid(nh.discretize(system, 0.1)),
)


MASS, INERTIA, OFFSET, STEP = 1.3, 0.7, 0.4, 0.9
SLEIGH = nh.discretize(nh.ChaplyginSleigh(MASS, INERTIA, OFFSET), STEP)
TOP = nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), STEP)
SETTLED = mpmath.mpf(10) ** -16  # distance from the equilibria at which the rest of an orbit changes no digit


def test_turn_of_a_discrete_sleigh() -> None:
    """The sum of all step angles, from the repelling to the attracting end; T^-1(r) = -T(-r) leads back."""
    orbit = nh.simulate(SLEIGH, restricted_velocity=(0.5, 0.2), steps=2)
    with mpmath.workdps(40):
        start = [STEP * mpmath.mpf(x) for x in orbit.restricted_momentum[0].tolist()]
        total = mpmath.mpf(0)
        for sign in (1, -1):
            r = sign * start[0], sign * start[1]  # backwards, from -r on, steps are those before, inverted
            while abs(r[0]) > SETTLED:
                t, r = sleigh_step(*map(mpmath.mpf, (MASS, INERTIA, OFFSET)), r)
                total += sign * 2 * mpmath.atan(t)
        expected = float(total)
    assert abs(nh.asymptotics(orbit).heading_turn - expected) <= 1e-12


@pytest.mark.profile("problems", instead="test_turn_of_a_discrete_sleigh")
def test_axes_in_space_of_a_discrete_top() -> None:
    """The product of all rotations in 40 digits carries the limit axes to those that `asymptotics` finds."""
    orbit = nh.simulate(TOP, restricted_velocity=(0.5, 0.4), steps=2)
    result, ends = nh.asymptotics(orbit), []
    with mpmath.workdps(40):
        B, c = mpmath.matrix(TOP.system.constrained_inertia.tolist()), TOP.system.coupling.tolist()
        for sign in (1, -1):
            m = sign * STEP / 2 * mpmath.matrix(orbit.restricted_momentum[0].tolist())
            pose, before = mpmath.eye(3), 0 * m
            while mpmath.norm(m - before) > SETTLED:
                before = m
                y, m = top_step(B, c, m)
                half = mpmath.matrix([[0, 0, y[0]], [0, 0, y[1]], [-y[0], -y[1], 0]])
                pose = pose * (mpmath.eye(3) + half) * (mpmath.eye(3) - half) ** -1
            ends.append(np.array(pose.tolist(), dtype=float))
    assert np.abs(ends[0] @ result.axis_after - result.spatial_axis_after).max() <= 1e-12
    assert np.abs(ends[1] @ result.axis_before - result.spatial_axis_before).max() <= 1e-12
