"""Rollouts in coordinates: the runs of `simulate`, with derivatives of 50 digits by parameters, start and controls."""

from typing import Any

import jax
import jax.numpy as jnp
import mpmath
import numpy as np
import pytest
from comparisons import assert_near
from refusals import refusals

import nonholo as nh

H, STEPS = 0.1, 6
NUMBERS = {"mass": 1.3, "arm": 0.2, "pull": np.array([0.3, -0.2, 0.1])}
Q, FORM = np.array([0.1, -0.2, 0.3]), np.array([-np.sin(0.3), np.cos(0.3), 0.2])
V = np.array([0.7, 0.4, -0.5]) - FORM * (FORM @ [0.7, 0.4, -0.5]) / (FORM @ FORM)
CONTROLS = np.random.default_rng(3).normal(size=(STEPS, 3))
ROWS = ("time", "configuration", "body_velocity", "momentum", "energy")


def sleigh(q, v, p):  # noqa: ANN001, ANN201
    """Return the Lagrangian of a sleigh in a wavy potential."""
    return (p["mass"] * (v[0] ** 2 + v[1] ** 2) + 0.5 * v[2] ** 2) / 2 + p["pull"] @ jnp.sin(q)


def blade(q, p):  # noqa: ANN001, ANN201
    """Return its constraint."""
    return jnp.array([[-jnp.sin(q[2]), jnp.cos(q[2]), p["arm"]]])


def pushed(time, q, v, p):  # noqa: ANN001, ANN201
    """Return a force."""
    return p["pull"] * jnp.cos(time + q[1]) - 0.1 * p["mass"] * v


SYSTEM = nh.LagrangeDAlembert(sleigh, blade, dimension=3, parameters=NUMBERS)
FORCED = nh.LagrangeDAlembert(sleigh, blade, dimension=3, parameters=NUMBERS, force=pushed)


GIVEN = np.concatenate([[1.3, 0.2], NUMBERS["pull"], Q, V, CONTROLS.ravel()])
"""All numbers of a run in one vector."""


def parts(x: Any) -> tuple[Any, ...]:
    """Return the mass, the arm, the pull, the start and the controls of a vector of all numbers."""
    return x[0], x[1], x[2:5], x[5:8], x[8:11], x[11:].reshape(STEPS, 3)


def end(x: Any) -> Any:
    """Return where a rollout ends, and how fast it is."""
    mass, arm, pull, q, v, controls = parts(x)
    discrete = nh.discretize(SYSTEM.with_parameters(mass=mass, arm=arm, pull=pull), H)
    states = nh.rollout(discrete, configuration=q, body_velocity=v, controls=controls, steps=STEPS, save_every=STEPS)
    return jnp.concatenate([states.configuration[-1], states.momentum[-1], states.energy[-1:]])


def exactly(x: np.ndarray) -> np.ndarray:
    """Return the same in 50 digits, from the equations of the midpoint rule written out."""
    m, arm, pull, q, v, controls = parts(x)
    mass, h = np.array([m, m, mpmath.mpf(0.5)]), mpmath.mpf(H)
    sin, cos = (np.vectorize(function, otypes=[object]) for function in (mpmath.sin, mpmath.cos))

    def form(at: np.ndarray) -> np.ndarray:
        return np.array([-mpmath.sin(at[2]), mpmath.cos(at[2]), arm])

    def step(q: np.ndarray, target: np.ndarray, near: np.ndarray) -> np.ndarray:
        """Return the velocity and the multiplier."""

        def missed(*z: Any) -> list[Any]:
            w, middle = np.array(z[:3]), q + np.array(z[:3]) * h / 2
            return [*(mass * w - pull * cos(middle) * h / 2 - target - form(q) * z[3]), form(middle) @ w]

        return np.array(list(mpmath.findroot(missed, list(near), tol=1e-45)))

    p, z = mass * v, np.append(v, mpmath.mpf(0))
    for row in [*controls, 0 * pull]:
        started, z = q, step(q, p + row * h / 2, z)
        slope = pull * cos(q + z[:3] * h / 2) * h / 2
        leaving = mass * z[:3] - slope - row * h / 2
        q, p = q + z[:3] * h, mass * z[:3] + slope + row * h / 2
    # the energy of a controlled motion is that of the velocity that has the momentum of the node
    here = form(started)
    u = (leaving - here * ((here @ (leaving / mass)) / (here @ (here / mass)))) / mass
    return np.array([*started, *leaving, mass @ u**2 / 2 - pull @ sin(started)])


@pytest.mark.profile("routes", instead="test_values_are_those_of_simulate")
def test_derivatives_have_nine_digits_of_fifty() -> None:
    """Forward and reverse derivatives by numbers, start and controls are those of differences of 50-digit runs."""
    with jax.enable_x64(True):
        tables = [np.asarray(derivative(end)(GIVEN)) for derivative in (jax.jacfwd, jax.jacrev)]
        ours = np.asarray(end(GIVEN))
    with mpmath.workdps(50):
        exact, step = np.vectorize(mpmath.mpf, otypes=[object])(GIVEN), mpmath.mpf(10) ** -18
        assert np.abs(ours - exactly(exact).astype(float)).max() <= 1e-14
        for index in (0, 1, 3, 7, 8, 18, 26):  # mass, arm, a pull, of place and velocity, controls of steps 2 and 5
            ahead, behind = exact.copy(), exact.copy()
            ahead[index], behind[index] = exact[index] + step, exact[index] - step
            slope = ((exactly(ahead) - exactly(behind)) / (2 * step)).astype(float)
            for table in tables:
                assert np.abs(table[:, index] - slope).max() <= 1e-9 * (1 + np.abs(slope).max()), index


