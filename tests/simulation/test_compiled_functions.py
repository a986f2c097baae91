"""Forces and potentials that numba compiled: the same motions as of Python functions and of the definition."""

import math
import sys
from collections.abc import Callable
from typing import Any

import numba
import numpy as np
import pytest
from bodies import GENERAL, weight
from comparisons import assert_same
from problems import EVERY
from simulation.forces import TOP

import nonholo as nh
from nonholo.base.numerics import applied
from nonholo.systems import AbstractSystem

SYSTEMS: dict[str, AbstractSystem] = {
    "top": TOP,
    "tilted top": nh.SuslovTop.from_inertia(np.diag([2.0, 3.0, 4.0]), (0.6, 0.8, 0)),
    "sleigh": nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.3),
    "suslov 4": GENERAL["suslov 4"][0],
    "any d on SE(3)": GENERAL["any d on SE(3)"][0],
}
START = [0.5, -0.3, 0.4, 0.2]


def _drive(time: float, g: np.ndarray, w: np.ndarray) -> np.ndarray:
    """A force of time, pose and velocity."""
    force = -0.4 * w * w[0] - 0.2 * w + 0.3 * g[0, 1]
    force[0] += math.cos(3 * time)
    return force


def _push(time: float, g: np.ndarray, w: np.ndarray) -> np.ndarray:
    """A force that does not depend on the velocity."""
    return 0.0 * w + math.cos(3 * time) * g[0, 0]


def _well(g: np.ndarray) -> float:
    """A potential."""
    off = g[0, 1] - 0.3
    return 0.5 * off * off + math.sin(g[1, 0]) + 0.2 * g[1, 2]


DRIVE, PUSH, WELL = numba.njit(_drive), numba.njit(_push), numba.njit(_well)


def _table(system: AbstractSystem) -> np.ndarray:
    return np.random.default_rng(3).normal(size=(12, system.group.dim))


KINDS: dict[str, Callable[[AbstractSystem], tuple[Any, Any]]] = {
    "push": lambda _: (None, _push),
    "weight and drive": lambda system: (weight(system), _drive),
    "well and drive": lambda _: (_well, _drive),
    "well": lambda _: (_well, None),
    "well and friction": lambda system: (_well, nh.Friction(np.linspace(0.1, 0.4, system.group.dim))),
    "well, drive and friction": lambda system: (_well, (_drive, nh.Friction(np.linspace(0.1, 0.4, system.group.dim)))),
    "all three": lambda system: (weight(system), (_table(system), nh.Friction(np.eye(system.group.dim)), _drive)),
    "well and table": lambda system: (_well, _table(system)),
}


def _compiled(function: Any) -> Any:
    if isinstance(function, tuple):
        return tuple(map(_compiled, function))
    return {_drive: DRIVE, _push: PUSH, _well: WELL}[function] if callable(function) else function


@pytest.mark.profile("routes", keep=["top-all three", "top-well and drive"])
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", SYSTEMS)
def test_compiled_functions_have_the_bits_of_python(name: str, kind: str) -> None:
    """A compiled function has the bits of the same one in Python, whose definition is in test_energy_scheme."""
    system, result = SYSTEMS[name], []
    g = system.group.random(np.random.default_rng(5))
    start: dict[str, Any] = {"restricted_velocity": START[: system.rank], "configuration": g}
    for functions in (lambda f: f, _compiled):
        forced = nh.Forced(system, *map(functions, KINDS[kind](system)))
        discrete = nh.discretize(forced, 0.05)
        result.append(nh.simulate(discrete, **start, steps=12))
        thin = nh.simulate(discrete, **start, steps=11, save_every=3)
        assert_same(result[-1][:12:3], thin)
    assert discrete.route.compiled_route is not None
    assert_same(*result)


