"""Axioms of the matrix groups, at random, near the identity and near angle pi."""

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given
from hypothesis import strategies as st

from nonholo.groups import SE, SO, AbstractMatrixGroup

GROUPS = [SO(3), SE(2)]
coordinates = st.lists(st.floats(-3, 3, allow_subnormal=False), min_size=3, max_size=3).map(np.array)
scales = st.sampled_from([1.0, 1e-3, 1e-9, 0.0])
groups = st.sampled_from(GROUPS)


def close(found: np.ndarray, expected: np.ndarray, ulps: float = 40) -> bool:
    """Tell whether arrays agree to some rounding errors of their size."""
    return bool(np.abs(found - expected).max() <= ulps * np.finfo(float).eps * (1 + np.abs(expected).max()))


@given(groups, coordinates, scales)
def test_exp_is_the_matrix_exponential(group: AbstractMatrixGroup, x: np.ndarray, scale: float) -> None:
    """The closed form of exp agrees with scaling and squaring."""
    assert close(group.exp(scale * x), scipy.linalg.expm(group.hat(scale * x)), 200)


@given(groups, coordinates, scales)
def test_log_inverts_exp(group: AbstractMatrixGroup, x: np.ndarray, scale: float) -> None:
    """exp(log(g)) = g for every angle, and log(exp(x)) = x below angle pi."""
    g = group.exp(scale * x)
    assert close(group.exp(group.log(g)), g, 100)
    if group.angle(scale * x) < 3:
        assert close(group.log(g), scale * x, 200)


@given(groups, coordinates, scales)
def test_cayley_solves_its_definition(group: AbstractMatrixGroup, x: np.ndarray, scale: float) -> None:
    """(I - X/2) cayley(x) = I + X/2, and the increment is cayley minus the identity to relative rounding."""
    X, eye = group.hat(scale * x), group.identity
    assert close((eye - X / 2) @ group.cayley(scale * x), eye + X / 2)
    increment = group.cayley_increment(scale * x)
    exact = np.linalg.solve(eye - X / 2, X)
    assert np.abs(increment - exact).max() <= 1e-14 * np.abs(exact).max()


@given(groups, coordinates)
def test_hat_and_vee_are_inverse(group: AbstractMatrixGroup, x: np.ndarray) -> None:
    """vee(hat(x)) = x, exactly."""
    assert np.array_equal(group.vee(group.hat(x)), x)


@pytest.mark.parametrize("group", GROUPS, ids=str)
def test_adjoint_is_conjugation(group: AbstractMatrixGroup) -> None:
    """Ad_g x is the conjugate of hat(x), Ad* its plain transpose, and Ad a homomorphism."""
    rng = np.random.default_rng(0)
    g, k, x, p = group.random(rng), group.random(rng), rng.normal(size=3), rng.normal(size=3)
    assert close(group.hat(group.adjoint(g) @ x), g @ group.hat(x) @ np.linalg.inv(g))
    assert close(group.coadjoint(g, p) @ x, p @ group.adjoint(g) @ x)
    assert close(group.adjoint(g @ k), group.adjoint(g) @ group.adjoint(k))
    assert close(group.inverse(g) @ g, group.identity)


@pytest.mark.parametrize("group", GROUPS, ids=str)
def test_bracket_is_the_derivative_of_adjoint(group: AbstractMatrixGroup) -> None:
    """[x, y] is antisymmetric, satisfies Jacobi, and ad* is its plain transpose."""
    rng = np.random.default_rng(1)
    x, y, z, p = rng.normal(size=(4, 3))
    bracket = group.bracket
    assert close(bracket(x, y), -bracket(y, x))
    cyclic = bracket(x, bracket(y, z)) + bracket(y, bracket(z, x)) + bracket(z, bracket(x, y))
    assert close(cyclic, np.zeros(3))
    assert close(group.coad(x, p) @ y, p @ bracket(x, y))
    small = 1e-6
    assert np.abs((group.adjoint(group.exp(small * x)) - np.eye(3)) @ y / small - bracket(x, y)).max() < 1e-4


