"""All values of a step over general rows: their equations, exact counts, Riccati, closed forms, runs, refusals."""

import functools
import itertools
import operator

import flint
import numpy as np
import pytest
from bodies import mass_tensor, random_rows
from forms import FORMS, system
from refusals import refusals

import nonholo as nh
from nonholo.discrete import Branches, legendre
from nonholo.discrete.branching import _sections

H = 0.3
COUNTS = {  # of values over a general momentum
    ("SO(2,1)", 1): 2, ("SO(2,1) oblique", 2): 4, ("SE(2)", 3): 2, ("SO(3)", 3): 4, ("SO(4)", 1): 4,
    ("SO(4)", 2): 8,
}  # fmt: skip


def _body(name: str, k: int, seed: int = 0) -> nh.Discretization:
    rng = np.random.default_rng(seed)
    if name in FORMS:
        return nh.discretize(system(FORMS[name], k, rng, definite=False), H)
    group = getattr(nh, name[:2])(int(name[3]))
    rows = np.eye(k) if k == group.dim else random_rows(group, k, rng)
    return nh.discretize(nh.LLSystem(group, mass_tensor(group, rng), rows), H)


def _values(name: str, k: int) -> tuple[nh.Discretization, np.ndarray, Branches]:
    discrete, r = _body(name, k), np.random.default_rng(k).normal(size=k)
    return discrete, r, nh.displacements_over(discrete, r)


@pytest.mark.profile("routes", keep=["SO(2,1)-1"])
@pytest.mark.parametrize(("name", "k"), COUNTS, ids=str)
def test_every_value_solves_the_equations(name: str, k: int) -> None:
    """(W - W^-1)/2 in d, momenta r, one energy after the step; distinct, conjugates too; one is that of the run."""
    discrete, r, values = _values(name, k)
    body, W, back = discrete.system, values.displacement, np.linalg.inv(values.displacement)
    group, size = body.group, np.abs(W).max((1, 2)) * np.abs(back).max((1, 2))
    assert len(values) == COUNTS[name, k]
    x = group.vee((W - back) / 2)
    outside = np.abs((W - back) / 2 - np.tensordot(x, group.basis, 1)).max((1, 2))
    across = np.abs(x @ body.annihilator.T).max(axis=1, initial=0.0)
    missed = np.abs(body.restrict(values.momentum) - r).max(axis=1)
    after = -body.restrict(legendre(discrete, back - group.identity, "left"))
    energy = np.einsum("bi,ij,bj->b", after, np.linalg.inv(body.constrained_inertia), after) / 2
    assert (np.stack([outside, across, missed, np.abs(energy - values.energy)]) / size**2).max() < 1e-11
    assert (np.abs(W[:, None] - W).max((2, 3)) + np.eye(len(W))).min() > 1e-6
    assert (np.abs(W.conj()[:, None] - W).max((2, 3)).min(axis=1) / size).max() < 1e-9
    run = nh.simulate(discrete, momentum=r, steps=1, throw=False)
    assert np.abs(W[values.principal] - run.displacement[0]).max() < 1e-12


def _exact(numbers: np.ndarray) -> list:
    return [_exact(row) for row in numbers] if np.ndim(numbers) else flint.fmpq(*float(numbers).as_integer_ratio())


def _product(A: list, B: list) -> list:
    return [
        [functools.reduce(operator.add, map(operator.mul, row, column)) for column in zip(*B, strict=True)] for row in A
    ]


def _trace(A: list) -> flint.fmpq_mpoly:
    return functools.reduce(operator.add, (A[i][i] for i in range(len(A))))


def _determinant(A: list) -> flint.fmpq_mpoly:
    minors = [[row[:j] + row[j + 1 :] for row in A[1:]] for j in range(len(A))]
    terms = [(-1) ** j * A[0][j] * (_determinant(minor) if minor else 1) for j, minor in enumerate(minors)]
    return functools.reduce(operator.add, terms)


