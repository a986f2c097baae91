"""The tangent map along orbits against differences of orbits, exponents, and the Lyapunov function on SO(n), SE(n)."""

import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from bodies import mass_tensor
from comparisons import derivatives

import nonholo as nh
from nonholo.systems import AbstractLLSystem, AbstractSystem

MIXED = [[1.0, 0, 1, 0.75, -0.5, 0.75], [0, 1.0, 0, 0.5, 0.25, -1], [1, 1, 0, 1, 0.5, -0.75]]
BODIES = {
    "tilted top": nh.SuslovTop.from_inertia(np.diag([3.0, 2.0, 2.5]) + 0.1, (0.6, 0.0, 0.8)),
    "offset sleigh": nh.ChaplyginSleigh(2.0, 1.0, 0.5, 0.3),
    "four": nh.SuslovTop(np.diag([1.0, 2.0, 1.5, 1.0]) + 0.1),
    "mixed": nh.LLSystem(nh.SE(3), np.diag([1.0, 2.0, 1.5, 1.0]) + 0.1, constraint_subspace=MIXED),
    "free": nh.RigidBody(np.diag([1.0, 2.0, 3.0])),
}


TOP = nh.SuslovTop(np.diag([1.0, 2.0, 1.5]) + 0.1)
POSED = {
    "under gravity": nh.Forced(TOP, nh.Gravity([0.0, 0.3, -1.0], [0.1, 0.2, 0.5])),
    "fixed in space": nh.VeselovaTop(np.diag([1.0, 2.0, 1.5])),
}
MAPS = {name: nh.discretize(system, 0.1) for name, system in (BODIES | POSED).items()} | {
    "composition": nh.discretize(BODIES["offset sleigh"], 0.1, order=4),
    "logarithmic": nh.discretize(TOP, 0.1, difference="logarithmic"),
}
FLOWS = BODIES | POSED | {"under a function": nh.Forced(TOP, lambda g: float(g[2, 0] ** 2 + 0.3 * g[2, 2]))}


def _assert_carries(run: Callable[..., nh.Orbit], system: AbstractSystem, error: float) -> None:
    """Compare the product of tangent maps with differences of the last state, with poses where they count."""
    group, k = system.group, system.rank
    start, g = np.linspace(0.3, 0.5, k), group.exp(np.linspace(0.1, 0.3, group.dim))
    orbit = run(momentum=start, configuration=g)
    product = np.linalg.multi_dot(orbit.tangent[::-1])
    posed = group.dim if system.is_spatial or system.is_forced else 0

    def last(z: np.ndarray) -> np.ndarray:
        end = run(momentum=start + z[posed:], configuration=g @ group.exp(z[:posed]) if posed else g)
        away = group.log(group.inverse(orbit.configuration[-1]) @ end.configuration[-1])
        return np.append(away[:posed], end.restricted_momentum[-1])

    np.testing.assert_allclose(product, derivatives(last, np.zeros(posed + k)), rtol=0, atol=error)


@pytest.mark.profile("routes", cases=["logarithmic", *POSED])
@pytest.mark.parametrize("discrete", MAPS.values(), ids=MAPS)
def test_tangent_maps_are_differences_of_orbits(discrete: nh.Discretization) -> None:
    """The product of the steps is what differences of the last state say, of closed derivatives and of JAX's."""
    _assert_carries(functools.partial(nh.simulate, discrete, steps=5), discrete.system, 1e-10)


@pytest.mark.profile("routes", cases=[f"*-{name}" for name in FLOWS if name not in BODIES])
@pytest.mark.parametrize("name", FLOWS)
@pytest.mark.parametrize("end", [1.5, -1.5])
def test_tangent_maps_are_differences_of_flows(name: str, end: float) -> None:
    """The same of flows, forwards and backwards."""
    run = functools.partial(nh.flow, FLOWS[name], times=end * np.array([0.0, 0.2, 0.7, 1.0]))
    _assert_carries(run, FLOWS[name], 1e-10 if name in BODIES else 1e-8)


