"""One route for each discretization, by its normal form; closed forms against the definition and general routes."""

import dataclasses
import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from bodies import elsewhere, tensor
from comparisons import assert_same, derivatives
from problems import PROBLEMS, Problem

import nonholo as nh
from nonholo.discrete.definition._step import in_double, momenta_by_derivative, principal_displacement
from nonholo.discrete.routes import make_route

QUANTITIES = ("momentum", "displacement", "configuration", "multipliers", "chart", "restricted_momentum")


def discrete_lagrangian(system: Any, h: float) -> Callable[[Any], Any]:
    """Return l_d(W) = tr(X J X*)/(2 h) with X = W - I, the one of difference="matrix"."""

    def of_matrix(W: Any) -> Any:
        X = W - jnp.eye(W.shape[-1])
        return jnp.trace(X @ jnp.asarray(system.homogeneous_mass_tensor) @ system.group.form_adjoint(X)) / (2 * h)

    return of_matrix


@pytest.mark.profile("routes", cases=["tilted top"])
@pytest.mark.parametrize("problem", PROBLEMS, ids=lambda p: p.name)
def test_orbits_agree(problem: Problem) -> None:
    """Ten steps by the compiled closed form and by the definition agree to rounding over the time step."""
    discrete = nh.discretize(problem.system, 0.2)
    pose = problem.system.group.random(np.random.default_rng(0))
    start = {"restricted_velocity": problem.restricted_velocity, "steps": 10, "configuration": pose}
    closed = nh.simulate(discrete, **start, backend="numba")
    definition = nh.simulate(discrete, **start, backend="jax")
    for name in QUANTITIES:
        expected = getattr(definition, name)
        assert np.abs(getattr(closed, name) - expected).max() <= 1e-12 * (1 + np.abs(expected).max()), name


@pytest.mark.profile("routes", keep=["left-top", "left-offset sleigh", "right-sleigh", "left-rod"])
@pytest.mark.parametrize("problem", PROBLEMS, ids=lambda p: p.name)
@pytest.mark.parametrize("side", ["left", "right"])
def test_legendre_agrees_with_its_derivative(problem: Problem, side: str) -> None:
    """The closed form of P(W), off the variety too, is the derivative of l_d; the right one is Ad* of the left."""
    group, rng = problem.system.group, np.random.default_rng(1)
    discrete = nh.discretize(problem.system, 0.3)
    W = np.stack([group.random(rng) for _ in range(5)])
    left, right = (nh.discrete_legendre(discrete, W, each) for each in ("left", "right"))
    defined = momenta_by_derivative(discrete_lagrangian(problem.system, 0.3), group, W, side)
    assert np.abs((left if side == "left" else right) - defined).max() <= 1e-12 * np.abs(defined).max()
    assert np.abs(right - group.coadjoint(W, left)).max() < 1e-12 * np.abs(defined).max()


def test_logarithmic_momenta_against_the_series() -> None:
    """For l(log W / h) the momentum is the transposed inverse of dexp applied to I X / h, here as a series."""
    system, h = PROBLEMS[0].system, 0.5
    x = np.array([0.2, -0.1, 0.15])
    ad = np.stack([system.group.bracket(x, e) for e in np.eye(3)], axis=1)
    bernoulli = (1, -1 / 2, 1 / 12, 0, -1 / 720, 0, 1 / 30240, 0, -1 / 1209600)
    inverse = sum(b * np.linalg.matrix_power(ad, k) for k, b in enumerate(bernoulli))
    P = nh.discrete_legendre(nh.discretize(system, h, difference="logarithmic"), system.group.exp(x))
    assert np.abs(P - inverse.T @ system.inertia_operator @ x / h).max() < 1e-9


def test_a_heavier_body_moves_in_the_same_way() -> None:
    """Masses in grams, or in another unit, are a factor of the equations: displacements have the same bits."""
    J, start = PROBLEMS[0].system.mass_tensor, {"restricted_velocity": (0.3, 0.2), "steps": 10}
    light, heavy = (nh.discretize(nh.SuslovTop(unit * J), 0.1, difference="logarithmic") for unit in (1.0, 2.0**40))
    assert_same(nh.simulate(light, **start), nh.simulate(heavy, **start), "displacement")


@pytest.mark.profile("routes", keep=["offset sleigh"])
@pytest.mark.parametrize("problem", PROBLEMS[:8:7], ids=lambda p: p.name)
def test_step_derivatives_against_differences(problem: Problem) -> None:
    """Forward and reverse derivatives of the step are those of the implicit function, parameters included."""
    discrete = nh.discretize(problem.system, 0.2)
    r = nh.simulate(discrete, restricted_velocity=problem.restricted_velocity, steps=1).restricted_momentum[0]

    def after(x: np.ndarray) -> np.ndarray:
        return nh.step(discrete, x).momentum

    differences = derivatives(after, r)
    with jax.enable_x64(True):
        forward = jax.jit(jax.jacfwd(after))(jnp.asarray(r))
        assert np.abs(forward - differences).max() < 1e-8
        assert np.abs(jax.jit(jax.jacrev(after))(jnp.asarray(r)) - forward).max() < 1e-13


