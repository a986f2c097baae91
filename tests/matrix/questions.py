"""What is asked of systems and orbits: equations, steady motions, tangent maps, runs in JAX, fits, controls."""

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from matrix.abilities import Case, ability
from matrix.ready import BODIES, STEADY, TELLING
from scipy.linalg import expm

import nonholo as nh
from nonholo.lagrange_dalembert import checked_state, tangents
from nonholo.systems import alike_in_time

_SIZE = {"rattleback": 3e-5}  # of differences of order 4, along curves of admissible starts; its shape is in cm
_WEIGHTS = {1: 2 / 3, 2: -1 / 12}
_TIME = {-3: -1 / 60, -2: 3 / 20, -1: -3 / 4, 1: 3 / 4, 2: -3 / 20, 3: 1 / 60}


def states(c: Case, orbit: Any) -> np.ndarray:
    """Return the states of an orbit as `nh.vector_field` takes them."""
    rows = orbit.configuration.reshape(len(orbit), -1)
    pair = (rows, orbit.body_velocity) if c.in_coordinates else (orbit.restricted_momentum, rows)
    return np.concatenate(pair, axis=1)


@ability
def vector_field(c: Case, _: Path) -> None:
    """The derivative of a state in the middle of a flow is that of differences of order 6 in time."""
    middle, step = 4 * c.h, 0.1 * c.h
    rows = states(c, c.flown([0.0, *(middle + step * np.arange(-3, 4))]))[1:]
    wanted = sum(weight * rows[3 + k] for k, weight in _TIME.items()) / step
    result = nh.vector_field(c.system)(middle, rows[3])
    np.testing.assert_allclose(result, wanted, 0, 1e-8 * np.abs(wanted).max())


Run = Callable[[dict[str, Any]], Any]


def seen_from(c: Case, reference: Any, orbit: Any) -> np.ndarray:
    """Return places and velocities of an orbit, of bodies momenta; poses are seen from those of a reference."""
    place, velocity = orbit.configuration, orbit.body_velocity if c.in_coordinates else orbit.restricted_momentum
    if place.ndim > 2:
        group = c.system.group
        place = group.log(group.inverse(reference.configuration) @ place)
    return np.concatenate([place, velocity], axis=1)


def moved(c: Case, place: np.ndarray, to: np.ndarray) -> np.ndarray:
    """Return the place beside one."""
    return place + to if place.ndim == 1 else place @ c.system.group.exp(to)


def changes(c: Case, run: Run, start: dict[str, Any], count: int) -> tuple[Any, np.ndarray]:
    """Return a run, and how its states change along curves of starts, (K, m, count)."""
    rng, reference = np.random.default_rng(3), run(start)
    q, v, size = start["configuration"], start["body_velocity"], _SIZE.get(c.name, 3e-4)
    fixed, columns = [i for i, _ in getattr(c.system, "prescribed", ())], []
    for _ in range(count):
        to, w = rng.normal(size=len(q) if q.ndim == 1 else c.system.group.dim), rng.normal(size=len(v))
        to[fixed] = 0.0
        ends = {}
        for k in (-2, -1, 1, 2):
            place = moved(c, q, k * size * to)
            orbit = run({"configuration": place, "body_velocity": v + k * size * w, "project": True})
            ends[k] = seen_from(c, reference, orbit)
        columns.append(sum(weight * (ends[k] - ends[-k]) for k, weight in _WEIGHTS.items()) / size)
    return reference, np.stack(columns, axis=-1)


def names_of(c: Case) -> tuple[str, ...]:
    """Return the names of the rows of changes."""
    if coordinates := getattr(c.system, "coordinates", ()):
        return *coordinates, *(f"{name}'" for name in coordinates)
    k = c.system.group.dim if c.in_coordinates else c.system.rank
    letter = "v" if c.in_coordinates else "r"
    return *(f"xi{i + 1}" for i in range(c.system.group.dim)), *(f"{letter}{i + 1}" for i in range(k))


def chosen(c: Case, result: Any) -> list[int]:
    """Return the rows of changes that are states of a linearization."""
    return [names_of(c).index(name) for name in result.names]


def steady(c: Case) -> Any:
    """Return the ready system in steady motion; one that is driven as it is."""
    return STEADY.get(c.name, c.ready)()


