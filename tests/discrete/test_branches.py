"""All values of the discrete map: against the definition on matrices, 50-digit references, and special cases."""

import json
from pathlib import Path

import numpy as np
import pytest
from comparisons import derivatives
from refusals import refusals
from scipy.optimize import brentq
from sturm import assert_counted

import nonholo as nh
from nonholo.discrete import Branches, Discretization

_GOLDEN = json.loads((Path(__file__).parents[1] / "golden" / "branches.json").read_text(encoding="utf-8"))
_DEFINITION = 1e-12  # relative to the products of matrix entries, which are what rounding sees
_SYSTEMS = {"top": nh.SuslovTop, "sleigh": nh.ChaplyginSleigh, "motion": nh.MultidimensionalSleigh}


def _top(B: object, c: object, time_step: float = 1.0) -> Discretization:
    """Build the top with given constrained inertia and coupling."""
    B, k = np.asarray(B, dtype=float), len(np.asarray(c))
    J = np.zeros((k + 1, k + 1))
    J[:k, :k], J[k, k], J[k, :k], J[:k, k] = B - 0.3 * np.eye(k), 0.3, c, c
    return nh.discretize(nh.SuslovTop(J), time_step)


def _sleigh(a: float, b: float = 0.0) -> Discretization:
    return nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, a, b), 1.0)


def _motion(center_of_mass: list[float], mass_tensor: object) -> Discretization:
    return nh.discretize(nh.MultidimensionalSleigh(1.3, center_of_mass, mass_tensor), 0.7)


def _at(pi: float, phat: float, a: float = 0.5) -> list[float]:
    """Return the momenta of `_sleigh(a)` at a point of the plane of the deltoid."""
    return [pi, (phat - 2 * a * a) / a]


def _check_definition(discrete: Discretization, result: Branches, r: object) -> None:
    """Check group, variety and momentum of every displacement, straight from matrices."""
    system, group = discrete.system, discrete.system.group
    n = len(group.identity) - (0 if np.any(group.basis[:, -1]) else 1)
    tensor = system.homogeneous_mass_tensor / np.abs(system.homogeneous_mass_tensor).max()
    rows = np.einsum("ki,iab->kab", system.constraint_subspace, group.basis)
    for W in result.displacement:
        size = max(1.0, np.abs(W).max()) ** 2
        R, inverse = W[:n, :n], np.linalg.inv(W)
        assert np.abs(R @ R.T - np.eye(n)).max() <= _DEFINITION * size
        assert np.array_equal(W[n:], group.identity[n:])
        forbidden = group.vee((W - inverse) / 2) @ system.annihilator.T
        assert np.abs(forbidden).max() <= _DEFINITION * size
        paired = np.einsum("kab,bc,ac->k", rows, tensor, W - group.identity)
        wanted = discrete.time_step * np.asarray(r) / np.abs(system.homogeneous_mass_tensor).max()
        assert np.abs(paired - wanted).max() <= _DEFINITION * size
        cosine = (np.trace(R) - n) / 2 + 1  # of the angle, in the one plane that turns
        sine_squared = -np.trace((R - R.T) @ (R - R.T)) / 8
        assert cosine**2 + sine_squared == pytest.approx(1, abs=1e-9 * size)


def _reference(case: dict) -> tuple[Discretization, np.ndarray]:
    """Return the discretized system of a case and its displacements from their Cayley coordinates."""
    discrete = nh.discretize(_SYSTEMS[case["system"]](**case["parameters"]), case["time_step"])
    y = np.array(case["roots"]) @ [1, 1j]
    Y = np.einsum("mi,ij,jab->mab", y, discrete.system.constraint_subspace, discrete.system.group.basis)
    eye = discrete.system.group.identity
    return discrete, np.linalg.solve(eye - Y, eye + Y)


