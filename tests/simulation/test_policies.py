"""Closed loops as JAX functions: a policy acts as its controls do, and derivatives are those of the whole loop."""

import dataclasses
from typing import Any, cast

import equinox
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from problems import EVERY
from references import golden, numbers
from refusals import refusals

import nonholo as nh
from nonholo.base.traced import NodeState
from nonholo.simulation.traced import with_traced_potential

SLEIGH = nh.ChaplyginSleigh(1.5, 0.7, 0.4, 0.2)
TABLE = np.outer(np.cos(np.arange(20)), [0.4, -0.3, 0.2])
RUB, HEAVY = nh.Friction(np.eye(3) / 5 + 0.1), nh.Gravity([0.2, -1.0], [0.5, 0.1])
GROUPS = {
    "closed form": SLEIGH,
    "matrices": EVERY["any d on SE(3)"],
    "in space": nh.VeselovaTop(np.diag([1.0, 2.0, 1.5]) + 0.1),
    "top": nh.Forced(nh.SuslovTop(np.eye(3) + 0.1), force=(RUB, TABLE)),
    "kicks": nh.Forced(SLEIGH, HEAVY, (RUB, TABLE), "variational"),
    "balanced": nh.Forced(SLEIGH, HEAVY, (RUB, TABLE)),
}
STEPS = 12


def wavy(time: Any, state: Any) -> Any:
    """Return a control that depends on all it sees, and on nothing of it linearly."""
    place, v = jnp.ravel(state.configuration), state.body_velocity
    return 0.3 * jnp.cos(time + v + jnp.sin(place @ jnp.arange(len(place)))) - 0.1 * v * jnp.abs(v)


def assert_same(one: Any, other: Any, tolerance: float = 1e-13) -> None:
    """Compare all that two rollouts tell."""
    for name in one._fields:
        np.testing.assert_allclose(getattr(one, name), getattr(other, name), 0, tolerance, err_msg=name)


def assert_controls_are(states: Any, velocities: np.ndarray, table: np.ndarray) -> None:
    """Compare the controls with those of a policy that sees configurations and velocities of the nodes."""
    rows = zip(states.time, states.configuration, velocities, strict=True)
    with jax.enable_x64(True):
        own = np.array([wavy(time, NodeState(q, v)) for time, q, v in rows])[:-1] + table[:STEPS]
    np.testing.assert_allclose(states.controls[:-1], own, 0, 1e-12)


@pytest.mark.profile("routes", keep=["closed form"])
@pytest.mark.parametrize("name", GROUPS)
def test_a_policy_is_the_table_of_its_controls(name: str) -> None:
    """On groups its controls are those of pose and admissible velocity at the nodes, and as a table they move alike."""
    system, dim = GROUPS[name], GROUPS[name].group.dim
    start = {"restricted_velocity": np.linspace(0.4, -0.6, system.rank), "steps": STEPS}
    start["configuration"] = system.group.exp(np.linspace(0.1, 0.5, dim))
    discrete, table = nh.discretize(system, 0.1), TABLE if system.is_forced else np.zeros((20, dim))
    states = nh.rollout(discrete, **start, policy=wavy)
    assert states.outcome == 0
    E = np.broadcast_to(system.constraint_subspace.T, (STEPS + 1, dim, system.rank))
    if system.is_spatial:
        E = system.group.adjoint(system.group.inverse(states.configuration)) @ E
    inertia = np.swapaxes(E, 1, 2) @ system.inertia_operator @ E
    velocities = (E @ np.linalg.solve(inertia, states.restricted_momentum[..., None]))[..., 0]
    assert_controls_are(states, velocities, table)
    assert_same(nh.rollout(discrete, **start, controls=(states.controls - table[: STEPS + 1])[:-1]), states)
    thinned = nh.rollout(discrete, **start, policy=wavy, save_every=5)
    assert_same(thinned, type(states)(*(rows[::5] for rows in states[:-1]), outcome=states.outcome))


READY = {"parameters": nh.examples.snakeboard, "driven": nh.examples.driven_sleigh, "free": nh.examples.snake}


