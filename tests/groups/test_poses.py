"""Compact poses: decoding, nearest poses, rates of change."""

import numpy as np
import pytest
import scipy.linalg
from groups.examples import GROUPS, MOTIONS, ROTATIONS, TWO_BODIES, WHEELED, close

from nonholo.groups import SE, SO, AbstractMatrixGroup, Translations

every_group = pytest.mark.parametrize("group", GROUPS, ids=str)


@every_group
def test_poses_decode_and_stay(group: AbstractMatrixGroup) -> None:
    """Poses decode to the matrix they came from, half turns too; normalization changes them by rounding only."""
    rng = np.random.default_rng(0)
    g = np.stack([group.random(rng) for _ in range(20)]).reshape(4, 5, group.size, group.size)
    if group.is_rigid:
        g[0, 0] = group.exp(np.pi * np.eye(group.dim)[0])
    pose = group.pose_from_matrix(g)
    assert pose.shape == (4, 5, group.pose_size)
    assert close(group.matrix_from_pose(pose), g)
    assert close(group.normalize_pose(pose), pose, 20)


@pytest.mark.parametrize("group", [*ROTATIONS, *MOTIONS, WHEELED, TWO_BODIES], ids=str)
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
