"""Rollouts in coordinates: the runs of `simulate`, with derivatives of 50 digits by parameters, start and controls."""

import functools
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


def end(numbers: dict[str, Any], q: Any, v: Any, controls: Any) -> Any:
    """Return where a rollout ends, and how fast it is."""
    discrete = nh.discretize(SYSTEM.with_parameters(**numbers), H)
    states = nh.rollout(discrete, configuration=q, body_velocity=v, controls=controls, steps=STEPS, save_every=STEPS)
    return jnp.concatenate([states.configuration[-1], states.momentum[-1], states.energy[-1:]])


def exactly(numbers: dict[str, Any], q: Any, v: Any, controls: Any) -> list[Any]:
    """Return the same in 50 digits, from the equations of the midpoint rule written out."""
    m, arm, pull, h = numbers["mass"], numbers["arm"], numbers["pull"], mpmath.mpf(H)
    mass, rows = [m, m, mpmath.mpf(0.5)], [*controls, [mpmath.mpf(0)] * 3]

    def form(at: list[Any]) -> list[Any]:
        return [-mpmath.sin(at[2]), mpmath.cos(at[2]), arm]

    q, p, near = list(q), [a * b for a, b in zip(mass, v, strict=True)], [*v, mpmath.mpf(0)]
    for row in rows:
        started, (place, target) = list(q), (q, [p[i] + h / 2 * row[i] for i in range(3)])

        def middle(w: Any, place: list[Any] = place) -> list[Any]:
            return [place[i] + h / 2 * w[i] for i in range(3)]

        def missed(
            a: Any, b: Any, c: Any, mu: Any, place: Any = place, target: Any = target, middle: Any = middle
        ) -> Any:
            w, at, here = (a, b, c), middle((a, b, c)), form(place)
            slope = [h / 2 * pull[i] * mpmath.cos(at[i]) for i in range(3)]
            dynamics = [mass[i] * w[i] - slope[i] - target[i] - mu * here[i] for i in range(3)]
            return [*dynamics, sum(f * x for f, x in zip(form(at), w, strict=True))]

        near = list(mpmath.findroot(missed, near, tol=1e-45))
        w, at = near[:3], middle(near[:3])
        slope = [h / 2 * pull[i] * mpmath.cos(at[i]) for i in range(3)]
        leaving = [mass[i] * w[i] - slope[i] - h / 2 * row[i] for i in range(3)]
        q, p = [q[i] + h * w[i] for i in range(3)], [mass[i] * w[i] + slope[i] + h / 2 * row[i] for i in range(3)]
    # the energy of a controlled motion is that of the velocity that has the momentum of the node
    here, norm = form(started), 0
    norm = sum(f * f / k for f, k in zip(here, mass, strict=True))
    off = sum(f * x / k for f, x, k in zip(here, leaving, mass, strict=True)) / norm
    u = [(leaving[i] - off * here[i]) / mass[i] for i in range(3)]
    energy = sum(mass[i] * u[i] ** 2 for i in range(3)) / 2 - sum(pull[i] * mpmath.sin(started[i]) for i in range(3))
    return [*started, *leaving, energy]


@pytest.mark.profile("routes", instead="test_values_are_those_of_simulate")
def test_derivatives_have_nine_digits_of_fifty() -> None:
    """Forward and reverse derivatives by numbers, start and controls are those of differences of 50-digit runs."""
    given = {"mass": NUMBERS["mass"], "arm": NUMBERS["arm"], "pull": NUMBERS["pull"]}
    with jax.enable_x64(True):
        forward = jax.jacfwd(end, argnums=(0, 1, 2, 3))(given, Q, V, CONTROLS)
        reverse = jax.jacrev(end, argnums=(0, 1, 2, 3))(given, Q, V, CONTROLS)
        ours = np.asarray(end(given, Q, V, CONTROLS))
    with mpmath.workdps(50):
        exact = functools.partial(jax.tree.map, lambda x: np.vectorize(mpmath.mpf, otypes=[object])(x))
        point = exact((given, Q, V, CONTROLS))
        assert np.abs(ours - np.array(exactly(*point), float)).max() <= 1e-14
        step = mpmath.mpf(10) ** -18
        paths = [
            (0, "mass", ()), (0, "arm", ()), (0, "pull", 1), (1, None, 2), (2, None, 0), (3, None, (2, 1)),
            (3, None, (5, 0)),
        ]  # fmt: skip
        for which, name, index in paths:
            ends = []
            for sign in (1, -1):
                moved = exact((given, Q, V, CONTROLS))
                place = moved[which] if name is None else moved[which][name]
                shifted = np.array(place, dtype=object)
                shifted[index] = shifted[index] + sign * step
                if name is not None:
                    moved[which][name] = shifted if shifted.ndim else shifted.item()
                else:
                    moved = tuple(shifted if i == which else each for i, each in enumerate(moved))
                ends.append(np.array(exactly(*moved), dtype=object))
            slope = ((ends[0] - ends[1]) / (2 * step)).astype(float)
            for table in (forward, reverse):
                ours = np.asarray(table[which] if name is None else table[which][name])
                ours = ours[(slice(None), *np.atleast_1d(index).astype(int))] if index != () else ours
                assert np.abs(ours - slope).max() <= 1e-9 * (1 + np.abs(slope).max()), (which, name, index)


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
    discrete, start = (
        nh.discretize(SYSTEM, 0.01),
        {"configuration": Q, "momentum": V, "steps": 10_000, "save_every": 10_000},
    )
    states, orbit = nh.rollout(discrete, **start), nh.simulate(discrete, **start)
    assert np.abs(states.configuration - orbit.configuration).max() <= 1e-9
    assert np.array_equal(states.time, orbit.time)


@pytest.mark.profile("routes", instead="test_values_are_those_of_simulate")
def test_many_numbers_at_once() -> None:
    """`jax.vmap` over a parameter gives the rollouts one by one."""

    def place(mass: Any) -> Any:
        return end({"mass": mass, "arm": 0.2, "pull": NUMBERS["pull"]}, Q, V, CONTROLS)

    masses = np.linspace(0.5, 2.0, 4)
    with jax.enable_x64(True):
        many, each = np.asarray(jax.vmap(place)(masses)), np.array([place(mass) for mass in masses])
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
