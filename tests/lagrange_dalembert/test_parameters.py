"""Parameters of systems in coordinates: the same as numbers within the functions, compiled once for all numbers."""

import inspect
import pickle
from pathlib import Path
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest
from comparisons import assert_member, assert_near
from jax import lax
from refusals import refusals

import nonholo as nh

NUMBERS = {"mass": 1.7, "inertia": 0.3, "arm": -0.4, "pull": np.array([0.2, -0.1, 0.05])}
OTHERS = {"mass": 0.6, "inertia": 1.1, "arm": 0.25, "pull": np.array([-0.3, 0.4, 0.2])}
ROWS = ("configuration", "displacement", "momentum", "multipliers", "energy", "constraint_residual")
START: dict[str, Any] = {"configuration": (0.1, -0.2, 0.0), "momentum": (0.7, 0.3, -0.4)}
"""A momentum begins along whatever constraint there is."""
CALLS: list[str] = []


def sleigh(q, v, p):  # noqa: ANN001, ANN201
    """Return the Lagrangian of a sleigh on a slope."""
    CALLS.append("sleigh")
    return (p["mass"] * (v[0] ** 2 + v[1] ** 2) + p["inertia"] * v[2] ** 2) / 2 + p["pull"] @ jnp.sin(q)


def timed(q, v, time, p):  # noqa: ANN001, ANN201
    """Return a Lagrangian that depends on the time."""
    return sleigh(q, v, p) * (1 + 0.1 * jnp.cos(p["arm"] * time))


def looped(q, v, p):  # noqa: ANN001, ANN201
    """Return the same Lagrangian by a loop, of which no formulas can be made."""
    return lax.fori_loop(0, 1, lambda _, value: value + sleigh(q, v, p), 0.0)


def blade(q, p):  # noqa: ANN001, ANN201
    """Return the constraint of a blade ahead of the reference point."""
    return jnp.array([[-jnp.sin(q[2]), jnp.cos(q[2]), p["arm"]]])


def turned(q, time, p):  # noqa: ANN001, ANN201
    """Return the constraint of a blade that turns."""
    return blade(q.at[2].add(p["arm"] * time), p)


def action(q, q_next, time_step, p):  # noqa: ANN001, ANN201
    """Return a discrete Lagrangian."""
    return time_step * sleigh(q, (q_next - q) / time_step, p)


def short_action(q, q_next, p):  # noqa: ANN001, ANN201
    """Return the same for one time step."""
    return action(q, q_next, 0.05, p)


def pushed(time, q, v, p):  # noqa: ANN001, ANN201
    """Return a force."""
    return p["pull"] * jnp.cos(time) - 0.1 * p["mass"] * v + 0 * q


def rolled(q, time, p):  # noqa: ANN001, ANN201
    """Return the sideways velocity of a moving blade."""
    return jnp.array([0.1 * p["mass"] * jnp.sin(time) + 0 * q[0]])


def driven(time, p):  # noqa: ANN001, ANN201
    """Return the motion of a driven joint."""
    return p["inertia"] * jnp.sin(p["mass"] * time)


def within(function: Any, numbers: dict[str, Any]) -> Any:
    """Return a function that has the numbers within."""

    def with_numbers(*given: Any) -> Any:
        return function(*given, numbers)

    *arguments, _ = inspect.signature(function).parameters.values()
    with_numbers.__signature__ = inspect.Signature(arguments)  # type: ignore[attr-defined]
    return with_numbers


SYSTEMS: dict[str, dict[str, Any]] = {
    "midpoint": {"lagrangian": sleigh, "constraint_forms": blade},
    "trapezoidal": {"lagrangian": sleigh, "constraint_forms": blade, "rule": "trapezoidal"},
    "without formulas": {"lagrangian": looped, "constraint_forms": blade},
    "free": {"lagrangian": sleigh, "constraint_forms": None},
    "of time": {"lagrangian": timed, "constraint_forms": turned},
    "discrete": {"lagrangian": sleigh, "constraint_forms": blade, "discrete_lagrangian": action},
    "one time step": {"lagrangian": sleigh, "constraint_forms": blade, "discrete_lagrangian": short_action},
    "force": {"lagrangian": sleigh, "constraint_forms": blade, "force": pushed},
    "moving": {"lagrangian": sleigh, "constraint_forms": blade, "constraint_velocities": rolled},
    "joint": {"lagrangian": sleigh, "constraint_forms": None, "prescribed": {2: driven}},
}


