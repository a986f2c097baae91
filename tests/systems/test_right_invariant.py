"""Right-invariant constraints: the turned inertia, energies, and the conservation of spatial momentum."""

import jax
import numpy as np
import pytest
from bodies import GENERAL, mass_tensor
from problems import EVERY
from refusals import refusals

import nonholo as nh
from nonholo.systems import AbstractLRSystem, AbstractSystem, LRSystem, VeselovaTop

_RNG = np.random.default_rng(7)
_J = mass_tensor(nh.SO(3), _RNG)
SPATIAL = {name: system for name, system in EVERY.items() if system.is_spatial} | {
    "by forbidden rows": LRSystem(nh.SE(3), mass_tensor(nh.SE(3), _RNG), annihilator=_RNG.normal(size=(2, 6))),
    "no motion": LRSystem(nh.SO(3), _J, np.empty((0, 3))),
}


@pytest.mark.parametrize("system", SPATIAL.values(), ids=SPATIAL)
def test_spatial_inertia_by_its_definition(system: AbstractLRSystem) -> None:
    """The trace form is S Ad^T I Ad S^T with Ad of the inverse, also for a stack of configurations."""
    group, S = system.group, system.constraint_subspace
    g = np.stack([group.random(_RNG) for _ in range(3)])
    result = system.spatial_inertia(g)
    for one, B in zip(g, result, strict=True):
        Ad = group.adjoint(group.inverse(one))
        assert np.allclose(B, S @ Ad.T @ system.inertia_operator @ Ad @ S.T, rtol=1e-12, atol=1e-12)
    assert np.allclose(system.spatial_inertia(group.identity), system.constrained_inertia, rtol=1e-14, atol=0)


@pytest.mark.parametrize("system", SPATIAL.values(), ids=SPATIAL)
def test_the_users_frame_is_the_canonical_one(system: AbstractLRSystem) -> None:
    """A system with a constraint in space is its own canonical form."""
    assert system.canonical is system
    assert np.array_equal(system.frame, system.group.identity)
    assert np.array_equal(system.frame_map, np.eye(len(system.constraint_subspace)))


def test_spatial_inertia_of_traced_numbers() -> None:
    """The mass tensor and the configuration may be traced, and the energy differentiated in both."""
    J, g, r = _J, nh.SO(3).exp(np.array([0.3, -0.2, 0.5])), np.array([0.4, -0.3])
    with jax.enable_x64(True):
        energy = jax.jit(lambda J, g: VeselovaTop(J).constrained_energy(r, g))
        assert float(energy(J, g)) == pytest.approx(float(VeselovaTop(J).constrained_energy(r, g)), rel=1e-14)
        slope = np.asarray(jax.grad(energy)(J, g))
    change = np.diag([1e-6, 0.0, 2e-6])
    ahead, behind = (VeselovaTop(J + sign * change).constrained_energy(r, g) for sign in (1, -1))
    assert np.sum(slope * change) == pytest.approx((ahead - behind) / 2, rel=1e-8)


def test_documented_rows_and_repr() -> None:
    """The rows of the Veselova top are those of the Suslov top; both tensors are named."""
    top = VeselovaTop(np.diag([1.0, 2.0, 3.0]))
    assert top.constraint_subspace.tolist() == [[0, 1, 0], [-1, 0, 0]]
    assert top.annihilator.tolist() == [[0, 0, 1]]
    assert VeselovaTop(np.eye(4)).annihilator.tolist() == nh.SuslovTop(np.eye(4)).annihilator.tolist()
    assert "mass tensor J" in repr(top)
    assert "constraint subspace" in repr(SPATIAL["right-invariant on SE(3)"])


# Each error names the owner, the requirement, what was got and the remedy.
test_bad_input_is_refused = refusals(
    (lambda: VeselovaTop(np.eye(2)), r"n >= 3. Got shape \(2, 2\)"),
    (lambda: VeselovaTop(np.diag([1.0, 0, 0])), "inertia operator positive definite. Got an eigenvalue 0"),
    (lambda: LRSystem(nh.SO(3), np.eye(3)), r"LRSystem\(constraint_subspace=\.\.\.\)` must be given"),
    (lambda: LRSystem(nh.SO(3), np.eye(4), np.eye(3)), r"shape \(3, 3\). Got shape \(4, 4\)"),
    (lambda: LRSystem(nh.SO(3), np.eye(3), np.ones((2, 3))), "independent rows"),
)


@pytest.fixture(params=GENERAL)
def system(request: pytest.FixtureRequest) -> AbstractSystem:
    """Return a system of either kind."""
    return GENERAL[request.param][0]


@pytest.fixture
def g(system: AbstractSystem) -> np.ndarray:
    """Return a pose."""
    return system.group.random(np.random.default_rng(3))


def test_momenta_of_velocities(system: AbstractSystem, g: np.ndarray) -> None:
    """Momenta along the constraint are those of which the velocities are known, one by one or stacked."""
    r = np.random.default_rng(1).normal(size=(3, system.rank))
    w = system.restricted_velocity(r, g)
    assert np.allclose(system.restricted_momentum(w, g), r, rtol=1e-12, atol=1e-12 * np.abs(r).max())
    assert np.allclose(system.restricted_momentum(w[1], g), r[1], rtol=1e-12, atol=1e-12 * np.abs(r).max())
    poses = np.stack([g, g, g])
    assert np.allclose(system.restricted_momentum(w, poses), r, rtol=1e-12, atol=1e-12 * np.abs(r).max())


def test_a_move_is_seen_by_the_constraint(system: AbstractSystem, g: np.ndarray) -> None:
    """A displacement along the constraint moves the pose by an admissible velocity, to second order."""
    group, size = system.group, 1e-5
    x = np.random.default_rng(2).normal(size=system.rank) @ system.constraint_subspace
    moved = system.moved(g, group.exp(size * x))
    body = group.log(group.inverse(g) @ moved) / size
    assert np.abs(system.annihilator @ system.carried(g) @ body).max(initial=0.0) < 1e-8


def test_what_the_constraint_sees(system: AbstractSystem, g: np.ndarray) -> None:
    """Its directions are those of admissible velocities; velocities and momenta as it sees them pair as before."""
    rng, E = np.random.default_rng(3), system.directions(g)  # 1e-13: sums of a few products of |Ad| below 10
    v, p = rng.normal(size=(2, system.group.dim))
    assert np.linalg.matrix_rank(E) == system.rank
    assert np.abs(system.annihilator @ system.constraint_velocity(E.T, g).T).max(initial=0.0) < 1e-13
    pairing = system.constraint_momentum(p, g) @ system.constraint_velocity(v, g)
    assert pairing == pytest.approx(p @ v, rel=0, abs=1e-13 * np.linalg.norm(p) * np.linalg.norm(v))
    assert system.components_along(p, g) == pytest.approx(E.T @ p, rel=0, abs=1e-13 * np.linalg.norm(p))


def test_poses_are_needed_in_space_alone(system: AbstractSystem) -> None:
    """Without a pose a constraint in space is refused, with the remedy; one in the body does not need it."""
    r, p = np.ones(system.rank), np.ones(system.group.dim)
    for question, value in ((system.restricted_velocity, r), (system.constrained_energy, r), (system.restrict_at, p)):
        if system.is_spatial:
            with pytest.raises(ValueError, match="be given where the constraint is fixed in space"):
                question(value)
        else:
            assert np.all(np.isfinite(question(value)))
