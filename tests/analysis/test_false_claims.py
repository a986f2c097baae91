"""Counterexamples to claims of the paper, most of them on sleighs. Names: docs/errata.md, docs/paper.md."""

import numpy as np
import pytest

import nonholo as nh
from nonholo.analysis import deltoid

MASS, INERTIA, OFFSET = 1.3, 0.7, 0.5
SLEIGH = nh.discretize(nh.ChaplyginSleigh(MASS, INERTIA, OFFSET), 1.0)
GROUP = nh.SE(2)


def _restricted(pi: float, hat: float) -> np.ndarray:
    """Return (p_theta, p_1) of a point (pi, phat) of the plane of the deltoid."""
    return np.array([pi, (hat - 2 * MASS * OFFSET**2) / OFFSET])


def _pose(angle: float, x: float, y: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, x], [s, c, y], [0.0, 0.0, 1.0]])


def test_angular_momentum_is_about_the_body_origin() -> None:
    """C13: M is not about the center of mass, but about the contact point: sum of m r ^ v over mass points."""
    rng = np.random.default_rng(0)
    masses, points = rng.uniform(0.5, 1.0, size=6), rng.normal(size=(6, 3)) + 1.0
    center = masses @ points / masses.sum()
    about = np.einsum("k,ki,kj->ij", masses, points - center, points - center)
    system = nh.MultidimensionalSleigh(masses.sum(), center, about)
    velocity = rng.normal(size=3) @ system.constraint_subspace
    speeds = np.column_stack([points, np.ones(6)]) @ system.group.hat(velocity)[:3].T
    M = (system.inertia_operator @ velocity)[:3]
    origin, mass_center = (np.cross(points - p, masses[:, None] * speeds).sum(axis=0) for p in (0 * center, center))
    assert np.abs(M - origin).max() <= 1e-13
    assert np.abs(M - mass_center).max() > 0.1


@pytest.mark.parametrize("n", [2, 3, 4])
def test_the_quotient_covers_displacements_twice(n: int) -> None:
    """C20: (q, nu) and (-q, -nu) of SE(n)/SE(n-1) are one displacement; no other pair is."""
    rng, sigma = np.random.default_rng(n), np.diag([1.0] + [-1.0] * (n - 1))
    q = rng.normal(size=n)
    q, nu = q / np.linalg.norm(q), 0.7

    def displacement(q: np.ndarray, nu: float) -> np.ndarray:
        W = np.eye(n + 1)
        W[:n, :n], W[:n, n] = (2 * np.outer(q, q) - np.eye(n)) @ sigma, nu * q
        return W

    W = displacement(q, nu)
    assert np.array_equal(W, displacement(-q, -nu))
    body = (
        nh.ChaplyginSleigh(1.0, 1.0, 0.5)
        if n == 2
        else nh.MultidimensionalSleigh(1.0, np.arange(1.0, n + 1), np.diag(np.arange(1.0, n + 1)) + 0.1)
    )
    found = nh.branches(nh.discretize(body, 1.0), displacement=W)  # refuses what is not in exp d
    assert len(found.displacement) == 2 * n - 1
    values, vectors = np.linalg.eigh(W[:n, :n] @ sigma)  # 2 q q^T - 1: q is determined up to sign
    assert values == pytest.approx([-1.0] * (n - 1) + [1.0], abs=1e-14)
    assert abs(vectors[:, -1] @ q) == pytest.approx(1.0, abs=1e-14)


def test_the_equation_without_half_angles_is_not_equivalent() -> None:
    """C21: V_1 (1 - cos D) = V_2 sin D holds for a pure sideways shift, which is no displacement of a sleigh."""
    W = _pose(0.0, 0.3, 0.4)
    c, s, V1, V2 = W[0, 0], W[1, 0], W[0, 2], W[1, 2]
    assert V1 * (1 - c) == V2 * s
    assert V2 * np.cos(0.0) - V1 * np.sin(0.0) == 0.4
    with pytest.raises(ValueError, match="lie on the displacement variety"):
        nh.branches(SLEIGH, displacement=W)
    assert nh.branches(SLEIGH, displacement=_pose(0.0, 0.3, 0.0)).is_real.any()  # accepted


