"""Orbits as JAX functions: values of `simulate`, derivatives against 40 digits and differences, folds, checkpoints."""

import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from comparisons import assert_near
from problems import EVERY
from references import golden, numbers
from refusals import refusals

import nonholo as nh
from nonholo.discrete.definition import Rollout
from nonholo.systems import AbstractSystem

TOP = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
FIELDS = ("time", "restricted_momentum", "momentum", "displacement", "configuration", "energy")
HEAVY, RUB = nh.Gravity([0.2, -0.3, -1.0], [0.1, 0.2, 0.3]), nh.Friction(np.eye(3) / 5 + 0.1)
TABLE = np.outer(np.sin(np.arange(50.0)), [0.4, -0.3, 0.2])
CASES = {case["name"]: case for case in golden("derivatives.json")}
MIXED = [[1.0, 0.0, 1.0, 0.75, -0.5, 0.75], [0.0, 1.0, 0.0, 0.5, 0.25, -1.0], [1.0, 1.0, 0.0, 1.0, 0.5, -0.75]]


def _symmetric(triangle: jax.Array, size: int) -> jax.Array:
    tensor = jnp.zeros((size, size)).at[np.triu_indices(size)].set(triangle)
    return tensor + jnp.triu(tensor, 1).T


BODIES: dict[str, Callable[[jax.Array], AbstractSystem]] = {
    "top": lambda x: nh.SuslovTop(_symmetric(x, 3)),
    "tilted top": lambda x: nh.SuslovTop(_symmetric(x, 3), axis=(0.6, 0.0, 0.8)),
    "four": lambda x: nh.SuslovTop(_symmetric(x, 4)),
    "mixed": lambda x: nh.LLSystem(nh.SE(3), _symmetric(x, 4), constraint_subspace=MIXED),
    **dict.fromkeys(("sleigh", "driven sleigh", "heavy sleigh"), lambda x: nh.ChaplyginSleigh(*x)),
}


def _end(name: str, x: jax.Array) -> jax.Array:
    """Return the end of an orbit of a golden case, from all of its numbers."""
    case = CASES[name]
    k, cut = len(case["velocity"]), len(case["body"])
    system, many = BODIES[name](x[:cut]), np.size(case["controls"])
    controls = x[cut + 1 + k :][:many].reshape(case["steps"], -1) if many else None
    if "friction" in case:
        friction, force, point = jnp.split(x[cut + 1 + k + many :], [3, 5])
        system = nh.Forced(system, nh.Gravity(force, point), nh.Friction(friction), "variational")
    discrete = nh.discretize(system, x[cut])
    orbit = nh.rollout(discrete, restricted_velocity=x[cut + 1 : cut + 1 + k], controls=controls, steps=case["steps"])
    return jnp.concatenate([orbit.restricted_momentum[-1], orbit.configuration[-1].ravel()])


@functools.cache
def _derivatives(name: str) -> Callable[[np.ndarray], tuple[jax.Array, jax.Array]]:
    """Return a compiled function of the numbers: the end and its derivative, a row for each number."""

    def both(x: jax.Array) -> tuple[jax.Array, jax.Array]:
        end, push = jax.linearize(functools.partial(_end, name), x)
        return end, jax.vmap(push)(jnp.eye(len(x)))

    return jax.jit(both)


def _point(name: str) -> np.ndarray:
    case = CASES[name]
    parts = [case["body"], [case["time_step"]], case["velocity"], *case["controls"]]
    return np.concatenate([*parts, case.get("friction", []), case.get("weight", [])])


@pytest.mark.profile("routes", keep=["heavy*"])
@pytest.mark.parametrize("state", ["moving", "at rest"])
@pytest.mark.parametrize("name", BODIES)
def test_derivatives_agree_with_40_digits(name: str, state: str) -> None:
    """Every number of body, time step, start, controls and forces moves the end as differences in 60 digits say."""
    case = CASES[name if state == "moving" else f"{name} at rest"]
    with jax.enable_x64(True):
        end, derivative = _derivatives(name)(_point(case["name"]))
    np.testing.assert_allclose(end, numbers(case["end"]), rtol=0, atol=1e-13)
    np.testing.assert_allclose(derivative, numbers(case["derivative"]), rtol=1e-9, atol=1e-11)


