"""Controls to goals, by shooting and by IPOPT: poses and velocities met, least effort, bounds, obstacles, refusals."""

import functools
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest
from refusals import refusals

import nonholo as nh
from nonholo.analysis.steering import Steering, _arguments, _shooting
from nonholo.analysis.steering._arguments import StateBounds, Way, body_numbers, body_states, resample
from nonholo.analysis.steering._problems import CoordinateNodes, GroupNodes
from nonholo.analysis.steering._transcription import Program, Steps, outcome_of

SLEIGH = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.2), 0.25)
ASIDE = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]])
REST = {"restricted_velocity": (0.0, 0.0)}
GOAL = {"configuration": ASIDE, **REST}
DISC = (np.array([[0.1, 0.5]]), 0.3)
STEPS = 16
SHOT = nh.discretize(SLEIGH.system, 0.1)


@pytest.mark.profile("long", instead="test_bounds_hold")
def test_thousand_sleighs_are_parked() -> None:
    """From random poses and velocities to rest: at least 999 of 1000 meet pose and velocity to 1e-8, as rollouts do."""
    result = nh.steer(SHOT, _starts(1000), {"configuration": np.eye(3), **REST}, steps=40)
    assert result.failures <= 1
    ends = result.orbit
    gap, speed = ends.configuration[:, -1] - np.eye(3), ends.restricted_momentum[:, -1]
    assert ((np.abs(gap).max(axis=(1, 2)) < 1e-8) & (np.abs(speed).max(axis=1) < 1e-8)).sum() >= 999


@pytest.mark.profile("routes", instead="test_bounds_hold")
def test_many_are_parked_at_once() -> None:
    """Each of three members side by side meets its goal, in the compiled run of its controls too."""
    starts, result = _starts(3), _parked(3)
    assert result.failures == 0
    assert result.controls.shape == (3, 40, 3)
    np.testing.assert_allclose(result.orbit.configuration[:, -1], np.broadcast_to(ASIDE, (3, 3, 3)), rtol=0, atol=1e-8)
    np.testing.assert_allclose(result.orbit.restricted_momentum[:, -1], 0.0, rtol=0, atol=1e-8)
    np.testing.assert_allclose(result.cost, 0.05 * (result.controls**2).sum(axis=(1, 2)), rtol=1e-12)
    driven = nh.Forced(SLEIGH.system, force=result.controls[2])
    start = {name: rows[2] for name, rows in starts.items()}
    end = nh.simulate(nh.discretize(driven, 0.1), **start, steps=40).configuration[-1]
    np.testing.assert_allclose(end, ASIDE, rtol=0, atol=1e-8)


@functools.cache
def _parked(count: int = 1) -> Steering:
    return nh.steer(SHOT, _starts(count), GOAL, steps=40)


def _starts(count: int) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(0)
    poses = np.array([nh.SE(2).random(rng) for _ in range(count)])
    return {"configuration": poses, "restricted_velocity": rng.normal(scale=0.5, size=(count, 2))}


def test_a_way_of_least_effort_counts_more_than_a_smaller_miss(monkeypatch: pytest.MonkeyPatch) -> None:
    """A start that comes nearer to the goal, at no minimum of the cost, does not hide a later one at a minimum."""
    ends = iter([([[2.0]], [[1e-12]], [1.0]), ([[1.0]], [[1e-10]], [0.0])])
    monkeypatch.setattr(_shooting, "least_effort", lambda *_: tuple(map(np.array, next(ends))))
    forces, missed, is_least = _shooting.best(lambda f, _: (f + 1, f), np.ones((1, 1)), (-np.ones(1), np.ones(1)))
    assert (forces.item(), missed.item(), is_least.item()) == (1.0, 1e-10, True)


@pytest.mark.parametrize("low", [-1.0, 0.0, 0.5])
def test_a_goal_that_is_met_without_forces_costs_nothing(low: float) -> None:
    """No local minimum with forces is taken for the least, where bounds allow none."""
    gaps = lambda f, _: (f.sum(axis=1, keepdims=True), np.ones((len(f), 1, 2)))  # noqa: E731
    forces, missed, is_least = _shooting.best(gaps, np.ones((1, 2)), (np.full(2, low), np.ones(2)))
    assert is_least.item() == (missed.item() == 0) == (low <= 0)
    assert (forces == 0).all() == (low <= 0)


def test_members_begin_where_they_do_without_others(monkeypatch: pytest.MonkeyPatch) -> None:
    """A member begins each attempt at the same forces whether another one is met at once or never."""

    def begins(other: float) -> list[float]:
        firsts = []

        def attempt(_: Any, f: np.ndarray, __: Any) -> tuple[np.ndarray, ...]:
            firsts.append(f[-1, 0])
            return f, np.array([[other], [1.0]])[-len(f) :], np.zeros(len(f))

        monkeypatch.setattr(_shooting, "least_effort", attempt)
        _shooting.best(lambda f, _: (f + 1, f), np.ones((2, 1)), (-np.ones(1), np.ones(1)))
        return firsts

    assert begins(0.0) == begins(1.0)