def _exact_roots(E: np.ndarray, J: np.ndarray, target: np.ndarray) -> np.ndarray:
    r"""Return the first coordinates of X of all values on matrices of four rows, by an exact resultant.

    X^4 = c_1 X^2 - c_0, so W = X + a + b X^2 with a^2 - b^2 c_0 = 1 and 2ab + b^2 c_1 = 1, and the momenta
    -tr(J E_i W) are r where L_i = -tr(J E_i X) - r_i = b tr(J E_i X^2) = b Q_i. Without a and b = L_1/Q_1 there are
    L_1 Q_2 = L_2 Q_1 and (Q_1^2 - c_1 L_1^2)^2 = 4 L_1^4 c_0 + 4 L_1^2 Q_1^2, of which L_1 = Q_1 = 0 and X = 0 are no
    values.
    """
    ring = flint.fmpq_mpoly_ctx.get(("x", "y"), flint.Ordering.lex)
    x, y = ring.gens()
    (first, other), arms, r = _exact(E), _exact(J @ E), _exact(target)
    X = [[x * a + y * b for a, b in zip(*rows, strict=True)] for rows in zip(first, other, strict=True)]
    square = _product(X, X)
    c0, c1 = _determinant(X), _trace(square) * flint.fmpq(1, 2)
    L = [-_trace(_product(arm, X)) - s for arm, s in zip(arms, r, strict=True)]
    Q = [_trace(_product(arm, square)) for arm in arms]
    second = (Q[0] ** 2 - c1 * L[0] ** 2) ** 2 - 4 * L[0] ** 4 * c0 - 4 * L[0] ** 2 * Q[0] ** 2
    result = (L[0] * Q[1] - L[1] * Q[0]).resultant(second, "y")
    for factor, power in ((L[0].resultant(Q[0], "y"), 4), (x, 8)):
        for _ in range(power):
            result, rest = divmod(result, factor)
            assert rest == 0
    terms = {power[0]: value for power, value in result.to_dict().items()}
    polynomial = flint.fmpq_poly([terms.get(i, flint.fmpq(0)) for i in range(max(terms) + 1)])
    return np.array([complex(root) for root, _ in polynomial.numer().complex_roots()])


@pytest.mark.profile("routes", instead="test_every_value_solves_the_equations")
@pytest.mark.parametrize("name", ["SO(4)", "Sp(4)", "SO(3,1)"])
def test_values_are_the_roots_of_an_exact_resultant(name: str) -> None:
    """Two rows on groups of matrices of four rows: as many values as the exact polynomial has roots, and the same X."""
    discrete, r, values = _values(name, 2)
    body, W = discrete.system, values.displacement
    x = body.group.vee((W - np.linalg.inv(W)) / 2) @ np.linalg.pinv(body.constraint_subspace)
    rows = body.group.hat(body.constraint_subspace)
    roots = _exact_roots(rows, np.asarray(body.homogeneous_mass_tensor), H * r)
    assert len(values) == len(roots) == 8
    apart = np.abs(x[:, :1] - roots) / (1 + np.abs(roots))
    assert apart.min(axis=0).max() < 1e-9
    assert apart.min(axis=1).max() < 1e-9


@pytest.mark.profile("routes", instead="test_every_value_solves_the_equations")
def test_a_free_top_has_the_roots_of_the_riccati_equation() -> None:
    """Of the 8 solutions of Moser's and Veselov's equation, one for each Lagrangian subspace, 4 are rotations."""
    discrete, r, values = _values("SO(3)", 3)
    J, M = np.asarray(discrete.system.homogeneous_mass_tensor), H * nh.SO(3).hat(r)
    hamiltonian = np.block([[-M / 2, -np.eye(3)], [-M @ M / 4 - J @ J, -M / 2]])
    eigenvalues, vectors = np.linalg.eig(hamiltonian)
    order = np.argsort(np.real(eigenvalues) + 1e-3 * np.imag(eigenvalues))
    rotations = []
    for chosen in itertools.product((0, 1), repeat=3):
        V = vectors[:, [order[i] if one else order[5 - i] for i, one in enumerate(chosen)]]
        W = (M / 2 + V[3:] @ np.linalg.inv(V[:3])) @ np.linalg.inv(J)
        if np.linalg.det(W).real > 0:
            rotations.append(W)
    assert len(rotations) == len(values) == 4
    assert np.abs(np.array(rotations)[:, None] - values.displacement).max((2, 3)).min(axis=0).max() < 1e-9