@pytest.mark.profile("routes", instead="test_a_policy_is_the_table_of_its_controls")
@pytest.mark.parametrize("name", READY)
def test_a_policy_in_coordinates_is_the_table_of_its_controls(name: str) -> None:
    """It sees the velocity that belongs to the momentum of the node; what drives a system acts beside it."""
    ready = READY[name]()
    system, discrete = cast(Any, ready.system).plain, ready.discretize(0.05)
    start = {"configuration": ready.configuration, "body_velocity": ready.body_velocity, "steps": STEPS}
    states = nh.rollout(discrete, **start, policy=wavy)
    assert states.outcome == 0
    velocities = []
    with jax.enable_x64(True):
        for time, q, p in zip(states.time, states.configuration, states.momentum, strict=True):
            at = (q, time) if system.takes_time("lagrangian") else (q,)
            n, M = len(q), jax.hessian(system.lagrangian, 1)(at[0], p, *at[1:])
            A = np.asarray(system.constraint_forms(q) if system.constraint_forms else np.zeros((0, n)))
            A = np.concatenate([A, np.eye(n)[[i for i, _ in system.prescribed]]])
            rates = np.zeros(len(A))
            rates[len(A) - len(system.prescribed) :] = [jax.grad(s)(time) for _, s in system.prescribed]
            bordered = np.block([[M, -A.T], [A, np.zeros((len(A), len(A)))]])
            velocities.append(np.linalg.solve(bordered, np.append(p, rates))[:n])
    assert_controls_are(states, np.array(velocities), np.zeros((STEPS, 1)))
    assert_same(nh.rollout(discrete, **start, controls=states.controls[:-1]), states)


@pytest.mark.profile("routes", instead="test_a_policy_is_the_table_of_its_controls")
def test_derivatives_of_a_closed_loop_agree_with_40_digits() -> None:
    """Gains, body, time step and start of a steered sleigh move its end as differences in 60 digits say."""
    (case,) = (case for case in golden("derivatives.json") if "gains" in case)

    def end(body: Any, time_step: Any, velocity: Any, gains: Any) -> Any:
        def steer(time: Any, state: Any) -> Any:
            (omega, speed, _), g = state.body_velocity, state.configuration
            torque = -gains[0] * jnp.cos(time) * (g[1, 2] + g[1, 0]) - gains[1] * omega
            return jnp.stack([torque, gains[2] * (1 - speed), 0.0])

        discrete = nh.discretize(nh.ChaplyginSleigh(*body), time_step)
        states = nh.rollout(discrete, restricted_velocity=velocity, steps=case["steps"], policy=steer)
        last = jnp.concatenate([states.restricted_momentum[-1], states.configuration[-1].ravel()])
        return last, last

    point = [np.array(case[name], float) for name in ("body", "time_step", "velocity", "gains")]
    for derivative in (jax.jacfwd, jax.jacrev):
        with jax.enable_x64(True):
            slopes, last = jax.jit(derivative(end, (0, 1, 2, 3), has_aux=True))(*point)
        np.testing.assert_allclose(last, numbers(case["end"]), 0, 1e-13)
        columns = np.concatenate([np.reshape(slope, (len(last), -1)) for slope in slopes], axis=1)
        np.testing.assert_allclose(columns.T, numbers(case["derivative"]), 1e-9, 1e-11)


class Network(equinox.Module):
    """A policy with two layers of weights."""

    layers: tuple[Any, ...]

    def __call__(self, time: Any, state: Any) -> Any:
        """Return the control."""
        inputs = jnp.append(jnp.append(jnp.ravel(state.configuration[:2]), state.body_velocity), time)
        return self.layers[1] @ jnp.tanh(self.layers[0] @ inputs)


@pytest.mark.profile("routes", instead="test_a_policy_is_the_table_of_its_controls")
def test_a_network_learns() -> None:
    """The gradient by the weights of a pytree is that of the same weights captured, and a step along it gains."""
    rng, discrete = np.random.default_rng(0), nh.discretize(SLEIGH, 0.1)
    weights = rng.normal(size=(4, 10)) / 3, rng.normal(size=(3, 4)) / 3

    def missed(policy: Any) -> Any:
        states = nh.rollout(discrete, restricted_velocity=(0.3, 1.0), steps=20, policy=policy)
        return jnp.sum((states.configuration[-1, :2, 2] - jnp.array([1.5, 1.0])) ** 2) + jnp.sum(states.controls**2)

    with jax.enable_x64(True):
        value, slope = jax.jit(jax.value_and_grad(missed))(Network(weights))
        captured = jax.grad(lambda w: missed(lambda time, state: Network(w)(time, state)))(weights)
    for mine, theirs in zip(slope.layers, captured, strict=True):
        np.testing.assert_allclose(mine, theirs, 1e-10, 1e-12)
    better = Network(tuple(w - 1e-3 * np.asarray(s) for w, s in zip(weights, slope.layers, strict=True)))
    gain = sum(float(np.sum(np.asarray(s) ** 2)) for s in slope.layers)
    with jax.enable_x64(True):
        assert abs(value - missed(better) - 1e-3 * gain) < 0.1 * 1e-3 * gain  # to first order


