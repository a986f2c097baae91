"""The energy theorem on groups of a form: any d, any J with J* = J, in kernels and by the definition."""

import numpy as np
import pytest
import scipy.integrate
from bodies import mass_tensor, random_rows
from comparisons import assert_near
from forms import FORMS, system, tensor, velocity

import nonholo as nh

_A_STEP = 20 * np.finfo(float).eps  # relative rounding of the energy in one step, of displacements of size one
_MOST = {"SU(1,1)": 2, "U(1,1)": 3}  # beyond, no inertia along d is definite
_CASES = [(name, k) for name, group in FORMS.items() for k in (2, 3, 4) if k <= _MOST.get(name, group.dim)]
_INDEFINITE = [("SO(2,1)", 3), ("SO(3,1)", 6), ("Sp(4)", 3), ("Sp(4)", 7), ("U(1,1)", 4), ("U(2,1)", 7)]


def _run(name: str, k: int, steps: int, *, definite: bool = True, size: float = 1.5) -> nh.Orbit:
    rng = np.random.default_rng(sum(map(ord, name)) + k)
    one = system(FORMS[name], k, rng, definite)
    start = {"restricted_velocity": velocity(one, size, rng), "configuration": one.group.random(rng)}
    return nh.simulate(nh.discretize(one, 0.1), steps=steps, throw=False, **start)


def _energy_error(orbit: nh.Orbit) -> float:
    """Return the largest change of the energy, relative to the terms of r . B^-1 r, which may be of either sign."""
    r, inverse = orbit.restricted_momentum, np.linalg.inv(orbit.system.constrained_inertia)
    terms = np.abs(r[:, :, None] * inverse * r[:, None, :]).sum(axis=(1, 2)) / 2
    return float((np.abs(orbit.energy - orbit.energy[0]) / np.maximum(terms, terms[0])).max())


def _reflection_error(orbit: nh.Orbit) -> float:
    """Return the largest miss of F(W') = -F(W^-1), relative to the size of the terms of F."""
    discrete, W = orbit.motion, orbit.displacement
    F = orbit.system.restrict(nh.discrete_legendre(discrete, W))
    mirrored = orbit.system.restrict(nh.discrete_legendre(discrete, np.linalg.inv(W)))
    size = np.abs(F).max() * max(1.0, np.abs(W).max())
    return float(np.abs(F[1:] + mirrored[:-1]).max() / size)


@pytest.mark.profile("problems", keep=["SO(2,1)-2", "Sp(4)-3"])
@pytest.mark.parametrize(("name", "k"), _CASES, ids=str)
def test_energy_of_random_systems(name: str, k: int) -> None:
    """2000 steps with a definite inertia along d: energy, reflection and constraint to rounding, while F changes."""
    orbit = _run(name, k, 2000)
    assert orbit.outcome == nh.Outcome.successful
    assert (orbit.motion.difference, orbit.motion.constraint) == ("matrix", "skew")
    assert orbit.motion.conserves_energy
    assert _energy_error(orbit) <= 2000 * _A_STEP
    assert _reflection_error(orbit) <= 1e-12
    W = orbit.displacement
    K = orbit.system.group.vee((W - np.linalg.inv(W)) / 2)
    assert np.abs(K @ orbit.system.annihilator.T).max(initial=0.0) <= 1e-12 * np.abs(K).max()
    change = np.ptp(orbit.restricted_momentum, axis=0).max() / np.abs(orbit.restricted_momentum).max()
    assert change > 0.05 or name == "SU(1,1)"


@pytest.mark.profile("problems", keep=["U(1,1)*", "SO(*"])
@pytest.mark.parametrize(("name", "k"), _INDEFINITE, ids=str)
def test_an_indefinite_inertia(name: str, k: int) -> None:
    """The level of the energy is unbounded, and orbits run off to infinity: up to there the energy is exact.

    Cayley coordinates give a displacement W to a rounding error times |W|.
    """
    lengths = []
    for seed in range(4):
        rng = np.random.default_rng(seed)
        one = system(FORMS[name], k, rng, definite=False)
        v = velocity(one, 0.5, rng)
        orbit = nh.simulate(nh.discretize(one, 0.1), restricted_velocity=v, steps=500, throw=False)
        assert _energy_error(orbit) <= len(orbit) * _A_STEP * max(1.0, np.abs(orbit.displacement).max())
        ends = nh.Outcome.successful, nh.Outcome.no_real_branch, nh.Outcome.branch_unverified, nh.Outcome.nonfinite
        assert orbit.outcome in ends
        assert orbit.system.group.residual(orbit.configuration).max() <= 1e-9
        lengths.append(len(orbit))
    assert max(lengths) > 50