@pytest.mark.profile("problems", instead="test_bounds_hold")
@pytest.mark.parametrize("length", [2.0**-10, 2.0**10])
def test_goals_are_met_in_any_unit_of_length(length: float) -> None:
    """Where thrusts cost a million times what torques do, or the inverse, a sleigh still comes to its place at rest."""
    sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, length**2, 0.2 * length), 0.1)
    place = ASIDE * [[1, 1, length], [1, 1, length], [1, 1, 1]]
    result = nh.steer(sleigh, {}, {"configuration": place, **REST}, steps=40)
    assert result.outcome in ("converged", "not least")
    assert result.missed < 1e-8


def test_ends_name_velocities_as_other_runs_do() -> None:
    """Starts by body velocities, of two members, and momenta, and such goals, are those by restricted velocities."""
    system, w = SLEIGH.system, np.array([[0.1, 0.3], [0.0, 0.5]])
    momenta, velocities = w[1] @ system.constrained_inertia, w @ system.constraint_subspace
    for start, wanted in (({"body_velocity": velocities}, w), ({"momentum": momenta}, w[1:])):
        (first, _, _, last), _ = _arguments.checked_ends(system, start, {"body_velocity": velocities[0]}, is_free=False)
        np.testing.assert_allclose(first, wanted, rtol=1e-15, atol=1e-16)
        np.testing.assert_allclose(last, w[: len(wanted)] * 0 + w[0], rtol=1e-15, atol=1e-16)


@pytest.mark.profile("routes", instead="test_bounds_hold")
def test_least_effort_to_a_speed_is_a_constant_thrust() -> None:
    """A sleigh that is to slide at speed 1 after 4 units of time is pushed with 1/4 all the time, at cost 1/8."""
    result = nh.steer(SHOT, {}, {"restricted_velocity": (0.0, 1.0)}, steps=40)
    np.testing.assert_allclose(result.controls, np.tile([0.0, 0.25, 0.0], (40, 1)), rtol=0, atol=1e-6)
    np.testing.assert_allclose(result.cost, 0.125, rtol=1e-9)
    assert result.converged


def test_bounds_hold() -> None:
    """Forces stay within their bounds, and cost more than without them."""
    goal, size = GOAL, 0.8 * np.abs(_parked().controls).max()
    bounded = nh.steer(SHOT, _starts(1), goal, steps=40, bounds=(-size, size))
    assert bounded.failures == 0
    assert np.abs(bounded.controls).max() <= size + 1e-12
    assert bounded.cost.sum() > _parked().cost.sum() + 1e-6


@pytest.mark.profile("routes", instead="test_words_of_outcomes")
@pytest.mark.parametrize(("discrete", "method", "least"), [(SHOT, None, 0.1), (SLEIGH, "ipopt", 0.2)])
def test_torque_alone_does_not_stop_a_sleigh(discrete: Any, method: str | None, least: float) -> None:
    """With its mass ahead, v' = a omega^2: no torque brings it to rest, and the result says so."""
    start = {"restricted_velocity": (0.0, 0.3)}
    result = nh.steer(discrete, start, REST, steps=6, bounds=((-5.0, 0.0), (5.0, 0.0)), method=method)
    assert not result.converged
    assert result.missed > least  # in units of the body and the 0.6 of the motion
    assert method is None or result.outcome == "infeasible"


def _program(discrete: Any, steps: int) -> Program:
    """Return a program with an obstacle and a goal that are nothing special."""
    rng = np.random.default_rng(2)
    system = discrete.system
    n = system.group.size - 1 if system.group.is_affine else 0
    free = nh.discretize(system.system, float(discrete.time_step)) if system.is_forced else discrete
    nodes = GroupNodes(free, discrete.forces, rng.normal(size=(1, n)), system.group.random(rng))
    centers, radii = rng.normal(size=(min(n, 1), n)), rng.uniform(0.1, 0.3, min(n, 1))
    size = system.group.size**2 + system.rank
    bounds = StateBounds(rng.normal(size=(2, size)), np.zeros(2), np.ones(2))
    shared = Steps(nodes, centers, radii, np.float64(discrete.time_step), bounds)
    return Program(shared, rng.normal(size=nodes.sizes[0]), 0.1 * rng.normal(size=(steps, system.group.dim)))


def _snakeboard() -> Program:
    rng = np.random.default_rng(3)
    system = nh.examples.snakeboard().system.plain
    nodes = CoordinateNodes(
        system, np.float64(0.1), rng.normal(size=(1, 2)), np.ones(5), rng.normal(size=(3, 5)), np.zeros(5), None
    )
    bounds = StateBounds(rng.normal(size=(2, 10)), np.zeros(2), np.ones(2))
    steps = Steps(nodes, rng.normal(size=(1, 2)), np.array([0.2]), nodes.time_step, bounds)
    return Program(steps, rng.normal(size=10), np.zeros((3, 5)))


