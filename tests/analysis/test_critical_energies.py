"""Critical energies of the top against 40-digit critical points; the sharp bound of the single-valued sleigh."""

from typing import Any

import mpmath
import numpy as np
import pytest
import scipy
from analysis.equations import cubic, momenta_of_energy
from refusals import refusals

import nonholo as nh
from nonholo.analysis import CriticalEnergies, deltoid

BODIES = {
    "generic": [[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]],
    "four real branches": [[1.25, 0.0, -0.5], [0.0, 1.0, -0.75], [-0.5, -0.75, 1.25]],
    "third minimum": [[3.0, 0.02, 0.1], [0.02, 0.1, 0.01], [0.1, 0.01, 0.2]],
    "aligned, center": [[3.0, 0.0, 0.4], [0.0, 1.5, 0.0], [0.4, 0.0, 0.8]],
    "aligned, saddle": [[0.5, 0.0, 0.3], [0.0, 2.5, 0.0], [0.3, 0.0, 0.8]],
    "balanced": [[1.0, 0.1, 0.0], [0.1, 2.0, 0.0], [0.0, 0.0, 0.5]],
    "irregular": [[1.01, 0.5, 0.4], [0.5, 0.27, 0.2], [0.4, 0.2, 0.16]],
}
STEP = 0.3


def _found(name: str, step: float = STEP) -> CriticalEnergies:
    return nh.critical_energies(nh.discretize(nh.SuslovTop(BODIES[name]), step))


def _energy(body: list, q: list) -> mpmath.mpf:
    """Return the physical energy of the rotation by the quaternion (z0, -z2, z1, 0), from M = W J - J W^T."""
    square = mpmath.fdot(q, q)
    z0, x, y = q
    last = [2 * z0 * x / square, 2 * z0 * y / square, 2 * z0 * z0 / square - 1]  # last column of W
    rows = [[1 - 2 * x * x / square, -2 * x * y / square], [-2 * x * y / square, 1 - 2 * y * y / square]]
    r = []
    for i, row in enumerate(rows):
        W = [*row, last[i]]
        below = [-last[0], -last[1], last[2]]  # last row of W
        r.append((mpmath.fdot(W, [J[2] for J in body]) - mpmath.fdot(body[i], below)) / mpmath.mpf(STEP))
    B11, B12, B22 = body[0][0] + body[2][2], body[0][1], body[1][1] + body[2][2]
    return (B22 * r[0] ** 2 - 2 * B12 * r[0] * r[1] + B11 * r[1] ** 2) / (B11 * B22 - B12 * B12) / 2


def _polished(body: list, z: np.ndarray) -> tuple[mpmath.mpf, float, mpmath.matrix]:
    """Return the energy of the critical point near z, how far it is, and the Hessian there, by Newton's method."""
    exact = [[mpmath.mpf(x) for x in row] for row in body]
    start = [mpmath.sqrt(max(0.0, 1 - float(z @ z))), *map(mpmath.mpf, z.tolist())]
    tangents = np.linalg.svd(np.array([[float(x) for x in start]]))[2][1:].tolist()
    e = mpmath.mpf(10) ** -15  # central differences: 25 digits of slopes, 25 of second derivatives at 60 digits

    def at(s: mpmath.mpf, t: mpmath.mpf) -> mpmath.mpf:
        return _energy(exact, [a + s * b + t * c for a, b, c in zip(start, *tangents, strict=True)])

    s = t = mpmath.mpf(0)
    for _ in range(4):
        here, sides = at(s, t), (at(s + e, t), at(s - e, t), at(s, t + e), at(s, t - e))
        slope = mpmath.matrix([sides[0] - sides[1], sides[2] - sides[3]]) / (2 * e)
        mixed = (at(s + e, t + e) - at(s + e, t - e) - at(s - e, t + e) + at(s - e, t - e)) / (4 * e * e)
        first, second = (sides[0] + sides[1] - 2 * here) / e**2, (sides[2] + sides[3] - 2 * here) / e**2
        hessian = mpmath.matrix([[first, mixed], [mixed, second]])
        move = mpmath.lu_solve(hessian, slope)
        s, t = s - move[0], t - move[1]
    assert mpmath.norm(move) <= 1e-20
    return at(s, t), float(mpmath.sqrt(s * s + t * t)), hessian


