"""The energy below which tops with n > 3 have no fold, against folds that rays of the definition meet."""

from typing import Any

import numpy as np
import pytest
import scipy

import nonholo as nh
from nonholo.discrete import legendre

H = 0.5


def _bound(sigma: float) -> float:
    return 1 - max(0.0, 3 * sigma - 1) ** 3 * (1 + sigma) / (16 * sigma)


def _body(k: int, sigma: float, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Return the eigenvalues of B, near each other or not, and c with |c|^2 = sigma b_1 b_2, near an axis or not."""
    b = np.sort(np.exp(rng.normal(size=k) * rng.choice([0.05, 0.5, 1.5])))
    c = rng.normal(size=k) * np.exp(rng.normal(size=k) * rng.choice([0.1, 2.0]))
    return b, c * np.sqrt(sigma * b[0] * b[1]) / np.linalg.norm(c)


def _top(b: np.ndarray, c: np.ndarray, rng: np.random.Generator) -> nh.SuslovTop:
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
        b, c = _body(n - 1, 0.3, rng)
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
        b, c = _body(int(rng.integers(3, 6)), sigma, rng)
        known = nh.critical_energies(nh.discretize(_top(b, c, rng), H))
        assert known.fold == pytest.approx(_bound(sigma) * b[0] / (2 * H * H), rel=1e-12)
        nearest = min(nearest, _lowest_fold(b, c, rng) / known.fold)
    assert 1 - 1e-12 <= nearest <= 1.2


def test_the_bound_is_reached() -> None:
    """With c along the axis of the least eigenvalue the lowest ridge is the bound, and a fold, if sigma <= 1/3."""
    b, c = np.array([1.0, 1.5, 2.0]), np.array([np.sqrt(0.5), 0.0, 0.0])
    y = np.array([1.0, 0.0, 0.0])  # the angle of 90 degrees, on the ridge
    known = nh.critical_energies(nh.discretize(_top(b, c, np.random.default_rng(0)), H))
    assert _energy(b, c, y) == pytest.approx(known.fold, rel=1e-14)
    assert known.line == pytest.approx(known.fold, rel=1e-14)
    assert abs(_determinant(b, c, y)) <= 1e-14


def test_the_value_of_three_dimensions_obeys_the_bound() -> None:
    """The fold that is searched for with n = 3 is not below what the planes of more dimensions would say."""
    rng = np.random.default_rng(1)
    for _ in range(30):
        sigma = rng.uniform(0.05, 0.4999)
        b, c = _body(2, sigma, rng)
        fold = nh.critical_energies(nh.discretize(_top(b, c, rng), H)).fold
        ratio = fold / (_bound(sigma) * b[0] / (2 * H * H))
        assert 1 - 1e-12 <= ratio < 128 / 125 / (1 - sigma)


def test_below_the_bound_principal_orbits_continue() -> None:
    """At 0.9999 of the bound orbits of tops with n = 4 and 6 run, and are known to; no other ones are."""
    rng = np.random.default_rng(2)
    for k, sigma in ((3, 0.33), (5, 0.45), (3, 0.5001)):
        b, c = _body(k, sigma, rng)
        top = nh.discretize(_top(b, c, rng), H)
        known = nh.critical_energies(top)
        assert known.regular == (sigma < 0.5)
        level = 0.9999 * (known.fold or 0.5 * b[0] / (2 * H * H))
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
    known = nh.critical_energies(nh.discretize(broad, H))
    assert known.fold == pytest.approx(3.0 / (2 * H * H), rel=1e-14)