@pytest.mark.parametrize("certify", [False, True], ids=["numerical", "certified"])
@pytest.mark.parametrize("case", _GOLDEN, ids=lambda case: f"{case['system']} {len(case['momentum'])}")
def test_against_fifty_digits(case: dict, certify: bool) -> None:
    """Every displacement is found, once, and equals its 50-digit value; none is invented."""
    discrete, reference = _reference(case)
    result = nh.displacements_over(discrete, case["momentum"], certify)
    assert result.certified == certify
    assert result.multiplicity.tolist() == [1] * len(reference)
    left = list(reference)
    for W in result.displacement:
        missed = [np.abs(W - other).max() / max(1.0, np.abs(other).max()) for other in left]
        assert min(missed) < 1e-10
        left.pop(int(np.argmin(missed)))
    real = np.abs(reference.imag).max(axis=(1, 2)) < 1e-12
    assert result.is_real.sum() == real.sum()


_DEFINED = {
    "top": (_top([[1.0, 0.2], [0.2, 1.5]], [0.3, -0.2], 0.5), [0.4, 0.7]),
    "tilted top": (nh.discretize(nh.SuslovTop.from_inertia(np.diag([3, 2, 2.5]) + 0.2, (0.6, 0, 0.8)), 0.5), [1, 2]),
    "top on SO(5)": (_top(np.diag([1.0, 1.2, 2.0, 2.5]), [0.3, -0.2, 0.1, 0.4]), [0.4, 0.7, -0.3, 1.0]),
    "sleigh with b": (_sleigh(-0.4, 0.3), [0.8, -0.3]),
    "sleigh on SE(3)": (_motion([0.3, 0.2, -0.1], np.diag([0.5, 0.7, 0.4]) + 0.1), [0.3, -0.4, 0.6]),
    "sleigh on SE(4)": (_motion([0.3, 0.2, -0.1, 0.4], np.diag([0.5, 0.7, 0.4, 0.3]) + 0.1), [0.3, -0.4, 0.6, 0.2]),
}


@pytest.mark.parametrize(("discrete", "r"), _DEFINED.values(), ids=_DEFINED)
def test_definition(discrete: Discretization, r: list[float]) -> None:
    """Each displacement is in the complex group, on the variety, in one plane of rotation, and has the momentum.

    The momenta of real ones are what `discrete_legendre` says, and share the given components and energy.
    """
    result, system = nh.displacements_over(discrete, r), discrete.system
    _check_definition(discrete, result, r)
    k = len(r)
    assert result.multiplicity.sum() == (2 * k if isinstance(system, nh.SuslovTop) else 2 * k - 1)
    for W, P in zip(result.displacement[result.is_real].real, result.momentum[result.is_real], strict=True):
        expected = nh.discrete_legendre(discrete, W)
        np.testing.assert_allclose(P, expected, rtol=0, atol=1e-12 * np.abs(expected).max() * np.abs(W).max() ** 2)
        assert system.constrained_energy(system.restrict(P.real)) == pytest.approx(result.energy, rel=1e-11)


