"""Certified branches and counts: enclosures against 40-digit roots, exact counts at folds, discs beside Sturm."""

import functools
import sys
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from bodies import random_rows
from flint import acb, ctx, fmpq_mat, fmpz, fmpz_mat, fmpz_poly
from scripts import script
from sturm import assert_counted, real_roots

import nonholo as nh
from nonholo.discrete.certificate import _roots as certificate_roots
from nonholo.discrete.certificate._certificate import _secular
from nonholo.discrete.certificate._roots import Problem, isolate, sharpen
from nonholo.discrete.routes import make_route
from nonholo.groups import AbstractMatrixGroup
from nonholo.kernels import GeneralBody
from nonholo.kernels.general._step import displace, workspace
from nonholo.kernels.general.run import is_certain, newton, principal

_TENSOR = np.array([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
_TURNED = nh.SuslovTop.from_inertia(np.diag([3.0, 2.0, 2.5]) + 0.2, (0.6, 0, 0.8))
_ENCLOSED = {
    "top": (nh.discretize(nh.SuslovTop(_TENSOR), 0.5), [0.4, 0.7]),
    "arrowhead": (nh.discretize(nh.SuslovTop.arrowhead([1.0, 1.2, 2.0, 0.7], [0.1, 0.2, -0.1]), 0.5), [0.4, 0.7, -0.3]),
    "sleigh": (nh.discretize(nh.ChaplyginSleigh(1.5, 1.2, -0.4), 0.5), [0.8, -0.3]),
    "sleigh on SE(3)": (
        nh.discretize(nh.MultidimensionalSleigh(1.3, [0.3, 0.2, -0.1], _TENSOR), 0.7),
        [0.3, -0.4, 0.6],
    ),
}


def _exact(discrete: nh.Discretization, r: list[float], W: np.ndarray) -> mpmath.matrix:
    """Return the displacement near W whose momentum is r, by Newton's method on matrices of 40 digits."""
    system, group = discrete.system, discrete.system.group
    eye = mpmath.matrix(group.identity.tolist())
    rows = [mpmath.matrix(np.tensordot(row, group.basis, 1).tolist()) for row in system.constraint_subspace]
    tensor = mpmath.matrix(system.homogeneous_mass_tensor.tolist())

    def displaced(y: tuple) -> mpmath.matrix:
        Y = sum((x * row for x, row in zip(y, rows, strict=True)), 0 * eye)
        return mpmath.inverse(eye - Y) * (eye + Y)

    def defect(*y: mpmath.mpc) -> list:
        pull = tensor * (displaced(y) - eye).T
        return [
            sum(row[i, j] * pull[j, i] for i in range(eye.rows) for j in range(eye.rows)) - discrete.time_step * x
            for row, x in zip(rows, r, strict=True)
        ]

    halves = np.linalg.solve(W + group.identity, W - group.identity)
    start = group.vee(halves.real) + 1j * group.vee(halves.imag)
    start = np.linalg.lstsq(system.constraint_subspace.T, start, rcond=None)[0]
    return displaced(tuple(mpmath.findroot(defect, [mpmath.mpc(x) for x in start], tol=1e-60)))


@pytest.mark.profile("problems", keep=["top", "arrowhead", "sleigh"])
@pytest.mark.parametrize(("discrete", "r"), _ENCLOSED.values(), ids=_ENCLOSED)
def test_enclosures_hold_the_displacements(discrete: nh.Discretization, r: list[float]) -> None:
    """Each 40-digit root of the matrix equations lies in its enclosure, which is a few roundings wide."""
    result = nh.displacements_over(discrete, r, certify=True)
    assert result.certified
    with mpmath.workdps(40):
        for W, radius in zip(result.displacement, result.radius, strict=True):
            exact = _exact(discrete, r, W)
            missed = max(abs(exact[i, j] - complex(W[i, j])) for i in range(len(W)) for j in range(len(W)))
            assert missed <= radius
            assert radius <= 32 * np.finfo(float).eps * (1 + np.abs(W).max())


@pytest.mark.profile("problems", keep=["top 3", "sleigh*"])
@pytest.mark.parametrize("kind", ["top 3", "sleigh", "top 4", "top 6", "sleigh SE(3)"])
def test_random_problems_are_certified_and_agree(kind: str) -> None:
    """All of 60 random problems are certified; further than 1e-11 from a fold values, counts and reality agree.

    Closer than that two roots differ by about the root of rounding, and the numerical branches are one double root.
    """
    module, rng = script("benchmarks/certified_branches.py"), np.random.default_rng(7)
    for _ in range(60):
        discrete = module.random_body(rng, kind)
        r, off = module.random_momentum(rng, discrete)
        certified = nh.displacements_over(discrete, r, certify=True)
        assert certified.certified
        if off > 1e-11:
            assert module.disagreement(certified, nh.displacements_over(discrete, r)) == ""


@pytest.mark.profile("problems", cases=["top 6"])
@pytest.mark.parametrize("kind", ["top 3", "sleigh", "top 4", "top 6", "sleigh SE(3)"])
def test_random_counts_are_exact(kind: str) -> None:
    """For 40 random problems, some of them nearly on a fold, the real values are as many as Sturm's theorem says."""
    module, rng = script("benchmarks/certified_branches.py"), np.random.default_rng(8)
    for _ in range(40):
        discrete = module.random_body(rng, kind)
        assert_counted(discrete, module.random_momentum(rng, discrete)[0])


@pytest.mark.parametrize(
    ("momentum", "multiplicity", "real"),
    [(1.0, [2, 1], 3), (np.nextafter(1.0, 0.0), [1, 1, 1], 3), (np.nextafter(1.0, 2.0), [1, 1, 1], 1)],
    ids=["on the fold", "one rounding inside", "one rounding outside"],
)
def test_a_fold_is_decided_exactly(momentum: float, multiplicity: list[int], real: int) -> None:
    """On the deltoid at t = 1 two branches are one; one rounding to either side they are two, real or complex."""
    sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 1.0)
    result = nh.displacements_over(sleigh, [momentum, -1.0], certify=True)
    assert sorted(result.multiplicity, reverse=True) == multiplicity
    assert result.multiplicity[result.is_real].sum() == real


def test_all_values_of_the_map_are_certified() -> None:
    """`branches` certifies the values over the momentum that it computes; they and the principal one are the same."""
    discrete, r = _ENCLOSED["top"]
    certified, result = nh.branches(discrete, momentum=r, certify=True), nh.branches(discrete, momentum=r)
    assert certified.certified
    assert not result.certified
    assert result.radius is None
    assert certified.principal == result.principal
    assert certified.is_real.tolist() == result.is_real.tolist()
    assert certified.region.tolist() == result.region.tolist()
    np.testing.assert_allclose(certified.fold_distance, result.fold_distance, rtol=1e-10)  # well away from a fold
    missed = np.abs(certified.displacement - result.displacement).max(axis=(1, 2))
    assert (missed <= certified.radius + 1e-13 * np.abs(result.displacement).max(axis=(1, 2))).all()


def test_a_turned_frame_widens_the_radius_only() -> None:
    """In a user's frame the certificate is the same up to the rounding of the turn."""
    discrete = nh.discretize(_TURNED, 0.5)
    certified, result = (nh.displacements_over(discrete, [1.0, 2.0], certify=choice) for choice in (True, False))
    assert certified.certified
    np.testing.assert_allclose(certified.displacement, result.displacement, rtol=0, atol=1e-13)
    assert certified.radius.max() < 1e-13


def test_what_is_not_decided_is_said() -> None:
    """Where the exact method has no answer the numerical branches come with the reason, not with a certificate."""
    J = np.diag([1.0, 1.5, 2.2, 0.3])
    J[0, 3] = J[3, 0] = 0.4  # r = c along a principal axis
    result = nh.displacements_over(nh.discretize(nh.SuslovTop(J), 1.0), [0.8, 0.0, 0.0], certify=True)
    assert not result.certified
    assert result.radius is None
    assert "equals the coupling" in result.uncertified
    assert len(result) > 0


def test_a_certificate_without_the_extra_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without python-flint the error names the extra."""
    monkeypatch.delitem(sys.modules, "nonholo.discrete.certificate", raising=False)
    monkeypatch.delitem(sys.modules, "nonholo.discrete.certificate._certificate", raising=False)
    monkeypatch.setitem(sys.modules, "flint", None)
    with pytest.raises(ValueError, match=r"must have the extra `certify`.*nonholo\[certify\]"):
        nh.displacements_over(*_ENCLOSED["top"], certify=True)


_X = fmpz_poly([0, 1])
_HUGE = fmpz(10) ** 40


def _with_roots(*roots: str) -> fmpz_poly:
    """Return the polynomial with given rational roots."""
    result = fmpz_poly([1])
    for root in map(Fraction, roots):
        result *= fmpz_poly([-root.numerator, root.denominator])
    return result


_POLYNOMIALS = {
    "one root": _with_roots("3/7"),
    "a root zero": _X * (_X * _X + 1),
    "far apart": _with_roots("1/100000000000000000000", "-3", "500000000000000000000") * (_X * _X + _HUGE),
    "Wilkinson's": _with_roots(*map(str, range(1, 21))),
    "close real roots": _with_roots("1", "1000000001/1000000000", "3"),
    "real, 20 digits alike": _HUGE * (_X - 1) ** 2 * (_X - 3) + 1,
    "a pair, real to 20 digits": _HUGE * (_X - 1) ** 2 * (_X - 3) - 1,
    "Mignotte's, real": _X**7 - 2 * (1000 * _X - 1) ** 2,
    "Mignotte's, complex": _X**8 + 2 * (1000 * _X - 1) ** 2,
    "close complex pairs": _HUGE * (_X * _X + 1) ** 2 + _X,
    "three close roots": _HUGE * (_X - 1) ** 3 - _X,
    "leading coefficient below doubles": _X**3 - _HUGE**30 * _X**2 + _HUGE**31 * _X - 1,
}
_NEED_NO_SEARCH = ["one root", "far apart", "close real roots", "real, 20 digits alike", "a pair, real to 20 digits"]


@pytest.mark.parametrize("polynomial", _POLYNOMIALS.values(), ids=_POLYNOMIALS)
def test_balls_are_counted_by_sturm_and_hold_one_root_each(polynomial: fmpz_poly) -> None:
    """As many are real as Sturm's theorem says; each root of FLINT, to 600 bits, lies in one alone."""
    balls = isolate(polynomial)
    real = [x for x in balls if x.imag == 0]
    assert len(real) == real_roots(polynomial)
    assert 2 * len(balls) - len(real) == polynomial.degree()
    with ctx.workprec(600):
        roots = [acb(z) for z, _ in polynomial.complex_roots()]
        holders = [[i for i, x in enumerate(balls) if x.overlaps(z)] for z in roots if z.imag >= 0]
    assert sorted(holders) == [[i] for i in range(len(balls))]


@pytest.mark.parametrize("name", _NEED_NO_SEARCH)
def test_close_pairs_need_no_search(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The parabola at the middle of two close eigenvalues says whether they are real, and the discs prove it."""
    monkeypatch.setattr(certificate_roots, "_search", lambda *_: [])
    assert isolate(_POLYNOMIALS[name]) is not None


@pytest.mark.parametrize("name", ["one root", "close real roots", "Mignotte's, complex", "three close roots"])
def test_bad_guesses_cost_time_only(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without guesses the roots are searched, and counted the same."""
    polynomial = _POLYNOMIALS[name]
    monkeypatch.setattr(certificate_roots, "_guess", lambda _: [acb(1)] * polynomial.degree())
    balls = isolate(polynomial)
    assert sum(x.imag == 0 for x in balls) == real_roots(polynomial)


_CUBIC = (_X - 2) * (_X * _X + 1)
_BAD_CENTERS = {
    "a root missing": (_CUBIC, [acb(2)]),
    "a root three times": (_CUBIC, [acb(2), acb(2), acb(2)]),
    "a pair taken for real roots": (_CUBIC, [acb(2), acb(0.5), acb(-0.5)]),
    "both of a pair": (_CUBIC, [acb(2), acb(0, 1), acb(0, -1)]),
    "the lower one of a pair": (_CUBIC, [acb(2), acb(0, -1)]),
    "a real root as a pair": (_X * _X - 2, [acb(1.5, 0.1)]),
    "not a number": (3 * _X - 1, [acb("nan")]),
}


@pytest.mark.parametrize(("polynomial", "centers"), _BAD_CENTERS.values(), ids=_BAD_CENTERS)
def test_a_wrong_guess_is_refused(polynomial: fmpz_poly, centers: list[acb]) -> None:
    """Discs prove nothing unless they are disjoint, complete, finite, and those of pairs off the real axis."""
    assert sharpen(polynomial, centers, 128) is None


def test_rough_guesses_are_improved() -> None:
    """From guesses with one digit Newton's method finds balls that are small, and proves the same as from good ones."""
    balls = sharpen(_CUBIC, [acb(2.1), acb(0.1, 0.9)], 128)
    assert [x.imag == 0 for x in balls] == [True, False]
    assert all(x.rad() < 2.0**-60 for x in balls)


def test_a_double_root_is_refused() -> None:
    """Two discs at a double root are never disjoint: what is not square-free has no proof."""
    assert isolate((_X - 1) ** 2 * (_X + 3)) is None


@pytest.mark.parametrize("coupled", [True, False])
@pytest.mark.parametrize("k", [2, 3, 5, 7])
def test_secular_polynomials_are_those_of_their_definition(k: int, coupled: bool) -> None:
    r"""At more points than there are degrees, $\Delta$, N_1, N_2 and Y are what linear algebra says they are."""
    rng = np.random.default_rng(k)
    c, d = rng.integers(-99, 99, (2, k)) * [[coupled], [1]]
    spread = rng.integers(-9, 9, (k, k))
    B, half = (spread @ spread.T).tolist(), 7
    whole = [[fmpz(x) for x in row] for row in (c.tolist(), d.tolist())]
    determinant, _, *secular, Y = _secular(Problem(fmpz_mat(B), *whole, fmpz(half), None))
    for mu in range(1, 2 * k + 3):  # no eigenvalue of B is negative
        shifted = fmpz_mat([[x + mu * (i == j) for j, x in enumerate(row)] for i, row in enumerate(B)])
        sides = fmpz_mat([[int(x), int(y)] for x, y in zip(c, d, strict=True)])
        solved = (fmpq_mat(shifted).solve(fmpq_mat(sides)) * shifted.det()).numer_denom()[0].tolist()
        Ac, Ad = (np.array(column) for column in zip(*solved, strict=True))
        n1, n2 = shifted.det() * mu + c @ Ac, shifted.det() * half - c @ Ad
        assert (determinant(mu), *(row(mu) for row in secular)) == (shifted.det(), n1, n2)
        assert [y(mu) * shifted.det() for y in Y] == list(n1 * Ad + n2 * Ac)


GROUPS = [nh.SO(3), nh.SO(4), nh.SO(5), nh.SE(2), nh.SE(3)]
INSIDE = 1 - 1e-5  # a difference quotient with a step of 1e-5 radii stays in the ball


def _uneven_tensor(group: AbstractMatrixGroup, rng: np.random.Generator) -> np.ndarray:
    """Draw a mass tensor whose points and masses differ by up to three orders of magnitude."""
    N = group.identity.shape[0]
    points = rng.normal(size=(N + 1, N)) * 10.0 ** rng.uniform(-0.7, 0.7, size=N)
    if not np.any(group.basis[:, -1]):
        points[:, -1] = 1.0
    return (points.T * 10.0 ** rng.uniform(-1.5, 1.5, size=N + 1)) @ points


@functools.cache
def _bodies(index: int) -> list[tuple[nh.LLSystem, GeneralBody]]:
    """Return one body for each dimension of d, general subspaces and coordinate ones in turn."""
    group, rng, result = GROUPS[index], np.random.default_rng(index), []
    for k in range(1, group.dim + 1):
        chosen = np.sort(rng.choice(group.dim, k, replace=False))
        rows = np.eye(group.dim)[chosen] if k % 2 else random_rows(group, k, rng)
        system = nh.LLSystem(group, _uneven_tensor(group, rng), rows)
        result.append((system, make_route(nh.discretize(system, 1.0), "matrix").body))
    return result


def _root(body: GeneralBody) -> np.ndarray:
    """Return the Cholesky factor of the inertia along d, in the kernel's units."""
    return np.linalg.cholesky(np.linalg.inv(body.metric))


def _even_part(body: GeneralBody, root: np.ndarray, x: np.ndarray) -> np.ndarray:
    r"""Return $\phi(x)$ by its definition, with W = K + S found from the eigenvectors of the rotation part of K."""
    n, K = body.size, np.einsum("a,aij", np.linalg.solve(root.T, x), body.directions)
    values, vectors = np.linalg.eigh(1j * K[:n, :n])
    S = np.zeros_like(K)
    S[:n, :n] = ((vectors * (np.sqrt(1 - values**2) - 1)) @ vectors.conj().T).real
    if n < len(K):
        R = np.eye(n) + K[:n, :n] + S[:n, :n]
        S[:n, n] = (np.eye(n) - R.T) @ np.linalg.solve(np.eye(n) + R.T, K[:n, n])
    return np.linalg.solve(root, np.einsum("aij,jk,ik->a", body.directions, body.tensor, S))


def _momenta_on_the_level(body: GeneralBody, count: int, rng: np.random.Generator) -> np.ndarray:
    """Draw momenta just inside the largest norm that the certificate accepts."""
    m = rng.normal(size=(count, len(body.metric)))
    norms = np.sqrt(np.einsum("ia,ab,ib->i", m, body.metric, m))
    return m * (np.sqrt(body.level) * (1 - 1e-12) / norms)[:, None]


@pytest.mark.parametrize("index", range(len(GROUPS)), ids=map(str, GROUPS))
def test_the_lipschitz_constant_is_not_exceeded(index: int) -> None:
    """On the boundary of the ball the derivative of the even part stays below the constant in use."""
    rng = np.random.default_rng(20 + index)
    for _, body in _bodies(index):
        root, radius = _root(body), np.sqrt(body.radius)
        claimed = 1 - np.sqrt(body.level) / radius
        for x in rng.normal(size=(20, len(root))):
            x *= INSIDE * radius / np.linalg.norm(x)
            steps = 1e-5 * radius * np.eye(len(root))
            pairs = [(_even_part(body, root, x + e), _even_part(body, root, x - e)) for e in steps]
            slopes = np.array([ahead - behind for ahead, behind in pairs]) / (2e-5 * radius)
            assert np.linalg.norm(slopes, 2) <= claimed + 1e-9  # rounding of the quotients


@pytest.mark.profile("problems", keep=["SO(3)", "SE(2)"])
@pytest.mark.parametrize("index", range(len(GROUPS)), ids=map(str, GROUPS))
def test_roots_on_the_level_are_principal_and_certified(index: int) -> None:
    """For momenta at the level the followed root is the fixed point of the contraction, and it is certified."""
    rng = np.random.default_rng(30 + index)
    for system, body in _bodies(index):
        root = _root(body)
        for m in _momenta_on_the_level(body, 4, rng):
            x, target = np.zeros(len(m)), np.linalg.solve(root, m)
            for _ in range(300):
                x = target - _even_part(body, root, x)
            work = workspace(body)
            y = np.empty(len(body.stretch))
            assert principal(body, work, m, y) == 0
            assert is_certain(body, work, m, y)
            displace(body, work, y)
            X = work.X
            K = (X - (system.group.inverse(X + system.group.identity) - system.group.identity)) / 2
            fixed = np.einsum("a,aij", np.linalg.solve(root.T, x), body.directions)
            assert np.abs(K - fixed).max() <= 1e-9 * np.abs(fixed).max()


@pytest.mark.parametrize("index", range(len(GROUPS)), ids=map(str, GROUPS))
def test_no_other_root_is_certified(index: int) -> None:
    """Newton's method from far guesses finds other roots at the level; none of them gets the certificate."""
    rng, others = np.random.default_rng(40 + index), 0
    for _, body in _bodies(index):
        for m in _momenta_on_the_level(body, 3, rng):
            work = workspace(body)
            first = np.empty(len(body.stretch))
            principal(body, work, m, first)
            for y in 2.0 * rng.normal(size=(25, len(body.stretch))):
                good, _ = newton(body, work, 1.0, m, y)
                if good and np.abs(y - first).max() > 1e-6 * (1 + np.abs(first).max()):
                    others += 1
                    assert not is_certain(body, work, m, y)
    assert others >= 10  # otherwise nothing was tried