def test_tangent_map_of_a_sleigh_in_closed_form() -> None:
    """Straight motion with speed u loses turning at the rate a m u / (J + m a^2); at rest nothing changes."""
    mass, inertia, a, p = 2.0, 1.0, 0.5, 0.8
    flow = nh.flow(nh.ChaplyginSleigh(mass, inertia, a), momentum=(0.0, p), times=np.linspace(0.0, 40.0, 9))
    decay = np.exp(-a * p / (inertia + mass * a * a) * np.diff(flow.time))
    np.testing.assert_allclose(flow.tangent[:, 0, 0], decay, rtol=1e-13)
    np.testing.assert_allclose(flow.tangent[:, 1, 1], 1.0, rtol=1e-13)
    np.testing.assert_allclose(nh.lyapunov_exponents(flow)[1], -a * p / (inertia + mass * a * a), rtol=1e-13)
    rest = nh.flow(nh.ChaplyginSleigh(mass, inertia, a), momentum=(0.0, 0.0), times=(0.0, 3.0))
    np.testing.assert_array_equal(rest.tangent[0], np.eye(2))


def test_exponents_are_right_or_refused() -> None:
    """A flow with times too far apart to see what decays is refused; a map whose step takes turning away is not."""
    sleigh = nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5)
    few, many, too_few = (
        nh.flow(sleigh, body_velocity=(0.3, 2.0, 0.0), times=np.linspace(0.0, 200.0, n)) for n in (11, 1001, 3)
    )
    np.testing.assert_allclose(nh.lyapunov_exponents(few), nh.lyapunov_exponents(many), rtol=1e-6)
    with pytest.raises(ValueError, match=r"directions are seen. Got a tangent map of condition .* Pass more times"):
        nh.lyapunov_exponents(too_few)
    fast = nh.simulate(nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 1.0), 1.0), restricted_velocity=(0.0, 4.0), steps=5)
    np.testing.assert_array_equal(nh.lyapunov_exponents(fast), [0.0, -np.inf])


def test_exponents_of_a_straight_motion() -> None:
    """A sleigh that slides straight ahead loses turning at a constant factor a step, which the cubic gives."""
    mass, inertia, a, h, p = 1.0, 1.0, 0.5, 0.1, 1.0
    orbit = nh.simulate(nh.discretize(nh.ChaplyginSleigh(mass, inertia, a), h), momentum=(0.0, p), steps=50)
    shifted = a * (h * p + 2 * mass * a)
    factor = 1 - 2 * a * h * p / (2 * inertia + shifted)
    np.testing.assert_allclose(nh.lyapunov_exponents(orbit), [0.0, np.log(factor) / h], rtol=1e-12, atol=1e-14)


def test_orbits_of_any_length_share_a_program(caplog: pytest.LogCaptureFixture) -> None:
    """Nothing is compiled again for the tangent maps of a longer orbit."""
    orbits = [nh.simulate(MAPS["composition"], momentum=(0.3, 0.4), steps=steps) for steps in (4, 70)]
    few, compiled = orbits[0].tangent, "Finished XLA compilation"
    assert compiled not in caplog.text
    with jax.log_compiles():
        np.testing.assert_array_equal(orbits[1].tangent[:4], few)
        assert compiled not in caplog.text
        jax.jit(lambda x: x + len(few))(1.0)
        assert compiled in caplog.text


@pytest.mark.profile("routes", keep=["True"])
@pytest.mark.parametrize("is_map", [True, False])
def test_tangent_maps_in_coordinates(is_map: bool) -> None:
    """On the particle with z' = y x' the product has the singular values of differences of orbits from all starts."""
    system: Any = nh.examples.particle().system
    h = 0.1 * is_map
    swung = nh.Forced(system, potential=lambda q: q @ q / 2 + q[0] ** 3 / 3)

    def state(z: np.ndarray) -> np.ndarray:
        q, u = np.array([0.1, 0.2, 0.3]) + z[:3], np.array([0.5, 0.4]) + z[3:]
        return np.array([*q, *u, (q[1] + h * u[1] / 2) * u[0]])

    def run(z: np.ndarray) -> Any:
        q, v = np.split(state(z), 2)
        if is_map:
            return nh.simulate(nh.discretize(swung, h), configuration=q, displacement=h * v, steps=6)
        return nh.flow(swung, configuration=q, body_velocity=v, times=[0.0, 0.2, 0.6], rtol=1e-13, atol=1e-14)

    def last(z: np.ndarray) -> np.ndarray:
        orbit = run(z)
        return np.append(orbit.configuration[-1], orbit.body_velocity[-1])

    carried = derivatives(last, np.zeros(5)) @ np.linalg.pinv(derivatives(state, np.zeros(5)))
    product = np.linalg.multi_dot(run(np.zeros(5)).tangent[::-1])
    wanted = np.linalg.svd(carried, compute_uv=False)[:5]
    np.testing.assert_allclose(np.linalg.svd(product, compute_uv=False), wanted, rtol=0, atol=1e-9)


