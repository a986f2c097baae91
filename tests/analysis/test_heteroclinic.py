"""Orbits traced both ways between equilibria, and invariant curves: energy, components, orbits that run on them."""

import numpy as np
import pytest
from bodies import ATTRACTING, mass_tensor
from refusals import refusals

import nonholo as nh
from nonholo.analysis.planar import planar_variety

SYSTEMS = {name: body for name, body in ATTRACTING.items() if name not in ("sleigh 4", "turning sleigh 4")}
TOP = SYSTEMS["top 3"]
STEP = 0.3


def _traced(name: str) -> nh.Orbit:
    discrete = nh.discretize(SYSTEMS[name], STEP)
    system = discrete.system
    start = 0.4 * np.array([1.0, -0.7, 0.5, 0.8, -0.3])[: len(system.constraint_subspace)]
    pose = system.group.random(np.random.default_rng(0))
    return nh.heteroclinic(discrete, momentum=np.asarray(system.constrained_inertia) @ start, configuration=pose)


@pytest.mark.parametrize("name", SYSTEMS)
def test_it_is_an_orbit(name: str) -> None:
    """Poses, displacements and momenta obey the equations of the map at every step, also where time is negative."""
    orbit = _traced(name).orbit
    system, g, W, P = orbit.system, orbit.configuration, orbit.displacement, orbit.momentum
    rounding = 1e-12 * max(1.0, np.abs(g).max())
    assert np.abs(g[1:] - g[:-1] @ W[:-1]).max() <= rounding
    assert np.abs(system.restrict(P[1:] - system.group.coadjoint(W[:-1], P[:-1]))).max() <= 1e-13
    assert np.abs(system.restrict(P) - orbit.restricted_momentum).max() <= 1e-13
    assert np.abs(P - nh.discrete_legendre(orbit.motion, W)).max() <= 1e-12
    assert np.ptp(orbit.energy) <= 1e-13
    assert np.allclose(np.diff(orbit.time), STEP)
    assert orbit.time[0] < -10 < 10 < orbit.time[-1]


@pytest.mark.parametrize("name", SYSTEMS)
def test_it_reaches_both_limits(name: str) -> None:
    """At both ends the velocity is the limit that `asymptotics` gives, and the last rotation inverts the first."""
    result = _traced(name)
    first, last = result.orbit.body_velocity[[0, -1]]
    assert np.abs(first - result.limits.velocity_before).max() <= 1e-13
    assert np.abs(last - result.limits.velocity_after).max() <= 1e-13
    turning = slice(-1) if result.orbit.system.group.is_rigid and "sleigh" in name else slice(None)
    W = result.orbit.displacement[[0, -1], turning, turning]
    if name != "turning sleigh 3":  # whose advance u is kept
        assert np.abs(W[0] @ W[1] - np.eye(len(W[0]))).max() <= 1e-12


@pytest.mark.parametrize("name", ["top 3", "top 4", "sleigh 2"])
def test_the_given_point_has_time_zero(name: str) -> None:
    """At time zero momentum, displacement and pose are those that were given; steps from there are those of a run."""
    discrete = nh.discretize(SYSTEMS[name], STEP)
    system = discrete.system
    rows, pose = system.constraint_subspace, system.group.random(np.random.default_rng(1))
    W = system.group.cayley(0.3 * np.array([1.0, -0.7, 0.5])[: len(rows)] @ rows)
    orbit = nh.heteroclinic(discrete, displacement=W, configuration=pose).orbit
    run = nh.simulate(discrete, displacement=W, configuration=pose, steps=20)
    now = int(np.flatnonzero(orbit.time == 0)[0])
    for quantity in ("momentum", "displacement", "configuration", "time"):
        ahead = getattr(orbit, quantity)[now : now + 21]
        assert np.abs(ahead - getattr(run, quantity)).max() <= 1e-13
    assert np.abs(orbit.displacement[now] - W).max() <= 1e-14
    behind = nh.simulate(discrete, momentum=orbit.restricted_momentum[now - 30], steps=30)
    assert np.abs(behind.displacement[-1] - W).max() <= 1e-11  # repelling, so errors grow


