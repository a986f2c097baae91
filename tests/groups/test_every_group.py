"""What every group must do beyond `check_group`, asked of all in tests/testing/test_our_own.py."""

import mpmath
import numpy as np
import pytest
import scipy.linalg
from groups.examples import GROUPS, OTHERS, RIGID, TWO_BODIES, WHEELED, close, vectors

from nonholo.groups import SE, SO, AbstractMatrixGroup, Translations

every_group = pytest.mark.parametrize("group", GROUPS, ids=str)


@pytest.mark.profile("routes", keep=["1.0-*"])
@every_group
@pytest.mark.parametrize("scale", [3.0, 1.0, 1e-3, 1e-9, 0.0])
def test_exp_is_the_matrix_exponential(group: AbstractMatrixGroup, scale: float) -> None:
    """The exponential agrees with forty digits (SciPy's is off by 2e-13 at these norms)."""
    x = vectors(group, 2, scale)
    with mpmath.workdps(40):
        exact = [mpmath.expm(mpmath.matrix(X.tolist()), method="taylor").tolist() for X in group.hat(x)]
    assert close(group.exp(x), np.array(exact, dtype=float), 30)


@every_group
@pytest.mark.parametrize("scale", [1.0, 1e-3, 1e-9])
def test_exp_increment_keeps_relative_accuracy(group: AbstractMatrixGroup, scale: float) -> None:
    """exp(x) - I is the integral of X exp(sX) over 0 < s < 1, relative to its own size."""
    x = vectors(group, 5, scale)
    nodes, weights = np.polynomial.legendre.leggauss(20)  # exact to rounding for norms of a few units
    samples = scipy.linalg.expm(np.multiply.outer((nodes + 1) / 2, group.hat(x)))
    exact = group.hat(x) @ np.tensordot(weights / 2, samples, axes=1)
    assert np.abs(group.exp_increment(x) - exact).max() <= 1e-13 * np.abs(exact).max()


@every_group
@pytest.mark.parametrize("scale", [0.5, 1e-3, 1e-9, 0.0])
def test_log_inverts_exp(group: AbstractMatrixGroup, scale: float) -> None:
    """log(exp(x)) = x while angles stay below pi; of small motions of SO(n) and SE(n) to relative precision."""
    x = vectors(group, 20, scale)
    result = group.log(group.exp(x))
    assert np.abs(result - x).max() <= 1e-23 if group.is_rigid and scale == 1e-9 else close(result, x)


@every_group
def test_hat_and_vee_are_inverse(group: AbstractMatrixGroup) -> None:
    """vee(hat(x)) = x for every basis, on SO(n) and SE(n) to the bit, and hat is the sum over the basis."""
    x = vectors(group, 7)
    result = group.vee(group.hat(x))
    assert np.array_equal(result, x) if group.is_rigid else close(result, x, 20)
    assert close(group.hat(x), np.einsum("ki,iab->kab", x, group.basis), 4)


@every_group
@pytest.mark.parametrize("scale", [3.0, 1.0, 1e-3, 1e-6])
def test_cayley_solves_its_definition(group: AbstractMatrixGroup, scale: float) -> None:
    """(I - X/2) cayley(x) = I + X/2 and the increment has no cancellation; a group without Cayley map says so."""
    x = vectors(group, 10, scale)
    if group is OTHERS[2]:
        with pytest.raises(ValueError, match=r"cayley.*stay in the group.*retract"):
            group.cayley(x)
        return
    X, eye = group.hat(x), group.identity
    assert close((eye - X / 2) @ group.cayley(x), eye + X / 2)
    exact = np.linalg.solve(eye - X / 2, X)
    assert np.abs(group.cayley_increment(x) - exact).max() <= 1e-14 * np.abs(exact).max()
    assert group.residual(group.cayley(x / (2 * scale))).max() < 1e-13


@every_group
def test_retract_is_cayley_or_exp(group: AbstractMatrixGroup) -> None:
    """Displacements have Cayley coordinates on SO(n) and SE(n), exponential ones elsewhere."""
    x = vectors(group, 3, 0.5)
    assert np.array_equal(group.retract(x), group.cayley(x) if group.is_rigid else group.exp(x))


@every_group
def test_residual_vanishes_on_the_group_alone(group: AbstractMatrixGroup) -> None:
    """Random elements have residual zero up to rounding, a changed matrix about the change, a reflection two."""
    rng = np.random.default_rng(7)
    g, mirror = np.stack([group.random(rng) for _ in range(5)]), group.identity
    assert group.residual(g).max() < 1e-12
    assert np.all(group.residual(1.001 * g) > 4e-4)
    mirror[0, 0] = -1
    assert group.residual(mirror) == 2 or not group.is_rigid


