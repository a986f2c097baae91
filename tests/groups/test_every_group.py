"""What every group must do: SO(n), SE(n), groups from a basis, products."""

import mpmath
import numpy as np
import pytest
import scipy.linalg
from groups.examples import GROUPS, OTHERS, RIGID, close, vectors

from nonholo.groups import SE, SO, AbstractMatrixGroup

every_group = pytest.mark.parametrize("group", GROUPS, ids=str)


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
    found = group.log(group.exp(x))
    assert np.abs(found - x).max() <= 1e-23 if group.is_rigid and scale == 1e-9 else close(found, x)


@every_group
def test_hat_and_vee_are_inverse(group: AbstractMatrixGroup) -> None:
    """vee(hat(x)) = x for every basis, on SO(n) and SE(n) to the bit, and hat is the sum over the basis."""
    x = vectors(group, 7)
    found = group.vee(group.hat(x))
    assert np.array_equal(found, x) if group.is_rigid else close(found, x, 20)
    assert close(group.hat(x), np.einsum("ki,iab->kab", x, group.basis), 4)


@every_group
def test_sizes_agree(group: AbstractMatrixGroup) -> None:
    """dim, size and pose_size are those of the arrays; only SO(n) and SE(n) are rigid."""
    assert group.basis.shape == (group.dim, group.size, group.size)
    assert group.pose_from_matrix(group.identity).shape == (group.pose_size,)
    assert group.is_rigid == (group in RIGID)


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
    expected = group.cayley(x) if group.is_rigid else group.exp(x)
    assert np.array_equal(group.retract(x), expected)
    assert close(group.identity + group.retract_increment(x), expected, 2)


@every_group
def test_adjoint_is_conjugation(group: AbstractMatrixGroup) -> None:
    """Ad_g x is the conjugate of hat(x), Ad a homomorphism, `inverse` the inverse."""
    rng = np.random.default_rng(3)
    g, k, x = group.random(rng), group.random(rng), rng.normal(size=group.dim)
    assert close(group.hat(group.adjoint(g) @ x), g @ group.hat(x) @ np.linalg.inv(g), 1000)
    assert close(group.adjoint(g @ k), group.adjoint(g) @ group.adjoint(k), 1000)
    assert close(group.inverse(g) @ g, group.identity, 1000)


@every_group
def test_coadjoint_operators_are_plain_transposes(group: AbstractMatrixGroup) -> None:
    """The matrix formulas g^T P g^-T and [X^T, P] agree with the transposes of Ad and ad in coordinates."""
    rng = np.random.default_rng(4)
    g, x, p = group.random(rng), *rng.normal(size=(2, group.dim))
    assert close(group.coadjoint(g, p), p @ group.adjoint(g), 1000)
    assert close(group.coad(x, p), p @ group.ad(x))


@pytest.mark.parametrize("n", [4, 5])
def test_coadjoint_operators_of_rotations(n: int) -> None:
    """On so(n) momenta are skew matrices M, Ad*_g M = g^T M g and ad*_x M = [M, X]."""
    group, rng = SO(n), np.random.default_rng(5)
    g, x, p = group.random(rng), *rng.normal(size=(2, group.dim))
    M, X = group.hat(p), group.hat(x)
    assert close(group.hat(group.coadjoint(g, p)), g.T @ M @ g)
    assert close(group.hat(group.coad(x, p)), M @ X - X @ M)


@every_group
def test_bracket_is_the_derivative_of_adjoint(group: AbstractMatrixGroup) -> None:
    """[x, y] is antisymmetric, satisfies Jacobi, and is the derivative of Ad, by central differences."""
    x, y, z = np.random.default_rng(6).normal(size=(3, group.dim))
    bracket, small = group.bracket, 1e-5
    assert close(bracket(x, y), -bracket(y, x))
    terms = np.stack([bracket(x, bracket(y, z)), bracket(y, bracket(z, x)), bracket(z, bracket(x, y))])
    assert np.abs(terms.sum(axis=0)).max() <= 1e-14 * (1 + np.abs(terms).max())
    slope = (group.adjoint(group.exp(small * x)) - group.adjoint(group.exp(-small * x))) @ y / (2 * small)
    # the error is small^2 / 6 times the third power of ad
    assert np.abs(slope - bracket(x, y)).max() < small**2 * (1 + np.linalg.norm(group.ad(x), 2)) ** 3


@every_group
def test_residual_vanishes_on_the_group_alone(group: AbstractMatrixGroup) -> None:
    """Random elements have residual zero up to rounding, a changed matrix about the change, a reflection two."""
    rng = np.random.default_rng(7)
    g, mirror = np.stack([group.random(rng) for _ in range(5)]), group.identity
    assert group.residual(g).max() < 1e-12
    assert np.all(group.residual(1.001 * g) > 4e-4)
    mirror[0, 0] = -1
    assert group.residual(mirror) == 2 or not group.is_rigid


@every_group
def test_angle_is_the_largest_imaginary_part(group: AbstractMatrixGroup) -> None:
    """The angle of exp(x) is the largest imaginary part of an eigenvalue of hat(x)."""
    x = vectors(group, 6, 2.0)
    eigenvalues = np.linalg.eigvals(group.hat(x))
    # a defective eigenvalue (nilpotent matrices, SL(2) near its cone) is found to the root of rounding only
    assert np.abs(group.angle(x) - np.abs(eigenvalues.imag).max(axis=-1)).max() < 1e-7


@every_group
def test_functions_broadcast(group: AbstractMatrixGroup) -> None:
    """Leading axes are mapped over, none of them and empty ones too."""
    x = vectors(group, 12, 0.4).reshape(3, 4, -1)
    g = group.exp(x)
    assert close(g[1, 2], group.exp(x[1, 2]), 20)
    assert close(group.log(g)[2, 3], group.log(g[2, 3]), 20)
    assert close(group.coadjoint(g, x)[1, 0], group.coadjoint(g[1, 0], x[1, 0]), 20)
    assert close(group.dexp_inverse(x)[0, 1], group.dexp_inverse(x[0, 1]), 20)
    assert group.log(group.exp(x[:0])).shape == (0, 4, group.dim)
    assert group.residual(g).shape == group.angle(x).shape == (3, 4)


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
