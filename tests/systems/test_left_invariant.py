"""Left-invariant systems of any dimension: inertia, rows, energy, drift and equilibria against their definitions."""

import dataclasses

import jax
import numpy as np
import pytest
from groups.examples import HEISENBERG
from refusals import refusals

import nonholo as nh
from nonholo import LLSystem, MultidimensionalSleigh, RigidBody, SuslovTop, reference_point_subspace
from nonholo.systems import SYSTEMS, AbstractLLSystem


def _points(n: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Mass points in general position: masses and positions."""
    rng = np.random.default_rng(seed)
    return rng.uniform(0.2, 1.0, size=2 * n), rng.normal(size=(2 * n, n))


def _mass_tensor(n: int) -> np.ndarray:
    masses, points = _points(n)
    return (masses[:, None] * points).T @ points


def _homogeneous(n: int) -> np.ndarray:
    masses, points = _points(n)
    lifted = np.column_stack([points, np.ones(len(points))])
    return (masses[:, None] * lifted).T @ lifted


def _sleigh(n: int) -> MultidimensionalSleigh:
    """The sleigh of the mass points."""
    masses, points = _points(n)
    center = masses @ points / masses.sum()
    return MultidimensionalSleigh(masses.sum(), center, (masses[:, None] * (points - center)).T @ (points - center))


def _random_rows(k: int, dim: int) -> np.ndarray:
    return np.random.default_rng(5).normal(size=(k, dim))


SYSTEMS_OF_POINTS = [
    *(SuslovTop(_mass_tensor(n)) for n in (3, 4, 6)),
    *(RigidBody(_mass_tensor(n)) for n in (3, 5)),
    *(RigidBody(_homogeneous(n), nh.SE(n)) for n in (2, 3)),
    *(_sleigh(n) for n in (3, 4)),
    LLSystem(nh.SO(4), _mass_tensor(4), _random_rows(2, 6)),
    LLSystem(nh.SE(3), _homogeneous(3), annihilator=_random_rows(2, 6)),
    LLSystem(nh.SE(3), _homogeneous(3), reference_point_subspace(3, [[1.0, 1.0, 0.0]])),
]


def _name(system: AbstractLLSystem) -> str:
    return f"{type(system).__name__}-{system.group!r}-{len(system.constraint_subspace)}"


@pytest.mark.parametrize("system", SYSTEMS_OF_POINTS, ids=_name)
def test_inertia_is_the_kinetic_energy_of_the_mass_points(system: AbstractLLSystem) -> None:
    """<xi, I xi> is the sum of m |X r|^2 over the points of the body, X the matrix of the body velocity."""
    n = system.group.identity.shape[0] - (repr(system.group)[:2] == "SE")
    masses, points = _points(n)
    if system.group.identity.shape[0] > n:
        points = np.column_stack([points, np.ones(len(points))])
    xi = np.random.default_rng(1).normal(size=system.group.dim)
    speeds = points @ system.group.hat(xi).T
    assert xi @ system.inertia_operator @ xi == pytest.approx(masses @ (speeds**2).sum(axis=1), rel=1e-13)


def test_documented_rows() -> None:
    """Rows and annihilators are the coordinates that the contract prints."""
    sleigh = _sleigh(3)
    assert sleigh.constraint_subspace.tolist() == [[0, 0, -1, 0, 0, 0], [0, 1, 0, 0, 0, 0], [0, 0, 0, 1, 0, 0]]
    assert sleigh.annihilator.tolist() == [[1, 0, 0, 0, 0, 0], [0, 0, 0, 0, 1, 0], [0, 0, 0, 0, 0, 1]]
    top = SuslovTop(np.diag([1.0, 2.0, 3.0, 4.0]))
    assert top.annihilator.tolist() == [[1, 0, 0, 0, 0, 0], [0, 1, 0, 0, 0, 0], [0, 0, 0, 1, 0, 0]]
    assert SuslovTop(np.eye(3)).constraint_subspace.tolist() == [[0, 1, 0], [-1, 0, 0]]


@pytest.mark.parametrize("k", [0, 6])
def test_extreme_constraints(k: int) -> None:
    """No admissible velocity at all, and no constraint at all, are systems like any other."""
    system = LLSystem(nh.SO(4), _mass_tensor(4), np.eye(6)[:k])
    assert system.annihilator.shape == (6 - k, 6)
    assert system.constrained_inertia.shape == system.frame_map.shape == (k, k)
    assert system.constrained_energy(np.zeros(k)) == 0
    assert LLSystem(nh.SO(4), _mass_tensor(4), annihilator=np.eye(6)[k:]).constraint_subspace.shape == (k, 6)


def test_coordinate_rows_are_kept() -> None:
    """The complement of coordinate rows is made of coordinate rows, that of others is orthonormal and unique."""
    assert LLSystem(nh.SO(3), np.eye(3), [[0, 2.0, 0]]).annihilator.tolist() == [[1, 0, 0], [0, 0, 1]]
    rows = _random_rows(3, 6)
    result, mixed = (LLSystem(nh.SO(4), np.eye(4), S).annihilator for S in (rows, _random_rows(3, 3) @ rows))
    assert np.allclose(result @ result.T, np.eye(3), rtol=0, atol=1e-14)
    assert np.allclose(result, mixed, rtol=0, atol=1e-13)


def test_a_group_of_ones_own() -> None:
    """On the Heisenberg group an inertia operator makes a system, a mass tensor is refused with that remedy."""
    inertia = np.diag([1.0, 2.0, 3.0])
    system = LLSystem(HEISENBERG, constraint_subspace=np.eye(3)[:2], inertia_operator=inertia)
    assert system.constrained_inertia.tolist() == [[1, 0], [0, 2]]
    assert system.equilibria().subspace.shape == (2, 3)  # [d, d] is the center, on which momenta in d vanish
    with pytest.raises(ValueError, match=r"must be used on SO\(n\) or SE\(n\).*Pass inertia_operator= instead"):
        LLSystem(HEISENBERG, inertia, np.eye(3)[:2])


def test_reference_point_subspace() -> None:
    """All rotations, and velocities of the reference point in the plane."""
    rows = reference_point_subspace(3, [[1.0, 1.0, 0.0], [0.0, 0.0, 2.0]])
    assert rows.shape == (5, 6)
    assert np.array_equal(rows[:3], np.eye(6)[:3])
    assert np.array_equal(rows[3:, 3:], [[1, 1, 0], [0, 0, 2]])
    assert reference_point_subspace(4, []).shape == (6, 10)


@pytest.mark.parametrize("system", SYSTEMS_OF_POINTS, ids=_name)
def test_parameters_may_be_traced(system: AbstractLLSystem) -> None:
    """The inertia operator, mass tensor and constrained inertia of traced leaves are those of concrete ones."""

    def numbers(leaves: dict[str, jax.Array]) -> tuple[jax.Array, ...]:
        traced = _rebuilt(system, leaves)
        return traced.inertia_operator, traced.homogeneous_mass_tensor, traced.constrained_inertia

    with jax.enable_x64(True):
        leaves = {name: getattr(system, name) for name in system.leaves if getattr(system, name) is not None}
        for traced, concrete in zip(jax.jit(numbers)(leaves), numbers(leaves), strict=True):
            assert np.allclose(traced, concrete, rtol=1e-13, atol=1e-13)


def _rebuilt(system: AbstractLLSystem, leaves: dict[str, jax.Array]) -> AbstractLLSystem:
    structure = {name: getattr(system, name) for name in system.structure}
    return type(system)(**leaves, **structure)


def test_every_class_declares_its_fields() -> None:
    """Leaves and structure together are the fields of a system, each once."""
    for kind in SYSTEMS:
        assert sorted(kind.leaves + kind.structure) == sorted(field.name for field in dataclasses.fields(kind))


def test_repr_names_what_is_shown() -> None:
    """For n > 3 the mass tensor alone is shown: tr(J) Id - J is not an inertia tensor there."""
    text = repr(SuslovTop(np.diag([1.0, 2.0, 3.0, 4.0])))
    assert "n=4" in text
    assert "mass tensor J" in text
    assert "inertia" not in text
    assert "inertia operator" in repr(LLSystem(nh.SO(3), constraint_subspace=[[1, 0, 0]], inertia_operator=np.eye(3)))
    assert "SE(2)" in repr(RigidBody(_homogeneous(2), nh.SE(2)))


# Each error names the owner, the requirement, what was got and the remedy.
test_bad_input_is_refused = refusals(
    (lambda: SuslovTop(np.eye(4), axis=(0, 0, 1)), r"axis=\.\.\.\)` must be left out for n > 3. Got an axis for n = 4"),
    (lambda: SuslovTop(np.eye(4)[:3]), r"shape \(n, n\) with n >= 3. Got shape \(3, 4\)"),
    (lambda: SuslovTop(np.diag([-9.0, 1, 1, 1])), "along the constraint positive definite. Got an eigenvalue -8"),
    (lambda: LLSystem(nh.SO(3)), r"LLSystem\(mass_tensor=.*must be given, or else inertia_operator=. Got neither"),
    (lambda: LLSystem(nh.SO(3), np.eye(3), np.eye(3), inertia_operator=np.eye(3)), "Got both"),
    (lambda: LLSystem(nh.SO(3), np.eye(3)), "be given, or annihilator=. Got neither"),
    (lambda: LLSystem(nh.SO(3), np.eye(4), np.eye(3)), r"shape \(3, 3\). Got shape \(4, 4\). On SO\(3\)"),
    (lambda: LLSystem(nh.SE(3), np.eye(3), np.eye(6)), r"shape \(4, 4\). Got shape \(3, 3\).*homogeneous on SE"),
    (lambda: LLSystem(nh.SO(3), np.eye(3), np.eye(2)), r"shape \(any, 3\). Got shape \(2, 2\)"),
    (lambda: LLSystem(nh.SO(3), np.eye(3), [[1, 2, 3], [2, 4, 6]]), r"independent rows. Got 2 rows.*1.*e-1\d \(2\)"),
    (lambda: LLSystem(nh.SO(3), np.eye(3), np.ones((4, 3))), "independent rows. Got 4 rows"),
    (lambda: LLSystem(nh.SO(3), np.eye(3), [[0, 0, 0]]), "independent rows"),
    (lambda: LLSystem(nh.SO(3), np.eye(3), [[1, 0, 0]], annihilator=[[0, 1, 0]]), "have 2 rows, the codimension"),
    (
        lambda: LLSystem(nh.SO(3), np.eye(3), [[1, 0, 0]], annihilator=[[0, 1, 0], [0.1, 0, 1]]),
        "vanish on the constraint subspace. Got a pairing of 0.1",
    ),
    (lambda: LLSystem(nh.SO(3), np.diag([-3.0, 1, 1]), [[0, 0, 1]]), "positive definite. Got an eigenvalue -2"),
    (lambda: LLSystem(nh.SO(3), None, np.eye(3), inertia_operator=np.triu(np.ones((3, 3)))), "symmetric"),
    (lambda: LLSystem(nh.SO(3), None, np.eye(3), inertia_operator=np.eye(2)), r"shape \(3, 3\). Got shape \(2, 2\)"),
    (lambda: LLSystem(nh.SO(3), np.full((3, 3), np.inf), np.eye(3)), "finite. Got inf"),
    (lambda: RigidBody(np.diag([1.0, 2, 3, 4])).equilibria(), r"at most three admissible directions\. Got 6, in wh"),
    (lambda: LLSystem(nh.SO(4), _mass_tensor(4), np.eye(6)[:4]).equilibria(), r"LLSystem\.equilibria\(\)"),
    (lambda: RigidBody(np.eye(3)).transverse_rates([1, 0], np.eye(3)), r"\(velocity=\.\.\.\)` must have shape \(3,\)"),
    (lambda: RigidBody(np.diag([1.0, 0, 0])), "inertia operator positive definite. Got an eigenvalue 0"),
    (lambda: RigidBody(None), r"RigidBody\(mass_tensor=\.\.\.\)` must be an array of real numbers. Got None"),
    (lambda: RigidBody(np.eye(3), nh.SE(3)), r"shape \(4, 4\). Got shape \(3, 3\)"),
    (lambda: MultidimensionalSleigh(0.0, [1, 0, 0], np.eye(3)), r"mass=\.\.\.\)` must be positive"),
    (lambda: MultidimensionalSleigh(1.0, [1, 0], np.eye(2)), "at least 3 coordinates. Got 2. In the plane"),
    (lambda: MultidimensionalSleigh(1.0, [1, 0, 0], np.eye(4)), r"shape \(3, 3\). Got shape \(4, 4\)"),
    (lambda: MultidimensionalSleigh(1.0, [0, 0, 0], np.diag([-2.0, 1, 1])), "positive definite. Got an eigenvalue -1"),
    (lambda: reference_point_subspace(1, [[1.0]]), "at least 2. Got 1"),
    (lambda: reference_point_subspace(3, [[1.0, 0.0]]), r"plane=\.\.\.\)` must have shape \(any, 3\)"),
    (lambda: nh.SuslovTop([[1, 0.1, 0], [0.3, 1, 0], [0, 0, 1]]), r"symmetric.*entries 0.1 and 0.3 at \(0, 1\)"),
    (lambda: nh.SuslovTop(np.eye(2)), r"shape \(n, n\) with n >= 3. Got shape \(2, 2\)"),
    (lambda: nh.SuslovTop(np.full((3, 3), np.nan)), r"finite. Got nan at index \(0, 0\)"),
    (lambda: nh.SuslovTop(1j * np.eye(3)), "be real"),
    (lambda: nh.SuslovTop(np.eye(3), axis=(0, 0, 2)), "unit vector. Got length 2"),
    (lambda: nh.SuslovTop.from_inertia(np.eye(3) + np.eye(3, k=1)), r"from_inertia.*symmetric"),
    (lambda: nh.ChaplyginSleigh(-1.0, 1.0, 0.5), r"mass=\.\.\.\)` must be positive. Got -1.0"),
    (lambda: nh.ChaplyginSleigh(1.0, 0.0, 0.5), r"inertia=\.\.\.\)` must be positive. Got 0.0.*center of mass"),
    (lambda: nh.ChaplyginSleigh(1.0, 1.0, np.inf), r"a=\.\.\.\)` must be finite"),
    (lambda: nh.ChaplyginSleigh(1.0, 1.0, "x"), "real numbers. Got 'x'"),
    (lambda: jax.jit(lambda S: LLSystem(nh.SO(3), np.eye(3), S).frame)(np.eye(3)), r"be concrete\. Got a traced value"),
)


def test_an_inertia_that_overflows_is_refused() -> None:
    """Finite entries whose sums are not finite are no inertia, and LAPACK is not asked."""
    with np.errstate(over="ignore", invalid="ignore"), pytest.raises(ValueError, match=r"finite\. Got an overflow"):
        MultidimensionalSleigh(1e150, [1e150, 0.0, 0.0], np.eye(3))


@pytest.mark.parametrize("length", [1e-9, 1e9])
def test_lengths_in_any_unit(length: float) -> None:
    """Inertias that mix angles with lengths of nanometers are as positive as others."""
    sleigh = MultidimensionalSleigh(1.0, np.array([0.5, 0.2, 0.1]) * length, np.diag([0.6, 0.4, 0.2]) * length**2)
    unit = np.sqrt(np.diag(sleigh.constrained_inertia))  # eigenvalues of so different sizes have no digits without it
    assert np.all(np.linalg.eigvalsh(sleigh.constrained_inertia / np.outer(unit, unit)) > 0.5)


INERTIA = np.array([[3.0, 0.1, 0.2], [0.1, 2.0, 0.3], [0.2, 0.3, 2.5]])


def test_from_inertia_keeps_the_documented_rows() -> None:
    """Rows are S(0,1,0), S(-1,0,0) with S the shortest rotation taking e3 to the axis."""
    axis = np.array([2.0, -1.0, 2.0]) / 3
    top = nh.SuslovTop.from_inertia(INERTIA, axis)
    S = nh.SO(3).exp(np.arccos(axis[2]) * np.cross([0, 0, 1.0], axis) / np.linalg.norm(np.cross([0, 0, 1.0], axis)))
    assert np.allclose(top.constraint_subspace, np.array([[0, 1, 0], [-1, 0, 0]]) @ S.T, atol=1e-15)
    for axis in [(0, 0, -1), (1e-160, 0, -1)]:  # squares of the second one underflow
        assert np.array_equal(nh.SuslovTop.from_inertia(INERTIA, axis).frame, np.diag([1.0, -1.0, -1.0]))
    assert np.allclose(top.inertia_operator, INERTIA, atol=1e-15)
