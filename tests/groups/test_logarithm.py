"""Logarithms at their difficult places: half turns, several of them at once, clusters of angles, no logarithm."""

import numpy as np
import pytest
from groups.examples import HEISENBERG, SL2, close, vectors
from hypothesis import example, given
from hypothesis import strategies as st
from refusals import refusals

from nonholo.groups import SE, SO, AbstractMatrixGroup


def turned(n: int, angles: list[float], seed: int = 0) -> np.ndarray:
    """Return the rotation by these angles in orthogonal planes of random position."""
    group = SO(n)
    X = np.zeros((n, n))
    for k, angle in enumerate(angles):
        X[2 * k, 2 * k + 1], X[2 * k + 1, 2 * k] = angle, -angle
    Q = group.random(np.random.default_rng(seed))
    return group.exp(group.vee(Q @ X @ Q.T))


CASES = [
    (2, [np.pi]), (4, [np.pi, np.pi]), (4, [np.pi, 0.0]), (4, [np.pi, 1e-9]), (4, [np.pi, np.pi - 1e-9]),
    (4, [np.pi - 1e-15, np.pi - 1e-14]), (4, [2.5, 2.5]), (4, [2.5, -2.5]), (5, [np.pi, np.pi]), (5, [3.0, 1.0]),
    (6, [np.pi, np.pi, np.pi]), (6, [np.pi, np.pi, 0.5]), (6, [2.0943951, 2.0943952, 0.0]),
]  # fmt: skip


@pytest.mark.parametrize(("n", "angles"), CASES)
def test_log_of_rotations_and_motions(n: int, angles: list[float]) -> None:
    """exp(log(g)) = g to rounding, with a translation too; the angles of log(R) are those of R, all at most pi."""
    group, R, g = SO(n), turned(n, angles), np.eye(n + 1)
    x = group.log(R)
    result = np.sort(np.linalg.eigvalsh(1j * group.hat(x)))[::-1][: len(angles)]
    assert close(group.exp(x), R, 40)
    assert np.abs(result - np.sort(np.abs(angles))[::-1]).max() < 1e-14
    g[:n, :n], g[:n, n] = R, np.arange(1.0, n + 1)
    assert close(SE(n).exp(SE(n).log(g)), g, 100)


planar = st.sampled_from([SO(3), SE(2)])
coordinates = st.lists(st.floats(-3, 3, allow_subnormal=False), min_size=3, max_size=3).map(np.array)


@given(planar, coordinates, st.sampled_from([1.0, 1e-3, 1e-9, 0.0]))
@example(SO(3), np.array([0.0, 0.0, 4.0]), 1.0)  # whose quaternion has a negative scalar part
def test_log_inverts_exp(group: AbstractMatrixGroup, x: np.ndarray, scale: float) -> None:
    """In closed form: exp(log(g)) = g for every angle, by the shorter way, and log(exp(x)) = x below angle pi."""
    g = group.exp(scale * x)
    assert close(group.exp(group.log(g)), g)
    assert group.angle(group.log(g)) <= np.pi * (1 + 1e-15)
    if group.angle(scale * x) < 3:
        assert close(group.log(g), scale * x, 200)


@pytest.mark.parametrize(("group", "axis"), [(SO(3), [2 / 3, -1 / 3, 2 / 3]), (SE(2), [1.0, 0.0, 0.0])], ids=str)
@pytest.mark.parametrize("gap", [0.0, 1e-15, 1e-12, 1e-8, 1e-4])
def test_log_near_angle_pi(group: AbstractMatrixGroup, axis: list[float], gap: float) -> None:
    """Near a half turn the logarithm is accurate to rounding, up to the sign that angle pi leaves open."""
    g = group.exp((np.pi - gap) * np.array(axis))
    assert np.abs(group.exp(group.log(g)) - g).max() < 4e-15
    assert abs(group.angle(group.log(g)) - (np.pi - gap)) < 4e-15