def test_a_root_that_goes_to_infinity() -> None:
    """A run ends as unverified where the root of s r goes to infinity at s < 1; followed here in log W instead."""
    group = FORMS["SO(2,1)"]
    for seed in range(20):
        rng = np.random.default_rng(seed)
        one = system(group, 3, rng, definite=False)
        discrete, v = nh.discretize(one, 0.1), velocity(one, 0.5, rng)
        orbit = nh.simulate(discrete, restricted_velocity=v, steps=500, throw=False)
        if orbit.outcome == nh.Outcome.branch_unverified:
            break
    r = one.restrict(nh.discrete_legendre(discrete, orbit.displacement[-1], "right"))

    def F(x: np.ndarray) -> np.ndarray:
        return one.restrict(nh.discrete_legendre(discrete, group.exp(x)))

    def rate(_: float, x: np.ndarray) -> np.ndarray:
        return np.linalg.solve(1e6 * (F(x + 5e-7 * np.eye(3)) - F(x - 5e-7 * np.eye(3))).T, r)

    def far(_: float, x: np.ndarray) -> float:
        return 1e3 - np.abs(group.exp(x)).max()

    far.terminal = True
    path = scipy.integrate.solve_ivp(rate, (0.0, 1.0), np.zeros(3), events=far, rtol=1e-5, atol=1e-5)
    assert path.status == 1
    assert path.t[-1] < 0.99
    assert np.abs(F(path.y[:, -1]) - path.t[-1] * r).max() < 1e-4 * np.abs(r).max()


@pytest.mark.parametrize("order", [2, 4])
def test_poses_that_overflow_end_the_run(order: int) -> None:
    """Boosts grow without bound: when the pose is no longer a number the outcome is nonfinite, the energy exact."""
    group = FORMS["SO(2,1)"]
    boost = group.vee(np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]))
    discrete = nh.discretize(nh.LLSystem(group, np.eye(3), [boost]), 0.5, order=order)
    orbit = nh.simulate(discrete, restricted_velocity=[1.0], steps=20_000, throw=False)
    assert orbit.outcome == nh.Outcome.nonfinite
    assert 1e200 < np.abs(orbit.configuration[-1]).max() < np.inf
    result = nh.invariants(orbit)
    assert result.energy_drift < 1e-12
    assert result.group_residual < 1e-11


@pytest.mark.parametrize(("group", "k"), [(nh.SO(3), 2), (nh.SO(4), 3), (nh.SO(4), 6)], ids=str)
def test_rotations_are_the_group_of_the_identity(group: object, k: int) -> None:
    """SO(n) as the group of the form I, in another kernel: the same orbits to rounding."""
    rng = np.random.default_rng(k)
    J, rows, v = mass_tensor(group, rng), random_rows(group, k, rng), 0.7 * rng.normal(size=k)
    form = nh.MatrixGroup(group.basis, form=np.eye(group.size))
    one, other = (
        nh.simulate(nh.discretize(nh.LLSystem(g, J, rows), 0.1), restricted_velocity=v, steps=50) for g in (group, form)
    )
    assert_near(one, other, 1e-12, "restricted_momentum", "displacement", "configuration", "multipliers")


@pytest.mark.profile("routes", keep=["SO(2,1) oblique-2"])
@pytest.mark.parametrize(
    ("name", "k"), [("SO(2,1) oblique", 2), ("Sp(4)", 3), ("Sp(4) oblique", 2), ("U(1,1)", 3), ("SO(2,1) x Sp(2)", 3)]
)
def test_the_checks_of_users_pass(name: str, k: int) -> None:
    """System and discretization pass all properties, among them the definition in JAX and the order of two."""
    one = system(FORMS[name], k, np.random.default_rng(3))
    assert nh.testing.check_system(one).passed
    report = nh.testing.check_discretization(nh.discretize(one, 0.1))
    assert report.passed
    assert report["definition"].status == report["energy"].status == "ok"


def test_momenta_of_su_1_1_stay() -> None:
    """Its W + W^-1 is a multiple of I and every inertia one of the Killing form: F itself is conserved."""
    orbit = _run("SU(1,1)", 2, 200)
    r = orbit.restricted_momentum
    assert np.ptp(r, axis=0).max() <= 1e-12 * np.abs(r).max()


def test_a_subgroup_of_u_2_1() -> None:
    """Where cubes of d in su(2, 1) stay in d, displacements have determinant one: for SU(2, 1) take U(2, 1)."""
    group, rng = FORMS["U(2,1)"], np.random.default_rng(2)
    mixing = np.kron(np.ones((2, 2)), [[0, 0, 1], [0, 0, 1], [1, 1, 0]])  # blocks between the signs: a symmetric pair
    rows = np.linalg.svd(group.vee(group.basis * mixing))[2][:4]
    one = nh.LLSystem(group, tensor(group, rng), rows)
    while np.linalg.eigvalsh(one.constrained_inertia)[0] < 0.1:
        one = nh.LLSystem(group, tensor(group, rng), rows)
    orbit = nh.simulate(nh.discretize(one, 0.1), restricted_velocity=velocity(one, 0.8, rng), steps=1000)
    assert orbit.motion.variety.exact
    W = orbit.displacement
    assert np.abs(np.linalg.det(W[:, :3, :3] + 1j * W[:, 3:, :3]) - 1).max() < 1e-12
    assert _energy_error(orbit) <= len(orbit) * _A_STEP
    assert np.ptp(orbit.restricted_momentum, axis=0).max() > 0.01 * np.abs(orbit.restricted_momentum).max()


