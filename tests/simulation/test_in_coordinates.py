"""Events and ensembles of systems in coordinates: known crossings, blocks, ends of runs, members, refusals."""

import jax.numpy as jnp
import numpy as np
import pytest
from comparisons import assert_member
from refusals import refusals

import nonholo as nh
from nonholo.lagrange_dalembert import LagrangeDAlembert

G = 0.8
PROFILE = pytest.mark.profile("routes", instead="test_a_ready_system_is_first_class")


def kinetic(q, v):  # noqa: ANN001, ANN201, ARG001
    """Return the Lagrangian of a free particle."""
    return v @ v / 2


def weight(time, q, v):  # noqa: ANN001, ANN201, ARG001
    """Return the force on a stone."""
    return jnp.array([-G, 0.0])


FALL = LagrangeDAlembert(lambda q, v: v @ v / 2 - G * q[0], None, dimension=2)
MOVED = LagrangeDAlembert(kinetic, None, dimension=2, force=weight)
THROWN = {"configuration": (0.0, 0.0), "body_velocity": (1.0, 0.5)}


def folded(q, q_next, h):  # noqa: ANN001, ANN201
    """Return a discrete Lagrangian whose momentum is sin(q' - q) at most: a fold at a right angle."""
    return jnp.sum(1 - jnp.cos(q_next - q)) / h + h * 0.15 * jnp.sum(q + q_next) / 2


FOLDING = LagrangeDAlembert(lambda q, v: v @ v / 2 + 0.15 * q[0], None, dimension=1, discrete_lagrangian=folded)


def height(states: nh.lagrange_dalembert.CoordinateOrbit) -> np.ndarray:
    """Return how far above 0.3 a stone is."""
    return states.configuration[:, 0] - 0.3


def rise(states: nh.lagrange_dalembert.CoordinateOrbit) -> np.ndarray:
    """Return the momentum upwards."""
    return states.momentum[:, 0]


@PROFILE
@pytest.mark.parametrize("system", [FALL, MOVED], ids=["potential", "force"])
def test_thrown_stones_cross_where_parabolas_do(system: LagrangeDAlembert) -> None:
    """The midpoint rule of any length moves along the parabola, and so do parts of its steps."""
    discrete = nh.discretize(system, 0.13)
    orbit = nh.simulate(discrete, **THROWN, steps=20, events=[height, rise])
    root = np.sqrt(1 - 0.6 * G)
    assert np.abs(orbit.events["height"].time - [(1 - root) / G, (1 + root) / G]).max() <= 1e-14
    assert orbit.events["height"].direction.tolist() == [1, -1]
    top = orbit.events["rise"]
    assert np.abs(top.time - 1 / G).max() <= 1e-14
    assert np.abs(top.states.configuration - [[1 / (2 * G), 0.5 / G]]).max() <= 1e-14
    assert (top.step, top.fraction) == (9, pytest.approx((1 / G - 9 * 0.13) / 0.13, abs=1e-12))


@PROFILE
@pytest.mark.parametrize("system", [FALL, MOVED], ids=["potential", "force"])
def test_flows_cross_where_parabolas_do(system: LagrangeDAlembert) -> None:
    """Forwards and backwards, from few requested times; a stopping event ends them with the last one before it."""
    root = np.sqrt(1 - 0.6 * G)
    result = nh.flow(system, **THROWN, times=np.linspace(0.0, 3.0, 5), rtol=1e-12, atol=1e-13, events=[height, rise])
    assert np.abs(result.events["height"].time - [(1 - root) / G, (1 + root) / G]).max() <= 1e-12
    assert np.abs(result.events["rise"].states.configuration - [[1 / (2 * G), 0.5 / G]]).max() <= 1e-12
    assert (len(result), result.events["rise"].step.tolist()) == (5, [1])
    stopped = nh.flow(system, **THROWN, times=np.linspace(0.0, 3.0, 5), events=[nh.Event(rise, stop=True)])
    assert (stopped.time[-1], stopped.outcome) == (0.75, nh.Outcome.successful)
    back = nh.flow(system, **THROWN, times=[0.0, -0.7, -1.5], events=[lambda states: states.configuration[:, 0] + 1.0])
    assert np.abs(back.events[0].time - (1 - np.sqrt(1 + 2 * G)) / G).max() <= 1e-9


@PROFILE
def test_members_are_runs_alone_however_they_end() -> None:
    """Those that fold keep their good states and are NaN after them; with the last state alone it is the last good."""
    discrete, v = nh.discretize(FOLDING, 1.0), np.array([[0.1], [0.3], [-1.5], [0.8]])
    runs = [nh.simulate(discrete, configuration=[0.0], body_velocity=row, steps=9, throw=False) for row in v]
    batch = nh.ensemble(discrete, configuration=[0.0], body_velocity=v, steps=9, save_every=2)
    last = nh.ensemble(discrete, configuration=np.zeros((4, 1)), body_velocity=v, steps=9)
    assert batch.outcome.tolist() == last.outcome.tolist() == [int(run.outcome) for run in runs]
    assert batch.steps_done.tolist() == last.steps_done.tolist() == [max(len(run) - 1, 0) for run in runs]
    assert len({*batch.steps_done}) >= 3
    for member, run in enumerate(runs):
        rows = run.configuration[::2]
        assert np.array_equal(batch.configuration[member, : len(rows)], rows)
        assert np.isnan(batch.configuration[member, len(rows) :]).all()
        assert np.array_equal(last.configuration[member][: len(run)], run.configuration[-1:])
        assert len(batch.orbit(member)) == len(rows)
    table = last.to_dataset()
    assert (dict(table.sizes)["member"], table.outcome.values.tolist()) == (4, batch.outcome.tolist())
    with pytest.raises(ValueError, match="Members count from 0"):
        batch.orbit(4)