_J3 = np.array([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
FORMED = {
    "top": nh.SuslovTop(_J3),
    "sleigh": nh.ChaplyginSleigh(1.0, 0.7, 5.0, 0.3),
    "top on SO(4)": nh.SuslovTop(np.diag([1.0, 2.0, 1.5, 0.7]) + 0.1),
    "sleigh on SE(3)": nh.MultidimensionalSleigh(1.3, [0.3, 0.2, -0.1], np.diag([0.5, 0.7, 0.4]) + 0.1),
}


@pytest.mark.profile("routes", instead="test_every_value_solves_the_equations")
@pytest.mark.parametrize("name", FORMED)
def test_tops_and_sleighs_have_the_values_of_their_closed_form(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without their normal form: the same displacements in the same order, the same fold distance of tops, one tree."""
    discrete = nh.discretize(FORMED[name], H)
    r = 0.4 * np.cos(np.arange(discrete.system.rank))
    expected = nh.displacements_over(discrete, r)
    monkeypatch.setattr(_sections, "has_frame", lambda _: False)
    followed = nh.displacements_over(discrete, r)
    assert len(followed) == len(expected)
    apart = np.abs(followed.displacement[:, None] - expected.displacement).max((2, 3))
    size = np.abs(expected.displacement).max()
    assert max(apart.min(axis=0).max(), apart.min(axis=1).max()) < 1e-9 * size
    assert followed.principal == expected.principal == 0
    if not discrete.system.group.is_affine:
        real = expected.is_real
        assert np.abs(np.sort(followed.fold_distance[real]) - np.sort(expected.fold_distance[real])).max() < 1e-9


LORENTZ = ("SO(2,1) oblique", 2)


@pytest.mark.profile("routes", instead="test_every_value_solves_the_equations")
def test_branches_follow_a_displacement() -> None:
    """The displacement of a momentum and back, its values, and the images of images: 4, 16."""
    discrete, r = _body(*LORENTZ), np.array([0.2, 0.1])
    values = nh.displacements_over(discrete, r)
    W = values.displacement[0].real
    assert np.abs(nh.inverse_discrete_legendre(discrete, values.momentum[0].real) - W).max() < 1e-9
    after = nh.step(discrete, r)
    assert after.outcome == 0
    for following in (nh.branches(discrete, displacement=W), nh.branches(discrete, momentum=r)):
        assert np.abs(following.momentum[following.principal] - after.momentum).max() < 1e-9
    assert nh.branch_tree(discrete, W, 2).counts.tolist() == [1, 4, 16]
    certified = nh.displacements_over(discrete, r, certify=True)
    assert not certified.certified
    assert "observed" in certified.uncertified


@pytest.mark.profile("routes", instead="test_every_value_solves_the_equations")
def test_the_fold_distance_is_that_of_the_momenta() -> None:
    """Against differences of the chart: the least singular value along S, seen from W; 1 at the identity."""
    discrete = _body("SO(4)", 2)
    body, group = discrete.system, discrete.system.group
    assert nh.fold_distance(discrete, group.identity) == pytest.approx(1.0, abs=1e-12)
    run = nh.simulate(discrete, momentum=[1.3, -0.8], steps=1)
    W, step = run.displacement[0], 1e-5
    r = run.restricted_momentum[0]
    moved = [
        [nh.simulate(discrete, momentum=r + s * step * e, steps=1).displacement[0] for s in (1, -1)] for e in np.eye(2)
    ]
    turns = np.array([group.vee(np.linalg.inv(W) @ (plus - minus)) / (2 * step * H) for plus, minus in moved]).T
    expected = 1 / np.linalg.svd(turns @ body.constrained_inertia, compute_uv=False)[0]
    assert nh.fold_distance(discrete, W) == pytest.approx(expected, rel=1e-6)
    assert 0 < expected < 0.999


_WIDE, _KNOWN = "must have matrices of at most 5 rows and a constraint of rank 1 to 4", "must have a mass tensor"
# A step that is no polynomial, matrices that are too large, and half-turns off the variety are refused with the reason.
test_what_has_no_values_is_refused = refusals(
    (
        lambda: nh.displacements_over(nh.discretize(nh.RigidBody(np.eye(4)), H), np.ones(6)),
        f"{_WIDE}.*4 rows and rank 6",
    ),
    (lambda: nh.displacements_over(_body("SO(6)", 1), [0.1]), f"{_WIDE}.*6 rows and rank 1"),
    (lambda: nh.displacements_over(_body("SO(3)", 0), []), f"{_WIDE}.*3 rows and rank 0"),
    (lambda: nh.fold_distance(_body("SO(2,1)", 1), np.diag([-1.0, -1.0, 1.0])), "must lie on the displacement var"),
    (lambda: nh.branch_tree(nh.discretize(nh.RigidBody(np.eye(3)), H, "logarithmic"), np.eye(3), 1), _KNOWN),
)