# A policy that gives no body covector, or stands beside controls, is refused before any work.
test_bad_policies_are_refused = refusals(
    ({"policy": lambda *_: np.zeros(2)}, r"return an array of shape \(3,\). Got shape \(2,\)"),
    ({"policy": lambda _: np.zeros(3)}, r"take \(time, state\)"),
    ({"policy": wavy, "controls": np.zeros((3, 3))}, "be left out beside controls"),
    ({"policy": 1.0}, "be a function"),
    ask=lambda given: nh.rollout(nh.discretize(SLEIGH, 0.1), restricted_velocity=(0.1, 0.2), steps=3, **given),
    begin=r"rollout\(policy=...\).*",
)


START = {"body_velocity": np.array([0.4, 0.7, 0.0]), "configuration": nh.SE(2).exp(np.array([0.3, 0.2, -0.1]))}


def _well(stiffness: Any, scheme: str | None = None) -> Any:
    """Return a sleigh in a well that is no harmonic one."""
    sleigh = nh.ChaplyginSleigh(mass=1.0, inertia=0.5, a=0.2)
    return nh.discretize(nh.Forced(sleigh, lambda g: stiffness * (g[0, 2] ** 2 + g[1, 2] ** 4) / 2, scheme=scheme), 0.1)


@pytest.mark.profile("routes", keep=["well"])
@pytest.mark.parametrize("discrete", [_well(0.8), nh.examples.heavy_suslov_top().discretize(0.1)], ids=["well", "top"])
def test_forces_are_those_of_differences(discrete: Any) -> None:
    """Energy, force and force of a step are those of `Forced`, which differences the function; at rest too."""
    rng, given, group = np.random.default_rng(6), discrete.system, discrete.system.group
    traced = with_traced_potential("rollout", discrete).system
    for size in (0.7, 1e-3, 1e-9, 0.0):
        g, W = group.exp(rng.normal(size=group.dim)), group.exp(size * rng.normal(size=group.dim))
        rest, places = np.zeros(group.dim), ("potential_energy", "potential_force")
        with jax.enable_x64(True):
            result = [traced.mean_force(jnp.asarray(g), jnp.asarray(W), 0.1, jnp.asarray(rest))]
            result += [getattr(traced, name)(jnp.asarray(g)) for name in places]
        wanted = [given.mean_force(g[None], W[None], 0.1, rest[None], time=np.zeros(1))[0]]
        wanted += [getattr(given, name)(g) for name in places]
        for one, other in zip(result, wanted, strict=True):
            np.testing.assert_allclose(one, other, rtol=0, atol=1e-11)


@pytest.mark.profile("routes", instead="test_forces_are_those_of_differences")
@pytest.mark.parametrize("scheme", ["energy", "variational"])
def test_rollout_is_the_run_and_its_derivatives_are_differences(scheme: str) -> None:
    """It has the numbers of `simulate`; derivatives by the start and by a number of the potential are differences."""
    orbit, states = (run(_well(0.8, scheme), steps=12, **START) for run in (nh.simulate, nh.rollout))
    for name in ("configuration", "momentum", "energy"):
        np.testing.assert_allclose(getattr(states, name), getattr(orbit, name), rtol=0, atol=1e-12)

    def end(stiffness: Any, turning: Any, run: Any = nh.rollout) -> Any:
        velocity = START["body_velocity"] * turning
        return run(_well(stiffness, scheme), steps=12, **{**START, "body_velocity": velocity}).configuration[-1, :2, 2]

    with jax.enable_x64(True):
        forward, reverse = (slope(end, (0, 1))(0.8, 1.0) for slope in (jax.jacfwd, jax.jacrev))
    h = 1e-5
    for i, result in enumerate(zip(forward, reverse, strict=True)):
        high, low = (end(*(np.array([0.8, 1.0]) + to), nh.simulate) for to in (h * np.eye(2)[i], -h * np.eye(2)[i]))
        wanted = (high - low) / (2 * h)
        np.testing.assert_allclose(result, [wanted, wanted], rtol=0, atol=1e-8)


def _branching(g: Any) -> Any:
    return g[0, 2] if g[0, 2] > 0 else 0.0


_BODY = dataclasses.replace(_well(1.0).system, potential=_branching)

# What JAX cannot trace is named; a force that is a function is none of numbers.
test_what_is_not_traced_is_refused = refusals(
    (_BODY, "be traceable by JAX on poses of SE.2."),
    (nh.Forced(_BODY.system, force=lambda _time, _g, v: 0 * v), "forces that are numbers"),
    ask=lambda system: nh.rollout(nh.discretize(system, 0.1), steps=2, **START),
)