BALL = nh.examples.chaplygin_ball()
KINKED = LagrangeDAlembert(lambda q, v: v @ v / 2 - jnp.sum(jnp.abs(q)), None, dimension=1)
SPRING = LagrangeDAlembert(
    lambda q, v, p: (p["mass"] * v @ v - q @ q) / 2,
    None,
    dimension=1,
    force=lambda time, q, v, p: jnp.sin(p["rate"] * time) - 0 * v,  # noqa: ARG005
    parameters={"mass": 1.0, "rate": 2.0},
)
READ = "time", "configuration", "body_velocity", "momentum", "multipliers", "energy"
FLOWS = {
    "on a group": (BALL.system, {"body_velocity": BALL.body_velocity * np.array([[1.0], [-2.0]])}, {}),
    "driven": (SPRING, {"configuration": [0.5], "momentum": [[1.0], [2.0]]}, {"mass": [1.0, 3.0]}),
    "by diffrax": (KINKED, {"configuration": [[0.5], [1.0]], "body_velocity": [0.2]}, {}),
}


@pytest.mark.profile("routes", cases=["None-on a group", "None-by diffrax"])
@pytest.mark.parametrize("name", FLOWS)
@pytest.mark.parametrize("rtol", [None, 1e-9])
def test_members_of_flows_are_flows_alone(name: str, rtol: float | None) -> None:
    """Bit for bit, by series or not, from the first time of a driven system back in time, with parameters."""
    system, start, parameters = FLOWS[name]
    times = [0.5, 0.2, -0.3] if name == "driven" else [0.0, 0.4, 1.0]
    batch = nh.ensemble(system, times=times, rtol=rtol, **start, parameters=parameters)
    energies = nh.ensemble(system, times=times, rtol=rtol, **start, parameters=parameters, reduce=lambda x: x.energy)
    for member in range(2):
        own = {what: np.asarray(value)[member] for what, value in parameters.items()}
        alone = system.with_parameters(**own) if own else system
        first = {what: np.asarray(x)[member if np.ndim(x) == 2 else ...] for what, x in start.items()}
        orbit = nh.flow(alone, times=times, rtol=rtol, **first)
        assert_member(batch, member, orbit, *READ)
        assert np.array_equal(energies[member], orbit.energy)
        assert np.array_equal(batch.orbit(member).configuration, orbit.configuration)
    assert batch.to_dataset().configuration.shape[:2] == (2, 3)


# Each refusal says what is wrong before any work.
test_flows_of_members_that_cannot_be_solved_are_refused = refusals(
    ({"reconstruct": False}, r"ensemble\(reconstruct=...\)` must keep its default"),
    ({"steps": 3}, r"ensemble\(steps=...\)` must be left out for a flow"),
    ({"parameters": {"time_step": [0.1]}}, "must name fields of the system"),
    ({"rtol": -1.0}, "rtol"),
    ({"configuration": [[1.0], [np.nan]]}, "finite"),
    ask=lambda x: nh.ensemble(SPRING, **{"times": [0.0, 1.0], "configuration": [[1.0]], "body_velocity": [0.0]} | x),
)


# Each refusal says what is wrong and what to pass.
test_members_that_cannot_be_run_are_refused = refusals(
    ({"body_velocity": (1.0, 0.5)}, "have a row for each member. Got one start"),
    ({"body_velocity": np.empty((0, 2))}, "have a row for each member. Got no rows"),
    ({"configuration": np.zeros((2, 2)), "body_velocity": np.zeros((3, 2))}, "Got 2 of configuration, 3 of"),
    ({"body_velocity": np.zeros((3, 4))}, r"must have shape \(any, 2\)"),
    ({"body_velocity": np.zeros((3, 2)), "momentum": np.zeros((3, 2))}, "exactly one of"),
    ({"parameters": {"mass": [1.0, 2.0]}, "body_velocity": (1, 0)}, "coordinates that has no parameters"),
    ({"body_velocity": [(1.0, 0.0), (np.inf, 0.0)]}, "must be finite"),
    ({"body_velocity": [(1.0, 0.0)], "times": (0.0, 1.0)}, r"ensemble\(times=...\)` must keep its default"),
    ({"restricted_velocity": [(1.0, 0.0)]}, r"ensemble\(restricted_velocity=...\)` must keep"),
    ({"body_velocity": [(1.0, 0.0)], "steps": None}, r"ensemble\(steps=...\)` must be"),
    ask=lambda given: nh.ensemble(nh.discretize(FALL, 0.1), **{"configuration": (0.0, 0.0), "steps": 3} | given),
)


@PROFILE
def test_a_start_off_the_constraint_is_refused_with_its_member() -> None:
    """Before any member runs."""
    skate = LagrangeDAlembert(kinetic, lambda q: jnp.array([[q[1], 1.0]]), dimension=2)
    rows = [(1.0, 0.0), (0.5, 0.0), (1.0, 1.0)]
    with pytest.raises(ValueError, match=r"nearest admissible velocity .* This is member 2\."):
        nh.ensemble(nh.discretize(skate, 0.1), configuration=(0.0, 0.0), body_velocity=rows, steps=10**9 // 2)


# What was made for one time step knows no others.
test_events_without_parts_of_steps_are_refused = refusals(
    ({"discrete_lagrangian": lambda q, p: (p - q) @ (p - q) / 0.2}, "must be left out where a part of a step"),
    ({"force": np.zeros((9, 2))}, "must be left out where a part of a step"),
    ask=lambda given: nh.simulate(
        nh.discretize(LagrangeDAlembert(kinetic, None, dimension=2, **given), 0.1), **THROWN, steps=5, events=[height]
    ),
)
