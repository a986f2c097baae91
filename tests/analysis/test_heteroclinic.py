"""Orbits traced both ways: they are orbits, and run from the repelling to the attracting equilibrium."""

import numpy as np
import pytest
from bodies import ATTRACTING

import nonholo as nh
from nonholo.discrete import Discretization

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
    found = _traced(name)
    first, last = found.orbit.body_velocity[[0, -1]]
    assert np.abs(first - found.limits.velocity_before).max() <= 1e-13
    assert np.abs(last - found.limits.velocity_after).max() <= 1e-13
    turning = slice(-1) if found.orbit.system.group.is_rigid and "sleigh" in name else slice(None)
    W = found.orbit.displacement[[0, -1], turning, turning]
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


def test_limits_in_space_and_turn() -> None:
    """The turn of a traced sleigh is the total turn that `asymptotics` finds for it."""
    found = nh.heteroclinic(nh.discretize(SYSTEMS["sleigh 2"], STEP), energy=0.3)
    assert found.limits.heading_turn == pytest.approx(np.ptp(found.orbit.heading), rel=1e-12)


@pytest.mark.parametrize(
    ("discrete", "options", "text"),
    [
        (nh.discretize(TOP, STEP), {}, "be given exactly one of energy, momentum, displacement. Got none"),
        (nh.discretize(TOP, STEP), {"energy": 1.0, "momentum": [1.0, 0.0]}, "Got energy and momentum"),
        (nh.discretize(TOP, STEP), {"energy": -1.0}, "positive"),
        (nh.discretize(TOP, STEP), {"energy": 1.0, "side": 0}, "be one of 1, -1"),
        (nh.discretize(TOP, STEP), {"displacement": np.eye(3)}, "start off the equilibria"),
        (nh.discretize(SYSTEMS["top 4"], STEP), {"energy": 1.0}, "Got 3 admissible directions"),
        (nh.discretize(nh.SuslovTop(np.eye(3)), STEP), {"energy": 1.0}, "have attracting equilibria"),
        (nh.discretize(TOP, STEP, difference="logarithmic"), {"energy": 1.0}, "whose map keeps energy"),
        (nh.discretize(nh.RigidBody(np.eye(3)), STEP), {"energy": 1.0}, "be a top or a sleigh"),
        (nh.discretize(TOP, 1e-6), {"energy": 1.0}, "`heteroclinic(...)` must settle within 1000000 steps"),
    ],
)
def test_what_cannot_be_traced_is_refused(discrete: Discretization, options: dict, text: str) -> None:
    """Each refusal names what is missing."""
    with pytest.raises(ValueError, match=text.replace("(", r"\(").replace(")", r"\)").replace(".", r"\.")):
        nh.heteroclinic(discrete, **options)


def test_a_branch_that_ends_is_refused() -> None:
    """Where the principal branch ends on the way the run says so."""
    discrete = nh.discretize(TOP, 1.0)
    with pytest.raises(nh.OutcomeError):
        nh.heteroclinic(discrete, energy=1.05 * nh.critical_energies(discrete).saddle)