@pytest.mark.parametrize("name", ["top 3", "top 3, tilted", "sleigh 2", "sleigh 2, backward"])
def test_an_energy_names_the_orbit_through_the_middle(name: str) -> None:
    """It has that energy, is at time zero where the Lyapunov function vanishes, and on the side that was asked for."""
    discrete = nh.discretize(SYSTEMS[name], STEP)
    for side in (1, -1):
        orbit = nh.heteroclinic(discrete, energy=0.3, side=side).orbit
        now = int(np.flatnonzero(orbit.time == 0)[0])
        assert orbit.energy == pytest.approx(0.3, rel=1e-13)
        assert abs(nh.lyapunov_function(discrete.system)(orbit.momentum[now])) <= 1e-15
        sides = nh.half_planes(discrete, momentum=orbit.momentum[now - 20 : now + 20]).side
        assert np.all(np.sign(sides) == side)


_TOP, _ENERGY = nh.discretize(TOP, STEP), {"energy": 1.0}
# Each refusal names what is missing.
test_what_cannot_be_traced_is_refused = refusals(
    (_TOP, {}, "be given exactly one of energy, momentum, displacement. Got none"),
    (_TOP, {"energy": 1.0, "momentum": [1.0, 0.0]}, "Got energy and momentum"),
    (_TOP, {"energy": -1.0}, "positive"),
    (_TOP, {"energy": 1.0, "side": 0}, "be one of 1, -1"),
    (_TOP, {"displacement": np.eye(3)}, "start off the equilibria"),
    (nh.discretize(SYSTEMS["top 4"], STEP), _ENERGY, "Got 3 admissible directions"),
    (nh.discretize(nh.SuslovTop(np.eye(3)), STEP), _ENERGY, "have attracting equilibria"),
    (nh.discretize(TOP, STEP, difference="logarithmic"), _ENERGY, "whose map keeps energy"),
    (nh.discretize(nh.RigidBody(np.eye(3)), STEP), _ENERGY, "be a top or a sleigh"),
    (nh.discretize(TOP, 1e-6), _ENERGY, r"`heteroclinic\(\.\.\.\)` must settle within 1000000 steps"),
    ask=lambda discrete, options: nh.heteroclinic(discrete, **options),
)


def test_a_branch_that_ends_is_refused() -> None:
    """Where the principal branch ends on the way the run says so."""
    discrete = nh.discretize(TOP, 1.0)
    with pytest.raises(nh.OutcomeError):
        nh.heteroclinic(discrete, energy=1.05 * nh.critical_energies(discrete).saddle)


HALF = nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 0.5)
TILTED = nh.discretize(nh.SuslovTop.from_inertia(np.diag([3.0, 2.0, 1.5]), axis=np.array([2.0, 1.0, 2.0]) / 3), 0.3)
BALANCED = nh.discretize(nh.SuslovTop(np.diag([1.0, 2.0, 3.0])), 0.5)
ROD = nh.discretize(nh.SuslovTop([[1.0, 0.1, 0.9], [0.1, 0.3, 0.2], [0.9, 0.2, 1.1]]), 0.5)  # D < 2 |c|^2
SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.3), 0.5)
HEAVY = nh.discretize(nh.ChaplyginSleigh(6.0, 1.0, -0.5, 0.3), 0.5)  # m a^2 > J: no saddle
EVEN = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.0, 0.3), 0.5)

CASES = [(HALF, e) for e in (0.3, 2.0, 4.4)]
CASES += [(TILTED, 2.0), (BALANCED, 2.0), (BALANCED, 9.0), (ROD, 0.5), (ROD, 4.0)]
CASES += [(SLEIGH, e) for e in (0.5, 2.1, 6.0)]
CASES += [(HEAVY, 2.0), (HEAVY, 20.0), (EVEN, 0.5), (EVEN, 3.0)]

# number of components below and above each critical energy; the last entry is above the largest
COUNTS = [(HALF, [0.5, 2.0, 4.4, 5.2], [2, 2, 2, 0]), (SLEIGH, [1.9, 2.1, 3.3], [1, 2, 1]), (HEAVY, [11, 13], [1, 1])]


@pytest.mark.parametrize(("discrete", "energy"), CASES)
def test_every_point_has_the_energy(discrete: nh.Discretization, energy: float) -> None:
    """Momenta of all points have the energy, by the definition; far out on the balanced sleigh rounding is larger."""
    curve = nh.invariant_curve(discrete, energy)
    assert curve.components
    for p in curve.momentum:
        assert np.allclose(discrete.system.constrained_energy(discrete.system.restrict(p)), energy, rtol=1e-12)