def start_of(ready: Any) -> dict[str, Any]:
    """Return its start."""
    return {name: getattr(ready, name) for name in ("configuration", "body_velocity")}


def flowing(system: Any, *times: float) -> Run:
    """Return what runs the flow to times."""
    return lambda start: nh.flow(system, times=[0.0, *times], **start)


def stepping(discrete: Any, steps: int = 1, **how: Any) -> Run:
    """Return what runs the map."""
    return lambda start: nh.simulate(discrete, steps=steps, **how, **start)


@ability
def linearize(c: Case, _: Path) -> None:
    """Beside a steady motion small changes of runs of the flow go where the exponential of the matrix takes them."""
    ready = steady(c)
    result, time = nh.linearize(ready.system, **start_of(ready)), 2 * c.h
    _, (before, after) = changes(c, flowing(ready.system, time), start_of(ready), 3)
    rows, carried = chosen(c, result), expm(time * result.matrix)
    np.testing.assert_allclose(after[rows], carried @ before[rows], 0, 1e-7 * np.abs(after[rows]).max())


@ability
def linearize_maps(c: Case, _: Path) -> None:
    """Small changes of a step are those of the matrix of the map."""
    ready = steady(c)
    discrete = nh.discretize(ready.system, c.h)
    result = nh.linearize(discrete, **start_of(ready))
    _, (before, after) = changes(c, stepping(discrete), start_of(ready), 3)
    rows = chosen(c, result)
    np.testing.assert_allclose(after[rows], result.matrix @ before[rows], 0, 1e-7 * np.abs(after[rows]).max())


@ability
def equilibria(c: Case, _: Path) -> None:
    """From beside a steady motion one is found at which `vector_field` has no rates, and the map no changes."""
    ready = steady(c)
    start, field = start_of(ready), nh.vector_field(ready.system)
    beside, discrete = _beside(c, ready), nh.discretize(ready.system, c.h)
    for subject in (ready.system, discrete):
        result = nh.equilibria(subject, **beside)
        there, rows = start_of(result), chosen(c, result.linearization)
        assert np.abs(result.configuration - start["configuration"]).max() < 0.2
        orbit, v = stepping(discrete, 2)(there), len(result.body_velocity) if c.in_coordinates else c.system.rank
        rates = np.diff(seen_from(c, orbit, orbit), axis=0) / c.h
        if subject is not discrete:
            rate = field(0.0, states(c, flowing(ready.system, c.h)(there))[0])
            place = rate[:-v] if result.configuration.ndim == 1 else np.zeros(c.system.group.dim)
            rates = np.concatenate([place, rate[-v:] if c.in_coordinates else rate[:v]])[None]
        np.testing.assert_allclose(rates[:, rows], 0, 0, 1e-8)


def _beside(c: Case, ready: Any) -> dict[str, Any]:
    """Return an admissible state next to a start; that itself of a driven system."""
    start, rng = start_of(ready), np.random.default_rng(2)
    if c.name not in STEADY:
        return start
    q = start["configuration"]
    to = 100 / 3 * _SIZE.get(c.name, 3e-4) * (rng.normal(size=len(q)) if q.ndim == 1 else np.eye(c.system.group.dim)[0])
    orbit = flowing(ready.system, c.h)(start | {"configuration": moved(c, q, to), "project": True})
    return {name: getattr(orbit, name)[0] for name in start}


def stretches(c: Case, run: Run) -> tuple[Any, Callable[..., np.ndarray]]:
    """Return a run, and the factors by which it stretches small changes of its start, as a function of their units."""
    start = c.start
    if c.ready is None:
        velocity = start["restricted_velocity"] @ np.asarray(c.system.constraint_subspace)
        start = {"configuration": c.system.group.identity, "body_velocity": velocity}
    reference, rows = changes(c, run, start, len(names_of(c)))
    count = reference.tangent.shape[-1]
    matters = slice(-count if not c.in_coordinates else 0, None)

    def factors(units: Any = 1.0) -> np.ndarray:
        before, after = (rows[k][matters] / np.reshape(units, (-1, 1)) for k in (0, -1))
        return np.linalg.svd(after @ np.linalg.pinv(before, rcond=1e-7), compute_uv=False)[:count]

    return reference, factors


