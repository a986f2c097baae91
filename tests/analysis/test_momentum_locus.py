"""Momentum loci: the equation, the double lines, the triple point and the pinch points against the definition."""

import numpy as np
import pytest
from bodies import mass_tensor
from refusals import refusals

import nonholo as nh
from nonholo.analysis.planar import momenta_at, planar_variety

TOPS = {
    "generic": nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]),
    "balanced": nh.SuslovTop(np.diag([1.0, 2.0, 3.0])),
    "other axis": nh.SuslovTop.from_inertia(np.diag([3.0, 2.0, 1.5]), axis=np.array([2.0, 1.0, 2.0]) / 3),
    "aligned": nh.SuslovTop([[1.0, 0.0, 0.5], [0.0, 1.0, 0.0], [0.5, 0.0, 1.0]]),
}
SLEIGHS = {
    "sleigh": nh.ChaplyginSleigh(1.3, 0.7, 0.5, 0.3),
    "backward": nh.ChaplyginSleigh(1.3, 0.7, -0.4, 0.2),
    "balanced sleigh": nh.ChaplyginSleigh(1.3, 0.7, 0.0, 0.3),
}
SYSTEMS = {name: nh.discretize(system, 0.3) for name, system in (TOPS | SLEIGHS).items()}
FLAT = nh.discretize(nh.SuslovTop(np.diag([1.0, 1.0, 3.0])), 0.3)


def random_points(discrete: nh.Discretization, count: int) -> np.ndarray:
    """Return points all over the variety: unit vectors, or angles and translations."""
    rng = np.random.default_rng(0)
    if isinstance(discrete.system, nh.SuslovTop):
        z = rng.normal(size=(count, 3))
        return z / np.linalg.norm(z, axis=1, keepdims=True)
    return np.stack([rng.uniform(-np.pi, np.pi, count), rng.normal(size=count)], axis=1)


def along(segments: np.ndarray, parts: np.ndarray) -> np.ndarray:
    """Return points of segments at these parts of their length."""
    return segments[:, None, 0] + parts[:, None] * (segments[:, None, 1] - segments[:, None, 0])


@pytest.mark.parametrize("discrete", [*SYSTEMS.values(), FLAT], ids=[*SYSTEMS, "flat"])
def test_equation_holds_on_the_locus(discrete: nh.Discretization) -> None:
    """At 1e4 momenta of random displacements the polynomial is 1e-12 of its size in the box around them."""
    p = nh.discrete_legendre(discrete, planar_variety(discrete.system).displacement(random_points(discrete, 10_000)))
    implicit = nh.momentum_locus(discrete, 3).implicit
    box = p[np.random.default_rng(1).permuted(np.tile(np.arange(10_000)[:, None], 3), axis=0), np.arange(3)]
    size = 1.0 if discrete is FLAT else np.abs(implicit(box)).max()
    assert np.abs(implicit(p)).max() <= 1e-12 * size


@pytest.mark.parametrize("discrete", SYSTEMS.values(), ids=SYSTEMS)
def test_equation_fails_beside_the_locus(discrete: nh.Discretization) -> None:
    """A momentum moved off the surface along its normal by 1e-3 of its size has a value far above rounding."""
    rng, implicit = np.random.default_rng(2), nh.momentum_locus(discrete, 3).implicit
    p = momenta_at(discrete, planar_variety(discrete.system), random_points(discrete, 200))
    moved = p + 1e-3 * np.abs(p).max() * rng.choice([-1, 1], size=p.shape)
    assert np.median(np.abs(implicit(moved))) > 1e6 * np.abs(implicit(p)).max()


@pytest.mark.profile("problems", keep=["?"])
@pytest.mark.parametrize("seed", range(20))
def test_any_body_has_three_double_segments(seed: int) -> None:
    """Random bodies: value and gradient of the quartic vanish on three lines, whiskers included."""
    discrete = nh.discretize(nh.SuslovTop(mass_tensor(nh.SO(3), np.random.default_rng(seed))), 0.3)
    locus = nh.momentum_locus(discrete, 20)
    size = np.abs(locus.momentum).max()
    assert locus.double_lines.shape == (3, 2, 3)
    for p in along(locus.double_lines, np.linspace(-1, 2, 7)).reshape(-1, 3) + 0.0:
        gradient = [locus.implicit(p + e) - locus.implicit(p - e) for e in 1e-5 * size * np.eye(3)]
        assert np.abs(gradient).max() < 1e-10  # second order in the step of 1e-5; at other places it is 1e-6
    assert np.allclose(locus.implicit(locus.triple_point), 0.0, atol=1e-14)


@pytest.mark.profile("problems", keep=["generic", "other axis"])
@pytest.mark.parametrize("name", TOPS)
def test_two_displacements_over_double_points(name: str) -> None:
    """The surface near an inner point of a segment consists of two sheets: displacements there are of two kinds."""
    discrete = SYSTEMS[name]
    locus = nh.momentum_locus(discrete, 300)
    size = np.ptp(locus.momentum.reshape(-1, 3), axis=0).max()
    for segment in locus.double_lines:
        target = segment[0] + 0.23 * (segment[1] - segment[0])
        near = np.linalg.norm(locus.momentum - target, axis=-1) < 0.03 * size
        z = locus.points[near]
        assert np.abs(z @ z.T).min() < 0.9  # not all close to one line through the origin