def made(name: str, numbers: dict[str, Any] | None = None) -> nh.LagrangeDAlembert:
    """Return a system with parameters, or with numbers within."""
    given = dict(SYSTEMS[name])
    if numbers is None:
        return nh.LagrangeDAlembert(**given, dimension=3, parameters=NUMBERS)
    plain = {key: within(value, numbers) if callable(value) else value for key, value in given.items()}
    if "prescribed" in plain:
        plain["prescribed"] = {2: within(driven, numbers)}
    return nh.LagrangeDAlembert(**plain, dimension=3)


@pytest.mark.profile("routes", keep=["midpoint", "force"])
@pytest.mark.parametrize("name", SYSTEMS)
def test_parameters_are_numbers_within_the_functions(name: str) -> None:
    """A run has what it has with the numbers within, but for constants that were computed before: to rounding."""
    system = made(name).with_parameters(**OTHERS)
    orbit, plain = (nh.simulate(nh.discretize(each, 0.05), **START, steps=40) for each in (system, made(name, OTHERS)))
    for row in ROWS:
        ours, theirs = getattr(orbit, row), getattr(plain, row)
        assert np.abs(ours - theirs).max(initial=0.0) <= 1e-13 * (1 + np.abs(theirs).max(initial=0.0)), row


@pytest.mark.profile("routes", keep=["force"])
@pytest.mark.parametrize("name", ["midpoint", "of time", "force", "moving", "joint"])
def test_flows_and_work_have_the_parameters(name: str) -> None:
    """A flow, and the work along it, agree with those of numbers within, to the errors of its steps."""
    system, times = made(name).with_parameters(**OTHERS), np.linspace(0.0, 1.0, 9)
    orbit, plain = (nh.flow(each, **START, times=times) for each in (system, made(name, OTHERS)))
    assert_near(orbit, plain, 1e-09, "configuration", "momentum", "multipliers", "energy", "work")


@pytest.mark.profile("routes", keep=["midpoint"])
@pytest.mark.parametrize("name", ["midpoint", "without formulas", "force"])
def test_other_numbers_are_not_compiled(name: str) -> None:
    """What was run with one set of numbers traces no function for another: not of a run, its parts or a flow."""

    def run(system: nh.LagrangeDAlembert) -> None:
        discrete = nh.discretize(system, 0.05)
        nh.simulate(discrete, **START, steps=7, events=[lambda states: states.configuration[:, 0] - 0.11])
        velocity = nh.flow(system, **START, times=(0.0, 0.5)).body_velocity[0]
        nh.simulate(discrete, configuration=START["configuration"], body_velocity=velocity, steps=3)

    system = made(name)
    run(system)
    before = len(CALLS)
    for mass in np.linspace(0.5, 2.0, 5):
        run(system.with_parameters(mass=mass).with_parameters(arm=0.1 * mass))
    assert len(CALLS) == before


@pytest.mark.profile("routes", instead="test_a_force_of_the_time_goes_with_parameters")
def test_a_force_and_friction_go_with_parameters() -> None:
    """`Forced` adds a potential and a force that take the parameters, friction and a table that do not."""
    table, friction = np.full((40, 3), 0.1), nh.Friction((0.1, 0.2, 0.3))
    well = lambda q, p: p["mass"] * q @ q  # noqa: E731
    system = nh.Forced(made("midpoint"), potential=well, force=(pushed, friction, table))
    given = within(pushed, OTHERS), friction, table
    plain = nh.Forced(made("midpoint", OTHERS), potential=lambda q: OTHERS["mass"] * q @ q, force=given)
    runs = [
        nh.simulate(nh.discretize(each, 0.05), **START, steps=40) for each in (system.with_parameters(**OTHERS), plain)
    ]
    assert_near(runs[0], runs[1], 1e-13, "configuration", "work")