@pytest.mark.profile("routes", instead="test_derivatives_agree_with_40_digits")
def test_reverse_mode_agrees_with_forward_mode() -> None:
    """The transposed derivative of the heavy sleigh is that of forward mode, at rest too."""
    with jax.enable_x64(True):
        _, derivative = _derivatives("heavy sleigh")(_point("heavy sleigh at rest"))
        weights = jnp.linspace(1.0, 2.0, derivative.shape[1])
        pull = jax.jit(jax.grad(lambda x: _end("heavy sleigh", x) @ weights))
        np.testing.assert_allclose(pull(_point("heavy sleigh at rest")), derivative @ weights, rtol=1e-12, atol=1e-12)


_OTHERS = ("tilted top", "offset sleigh", "suslov 4", "sleigh 3", "free on SO(4)", "veselova 3")
_OTHERS += ("right-invariant on SE(2)", "any d on SE(3)", "Heisenberg", "product")
CASES_OF_VALUES: dict[str, tuple[AbstractSystem, dict[str, Any]]] = {
    "top": (TOP, {}),
    **{name: (EVERY[name], {}) for name in _OTHERS},
    "arrowhead": (nh.SuslovTop.arrowhead([1.0, 2.0, 1.5, 1.0], [0.3, 0.2, 0.1]), {}),
    **{f"order {order}": (TOP, {"order": order}) for order in (4, 6, 8)},
    "logarithmic": (TOP, {"difference": "logarithmic"}),
    "heavy, with friction": (nh.Forced(TOP, HEAVY, RUB), {}),
    "heavy, with friction and a table": (nh.Forced(TOP, HEAVY, (RUB, TABLE)), {}),
    "driven": (nh.Forced(EVERY["offset sleigh"], force=TABLE), {}),
    "forces, fixed in space": (nh.Forced(EVERY["veselova 3"], HEAVY, RUB), {}),
}
SYSTEMS = pytest.mark.parametrize(("system", "options"), CASES_OF_VALUES.values(), ids=CASES_OF_VALUES)


@pytest.mark.profile("routes", keep=["top"])
@SYSTEMS
def test_values_are_those_of_simulate(system: AbstractSystem, options: dict, caplog: pytest.LogCaptureFixture) -> None:
    """Eager rollouts are NumPy arrays that agree with the compiled orbit to rounding, state by state, at any length."""
    discrete = nh.discretize(system, 0.1, **options)
    pose = system.group.exp(np.linspace(0.1, 0.5, system.group.dim))
    start = {"restricted_velocity": np.linspace(0.4, 0.6, system.rank), "configuration": pose}
    result = nh.rollout(discrete, **start, steps=50)
    with jax.log_compiles(), caplog.at_level("WARNING"):
        shorter = nh.rollout(discrete, **start, steps=30)
    assert "roll_out" not in caplog.text  # a program serves all up to 63 steps
    assert all(map(np.array_equal, shorter[:-2], (x[:31] for x in result[:-2])))
    assert all(type(x) is np.ndarray and x.dtype == np.float64 for x in result[:-1])
    assert result.outcome == 0
    assert_near(result, nh.simulate(discrete, **start, steps=50), 1e-13, *FIELDS)


def _symmetrized(x: np.ndarray) -> np.ndarray:
    return (x + x.T) / 2 if x.ndim == 2 and len(x) == len(x.T) else x