@pytest.mark.parametrize("discrete", SYSTEMS.values(), ids=SYSTEMS)
def test_segments_are_on_the_locus_and_whiskers_are_not(discrete: nh.Discretization) -> None:
    """Mesh points come close to all points of the segments, but not to points well out on the whiskers."""
    locus = nh.momentum_locus(discrete, 150)
    mesh = locus.momentum.reshape(-1, 3)
    for segment in locus.double_lines:
        length = np.linalg.norm(segment[1] - segment[0])
        inside = along(segment[None], np.array([0.02, 0.3, 0.6, 0.98]))[0]
        assert max(np.linalg.norm(mesh - p, axis=1).min() for p in inside) < 0.05 * length
    for whisker in locus.whiskers(0.5):
        length = np.linalg.norm(whisker[1] - whisker[0])
        assert np.linalg.norm(mesh - whisker[1], axis=1).min() > 0.1 * length


def test_triple_point_has_three_displacements() -> None:
    """Eigenvectors v of J diag(1, 1, -1), real for any body, give z = (v_3, v_1, v_2) over the triple point."""
    locus = nh.momentum_locus(SYSTEMS["generic"], 3)
    vectors = np.linalg.eig(TOPS["generic"].mass_tensor @ np.diag([1.0, 1.0, -1.0]))[1].T
    momenta = momenta_at(locus.discrete, planar_variety(locus.discrete.system), vectors[:, [2, 0, 1]])
    assert np.allclose(momenta, locus.triple_point, atol=1e-13)


def test_balanced_quartic_is_the_classical_one() -> None:
    """For J = diag the quartic is proportional to x^2 y^2 + y^2 z^2 + z^2 x^2 - x y z in the scaled components."""
    p = np.random.default_rng(3).normal(size=(50, 3)) * 5
    m13, m23, m12 = 0.15 * p[:, 1], -0.15 * p[:, 0], -0.15 * p[:, 2]
    x, y, z = m13 / 4, m23 / 5, m12 / -1  # z_0 z_1, z_0 z_2, z_1 z_2 with B = diag(4, 5)
    classical = (x * y) ** 2 + (y * z) ** 2 + (z * x) ** 2 - x * y * z
    ratio = nh.momentum_locus(SYSTEMS["balanced"], 3).implicit(p) / classical
    assert np.allclose(ratio, ratio[0], rtol=1e-9)


def test_flat_locus_has_a_linear_equation() -> None:
    """Balanced with two equal moments: the third component of every momentum is zero, and nothing is singular."""
    locus = nh.momentum_locus(FLAT, 10)
    assert locus.double_lines.shape == (0, 2, 3)
    assert locus.triple_point is None
    assert np.allclose(np.abs(locus.implicit(np.eye(3))), [0.0, 0.0, np.abs(locus.implicit([0.0, 0.0, 1.0]))])
    assert np.abs(locus.implicit([0.0, 0.0, 1.0])) > 0.01


def test_sleigh_pinch_points() -> None:
    """They are p_1 = -2am, p_2 = 0 and pi = +-J, in units of 1/h."""
    sleigh = SLEIGHS["sleigh"]
    p_1 = -2 * sleigh.a * sleigh.mass
    expected = np.array([[side * sleigh.inertia - sleigh.b * p_1, p_1, 0.0] for side in (-1, 1)]) / 0.3
    assert np.allclose(nh.momentum_locus(SYSTEMS["sleigh"], 3).pinch_points, expected, rtol=1e-13)


@pytest.mark.parametrize("discrete", SYSTEMS.values(), ids=SYSTEMS)
def test_points_and_displacements_are_inverse(discrete: nh.Discretization) -> None:
    """A displacement is found again from its point, at angle pi too."""
    points, is_top = random_points(discrete, 50), isinstance(discrete.system, nh.SuslovTop)
    points[0, 0] = 0.0 if is_top else np.pi
    points[0] /= np.linalg.norm(points[0]) if is_top else 1.0
    variety = planar_variety(discrete.system)
    W = variety.displacement(points)
    assert np.allclose(variety.displacement(variety.points(W)), W, atol=1e-14)


# Another system, another difference and a mesh of one row.
test_refuses_what_has_no_closed_form = refusals(
    (nh.discretize(nh.RigidBody(np.eye(3)), 0.1), r"locus\(discrete=...\)` must be of a top with n = 3 or of a sleigh"),
    (nh.discretize(TOPS["generic"], 0.1, "logarithmic"), r"must keep energy. Got difference='logarithmic'"),
    (SYSTEMS["generic"], 1, r"`momentum_locus\(resolution=...\)` must be at least 2"),
    ask=lambda *given: nh.momentum_locus(*given),
)