@pytest.mark.profile("routes", instead="test_step_derivatives_against_differences")
def test_derivative_with_respect_to_the_body() -> None:
    """The mass tensor and the time step are differentiable numbers."""
    J, r = np.array(PROBLEMS[0].system.mass_tensor), np.array([0.5, -0.3])

    def energy_after(tensor: np.ndarray, h: float) -> np.ndarray:
        return nh.step(nh.discretize(nh.SuslovTop(tensor), h), r).momentum.sum()

    twist = np.zeros((3, 3))
    twist[0, 2] = twist[2, 0] = 1e-5
    with jax.enable_x64(True):
        by_tensor, by_step = jax.jit(jax.grad(energy_after, argnums=(0, 1)))(jnp.asarray(J), jnp.asarray(0.2))
    difference = (energy_after(J + twist, 0.2) - energy_after(J - twist, 0.2)) / 2e-5
    assert by_tensor[0, 2] + by_tensor[2, 0] == pytest.approx(difference, rel=1e-6)
    difference = (energy_after(J, 0.2 + 1e-5) - energy_after(J, 0.2 - 1e-5)) / 2e-5
    assert by_step == pytest.approx(difference, rel=1e-6)


def test_step_outcomes() -> None:
    """Off the locus, beyond the fold and in 32 bits: outcomes are data, precision is an error with its remedy."""
    discrete = nh.discretize(PROBLEMS[0].system, 0.2)
    on_locus = nh.simulate(discrete, restricted_velocity=(0.9, -0.4), steps=1).momentum[0]
    off = nh.step(discrete, on_locus + np.array([0.0, 0.0, 0.3]))
    assert off.outcome == nh.Outcome.off_momentum_locus
    assert np.isnan(off.momentum).all()
    assert nh.step(discrete, 1e3 * on_locus).outcome == nh.Outcome.no_real_branch
    with pytest.raises(TypeError, match=r"64 bits. Got float32.*allow_float32"):
        jax.jit(lambda r: nh.step(discrete, r))(np.ones(2))
    with nh.allow_float32():
        single = jax.jit(lambda r: nh.step(discrete, r))(discrete.system.restrict(on_locus))
    assert np.abs(single.momentum - nh.step(discrete, on_locus).momentum).max() < 1e-5


def test_definition_refuses_beyond_the_fold_like_the_closed_form() -> None:
    """At 200 random momenta around the fold the definition never accepts what the closed form rejects."""
    rng, discrete = np.random.default_rng(5), nh.discretize(PROBLEMS[0].system, 1.0)
    momenta = rng.normal(size=(200, 2)) * 2.0
    solve = jax.jit(jax.vmap(lambda r: principal_displacement(discrete, r, discrete.system.group.identity)))
    charts, codes = in_double(solve, momenta)
    accepted = 0
    for r, y, code in zip(momenta, charts, codes, strict=True):
        orbit = nh.simulate(discrete, momentum=r, steps=1, throw=False)
        if code == 0:
            accepted += 1
            assert len(orbit)
            assert np.abs(orbit.chart[0] - y).max() < 1e-10
    assert 50 < accepted < 150


_ANGLES = np.random.default_rng(7)
_CLOSE = 1e-11  # relative: two routes in 20 steps of bodies of ordinary shape


_tensor = functools.partial(tensor, rng=_ANGLES)
_elsewhere = functools.partial(elsewhere, rng=_ANGLES)


SYSTEMS = {
    "top": _elsewhere(nh.SuslovTop(_tensor(3))),
    "balanced top": _elsewhere(nh.SuslovTop(np.diag([1.0, 2.0, 3.0]))),
    "flat top": _elsewhere(nh.SuslovTop([[1.0, 0.2, 0.0], [0.2, 2.0, 0.0], [0.0, 0.0, 0.0]])),
    "plane sleigh": _elsewhere(nh.ChaplyginSleigh(1.3, 0.7, 0.5, b=0.3)),
    "backward sleigh": _elsewhere(nh.ChaplyginSleigh(1.3, 0.7, -0.5)),
    "balanced sleigh": _elsewhere(nh.ChaplyginSleigh(1.3, 0.7, 0.0, b=0.3)),
    "top on SO(4)": _elsewhere(nh.SuslovTop(_tensor(4))),
    "top on SO(6)": _elsewhere(nh.SuslovTop(_tensor(6))),
    "sleigh on SE(3)": _elsewhere(nh.MultidimensionalSleigh(1.3, [0.4, 0.2, -0.1], _tensor(3))),
    "balanced sleigh on SE(4)": _elsewhere(nh.MultidimensionalSleigh(1.3, [0.0, 0.3, 0.1, -0.2], _tensor(4))),
}
ROUTES = {name: "scalar" if system.rank == 2 else "secular" for name, system in SYSTEMS.items()}