def test_events_are_found_under_a_compiled_potential() -> None:
    """A part of a step is the step of that length, under a potential and under a force of the time."""
    event = nh.Event(lambda states: states.configuration[:, 0, 0] - 0.95)
    run: dict[str, Any] = {"restricted_velocity": START[:2], "steps": 60, "events": [event]}
    for forced in (nh.Forced(TOP, WELL), nh.Forced(TOP, WELL, PUSH)):
        result = nh.simulate(nh.discretize(forced, 0.05), **run).events[0]
        assert len(result) > 0
        assert np.abs(result.states.configuration[:, 0, 0] - 0.95).max() < 1e-14


@numba.njit
def _short(time: float, g: np.ndarray, w: np.ndarray) -> Any:
    return time * g[0, :2] + w[:2]


@numba.njit
def _ending(time: float, g: np.ndarray, w: np.ndarray) -> Any:
    return g[2] * w + (math.nan if time > 0.25 else 0.0)


@numba.njit
def _jumping(time: float, g: np.ndarray, w: np.ndarray) -> Any:
    return -1e4 * np.sign(w - 0.01) if time > 0.25 else 0.0 * g[2]


@numba.njit
def _raising(time: float, g: np.ndarray, w: np.ndarray) -> Any:
    if time > 0.25:
        raise ValueError("too late")
    return g[2] * w


FAILING = {"nonfinite": _ending, "no_half_impulse": _jumping, "raises": _raising}