SPACE = nh.LLSystem.from_inertia(
    1.0,
    np.diag([1.0, 1.2, 0.7]),
    [0.1, 0.0, 0.0],
    nh.SE(3),
    constraint_subspace=np.eye(6)[[1, 2, 3]] + 0.1 * np.eye(6)[[4, 5, 0]],
)
FORCED = nh.Forced(SLEIGH.system, nh.Gravity([0.0, -1.0], [0.2, 0.0]), nh.Friction([0.1, 0.3, 0.0]))
PROGRAMS = {
    "sleigh": lambda: _program(SLEIGH, STEPS),
    "top": lambda: _program(nh.discretize(nh.SuslovTop(np.diag([1.0, 1.2, 0.8]) + 0.1), 0.1), 3),
    "space": lambda: _program(nh.discretize(SPACE, 0.1), 2),
    "forced": lambda: _program(nh.discretize(FORCED, 0.1), 3),
    "logarithmic": lambda: _program(nh.discretize(SLEIGH.system, 0.1, difference="logarithmic"), 3),
    "snakeboard": _snakeboard,
}


@pytest.mark.profile("routes", keep=["sleigh"])
@pytest.mark.parametrize("name", PROGRAMS)
def test_derivatives_are_those_of_differences(name: str) -> None:
    """Sparse first and second derivatives act on vectors as central differences of values and of first ones do."""
    program, rng = PROGRAMS[name](), np.random.default_rng(0)
    u, v = 0.3 * rng.normal(size=(2, program.unknowns))
    if name == "space":  # far from the group its logarithm is not smooth
        u[-len(program.first) : -SPACE.rank] = SPACE.group.random(rng)[:3].ravel()
    weights, size = rng.normal(size=len(program.limits[0])), 2e-4

    def slope(f: Any) -> np.ndarray:  # of order 4: its error is about size^4, and rounding over size
        ahead, far = (f(u + k * size * v) - f(u - k * size * v) for k in (1, 2))
        return (8 * ahead - far) / (12 * size)

    def gradient(u: np.ndarray) -> np.ndarray:
        return program.slopes(u).T @ weights + 0.7 * program.cost(u)[1]

    conditions = slope(program.conditions)
    np.testing.assert_allclose(program.slopes(u) @ v, conditions, rtol=0, atol=1e-9 * np.abs(conditions).max())
    np.testing.assert_allclose(program.cost(u)[1] @ v, slope(lambda u: program.cost(u)[0]), rtol=1e-9)
    upper, bent = program.curvatures(u, weights, 0.7).toarray(), slope(gradient)
    np.testing.assert_array_equal(upper, np.triu(upper))
    whole = upper + np.triu(upper, 1).T
    np.testing.assert_allclose(whole @ v, bent, rtol=0, atol=1e-9 * np.abs(bent).max())


