"""The scheme "energy": the equations of Theorems 18.1 and 18.2 hold on orbits of every kind, whatever computed them."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from bodies import GENERAL, magnet, weight
from simulation.forces import SLEIGH, TOP, drive, start_of

import nonholo as nh
from nonholo.systems import AbstractSystem

SYSTEMS: dict[str, AbstractSystem] = {
    "top": TOP,
    "tilted top": nh.SuslovTop.from_inertia(np.diag([2.0, 3.0, 4.0]), (0.6, 0.8, 0)),
    "sleigh": SLEIGH,
    "sleigh with its mass behind": nh.ChaplyginSleigh(1.0, 1.0, -0.4, -0.2),
    "top on SO(4)": GENERAL["suslov 4"][0],
    "sleigh on SE(3)": GENERAL["sleigh 3"][0],
    "any d on SE(3)": GENERAL["any d on SE(3)"][0],
}


def _own(g: np.ndarray) -> float:
    """A potential that is neither linear nor a spring."""
    return float(np.cos(g[0, 1]) + g[1, 0] ** 3 + 0.3 * g[-1, 0] * g[0, 0] + np.sin(g[0, -1]))


def _spring(system: AbstractSystem) -> nh.Spring:
    n = system.group.size - system.group.is_affine
    return nh.Spring(np.linspace(0.2, 0.4, n), np.linspace(1.0, -0.5, n), 1.5, 0.3)


POTENTIALS: dict[str, Callable[[AbstractSystem], Any]] = {
    "none": lambda _: None,
    "weight": weight,
    "magnet": magnet,
    "spring": _spring,
    "own": lambda _: _own,
    "all": lambda system: (weight(system), _spring(system), magnet(system), _own),
}
FORCES: dict[str, Callable[[AbstractSystem], Any]] = {
    "none": lambda _: None,
    "friction": lambda s: nh.Friction(np.linspace(0.1, 0.4, s.group.dim)),
    "table": lambda s: np.random.default_rng(4).normal(size=(60, s.group.dim)),
    "drive": lambda _: drive,
    "all": lambda s: (FORCES["friction"](s), FORCES["table"](s), drive),
}
CASES = [
    *((potential, "none") for potential in ("weight", "magnet", "spring", "own")),
    *(("none", force) for force in ("friction", "table", "drive")),
    *(("weight", force) for force in ("friction", "table", "all")),
    ("all", "all"),
]


def _legendre(system: AbstractSystem, W: np.ndarray, h: float) -> np.ndarray:
    """F(W): what exp(s x) W adds to tr((W - 1) J (W - 1)*)/(2h), for each row x, by the trace."""
    group, J = system.group, np.asarray(system.homogeneous_mass_tensor)
    X = group.hat(np.asarray(system.constraint_subspace))
    return np.einsum("iab,kbc,cd,kad->ki", X, W, J, W - group.identity) / h


@pytest.mark.profile("routes", cases=["*any d*", "*SO(4)*", "*-own-none", "*-weight-none"])
@pytest.mark.parametrize("acting", CASES, ids="-".join)
@pytest.mark.parametrize("name", SYSTEMS)
def test_orbits_obey_the_equations_of_the_step(name: str, acting: tuple[str, str]) -> None:
    """F(W) = r + h/2 f and r' = -F(W^-1) + h/2 f with the f of its definition, and T' - T = <f, X>."""
    system, h = SYSTEMS[name], 0.1
    forced = nh.Forced(system, POTENTIALS[acting[0]](system), FORCES[acting[1]](system))
    orbit = nh.simulate(nh.discretize(forced, h), **start_of(system), steps=20)
    g, W, r = orbit.configuration, orbit.displacement, orbit.restricted_momentum
    group, S = system.group, np.asarray(system.constraint_subspace)
    f = forced.mean_force(g, W, h, forced.rows(orbit.step), orbit.time)
    back = group.inverse(W)
    np.testing.assert_allclose(_legendre(system, W, h), r + h / 2 * f @ S.T, atol=2e-14)
    np.testing.assert_allclose((-_legendre(system, back, h) + h / 2 * f @ S.T)[:-1], r[1:], atol=2e-14)
    np.testing.assert_allclose(g[:-1] @ W[:-1], g[1:], atol=2e-15)
    X = group.vee((W - back) / 2)
    B = S @ np.asarray(system.inertia_operator) @ S.T
    T = np.sum(r * np.linalg.solve(B, r.T).T, axis=1) / 2
    np.testing.assert_allclose(np.diff(T), (f * X).sum(axis=1)[:-1], atol=1e-14)
    np.testing.assert_allclose(orbit.energy, T + forced.potential_energy(g), atol=1e-14)
    np.testing.assert_allclose(orbit.energy - orbit.energy[0], orbit.work, atol=3e-14)
    np.testing.assert_allclose(orbit.momentum @ S.T, r, atol=1e-14)
    jump = orbit.multipliers @ np.asarray(system.annihilator)
    p = nh.discrete_legendre(nh.discretize(system, h), W[0])
    after = nh.discrete_legendre(nh.discretize(system, h), W[1])
    np.testing.assert_allclose(after - group.coadjoint(W[0], p) - h / 2 * (f[0] + f[1]), jump[0], atol=2e-14)


@pytest.mark.parametrize("blade", [None, nh.Slip([[0.0, 0.0, 1.0]], 0.4, 0.1)], ids=["holds", "slips"])
@pytest.mark.parametrize("more", [{}, {"weight": True}, {"motor": True}], ids=["alone", "heavy", "driven"])
def test_dissipation_is_what_friction_and_slips_take(blade: Any, more: dict[str, bool]) -> None:
    """It never falls, is X.CX/h of friction, minus the work without motors, and with it the work of motors, <f, X>."""
    system = nh.ChaplyginSleigh(1.0, 1.0, -0.4)
    rub, table = FORCES["friction"](system), FORCES["table"](system)
    force = (rub, *([table] if "motor" in more else []), *([blade] if blade else []))
    discrete = nh.discretize(nh.Forced(system, weight(system) if more else None, force), 0.1)
    orbit = nh.simulate(discrete, body_velocity=(1.0, 1.0, 0.0), steps=50)
    W, group = orbit.displacement, system.group
    X = group.vee((W - group.inverse(W)) / 2)[:-1]
    motors = (table[:50] * X).sum(axis=1) if "motor" in more else np.zeros(50)
    took = np.diff(orbit.dissipation)
    assert took.min() > -1e-15
    np.testing.assert_allclose(orbit.work[1:] + orbit.dissipation[1:], np.cumsum(motors), atol=3e-14)
    rubbed = (X @ rub.matrix * X).sum(axis=1) / 0.1
    assert np.abs(took - rubbed).max() < 1e-15 if blade is None else (took - rubbed).max() > 1e-3


@pytest.mark.parametrize("way", ["kicks", "order 4", "states left out", "flow"])
def test_dissipation_of_other_motions_is_that_of_the_nodes(way: str) -> None:
    """It is minus the work of friction alone, and what the energy falls by up to order 2."""
    forced = nh.Forced(TOP, None, FORCES["friction"](TOP), "variational" if way == "kicks" else None)
    start: dict[str, Any] = {"restricted_velocity": [0.5, -0.3]}
    if way == "flow":
        orbit = nh.flow(forced, **start, times=np.linspace(0.0, 2.0, 41))
    else:
        discrete = nh.discretize(forced, 0.05, order=4 if way == "order 4" else 2)
        orbit = nh.simulate(discrete, **start, steps=40, save_every=2 if "left" in way else 1)
    assert orbit.dissipation[-1] > 0.05
    np.testing.assert_array_equal(orbit.dissipation, -orbit.work)
    np.testing.assert_allclose(orbit.dissipation, orbit.energy[0] - orbit.energy, rtol=2e-2, atol=1e-15)


@pytest.mark.profile("routes", instead="test_orbits_obey_the_equations_of_the_step")
def test_energy_does_not_drift_one_way_by_rounding() -> None:
    """T + U of a sleigh on a spring, order 6: the median slope of its errors was -1e-17 a step, for every start."""
    forced, slopes = nh.Forced(nh.ChaplyginSleigh(1.0, 1.0, 0.5), _spring(SYSTEMS["sleigh"])), []
    for start in np.random.default_rng(0).normal(size=(9, 2)) / 2:
        orbit = nh.simulate(nh.discretize(forced, 0.5, order=6), restricted_velocity=start, steps=1500)
        U = forced.potential_energy(orbit.configuration)
        scale = (orbit.energy - U + np.abs(U - U[0])).max()
        slopes.append(np.polyfit(orbit.step, (orbit.energy - orbit.energy[0]) / scale, 1)[0])
    assert abs(np.median(slopes)) < 4e-18, slopes


@pytest.mark.parametrize(("order", "least"), [(4, -0.6579630871775028), (6, -0.7062461725576393)])
def test_substeps_back_in_time_give_the_energy_of_friction_back(order: int, least: float) -> None:
    """Proposition 18.5: near hc/2m = 1/|gamma| a step of higher order multiplies T, and one of order 2 takes of it."""
    grown = []
    for way in (2, order):
        forced = nh.Forced(nh.ChaplyginSleigh(1.0, 1.0, 0.0), force=nh.Friction([0.0, -20 * (1 - 1e-4) / least, 0.0]))
        orbit = nh.simulate(nh.discretize(forced, 0.1, order=way), body_velocity=(0.0, 1.0, 0.0), steps=1)
        grown.append(orbit.energy[1] / orbit.energy[0])
    assert grown[0] < 1 < 100 < grown[1]


@pytest.mark.parametrize("name", SYSTEMS)
@pytest.mark.parametrize("kind", ["weight", "magnet", "spring", "own", "all"])
def test_slopes_do_the_work_and_are_the_same_from_both_ends(name: str, kind: str) -> None:
    """(i) <G, X> = U(gW) - U(g) and (ii) G(gW, W^-1) = G(g, W), for displacements of all sizes, on no variety."""
    system, rng = SYSTEMS[name], np.random.default_rng(7)
    group, forced = system.group, nh.Forced(system, POTENTIALS[kind](system))
    for size in (1e-9, 1e-5, 1e-2, 0.3, 1.0, 2.0):
        for _ in range(3):
            g, W = group.random(rng)[None], group.exp(size * rng.normal(size=(1, group.dim)) / np.sqrt(group.dim))
            G = -forced.mean_force(g, W, 0.1, np.zeros((1, group.dim)), np.zeros(1))
            X, back = group.vee((W - group.inverse(W)) / 2), group.inverse(W)
            change = forced.potential_energy(g @ W) - forced.potential_energy(g)
            reverse = -forced.mean_force(g @ W, back, 0.1, np.zeros((1, group.dim)), np.zeros(1))
            scale = 1 + np.abs(forced.potential_energy(g)).max()
            assert np.abs((G * X).sum() - change).max() < 3e-14 * scale
            least = 1e-14 if kind not in ("own", "all") else 1e-11 + 1e-15 / size
            stretch = 1 + np.abs(np.linalg.inv(np.eye(len(W[0])) + W[0])).max()
            assert np.abs(G - reverse).max() < least * scale * stretch**2
            if size < 1e-4:
                assert np.abs(G + forced.potential_force(g)).max() < 30 * size * scale + 1e-6


@pytest.mark.profile("routes", cases=["*any d*", "*SO(4)*"])
@pytest.mark.parametrize("order", [2, 4])
@pytest.mark.parametrize("name", SYSTEMS)
def test_compositions_keep_the_energy_and_have_their_order(name: str, order: int) -> None:
    """Weight, spring and magnet together: T + U to rounding, pose and momentum of the order of the map."""
    system, errors = SYSTEMS[name], []
    forced = nh.Forced(system, (weight(system), _spring(system), magnet(system)))
    flow = nh.flow(forced, **start_of(system), times=(0.0, 0.8))
    for steps in (8, 16) if order == 2 else (4, 8):
        orbit = nh.simulate(nh.discretize(forced, 0.8 / steps, order=order), **start_of(system), steps=steps)
        assert np.ptp(orbit.energy) < 2e-14
        pose = np.abs(orbit.configuration[-1] - flow.configuration[-1]).max()
        errors.append(max(pose, np.abs(orbit.restricted_momentum[-1] - flow.restricted_momentum[-1]).max()))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.2 if order == 2 else 0.5)


@pytest.mark.parametrize("step", [0.1, 0.5])
@pytest.mark.parametrize("name", ["sleigh", "sleigh with its mass behind", "knife edge"])
def test_bodies_that_fall_keep_their_energy(name: str, step: float) -> None:
    """1e5 steps down a slope, far beyond the first place, or until the branch ends: places lose no work to rounding."""
    system = SYSTEMS.get(name) or nh.ChaplyginSleigh(1.0, 1.0, 0.0)
    forced = nh.Forced(system, nh.Gravity([0.4, -0.2], [0.5, 0.1]))
    run = nh.simulate(nh.discretize(forced, step), body_velocity=(0.7, 0.2, 0.0), steps=10**5, throw=False)
    potential = forced.potential_energy(run.configuration)
    turned = (run.energy - potential + np.abs(potential - potential[0])).max()
    assert np.abs(run.energy - run.energy[0]).max() < 1e-13 * turned
    assert len(run) > 10**5 or run.outcome == nh.Outcome.no_real_branch


@pytest.mark.parametrize("turned", [0.0, 0.01])
def test_a_sleigh_of_order_4_ends_at_a_fold_where_it_falls_too_fast(turned: float) -> None:
    """The longest substep back in time has a principal displacement up to v = 2 (J + m a^2) / (m a |w| h)."""
    system, h = nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1
    fastest = 2 * 1.25 / (0.5 * h * 0.6579630871775028)
    free = nh.discretize(system, h, order=4)
    for share, lasts in ((0.999, True), (1.001, False)):
        run = nh.simulate(free, body_velocity=(0.0, share * fastest, 0.0), steps=3, throw=False)
        assert (len(run) > 3) == lasts
    heavy = nh.discretize(nh.Forced(system, nh.Gravity([0.4, 0.0], [0.5, 0.0])), h, order=4)
    start = {"body_velocity": (1e-3, 0.99 * fastest, 0.0), "configuration": nh.SE(2).exp(np.array([turned, 0.0, 0.0]))}
    run = nh.simulate(heavy, **start, steps=100, throw=False)
    assert run.outcome == nh.Outcome.no_real_branch
    assert 0.998 < run.body_velocity[-1, 1] / fastest < 1


def test_a_pull_that_rounding_blurs_is_no_fold() -> None:
    """Far out on SO(2, 1) terms of the pull are large and cancel: the run continues, with their rounding in T + U.

    It ends where its pose has left the group: what rounding has taken from it far out is missing when it comes back.
    """
    form = np.diag([1.0, 1.0, -1.0])
    group = nh.MatrixGroup(form @ nh.SO(3).basis, form=form)
    body = nh.LLSystem(group, np.diag([4.0, 6.0, 9.0]) @ form, [[0.3, 0.8, 0.3], [-1.3, 0.9, 0.4]])
    discrete = nh.discretize(nh.Forced(body, nh.Linear(0.2 * np.eye(3))), 0.5)
    run = nh.simulate(discrete, restricted_velocity=(0.4, -0.3), steps=400, throw=False)
    assert run.outcome == nh.Outcome.nonfinite
    assert 240 < len(run) < 300
    assert run.system.group.residual(run.configuration).max() <= 1e-9
    out = run[:241]
    far = np.abs(out.configuration).max()
    assert far > 1e4
    assert np.abs(out.energy - out.energy[0]).max() < 1e-15 * far


def test_the_scheme_is_the_one_that_is_asked_for() -> None:
    """By default it is "energy" where it is defined and the body is constrained; elsewhere it is refused."""
    heavy = nh.Gravity([0.0, 0.0, -1.0], [0.1, 0.2, 0.3])
    free = nh.RigidBody(np.diag([1.0, 1.2, 0.7]))
    veselova = nh.VeselovaTop(np.diag([1.0, 2.0, 3.0]))
    tilted = nh.LLSystem(nh.SO(3), inertia_operator=np.diag([1.0, 2.0, 3.0]), constraint_subspace=np.eye(3)[:2])
    default = {"energy": TOP, "variational": free}
    for scheme, system in default.items():
        assert nh.discretize(nh.Forced(system, heavy), 0.1).is_balanced == (scheme == "energy")
        other = {"energy": "variational", "variational": "energy"}[scheme]
        assert nh.discretize(nh.Forced(system, heavy, scheme=other), 0.1).is_balanced == (other == "energy")
    assert not nh.discretize(nh.Forced(veselova, heavy), 0.1).is_balanced
    for system in (veselova, tilted):
        with pytest.raises(ValueError, match="conserves energy"):
            nh.discretize(nh.Forced(system, heavy, scheme="energy"), 0.1)
    with pytest.raises(ValueError, match="scheme"):
        nh.Forced(TOP, heavy, scheme="exact")
    body = nh.discretize(nh.Forced(free, heavy, scheme="energy"), 0.1)
    assert np.ptp(nh.simulate(body, body_velocity=(0.3, 0.4, 0.5), steps=200).energy) < 1e-14


def _followed(forced: nh.Forced, h: float, r: np.ndarray, g: np.ndarray) -> np.ndarray | None:
    """Follow the root of F(W) = t r + t^2 h f/2, in units of h, from t = 0; None where its slope ends."""
    system, group, y, pieces = forced.system, forced.group, np.zeros(2), 150
    S, around = np.asarray(system.constraint_subspace), 1e-6 * np.concatenate([np.eye(2), -np.eye(2), np.zeros((1, 2))])
    poses, still = np.tile(g, (5, 1, 1)), np.zeros((5, group.dim))

    def at(y: np.ndarray, t: float) -> tuple[np.ndarray, np.ndarray]:
        """Return what is missed and its slope."""
        W = np.array([group.cayley(2 * x @ S) for x in y + around])
        pull = forced.mean_force(poses, W, h * t, still) @ S.T
        gaps = h * _legendre(system, W, h) - t * h * r - (t * h) ** 2 / 2 * pull
        return gaps[4], (gaps[:2] - gaps[2:4]).T / 2e-6

    begun = np.linalg.det(at(y, 1e-9)[1])
    for k in range(1, pieces + 1):
        for _ in range(8):
            gap, slope = at(y, k / pieces)
            y = y - np.linalg.solve(slope, gap)
            if np.abs(gap).max() < 1e-13:
                break
        if not (np.abs(gap).max() < 1e-11 * (1 + np.abs(h * r).max()) and np.linalg.det(slope) > 0.02 * begun):
            return None
    return group.cayley(2 * y @ S)


@pytest.mark.profile("problems", keep=["14"])
@pytest.mark.parametrize("bodies", [14, 100])
def test_roots_are_those_of_a_path_of_our_own(bodies: int) -> None:
    """Heavy tops and sleighs with friction, at large angles: the first displacement is where the path leads."""
    rng, ended, turned = np.random.default_rng(31), 0, 0.0
    for case in range(bodies):
        root, n = rng.normal(size=(3, 4)), 2 + case % 2
        sleigh = nh.ChaplyginSleigh(*rng.uniform(0.3, 2, 2), *rng.normal(size=2))
        system = nh.SuslovTop(root @ root.T) if n == 3 else sleigh
        turning = rng.normal(size=(3, 3))
        rub = nh.Friction(0.3 * np.outer(turning[0], turning[0]) + 0.1 * (turning - turning.T))
        forced = nh.Forced(system, nh.Gravity(rng.normal(size=n), rng.normal(size=n)), rub)
        h, g = 10 ** rng.uniform(-1.5, 0), system.group.random(rng)
        velocity = rng.normal(size=2) * 10 ** rng.uniform(-1, 0)
        r = system.restricted_momentum(velocity)
        wanted = _followed(forced, h, r, g)
        run = nh.simulate(nh.discretize(forced, h), restricted_velocity=velocity, configuration=g, steps=1, throw=False)
        if wanted is None:
            ended += 1
            continue
        assert len(run) > 0, (case, run.outcome)
        turned = max(turned, float(system.group.angle(system.group.log(run.displacement[0]))))
        assert np.abs(run.displacement[0] - wanted).max() < 1e-8, case
    assert 0 < ended < bodies / 3
    assert turned > 1.0


def test_a_spring_with_a_length_has_no_direction_at_its_end() -> None:
    """Maps and flows end there, systems by functions refuse it; beside it kicks have the exact force."""
    disk, spring = nh.RigidBody.from_inertia(1.0, 0.5, (0.0, 0.0), nh.SE(2)), nh.Spring([0, 0], [0, 0], 2.0, 0.3)
    turning = {"body_velocity": (0.5, 0.0, 0.0)}
    for forced in (nh.Forced(disk, spring, scheme=scheme) for scheme in ("variational", "energy")):
        orbit = nh.simulate(nh.discretize(forced, 0.1), steps=3, throw=False, **turning)
        assert (str(orbit.outcome), len(orbit)) == ("nonfinite", 0)
        with pytest.raises(nh.OutcomeError, match="nonfinite"):
            nh.flow(forced, times=(0.0, 0.1), **turning)
    by_functions = nh.GroupLagrangeDAlembert(nh.SE(2), nh.mass_tensor_lagrangian(nh.SE(2), np.diag([0.5, 1, 1])), None)
    with pytest.raises(ValueError, match="be finite and differentiable"):
        nh.flow(nh.Forced(by_functions, spring), times=(0.0, 0.1), configuration=np.eye(3), **turning)
    beside = {"configuration": nh.SE(2).exp(np.array([0.0, 1e-4, 0.0])), "body_velocity": np.zeros(3)}
    pulled = nh.simulate(nh.discretize(nh.Forced(disk, spring, scheme="variational"), 1e-3), steps=1, **beside)
    assert abs(pulled.position[1, 0] - 1e-4 - 1e-6 * 2.0 * (0.3 - 1e-4) / 2) < 1e-15