@pytest.mark.profile("routes", instead="test_derivatives_agree_with_40_digits")
@SYSTEMS
def test_gradients_of_every_system_are_differences(system: AbstractSystem, options: dict) -> None:
    """By all numbers of body, forces, time step and start at once the gradient is a difference of `simulate`."""
    rng = np.random.default_rng(0)
    point = (nh.discretize(system, 0.1, **options), np.linspace(0.4, 0.6, system.rank))
    pose = system.group.exp(np.linspace(0.1, 0.5, system.group.dim))
    weights, on_pose = rng.normal(size=system.rank), rng.normal(size=pose.size)
    steps = 130 if system is TOP and not options else 50  # of 130 steps stretches are computed once more

    def end(run: Callable, discrete: nh.Discretization, velocity: Any) -> Any:
        how = {"steps": steps, "save_every": steps}
        orbit = run(discrete, restricted_velocity=velocity, configuration=pose, **how)
        return orbit.restricted_momentum[-1] @ weights + orbit.configuration[-1].ravel() @ on_pose

    def moved(size: float) -> float:
        return end(nh.simulate, *jax.tree.map(lambda x, way: np.asarray(x + size * way)[()], point, way))

    with jax.enable_x64(True):
        gradient = jax.jit(jax.grad(functools.partial(end, nh.rollout), argnums=(0, 1)))(*point)
    for _ in range(5):
        way = jax.tree.map(lambda x: _symmetrized(rng.normal(size=np.shape(x))), point)
        slope = sum(np.sum(x * np.asarray(y)) for x, y in zip(*map(jax.tree.leaves, (way, gradient)), strict=True))
        difference = (8 * (moved(2e-4) - moved(-2e-4)) - moved(4e-4) + moved(-4e-4)) / 24e-4
        np.testing.assert_allclose(slope, difference, rtol=1e-7, atol=1e-9)


def test_momentum_off_the_locus_is_an_outcome() -> None:
    """A full momentum that no displacement has gives NaN and says why."""
    result = nh.rollout(nh.discretize(TOP, 0.1), momentum=(0.4, 0.9, 2.0), steps=5)
    assert result.outcome == nh.Outcome.off_momentum_locus
    assert np.isnan(result.momentum).all()


SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.5, 0.7, 0.4, 0.2), 0.3)