@pytest.mark.profile("routes", keep=["raises-numba", "*-python"])
@pytest.mark.parametrize("way", ["numba", "python"])
@pytest.mark.parametrize("name", FAILING)
def test_functions_that_fail(name: str, way: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """What ends a run has a name of its own, with the states before; what a compiled function raises is printed."""
    printed: list[str] = []
    monkeypatch.setattr(sys, "unraisablehook", lambda raised: printed.append(str(raised.exc_value)))
    force, start = FAILING[name], {"restricted_velocity": START[:2], "steps": 9}
    discrete = nh.discretize(nh.Forced(TOP, force=force if way == "numba" else force.py_func), 0.1)
    if (name, way) == ("raises", "python"):
        with pytest.raises(ValueError, match="too late"):
            nh.simulate(discrete, **start)
        return
    outcome = "nonfinite" if name == "raises" else name
    run = nh.simulate(discrete, **start, throw=False)
    assert (str(run.outcome), len(run)) == (outcome, 3)
    assert printed == ["too late"] * (name == "raises")
    with pytest.raises(nh.OutcomeError, match=outcome):
        nh.simulate(discrete, **start)


def test_a_compiled_function_of_another_size_is_refused() -> None:
    """It is asked before the run, since compiled code does not see how many numbers it returns."""
    with pytest.raises(ValueError, match="return 3 real numbers"):
        nh.simulate(nh.discretize(nh.Forced(TOP, force=_short), 0.1), restricted_velocity=START[:2], steps=9)


def _drag(time: float, g: np.ndarray, w: np.ndarray) -> Any:
    return 0.0 * time * g[0, 0], -0.5 * w[1] * abs(w[1]), 0.0


def _gust(time: float, g: np.ndarray, w: np.ndarray) -> Any:
    return 0.0 * g[0, 0], (0.96 if time == 0 else 0.0) * w[1] * w[1], 0.0


@pytest.mark.profile("routes", cases=["in space-*"])
@pytest.mark.parametrize("way", ["in the body-numba", "in the body-python", "in space-python"])
def test_half_impulses_that_exist_are_found(way: str) -> None:
    """Half an impulse of drag turns u into x with u - x = a (u + x)^2, a = h/16 here, whatever the step.

    A step without a constraint that acts is two of them from node to node: the positive root of
    a x^2 + (1 + 2 a u) x + a u^2 - u = 0, twice. The explicit impulse reverses the velocity.
    """
    system: AbstractSystem = nh.ChaplyginSleigh(1.0, 1.0, 0.0)
    if "space" in way:
        system = nh.LRSystem(nh.SE(2), system.homogeneous_mass_tensor, np.eye(3)[:2])
    force, h, reference = numba.njit(_drag) if "numba" in way else _drag, 0.8, [8.0]
    a = 0.5 * h / 2 / 4
    for _ in range(2):
        u = reference[-1]
        for _ in range(2):
            b = 1 + 2 * a * u
            u = (math.sqrt(b * b - 4 * a * (a * u * u - u)) - b) / (2 * a)
        reference.append(u)
    kicked = nh.discretize(nh.Forced(system, force=force, scheme="variational"), h)
    orbit = nh.simulate(kicked, body_velocity=(0.0, 8.0, 0.0), steps=2)
    assert np.abs(orbit.body_velocity[:, 1] - reference).max() < 1e-12
    assert np.allclose(reference, [8.0, 1.6396, 0.9837], atol=1e-4)


@pytest.mark.parametrize("strength", [1.0, 1.05])
def test_half_impulses_near_their_limit(strength: float) -> None:
    """A push 0.96 w^2 over half a unit of time from w: x = w + 0.48 ((w + x) / 2)^2 has roots up to w = 25 / 24."""
    sleigh = nh.ChaplyginSleigh(1.0, 1.0, 0.0)
    run: dict[str, Any] = {"body_velocity": (0.0, strength, 0.0), "steps": 1, "throw": False}
    orbit = nh.simulate(nh.discretize(nh.Forced(sleigh, force=_gust, scheme="variational"), 1.0), **run)
    if strength > 25 / 24:
        assert orbit.outcome == nh.Outcome.no_half_impulse
        assert "tolerances" not in orbit.outcome.message
    else:
        middle = (1 - math.sqrt(1 - 2 * 0.48 * strength)) / 0.48
        assert abs(orbit.body_velocity[1, 1] - (2 * middle - strength)) < 1e-11  # slopes near a fold: 1e-12 / 0.2


DECODED = "restricted_momentum", "momentum", "body_velocity", "configuration", "pose", "energy", "spatial_momentum"


@pytest.mark.parametrize("k", [1, 2, 3, 7, 16, 33, 150])
def test_products_of_a_row_are_those_of_many(k: int) -> None:
    """However many rows there are, of whatever layout, each has the bits that it has alone."""
    rng = np.random.default_rng(k)
    matrix, rows = rng.normal(size=(k + 1, k)), rng.normal(size=(37, k))
    alone = np.concatenate([applied(matrix, row[None]) for row in rows])
    spread = np.zeros((37, 2 * k))
    spread[:, ::2] = rows
    for many in (rows, np.asfortranarray(rows), spread[:, ::2], rows[None], np.repeat(rows, 2, axis=0)[::2]):
        assert np.array_equal(applied(matrix, many).reshape(alone.shape), alone)
    assert np.array_equal(applied(np.tile(matrix, (37, 1, 1)), rows), alone)
    assert np.array_equal(applied(np.asfortranarray(matrix), rows), alone)
    assert np.allclose(alone, rows @ matrix.T, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("name", ["tilted top", "sleigh", "offset sleigh", "suslov 6", "sleigh 3", "any d on SO(4)"])
def test_states_are_read_alone_as_in_company(name: str) -> None:
    """Each state of an orbit or a flow decodes to the same bits alone and among all others."""
    body = EVERY[name]
    start: Any = {"restricted_velocity": np.random.default_rng(7).normal(size=body.rank) / 3}
    flow = nh.flow(body, times=np.linspace(0.0, 2.0, 9), **start)
    for orbit in (nh.simulate(nh.discretize(body, 0.1), steps=8, **start), flow):
        for what in (*DECODED, *(("chart", "displacement") if orbit.is_discrete else ("multipliers",))):
            alone = np.concatenate([getattr(orbit[k : k + 1], what) for k in range(len(orbit))])
            assert np.array_equal(alone, getattr(orbit, what)), what