@pytest.mark.parametrize(("discrete", "energy"), CASES)
def test_momenta_lie_on_the_locus(discrete: nh.Discretization, energy: float) -> None:
    """The curve is part of the surface: the polynomial vanishes, to rounding, which grows with the degree three."""
    implicit = nh.momentum_locus(discrete, 3).implicit
    for p in nh.invariant_curve(discrete, energy).momentum:
        assert np.abs(implicit(p)).max() <= 1e-12 * max(1.0, np.abs(0.5 * p).max() ** 3)


@pytest.mark.parametrize(("discrete", "energies", "counts"), COUNTS)
def test_number_of_components(discrete: nh.Discretization, energies: list[float], counts: list[int]) -> None:
    """Inner and outer curve of a top, two about its maxima, none above; the sleigh has a second one between saddles."""
    assert [len(nh.invariant_curve(discrete, energy).components) for energy in energies] == counts


@pytest.mark.profile("problems", keep=["[0-4]"])
@pytest.mark.parametrize("seed", range(12))
def test_curves_of_random_bodies(seed: int) -> None:
    """Whatever the arcs that make them up: closed, without jumps, and every change of sign on a grid is near them."""
    rng = np.random.default_rng(seed)
    discrete = nh.discretize(nh.SuslovTop(mass_tensor(nh.SO(3), rng)), 1.0)
    locus = nh.momentum_locus(discrete, 60)
    energies = discrete.system.constrained_energy(discrete.system.restrict(locus.momentum))
    energy = rng.uniform(0.02, 0.98) * energies.max()
    curves = nh.invariant_curve(discrete, energy, 1000).displacement
    for W in curves:
        assert np.array_equal(W[0], W[-1])
        assert np.abs(np.diff(W, axis=0)).max() < 0.2  # entries are between -1 and 1
    near = np.concatenate([W.reshape(-1, 9) for W in curves])
    grid = locus.displacement[:-1][(energies[:-1] - energy) * (energies[1:] - energy) < 0].reshape(-1, 9)
    assert max(np.linalg.norm(near - W, axis=1).min() for W in grid) < 0.15  # steps of the grid are 0.075


@pytest.mark.parametrize("fraction", [0.5, 1.0, 1.5])
def test_sleigh_levels_at_their_critical_energies(fraction: float) -> None:
    """Just below and above h^2 E = 2M a second oval appears; just above I^2/(2J) both have become one curve."""
    sleigh = nh.ChaplyginSleigh(1.0, 1.0, 0.5 * fraction)
    M, whole = 0.25 * fraction**2, 1.0 + 0.25 * fraction**2
    result = [
        len(nh.invariant_curve(nh.discretize(sleigh, 0.5), 4 * level * side).components)
        for level in (2 * M, whole**2 / 2)
        for side in (1 - 1e-9, 1 + 1e-9)
    ]
    assert result == [1, 2, 2, 1]


@pytest.mark.parametrize("discrete", [HALF, TILTED, BALANCED, SLEIGH, HEAVY, EVEN])
def test_orbits_run_on_their_curve(discrete: nh.Discretization) -> None:
    """Every displacement of an orbit is one of the two points of its curve over its direction, to 1e-10."""
    orbit = nh.simulate(discrete, restricted_velocity=(0.5, -0.9), steps=80)
    curve = nh.invariant_curve(discrete, orbit.energy[0])
    for point in planar_variety(discrete.system).points(orbit.displacement):
        if isinstance(discrete.system, nh.SuslovTop):
            upper = point * (1.0 if point[0] >= 0 else -1.0)
            result = curve.over(np.arctan2(upper[2], upper[1]))
            assert np.abs(result - upper).max(axis=1).min() < 1e-10
        else:
            assert np.abs(curve.over(point[0]) - point).max(axis=1).min() < 1e-10


def test_refuses_an_energy_that_is_not_positive() -> None:
    """Energy zero is a point and not a curve: refused in words."""
    with pytest.raises(ValueError, match=r"`invariant_curve\(energy=...\)` must be positive"):
        nh.invariant_curve(HALF, 0.0)