@pytest.mark.parametrize("n", [2, 5])
def test_random_rotations_are_uniform(n: int) -> None:
    """The mean over the group is zero and the trace has mean square 1 (2 in the plane); 4000 draws, 5 sigma."""
    rng, count = np.random.default_rng(8), 4000
    draws = np.stack([SO(n).random(rng) for _ in range(count)])
    traces = np.trace(draws, axis1=1, axis2=2) ** 2
    assert np.abs(draws.mean(axis=0)).max() < 5 / np.sqrt(count)
    assert abs(traces.mean() - (2 if n == 2 else 1)) < 5 * traces.std() / np.sqrt(count)


def test_coordinates_follow_the_conventions() -> None:
    """so(3): cross products; so(4): pairs in lexicographic order; se(n): those of rotations, then the velocity."""
    e, v, w = np.eye(4), np.array([1.0, 2.0, 3.0]), np.array([-1.0, 0.5, 2.0])
    assert np.array_equal(SO(3).hat(v) @ w, np.cross(v, w))
    assert SE(2).hat(v).tolist() == [[0, -1, 2], [1, 0, 3], [0, 0, 0]]
    assert np.array_equal(SO(4).hat(np.eye(6)[3]), np.outer(e[1], e[2]) - np.outer(e[2], e[1]))
    assert np.array_equal(SE(3).hat(np.arange(1.0, 7.0))[:3, :3], SO(3).hat(v))
    assert SE(3).hat(np.arange(1.0, 7.0))[:, 3].tolist() == [4, 5, 6, 0]
    assert np.array_equal(SE(4).hat(np.arange(10.0))[:4, :4], SO(4).hat(np.arange(6.0)))


def test_large_groups_need_no_basis() -> None:
    """SO(n) and SE(n) know their dimension for n = 10^6, and brackets of SO(200) take no (dim, n, n) array."""
    assert SO(10**6).dim == 499_999_500_000
    assert SE(10**6).pose_size == 10**6 * (10**6 + 1)
    group = SO(200)
    x, p = vectors(group, 2)
    assert abs(group.coad(x, p) @ x) < 1e-10  # <p, [x, x]>


@pytest.mark.parametrize("group", RIGID, ids=str)
def test_half_turns_have_poses(group: AbstractMatrixGroup) -> None:
    """The pose of a half turn decodes to it, and is normal; `check_group` has random elements."""
    g = group.exp(np.pi * np.eye(group.dim)[0])
    pose = group.pose_from_matrix(g)
    assert close(group.matrix_from_pose(pose), g)
    assert close(group.normalize_pose(pose), pose, 20)


@pytest.mark.parametrize("group", [*RIGID, WHEELED, TWO_BODIES], ids=str)
def test_gathered_errors_are_removed(group: AbstractMatrixGroup) -> None:
    """A pose that is wrong by 1e-5 decodes to an element of the group within 1e-4 of the true one."""
    rng = np.random.default_rng(2)
    g = group.random(rng)
    pose = group.pose_from_matrix(g) + 1e-5 * rng.normal(size=group.pose_size)
    assert group.residual(group.matrix_from_pose(pose)) < 4e-15
    assert np.abs(group.matrix_from_pose(group.normalize_pose(pose)) - g).max() < 1e-4


@pytest.mark.parametrize("group", [SO(2), SO(5)], ids=str)
def test_the_nearest_rotation_is_the_polar_factor(group: AbstractMatrixGroup) -> None:
    """Normalization is the polar factor of the singular value decomposition."""
    rng = np.random.default_rng(3)
    R = group.random(rng) + 1e-5 * rng.normal(size=(group.size, group.size))
    assert close(group.matrix_from_pose(R.reshape(-1)), scipy.linalg.polar(R)[0], 20)


def test_layouts_of_poses() -> None:
    """Rotations row by row, then the position; products one factor after another; vectors as they are."""
    g = SE(3).exp(np.array([0.1, 0.2, 0.3, 4.0, 5.0, 6.0]))
    assert np.array_equal(SE(3).pose_from_matrix(g), np.append(g[:3, :3].reshape(-1), g[:3, 3]))
    R = SO(4).exp(np.arange(6.0) / 10)
    assert np.array_equal(SO(4).pose_from_matrix(R), R.reshape(-1))
    x = np.array([0.3, 1.0, 2.0, 7.0, 8.0])
    parts = [SE(2).pose_from_matrix(SE(2).exp(x[:3])), Translations(2).pose_from_matrix(Translations(2).exp(x[3:]))]
    assert np.array_equal(WHEELED.pose_from_matrix(WHEELED.exp(x)), np.concatenate(parts))


@pytest.mark.parametrize("size", [0.0, 5e-324])
@pytest.mark.parametrize("group", [SO(3), SE(2)], ids=repr)
def test_a_pose_without_a_direction_is_refused(group: AbstractMatrixGroup, size: float) -> None:
    """No quaternion and no heading has the length 0, also by underflow; in a stack it marks what has no value."""
    pose = np.full(4, size)
    for method in (group.normalize_pose, group.matrix_from_pose, lambda p: group.pose_product(p, p)):
        with pytest.raises(ValueError, match="squares have a positive sum"):
            method(pose)
    assert not np.isfinite(group.normalize_pose(pose[None])[0, 0])