def test_easy_and_difficult_rotations_mix() -> None:
    """A stack of rotations, some at half turns and one not a number, is taken element by element."""
    R = np.stack([turned(4, [0.1, 0.2]), turned(4, [np.pi, 2.0]), np.full((4, 4), np.nan), np.eye(4), -np.eye(4)])
    x, known = SO(4).log(R), [0, 1, 3, 4]
    assert np.isnan(x[2]).all()
    assert close(SO(4).exp(x[known]), R[known])
    assert abs(np.linalg.norm(x[4]) - np.pi * np.sqrt(2)) < 1e-14  # two half turns


test_matrices_without_logarithm_are_refused = refusals(
    (lambda: SO(4).log(np.diag([-1.0, 1, 1, 1])), r"\.log.*determinant \+1.*reflection"),
    (lambda: SE(4).log(np.diag([-1.0, 1, 1, 1, 1])), r"\.log.*determinant \+1.*reflection"),
    (lambda: SL2.log(np.stack([np.eye(2), -np.eye(2)])), r"MatrixGroup.*log.*real principal logarithm.*eigenvalues"),
    (lambda: SL2.log(np.diag([-2.0, -0.5])), r"MatrixGroup.*log.*real principal logarithm.*eigenvalues"),
    (lambda: SL2.log(np.diag([2.0, 1.0])), r"lie in the group.*0\.347 away"),  # its trace is not zero
)


@pytest.mark.parametrize("coordinates", [[8.0, 0.0, 0.0], [15.0, 1.0, 0.0], [0.0, 3.1, -3.1], [1.0, 1.0, -1.0]])
def test_log_of_unimodular_matrices(coordinates: list[float]) -> None:
    """Stretches by exp(15), rotations by 3.1 and the parabolic case; rounding of g counts by its condition."""
    g = SL2.exp(np.array(coordinates))
    assert np.abs(SL2.log(g) - coordinates).max() <= 40 * np.finfo(float).eps * np.linalg.cond(g)


def test_log_of_unipotent_matrices() -> None:
    """On the Heisenberg group the logarithm is a polynomial: no size is too large."""
    x = vectors(HEISENBERG, 10, 1e4)
    assert close(HEISENBERG.log(HEISENBERG.exp(x)), x, 1e4)  # the corner is a difference of products of 1e4 and 1e4


def test_residuals_of_matrices_without_logarithm() -> None:
    """Infinite on the negative real axis; of a logarithm outside of the algebra its distance."""
    assert SL2.residual(-np.eye(2)) == SL2.residual(np.diag([-2.0, -0.5])) == np.inf
    assert abs(SL2.residual(np.diag([2.0, 1.0])) - np.log(2) / 2) < 1e-15


@pytest.mark.parametrize("group", [SO(3), SE(2)], ids=str)
@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-4, 0.5, 1 - 1e-9, 1 + 1e-9, 3.0, np.pi, 6.0])
def test_closed_forms_agree_with_the_definition(group: AbstractMatrixGroup, angle: float) -> None:
    """The closed form in ad and ad^2 against the inverse of the integrated exponential; near 2 pi both grow."""
    x = np.array([1.0, -1.0, 2.0]) * angle if group == SE(2) else np.array([2.0, -1.0, 2.0]) / 3 * angle
    assert close(group.dexp_inverse(x), AbstractMatrixGroup.dexp_inverse(group, x), 1000)


@pytest.mark.parametrize("group", [SO(4), SE(3)], ids=str)
def test_dexp_inverse_holds_at_large_angles(group: AbstractMatrixGroup) -> None:
    """Where ad has eigenvalues near 2 pi i, the derivative of exp times this is still the identity."""
    x = np.zeros(group.dim)
    x[0], x[-1] = 3.0, 3.0  # SO(4): two planes, ad has eigenvalues 6 i
    ad = group.ad(x)
    nodes, weights = np.polynomial.legendre.leggauss(24)
    dexp = sum(w / 2 * group.adjoint(group.exp((t + 1) / 2 * x)) for t, w in zip(nodes, weights, strict=True))
    assert np.abs(ad).max() >= 3
    assert close(group.dexp_inverse(x) @ dexp, np.eye(group.dim), 1000)