@pytest.mark.profile("routes", keep=["forced"])
@pytest.mark.parametrize("system", [SYSTEM, FORCED], ids=["free", "forced"])
def test_values_are_those_of_simulate(system: nh.LagrangeDAlembert) -> None:
    """All that a rollout tells is what an orbit tells, to rounding; a table of controls acts as that of a force."""
    discrete, start = nh.discretize(system, H), {"configuration": Q, "momentum": V, "steps": 30}
    states, orbit = nh.rollout(discrete, **start), nh.simulate(discrete, **start)
    assert_near(states, orbit, 1e-13, *ROWS)
    assert states.outcome == nh.Outcome.successful
    if system is SYSTEM:
        controls = np.random.default_rng(1).normal(size=(30, 3))
        driven = nh.rollout(discrete, **start, controls=controls, save_every=3)
        table = nh.simulate(nh.discretize(nh.Forced(system, force=controls), H), **start, save_every=3)
        assert_near(driven, table, 1e-13, *ROWS)


@pytest.mark.profile("routes", instead="test_values_are_those_of_simulate")
def test_a_long_rollout_goes_between_saved_states() -> None:
    """Ten thousand steps, in stretches, end where those of `simulate` do."""
    discrete = nh.discretize(SYSTEM, 0.01)
    start = {"configuration": Q, "momentum": V, "steps": 10_000, "save_every": 10_000}
    states, orbit = nh.rollout(discrete, **start), nh.simulate(discrete, **start)
    assert np.abs(states.configuration - orbit.configuration).max() <= 1e-9
    assert np.array_equal(states.time, orbit.time)


@pytest.mark.profile("routes", instead="test_values_are_those_of_simulate")
def test_many_numbers_at_once() -> None:
    """`jax.vmap` over a parameter gives the rollouts one by one."""
    starts = np.tile(GIVEN, (4, 1))
    starts[:, 0] = np.linspace(0.5, 2.0, 4)
    with jax.enable_x64(True):
        many, each = np.asarray(jax.vmap(end)(starts)), np.array([end(start) for start in starts])
    assert np.abs(many - each).max() <= 1e-14


@pytest.mark.profile("routes", instead="test_values_are_those_of_simulate")
def test_beyond_a_fold_there_is_nothing() -> None:
    """States and derivatives are NaN from the step that is not there, which the outcome says; those before stay."""

    def folded(q, q_next, h, p):  # noqa: ANN001, ANN202
        return jnp.sum(1 - jnp.cos(q_next - q)) / h + h * p["slope"] * jnp.sum(q + q_next) / 2

    lagrangian = lambda q, v, p: v @ v / 2 + p["slope"] * q[0]  # noqa: E731
    given = {"dimension": 1, "discrete_lagrangian": folded, "parameters": {"slope": 0.15}}
    system = nh.LagrangeDAlembert(lagrangian, None, **given)
    start = {"configuration": np.zeros(1), "momentum": np.array([0.6]), "steps": 12}
    orbit = nh.simulate(nh.discretize(system, 1.0), **start, throw=False)
    states = nh.rollout(nh.discretize(system, 1.0), **start)
    assert states.outcome == orbit.outcome == nh.Outcome.no_real_branch
    good = len(orbit)
    assert 0 < good < 12
    assert np.abs(states.configuration[:good] - orbit.configuration).max() <= 1e-12
    assert np.isnan(states.configuration[good:]).all()

    def places(slope: Any) -> Any:
        return nh.rollout(nh.discretize(system.with_parameters(slope=slope), 1.0), **start).configuration

    with jax.enable_x64(True):
        slopes = np.asarray(jax.jacfwd(places)(0.15))
    assert np.isfinite(slopes[:good]).all()
    assert np.isnan(slopes[good:]).all()


# Shapes and starts are checked before any work, traced or not.
test_bad_arguments_are_refused = refusals(
    ({"restricted_velocity": (1.0, 0.0)}, r"rollout\(restricted_velocity=...\)` must keep"),
    ({"momentum": V, "configuration": Q[:2]}, r"rollout\(configuration=...\)` must have shape \(3,\)"),
    ({"momentum": V[:2]}, r"rollout\(momentum=...\)` must have shape \(3,\)"),
    ({"momentum": V, "controls": CONTROLS[:2]}, r"rollout\(controls=...\)` must have shape \(6, 3\)"),
    ({"momentum": V, "configuration": None}, "must be given for a system in coordinates"),
    ask=lambda given: nh.rollout(nh.discretize(SYSTEM, H), **{"configuration": Q, "steps": STEPS} | given),
)