@pytest.mark.parametrize("units", [(2.0**18, 1.0, 1.0), (2.0**-18, 2.0**40, 1.0), (1.0, 2.0**-40, 2.0**-10)])
def test_controls_do_not_depend_on_units(units: tuple[float, float, float]) -> None:
    """IPOPT finds the same forces for a top and for a spring between two masses, one of them bounded, to rounding."""
    tensor = np.array([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
    turned = {"configuration": nh.SO(3).exp([0.4, 0.2, 0.1]), "restricted_velocity": (0.0, 0.0)}
    pair = nh.LagrangeDAlembert(
        lambda q, v, p: p["mass"] * (v[0] ** 2 + v[1] ** 2 / 2) / 2 - p["spring"] * (q[0] - q[1]) ** 2 / 2,
        None,
        dimension=2,
        parameters={"mass": 1.0, "spring": 0.5},
    )

    def forces(mass: float, length: float, time: float) -> list[np.ndarray]:
        maps = nh.SuslovTop(tensor * mass), pair.with_parameters(mass=mass, spring=0.5 * mass / time**2)
        top, masses = (nh.discretize(system, 0.1 * time) for system in maps)
        beside = {"configuration": (length, 0.5 * length), "body_velocity": (0.0, 0.0)}
        bounds = {"q2": (0.0, 0.52 * length), "body_velocity": (-1.3 * length / time, 1.3 * length / time)}
        steered = [
            nh.steer(top, {}, turned, steps=20, method="ipopt"),
            nh.steer(masses, {"configuration": (0.0, 0.0)}, beside, steps=20, state_bounds=bounds),
        ]
        assert [each.outcome for each in steered] == ["converged", "converged"]
        return [each.controls * time**2 / mass / size for each, size in zip(steered, (1.0, length), strict=True)]

    for result, expected in zip(forces(*units), forces(1.0, 1.0, 1.0), strict=True):
        np.testing.assert_allclose(result, expected, rtol=0, atol=1e-12)


def test_only_windows_of_unknowns_are_coupled() -> None:
    """The matrices are banded: equations of a step see it and the state before, and each step has as many entries."""
    program = _program(SLEIGH, STEPS)
    (rows, columns), (count, ends) = program.slope_places.pattern.nonzero(), program.shape
    step = rows // count
    inside = step < STEPS
    assert (columns < program.width * np.minimum(step + 1, STEPS)).all()
    assert (columns >= program.width * np.minimum(step, STEPS) - len(program.first)).all()
    assert len(set(np.bincount(step[inside])[1:])) == 1
    assert ends == 3
    assert len(rows) < 0.2 * len(program.limits[0]) * program.unknowns


@pytest.mark.profile("routes", instead="test_derivatives_are_those_of_differences")
def test_an_orbit_satisfies_all_equations() -> None:
    """States, charts and forces of a rollout leave nothing over: the equations are those of the exact step."""
    table, forces = np.random.default_rng(1).normal(size=(2, 6, 3))
    forces = forces[:, :2]
    controls = np.column_stack([forces, np.zeros(6)]) + table
    orbit = nh.rollout(SLEIGH, restricted_velocity=(0.3, 0.8), controls=controls, steps=6)
    charts = np.array([SLEIGH.variety.coordinates(W) for W in orbit.displacement[:-1]])
    states = np.column_stack([orbit.configuration[:, :2].reshape(7, 6), orbit.restricted_momentum])
    nowhere = StateBounds(np.zeros((0, 11)), np.zeros(0), np.zeros(0))
    nodes, obstacles = GroupNodes(SLEIGH, None, np.zeros((1, 2)), None), (np.zeros((0, 2)), np.zeros(0))
    steps = Steps(nodes, *obstacles, SLEIGH.time_step, nowhere)
    program = Program(steps, states[0], table)
    u = np.column_stack([charts, forces, states[1:]]).ravel()
    np.testing.assert_allclose(program.conditions(u), 0.0, rtol=0, atol=1e-14)
    assert np.abs(program.conditions(u + 1e-3)).max() > 1e-4


@functools.cache
def _around() -> Steering:
    return nh.steer(SLEIGH, {}, GOAL, steps=STEPS, obstacles=DISC)


@pytest.mark.profile("routes", instead="test_derivatives_are_those_of_differences")
def test_a_disc_is_kept_clear_of() -> None:
    """Run again by the compiled map under a table, the controls meet the goal and the clearance, which is used up."""
    result = _around()
    assert result.outcome == "converged"
    orbit = result.orbit
    np.testing.assert_allclose(orbit.configuration[-1], ASIDE, rtol=0, atol=1e-8)
    np.testing.assert_allclose(orbit.restricted_momentum[-1], 0.0, rtol=0, atol=1e-8)
    assert -1e-8 < np.linalg.norm(orbit.position - DISC[0], axis=1).min() - DISC[1] < 1e-6
    np.testing.assert_allclose(result.cost, 0.125 * (result.controls**2).sum(), rtol=1e-12)


@pytest.mark.profile("routes", instead="test_derivatives_are_those_of_differences")
def test_without_obstacles_both_methods_find_the_same() -> None:
    """IPOPT from the controls of shooting stays there: the same cost and the same controls."""
    shot = nh.steer(SLEIGH, {}, GOAL, steps=STEPS)
    result = nh.steer(SLEIGH, {}, GOAL, steps=STEPS, guess=shot)
    assert (shot.outcome, result.outcome) == ("converged", "converged")
    np.testing.assert_allclose(result.cost, shot.cost, rtol=1e-6)
    np.testing.assert_allclose(result.controls, shot.controls, rtol=0, atol=1e-4 * np.abs(shot.controls).max())


@pytest.mark.parametrize(
    ("status", "gap", "word"),
    [
        ("Solve_Succeeded", 1e-9, "converged"),
        ("Solve_Succeeded", 1e-7, "not found"),
        ("Maximum_Iterations_Exceeded", 1e-9, "not least"),
        ("Maximum_Iterations_Exceeded", np.inf, "not found"),
        ("Infeasible_Problem_Detected", 1e-7, "infeasible"),
    ],
)
def test_words_of_outcomes(status: str, gap: float, word: str) -> None:
    """What the orbit misses decides before what IPOPT says of its equations."""
    assert outcome_of(status, gap) == word


@pytest.mark.profile("routes", instead="test_derivatives_are_those_of_differences")
def test_members_go_one_after_the_other() -> None:
    """Of two starts, with their own goals, each is what it is alone; bounds hold."""
    starts = {"restricted_velocity": np.array([(0.0, 0.0), (0.2, 0.3)])}
    size = 0.9 * np.abs(_around().controls).max()
    with pytest.raises(ValueError, match="4 steps"):
        nh.steer(SLEIGH, {}, GOAL, steps=4, guess=_around())
    both = nh.steer(SLEIGH, starts, GOAL, steps=STEPS, obstacles=DISC, bounds=(-size, size))
    assert both.failures == 0
    assert both.controls.shape == (2, STEPS, 3)
    assert np.abs(both.controls).max() <= size
    one = {"restricted_velocity": starts["restricted_velocity"][1]}
    alone = nh.steer(SLEIGH, one, GOAL, steps=STEPS, obstacles=DISC, bounds=(-size, size))
    np.testing.assert_array_equal(alone.controls, both.controls[1])
    np.testing.assert_allclose(alone.orbit.configuration[-1], ASIDE, rtol=0, atol=1e-8)
    assert both.cost[0] > _around().cost


@pytest.mark.profile("routes", instead="test_derivatives_are_those_of_differences")
def test_places_on_the_way_and_the_goal_of_an_outline() -> None:
    """A motion through two places back to its start, with both ends of a rod clear of a disc."""
    via, rod = {10: (1.5, 0.7), 20: (1.5, -0.7)}, np.array([[0.3, 0.0], [-0.3, 0.0]])
    goal = {"configuration": np.eye(3), "restricted_velocity": (0.0, 0.8)}
    disc = (np.array([[0.9, 0.1]]), 0.2)
    start = {"restricted_velocity": (0.0, 0.8)}
    result = nh.steer(SLEIGH, start, goal, steps=40, via=via, obstacles=disc, outline=rod)
    assert result.outcome == "converged"
    poses = result.orbit.configuration
    for step, place in via.items():
        np.testing.assert_allclose(poses[step, :2, 2], place, rtol=0, atol=1e-8)
    ends = poses[:, None, :2, 2] + np.einsum("kij,pj->kpi", poses[:, :2, :2], rod)
    assert np.linalg.norm(ends - disc[0][0], axis=-1).min() > disc[1] - 1e-8
    np.testing.assert_allclose(poses[-1], np.eye(3), rtol=0, atol=1e-8)


def trailer_axle(q: Any) -> Any:
    """Return the axle of the tractor and that of a trailer 0.6 behind it, in axes of the tractor."""
    bent = q[3] - q[2]
    return jnp.stack([jnp.zeros(2), -0.6 * jnp.stack([jnp.cos(bent), jnp.sin(bent)])])


@pytest.mark.profile("long", instead="test_derivatives_are_those_of_differences")
def test_a_trailer_keeps_clear_of_a_disc() -> None:
    """Its axle cuts into the disc that the tractor avoids; as a point of the outline, a function of q, it does not."""
    discrete = nh.examples.trailers(hitches=(0.6,)).discretize(0.1)
    start = {"configuration": (0.0, 0.0, 0.0, 0.0), "body_velocity": (0.8, 0.0, 0.0, 0.0)}
    goal, disc = {"configuration": {"x": 1.6, "y": 1.6, "theta": np.pi / 2}}, ([(1.0, 0.6)], 0.35)
    nearest = []
    for outline in (np.zeros((1, 2)), trailer_axle):
        result = nh.steer(discrete, start, goal, steps=30, obstacles=disc, outline=outline)
        assert result.outcome == "converged"
        q = result.orbit.configuration
        axles = q[:, :2], q[:, :2] - 0.6 * np.stack([np.cos(q[:, 3]), np.sin(q[:, 3])], axis=1)
        nearest.append([np.linalg.norm(axle - disc[0][0], axis=1).min() - disc[1] for axle in axles])
    (tractor, cut), (both, clear) = nearest
    assert tractor > -1e-8
    assert cut < -0.01
    assert min(both, clear) > -1e-8


@pytest.mark.profile("long", instead="test_derivatives_are_those_of_differences")
@pytest.mark.parametrize("name", ["top", "space", "forced"])
def test_bodies_meet_goals(name: str) -> None:
    """A top about the axis that it must not turn about, a body in space, a sleigh under gravity and friction."""
    top = nh.SuslovTop(np.diag([1.0, 1.2, 0.8]) + 0.1)
    system, turn = {
        "top": (top, nh.SO(3).exp(np.array([0.0, 0.0, 1.2]))),
        "space": (SPACE, nh.SE(3).exp(np.array([0.3, 0.2, 0.5, 1.0, 0.5, 0.3]))),
        "forced": (FORCED, ASIDE),
    }[name]
    goal = {"configuration": turn, "restricted_velocity": np.zeros(system.rank)}
    result = nh.steer(nh.discretize(system, 0.1), {}, goal, steps=40, method="ipopt")
    assert result.outcome == "converged"
    np.testing.assert_allclose(result.orbit.configuration[-1], turn, rtol=0, atol=1e-8)
    shot = nh.steer(nh.discretize(system, 0.1), {}, goal, steps=40)
    guided = nh.steer(nh.discretize(system, 0.1), {}, goal, steps=40, guess=shot)
    np.testing.assert_allclose(guided.cost, shot.cost, rtol=1e-6)


@pytest.mark.profile("routes", instead="test_derivatives_are_those_of_differences")
def test_a_snakeboard_moves_by_its_rotor_and_wheels() -> None:
    """Motors of the shape alone bring it aside, from rest to rest; simulated under a table it is there."""
    board = nh.examples.snakeboard().system
    motors, start = np.array([0.0, 0.0, 0.0, 2.0, 2.0]), {"configuration": np.zeros(5)}
    goal = {"configuration": {"x": 1.0, "y": 0.3, "theta": 0.0}, "body_velocity": np.zeros(5)}
    disc = (np.array([[0.5, 0.1]]), 0.05)
    result = nh.steer(nh.discretize(board, 0.1), start, goal, steps=80, bounds=(-motors, motors), obstacles=disc)
    assert result.outcome == "converged"
    assert not result.controls[:, :3].any()
    orbit = result.orbit
    np.testing.assert_allclose(orbit.configuration[-1, :3], [1.0, 0.3, 0.0], rtol=0, atol=1e-8)
    v = (orbit.configuration[-1] - orbit.configuration[-2]) / 0.1
    assert np.abs(orbit.body_velocity[-1]).max() < 1e-8 < np.abs(v).max()  # the step after the last rests
    assert np.linalg.norm(orbit.configuration[:, :2] - disc[0], axis=1).min() > disc[1] - 1e-8


def test_bounds_of_states_are_linear_in_their_numbers() -> None:
    """Rows say of random poses and momenta by how much position, heading and velocity are outside, in units."""
    system, rng = nh.ChaplyginSleigh(1.0, 0.6, 0.2, 0.1), np.random.default_rng(4)
    g, w = nh.SE(2).exp(rng.normal(size=(50, 3)) * [2.0, 1.0, 1.0]), rng.normal(size=(50, 2))
    heading, numbers = np.arctan2(g[:, 1, 0], g[:, 0, 0]), body_states(g, system.restricted_momentum(w))
    nowhere, names = {"start": np.full((1, 11), np.nan)}, body_numbers(system, 2.0)
    length = system.displacement_units[1]

    def outside(**arguments: Any) -> np.ndarray:
        bounds: Any = StateBounds.of(arguments, names, nowhere)
        return np.array([bounds.outside(each) for each in numbers])

    np.testing.assert_allclose(outside(y=(-0.3, 0.2)) * length, _beyond(g[:, 1, 2], -0.3, 0.2), atol=1e-15)
    velocity = 2.0 * np.maximum(_beyond(w[:, 0], -0.5, 0.5), _beyond(w[:, 1], -0.5, np.inf) / length)
    np.testing.assert_allclose(outside(restricted_velocity=(-0.5, (0.5, np.inf))), velocity, atol=1e-15)
    for low, high in ((-0.4, 0.9), (-2.5, 0.1), (2.9, 4.0)):
        middle = (low + high) / 2
        turn = middle + np.angle(np.exp(1j * (heading - middle)))
        np.testing.assert_array_equal(outside(theta=(low, high)) > 0, _beyond(turn, low, high) > 0)
    near = body_states(nh.SE(2).exp(np.array([0.5 + 1e-6, 0.0, 0.0])), np.zeros(2))
    narrow: Any = StateBounds.of({"theta": (-0.3, 0.5)}, names, nowhere)
    np.testing.assert_allclose(narrow.outside(near), 1e-6, rtol=1e-4)


def _beyond(values: np.ndarray, low: float, high: float) -> np.ndarray:
    return np.maximum(0.0, np.maximum(low - values, values - high))


@pytest.mark.profile("routes", instead="test_bounds_of_states_are_linear_in_their_numbers")
@pytest.mark.parametrize(
    "values", [{"theta": (-0.5, 0.6)}, {"restricted_velocity": (-0.9, (1.0, 0.7)), "x": (-0.2, 2)}]
)
def test_bounds_of_states_are_kept_and_used_up(values: dict) -> None:
    """Run again by the compiled map, states of a parking stay within bounds that it broke without, and touch them."""

    def rooms(result: Steering) -> list[float]:
        orbit = result.orbit
        velocity = SLEIGH.system.restricted_velocity(orbit.restricted_momentum)
        states = {"theta": orbit.heading, "x": orbit.position[:, 0], "restricted_velocity": velocity}
        return [min((states[name] - low).min(), (high - states[name]).min()) for name, (low, high) in values.items()]

    free = nh.steer(SLEIGH, {}, GOAL, steps=STEPS, method="ipopt")
    result = nh.steer(SLEIGH, {}, GOAL, steps=STEPS, state_bounds=values)
    assert result.outcome == "converged"
    assert result.cost > free.cost
    assert all(room < -0.01 for room in rooms(free))
    assert all(-1e-8 < room < 1e-5 for room in rooms(result))


@pytest.mark.profile("long", instead="test_bounds_hold")
def test_wheels_are_kept_from_turning_over() -> None:
    """A snakeboard whose wheels may not pass 1.2 is steered to where it is not found without; too slow, nowhere."""
    board, motors = nh.examples.snakeboard().system, np.array([0.0, 0.0, 0.0, 1.0, 1.0])
    goal = {"configuration": {"x": 1.0, "y": 1.0, "theta": 0.0, "phi": 0.0}, "body_velocity": np.zeros(5)}
    arguments = {"start": {"configuration": np.zeros(5)}, "goal": goal, "steps": 80, "bounds": (-motors, motors)}
    discrete, limit = nh.discretize(board, 0.1), {"phi": (-1.2, 1.2)}
    assert not nh.steer(discrete, **arguments).converged
    result = nh.steer(discrete, **arguments, state_bounds=limit)
    assert result.outcome == "converged"
    orbit = result.orbit
    np.testing.assert_allclose(orbit.configuration[-1, [0, 1, 2, 4]], [1.0, 1.0, 0.0, 0.0], rtol=0, atol=1e-8)
    assert -1e-8 < 1.2 - np.abs(orbit.configuration[:, 4]).max() < 1e-5
    slow = nh.steer(discrete, **arguments, state_bounds={**limit, "body_velocity": (-0.1, 0.1)})
    assert slow.outcome in ("infeasible", "not found")
    assert np.abs(slow.orbit.body_velocity[:-1]).max() > 0.1 or slow.missed > 1e-3


def test_a_leap_over_a_disc_is_missed() -> None:
    """States on both sides of a disc are clear of it, but not the line between them; a cut of its edge is let pass."""
    way = Way.of(SLEIGH.system, 2, ([(0.0, 0.0)], 0.5), None, None, None)
    leap, edge = (np.array([[-1.0, y], [1.0, y]]) for y in (0.1, 0.4))
    np.testing.assert_allclose([way.gap(each[:, None], each) for each in (leap, edge)], [0.4, 0.0], rtol=1e-15)
    inside = np.array([[0.0, 0.2], [1.0, 0.2]])
    np.testing.assert_allclose(way.gap(inside[:, None], inside), 0.3, rtol=1e-15)


def test_a_path_is_resampled_evenly() -> None:
    """Points at equal distances along a bent path."""
    path = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 3.0]])
    np.testing.assert_allclose(resample(path, 4), [[0, 0], [1, 0], [1, 1], [1, 2], [1, 3]], atol=1e-15)


