"""Certified branches: enclosures against 40-digit roots, exact counts at folds, agreement with numerical branches."""

import sys

import mpmath
import numpy as np
import pytest
from scripts import script
from sturm import assert_counted

import nonholo as nh
from nonholo.discrete import Discretization

_TENSOR = np.array([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
_TURNED = nh.SuslovTop.from_inertia(np.diag([3.0, 2.0, 2.5]) + 0.2, (0.6, 0, 0.8))
_ENCLOSED = {
    "top": (nh.discretize(nh.SuslovTop(_TENSOR), 0.5), [0.4, 0.7]),
    "top on SO(4)": (nh.discretize(nh.SuslovTop(np.diag([1.0, 1.2, 2.0, 0.7]) + 0.1), 0.5), [0.4, 0.7, -0.3]),
    "sleigh": (nh.discretize(nh.ChaplyginSleigh(1.5, 1.2, -0.4), 0.5), [0.8, -0.3]),
    "sleigh on SE(3)": (
        nh.discretize(nh.MultidimensionalSleigh(1.3, [0.3, 0.2, -0.1], _TENSOR), 0.7),
        [0.3, -0.4, 0.6],
    ),
}


def _exact(discrete: Discretization, r: list[float], W: np.ndarray) -> mpmath.matrix:
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


@pytest.mark.profile("problems", keep=["top", "sleigh"])
@pytest.mark.parametrize(("discrete", "r"), _ENCLOSED.values(), ids=_ENCLOSED)
def test_enclosures_hold_the_displacements(discrete: Discretization, r: list[float]) -> None:
    """Each 40-digit root of the matrix equations lies in its enclosure, which is a few roundings wide."""
    found = nh.displacements_over(discrete, r, certify=True)
    assert found.certified
    with mpmath.workdps(40):
        for W, radius in zip(found.displacement, found.radius, strict=True):
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
    found = nh.displacements_over(sleigh, [momentum, -1.0], certify=True)
    assert sorted(found.multiplicity, reverse=True) == multiplicity
    assert found.multiplicity[found.is_real].sum() == real


def test_all_values_of_the_map_are_certified() -> None:
    """`branches` certifies the values over the momentum that it computes; they and the principal one are the same."""
    discrete, r = _ENCLOSED["top"]
    certified, found = nh.branches(discrete, momentum=r, certify=True), nh.branches(discrete, momentum=r)
    assert certified.certified
    assert not found.certified
    assert found.radius is None
    assert certified.principal == found.principal
    assert certified.is_real.tolist() == found.is_real.tolist()
    assert certified.region.tolist() == found.region.tolist()
    np.testing.assert_allclose(certified.fold_distance, found.fold_distance, rtol=1e-10)  # well away from a fold
    missed = np.abs(certified.displacement - found.displacement).max(axis=(1, 2))
    assert (missed <= certified.radius + 1e-13 * np.abs(found.displacement).max(axis=(1, 2))).all()


def test_a_turned_frame_widens_the_radius_only() -> None:
    """In a user's frame the certificate is the same up to the rounding of the turn."""
    discrete = nh.discretize(_TURNED, 0.5)
    certified, found = (nh.displacements_over(discrete, [1.0, 2.0], certify=choice) for choice in (True, False))
    assert certified.certified
    np.testing.assert_allclose(certified.displacement, found.displacement, rtol=0, atol=1e-13)
    assert certified.radius.max() < 1e-13


def test_what_is_not_decided_is_said() -> None:
    """Where the exact method has no answer the numerical branches come with the reason, not with a certificate."""
    J = np.diag([1.0, 1.5, 2.2, 0.3])
    J[0, 3] = J[3, 0] = 0.4  # r = c along a principal axis
    found = nh.displacements_over(nh.discretize(nh.SuslovTop(J), 1.0), [0.8, 0.0, 0.0], certify=True)
    assert not found.certified
    assert found.radius is None
    assert "equals the coupling" in found.uncertified
    assert len(found) > 0


def test_a_certificate_without_the_extra_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without python-flint the error names the extra."""
    monkeypatch.delitem(sys.modules, "nonholo.discrete.certificate", raising=False)
    monkeypatch.delitem(sys.modules, "nonholo.discrete.certificate._certificate", raising=False)
    monkeypatch.setitem(sys.modules, "flint", None)
    with pytest.raises(ValueError, match=r"must have the extra `certify`.*nonholo\[certify\]"):
        nh.displacements_over(*_ENCLOSED["top"], certify=True)
