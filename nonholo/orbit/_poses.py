r"""Compact poses as matrices, and angles as continuous headings; also for parts of a motion."""

import numpy as np

from nonholo.base.types import Float
from nonholo.systems import System

_TURN = 2 * np.pi


class AliasingWarning(UserWarning):
    """Given poses of which one is turned by more than 90 degrees from the one before.

    Its velocity is that of the shorter turn. Of a body that turns faster than half a turn a row nothing tells which
    turn it took.

    Example:
        >>> import warnings
        >>> poses = nh.SE(2).exp([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0]])
        >>> with warnings.catch_warnings(record=True) as caught:
        ...     warnings.simplefilter("always")
        ...     fast = nh.Orbit.from_poses(nh.ChaplyginSleigh(1.0, 1.0, 0.5), [0, 1], poses)
        >>> caught[0].category.__name__, fast.body_velocity[0, 0].round(3)
        ('AliasingWarning', np.float64(-0.757))
    """


def configurations(system: System, pose: Float[np.ndarray, "K size"]) -> Float[np.ndarray, "K N N"]:
    """Return the matrices, in the user's body frame, of compact poses in the canonical one."""
    g = system.group.matrix_from_pose(pose)
    if is_own_frame(system):
        return g.copy() if np.may_share_memory(g, pose) else g
    return g @ system.group.inverse(system.frame)


def poses(system: System, canonical_pose: Float[np.ndarray, "K size"]) -> Float[np.ndarray, "K size"]:
    """Return compact poses, in the user's body frame, from those in the canonical one; the same where frames are.

    Example:
        >>> from nonholo.systems import ChaplyginSleigh
        >>> poses(ChaplyginSleigh(1.0, 1.0, 0.5, b=0.25), np.array([[1.0, 0.0, 3.0, 0.25]]))
        array([[1., 0., 3., 0.]])
    """
    if is_own_frame(system):
        return canonical_pose
    group = system.group
    return group.pose_product(canonical_pose, group.pose_from_matrix(group.inverse(system.frame)))


def is_own_frame(system: System) -> bool:
    """Tell whether the user's body frame is the canonical one."""
    return system.canonical is system or np.array_equal(np.asarray(system.frame), system.group.identity)


def unwrapped(pose: Float[np.ndarray, "K 4"], before: float | None = None) -> Float[np.ndarray, "K"]:
    """Return the angles of compact poses on SE(2); the shorter turn leads to each, to the first one from `before`.

    Full turns are counted in whole numbers, so no rounding gathers, and parts of a motion give the bits of the whole.

    Example:
        >>> pose = np.array([[-1.0, 0.1, 0.0, 0.0], [-1.0, -0.1, 0.0, 0.0]])
        >>> unwrapped(pose).round(2), unwrapped(pose[1:], before=3.0).round(2)
        (array([3.04, 3.24]), array([3.24]))
    """
    angle = np.arctan2(pose[:, 1], pose[:, 0])
    passed = np.rint(np.diff(angle, prepend=angle[:1] if before is None else before) / _TURN)
    return angle - _TURN * np.cumsum(passed)


def turned_near(headings: Float[np.ndarray, "K"], pose: Float[np.ndarray, "K 4"]) -> Float[np.ndarray, "K"]:
    """Return the headings at compact poses on SE(2) that are less than half a turn from given ones.

    Example:
        >>> turned_near(np.array([6.3]), np.array([[1.0, 0.0, 0.0, 0.0]])).round(2)
        array([6.28])
    """
    angle = np.arctan2(pose[:, 1], pose[:, 0])
    return angle + _TURN * np.rint((headings - angle) / _TURN)