@pytest.mark.parametrize("name", [name for name in BODIES if name != "balanced"])
def test_critical_points_to_ten_digits(name: str) -> None:
    """Each point is a critical point of the energy of its kind, at its energy to 1e-12."""
    with mpmath.workdps(60):
        for point in _found(name).points:
            energy, distance, hessian = _polished(BODIES[name], point.half_turn_vector)
            assert abs(energy - point.energy) <= 1e-12 * max(1.0, abs(point.energy))
            assert distance <= 3e-8  # z0 = sqrt(1 - |z|^2) of a double z on the equator is that far off
            signs = [mpmath.sign(x) for x in mpmath.eigsy(hessian, eigvals_only=True)]
            assert {"minimum": [1, 1], "saddle": [-1, 1], "maximum": [-1, -1]}[point.kind] == signs


@pytest.mark.parametrize("seed", range(4))
def test_all_critical_points_are_found(seed: int) -> None:
    """On the projective plane minima - saddles + maxima = 1, for 50 random bodies, nearly rod-like ones among them."""
    rng, regular = np.random.default_rng(seed), set()
    for _ in range(50):
        points = rng.normal(size=(3, 3)) * rng.uniform(0.05, 1.5, size=3)
        result = nh.critical_energies(nh.discretize(nh.SuslovTop(points.T @ points + np.diag([0.01, 0.01, 0.0])), 1.0))
        weights = [1 if p.on_equator or not p.half_turn_vector.any() else 2 for p in result.points]
        signs = [-1 if p.kind == "saddle" else 1 for p in result.points]
        assert np.dot(weights, signs) == 1
        regular.add(result.regular)
    assert regular == {True, False}


def test_no_energy_exceeds_the_highest_point() -> None:
    """The largest energy of 200,000 displacements is the highest critical value, to the spacing of the sample."""
    rng = np.random.default_rng(1)
    for name, body in BODIES.items():
        top, result = nh.SuslovTop(body), _found(name)
        q = rng.normal(size=(3, 200_000))
        z0, *z = q / np.linalg.norm(q, axis=0)
        z = np.array(z)
        c, B = top.coupling, top.constrained_inertia
        F = z0 * (B @ z) + (z * z).sum(axis=0) * c[:, None] - (c @ z) * z
        sampled = (F * np.linalg.solve(B, F)).sum(axis=0).max() * 2 / STEP**2
        highest = max(p.energy for p in result.points)
        assert highest * (1 - 1e-3) <= sampled <= highest * (1 + 1e-14)


def test_aligned_closed_forms() -> None:
    """For c along e1: B11/(2 h^2) and B22/(2 h^2 kappa), kappa = 1 - |c|^2/D, are the two values off the equator."""
    for name in ("aligned, center", "aligned, saddle"):
        J = np.array(BODIES[name])
        b1, b2 = J[0, 0] + J[2, 2], J[1, 1] + J[2, 2]
        along, across = b1, b2 / (1 - J[0, 2] ** 2 / (b1 * b2))
        result = _found(name)
        expected = np.sort([along, across]) / (2 * STEP**2)
        assert np.abs(np.array([result.saddle, result.center]) - expected).max() <= 1e-13 * expected[1]
        kind = result.points[-1] if along > across else next(p for p in result.points if p.energy == result.saddle)
        assert kind.stationary


def test_outer_ovals_surround_one_half_turn() -> None:
    """False in the paper: for small energies the outer component is near the equator. It is near z || c alone."""
    top, angle = nh.SuslovTop(BODIES["generic"]), np.linspace(0.0, np.pi, 1001)
    z, c = np.array([np.cos(angle), np.sin(angle)]), top.coupling
    F = c[:, None] - (c @ z) * z
    energy = (F * np.linalg.solve(top.constrained_inertia, F)).sum(axis=0) * 2 / STEP**2
    low = energy < 1e-3 * _found("generic").equatorial_saddle
    assert 0 < low.sum() < 40
    assert np.abs(c @ z[:, low]).min() > 0.99 * np.hypot(*c)


