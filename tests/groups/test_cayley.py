"""The Cayley map on SO(n) near half-turns of one plane, where its linear equations are singular to rounding."""

import numpy as np
import pytest

from nonholo.groups import SO


@pytest.mark.parametrize("n", [4, 5, 7])
@pytest.mark.parametrize("length", [1.0, 999.0, 1e5, 1e9, 1e14, 1e40, 1e70])
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
