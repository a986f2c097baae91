"""The Cayley map near half-turns of one plane, where its linear equations are singular to rounding."""

import mpmath
import numpy as np
import pytest

from nonholo.groups import SE, SO, AbstractMatrixGroup


@pytest.mark.parametrize("n", [4, 5, 7])
@pytest.mark.parametrize("length", [1.0, 999.0, 1e5, 1e9, 1e14, 1e40, 1e70, 1e200])
def test_cayley_of_one_plane_is_two_reflections(n: int, length: float) -> None:
    """For Y = y e_n^T - e_n y^T it is I - 2 q q^T times the reflection of e_n, q along (y, 1)."""
    rng = np.random.default_rng(n)
    y, Q = rng.normal(size=n - 1), SO(n).random(rng)
    y *= length / np.linalg.norm(y)
    Y = np.zeros((n, n))
    Y[:-1, -1], Y[-1, :-1] = y, -y
    q = np.append(y, 1.0) / np.hypot(length, 1.0)
    mirrors = np.append(np.ones(n - 1), -1.0)
    W = (np.eye(n) - 2 * np.outer(q, q)) * mirrors
    turned = SO(n).cayley(SO(n).vee(Q @ (2 * Y) @ Q.T))
    assert np.abs(SO(n).cayley(SO(n).vee(2 * Y)) - W).max() < 4e-13
    assert np.abs(turned - Q @ W @ Q.T).max() < 4e-13


def test_other_planes_are_not_lost() -> None:
    """A second plane that turns by little beside a large first one turns as it should."""
    x = SO(4).vee(2 * np.array([[0, 1e6, 0, 0], [-1e6, 0, 0, 0], [0, 0, 0, 1e-3], [0, 0, -1e-3, 0]]))
    assert SO(4).cayley(x)[2, 3] == pytest.approx(2e-3 / (1 + 1e-6), rel=1e-9)


def _motion(y: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Return the matrix X of a motion that turns the plane of e_1 and (0, y)."""
    n = len(v)
    X = np.zeros((n + 1, n + 1))
    X[0, 1:n], X[1:n, 0], X[:n, n] = y, -y, v
    return X


def _by_definition(X: np.ndarray, digits: int) -> np.ndarray:
    """Solve (I - X/2) W = I + X/2 with this many digits."""
    with mpmath.workdps(digits):
        half, eye = mpmath.matrix(X.tolist()) / 2, mpmath.eye(len(X))
        return np.array((mpmath.inverse(eye - half) * (eye + half)).tolist(), dtype=np.float64)


@pytest.mark.parametrize("n", [3, 4, 6])
@pytest.mark.parametrize("length", [1.0, 999.0, 1e5, 1e9, 1e16, 1e75, 1e200])
def test_slides_along_the_turning_plane(n: int, length: float) -> None:
    """A slide as long as the turn, along any line of the plane that turns, moves a finite way; in any frame."""
    rng = np.random.default_rng(n)
    y, Q = rng.normal(size=n - 1), np.eye(n + 1)
    y *= length / np.linalg.norm(y)
    Q[:n, :n] = SO(n).random(rng)
    for v in (np.append(0.7 * length, np.zeros(n - 1)), np.append(-0.3 * length, y)):
        X = _motion(y, v)
        W = _by_definition(X, 1000)
        assert np.abs(SE(n).cayley(SE(n).vee(X)) - W).max() < 1e-12
        assert np.abs(SE(n).cayley(SE(n).vee(Q @ X @ Q.T)) - Q @ W @ Q.T).max() < 2e-12
    stack = SE(n).vee(np.stack([X, _motion(y / length, v / length)]))
    assert np.abs(SE(n).cayley(stack) - [SE(n).cayley(x) for x in stack]).max() < 1e-14


@pytest.mark.parametrize("across", [0.0, 1e-3, 1.0, 1e6])
def test_slides_across_are_not_lost(across: float) -> None:
    """What slides across the plane moves as far as it slides, to the rounding of the whole slide."""
    X = _motion(np.array([0.0, 1e8, 0.0]), np.array([1e8, across, 2e8, -across]))
    assert np.abs(SE(4).cayley(SE(4).vee(X)) - _by_definition(X, 60)).max() < 1e-7
    assert SE(4).cayley(SE(4).vee(X))[[1, 3], 4] == pytest.approx([across, -across], abs=1e-7)


@pytest.mark.parametrize("group", [SO(4), SE(3)])
def test_lengths_beyond_all_numbers_are_not_the_identity(group: AbstractMatrixGroup) -> None:
    """Where the length of a vector overflows there is no silent result."""
    with pytest.warns(RuntimeWarning):
        assert np.isnan(group.cayley(np.full(6, 1e308))).any()