@pytest.mark.profile("routes", instead="test_tangent_maps_in_coordinates")
def test_exponents_in_coordinates_are_those_of_the_linear_equations() -> None:
    """A pendulum upside down: plus and minus one, of the map logarithms of the multipliers over the step."""
    pendulum = nh.LagrangeDAlembert(lambda q, v: v @ v / 2 + jnp.cos(q[0]), None, dimension=1)
    rest: dict[str, Any] = {"configuration": [np.pi], "body_velocity": [0.0]}
    discrete = nh.discretize(pendulum, 0.1)
    multipliers = nh.linearize(discrete, configuration=[np.pi]).eigenvalues
    result = nh.lyapunov_exponents(nh.simulate(discrete, steps=60, **rest))
    np.testing.assert_allclose(result, np.log(multipliers) / 0.1, rtol=0, atol=np.log(2) / 6)  # the first frame
    flow = nh.flow(pendulum, times=np.linspace(0.0, 20.0, 81), **rest)
    np.testing.assert_allclose(nh.lyapunov_exponents(flow), [1.0, -1.0], rtol=0, atol=0.05)
    values = np.linalg.eigvals(flow.tangent[0])
    np.testing.assert_allclose(np.sort(np.real(values)), np.exp([-0.25, 0.25]), rtol=1e-11)


@pytest.mark.profile("routes", instead="test_tangent_maps_in_coordinates")
def test_tangent_maps_by_functions_on_a_group() -> None:
    """By functions of the pose on a group: a free top has the tangent map of `RigidBody`, and carries its pose."""
    J, h = np.diag([1.0, 2.0, 3.0]), 0.1
    top = nh.GroupLagrangeDAlembert(nh.SO(3), nh.mass_tensor_lagrangian(nh.SO(3), J), None)
    body = nh.discretize(nh.RigidBody(J), h)
    start: dict[str, Any] = {"body_velocity": (0.3, 0.4, 0.2)}
    orbit, reference = nh.simulate(nh.discretize(top, h), steps=1, **start), nh.simulate(body, steps=1, **start)

    def momentum(v: np.ndarray) -> np.ndarray:
        return nh.discrete_legendre(body, nh.SO(3).exp(h * v))

    before, after = (derivatives(momentum, v) for v in orbit.body_velocity)
    wanted = np.linalg.solve(after, reference.tangent[0] @ before)
    np.testing.assert_allclose(orbit.tangent[0][3:], np.hstack([np.zeros((3, 3)), wanted]), rtol=0, atol=1e-11)
    np.testing.assert_allclose(orbit.tangent[0][:3, :3], orbit.displacement[0].T, rtol=0, atol=1e-14)


def test_other_orbits_are_refused() -> None:
    """Orbits without a tangent map say what has one: thinned, under a function as force, with rows that yield."""
    sleigh = BODIES["offset sleigh"]
    thinned = nh.simulate(nh.discretize(sleigh, 0.1), restricted_velocity=(0.1, 0.2), steps=4, save_every=2)
    own = nh.discretize(nh.Forced(sleigh, force=lambda *_: np.zeros(3)), 0.1)
    pushed = nh.simulate(own, restricted_velocity=(0.1, 0.2), steps=4)
    ready = nh.examples.particle().simulate(steps=4, save_every=2)
    slipping = nh.discretize(nh.Forced(sleigh, force=nh.Slip([[0.0, 0.0, 1.0]], grip=0.5)), 0.1)
    slid = nh.simulate(slipping, restricted_velocity=(0.1, 0.2, 0.3), steps=4)
    cases = (thinned, "all states"), (pushed, "rollout"), (ready, "all states"), (slid, "never yields")
    for orbit, words in cases:
        with pytest.raises(ValueError, match=words):
            _ = orbit.tangent
    with pytest.raises(ValueError, match="have a step"):
        nh.lyapunov_exponents(nh.simulate(nh.discretize(sleigh, 0.1), momentum=(0.1, 0.2), steps=1)[:1])