def own_units(c: Case, orbit: Any) -> Any:
    """Return the units of changes in which exponents are measured; of momenta alone none matter to volumes."""
    if not c.in_coordinates:
        return 1.0
    maps, _, units, places = tangents.changes(orbit)
    sizes = alike_in_time(maps, units, places, np.ptp(orbit.time))
    return np.insert(sizes, [i - k for k, (i, _) in enumerate(sorted(getattr(c.system, "prescribed", ())))], 1.0)


@ability
def tangent_maps(c: Case, _: Path) -> None:
    """Their product along a run stretches changes of the start as differences of runs do."""
    _assert_carried(*stretches(c, stepping(c.discrete, 3, **c.run)))


def _assert_carried(orbit: Any, factors: Callable[..., np.ndarray]) -> None:
    product = np.linalg.multi_dot(orbit.tangent[::-1])
    np.testing.assert_allclose(np.linalg.svd(product, compute_uv=False), factors(), 1e-6, 1e-8)


@ability
def lyapunov_exponents(c: Case, _: Path) -> None:
    """Their sum is the rate at which differences of runs say that volumes grow, in units of the body."""
    _assert_grown(c, *stretches(c, stepping(c.discrete, 3, **c.run)))


def _assert_grown(c: Case, orbit: Any, factors: Callable[..., np.ndarray]) -> None:
    growth = nh.lyapunov_exponents(orbit).sum() * orbit.time[-1]
    np.testing.assert_allclose(growth, np.log(factors(own_units(c, orbit))).sum(), 0, 1e-6)


@ability
def rollout(c: Case, _: Path) -> None:
    """It has the numbers of the run."""
    _assert_rolled(nh.rollout(c.discrete, steps=5, **c.start), c.simulated(steps=5))


def _assert_rolled(states: Any, orbit: Any) -> None:
    assert states.outcome == 0
    for name in ("time", "configuration", "momentum", "energy"):
        size = np.abs(getattr(orbit, name)).max()
        np.testing.assert_allclose(getattr(states, name), getattr(orbit, name), 0, 1e-11 * size, err_msg=name)


@ability
def fit(c: Case, folder: Path) -> None:
    """From a record of its motion the numbers of a system are found again."""
    guess, ready = TELLING.get(c.name, {c.kind.parameter: c.kind.values[1]}), c.ready()
    orbit = nh.simulate(nh.discretize(ready.system, c.h), steps=40, **start_of(ready))
    orbit.to_csv(folder / "a.csv")
    system_of, truth = BODIES.get(c.name) or (lambda p: ready.system.with_parameters(**p), ready.system.parameters)
    result = nh.fit(system_of, folder / "a.csv", guess, time_step=c.h)
    for name in guess:
        np.testing.assert_allclose(result.parameters[name], truth[name], 1e-6, err_msg=name)


def controlled(c: Case) -> dict[str, Any]:
    """Return the start as what finds controls takes it, of bodies with their velocity along the constraint."""
    if c.in_coordinates:
        return c.start
    velocity = c.system.restricted_velocity(c.orbit.restricted_momentum[0])
    return {"configuration": c.start.get("configuration", c.system.group.identity), "restricted_velocity": velocity}


@ability
def tracking_feedback(c: Case, _: Path) -> None:
    """A motion that begins beside the reference ends nearer to it under the feedback than without."""
    start, n = controlled(c), c.orbit.body_velocity.shape[1]
    hold = nh.tracking_feedback(
        c.discrete, start, np.zeros((40, n)), final_weight=1e6 if c.name == "rattleback" else 100.0
    )
    beside = {name: 1.02 * value for name, value in start.items() if "velocity" in name}
    if c.in_coordinates:
        is_prescribed = bool(getattr(c.system, "prescribed", ()))
        q = c.rows["configuration"][0] if is_prescribed else start["configuration"]
        velocity = {"body_velocity": start["body_velocity"]} if is_prescribed else beside
        beside = {"configuration": q, "body_velocity": checked_state(c.system, q, velocity, 0.0, project=True)[1]}
    motion, alone = hold.simulate(**beside), nh.simulate(c.discrete, steps=40, **{**start, **beside})
    gaps = [np.abs(x.configuration[-1] - hold.reference.configuration[-1]).max() for x in (motion.orbit, alone)]
    assert gaps[0] < 0.5 * gaps[1]


