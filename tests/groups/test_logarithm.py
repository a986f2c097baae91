"""Logarithms at their difficult places: half turns, several of them at once, clusters of angles, no logarithm."""

import numpy as np
import pytest
from groups.examples import HEISENBERG, SL2, close, vectors

from nonholo.groups import SE, SO


def turned(n: int, angles: list[float], seed: int = 0) -> np.ndarray:
    """Return the rotation by these angles in orthogonal planes of random position."""
    group = SO(n)
    X = np.zeros((n, n))
    for k, angle in enumerate(angles):
        X[2 * k, 2 * k + 1], X[2 * k + 1, 2 * k] = angle, -angle
    Q = group.random(np.random.default_rng(seed))
    return group.exp(group.vee(Q @ X @ Q.T))


CASES = [
    (2, [np.pi]),
    (4, [np.pi, np.pi]),
    (4, [np.pi, 0.0]),
    (4, [np.pi, 1e-9]),
    (4, [np.pi, np.pi - 1e-9]),
    (4, [np.pi - 1e-15, np.pi - 1e-14]),
    (4, [2.5, 2.5]),
    (4, [2.5, -2.5]),
    (5, [np.pi, np.pi]),
    (5, [3.0, 1.0]),
    (6, [np.pi, np.pi, np.pi]),
    (6, [np.pi, np.pi, 0.5]),
    (6, [2.0943951, 2.0943952, 0.0]),
]


@pytest.mark.parametrize(("n", "angles"), CASES)
def test_log_of_rotations(n: int, angles: list[float]) -> None:
    """exp(log(R)) = R to rounding, and the angles of the logarithm are those of R, all at most pi."""
    group, R = SO(n), turned(n, angles)
    x = group.log(R)
    found = np.sort(np.linalg.eigvalsh(1j * group.hat(x)))[::-1][: len(angles)]
    assert close(group.exp(x), R, 40)
    assert np.abs(found - np.sort(np.abs(angles))[::-1]).max() < 1e-14


@pytest.mark.parametrize(("n", "angles"), CASES)
def test_log_of_motions(n: int, angles: list[float]) -> None:
    """The same with a translation: at angle pi the integrated exponential is still invertible."""
    group = SE(n)
    g = group.identity
    g[:n, :n], g[:n, n] = turned(n, angles), np.arange(1.0, n + 1)
    assert close(group.exp(group.log(g)), g, 100)


def test_log_of_minus_one() -> None:
    """-I of SO(4), both eigenplanes open, has a logarithm of two half turns."""
    x = SO(4).log(-np.eye(4))
    assert abs(np.linalg.norm(x) - np.pi * np.sqrt(2)) < 1e-14
    assert close(SO(4).exp(x), -np.eye(4), 4)


def test_easy_and_difficult_rotations_mix() -> None:
    """A stack of rotations, some at half turns and one not a number, is taken element by element."""
    R = np.stack([turned(4, [0.1, 0.2]), turned(4, [np.pi, 2.0]), np.full((4, 4), np.nan), np.eye(4)])
    x = SO(4).log(R)
    assert np.isnan(x[2]).all()
    assert close(SO(4).exp(x[[0, 1, 3]]), R[[0, 1, 3]])


@pytest.mark.parametrize("group", [SO(4), SE(4)], ids=str)
def test_reflections_are_refused(group: object) -> None:
    """A matrix of determinant -1 has no real logarithm."""
    mirror = group.identity
    mirror[0, 0] = -1
    with pytest.raises(ValueError, match=r"\.log.*determinant \+1.*reflection"):
        group.log(mirror)


@pytest.mark.parametrize("coordinates", [[8.0, 0.0, 0.0], [15.0, 1.0, 0.0], [0.0, 3.1, -3.1], [1.0, 1.0, -1.0]])
def test_log_of_unimodular_matrices(coordinates: list[float]) -> None:
    """Stretches by exp(15), rotations by 3.1 and the parabolic case; rounding of g counts by its condition."""
    g = SL2.exp(np.array(coordinates))
    assert np.abs(SL2.log(g) - coordinates).max() <= 40 * np.finfo(float).eps * np.linalg.cond(g)


def test_log_of_unipotent_matrices() -> None:
    """On the Heisenberg group the logarithm is a polynomial: no size is too large."""
    x = vectors(HEISENBERG, 10, 1e4)
    assert close(HEISENBERG.log(HEISENBERG.exp(x)), x, 1e4)  # the corner is a difference of products of 1e4 and 1e4


@pytest.mark.parametrize("g", [-np.eye(2), np.diag([-2.0, -0.5])], ids=["minus one", "negative stretch"])
def test_missing_logarithms_are_refused(g: np.ndarray) -> None:
    """Eigenvalues on the negative real axis: no principal logarithm, and the residual is infinite."""
    with pytest.raises(ValueError, match=r"MatrixGroup.*log.*real principal logarithm.*eigenvalues"):
        SL2.log(np.stack([np.eye(2), g]))
    assert SL2.residual(g) == np.inf


def test_matrices_outside_the_group_are_refused() -> None:
    """diag(2, 1) has a logarithm, but not one of trace zero."""
    with pytest.raises(ValueError, match=r"lie in the group.*0\.347 away"):
        SL2.log(np.diag([2.0, 1.0]))
    assert abs(SL2.residual(np.diag([2.0, 1.0])) - np.log(2) / 2) < 1e-15
