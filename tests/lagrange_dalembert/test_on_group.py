"""Left-invariant Lagrangians with any constraints on a group: special cases, mixed systems, what is not conserved."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from comparisons import assert_near
from refusals import refusals
from scipy.integrate import solve_ivp

import nonholo as nh
from nonholo.lagrange_dalembert import GroupLagrangeDAlembert, GroupOrbit, mass_tensor_lagrangian
from nonholo.lagrange_dalembert.compiled import _run

TENSOR = np.array([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
PLANE, BODY = nh.SE(2), nh.ChaplyginSleigh(mass=1.3, inertia=0.7, a=0.0, b=0.2)
ACTION = mass_tensor_lagrangian(PLANE, BODY.homogeneous_mass_tensor)
ROLL = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
START = {"configuration": PLANE.exp(np.array([0.4, 1.0, -2.0]))}


def rewritten(system) -> GroupLagrangeDAlembert:  # noqa: ANN001
    """Return an LL or LR system as forms a(g) and (D - D^-1)/2 in d, D the displacement in the frame of d."""
    group, rows = system.group, np.asarray(system.annihilator)
    right = isinstance(system, nh.VeselovaTop)

    def forms(g):  # noqa: ANN001, ANN202
        return group.coadjoint(g, jnp.asarray(rows)) if right else jnp.asarray(rows)

    def constraints(g, W, h):  # noqa: ANN001, ANN202, ARG001
        D = g @ W @ group.inverse(g) if right else W
        return jnp.asarray(rows) @ group.vee((D - group.inverse(D)) / 2)

    action = mass_tensor_lagrangian(group, system.homogeneous_mass_tensor)
    return GroupLagrangeDAlembert(group, action, forms, constraints)


CASES = {
    "sleigh": (nh.ChaplyginSleigh(mass=1.3, inertia=0.7, a=0.5, b=0.2), (1.0, -1.0, 0.0)),
    "top": (nh.SuslovTop(TENSOR), (0.7, -0.5, 0.0)),
    "veselova": (nh.VeselovaTop(TENSOR), (0.7, -0.5, 0.0)),
}


@pytest.mark.profile("routes", instead="test_the_equations_hold_with_their_sign")
@pytest.mark.parametrize("name", CASES)
def test_invariant_constraints_give_the_known_maps(name: str) -> None:
    """Constant forms are the LL map, forms Ad*_g a the LR map; rounding of 50 steps stays below 1e-12."""
    system, velocity = CASES[name]
    g = system.group.random(np.random.default_rng(3))
    if name == "veselova":
        velocity = system.group.adjoint(system.group.inverse(g)) @ velocity
    start = {"configuration": g, "body_velocity": velocity, "steps": 50}
    ours, reference = (nh.simulate(nh.discretize(each, 0.15), **start) for each in (rewritten(system), system))
    assert np.abs(reference.multipliers).max() > 0.01
    assert_near(ours, reference, 1e-12, "momentum", "displacement", "configuration", "multipliers")


def blade(g):  # noqa: ANN001, ANN201
    """Return the normal of a blade that is turned in the body by an angle which depends on the place."""
    angle = 0.7 * jnp.sin(g[0, 2]) + 0.4 * jnp.cos(1.3 * g[1, 2])
    return jnp.array([[0.0, -jnp.sin(angle), jnp.cos(angle)]])


MIXED = GroupLagrangeDAlembert(PLANE, ACTION, blade)


def admissible(turn: float, speed: float, g: np.ndarray = START["configuration"]) -> np.ndarray:
    """Return a body velocity that satisfies the constraint at a pose, by default the start."""
    x, y = g[:2, 2]
    angle = 0.7 * np.sin(x) + 0.4 * np.cos(1.3 * y)
    return np.array([turn, speed * np.cos(angle), speed * np.sin(angle)])


def run(h: float, steps: int, **changes) -> GroupOrbit:  # noqa: ANN003
    """Return an orbit of the mixed system."""
    start = START | {"body_velocity": admissible(0.9, 1.0), "steps": steps}
    if changes.keys() & {"displacement", "momentum"}:
        del start["body_velocity"]
    return nh.simulate(nh.discretize(MIXED, h), **(start | changes))


def test_the_equations_hold_with_their_sign() -> None:
    """P(W_k+1) - Ad*_W P(W_k) = lambda a(g_k+1), and a at the middle pose annihilates log W."""
    orbit = run(0.1, 20)
    with jax.enable_x64(True):
        forms = np.stack([np.asarray(blade(jnp.asarray(g)))[0] for g in orbit.configuration])
        x = PLANE.log(orbit.displacement)
        middle = orbit.configuration @ PLANE.exp(x / 2)
        missed = [np.asarray(blade(jnp.asarray(g)))[0] @ y for g, y in zip(middle, x, strict=True)]
    arriving = PLANE.coadjoint(orbit.displacement[:-1], orbit.momentum[:-1])
    force = orbit.multipliers * forms[1:]
    assert np.abs(orbit.momentum[1:] - arriving - force).max() <= 1e-13
    assert np.abs(missed).max() <= 1e-14
    assert np.abs(orbit.configuration[1:] - orbit.configuration[:-1] @ orbit.displacement[:-1]).max() <= 1e-14


def test_the_midpoint_rule_is_reversible() -> None:
    """From g_20 with W_19 inverted the run goes back over the same poses."""
    there = run(0.2, 20)
    W = PLANE.inverse(there.displacement[19])
    back = run(0.2, 20, configuration=there.configuration[20], displacement=W)
    assert np.abs(back.configuration[::-1] - there.configuration).max() <= 1e-12


def test_energy_drifts_though_the_rule_is_reversible() -> None:
    """The flow's energy is constant; the map's falls steadily here, four times slower with half the step."""
    fallen = []
    for h in (0.2, 0.1):
        energy = run(h, round(2000 / h), save_every=5).energy
        eighths = [part.mean() for part in np.array_split(energy, 8)]
        assert np.all(np.diff(eighths) < 0)
        fallen.append(eighths[0] - eighths[-1])
    assert fallen[1] > 1e-3
    assert 3.0 < fallen[0] / fallen[1] < 5.0  # the next term of the expansion in h is still seen


def rolling_ball() -> tuple[GroupLagrangeDAlembert, dict[str, np.ndarray]]:
    """Return a ball on SO(3) x R^2 that rolls with radius 1, x' = Om x e3, and a start."""
    group, mass, tensor = nh.ProductGroup(nh.SO(3), nh.Translations(2)), 1.5, np.diag([0.2, 0.3, 0.45])
    turning = mass_tensor_lagrangian(nh.SO(3), tensor)

    def action(W, h):  # noqa: ANN001, ANN202
        return turning(W[:3, :3], h) + mass * (W[3:5, 5] @ W[3:5, 5]) / (2 * h)

    def rolling(g):  # noqa: ANN001, ANN202
        return jnp.concatenate([-ROLL @ g[:3, :3], jnp.eye(2)], axis=1)

    g = group.random(np.random.default_rng(1))
    spin = np.array([1.0, -0.4, 0.8])
    start = {"configuration": g, "body_velocity": np.concatenate([spin, ROLL @ g[:3, :3] @ spin])}
    return GroupLagrangeDAlembert(group, action, rolling), start


