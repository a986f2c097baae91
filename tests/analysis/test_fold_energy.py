"""The energy up to which the displacement around the identity is unique: samples, 40-digit cusps, folds for n > 3."""

from collections.abc import Callable
from typing import Any

import mpmath
import numpy as np
import pytest
import scipy
from analysis.equations import momenta_of_energy

import nonholo as nh
from nonholo.analysis._critical_energies import fold_energy, over_directions
from nonholo.discrete import legendre

BODIES = {  # the first three have D/|c|^2 between 2 and 3; the last two are outside the regular regime
    "three inner values": [
        [1.645907, -0.975937, -0.176582],
        [-0.975937, 0.591716, 0.106159],
        [-0.176582, 0.106159, 0.028912],
    ],
    "a little below": [[0.1455, -0.1016, 0.0784], [-0.1016, 1.9212, 1.4494], [0.0784, 1.4494, 1.3992]],
    "below the saddle": [[0.5086, -0.3131, 0.0789], [-0.3131, 0.2054, -0.0446], [0.0789, -0.0446, 0.0163]],
    "near a rod": [[1.01, 0.5, 0.4], [0.5, 0.27, 0.2], [0.4, 0.2, 0.16]],
    "a saddle, irregular": [[0.95, -1.75, 1.8], [-1.75, 3.7, -3.65], [1.8, -3.65, 3.65]],
}
THREE, REGULAR = next(iter(BODIES)), list(BODIES)[:3]


def _top(name: str) -> nh.SuslovTop:
    return nh.SuslovTop(BODIES[name])


def _discrete(name: str, step: float = 1.0) -> nh.Discretization:
    return nh.discretize(_top(name), step)