def _kicked(controls: np.ndarray, velocity: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Return momenta and poses by single steps of `simulate`, with half of each impulse before and after."""
    S = SLEIGH.system.constraint_subspace
    r, g = [SLEIGH.system.restricted_momentum(np.array(velocity))], [np.eye(3)]
    for row in controls:
        kick = S @ row * SLEIGH.time_step / 2
        step = nh.simulate(SLEIGH, momentum=r[-1] + kick, configuration=g[-1], steps=1)
        r.append(step.restricted_momentum[1] + kick)
        g.append(step.configuration[1])
    return np.array(r), np.array(g)


def test_controls_act_half_at_each_end_of_a_step() -> None:
    """Momenta of nodes and poses are those of single steps between half impulses; none acts after the last row."""
    controls = np.random.default_rng(0).normal(size=(6, 3))
    result = nh.rollout(SLEIGH, restricted_velocity=(0.8, -0.5), controls=controls, steps=6)
    r, g = _kicked(controls, (0.8, -0.5))
    np.testing.assert_allclose(result.restricted_momentum, r, rtol=0, atol=1e-14)
    np.testing.assert_allclose(result.configuration, g, rtol=0, atol=1e-14)
    last = nh.simulate(SLEIGH, momentum=r[-1], steps=1)
    np.testing.assert_allclose(result.displacement[-1], last.displacement[0], rtol=0, atol=1e-14)
    np.testing.assert_allclose(result.momentum @ SLEIGH.system.constraint_subspace.T, r, rtol=0, atol=1e-13)


@pytest.mark.profile("routes", instead="test_derivatives_agree_with_40_digits")
def test_map_over_members_is_a_loop_and_compiled_is_not_compiled() -> None:
    """`vmap` of 3 members in `jit` equals 3 eager calls and `simulate`, where stretches have a remainder too."""
    members = np.array([[0.5, 1.0, 0.0], [0.0, 0.0, 0.0], [-0.7, 0.3, 0.0]])
    sizes = {"steps": 150, "save_every": 70}

    def poses(velocity: jax.Array) -> jax.Array:
        return nh.rollout(SLEIGH, body_velocity=velocity, **sizes).configuration

    with jax.enable_x64(True):
        mapped = jax.jit(jax.vmap(poses))(members)
    for result, member in zip(mapped, members, strict=True):
        np.testing.assert_allclose(result, poses(member), rtol=0, atol=1e-12)
        orbit = nh.simulate(SLEIGH, body_velocity=member, **sizes)
        np.testing.assert_allclose(result, orbit.configuration, rtol=0, atol=1e-12)


@pytest.mark.profile("routes", instead="test_derivatives_agree_with_40_digits")
def test_second_derivatives() -> None:
    """The Hessian matrix of a short orbit is the difference of gradients, at rest too."""

    def place(velocity: jax.Array) -> jax.Array:
        return jnp.sum(nh.rollout(SLEIGH, restricted_velocity=velocity, steps=3).configuration[-1, :2, 2] ** 2)

    with jax.enable_x64(True):
        gradient, hessian = jax.jit(jax.grad(place)), jax.jit(jax.hessian(place))
        for point in (np.array([0.8, -0.5]), np.zeros(2)):
            there, back = (np.array([gradient(point + s * 1e-4 * unit) for unit in np.eye(2)]) for s in (1.0, -1.0))
            np.testing.assert_allclose(hessian(point), (there - back) / 2e-4, rtol=1e-6, atol=1e-7)


@pytest.mark.profile("routes", instead="test_derivatives_agree_with_40_digits")
@pytest.mark.parametrize("forces", [(), (nh.Gravity([0.4, -1.0], [0.5, 0.3]), nh.Friction([0.3, 0.2, 0.1]))])
def test_third_derivatives(forces: tuple) -> None:
    """The third derivative is the difference of second ones, free and where forces act at the displacement."""
    discrete = nh.discretize(nh.Forced(SLEIGH.system, *forces), 0.3) if forces else SLEIGH

    def place(x: jax.Array) -> jax.Array:
        velocity = jnp.stack([0.8 + x, -0.5 + 2 * x])
        return nh.rollout(discrete, restricted_velocity=velocity, steps=1).configuration[-1, 0, 2]

    with jax.enable_x64(True):
        second = jax.jit(jax.jacfwd(jax.grad(place)))
        third = jax.jit(jax.jacfwd(jax.jacfwd(jax.grad(place))))(0.0)
        np.testing.assert_allclose(third, (second(1e-4) - second(-1e-4)) / 2e-4, rtol=1e-6)


@pytest.mark.profile("routes", keep=["variational"])
@pytest.mark.parametrize("scheme", ["energy", "variational"])
def test_a_spring_without_length_pulls_smoothly_at_its_end(scheme: str) -> None:
    """A sleigh that leaves the place where it is held swings by the linear map of the scheme, and so from rest."""
    spring, h, steps = nh.Spring([0.0, 0.0], [0.0, 0.0], 2.0), 0.1, 5
    content = nh.discretize(nh.Forced(nh.ChaplyginSleigh(1.0, 1.0, 0.2), spring, scheme=scheme), h)
    rate = np.sqrt(2.0)
    angle = 2 * np.arctan(h * rate / 2) if scheme == "energy" else 2 * np.arcsin(h * rate / 2)
    expected = np.sin(steps * angle) * (1 / rate if scheme == "energy" else h / np.sin(angle))

    def end(speed: jax.Array) -> jax.Array:
        orbit = nh.rollout(content, restricted_velocity=jnp.stack([0.0, speed]), steps=steps)
        return orbit.configuration[-1, 0, 2] + orbit.energy[0] - speed**2 / 2

    with jax.enable_x64(True):
        run = jax.jit(lambda speed: (end(speed), jax.grad(end)(speed), jax.jacfwd(jax.grad(end))(speed)))
        for speed in (0.0, 0.3):
            np.testing.assert_allclose(run(speed), (expected * speed, expected, 0.0), rtol=0, atol=1e-14)


PUSHED = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.2), 1.0)


@pytest.mark.profile("routes", instead="test_values_are_those_of_simulate")
def test_what_fails_after_the_last_step_is_no_outcome() -> None:
    """A table that pushes beyond the fold from node 2 on ends an orbit of three steps, not one of a single step."""
    table = np.array([[0.0, -0.2, 0.0], [0.0, 0.0, 0.0], [10.0, 0.0, 0.0]])
    pushed = nh.discretize(nh.Forced(PUSHED.system, force=table), 1.0)
    one, three = (nh.rollout(pushed, restricted_velocity=(0.2, -0.1), steps=steps) for steps in (1, 3))
    assert one.outcome == 0
    assert three.outcome != 0
    assert np.array_equal(one.momentum, three.momentum[:2])


@pytest.mark.profile("routes", instead="test_derivatives_agree_with_40_digits")
def test_fold_is_an_outcome_with_derivative_nan_and_states_before_keep_theirs() -> None:
    """A push beyond the fold ends the orbit at node 2; what comes from there on is NaN, with its derivatives alone."""

    def states(push: jax.Array) -> Rollout:
        controls = jnp.zeros((4, 3)).at[2, 0].set(push).at[0, 1].set(-0.02 * push)
        return nh.rollout(PUSHED, restricted_velocity=(0.2, -0.1), controls=controls, steps=4)

    def sums(push: jax.Array) -> jax.Array:
        return states(push).restricted_momentum.sum(axis=1)

    with jax.enable_x64(True):
        run, slopes = jax.jit(states)(10.0), jax.jit(jax.jacrev(sums))(10.0)
        forward = jax.jit(jax.jacfwd(sums))(10.0)
    assert int(run.outcome) == nh.Outcome.no_real_branch
    assert np.isfinite(run.momentum[:2]).all()
    assert np.isnan(run.momentum[2:]).all()
    for result in map(np.asarray, (slopes, forward)):
        assert result[0] == 0.0
        assert result[1] != 0.0
        assert np.isfinite(result[1])
        assert np.isnan(result[2:]).all()


@pytest.mark.profile("routes", instead="test_derivatives_agree_with_40_digits")
def test_near_half_a_turn_the_derivative_is_finite() -> None:
    """A step of 174 degrees turns with its momentum as the cubic of the sleigh says, differentiated by hand."""
    fast = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 3.0), 1.0)
    hat, t = 20.0, 20.0  # a (p_1 + 2 m a) and tan of half the angle
    spin = (hat * t**3 + (2 + hat) * t) / (1 + t * t)
    slope = (1 + t * t) / (3 * hat * t * t - 2 * spin * t + 2 + hat)

    def cosine(spin: jax.Array) -> jax.Array:
        return nh.rollout(fast, momentum=jnp.stack([spin, hat / 3 - 6 + 0 * spin]), steps=1).displacement[0, 0, 0]

    with jax.enable_x64(True):
        value, result = jax.jit(jax.value_and_grad(cosine))(spin)
    np.testing.assert_allclose(value, (1 - t * t) / (1 + t * t), rtol=1e-12)
    np.testing.assert_allclose(result, -4 * t * slope / (1 + t * t) ** 2, rtol=1e-9)


# An argument that does not fit is named before any work.
test_bad_arguments_are_refused = refusals(
    ({"steps": 0}, "rollout.steps=....` must be a positive integer"),
    ({"body_velocity": (1.0, 0.0, 0.0)}, "exactly one of"),
    ({"controls": np.zeros((2, 3))}, "must have shape .3, 3."),
    ({"restricted_velocity": (np.nan, 0.0)}, "be finite"),
    ({"configuration": 2 * np.eye(3)}, "lie in SE"),
    ({"discrete": TOP}, "discretized system"),
    ({"discrete": nh.discretize(nh.Forced(TOP, force=np.zeros((2, 3))), 0.1)}, "one for each row of the forces"),
    ({"discrete": nh.discretize(nh.Forced(TOP, np.trace), 0.1)}, "be traceable by JAX on poses"),
    ({"discrete": nh.discretize(TOP, 0.1, order=4), "controls": np.zeros((3, 3))}, "have a step of order 2"),
    ask=lambda change: nh.rollout(**{"discrete": SLEIGH, "restricted_velocity": (0.1, 0.2), "steps": 3} | change),
)


def test_traced_single_precision_is_refused() -> None:
    """Tracing in 32 bits says how to trace in 64."""
    with pytest.raises(TypeError, match="enable_x64"):
        jax.jit(lambda v: nh.rollout(SLEIGH, body_velocity=v, steps=2).momentum)(np.zeros(3, np.float32))


@pytest.mark.profile("routes", instead="test_tangent_maps_are_differences_of_flows")
@pytest.mark.parametrize("reverse", [False, True], ids=["forward", "reverse"])
def test_flows_are_differentiated_by_diffrax(reverse: bool) -> None:
    """Through the vector field of a traced body, derivatives by body and start are differences of the flow."""
    diffrax = pytest.importorskip("diffrax")
    adjoint = diffrax.RecursiveCheckpointAdjoint() if reverse else diffrax.ForwardMode()

    def traced(tensor: Any, velocity: Any) -> Any:
        top = nh.SuslovTop(tensor)
        field = nh.vector_field(top)
        start = jnp.concatenate([top.restricted_momentum(velocity), jnp.eye(3).ravel()])
        control, term = diffrax.PIDController(rtol=1e-11, atol=1e-13), diffrax.ODETerm(lambda t, y, _: field(t, y))
        options = {"stepsize_controller": control, "adjoint": adjoint}
        return diffrax.diffeqsolve(term, diffrax.Dopri5(), 0.0, 3.0, None, start, **options).ys[-1]

    def flowed(size: float) -> np.ndarray:
        body = nh.SuslovTop(TOP.mass_tensor + size * along_tensor)
        end = nh.flow(body, restricted_velocity=velocity + size * along_velocity, times=(0.0, 3.0))
        return np.concatenate([end.restricted_momentum[-1], end.configuration[-1].ravel()])

    along_tensor = np.array([[0.3, -0.2, 0.5], [-0.2, 0.4, 0.1], [0.5, 0.1, -0.6]])
    velocity, along_velocity = np.array([0.4, 0.7]), np.array([0.8, -0.5])
    with jax.enable_x64(True):
        by_both = (jax.jacrev if reverse else jax.jacfwd)(traced, (0, 1))
        by_tensor, by_velocity = map(np.asarray, jax.jit(by_both)(TOP.mass_tensor, velocity))
    slope = np.tensordot(by_tensor, along_tensor, 2) + by_velocity @ along_velocity
    difference = (8 * (flowed(1e-3) - flowed(-1e-3)) - flowed(2e-3) + flowed(-2e-3)) / 12e-3
    np.testing.assert_allclose(slope, difference, rtol=0, atol=1e-8)


def test_rollouts_print_as_tables() -> None:
    """On a group and in coordinates, alone and of many, a line for each field has a few numbers or a shape."""
    sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
    point = nh.discretize(nh.LagrangeDAlembert(lambda q, v: (v @ v - q @ q) / 2, None, dimension=1), 0.1)
    alone = nh.rollout(point, configuration=[1.0], body_velocity=[0.0], steps=50)
    with jax.enable_x64(True):
        many = jax.vmap(lambda v: nh.rollout(sleigh, restricted_velocity=v, steps=50))(jnp.eye(2))
    for orbit, shape, outcome in ((alone, "(51, 1)", "0"), (many, "(2, 51, 3, 3)", "[0 0]")):
        name, *lines = repr(orbit).split("\n")
        assert (name, len(lines)) == (type(orbit).__name__, len(orbit))
        assert f"configuration: shape {shape}" in repr(orbit)
        assert lines[-1].strip() == f"outcome: {outcome}"