_SPECIAL_B = np.diag([1.0, 1.5, 2.2])
_SPECIAL = {
    "c and r vanish along an axis": (_top(_SPECIAL_B, [0.3, 0, 0.2]), [0.4, 0, -0.3], 6),
    "c and r almost vanish along an axis": (_top(_SPECIAL_B, [0.3, 1e-9, 0.2]), [0.4, 1e-9, -0.3], 6),
    "c vanishes along an axis": (_top(_SPECIAL_B, [0.3, 0, 0.2]), [0.4, 0.1, -0.3], 6),
    "r vanishes along an axis": (_top(_SPECIAL_B, [0.3, 0.1, 0.2]), [0.4, 0, -0.3], 6),
    "c and r along one axis": (_top(_SPECIAL_B, [0.3, 0, 0]), [0.4, 0, 0], 6),
    "round, n = 3": (_top(1.3 * np.eye(2), [0.3, 0.1]), [0.4, 0.3], 4),
    "round, n = 4": (_top(1.3 * np.eye(3), [0.3, 0.1, 0.2]), [0.4, 0.3, -0.3], 4),
    "c = 0": (_top(_SPECIAL_B, [0, 0, 0]), [0.4, 0.3, -0.3], 2),
    "c = 0, r = 0": (_top(_SPECIAL_B, [0, 0, 0]), [0.0, 0.0, 0.0], 1),
    "r = 0": (_top(_SPECIAL_B, [0.3, 0.1, 0.2]), [0.0, 0.0, 0.0], 6),
    "r = c, n = 3": (_top(_SPECIAL_B[:2, :2], [0.3, 0.1]), [0.6, 0.2], 4),
    "r = c, n = 4": (_top(_SPECIAL_B, [0.3, 0.1, 0.2]), [0.6, 0.2, 0.4], 4),
    "r parallel c": (_top(_SPECIAL_B, [0.3, 0.1, 0.2]), [0.09, 0.03, 0.06], 6),
    "sleigh, half-turn": (_sleigh(0.5), _at(0.8, 0.0), 3),
    "sleigh, pi = 0": (_sleigh(0.5), _at(0.0, 0.7), 3),
    "sleigh at rest": (_sleigh(0.5), [0.0, 0.0], 3),
    "a half-turn of a top": (_top(np.diag([1.0, 1.5]), [0.3, 0.1]), [0.312, 0.416], 4),  # r.(r - c) = 0
    "momentum of the coupling": (_top(np.diag([1.0, 1.5]), [0.5, 0.25]), [1.0, 0.5], 4),
    "all equal and aligned": (_top(1.5 * np.eye(3), [0.5, 0, 0]), [0.4, 0, 0], 2),
    "balanced sleigh": (_sleigh(0.0), [0.3, 0.2], 2),
    "balanced sleigh, straight": (_sleigh(0.0), [0.0, 0.2], 1),
    "SE(3), c = 0": (_motion([0.3, 0.2, 0.1], np.diag([0.5, 0.7, 0.4])), [0.3, 0.2, 0.1], 5),
    "SE(3), c and r vanish along an axis": (_motion([0.3, 0, 0], np.diag([0.5, 0.7, 0.4])), [0.3, 0, 0.1], 5),
    "SE(3), a1 = 0": (_motion([0, 0.2, 0.1], np.diag([0.5, 0.7, 0.4]) + 0.1), [0.3, 0.2, 0.1], 4),
}


@pytest.mark.parametrize("certify", [False, True], ids=["numerical", "certified"])
@pytest.mark.parametrize(("discrete", "r", "count"), _SPECIAL.values(), ids=_SPECIAL)
def test_special_bodies_and_momenta(discrete: Discretization, r: list[float], count: int, certify: bool) -> None:
    """Where the secular polynomial degenerates the isolated roots are still all found, each once, and certified."""
    result = nh.displacements_over(discrete, r, certify)
    assert result.certified == certify
    _check_definition(discrete, result, r)
    assert result.multiplicity.tolist() == [1] * count
    if certify:
        assert_counted(discrete, r)


_HIDDEN = nh.MultidimensionalSleigh(1.0, [-0.5, 0, 0], [[3, 0, 0.5], [0, 2, 0], [0.5, 0, 1]])
_MULTIPLE = {  # of the first the secular polynomial hides two beside the double half-turn
    "two roots hidden beside a half-turn": (
        nh.discretize(_HIDDEN, 1.0),
        [0, 0, 1],
        [1, 2, 1, 1],
        [True, True, False, False],
    ),
    "a cusp of the deltoid": (_sleigh(0.5), _at(0.0, -2.0), [3], [True]),
    "fold of a balanced top": (nh.discretize(nh.SuslovTop(np.diag([0.75, 0.75, 0.25])), 1.0), [1.0, 0.0], [2], [True]),
}


@pytest.mark.parametrize("certify", [False, True], ids=["numerical", "certified"])
@pytest.mark.parametrize("name", _MULTIPLE)
def test_multiple_values(name: str, certify: bool) -> None:
    """Values that are one are counted as often as they are, and no others are taken for copies of them."""
    discrete, r, multiplicity, real = _MULTIPLE[name]
    result = nh.displacements_over(discrete, r, certify)
    assert result.multiplicity.tolist() == multiplicity
    assert result.is_real.tolist() == real
    if certify:
        assert_counted(discrete, r)