def _start(system: Any) -> np.ndarray:
    r = np.random.default_rng(1).normal(size=system.rank)
    return r / np.sqrt(system.constrained_energy(r))


def _run(system: Any, wanted: str | None = None, steps: int = 20, order: int = 2, **options: Any) -> nh.Orbit:
    discrete = dataclasses.replace(nh.discretize(system, 0.2, order=order), wanted_route=wanted)
    pose = system.group.exp(np.random.default_rng(2).normal(size=system.group.dim))
    return nh.simulate(discrete, momentum=_start(system), configuration=pose, steps=steps, **options)


def _check_same(one: nh.Orbit, other: nh.Orbit, *more: str) -> None:
    names = ("reduced_momentum", "cayley", "configuration", "momentum", "displacement", "body_velocity", "energy")
    for name in (*names, *more):
        result, expected = getattr(one, name), getattr(other, name)
        assert np.abs(result - expected).max() <= _CLOSE * max(1.0, np.abs(expected).max()), name


@pytest.mark.parametrize("name", SYSTEMS)
def test_a_system_takes_the_route_of_its_normal_form(name: str) -> None:
    """An `LLSystem` that is a top or a sleigh runs as one, with what the general route makes of it."""
    orbit, expected = _run(SYSTEMS[name]), _run(SYSTEMS[name], "matrix")
    assert (orbit.motion.route.name, expected.motion.route.name) == (ROUTES[name], "matrix")
    _check_same(orbit, expected, "multipliers")
    invariants = nh.invariants(orbit)
    assert invariants.energy_drift < 1e-13
    assert invariants.reversal_defect < 1e-11


@pytest.mark.profile("routes", keep=["top", "plane sleigh"])
@pytest.mark.parametrize("name", SYSTEMS)
def test_compositions_take_the_same_route(name: str) -> None:
    """Compositions take it, too."""
    orbit, expected = _run(SYSTEMS[name], order=4), _run(SYSTEMS[name], "matrix", order=4)
    assert orbit.motion.route.name == ROUTES[name]
    _check_same(orbit, expected)


@pytest.mark.parametrize("name", ["top", "plane sleigh", "top on SO(4)", "sleigh on SE(3)"])
def test_events_within_steps(name: str) -> None:
    """What is reached within a step is that of the general route, in poses of the user's frame."""
    middle = np.median(_run(SYSTEMS[name], steps=60).configuration[:, 0, 0])
    events = [lambda orbit: orbit.configuration[:, 0, 0] - middle]
    one, other = (_run(SYSTEMS[name], wanted, events=events, steps=60) for wanted in (None, "matrix"))
    result, expected = one.events[0], other.events[0]
    assert len(result) > 0
    assert np.allclose(result.time, expected.time, rtol=0, atol=1e-9)
    assert np.allclose(result.states.configuration, expected.states.configuration, rtol=0, atol=1e-9)


def test_a_sleigh_without_a_moment_about_its_center_goes_by_matrices() -> None:
    """A point mass ahead of the blade may move, but is no body of the closed form, which divides by J."""
    point = np.array([0.5, 0.0, 1.0])
    system = nh.LLSystem(nh.SE(2), np.outer(point, point), annihilator=[[0.0, 0.0, 1.0]])
    discrete = nh.discretize(system, 0.1)
    assert system.normal_form is not None
    assert discrete.route.name == "matrix"
    assert np.ptp(nh.simulate(discrete, momentum=(0.1, 0.3), steps=50).energy) < 1e-14


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ({}, "scalar"),
        ({"constraint": "exponential"}, "scalar"),
        ({"constraint": "naive"}, "definition"),
        ({"difference": "logarithmic"}, "definition"),
        ({"order": 4}, "scalar"),
        ({"difference": "logarithmic", "order": 4}, "definition"),
    ],
)
def test_which_route(options: dict[str, Any], expected: str) -> None:
    """The first route that computes what is asked for, made once; one that a store names where the system has it."""
    discrete = nh.discretize(nh.SuslovTop(np.diag([1.0, 2.0, 3.0])), 0.1, **options)
    assert discrete.route.name == expected
    assert discrete.route is discrete.route
    assert (discrete.route.compiled_route is None) == (expected == "definition")
    if not options:
        wanted = {"secular": "matrix", "matrix": "matrix", "x": "definition"}
        assert {name: make_route(discrete, name).name for name in wanted} == wanted