def test_compositions_ensembles_and_flows() -> None:
    """Order four keeps the energy and comes closer to the flow; the last member of an ensemble is a run alone."""
    one, rng = system(FORMS["SO(2,1)"], 2, np.random.default_rng(7)), np.random.default_rng(8)
    v = np.stack([velocity(one, 0.6, rng) for _ in range(3)])
    flow = nh.flow(one, restricted_velocity=v[-1], times=[0.0, 2.0], rtol=1e-12, atol=1e-13)
    errors = []
    for order in (2, 4):
        discrete = nh.discretize(one, 0.1, order=order)
        orbit = nh.simulate(discrete, restricted_velocity=v[-1], steps=20)
        batch = nh.ensemble(discrete, restricted_velocity=v, steps=20)
        assert np.array_equal(batch.restricted_momentum[-1, -1], orbit.restricted_momentum[-1])
        assert nh.invariants(orbit).energy_drift < 1e-13
        errors.append(np.abs(orbit.configuration[-1] - flow.configuration[-1]).max())
    assert errors[1] < 0.05 * errors[0]


GROUPS = [nh.SO(3), nh.SO(4), nh.SO(5), nh.SE(2), nh.SE(3)]
CASES = [(group, k) for group in GROUPS for k in range(1, group.dim + 1)]


def _orbit(group: object, k: int, constraint: str, steps: int) -> nh.Orbit:
    rng = np.random.default_rng(100 * group.dim + k)
    system = nh.LLSystem(group, mass_tensor(group, rng), random_rows(group, k, rng))
    velocity = rng.normal(size=k)
    velocity *= 1.5 / np.sqrt(2 * system.constrained_energy(system.constrained_inertia @ velocity))
    return nh.simulate(nh.discretize(system, 0.1, constraint=constraint), restricted_velocity=velocity, steps=steps)


@pytest.mark.profile("problems", keep=["S?(2)*", "SO(3)*", "SE(3)-3", "SO(4)-3", "SO(5)-5"])
@pytest.mark.parametrize(("group", "k"), CASES, ids=str)
def test_energy_of_every_dimension(group: object, k: int) -> None:
    """Random d of dimension k, 2000 steps: energy, constraint, group and reversal to rounding."""
    result = nh.invariants(_orbit(group, k, "skew", 2000))
    assert result.energy_drift <= 1e-12
    assert result.constraint_residual <= 1e-12
    assert result.group_residual <= 1e-12
    assert result.reversal_defect <= 1e-12


@pytest.mark.profile("routes", keep=["SO(4)-3"])
@pytest.mark.parametrize(("group", "k"), [(nh.SO(4), 3), (nh.SO(4), 4), (nh.SE(3), 3)], ids=str)
def test_the_exponential_constraint_drifts(group: object, k: int) -> None:
    """With exp d instead, and d no symmetric pair, the energy visibly changes."""
    orbit = _orbit(group, k, "exponential", 40)
    assert not orbit.motion.conserves_energy
    assert nh.invariants(orbit).energy_drift >= 1e-5


@pytest.mark.parametrize("constraint", ["skew", "exponential"])
def test_a_symmetric_pair_of_rank_two(constraint: str) -> None:
    """For so(4) / (so(2) + so(2)), the planes that mix (1, 2) with (3, 4), both constraints are one and conserve."""
    rows = np.eye(6)[[1, 2, 3, 4]]
    assert nh.is_symmetric_pair(nh.SO(4), rows)
    rng = np.random.default_rng(3)
    system = nh.LLSystem(nh.SO(4), mass_tensor(nh.SO(4), rng), rows)
    discrete = nh.discretize(system, 0.2, constraint=constraint)
    orbit = nh.simulate(discrete, restricted_velocity=rng.normal(size=4), steps=2000)
    assert discrete.conserves_energy
    assert nh.invariants(orbit).energy_drift <= 1e-12


def test_reversal_and_reconstruction() -> None:
    """One step back returns, poses are products of displacements, and boosts keep the direction of time."""
    orbit = _run("SO(3,1)", 3, 40)
    result = nh.invariants(orbit)
    assert result.reversal_defect <= 1e-12
    assert result.group_residual <= 1e-13
    g, W = orbit.configuration, orbit.displacement
    assert np.abs(g[1:] - g[:-1] @ W[:-1]).max() <= 1e-13 * np.abs(g).max()
    assert np.all(W[:, 3, 3] >= 1)
    assert np.all(np.linalg.det(W) > 0)
