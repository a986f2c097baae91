"""Regions of the branches of a top with n = 3: against the energies and the ridge that define them."""

import numpy as np
import pytest

import nonholo as nh

_REGULAR = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
_AXIS = nh.SuslovTop.from_inertia(np.diag([3.0, 2.0, 2.5]) + 0.2, (0.6, 0, 0.8))
_BALANCED = nh.SuslovTop(np.diag([1.0, 1.5, 0.5]))
_TOPS = {"canonical": _REGULAR, "another axis": _AXIS, "balanced": _BALANCED}


def _direction(discrete: nh.Discretization) -> np.ndarray:
    """Return the momentum that has energy one in a direction that is not special."""
    r = np.array([0.6, -0.4])
    return r / np.sqrt(discrete.system.constrained_energy(r))


def _beyond_ridge(discrete: nh.Discretization, W: np.ndarray) -> bool:
    r"""Tell whether $\varrho > 1/(2\kappa)$ from the half-turn vector of a displacement."""
    top, frame = discrete.system.canonical, discrete.system.frame
    square = (np.eye(2) - (frame.T @ W @ frame)[:2, :2]) / 2  # z z^T
    rho, u = np.trace(square), np.linalg.eigh(square)[1][:, 1]
    sigma = top.coupling @ [-u[1], u[0]]
    return bool(rho > 1 / (2 * (1 - sigma**2 / np.linalg.det(top.constrained_inertia))))


@pytest.mark.parametrize("top", _TOPS.values(), ids=_TOPS)
@pytest.mark.parametrize("part", [0.01, 0.3, 0.9, 0.999])
def test_below_the_saddle_one_branch_is_inner(top: nh.SuslovTop, part: float) -> None:
    """For D >= 3|c|^2 exactly one real branch below h*, the principal one, lies before the ridge, others beyond it."""
    discrete = nh.discretize(top, 0.5)
    result = nh.displacements_over(
        discrete, np.sqrt(part * nh.critical_energies(discrete).saddle) * _direction(discrete)
    )
    real = result.displacement[result.is_real].real
    expected = ["outer" if _beyond_ridge(discrete, W) else "inner" for W in real]
    assert result.region[result.is_real].tolist() == expected
    assert expected.count("inner") == 1
    assert result.region[result.principal] == "inner"
    assert set(result.region[~result.is_real]) <= {""}


def test_between_the_saddle_and_the_center() -> None:
    """From h* to h** the region is "between", wherever the displacement lies."""
    discrete = nh.discretize(_REGULAR, 0.5)
    critical = nh.critical_energies(discrete)
    center = next(p for p in critical.points if p.kind == "maximum")
    for part in (0.5, 0.99):
        z = part * center.half_turn_vector + (1 - part) * np.array([0.01, 0.0])
        W = discrete.system.group.exp(
            2 * np.arcsin(np.linalg.norm(z)) / np.linalg.norm(z) * z @ _REGULAR.constraint_subspace
        )
        result = nh.displacements_over(discrete, discrete.system.restrict(nh.discrete_legendre(discrete, W)))
        between = critical.saddle < result.energy < critical.center
        assert between == (part == 0.99)
        assert ("between" in result.region) == between


_WITHOUT = {
    "rod-like top": (nh.SuslovTop(np.outer([1.0, 0.2, 0.9], [1.0, 0.2, 0.9]) + 0.02 * np.eye(3)), [0.01, 0.02]),
    "SO(4)": (nh.SuslovTop(np.diag([1.0, 1.5, 2.0, 0.5])), [0.1, 0.2, 0.3]),
    "sleigh": (nh.ChaplyginSleigh(1.0, 1.0, 0.5), [0.1, 0.2]),
}


@pytest.mark.parametrize(("system", "r"), _WITHOUT.values(), ids=_WITHOUT)
def test_no_regions_elsewhere(system: object, r: list[float]) -> None:
    """In the other regime, in other dimensions and for sleighs there are values but no regions."""
    result = nh.displacements_over(nh.discretize(system, 0.5), r)
    assert result.is_real.any()
    assert set(result.region) == {""}