BOARD = {"start": {"configuration": np.zeros(5)}, "goal": {"configuration": {"x": 1.0}}}


@pytest.mark.profile("routes", instead="test_bad_arguments_are_refused")
def test_a_ball_rolls_aside_and_rests_as_it_was() -> None:
    """A goal of all six numbers of a pose, on its plane, around a place that it keeps clear of."""
    discrete, aside = nh.discretize(nh.examples.chaplygin_ball().system, 0.2), np.eye(4)
    aside[:2, 3] = 0.5, 0.3
    goal, bounds = {"configuration": aside, "body_velocity": np.zeros(6)}, {"y": (-0.05, np.inf)}
    result = nh.steer(discrete, {}, goal, steps=12, obstacles=([(0.25, 0.1, 0.0)], 0.1), state_bounds=bounds)
    assert result.outcome == "converged"
    orbit = nh.rollout(discrete, body_velocity=np.zeros(6), controls=result.controls, steps=12)
    np.testing.assert_allclose(orbit.configuration[-1], aside, rtol=0, atol=1e-8)
    place = orbit.configuration[:, :3, 3]
    assert np.linalg.norm(place - [0.25, 0.1, 0.0], axis=1).min() > 0.1 - 1e-8
    assert place[:, 1].min() > -0.05 - 1e-8
    assert np.abs(place[:, 2]).max() < 1e-9