def test_a_third_minimum_of_positive_energy() -> None:
    """In the regular regime too the energy may have a minimum on the equator that is not zero, between two saddles."""
    result = _found("third minimum")
    assert result.regular
    minima = [p for p in result.points if p.kind == "minimum"]
    assert [p.energy > 0 for p in minima] == [False, False, True]
    assert [p.kind for p in result.points if p.on_equator].count("saddle") == 2


def test_balanced_top() -> None:
    """For c = 0 values are eigenvalues of B over 2 h^2, all half-turns have energy zero, folds are the ridge."""
    result = _found("balanced")
    expected = np.linalg.eigvalsh(nh.SuslovTop(BODIES["balanced"]).constrained_inertia) / (2 * STEP**2)
    assert np.abs(np.array([result.saddle, result.center]) - expected).max() <= 1e-14 * expected[1]
    assert (result.equatorial_saddle, result.line, result.fold) == (None, None, result.saddle)
    assert all(p.stationary and not p.on_equator for p in result.points)


def test_a_closed_curve_of_maxima() -> None:
    """For B a multiple of the identity and c = 0 saddle and center coincide, and no isolated point is listed."""
    result = nh.critical_energies(nh.discretize(nh.SuslovTop(np.diag([1.0, 1.0, 1.0])), 1.0))
    assert (result.saddle, result.center) == pytest.approx((1.0, 1.0))
    assert result.centre == result.center
    assert len(result.points) == 1


# What has no such energies is refused, with the place to look at.
test_refusals = refusals(
    (nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1), "single_valued_region"),
    (nh.discretize(nh.MultidimensionalSleigh(1.0, [0.5, 0.1, 0.1], np.eye(3)), 0.1), r"Pass .discretize\(SuslovTop"),
    (nh.SuslovTop(np.diag([1.0, 2.0, 3.0])), "be a discretized system"),
    (nh.discretize(nh.SuslovTop(BODIES["generic"]), 0.1, difference="logarithmic"), "conserve the energy"),
    ask=lambda discrete: nh.critical_energies(discrete),
)


ANGLES = 2 * np.pi * (np.arange(90) + 0.5) / 90  # none of them an equilibrium
RATIOS = [0.01, 0.2, 0.499, 0.5, 0.501, 0.8, 0.8256, 0.8258, 1.0, 2.0, 5.0, 50.0]  # of m a^2 to J


def _sleigh(ratio: float, step: float = 0.25, b: float = 0.0, sign: int = 1) -> nh.Discretization:
    mass, inertia = 1.3, 0.7
    return nh.discretize(nh.ChaplyginSleigh(mass, inertia, sign * np.sqrt(ratio * inertia / mass), b), step)


def _real_branches(discrete: nh.Discretization, momentum: np.ndarray) -> int:
    """Count the real roots of the cubic with numpy."""
    roots = np.roots(cubic(discrete.system, discrete.time_step, momentum))
    return int(np.sum(np.abs(roots.imag) < 1e-9))


@pytest.mark.profile("problems", keep=["0.2", "0.499", "0.501", "0.8258", "2.0"])
@pytest.mark.parametrize("ratio", RATIOS)
def test_sharp_bound_is_the_least_energy(ratio: float) -> None:
    """It is the least energy on the deltoid, by search in D/2, cusps and both ends among what is tried."""
    discrete = _sleigh(ratio)
    s, h = discrete.system, discrete.time_step
    M = s.mass * s.a**2

    def level(half: Any) -> Any:
        T = np.tan(half) ** 2
        pi2, phat = 16 * s.inertia**2 * T**3 / (1 + T) ** 4, -2 * s.inertia * (1 - T) / (1 + T) ** 2
        return pi2 / (2 * (s.inertia + M) * h**2) + ((phat - 2 * M) / s.a / h) ** 2 / (2 * s.mass)

    halves = np.append(np.linspace(0.0, np.pi / 2, 2001), np.pi / 3)
    least = halves[np.argmin(level(halves))]
    bounds = np.clip([least - 1e-3, least + 1e-3], 0.0, np.pi / 2)
    inside = scipy.optimize.minimize_scalar(level, bounds=bounds, method="bounded", options={"xatol": 1e-9}).fun
    assert abs(min(inside, level(least)) / nh.single_valued_region(discrete).energy - 1) <= 1e-13