@pytest.mark.profile("routes", keep=["force"])
@pytest.mark.parametrize("part", ["potential", "force"])
def test_a_force_of_the_time_goes_with_parameters(part: str) -> None:
    """`Forced` keeps the time of a Lagrangian between velocity and parameters; what it adds need not take them."""
    well, drag = lambda q: NUMBERS["mass"] * q @ q, lambda _time, q, v: -0.1 * v + 0 * q
    plain = nh.Forced(made("of time", NUMBERS), potential=well, force=drag)
    own = {"potential": lambda q, p: p["mass"] * q @ q, "force": lambda time, q, v, p: drag(time, q, v) + 0 * p["mass"]}
    pair = nh.Forced(made("of time"), **{"potential": well, "force": drag, part: own[part]}), plain
    ends = [nh.simulate(nh.discretize(each, 0.05), **START, steps=9).configuration[-1] for each in pair]
    assert np.abs(ends[0] - ends[1]).max() <= 1e-14


def test_systems_know_their_parameters() -> None:
    """Equality and hash are those of functions and numbers; texts are short, and what is given cannot be changed."""
    system = made("midpoint")
    same, other = system.with_parameters(mass=1.7), system.with_parameters(mass=2)
    assert system == same
    assert hash(system) == hash(same)
    assert system != other
    assert other.family is system.family
    assert other.parameters["mass"] == 2.0
    assert system.parameters["mass"] == 1.7
    assert "parameters={'mass': 2.0, 'inertia': 0.3, 'arm': -0.4, 'pull': shape (3,)}" in repr(other)
    with pytest.raises(ValueError, match="read-only"):
        other.parameters["pull"][0] = 1.0
    with pytest.raises(TypeError):
        other.parameters["mass"] = 1.0
    assert pickle.loads(pickle.dumps(other)) == other  # noqa: S301


def test_an_outline_takes_parameters() -> None:
    """The picture of a body has its lengths."""
    drawn = nh.LagrangeDAlembert(
        sleigh, blade, dimension=3, parameters=NUMBERS, outline=lambda q, p: [[q[:2], [p["arm"], 0]]]
    )
    assert drawn.with_parameters(arm=0.5).parts(np.zeros(3))[0].tolist() == [[0, 0], [0.5, 0]]


def test_other_questions_see_the_parameters() -> None:
    """Checks, regularity and growth are those of the system with the numbers within."""
    system, plain = made("midpoint").with_parameters(**OTHERS), made("midpoint", OTHERS)
    assert nh.testing.check_system(system, configuration=(0.1, 0.2, 0.3)).passed
    ends = (0.0, 0.0, 0.0), (0.1, 0.05, 0.1)
    assert system.regularity(*ends) == pytest.approx(plain.regularity(*ends), rel=1e-14)
    at = {"configuration": (0.1, 0.2, 0.3)}
    assert nh.accessibility(system, **at).growth == nh.accessibility(plain, **at).growth


def test_stores_tell_the_parameters(tmp_path: Path) -> None:
    """A store holds them, an orbit from it tells them, and a run continues with the same numbers alone."""
    system, path = made("midpoint").with_parameters(**OTHERS), tmp_path / "run.zarr"
    whole = nh.simulate(nh.discretize(system, 0.05), **START, steps=30)
    nh.simulate(nh.discretize(system, 0.05), **START, steps=10, store=path, checkpoint_every=5)
    stored = nh.load_orbit(path).system.parameters
    assert stored == {"mass": 0.6, "inertia": 1.1, "arm": 0.25, "pull": [-0.3, 0.4, 0.2]}
    with pytest.raises(ValueError, match="must be the discretization of the store"):
        nh.extend(path, 20, discrete=nh.discretize(system.with_parameters(mass=0.7), 0.05))
    nh.extend(path, 20, discrete=nh.discretize(system, 0.05))
    assert np.array_equal(nh.load_orbit(path, discrete=nh.discretize(system, 0.05)).configuration, whole.configuration)