@ability
def tangent_maps_of_flows(c: Case, _: Path) -> None:
    """Their product stretches changes of the start as differences of flows do, at the rates that exponents sum up."""
    pair = stretches(c, flowing(c.system, c.h, 2 * c.h))
    _assert_carried(*pair)
    _assert_grown(c, *pair)


@ability
def critical_values(c: Case, _: Path) -> None:
    """Beside one, other numbers of small changes of runs grow; where there is none, as many at both ends."""
    ready, interval = steady(c), np.array([-1.3, 2.1])

    def start(speed: float) -> dict[str, Any]:
        speed = 1.0 if "driven" in c.kind.traits else speed
        return {"configuration": ready.configuration, "body_velocity": speed * ready.body_velocity}

    def linear(speed: float) -> Any:
        return nh.linearize(ready.system, **start(speed))

    def growing(speed: float) -> int:
        result = linear(speed)
        _, (before, after) = changes(c, flowing(ready.system, c.h), start(speed), len(result.names))
        rows = chosen(c, result)
        return int((np.abs(np.linalg.eigvals(np.linalg.solve(before[rows].T, after[rows].T))) > 1 + 1e-5).sum())

    result = nh.critical_values(linear, interval, samples=12)
    counts = [growing(speed) for speed in (result[:, None] + [-0.05, 0.05] if len(result) else interval).ravel()]
    assert len(result) == 0 or np.diff(np.reshape(counts, (-1, 2))).all()
    assert len(result) > 0 or counts[0] == counts[1]


def _pull(time: Any, place: Any, velocity: Any) -> Any:
    """Return forces of a time, a place and a velocity."""
    xp = velocity.__array_namespace__()
    return 0.1 * xp.cos(time + place.ravel()[-2] + xp.arange(len(velocity))) - 0.05 * velocity


def under(c: Case, controls: np.ndarray) -> Any:
    """Return a run under forces, one a step; systems by discrete functions have them in rollouts alone."""
    if any(getattr(c.system, name, None) for name in ("discrete_lagrangian", "discrete_constraints")):
        return nh.rollout(c.discrete, steps=len(controls), controls=controls, **c.start)
    forced = dataclasses.replace(c.system, force=controls) if not c.in_coordinates else c.system.forced(None, controls)
    return c.simulated(nh.discretize(forced, c.h), len(controls))


@ability
def policy(c: Case, _: Path) -> None:
    """Its forces are those of the states, and a run under a table of them is the motion."""
    states = nh.rollout(
        c.discrete, steps=5, **c.start, policy=lambda time, at: _pull(time, at.configuration, at.body_velocity)
    )
    assert states.outcome == 0
    if c.in_coordinates:
        v = tangents.node_velocities(c.system, states.time, states.configuration, states.momentum)
    else:
        v = c.system.restricted_velocity(states.restricted_momentum) @ np.asarray(c.system.constraint_subspace)
    wanted = [_pull(*node) for node in zip(states.time, states.configuration, v, strict=True)]
    np.testing.assert_allclose(states.controls[:-1], wanted[:-1], 1e-10, 1e-12)
    q = under(c, states.controls[:-1]).configuration
    np.testing.assert_allclose(states.configuration, q, 0, 1e-11 * np.abs(q).max())


@ability
def steer(c: Case, _: Path) -> None:
    """A run under its forces ends at the goal, one that other forces reach with more effort."""
    steps, n = 12, c.orbit.body_velocity.shape[1]
    reference = 0.1 * np.cos(np.arange(steps)[:, None] + np.arange(n))
    goal = nh.rollout(c.discrete, steps=steps, controls=reference, **controlled(c)).configuration[-1]
    result = nh.steer(c.discrete, controlled(c), {"configuration": goal}, steps=steps)
    assert result.converged
    q = under(c, result.controls).configuration[-1]
    np.testing.assert_allclose(q, goal, 0, 1e-8 * np.abs(goal).max())
    assert result.cost <= c.h * (reference**2).sum() / 2