def _body(sigma: float, ratio: float, angle: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Return B with eigenvalues 1 and `ratio`, c with |c|^2 = sigma det B, and the value of the saddle."""
    B, c = np.diag([1.0, ratio]), np.sqrt(sigma * ratio) * np.array([np.cos(angle), np.sin(angle)])
    across = np.array([-c[1], c[0]])
    kappa = np.eye(2) - np.outer(across, across) / ratio
    return B, c, 1 / (4 * np.linalg.eigvals(np.linalg.solve(B, kappa)).real.max())


def _bound(sigma: float) -> float:
    return 1 - max(0.0, 3 * sigma - 1) ** 3 * (1 + sigma) / (16 * sigma)


class Twin:
    """Energy and Jacobian determinant at angles (phi, theta) of axis and rotation, from the matrices alone; h = 1."""

    def __init__(self, body: list, number: type = float) -> None:
        self.J = [[number(x) for x in row] for row in body]
        self.lib = mpmath if number is mpmath.mpf else np

    def momentum(self, phi: Any, theta: Any) -> tuple:
        """Return the components along e_1 ^ e_3 and e_2 ^ e_3 of W J - J W^T."""
        cos, sin, versine = self.lib.cos(theta), self.lib.sin(theta), 1 - self.lib.cos(theta)
        u = [self.lib.cos(phi), self.lib.sin(phi)]
        W = [[(i == j) - versine * u[i] * u[j] for j in range(2)] + [sin * u[i]] for i in range(2)]
        W.append([-sin * u[0], -sin * u[1], cos])
        J = self.J
        return tuple(sum(W[i][k] * J[k][2] - J[i][k] * W[2][k] for k in range(3)) for i in range(2))

    def energy(self, phi: Any, theta: Any) -> Any:
        """Return the energy."""
        (x, y), J = self.momentum(phi, theta), self.J
        p, q, r = J[0][0] + J[2][2], J[0][1], J[1][1] + J[2][2]
        return (r * x * x - 2 * q * x * y + p * y * y) / (p * r - q * q) / 2

    def determinant(self, phi: Any, theta: Any, e: Any) -> Any:
        """Return the determinant of the momenta by the angles, by central differences."""
        a, b = self.momentum(phi + e, theta), self.momentum(phi - e, theta)
        c, d = self.momentum(phi, theta + e), self.momentum(phi, theta - e)
        return ((a[0] - b[0]) * (c[1] - d[1]) - (a[1] - b[1]) * (c[0] - d[0])) / (4 * e * e)


def _first_zero(of: Callable, phi: np.ndarray) -> np.ndarray:
    """Return where a function that is positive near the identity first changes sign on each ray; pi if it does not."""
    theta = np.linspace(1e-2, np.pi - 1e-6, 300)
    negative = of(phi[:, None], theta) <= 0
    first = np.argmax(negative, axis=1)
    low, high = theta[np.maximum(first - 1, 0)], theta[first]
    for _ in range(40):
        middle = (low + high) / 2
        below = of(phi, middle) <= 0
        low, high = np.where(below, low, middle), np.where(below, middle, high)
    return np.where(negative.any(axis=1), low, np.pi)


def _lowest(body: list) -> tuple[float, float, bool]:
    """Return the angles of the lowest first fold, or top of a ray, of dense rays, looked at closer and closer."""
    twin, center = Twin(body), np.pi
    side = np.sign(twin.determinant(0.0, 1e-2, 1e-4))
    for width in (np.pi, 0.1, 0.01, 1e-3):
        phi = center + width * np.linspace(-1.0, 1.0, 400)
        fold = _first_zero(lambda x, y: side * twin.determinant(x, y, 1e-4), phi)
        top = _first_zero(lambda x, y: twin.energy(x, y + 1e-5) - twin.energy(x, y - 1e-5), phi)
        least = int(np.argmin(twin.energy(phi, np.minimum(fold, top))))
        center = phi[least]
    return float(center), float(min(fold[least], top[least])), bool(fold[least] < top[least])


def _cusp(body: list, phi: float, theta: float) -> mpmath.mpf:
    """Return the energy of the cusp near a fold: the determinant is stationary along the level."""
    twin, e, d = Twin(body, mpmath.mpf), mpmath.mpf(10) ** -25, mpmath.mpf(10) ** -15

    def slopes(of: Callable, x: Any, y: Any) -> tuple:
        return (of(x + d, y) - of(x - d, y)) / (2 * d), (of(x, y + d) - of(x, y - d)) / (2 * d)

    def wanted(x: Any, y: Any) -> tuple:
        fold, height = slopes(lambda s, t: twin.determinant(s, t, e), x, y), slopes(twin.energy, x, y)
        return twin.determinant(x, y, e), fold[0] * height[1] - fold[1] * height[0]

    x, y = mpmath.mpf(phi), mpmath.mpf(theta)
    for _ in range(8):
        rows = [slopes(lambda s, t, i=i: wanted(s, t)[i], x, y) for i in range(2)]
        move = mpmath.lu_solve(mpmath.matrix(rows), mpmath.matrix(wanted(x, y)))
        x, y = x - move[0], y - move[1]
    assert mpmath.norm(move) <= 1e-20
    assert abs(x - phi) + abs(y - theta) <= 1e-3
    return twin.energy(x, y)


@pytest.mark.profile("problems", keep=["near a rod"])
@pytest.mark.parametrize("name", BODIES)
def test_fold_energy_against_the_matrices(name: str) -> None:
    """The lowest fold that dense rays of the definition meet, polished to 30 digits, has the energy to 1e-11."""
    phi, theta, is_fold = _lowest(BODIES[name])
    assert is_fold
    with mpmath.workdps(110):
        expected = _cusp(BODIES[name], phi, theta)
        assert abs(nh.critical_energies(_discrete(name)).fold / expected - 1) <= 1e-11


def test_the_inner_displacement_is_not_unique_below_the_saddle() -> None:
    """At 0.985 h* a momentum has three inner values, and a principal orbit ends; its limits are those of any branch."""
    top = _discrete(THREE)
    reference = nh.critical_energies(top)
    level = 0.985 * reference.saddle
    assert reference.regular
    assert reference.fold < level < reference.saddle
    regions = [
        nh.displacements_over(top, r).region.tolist()
        for r in momenta_of_energy(top.system, level, np.linspace(0.0, 2 * np.pi, 101))
    ]
    assert {row.count("inner") for row in regions} == {1, 3}
    orbit = nh.simulate(top, momentum=[-0.34187683576850936, 0.21427098809515754], steps=50, throw=False)
    assert orbit.outcome == nh.Outcome.no_real_branch
    limits = nh.asymptotics(orbit)
    assert not limits.persists
    assert limits.spatial_axis_after is None
    assert np.abs(limits.axis_after - nh.asymptotics(top.system).axis_after).max() <= 1e-14


@pytest.mark.profile("routes", keep=["a saddle, irregular"])
@pytest.mark.parametrize("name", BODIES)
def test_below_the_fold_every_principal_orbit_goes_on(name: str) -> None:
    """At 0.9999 of the energy 50 principal orbits continue; in the regular regime there is one inner value."""
    top = _discrete(name, 0.5)
    level = 0.9999 * nh.critical_energies(top).fold
    for r in momenta_of_energy(top.system, level, np.linspace(0.1, 6.3, 50)):
        assert nh.asymptotics(nh.simulate(top, momentum=r, steps=40)[:1]).persists
        if name in REGULAR:
            values = nh.displacements_over(top, r)
            assert np.flatnonzero(values.region == "inner").tolist() == [values.principal]


@pytest.mark.profile("problems", instead="test_the_inner_displacement_is_not_unique_below_the_saddle")
def test_rules_that_are_not_known_to_persist() -> None:
    """What is known of principal orbits is not said of another rule, nor of a composition; limits remain."""
    top = _discrete(THREE)
    r = momenta_of_energy(top.system, 0.5 * nh.critical_energies(top).fold, np.array([1.0]))[0]
    other = nh.asymptotics(nh.simulate(top, momentum=r, steps=3, branch="largest"))
    composed = nh.asymptotics(nh.simulate(nh.discretize(top.system, 1.0, order=4), momentum=r / 9, steps=3))
    near = nh.asymptotics(nh.simulate(top, momentum=r, steps=3, branch="nearest"))
    assert [other.persists, composed.persists, near.persists] == [False, False, False]
    assert other.spatial_axis_after is None
    assert near.spatial_axis_after is not None
    assert np.abs(other.velocity_after - near.velocity_after).max() <= 1e-15


def test_folds_in_polar_coordinates() -> None:
    """The cubic and the form with eta are the fold function of docs/theory/invariant-measure.md; so is the energy."""
    rng = np.random.default_rng(2)
    for _ in range(200):
        B, c, _ = _body(rng.uniform(0.0, 0.9), 10 ** -rng.uniform(0.0, 2.0), rng.uniform(0.0, np.pi))
        D, angle, x = np.linalg.det(B), rng.uniform(0.0, 2 * np.pi), np.array([rng.uniform(0.0, 3.0)])
        u = np.array([[np.cos(angle), np.sin(angle)]])
        z0, z, across = x[0] / np.hypot(x[0], 1.0), u[0] / np.hypot(x[0], 1.0), np.array([-u[0, 1], u[0, 0]])
        force = (c @ across) * across * (z @ z)
        e = (z0 * B @ z + force) @ np.linalg.solve(B, z0 * B @ z + force)
        f = D * z0 * (z0**2 - z @ z) + 2 * z0 * (z @ z) * (c @ across) ** 2 - c @ B @ z + 2 * (c @ z) * (z @ B @ z)
        f = f / D * np.hypot(x[0], 1.0) ** 3
        (b, p, s, along), X = (float(part[0]) for part in over_directions(u, B, c)), x[0]
        kappa, alpha, k = 1 - s * s, c @ u[0], u[0] @ B @ across
        mu, rate = b / kappa, (2 * k * kappa - 2 * b * s * alpha / np.sqrt(D)) / kappa**2
        Y = X * X - 1 + 2 * s * s
        eta = Y / (Y + 2 * kappa)
        cubic = X**3 - p * X * X - (1 - 2 * s * s) * X + 2 * along - p
        polar = (Y + 2 * kappa) * (eta * (X - alpha * mu / D) - s * kappa * rate / (2 * np.sqrt(D)))
        assert [cubic, polar] == pytest.approx([f, f], rel=1e-10, abs=1e-10 * (1 + p * p + along * along))
        assert [b * (X * X + s * s) / (1 + X * X) ** 2, mu / 4 * (1 - eta * eta)] == pytest.approx([e, e], rel=1e-11)


@pytest.mark.profile("problems", keep=["0.05", "0.3*"])
@pytest.mark.parametrize("sigma", [0.0, 0.05, 0.2, 1 / 3])
def test_no_fold_below_the_saddle_for_three(sigma: float) -> None:
    """For D >= 3|c|^2 the search, which does not know the theorem, meets nothing below the saddle."""
    rng = np.random.default_rng(int(100 * sigma))
    for _ in range(20):
        B, c, saddle = _body(sigma, 10 ** -rng.uniform(0.0, 5.0), rng.uniform(0.0, np.pi))
        assert fold_energy(B, c) == pytest.approx(saddle, rel=1e-9)


@pytest.mark.parametrize("sigma", [0.35, 0.42, 0.4999])
def test_the_bound_is_sharp(sigma: float) -> None:
    """Flat bodies with the direction of the proof across c come within a percent of it; the least of all is 125/128."""
    eta = (3 * sigma - 1) / 2
    limit, m = _bound(sigma), 1e-4
    rho = (1 - eta**2) / limit
    k = np.sqrt((1 / rho - 1) * (1 - (1 - sigma) * m * m * rho))
    b = m * (1 - sigma)
    B, c = np.array([[b, k], [k, (1 + k * k) / b]]), np.array([0.0, np.sqrt(sigma)])
    saddle = 1 / (4 * np.linalg.eigvals(np.linalg.solve(B, np.diag([1 - sigma, 1.0]))).real.max())
    last = np.sqrt(sigma) * b
    assert np.linalg.eigvalsh(np.block([[B - last * np.eye(2), c[:, None]], [c, last]])).min() > 0
    assert 0 <= fold_energy(B, c) / saddle - limit <= 0.01 * (1 - limit)
    assert limit >= 125 / 128


def test_fold_scales_and_turns_with_the_body() -> None:
    """The energies go with 1/h^2 and do not depend on the body frame."""
    turn = nh.SO(3).random(np.random.default_rng(5))
    turned = nh.SuslovTop(turn @ np.array(BODIES[THREE]) @ turn.T, axis=turn[:, 2])
    one, other = (nh.critical_energies(nh.discretize(top, h)) for top, h in ((_top(THREE), 1.0), (turned, 0.25)))
    assert [other.fold, other.line] == pytest.approx([16 * one.fold, 16 * one.line], rel=1e-11)


def test_the_line_of_equilibria_ends_between_saddle_and_center() -> None:
    """Its top is the energy of the equilibrium that turns by 90 degrees; `equilibria` says the same."""
    for name in REGULAR:
        top = _discrete(name, 0.7)
        reference = nh.critical_energies(top)
        assert reference.saddle <= reference.line <= reference.center
        c = top.system.coupling
        z = -np.sqrt(0.5) * c / np.hypot(*c)
        W = np.block([[np.eye(2) - 2 * np.outer(z, z), np.sqrt(2) * z[:, None]], [-np.sqrt(2) * z, np.zeros(1)]])
        orbit = nh.simulate(top, displacement=W, steps=1, throw=False, branch="smallest")
        assert orbit.energy[0] == pytest.approx(reference.line, rel=1e-13)
        assert nh.equilibria(top, 0.5 * reference.line).highest_energy == reference.line
        with pytest.raises(ValueError, match=f"Lower the energy, to {reference.line:.6g} at most"):
            nh.equilibria(top, 1.001 * reference.line)


H = 0.5


def _body_of_rank(k: int, sigma: float, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Return the eigenvalues of B, near each other or not, and c with |c|^2 = sigma b_1 b_2, near an axis or not."""
    b = np.sort(np.exp(rng.normal(size=k) * rng.choice([0.05, 0.5, 1.5])))
    c = rng.normal(size=k) * np.exp(rng.normal(size=k) * rng.choice([0.1, 2.0]))
    return b, c * np.sqrt(sigma * b[0] * b[1]) / np.linalg.norm(c)


def _top_of(b: np.ndarray, c: np.ndarray, rng: np.random.Generator) -> nh.SuslovTop:
    """Return a top with these numbers, in other axes: a small J_nn keeps the mass tensor as positive as it can be."""
    n, along = len(b) + 1, 0.4 * b.min()
    J = np.diag(np.append(b - along, along))
    J[-1, :-1] = J[:-1, -1] = c
    turn = scipy.linalg.block_diag(nh.SO(n - 1).random(rng), 1.0)
    return nh.SuslovTop(turn @ J @ turn.T)


def _momentum(b: np.ndarray, c: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return h r/2 over Cayley coordinates."""
    return (b * y + (y @ y) * c - (c @ y) * y) / (1 + y @ y)


def _energy(b: np.ndarray, c: np.ndarray, y: np.ndarray) -> float:
    r = _momentum(b, c, y)
    return float(2 * (r / b) @ r / H**2)


def _determinant(b: np.ndarray, c: np.ndarray, y: np.ndarray) -> float:
    square, above = 1 + y @ y, b * y + (y @ y) * c - (c @ y) * y
    slope = np.diag(b - c @ y) + 2 * np.outer(c, y) - np.outer(y, c)
    return float(np.linalg.det(square * slope - 2 * np.outer(above, y)))


def _first_fold(b: np.ndarray, c: np.ndarray, direction: np.ndarray) -> float:
    """Return the highest energy on a ray up to its first fold; infinite where there is none within 80 degrees."""
    u, angles = direction / np.linalg.norm(direction), np.linspace(0.0, 1.4, 100)
    signs = [_determinant(b, c, np.tan(a) * u) for a in angles]
    if min(signs) > 0:
        return np.inf
    first = int(np.argmax(np.array(signs) <= 0))
    find: Any = scipy.optimize.brentq
    end = find(lambda a: _determinant(b, c, np.tan(a) * u), angles[first - 1], angles[first])
    return max(_energy(b, c, np.tan(a) * u) for a in np.linspace(0.0, end, 30))


def _lowest_fold(b: np.ndarray, c: np.ndarray, rng: np.random.Generator) -> float:
    """Return the least energy of first folds that a search from the best of six lines comes to."""
    minimize: Any = scipy.optimize.minimize
    rays = rng.normal(size=(6, len(b))) * np.append([3.0, 2.0], np.ones(len(b) - 2))
    start = min([*rays, *-rays], key=lambda u: _first_fold(b, c, u))
    return minimize(lambda u: _first_fold(b, c, u), start, method="Nelder-Mead", options={"maxiter": 60}).fun


def test_the_twin_is_the_definition() -> None:
    """Momentum and folds of the coordinates used here are those of the matrices, by central differences."""
    rng = np.random.default_rng(0)
    for n in (4, 5, 6):
        b, c = _body_of_rank(n - 1, 0.3, rng)
        J = np.diag(np.append(b - 0.4 * b[0], 0.4 * b[0]))
        J[-1, :-1] = J[:-1, -1] = c
        top = nh.discretize(nh.SuslovTop(J), H)

        def scaled(y: np.ndarray, top: nh.Discretization = top, n: int = n) -> np.ndarray:
            z0, z = 1 / np.sqrt(1 + y @ y), y / np.sqrt(1 + y @ y)
            column, row = 2 * z0 * z[:, None], -2 * z0 * z[None]
            X = np.block([[-2 * np.outer(z, z), column], [row, np.array([[-2 * z @ z]])]])
            assert X.shape == (n, n)
            return top.system.restrict(legendre(top, X, "left")) * H / 2

        y, e = rng.normal(size=n - 1), 1e-6
        assert np.abs(scaled(y) - _momentum(b, c, y)).max() <= 1e-14 * b.max()
        slope = np.array([scaled(y + e * d) - scaled(y - e * d) for d in np.eye(n - 1)]).T / (2 * e)
        expected = _determinant(b, c, y) / (1 + y @ y) ** (2 * (n - 1))
        assert np.linalg.det(slope) == pytest.approx(expected, rel=1e-6, abs=1e-7 * np.prod(b))


@pytest.mark.profile("problems", keep=["0-3"])
@pytest.mark.parametrize(("seed", "bodies"), [(0, 3), *((seed, 12) for seed in range(5))])
def test_no_fold_below_the_bound(seed: int, bodies: int) -> None:
    """No ray of some bodies, n = 4 to 6, that is looked at meets a fold at less energy."""
    rng, nearest = np.random.default_rng(seed), np.inf
    for _ in range(bodies):
        sigma = rng.uniform(0.25, 1 / 3) if rng.random() < 0.6 else rng.uniform(1 / 3, 0.4999)
        b, c = _body_of_rank(int(rng.integers(3, 6)), sigma, rng)
        reference = nh.critical_energies(nh.discretize(_top_of(b, c, rng), H))
        assert reference.fold == pytest.approx(_bound(sigma) * b[0] / (2 * H * H), rel=1e-12)
        nearest = min(nearest, _lowest_fold(b, c, rng) / reference.fold)
    assert 1 - 1e-12 <= nearest <= 1.2


def test_the_bound_is_reached() -> None:
    """With c along the axis of the least eigenvalue the lowest ridge is the bound, and a fold, if sigma <= 1/3."""
    b, c = np.array([1.0, 1.5, 2.0]), np.array([np.sqrt(0.5), 0.0, 0.0])
    y = np.array([1.0, 0.0, 0.0])  # the angle of 90 degrees, on the ridge
    reference = nh.critical_energies(nh.discretize(_top_of(b, c, np.random.default_rng(0)), H))
    assert _energy(b, c, y) == pytest.approx(reference.fold, rel=1e-14)
    assert reference.line == pytest.approx(reference.fold, rel=1e-14)
    assert abs(_determinant(b, c, y)) <= 1e-14


def test_the_value_of_three_dimensions_obeys_the_bound() -> None:
    """The fold that is searched for with n = 3 is not below what the planes of more dimensions would say."""
    rng = np.random.default_rng(1)
    for _ in range(30):
        sigma = rng.uniform(0.05, 0.4999)
        b, c = _body_of_rank(2, sigma, rng)
        fold = nh.critical_energies(nh.discretize(_top_of(b, c, rng), H)).fold
        ratio = fold / (_bound(sigma) * b[0] / (2 * H * H))
        assert 1 - 1e-12 <= ratio < 128 / 125 / (1 - sigma)


def test_below_the_bound_principal_orbits_continue() -> None:
    """At 0.9999 of the bound orbits of tops with n = 4 and 6 run, and are known to; no other ones are."""
    rng = np.random.default_rng(2)
    for k, sigma in ((3, 0.33), (5, 0.45), (3, 0.5001)):
        b, c = _body_of_rank(k, sigma, rng)
        top = nh.discretize(_top_of(b, c, rng), H)
        reference = nh.critical_energies(top)
        assert reference.regular == (sigma < 0.5)
        level = 0.9999 * (reference.fold or 0.5 * b[0] / (2 * H * H))
        for direction in rng.normal(size=(8, k)):
            r = direction * np.sqrt(level / top.system.constrained_energy(direction))
            orbit = nh.simulate(top, momentum=r, steps=60, throw=False)
            assert nh.asymptotics(orbit[:1]).persists == (sigma < 0.5)
            assert sigma > 0.5 or orbit.outcome == nh.Outcome.successful
            beyond = nh.simulate(top, momentum=1.001 * r, steps=1, throw=False)
            assert not nh.asymptotics(beyond[:1]).persists


def test_other_tops() -> None:
    """A balanced top has b_1/(2h^2) and no line; n = 10^5 needs no matrix; `line` is that of the equilibria."""
    balanced = nh.critical_energies(nh.discretize(nh.SuslovTop(np.diag([1.0, 3.0, 2.0, 0.5])), H))
    assert (balanced.fold, balanced.line, balanced.points) == (3.0, None, ())
    top = nh.discretize(nh.SuslovTop(np.diag([1.0, 0.7, 0.9, 0.6]) + 0.2), H)
    assert nh.critical_energies(top).line == pytest.approx(nh.equilibria(top, 0.1).highest_energy, rel=1e-14)
    broad = nh.SuslovTop.arrowhead(np.linspace(1.0, 2.0, 100_000), np.full(99_999, 1e-3))
    reference = nh.critical_energies(nh.discretize(broad, H))
    assert reference.fold == pytest.approx(3.0 / (2 * H * H), rel=1e-14)