def test_hat_is_the_cross_product() -> None:
    """On so(3), hat(v) w = v x w; on se(2) the rotation comes first."""
    v, w = np.array([1.0, 2.0, 3.0]), np.array([-1.0, 0.5, 2.0])
    assert np.array_equal(SO(3).hat(v) @ w, np.cross(v, w))
    assert SE(2).hat(np.array([1.0, 2.0, 3.0])).tolist() == [[0, -1, 2], [1, 0, 3], [0, 0, 0]]


@pytest.mark.parametrize("group", GROUPS, ids=str)
@pytest.mark.parametrize("gap", [0.0, 1e-15, 1e-12, 1e-8, 1e-4])
def test_log_near_angle_pi(group: AbstractMatrixGroup, gap: float) -> None:
    """Near a half turn the logarithm is accurate to rounding, up to the sign that angle pi leaves open."""
    direction = (
        np.array([2.0, -1.0, 2.0]) / 3 if group.angle(np.eye(3)[0]) == group.angle(np.eye(3)[1]) else np.eye(3)[0]
    )
    g = group.exp((np.pi - gap) * direction)
    assert np.abs(group.exp(group.log(g)) - g).max() < 4e-15
    assert abs(group.angle(group.log(g)) - (np.pi - gap)) < 4e-15


@pytest.mark.parametrize("group", GROUPS, ids=str)
def test_pose_round_trip(group: AbstractMatrixGroup) -> None:
    """Compact poses decode to the matrix they came from, for many elements at once and half turns."""
    rng = np.random.default_rng(2)
    g = np.stack([group.random(rng) for _ in range(50)] + [group.exp(np.pi * e) for e in np.eye(3)[:1]])
    assert close(group.matrix_from_pose(group.pose_from_matrix(g)), g)


@pytest.mark.parametrize("group", GROUPS, ids=str)
def test_functions_broadcast(group: AbstractMatrixGroup) -> None:
    """Leading axes are mapped over."""
    x = np.random.default_rng(3).normal(size=(4, 5, 3))
    assert np.array_equal(group.exp(x)[1, 2], group.exp(x[1, 2]))
    assert close(group.coadjoint(group.exp(x), x)[3, 0], group.coadjoint(group.exp(x[3, 0]), x[3, 0]))


@pytest.mark.parametrize("group", GROUPS, ids=str)
def test_jax_traces_the_same_formulas(group: AbstractMatrixGroup) -> None:
    """The same code runs under jit and its derivatives are finite at the identity."""
    import jax
    import jax.numpy as jnp

    with jax.enable_x64(True):
        x = np.array([0.3, -0.2, 0.5])
        assert close(np.asarray(jax.jit(group.exp)(jnp.asarray(x))), group.exp(x))
        assert close(np.asarray(jax.jit(group.log)(jnp.asarray(group.exp(x)))), x)
        through = jax.jit(jax.jacfwd(lambda v: group.log(group.exp(v))))(jnp.zeros(3))
        assert close(np.asarray(through), np.eye(3))


def test_wrong_shapes_are_refused() -> None:
    """A matrix where coordinates are needed, and the reverse, name the remedy."""
    with pytest.raises(ValueError, match=r"SO\(3\) \(coordinates\).*shape \(3,\).*vee"):
        SO(3).exp(np.zeros(4))
    with pytest.raises(ValueError, match=r"SE\(2\) \(element\).*hat"):
        SE(2).log(np.zeros((2, 2)))
    with pytest.raises(ValueError, match=r"SO\(n=\.\.\.\).*at least 2.*Got 1"):
        SO(1)
    with pytest.raises(ValueError, match=r"SE\(n=\.\.\.\).*positive integer.*Got 2\.5"):
        SE(2.5)


@pytest.mark.parametrize("axis", np.eye(3), ids=["e1", "e2", "e3"])
@pytest.mark.parametrize("angle", [3.2, 4.0, 6.0, -3.5])
def test_the_logarithm_goes_the_shorter_way(angle: float, axis: np.ndarray) -> None:
    """A turn by more than a half is the rest of a full turn the other way."""
    rest = angle - np.copysign(2 * np.pi, angle)
    assert np.abs(SO(3).log(SO(3).exp(angle * axis)) - rest * axis).max() <= 1e-14