def test_a_fold_of_a_top_counts_twice() -> None:
    """At a momentum on the fold two roots are one of multiplicity two, at fold distance zero."""
    discrete, ray = _top(np.diag([1.0, 1.5]), [0.3, -0.2]), np.array([0.6, 0.8])
    rows, group = discrete.system.constraint_subspace, discrete.system.group

    def momentum(x: np.ndarray) -> np.ndarray:
        return discrete.system.restrict(nh.discrete_legendre(discrete, group.exp(x @ rows)))

    size = brentq(lambda size: np.linalg.det(derivatives(momentum, size * ray)), 0.1, 2.5, xtol=1e-14)
    folded = group.exp(size * ray @ rows)
    assert nh.fold_distance(discrete, folded) < 1e-8  # of difference quotients
    result = nh.displacements_over(discrete, momentum(size * ray))
    assert sorted(result.multiplicity) == [1, 1, 2]
    double = int(np.argmax(result.multiplicity))
    assert result.is_real[double]
    np.testing.assert_allclose(result.displacement[double], folded, atol=1e-6)  # square root of rounding
    assert result.fold_distance[double] < 1e-6


@pytest.mark.parametrize("t", [0.2, 0.7, -1.1, 2.5])
def test_the_deltoid_is_the_fold_of_the_sleigh(t: float) -> None:
    """On the deltoid two of the sleigh's three branches meet."""
    pi, phat = 4 * t**3 / (1 + t * t) ** 2, -2 * (1 - t * t) / (1 + t * t) ** 2
    result = nh.displacements_over(_sleigh(0.5), _at(pi, phat))
    assert sorted(result.multiplicity) == [1, 2]
    assert result.is_real.all()
    assert result.fold_distance[np.argmax(result.multiplicity)] < 1e-6


@pytest.mark.parametrize("off", [1e-15, -1e-13, 1e-13, -1e-11, 1e-9, -1e-6])
@pytest.mark.parametrize("t", [1.2, -0.05])
def test_no_branch_is_lost_near_a_fold(t: float, off: float) -> None:
    """However close to the deltoid, three branches are counted and keep the sum rule to the root of rounding."""
    pi, phat = 4 * t**3 / (1 + t * t) ** 2, -2 * (1 - t * t) / (1 + t * t) ** 2 + off
    result = nh.displacements_over(_sleigh(0.5), _at(pi, phat))
    turns = result.displacement[:, 0, 0] + 1j * result.displacement[:, 1, 0]
    assert result.multiplicity.sum() == 3
    assert (turns * result.multiplicity).sum() == pytest.approx(-(2 * phat + 1) + 2j * pi, abs=1e-6)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_three_branches_meet_at_a_cusp(sign: float) -> None:
    """At the upper cusps of the deltoid the root is triple, too."""
    result = nh.displacements_over(_sleigh(0.5), _at(sign * 3 * np.sqrt(3) / 4, 0.25))
    assert result.multiplicity.tolist() == [3]
    assert result.is_real.all()


def test_sum_rule_of_the_map_of_random_sleighs() -> None:
    """The values of the map obey the sum rule inside the deltoid, where all are real, and outside, where one is."""
    rng = np.random.default_rng(2)
    counts = []
    for _ in range(60):
        m, J, a, b = *rng.uniform(0.3, 2.0, 2), *rng.normal(0, 0.5, 2)
        sleigh = nh.discretize(nh.ChaplyginSleigh(m, J, a, b), 1.0)
        W = nh.SE(2).exp(rng.normal(size=2) @ sleigh.system.constraint_subspace)
        r = sleigh.system.restrict(nh.discrete_legendre(sleigh, W, "right"))
        result = nh.branches(sleigh, displacement=W)
        turns = result.displacement[:, 0, 0] + 1j * result.displacement[:, 1, 0]
        kappa = (-(2 * (a * r[1] + 2 * m * a * a) + J) + 2j * (r[0] + b * r[1])) / J
        size = np.abs(turns).max() ** 2  # of complex turns, which rounding and the product see
        assert np.prod(turns) == pytest.approx(1, abs=1e-12 * size)
        assert turns.sum() == pytest.approx(kappa, abs=1e-12 * size)
        counts.append(int(result.is_real.sum()))
    assert set(counts) == {1, 3}