def test_three_displacements_and_a_cubic_surface() -> None:
    """three-preimages: generic momenta have three displacements. The fourth, a shift, is off the surface."""
    for r in np.random.default_rng(1).normal(size=(20, 2)):
        found = nh.displacements_over(SLEIGH, r)
        assert found.multiplicity.sum() == len(found.displacement) == 3
        p_theta, p1 = r
        shift = _pose(0.0, p1 / MASS, p_theta / (MASS * OFFSET))  # same p_theta, p_1
        P = nh.discrete_legendre(SLEIGH, shift)
        assert np.abs(SLEIGH.system.restrict(P) - r).max() <= 1e-14
        assert P[0] == pytest.approx(OFFSET * P[2], rel=1e-14)  # the plane that makes the cubic a quartic
        locus = nh.momentum_locus(SLEIGH, resolution=2)
        assert abs(locus.implicit(P)) > 1e-3
        assert np.abs(locus.implicit(found.momentum[found.is_real].real)).max() <= 1e-10


def test_the_cubic_for_the_sine_leaves_the_unit_strip() -> None:
    """surface: on phat = 0, |pi| > J, it has the real double root z = pi/J beyond 1, of two complex angles."""
    pi = 1.5 * INERTIA
    found = nh.displacements_over(SLEIGH, _restricted(pi, 0.0))
    sines = found.displacement[:, 1, 0]
    outside = np.abs(sines) > 1
    assert outside.sum() == 2
    assert not found.is_real[outside].any()
    assert np.abs(sines[outside] - 1.5).max() <= 1e-7  # a double root: the square root of rounding
    z = 1.5
    cubic = (INERTIA**2 * z**3, -2 * INERTIA * pi * z**2, pi**2 * z, 0.0)  # phat = 0
    assert sum(cubic) == pytest.approx(0.0, abs=1e-13)


@pytest.mark.parametrize(
    ("part", "at", "signs"),
    [
        ("lower", (0.0, -1.6), (1, 1, 1)),
        ("upper", (0.0, -0.5), (-1, -1, 1)),  # printed: +
        ("side", (0.55, -0.47), (-1, 1, 1)),  # printed: -
        ("side", (1.286, 0.2425), (-1, -1, -1)),
    ],
)
def test_the_sign_of_the_cosine_is_not_that_of_the_quadrant(part: str, at: tuple, signs: tuple) -> None:
    """C25: inside the deltoid the three branches over one momentum have different signs of cos D."""
    pi, hat = (INERTIA * x for x in at)
    found_in = "lower" if hat < -INERTIA - abs(pi) else "upper" if hat > abs(pi) - INERTIA else "side"
    assert found_in == part
    found = nh.displacements_over(SLEIGH, _restricted(pi, hat))
    assert found.is_real.all()
    assert sorted(np.sign(found.displacement[:, 0, 0].real)) == list(signs)


def test_the_half_turn_lies_over_a_whole_axis() -> None:
    """C25, C28: over every point of phat = 0 the step D = pi is a branch; it has V_1 = 0, off the printed ellipse."""
    for pi in (-2.0, -0.6, 0.5, 0.9, 3.0):
        found = nh.displacements_over(SLEIGH, _restricted(pi, 0.0))
        half = int(np.argmin(np.abs(found.displacement[:, 0, 0] + 1)))
        W = found.displacement[half]
        assert found.is_real[half]
        assert np.abs(W - _pose(np.pi, 0.0, pi / (MASS * OFFSET))).max() <= 1e-12
        assert np.hypot(*(deltoid(SLEIGH).resting(1000) - _restricted(pi, 0.0)).T).min() > 0.02


def test_the_sign_of_the_advance_is_not_that_of_the_ellipse() -> None:
    """C28: V_1 < 0 inside the ellipse and > 0 outside holds for the principal branch, not for all real ones."""
    whole, M = INERTIA + MASS * OFFSET**2, MASS * OFFSET**2
    corners, against = deltoid(SLEIGH).cusps, 0
    for weights in np.random.default_rng(2).dirichlet(np.ones(3), size=100):
        r = weights @ corners
        hat = OFFSET * r[1] + 2 * M
        inside = (r[0] / whole) ** 2 + (hat / M - 1) ** 2 < 1
        found = nh.displacements_over(SLEIGH, r)
        advance = found.displacement[found.is_real, 0, 2].real
        against += bool(np.any((advance < 0) != inside))
    assert against > 50


