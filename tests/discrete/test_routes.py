"""One route for each discretization: by its normal form, whatever its class; each against the more general ones."""

import dataclasses
import functools
from typing import Any

import numpy as np
import pytest
from bodies import elsewhere, tensor

import nonholo as nh
from nonholo.discrete.routes import make_route

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
        found, expected = getattr(one, name), getattr(other, name)
        assert np.abs(found - expected).max() <= _CLOSE * max(1.0, np.abs(expected).max()), name


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
def test_the_route_against_the_definition(name: str) -> None:
    """The compiled route gives what the definition gives, poses and impulses included."""
    _check_same(_run(SYSTEMS[name], steps=3), _run(SYSTEMS[name], steps=3, backend="jax"), "multipliers")


@pytest.mark.profile("routes", keep=["top", "plane sleigh"])
@pytest.mark.parametrize("name", SYSTEMS)
def test_compositions_take_the_same_route(name: str) -> None:
    """So do compositions."""
    orbit, expected = _run(SYSTEMS[name], order=4), _run(SYSTEMS[name], "matrix", order=4)
    assert orbit.motion.route.name == ROUTES[name]
    _check_same(orbit, expected)


@pytest.mark.parametrize("name", ["top", "plane sleigh", "top on SO(4)", "sleigh on SE(3)"])
def test_events_within_steps(name: str) -> None:
    """What is reached within a step is that of the general route, in poses of the user's frame."""
    middle = np.median(_run(SYSTEMS[name], steps=60).configuration[:, 0, 0])
    events = [lambda orbit: orbit.configuration[:, 0, 0] - middle]
    one, other = (_run(SYSTEMS[name], wanted, events=events, steps=60) for wanted in (None, "matrix"))
    found, expected = one.events[0], other.events[0]
    assert len(found) > 0
    assert np.allclose(found.time, expected.time, rtol=0, atol=1e-9)
    assert np.allclose(found.states.configuration, expected.states.configuration, rtol=0, atol=1e-9)


@pytest.mark.profile("routes", keep=["top", "plane sleigh"])
@pytest.mark.parametrize("name", ["top", "plane sleigh", "balanced sleigh", "top on SO(4)"])
def test_single_steps(name: str) -> None:
    """`step` gives the second state of a run, whichever closed form JAX traces."""
    orbit, discrete = _run(SYSTEMS[name], steps=1), nh.discretize(SYSTEMS[name], 0.2)
    after = nh.step(discrete, _start(SYSTEMS[name]))
    assert np.allclose(after.momentum, orbit.momentum[1], rtol=1e-12, atol=1e-12)
    assert np.allclose(after.displacement, orbit.displacement[1], rtol=1e-12, atol=1e-12)


def test_a_sleigh_without_a_moment_about_its_center_goes_by_matrices() -> None:
    """A point mass ahead of the blade may move, but is no body of the closed form, which divides by J."""
    point = np.array([0.5, 0.0, 1.0])
    system = nh.LLSystem(nh.SE(2), np.outer(point, point), annihilator=[[0.0, 0.0, 1.0]])
    discrete = nh.discretize(system, 0.1)
    assert system.normal_form is not None
    assert discrete.route.name == "matrix"
    orbit = nh.simulate(discrete, momentum=(0.1, 0.3), steps=50)
    assert np.ptp(orbit.energy) < 1e-14


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
