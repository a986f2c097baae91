"""Critical energies of the discrete top against 40-digit critical points of the energy, found from its definition."""

import mpmath
import numpy as np
import pytest
from refusals import refusals

import nonholo as nh
from nonholo.analysis import CriticalEnergies

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
        found = nh.critical_energies(nh.discretize(nh.SuslovTop(points.T @ points + np.diag([0.01, 0.01, 0.0])), 1.0))
        weights = [1 if p.on_equator or not p.half_turn_vector.any() else 2 for p in found.points]
        signs = [-1 if p.kind == "saddle" else 1 for p in found.points]
        assert np.dot(weights, signs) == 1
        regular.add(found.regular)
    assert regular == {True, False}


def test_no_energy_exceeds_the_highest_point() -> None:
    """The largest energy of 200,000 displacements is the highest critical value, to the spacing of the sample."""
    rng = np.random.default_rng(1)
    for name, body in BODIES.items():
        top, found = nh.SuslovTop(body), _found(name)
        q = rng.normal(size=(3, 200_000))
        z0, *z = q / np.linalg.norm(q, axis=0)
        z = np.array(z)
        c, B = top.coupling, top.constrained_inertia
        F = z0 * (B @ z) + (z * z).sum(axis=0) * c[:, None] - (c @ z) * z
        sampled = (F * np.linalg.solve(B, F)).sum(axis=0).max() * 2 / STEP**2
        highest = max(p.energy for p in found.points)
        assert highest * (1 - 1e-3) <= sampled <= highest * (1 + 1e-14)


def test_time_step_scales_the_energies() -> None:
    """Critical energies are those of h = 1 divided by h^2: h P is the momentum in which the variety is fixed."""
    one, other = _found("generic", 1.0), _found("generic", 0.25)
    for field in ("saddle", "center", "equatorial_saddle"):
        assert getattr(other, field) == pytest.approx(16 * getattr(one, field), rel=1e-14)


def test_aligned_closed_forms() -> None:
    """For c along e1: B11/(2 h^2) and B22/(2 h^2 kappa), kappa = 1 - |c|^2/D, are the two values off the equator."""
    for name in ("aligned, center", "aligned, saddle"):
        J = np.array(BODIES[name])
        b1, b2 = J[0, 0] + J[2, 2], J[1, 1] + J[2, 2]
        along, across = b1, b2 / (1 - J[0, 2] ** 2 / (b1 * b2))
        found = _found(name)
        expected = np.sort([along, across]) / (2 * STEP**2)
        assert np.abs(np.array([found.saddle, found.center]) - expected).max() <= 1e-13 * expected[1]
        kind = found.points[-1] if along > across else next(p for p in found.points if p.energy == found.saddle)
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
    found = _found("third minimum")
    assert found.regular
    minima = [p for p in found.points if p.kind == "minimum"]
    assert [p.energy > 0 for p in minima] == [False, False, True]
    assert [p.kind for p in found.points if p.on_equator].count("saddle") == 2


def test_balanced_top() -> None:
    """For c = 0 the values are the eigenvalues of B over 2 h^2, and all half-turns have energy zero."""
    found = _found("balanced")
    expected = np.linalg.eigvalsh(nh.SuslovTop(BODIES["balanced"]).constrained_inertia) / (2 * STEP**2)
    assert np.abs(np.array([found.saddle, found.center]) - expected).max() <= 1e-14 * expected[1]
    assert found.equatorial_saddle is None
    assert all(p.stationary and not p.on_equator for p in found.points)


def test_a_closed_curve_of_maxima() -> None:
    """For B a multiple of the identity and c = 0 saddle and center coincide, and no isolated point is listed."""
    found = nh.critical_energies(nh.discretize(nh.SuslovTop(np.diag([1.0, 1.0, 1.0])), 1.0))
    assert found.saddle == pytest.approx(1.0)
    assert found.center == pytest.approx(1.0)
    assert len(found.points) == 1


def test_the_forbidden_axis_does_not_matter() -> None:
    """The same body in another body frame has the same critical energies."""
    rng = np.random.default_rng(5)
    turn = nh.SO(3).random(rng)
    top = nh.SuslovTop(turn @ np.array(BODIES["generic"]) @ turn.T, axis=turn[:, 2])
    found, same = nh.critical_energies(nh.discretize(top, STEP)), _found("generic")
    values = ("saddle", "center", "equatorial_saddle")
    assert [getattr(found, v) for v in values] == pytest.approx([getattr(same, v) for v in values], rel=1e-13)


# What has no such energies is refused, with the place to look at.
test_refusals = refusals(
    (nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1), "single_valued_region"),
    (nh.SuslovTop(np.diag([1.0, 2.0, 3.0])), "discretized Suslov top"),
    (nh.discretize(nh.SuslovTop(BODIES["generic"]), 0.1, difference="logarithmic"), "conserve the energy"),
    ask=lambda discrete: nh.critical_energies(discrete),
)


def test_both_names_of_the_center() -> None:
    """`centre` is another name of `center`."""
    energies = _found("generic")
    assert energies.centre == energies.center > energies.saddle