def test_images_of_images_grow_as_powers_of_three() -> None:
    """C37: a map with theta functions as solutions has few images; this one has 3, 9, 27, 81 distinct ones."""
    momenta, counts = np.array([[0.3, 0.2]], dtype=complex), []
    for _ in range(4):
        images = []
        for pi, p in momenta:
            hat = OFFSET * p + 2 * MASS * OFFSET**2
            for t in np.roots([hat, -pi, 2 * INERTIA + hat, -pi]):
                versine = 2 * t * t / (1 + t * t)
                images.append((pi - 2 * OFFSET * t * (p + OFFSET * MASS * versine), p + 2 * OFFSET * MASS * versine))
        momenta = np.array(images)
        apart = np.abs(momenta[:, None] - momenta).sum(axis=2) + 1e9 * np.eye(len(momenta))
        counts.append(int(np.sum(apart.min(axis=1) > 1e-6 * np.abs(momenta).max(axis=1))))
        energy = momenta[:, 0] ** 2 / (INERTIA + MASS * OFFSET**2) + momenta[:, 1] ** 2 / MASS
        assert np.abs(energy - energy[0]).max() <= 1e-8  # all on one level
    assert counts == [3, 9, 27, 81]


def test_a_balanced_sleigh_need_not_repeat_its_step() -> None:
    """C32: for a = 0 not all solutions are stationary: pi - D is a branch beside D, and beyond J there is none."""
    discrete = nh.discretize(nh.ChaplyginSleigh(MASS, INERTIA, 0.0), 1.0)
    found = nh.displacements_over(discrete, [0.6 * INERTIA, 0.4])
    angles = np.angle(found.displacement[:, 0, 0].real + 1j * found.displacement[:, 1, 0].real)
    assert found.is_real.tolist() == [True, True]
    assert np.sort(angles) == pytest.approx([np.arcsin(0.6), np.pi - np.arcsin(0.6)], abs=1e-13)
    assert not nh.displacements_over(discrete, [1.1 * INERTIA, 0.4]).is_real.any()


def test_the_half_plane_is_kept_beyond_the_single_valued_region() -> None:
    """half-plane: below E = 2 m a^2/h^2, more than E*, pi keeps its sign on every real branch, and above it not."""
    bound, rng = 2 * MASS * OFFSET**2, np.random.default_rng(3)
    kept = []
    for share in (0.99, 4.0):
        signs = []
        for r in rng.normal(size=(150, 2)):
            start = r * np.sqrt(share * bound / SLEIGH.system.constrained_energy(r))
            for W in (v.real for v, real in _values(start) if real):
                after = SLEIGH.system.restrict(nh.discrete_legendre(SLEIGH, W, side="right"))
                signs.append(np.sign(after[0]) == np.sign(start[0]))
        kept.append(all(signs))
    assert kept == [True, False]


def _values(r: np.ndarray) -> list[tuple[np.ndarray, bool]]:
    found = nh.displacements_over(SLEIGH, r)
    return list(zip(found.displacement, found.is_real, strict=True))


def test_the_outer_solution_need_not_be_unique() -> None:
    """S49: a regular body, below its saddle, whose step has one inner solution and three outer ones."""
    top = nh.SuslovTop([[1.25, 0, -0.5], [0, 1, -0.75], [-0.5, -0.75, 1.25]])
    discrete, c = nh.discretize(top, 1.0), np.array([-0.5, -0.75])
    found = nh.branches(discrete, displacement=top.group.cayley(c @ top.constraint_subspace))
    critical = nh.critical_energies(discrete)
    assert critical.regular
    assert found.energy < critical.saddle
    assert found.is_real.all()
    cosine = found.displacement[:, 2, 2].real
    u = found.displacement[:, :2, 2].real / np.sqrt(1 - cosine**2)[:, None]
    across = c[1] * u[:, 0] - c[0] * u[:, 1]
    kappa = 1 - across**2 / np.linalg.det(top.constrained_inertia)
    assert np.sum((1 - cosine) / 2 < 1 / (2 * kappa)) == 1