def turned(speed: float) -> tuple[GroupLagrangeDAlembert, dict[str, np.ndarray]]:
    """Return a body on SO(3) that may not turn about an axis of space, and a start."""
    system = GroupLagrangeDAlembert(nh.SO(3), mass_tensor_lagrangian(nh.SO(3), TENSOR), lambda g: g[2:3])
    g = nh.SO(3).random(np.random.default_rng(3))
    return system, {"configuration": g, "body_velocity": speed * np.cross(g[2], [1.0, 0.3, -0.5])}


RUNS = {
    "SO(3)": lambda: turned(1.0),
    "SO(3), fast": lambda: turned(7.0),
    "SE(2)": lambda: (MIXED, {**START, "body_velocity": admissible(0.9, 1.0)}),
    "SE(3)": lambda: (nh.examples.chaplygin_ball().system, nh.examples.chaplygin_ball()._start),
    "SO(3) x R^2": rolling_ball,
}


@pytest.mark.profile("routes", keep=["SE(2)"])
@pytest.mark.parametrize("name", RUNS)
def test_compiled_runs_are_those_of_jax(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Equations on groups are formulas, too: orbits of 50 steps differ by rounding, and so does what is decoded."""
    system, start = RUNS[name]()
    orbit = nh.simulate(nh.discretize(system, 0.1), **start, steps=50)
    assert _run.programs(system, system.shapes[0], system.group.dim) is not None
    for each in ("programs", "values"):
        monkeypatch.setattr(_run, each, lambda *_, **__: None)
    by_jax = nh.simulate(nh.discretize(system, 0.1), **start, steps=50)
    for name in ("configuration", "displacement", "momentum", "multipliers", "energy"):
        ours, theirs = getattr(orbit, name), getattr(by_jax, name)
        assert np.abs(ours - theirs).max() <= 1e-12 * max(1.0, np.abs(theirs).max()), name
    assert orbit.constraint_residual.max() <= 1e-13 * np.abs(orbit.body_velocity).max()


def height(g):  # noqa: ANN001, ANN201
    """Return the potential of a spring to a place and of a body that is heavy on one side."""
    return 0.4 * (g[0, 2] - 0.3) ** 2 + 0.7 * g[1, 2] + 0.2 * g[0, 0] * g[1, 2]


@pytest.mark.profile("routes", keep=["0.4"])
@pytest.mark.parametrize("step", [0.05, 0.4])
def test_a_free_body_in_a_potential_is_that_of_the_forced_map(step: float) -> None:
    """The trapezoidal rule in the action: half a kick at each node, as `nh.Forced` has it, which differences U."""
    body = nh.LLSystem(PLANE, BODY.homogeneous_mass_tensor, np.eye(3))
    kicked = nh.discretize(nh.Forced(body, lambda g: float(height(g)), scheme="variational"), step)
    ours = nh.discretize(nh.Forced(GroupLagrangeDAlembert(PLANE, ACTION, None), height), step)
    start = {**START, "body_velocity": (0.3, 0.5, -0.2), "steps": 30}
    orbit, reference = nh.simulate(ours, **start), nh.simulate(kicked, **start)
    assert np.abs(orbit.configuration - reference.configuration).max() <= 1e-10
    assert _run.programs(ours.system, (3, 3), 3) is not None  # compiled


def test_a_blade_in_a_potential_keeps_its_energy_and_converges() -> None:
    """The flow keeps T + U; its momenta are ad* p - dU + a, written out by differences; the map has order two."""
    system = nh.Forced(MIXED, height)
    start = {**START, "body_velocity": admissible(0.9, 1.0)}
    exact = nh.flow(system, **start, times=np.linspace(0.0, 2.0, 401))
    assert np.ptp(exact.energy) <= 1e-12
    p, w, g, d, free = exact.momentum, exact.body_velocity, exact.configuration, 1e-5, np.s_[1:-1]
    along = [(height(x @ PLANE.exp(d * e)) - height(x @ PLANE.exp(-d * e))) / (2 * d) for x in g for e in np.eye(3)]
    with jax.enable_x64(True):
        forms = np.stack([np.asarray(blade(jnp.asarray(x)))[0] for x in g])
    rate = (p[2:] - p[:-2]) / (exact.time[2:] - exact.time[:-2])[:, None]
    balance = rate - (PLANE.coad(w, p) - np.reshape(along, p.shape) + exact.multipliers * forms)[free]
    assert np.abs(balance).max() <= 1e-4 * np.abs(p).max()  # of differences with 0.005 between
    errors = [
        np.abs(nh.simulate(nh.discretize(system, 2 / n), **start, steps=n).configuration[-1] - g[-1]).max()
        for n in (50, 100, 200)
    ]
    assert np.abs(np.log2(np.divide(errors[:-1], errors[1:])) - 2).max() <= 0.15


RUB = nh.Friction([0.1, 0.3, 0.2])


def motor(time, g, w, xp=jnp):  # noqa: ANN001, ANN201
    """Return a force of time, pose and velocity."""
    return xp.stack([xp.sin(time) * g[0, 0], -0.2 * w[1] ** 3, 0.3 * xp.cos(2 * time)])


@pytest.mark.profile("routes", keep=["function"])
@pytest.mark.parametrize("kind", ["function", "table"])
def test_a_force_on_a_free_body_is_that_of_the_forced_map(kind: str) -> None:
    """Half the impulse of a step at each of its ends, as in kicks: a table, and one row as a function."""
    rows = np.random.default_rng(4).normal(size=(8 if kind == "table" else 1, 3)) * np.ones((8, 1))
    kicked = nh.Forced(nh.LLSystem(PLANE, BODY.homogeneous_mass_tensor, np.eye(3)), None, rows, "variational")
    force = rows if kind == "table" else lambda _t, _g, _w: jnp.asarray(rows[0])
    ours, start = GroupLagrangeDAlembert(PLANE, ACTION, None, force=force), {**START, "body_velocity": (0.3, 0.5, -0.2)}
    both = (nh.simulate(nh.discretize(each, 0.1), **start, steps=7) for each in (ours, kicked))
    assert_near(*both, 1e-13, "configuration", "momentum", "energy")


@pytest.mark.profile("routes", instead="test_a_force_on_a_free_body_is_that_of_the_forced_map")
def test_forces_are_those_of_the_body_with_the_same_constraint() -> None:
    """Flows under a weight, a spring, U, friction and f are those of `nh.Forced` of a sleigh; the map has order two."""
    sleigh = CASES["sleigh"][0]
    terms = nh.Gravity([0.0, -0.5], [0.2, 0.1]), nh.Spring([0.1, 0.2], [1.0, 1.0], 0.7, 0.3), height
    ours = nh.Forced(rewritten(sleigh), terms, (RUB, motor))
    reference = nh.Forced(sleigh, terms, (RUB, functools.partial(motor, xp=np)))
    start = {**START, "body_velocity": (0.5, 1.0, 0.0)}
    flow, other = (nh.flow(each, **start, times=np.linspace(0.0, 1.0, 51)) for each in (ours, reference))
    assert_near(flow, other, 1e-9, "configuration", "momentum")
    assert np.abs(flow.energy - flow.energy[0] - flow.work).max() <= 1e-3 * np.abs(flow.work).max()  # trapezoidal
    gaps = [
        nh.simulate(nh.discretize(ours, 1 / n), **start, steps=n).configuration[-1] - flow.configuration[-1]
        for n in (20, 40)
    ]
    assert abs(np.log2(np.abs(gaps[0]).max() / np.abs(gaps[1]).max()) - 2) <= 0.15


@pytest.mark.profile("routes", instead="test_the_equations_hold_with_their_sign")
def test_chaplygins_ball_keeps_its_momentum_about_the_contact() -> None:
    """On SO(3) x R^2: with the midpoint rule R I R^T Om + m x e3 x x' in space is constant to rounding."""
    system, start = rolling_ball()
    orbit = nh.simulate(nh.discretize(system, 0.1), **start, steps=2000)
    angular = np.einsum("kij,kj->ki", orbit.configuration[:, :3, :3], orbit.momentum[:, :3])
    total = angular[:, :2] + orbit.momentum[:, 3:] @ ROLL[:, :2]
    assert np.abs(np.diff(orbit.momentum[:, 3:], axis=0)).max() > 1e-3
    assert np.abs(total - total[0]).max() <= 1e-11
    assert np.abs(angular[:, 2] - angular[0, 2]).max() <= 1e-11
    assert 1e-5 < np.ptp(orbit.energy) < 1e-2  # not constant; no trend is seen in 2000 steps
    assert abs(orbit.energy[:1000].mean() - orbit.energy[1000:].mean()) < 0.05 * np.ptp(orbit.energy)


def test_a_step_beyond_the_fold_has_no_branch() -> None:
    """The matrix difference reaches spins up to about 1/h: a faster start has no displacement."""
    with pytest.raises(nh.OutcomeError, match=r"Start of the run.*no_real_branch"):
        run(0.2, 3, body_velocity=admissible(40.0, 1.0))


def sleigh(a) -> nh.ChaplyginSleigh:  # noqa: ANN001
    """Return a sleigh whose center of mass is somewhere."""
    return nh.ChaplyginSleigh(mass=1.3, inertia=0.7, a=a, b=0.2)


LINE = np.asarray(sleigh(0.5).annihilator)
OF_NUMBERS = GroupLagrangeDAlembert(
    PLANE,
    lambda W, h, p: mass_tensor_lagrangian(PLANE, sleigh(p["a"]).homogeneous_mass_tensor)(W, h),
    lambda _g, _p: jnp.asarray(LINE),
    lambda _g, W, _h, _p: jnp.asarray(LINE) @ PLANE.vee((W - PLANE.inverse(W)) / 2),
    parameters={"a": 0.5},
)
PUSHES = np.random.default_rng(4).normal(size=(6, 3))


def test_a_table_may_come_beside_a_force() -> None:
    """Controls of a system with a force of its own act as those given with it."""
    assert nh.Forced(nh.Forced(MIXED, None, motor), None, PUSHES) == nh.Forced(MIXED, None, (motor, PUSHES))
    assert nh.Forced(MIXED, None, (motor, PUSHES)) != nh.Forced(MIXED, None, (motor, 2 * PUSHES))


def end_of(system, pose, velocity, pushes):  # noqa: ANN001, ANN201
    """Return where a rollout ends."""
    start = {"configuration": pose, "body_velocity": velocity}
    return nh.rollout(nh.discretize(system, 0.2), **start, controls=pushes, steps=6).configuration[-1]


@pytest.mark.profile("routes", instead="test_parameters_are_numbers_of_one_system")
@pytest.mark.parametrize("derive", [jax.jacfwd, jax.jacrev])
def test_derivatives_of_rollouts_are_those_of_the_ll_map(derive) -> None:  # noqa: ANN001
    """By a number of the body, the start and controls: the definition of left-invariant maps is other code."""
    start = (0.5, np.array([1.0, -1.0, 0.0]), PUSHES)
    pose = START["configuration"]
    with jax.enable_x64(True):
        ours = derive(lambda a, *rest: end_of(OF_NUMBERS.with_parameters(a=a), pose, *rest), (0, 1, 2))(*start)
        reference = jax.jacfwd(lambda a, *rest: end_of(sleigh(a), pose, *rest), (0, 1, 2))(*start)
    for one, other in zip(ours, reference, strict=True):
        np.testing.assert_allclose(one, other, 0, 1e-11 * np.abs(other).max())


def test_parameters_are_numbers_of_one_system() -> None:
    """The system of other numbers has the code of the first, and functions with these numbers within."""
    system, W = OF_NUMBERS.with_parameters(a=0.1), PLANE.exp(np.array([0.1, 0.2, -0.3]))
    assert (system.family, dict(system.parameters)) == (OF_NUMBERS.family, {"a": 0.1})
    with jax.enable_x64(True):
        value = float(system.plain.discrete_lagrangian(np.eye(3), W, 0.2))
    assert abs(value - mass_tensor_lagrangian(PLANE, sleigh(0.1).homogeneous_mass_tensor)(W, 0.2)) <= 1e-14


@pytest.mark.profile("routes", instead="test_parameters_are_numbers_of_one_system")
def test_motions_with_parameters_are_those_with_numbers_within() -> None:
    """Maps, and flows under a potential, whose inertia is derived from the discrete Lagrangian."""
    system, own = OF_NUMBERS.with_parameters(a=0.1), rewritten(sleigh(0.1))
    start = {**START, "body_velocity": (1.0, -1.0, 0.0)}
    ours, reference = (nh.simulate(nh.discretize(each, 0.2), **start, steps=10) for each in (system, own))
    assert_near(ours, reference, 1e-13, "momentum", "configuration", "energy", "multipliers")
    ours, reference = (nh.flow(nh.Forced(each, height), **start, times=[0.0, 1.0]) for each in (system, own))
    assert_near(ours, reference, 1e-12, "momentum", "configuration", "energy")


def rotation_only(W, h):  # noqa: ANN001, ANN201
    """Return the discrete Lagrangian of a body without mass."""
    return ((W[0, 0] - 1) ** 2 + W[1, 0] ** 2) / (2 * h)


def branching(W, h):  # noqa: ANN001, ANN201
    """Return a scalar by a Python branch that JAX cannot trace."""
    return h if W[0, 0] > 0 else -h


# Each error names the argument and the requirement.
test_bad_definitions_are_refused = refusals(
    (lambda: GroupLagrangeDAlembert("SE(2)", ACTION, blade), "matrix group"),
    (lambda: GroupLagrangeDAlembert(PLANE, lambda W, h: W[0] / h, blade), "discrete_lagrangian.* scalar"),
    (lambda: GroupLagrangeDAlembert(PLANE, branching, blade), "discrete_lagrangian.*traceable"),
    (lambda: GroupLagrangeDAlembert(PLANE, ACTION, lambda g: g[0]), "constraint_forms.*shape"),
    (lambda: GroupLagrangeDAlembert(PLANE, ACTION, lambda g: g), "0 < s < 3"),
    (lambda: GroupLagrangeDAlembert(PLANE, ACTION, blade, lambda g, W, h: g[0] * W[0] * h), "constraints.*shape"),
    (lambda: GroupLagrangeDAlembert(PLANE, ACTION, 3.0), "constraint_forms.*function"),
    (lambda: mass_tensor_lagrangian("SE(2)", np.eye(3)), r"\(group=\.\.\.\)` must be a matrix group"),
    (lambda: mass_tensor_lagrangian(PLANE, np.eye(2)), r"\(mass_tensor=\.\.\.\)` must have shape \(3, 3\)"),
    (lambda: mass_tensor_lagrangian(nh.Translations(2), np.eye(3)), "SO"),
    (lambda: nh.Forced(MIXED, force=lambda _t, _g, w: w[:2]), r"force=\.\.\..* shape \(3,\)"),
    (lambda: nh.Forced(MIXED, force=np.zeros((4, 2))), "have shape .*3"),
    (lambda: nh.Forced(nh.Forced(MIXED, None, RUB), None, RUB), "have no force yet"),
    (lambda: nh.Forced(MIXED, nh.Gravity(np.ones(3), np.ones(3))), "have points of SE"),
    (lambda: nh.Forced(MIXED, 3.0), "be a potential"),
    (lambda: nh.Forced(MIXED, lambda g: g[0]), r"potential=\.\.\..* scalar"),
    (lambda: GroupLagrangeDAlembert(PLANE, ACTION, blade, parameters={"a": 1.0}), "take the parameters of the system"),
    (lambda: GroupLagrangeDAlembert(PLANE, ACTION, blade, parameters=3), "be a mapping of names"),
    (lambda: MIXED.with_parameters(a=1.0), "It has none"),
    (lambda: OF_NUMBERS.with_parameters(b=1.0), "It has a"),
)


# Each error says what was got and what would do.
test_bad_starts_are_refused = refusals(
    ({"body_velocity": (1.0, 1.0, 1.0)}, r"satisfy the constraint.*nearest admissible velocity is \["),
    ({"body_velocity": (1.0, np.nan, 0.0)}, "finite"),
    ({"configuration": np.diag([1.0, 2.0, 1.0])}, "lie in SE"),
    ({"displacement": PLANE.exp(np.array([0.1, 0.0, 0.1]))}, "satisfy the discrete constraint"),
    ({"steps": 0}, "positive integer"),
    ({"body_velocity": None}, "exactly one of body_velocity, displacement, momentum"),
    ask=lambda changes: run(0.1, **({"steps": 3} | changes)),
)


def twice(g):  # noqa: ANN001, ANN201
    """Return the same form twice."""
    return jnp.concatenate([blade(g), -2 * blade(g)])


# What only numbers can show is checked at the first pose, before any work.
test_bad_systems_are_refused_at_the_start = refusals(
    ((ACTION, twice), "independent rows.*rank 1 of 2"),
    ((ACTION, lambda g: blade(g) / (g[0, 2] - g[0, 2])), "constraint_forms.*finite"),
    ((lambda W, h: ACTION(W, h) / h, blade), "tend to time_step times the Lagrangian"),
    ((rotation_only, blade), "determine the accelerations"),
    ((ACTION, blade, lambda _g, W, _h: W[1:2, 2]), "span the constraint forms"),
    ((ACTION, blade, lambda *_: jnp.ones(1)), "vanish at W = I"),
    ask=lambda arguments: nh.simulate(
        nh.discretize(GroupLagrangeDAlembert(PLANE, *arguments), 0.1),
        **START, body_velocity=admissible(0.9, 1.0), steps=3,
    ),
)  # fmt: skip


def test_orbits_on_groups_have_tables_files_and_pictures(tmp_path) -> None:  # noqa: ANN001
    """Poses are columns x, y, heading; the dataset, the CSV and the path in the picture hold them, too."""
    orbit = run(0.1, 10)
    table, dataset = orbit.to_pandas(), orbit.to_dataset()
    assert all(np.array_equal(dataset[name], table[name]) for name in ("x", "y", "heading"))
    assert np.array_equal(table[["x", "y"]].to_numpy(), orbit.configuration[:, :2, 2])
    assert np.array_equal(table[[f"momentum_{i}" for i in range(3)]].to_numpy(), orbit.momentum)
    orbit.to_csv(tmp_path / "poses.csv")
    rows = np.loadtxt(tmp_path / "poses.csv", delimiter=",", skiprows=1)
    assert np.array_equal(rows, np.column_stack([orbit.time, table[["x", "y", "heading"]].to_numpy()]))
    assert nh.invariants(orbit).group_residual <= 1e-15
    panels = orbit.plot().axes
    assert np.array_equal(np.ma.getdata(panels[0].collections[0].get_offsets()), orbit.configuration[:, :2, 2])
    titles = ["Reference point", "Body velocity", "Energy error", "Residual of the constraint"]
    assert [axes.get_title(loc="left") for axes in panels] == titles


@functools.cache
def flow() -> GroupOrbit:
    """Return the continuous motion of the mixed system at times 0, 1, 2."""
    return nh.flow(MIXED, **START, body_velocity=admissible(0.9, 1.0), times=[0.0, 1.0, 2.0], rtol=1e-13, atol=1e-14)


def rates(_: float, z: np.ndarray) -> np.ndarray:
    """Return the rates of (theta, x, y, omega, v1, v2), written out by hand."""
    theta, x, y, omega, v1, v2 = z
    inertia, p = BODY.inertia_operator, BODY.inertia_operator @ z[3:]
    torque = np.array([p[1] * v2 - p[2] * v1, omega * p[2], -omega * p[1]])
    dx, dy = np.cos(theta) * v1 - np.sin(theta) * v2, np.sin(theta) * v1 + np.cos(theta) * v2
    angle, turning = 0.7 * np.sin(x) + 0.4 * np.cos(1.3 * y), 0.7 * np.cos(x) * dx - 0.52 * np.sin(1.3 * y) * dy
    a, da = np.array([0, -np.sin(angle), np.cos(angle)]), -turning * np.array([0, np.cos(angle), np.sin(angle)])
    matrix = np.block([[inertia, -a[:, None]], [a[None], np.zeros((1, 1))]])
    solution = np.linalg.solve(matrix, np.append(torque, -da @ z[3:]))
    return np.concatenate([[omega, dx, dy], solution[:3]])


@pytest.mark.profile("routes", instead="test_the_flow_is_the_published_solution")
def test_the_flow_solves_the_equations() -> None:
    """Pose and velocity agree with an independent integration of hand-written equations."""
    x, y = START["configuration"][:2, 2]
    first = np.concatenate([[0.4, x, y], admissible(0.9, 1.0)])
    z = solve_ivp(rates, (0, 2), first, method="DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
    assert np.abs(flow().configuration[-1, :2, 2] - z[1:3]).max() <= 1e-11
    assert np.abs(flow().body_velocity[-1] - z[3:]).max() <= 1e-11
    assert np.ptp(flow().energy) <= 1e-12


@pytest.mark.profile("routes", instead="test_the_map_satisfies_its_constraint_and_has_order_two")
def test_a_mixed_system_converges_with_order_two() -> None:
    """Poses, momenta along the constraint and impulse / h, with its sign, tend to the flow; slope 2.0 +- 0.1."""
    rows, exact = [], flow()
    along = np.linalg.svd(np.asarray(blade(jnp.asarray(exact.configuration[-1]))))[2][1:]  # rows span the kernel of a
    for n in (50, 100, 200, 400):
        orbit = run(2 / n, n)
        pose = np.abs(orbit.configuration[-1] - exact.configuration[-1]).max()
        momentum = np.abs(along @ (orbit.momentum[-1] - exact.momentum[-1])).max()
        rows.append((pose, momentum, abs(orbit.multipliers[n // 2 - 1, 0] * n / 2 - exact.multipliers[1, 0])))
    for column in np.transpose(rows):
        assert abs(-np.polyfit(np.log([50, 100, 200, 400]), np.log(column), 1)[0] - 2.0) <= 0.1