@pytest.mark.parametrize(("discrete", "r"), _DEFINED.values(), ids=_DEFINED)
def test_the_principal_branch_is_that_of_a_run(discrete: Discretization, r: list[float]) -> None:
    """`principal` names the displacement at which a run with this momentum starts, and the next one."""
    r = 0.2 * np.array(r)
    orbit = nh.simulate(discrete, momentum=r, steps=1)
    here, after = nh.displacements_over(discrete, r), nh.branches(discrete, momentum=r)
    np.testing.assert_allclose(here.displacement[here.principal], orbit.displacement[0], atol=1e-11)
    np.testing.assert_allclose(after.displacement[after.principal], orbit.displacement[1], atol=1e-11)
    same = nh.branches(discrete, displacement=orbit.displacement[0])
    np.testing.assert_allclose(same.displacement, after.displacement, atol=1e-8 * np.abs(after.displacement).max())


def test_no_principal_branch_beyond_the_fold() -> None:
    """A momentum that the principal branch does not reach has values, but no principal one."""
    result = nh.displacements_over(_top(np.diag([1.0, 1.5]), [0.3, -0.2]), [6.0, 5.0])
    assert result.multiplicity.sum() == 4
    assert result.principal is None
    with pytest.raises(ValueError, match="must have a principal displacement"):
        nh.branches(_top(np.diag([1.0, 1.5]), [0.3, -0.2]), momentum=[6.0, 5.0])


def test_values_all_too_far_away_are_none() -> None:
    """Doubles hold no displacement of a sleigh in space over a momentum of 1e100: none is left, all are missing."""
    result = nh.displacements_over(_DEFINED["sleigh on SE(3)"][0], [3e99, 2e99, -4e99])
    assert (len(result.is_real), result.real_count, result.missing, result.principal) == (0, 0, 5, None)


@pytest.mark.parametrize(("discrete", "r"), _DEFINED.values(), ids=_DEFINED)
def test_inverse_legendre(discrete: Discretization, r: list[float]) -> None:
    """The displacement of a momentum is recovered, on every branch, none of momentum zero; off the locus is refused."""
    result, group = nh.displacements_over(discrete, r), discrete.system.group
    still = nh.inverse_discrete_legendre(discrete, np.zeros(group.dim))
    np.testing.assert_allclose(still, group.identity, atol=1e-14)
    for W in result.displacement[result.is_real].real:
        P = nh.discrete_legendre(discrete, W)
        np.testing.assert_allclose(nh.inverse_discrete_legendre(discrete, P), W, atol=1e-8 * np.abs(W).max())
    off = nh.discrete_legendre(discrete, W) + 0.1 * discrete.system.annihilator[0]
    with pytest.raises(ValueError, match=r"must lie on the momentum locus. Got (distance|components)"):
        nh.inverse_discrete_legendre(discrete, off)


_KNOWN = "must have a mass tensor, a constraint fixed in the body, difference 'matrix'"
_OFF = "must lie on the displacement variety"
_SPURIOUS = np.array([[-1.0, 0, 0.4], [0, -1.0, 0.3], [0, 0, 1.0]])  # a half-turn with (W - W^-1)/2 in d
_SLEIGH = nh.ChaplyginSleigh(1.0, 1.0, 0.5)
# Where not all values are known, and where a start is missing or off the variety, the error says why.
test_what_has_no_values_is_refused = refusals(
    (lambda: nh.displacements_over(nh.discretize(nh.VeselovaTop(np.diag([1.0, 2.0, 3.0])), 0.1), [0.1, 0.2]), _KNOWN),
    (lambda: nh.displacements_over(nh.discretize(_SLEIGH, 0.1, "logarithmic"), [0.1, 0.2]), _KNOWN),
    (lambda: nh.displacements_over(nh.discretize(_SLEIGH, 0.1, constraint="naive"), [0.1, 0.2]), _KNOWN),
    (lambda: nh.branches(_sleigh(0.5)), r"must be given exactly one of momentum, displacement\. Got none"),
    (lambda: nh.fold_distance(_sleigh(0.5), nh.SE(2).exp(np.array([0.1, 0.2, 0.3]))), _OFF),
    (lambda: nh.branches(_sleigh(0.5), displacement=_SPURIOUS), _OFF),
)