def _body(name: str, rng: np.random.Generator) -> AbstractLLSystem:
    kind, n = name.split()
    if kind == "tilted":
        return nh.SuslovTop.from_inertia([[3.0, 0.1, 0.2], [0.1, 2.0, 0.3], [0.2, 0.3, 2.5]], (2 / 3, -1 / 3, 2 / 3))
    if kind == "top":
        return nh.SuslovTop(mass_tensor(nh.SO(int(n)), rng))
    if int(n) == 2:
        return nh.ChaplyginSleigh(*rng.uniform(0.3, 1.5, size=2), *rng.normal(size=2))
    center = rng.normal(size=int(n)) * ([0.0] + [1.0] * (int(n) - 1) if kind == "turning" else 1.0)
    return nh.MultidimensionalSleigh(rng.uniform(0.3, 1.5), center, mass_tensor(nh.SO(int(n)), rng))


NAMES = ["top 3", "top 4", "top 5", "top 6", "sleigh 2", "sleigh 3", "sleigh 4", "turning 3", "turning 4"]


@pytest.mark.parametrize("name", NAMES)
def test_falls_by_the_claimed_amount(name: str) -> None:
    """The change in a step is -(4/h) sin^2(theta/2) times |c|^2 - (c.u)^2 (turning) or m |a_1| (sliding)."""
    rng = np.random.default_rng(4)
    system, h = _body(name, rng), 0.2
    rows = system.constraint_subspace
    orbit = nh.simulate(nh.discretize(system, h), restricted_velocity=0.5 * rng.normal(size=len(rows)), steps=20)
    x = system.group.log(orbit.displacement[:-1]) @ np.linalg.pinv(rows)
    turn = x[:, : 1 if name == "sleigh 2" else len(x[0]) - (0 if name.startswith("top") else 1)]
    theta = np.linalg.norm(turn, axis=1)
    if name.startswith("sleigh"):
        a1 = system.a if name == "sleigh 2" else system.center_of_mass[0]
        weight = np.full(len(theta), system.mass * abs(a1))
    else:
        c = system.coupling if name.startswith("top") else system.mass_tensor[0, 1:]
        weight = c @ c - (turn @ c / theta) ** 2
    expected = -4 / h * np.sin(theta / 2) ** 2 * weight
    change = np.diff(nh.lyapunov_function(orbit.motion)(orbit.momentum))
    assert np.abs(change - expected).max() <= 1e-13 * max(1.0, np.abs(orbit.momentum).max())


@pytest.mark.profile("routes", keep=["top 4", "sleigh 3", "tilted 3"])
@pytest.mark.parametrize("name", [*NAMES, "tilted 3"])
def test_falls_along_the_flow(name: str) -> None:
    """L falls between all saved states of a flow; it takes momenta in the user's frame."""
    rng = np.random.default_rng(5)
    system = _body(name, rng)
    start = rng.normal(size=len(system.constraint_subspace))
    orbit = nh.flow(system, restricted_velocity=start, times=np.linspace(0.0, 1.0, 6))
    assert np.all(np.diff(nh.lyapunov_function(system)(orbit.momentum)) < 0)


def test_balanced_and_refused() -> None:
    """For a balanced body the function is constant; a right-invariant constraint is refused."""
    assert nh.lyapunov_function(nh.SuslovTop(np.diag([1.0, 2.0, 3.0])))([0.3, 0.4]) == 0
    with pytest.raises(ValueError, match="left-invariant"):
        nh.lyapunov_function(nh.VeselovaTop(np.diag([1.0, 2.0, 3.0])))