_REST = {"configuration": np.zeros(5)}
SYSTEMS = {
    "board": lambda: nh.examples.snakeboard().system,
    "ball": lambda: nh.examples.chaplygin_ball().system,
    "driven": lambda: nh.Forced(nh.examples.snakeboard().system, force=np.zeros((4, 5))),
    "car": lambda: nh.examples.kinematic_car().system,
}


def _asked(change: dict[str, Any]) -> None:
    defaults: dict[str, Any] = {"discrete": SLEIGH, "start": {}, "goal": {"configuration": ASIDE}, "steps": 4}
    if change.get("discrete") in SYSTEMS:
        change = BOARD | change | {"discrete": nh.discretize(SYSTEMS[change["discrete"]](), 0.1)}
    nh.steer(**defaults | change)


# What cannot be steered is named before any work.
test_bad_arguments_are_refused = refusals(
    ({"goal": {}}, "name a pose or a velocity"),
    ({"goal": {"pose": ASIDE}}, "name only"),
    ({"goal": {"configuration": 2 * ASIDE}}, "lie in SE"),
    ({"start": 5}, "name only"),
    ({"start": {"restricted_velocity": [[1.0, 2.0], [1.0]]}}, "be an array of real numbers"),
    ({"start": {"body_velocity": (0.0, 0.0, 1.0)}}, r"`steer.start\(body_velocity=...\)` must satisfy the constraint"),
    ({"start": {"body_velocity": (0.0, 1.0, 0.0), "momentum": (0.0, 1.0)}}, "exactly one of body_velocity, momentum"),
    ({"goal": {"restricted_velocity": (0.0, 1.0, 0.0)}}, "one number per admissible direction"),
    ({"start": _starts(2), "goal": {"restricted_velocity": np.zeros((3, 2))}}, "as many members each"),
    ({"start": {"configuration": np.zeros((0, 3, 3))}}, "as many members each"),
    ({"bounds": (1.0, -1.0)}, "leave room"),
    ({"bounds": 3.0}, "be a pair"),
    ({"cost": "time"}, "be one of"),
    ({"steps": 0}, "positive integer"),
    ({"discrete": SLEIGH.system}, "discretized system"),
    ({"discrete": nh.discretize(nh.VeselovaTop(np.diag([1.0, 2.0, 3.0])), 0.1)}, "left-invariant"),
    ({"discrete": nh.discretize(SLEIGH.system, 0.1, order=4)}, "order 2"),
    ({"obstacles": ([(0.0, 0.1)], 0.3)}, "clear of obstacles"),
    ({"obstacles": ([(0.0, 1.1)], 0.3)}, r"goal=...\)` must be clear"),
    ({"obstacles": 3}, "be a pair"),
    ({"obstacles": ([(3.0, 1.0)], -0.1)}, "positive radii"),
    ({"obstacles": ([(3.0, 1.0)], (0.1, 0.2))}, "shape"),
    ({"outline": np.zeros((0, 2))}, "have a point"),
    ({"via": {0: (1.0, 1.0)}}, "number of a step"),
    ({"via": {2: (1.0, 1.0, 1.0)}}, "shape"),
    ({"guess": [(0.0, 0.0)]}, "two positions or more"),
    ({"state_bounds": 3}, "name components of a state"),
    ({"state_bounds": {"phi": (0.0, 1.0)}}, "restricted_velocity, x, y, theta"),
    ({"state_bounds": {"x": (1.0, 0.0)}}, "room between"),
    ({"state_bounds": {"x": 1.0}}, "be a pair"),
    ({"state_bounds": {"x": ("a", 1.0)}}, "real numbers"),
    ({"state_bounds": {"x": (float("nan"), 1.0)}}, "be finite"),
    ({"state_bounds": {"restricted_velocity": (-1.0, (1.0, 2.0, 3.0))}}, "shape"),
    ({"state_bounds": {"theta": (-3.0, 4.0)}}, "less than a turn"),
    ({"state_bounds": {"x": (0.1, 1.0)}}, r"start=...\)` must lie within state_bounds"),
    ({"state_bounds": {"y": (-1.0, 0.9)}}, r"goal=...\)` must lie within state_bounds. Got y outside by 0.1"),
    ({"state_bounds": {"x": (-1.0, 1.0)}, "method": "shooting"}, "left out of shooting"),
    ({"method": "newton"}, "be one of"),
    ({"method": "shooting", "via": {1: (0.0, 0.0)}}, "left out of shooting"),
    ({"progress": 1}, "True or False"),
    ({"discrete": nh.discretize(nh.SuslovTop(np.eye(3)), 0.1), "obstacles": DISC}, "have a position"),
    ({"discrete": nh.discretize(nh.SuslovTop(np.eye(3)), 0.1), "guess": [(0, 0), (1, 1)]}, "without a position"),
    ({"discrete": nh.discretize(nh.Forced(SLEIGH.system, force=lambda *_: np.zeros(3)), 0.1)}, "that are numbers"),
    ({"discrete": nh.discretize(nh.Forced(SLEIGH.system, force=np.zeros((2, 3))), 0.1)}, "one for each row"),
    ({"discrete": "board", "method": "shooting"}, "be one of None, 'ipopt'"),
    ({"discrete": "board", "start": {}}, "be given for a system in coordinates"),
    ({"discrete": "board", "start": {"pose": 1}}, "name only"),
    ({"discrete": "board", "goal": {}}, "coordinates or a velocity"),
    ({"discrete": "board", "goal": {"configuration": {"z": 1.0}}}, "coordinates of the system"),
    ({"discrete": "board", "state_bounds": {"phi": (0.1, 1.0)}}, "Got phi outside by 0.1"),
    ({"discrete": "board", "state_bounds": {"x": (-1.0, 0.9)}}, "Got x outside by 0.1"),
    ({"discrete": "ball", "start": {}, "goal": {}}, "coordinates or a velocity"),
    ({"discrete": "ball", "start": {}, "goal": {"configuration": np.eye(3)}}, "shape"),
    ({"discrete": "ball", "start": {}, "outline": len}, "points of a body on a group"),
    ({"discrete": "driven"}, "have no force yet"),
    ({"outline": trailer_axle}, "be points of a body on a group"),
    ({"discrete": "car", "start": _REST, "goal": _REST, "outline": lambda q: q[:2]}, r"of shape \(points, 2\)"),
    ask=_asked,
)