@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("sign", [1, -1])
def test_bound_is_sharp(ratio: float, sign: int) -> None:
    """Below it random momenta have one real branch each; from the contact just into the deltoid there are three."""
    discrete, rng = _sleigh(ratio, b=0.4, sign=sign), np.random.default_rng(0)
    system, result = discrete.system, nh.single_valued_region(discrete)
    for momentum in rng.normal(size=(500, 2)):
        scale = np.sqrt(0.999 * result.energy / system.constrained_energy(momentum))
        assert _real_branches(discrete, scale * momentum) == 1
    center = result.cusps.mean(axis=0)
    for contact in result.contact:
        assert system.constrained_energy(contact) == pytest.approx(result.energy, rel=1e-13)
        assert _real_branches(discrete, contact + 1e-3 * (center - contact)) == 3


@pytest.mark.profile("problems", keep=["0.501", "0.8258", "5.0"])
@pytest.mark.parametrize("ratio", RATIOS)
def test_principal_energy_is_the_least_on_two_sides(ratio: float) -> None:
    """The closed form is the least energy on the right side of the deltoid, angles 0 to 2 pi/3, found by search."""
    discrete = _sleigh(ratio, b=0.4)
    side = deltoid(discrete).touching(np.linspace(0, 2 * np.pi / 3, 3001))
    least = min(float(discrete.system.constrained_energy(r)) for r in side)
    bound = nh.single_valued_region(discrete).principal_energy
    assert bound * (1 - 1e-13) <= least <= bound * (1 + 1e-5)  # the mesh is one of 7e-4


@pytest.mark.profile("problems", keep=["1-0.5"])
@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("sign", [1, -1])
def test_every_momentum_has_a_principal_value_below(ratio: float, sign: int) -> None:
    """Below the principal energy all directions of momentum have a principal value; above it some have none."""
    discrete = _sleigh(ratio, b=0.4, sign=sign)
    bound, without = nh.single_valued_region(discrete).principal_energy, []
    for share in (0.999, 1.3):
        around = momenta_of_energy(discrete.system, share * bound, ANGLES)
        without.append(sum(nh.displacements_over(discrete, r).principal is None for r in around))
    assert without[0] == 0
    assert without[1] > 0


@pytest.mark.parametrize("ratio", RATIOS)
def test_bound_of_the_paper_is_not_sharp(ratio: float) -> None:
    """False in the paper as a limit: it is 3.79 to 4 times too small (243/64 at m a^2 = 2J)."""
    result = nh.single_valued_region(_sleigh(ratio))
    assert 243 / 64 * (1 - 1e-14) <= result.energy / result.bound_of_the_paper <= 4
    if ratio == 2.0:
        assert result.energy / result.bound_of_the_paper == pytest.approx(243 / 64, rel=1e-14)


def test_crossover() -> None:
    """Origin and cusps are reached together at m a^2 = (3 + sqrt 13) J/8: on either side the contact is another."""
    edge = (3 + np.sqrt(13)) / 8
    assert nh.single_valued_region(_sleigh(edge * (1 - 1e-9))).contact.shape == (1, 2)
    assert nh.single_valued_region(_sleigh(edge * (1 + 1e-9))).contact.shape == (2, 2)


@pytest.mark.parametrize("a", [1e-8, 1e-160, 1e8])
def test_extreme_offsets(a: float) -> None:
    """Energies are finite numbers without warnings for tiny and huge a."""
    result = nh.single_valued_region(nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, a), 1.0))
    assert 0 <= result.bound_of_the_paper <= result.energy < np.inf


# Balanced sleighs and other systems are refused with the reason.
test_other_bodies_are_refused = refusals(
    (nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.0), 0.1), "two real branches"),
    (nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1, difference="logarithmic"), "three branches"),
    (nh.discretize(nh.SuslovTop(np.diag([1.0, 2.0, 3.0])), 0.1), "be of a sleigh in the plane"),
    (nh.ChaplyginSleigh(1.0, 1.0, 0.5), "be a discretized system"),
    ask=lambda discrete: nh.single_valued_region(discrete),
)