# Each bad argument is refused by its name.
test_bad_parameters_are_refused = refusals(
    ({"lagrangian": lambda q, v: q @ v}, r"lagrangian=.* take the parameters .* Got \(q, v\)"),
    ({"constraint_forms": lambda q: q[None]}, r"constraint_forms=.* last argument. Got \(q\)"),
    ({"prescribed": {0: lambda time: time}}, r"prescribed=.* last argument. Got \(time\)"),
    ({"force": lambda time, q, v: time * q + v}, r"force=.* last argument. Got \(time, q, v\)"),
    ({"parameters": {"a b": 1.0}}, r"parameters=\.\.\.\)` must be a name"),
    ({"parameters": {"time_step": 1.0}}, r"must be a name.* taken: time_step"),
    ({"parameters": [1.0]}, r"must be a mapping of names to numbers"),
    ({"parameters": {"mass": "heavy"}}, r"parameters=\{'mass': \.\.\.\}\)` must be an array of real numbers"),
    ({"parameters": {"mass": [1.0, np.nan]}}, r"'mass'.* must be finite"),
    ({"lagrangian": lambda q, v, p: p["weight"] * v @ q}, r"KeyError: 'weight'"),
    ask=lambda given: nh.LagrangeDAlembert(
        **{"lagrangian": sleigh, "constraint_forms": None, "dimension": 3, "parameters": NUMBERS} | given
    ),
)


# Other numbers have a known name, the same shape, and are finite.
test_bad_numbers_are_refused = refusals(
    ({"mas": 1.0}, r"`with_parameters\(\.\.\.\)` must name parameters .* Got 'mas'. Did you mean mass\?"),
    ({"q": 1.0}, r"Got 'q'. It has mass, inertia, arm, pull\."),
    ({"mass": [1.0, 2.0]}, r"with_parameters\(\{'mass': \.\.\.\}\)` must have shape \(\). Got shape \(2,\)"),
    ({"mass": np.inf}, "must be finite"),
    ({}, "It has none: make it with parameters="),
    ask=lambda given: made("midpoint", None if given else NUMBERS).with_parameters(**given or {"mass": 1.0}),
)


def test_members_with_parameters_are_runs_alone() -> None:
    """Members of an ensemble have the bits of their runs by `simulate`, numbers and arrays alike."""
    rng, discrete = np.random.default_rng(4), nh.discretize(made("force"), 0.05)
    varied = {"mass": rng.uniform(0.5, 2.0, 4), "pull": rng.normal(size=(4, 3)), "time_step": rng.uniform(0.02, 0.1, 4)}
    batch = nh.ensemble(discrete, **START, parameters=varied, steps=30, save_every=10)
    for member in range(4):
        own = {name: values[member] for name, values in varied.items()}
        alone = nh.discretize(made("force").with_parameters(mass=own["mass"], pull=own["pull"]), own["time_step"])
        orbit = nh.simulate(alone, **START, steps=30, save_every=10)
        assert_member(
            batch, member, orbit, "configuration", "momentum", "energy", "body_velocity", "restricted_momentum"
        )
        assert batch.orbit(member).system == alone.system
    assert np.array_equal(batch.to_dataset()["pull"], varied["pull"])


def test_members_with_parameters_are_compiled_once() -> None:
    """A hundred masses trace no function more than one does."""
    discrete = nh.discretize(made("force"), 0.05)
    nh.ensemble(discrete, **START, parameters={"mass": [1.0]}, steps=3)
    before = len(CALLS)
    nh.ensemble(discrete, **START, parameters={"mass": np.linspace(0.5, 2.0, 100)}, steps=3)
    assert len(CALLS) == before


# Members differ by known names and fitting shapes.
test_bad_members_are_refused = refusals(
    ({"mas": [1.0]}, r"fields of the system. Got 'mas'. LagrangeDAlembert has mass, inertia, arm, pull, time_step"),
    ({"pull": [1.0, 2.0]}, r"'pull': \.\.\.\}\)` must have shape \(any, 3\)"),
    ({"mass": [1.0, np.nan]}, "must be finite"),
    ask=lambda given: nh.ensemble(nh.discretize(made("midpoint"), 0.05), **START, parameters=given, steps=3),
)
