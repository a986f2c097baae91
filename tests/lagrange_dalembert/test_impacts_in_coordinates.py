"""Impacts in coordinates: the reflection against the impulses of wall and constraint, and motions that are known."""

import dataclasses
import pathlib
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import xarray
from refusals import refusals

import nonholo as nh

MASSES = np.array([2.0, 0.7])
PARTICLE = nh.LagrangeDAlembert(lambda _, v: jnp.asarray(MASSES) @ v**2 / 2, None, dimension=2)
flow: Any = nh.flow
simulate: Any = nh.simulate
TENSOR = np.diag([0.5, 0.4, 1.0])
SPEED = np.array([0.73, 0.31])
FALL = nh.LagrangeDAlembert(lambda q, v: v @ v / 2 - q[1], None, dimension=2)
FLOOR = nh.Event(lambda states: states.configuration[:, 1], name="floor", reset=nh.Impact(restitution=0.8))
DISK = nh.examples.rolling_disk()
ROLLING = {"configuration": DISK.configuration, "body_velocity": DISK.body_velocity}
ACROSS = nh.Event(lambda states: 0.5 - states.configuration[:, 0], name="wall", reset=nh.Impact((-1.0, 0.0, 0.0, 0.0)))


def box(**impact: Any) -> list[nh.Event]:
    """A square of side 2 about the origin."""
    sides = [(axis, sign) for axis in (0, 1) for sign in (1.0, -1.0)]
    return [
        nh.Event(
            lambda states, axis=axis, sign=sign: 1 - sign * states.configuration[:, axis],
            name=f"side{axis}{'pm'[sign < 0]}",
            reset=nh.Impact(**impact),
        )
        for axis, sign in sides
    ]


def folded(way: np.ndarray) -> np.ndarray:
    """Where a point is that has gone a way from the origin, to and fro between -1 and 1."""
    return 1 - abs((way + 1) % 4 - 2)


def curved(q, v):  # noqa: ANN001, ANN201
    """Return a Lagrangian with a mass of the place, a gyroscopic term and a potential."""
    return (1 + q[0] ** 2 / 4) * (v @ jnp.diag(jnp.array([1.0, 2.0, 0.5])) @ v) / 2 + q[0] * v[1] - q @ q / 2


SYSTEMS: dict[str, Any] = {
    "contact": nh.LagrangeDAlembert(curved, lambda q: jnp.array([[-q[1], 0.0, 1.0]]), dimension=3),
    "driven": nh.LagrangeDAlembert(
        curved,
        lambda q: jnp.array([[-q[1], 0.0, 1.0]]),
        dimension=3,
        constraint_velocities=lambda q, t: jnp.array([jnp.cos(t) + q[0]]),
    ),
    "on a sphere": nh.LagrangeDAlembert(curved, None, dimension=3, holonomic=lambda q: jnp.array([q @ q - 1.5])),
    "on a group": nh.GroupLagrangeDAlembert(
        nh.SE(2), nh.mass_tensor_lagrangian(nh.SE(2), TENSOR), lambda g: jnp.array([[0.3 * g[0, 2], 0.2, 1.0]])
    ),
}


@pytest.mark.profile("routes", keep=["contact-*"])
@pytest.mark.parametrize("bounce", [1.0, 0.4])
@pytest.mark.parametrize("name", SYSTEMS)
def test_reflection_is_that_of_the_impulses(name: str, bounce: float) -> None:
    """That of impulses of wall and constraint: M(w' - w) = jn + A'l, Aw' = Aw, nw' = -e nw."""
    system, rng = SYSTEMS[name], np.random.default_rng(3)
    place = nh.SE(2).exp([0.3, 0.5, -0.2]) if name == "on a group" else np.array([0.3, 0.5, -0.2])
    start = {"configuration": place, "body_velocity": [0.4, 0.9, 0.7], "project": True}
    flowed = flow(system, times=(0.0, 0.1), **start)
    stepped = simulate(nh.discretize(system, 0.05), steps=2, **start)
    for orbit in (flowed.chosen(slice(1, 2)), stepped.chosen(slice(1, 2))):
        n, p = rng.normal(size=3), orbit.momentum[0]
        with jax.enable_x64(True):
            q = jnp.asarray(orbit.configuration[0])
            if name == "on a group":
                mass = nh.RigidBody(TENSOR, nh.SE(2)).inertia_operator
                A, drift = np.asarray(system.constraint_forms(q)), np.zeros(3)
            else:
                mass = np.asarray(jax.hessian(curved, argnums=1)(q, jnp.zeros(3)))
                drift = np.asarray(jax.grad(curved, argnums=1)(q, jnp.zeros(3)))
                A = np.asarray(system.constraint_forms(q) if system.holonomic is None else 2 * q[None])
        moving = np.cos(orbit.time) + np.asarray(q[:1]) if name == "driven" else np.zeros(1)
        border = np.block([[mass, -A.T], [A, np.zeros((1, 1))]])
        w = np.linalg.solve(border, [*(p - drift), *moving])[:3]
        whole = np.block([[mass, -n[:, None], -A.T], [A, np.zeros((1, 2))], [n[None], np.zeros((1, 2))]])
        wanted = np.linalg.solve(whole, [*(mass @ w), *moving, -bounce * (n @ w)])[:3]
        after = nh.Impact(lambda _: n, bounce).struck("", None, orbit, int(np.sign(n @ w)))  # noqa: B023
        assert np.abs(after.body_velocity[0] - wanted).max() < 1e-13 * np.linalg.cond(whole)
        assert np.abs(np.linalg.solve(border, [*(after.momentum[0] - drift), *moving])[:3] - wanted).max() < 1e-13
        if bounce == 1 and name != "driven":
            assert abs(wanted @ mass @ wanted / (w @ mass @ w) - 1) < 1e-13


@pytest.mark.profile("routes", instead="test_normals_of_all_kinds_are_one")
def test_normals_of_all_kinds_are_one() -> None:
    """The derivative by differences is that of numbers and of a function, in coordinates and on a group."""
    state = simulate(nh.discretize(SYSTEMS["contact"], 0.1), steps=2, configuration=(0.3, 0.5, -0.2),
                        body_velocity=(0.2, 0.9, 0.1)).chosen(slice(1, 2))  # fmt: skip
    n = np.array([0.3, -1.0, 0.2])
    kinds = nh.Impact(n), nh.Impact(lambda _: n), nh.Impact()
    for kind in kinds:
        assert np.abs(kind.covector(lambda states: states.configuration @ n, state) - n).max() < 1e-12
    orbit = simulate(nh.discretize(SYSTEMS["on a group"], 0.1), steps=2, body_velocity=(0.4, 0.9, -0.18))
    plane = nh.Impact((0.3, 1.0), point=(0.2, 0.5))
    gap = lambda states: states.configuration @ [0.2, 0.5, 1.0] @ [0.3, 1.0, 0]  # noqa: E731
    state = orbit.chosen(slice(1, 2))
    assert np.abs(plane.covector(gap, state) - nh.Impact().covector(gap, state)).max() < 1e-12


def test_a_particle_goes_to_and_fro() -> None:
    """Between four walls, whatever its masses, a particle is where the folded straight line is, in maps and flows."""
    run = {"configuration": np.zeros(2), "body_velocity": SPEED, "events": box()}
    flown = flow(PARTICLE, times=np.linspace(0, 30, 61), **run)
    orbit = simulate(nh.discretize(PARTICLE, 0.1), steps=300, **run)
    for states in (orbit, flown, flown.at(np.linspace(1, 29, 8))):
        assert np.abs(states.configuration - folded(states.time[:, None] * SPEED)).max() < 1e-13
        assert np.abs(states.energy / orbit.energy[0] - 1).max() < 1e-14
    for hits in (orbit.events["side0p"], flown.events["side0p"]):
        assert np.abs(hits.time - (1 + 4 * np.arange(6)) / SPEED[0]).max() < 1e-13
        assert np.abs(hits.after.body_velocity - hits.states.body_velocity * [-1, 1]).max() < 1e-14


def rolled(times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where a disk is that rolls from (0, 0) with speed 1 and turns by 1/2, and when it hits the wall x = 1/2."""
    first = np.arcsin(0.25)  # x is 2 sin(t / 2), and beyond the wall its mirror image
    hits = 2 * np.array([first, np.pi - first, 2 * np.pi + first])
    begins = np.append(0.0, hits)
    ends = np.clip(times[:, None], begins, np.append(hits, np.inf))  # of the arcs, to and fro
    y = 2 * (np.cos(begins / 2) - np.cos(ends / 2)) @ (-1.0) ** np.arange(4)
    return np.stack([0.5 - np.abs(0.5 - 2 * np.sin(times / 2)), y], axis=1), hits


@pytest.mark.profile("routes", instead="test_a_particle_goes_to_and_fro")
def test_a_disk_rolls_back_from_a_wall() -> None:
    """The wall turns the rolling around, and leaves the turning: arcs of circles, on the other side after each hit."""
    times = np.linspace(0, 15, 31)
    wanted, hits = rolled(times)
    flown = flow(DISK.system, times=times, events=[ACROSS], **ROLLING)
    assert np.abs(flown.events["wall"].time - hits).max() < 1e-12
    assert np.abs(flown.configuration[:, :2] - wanted).max() < 1e-12
    assert np.array_equal(np.sign(flown.body_velocity[:, 2]), (-1.0) ** np.searchsorted(hits, times))
    errors = []
    for step in (0.1, 0.05):
        orbit = simulate(nh.discretize(DISK.system, step), steps=round(15 / step), events=[ACROSS], **ROLLING)
        errors.append(np.abs(orbit.configuration[:: round(0.5 / step), :2] - wanted).max())
        assert np.abs(orbit.energy / orbit.energy[0] - 1).max() < 1e-14
        assert np.abs(orbit.body_velocity[:, 3] - 0.5).max() < 1e-14
        assert orbit.constraint_residual.max() < 1e-14
        assert np.array_equal(np.isnan(orbit.multipliers[:, 0]), orbit.has_impacts[:-1])
        assert orbit.has_impacts.sum() == 3
    assert 3.8 < errors[0] / errors[1] < 4.2


def test_a_ball_bounces_lower_and_lower() -> None:
    """The times of impacts of a falling point are a geometric series."""
    start = {"configuration": (0.0, 1.0), "body_velocity": (1.0, 0.0)}
    wanted = np.sqrt(2) * (1 + 2 * np.cumsum([0.0, *0.8 ** np.arange(1, 5)]))
    orbit = flow(FALL, times=np.linspace(0, 8.5, 30), events=[FLOOR], **start)
    assert np.abs(orbit.events["floor"].time - wanted).max() < 1e-12
    run = simulate(nh.discretize(FALL, 0.05), steps=170, events=[FLOOR], **start)
    assert np.abs(run.events["floor"].time - wanted).max() < 1e-12  # a parabola is the map's own


@pytest.mark.profile("problems", keep=["0.02"])
@pytest.mark.parametrize("bounce", [0.02, 0.2])
def test_chattering_ends_where_no_time_passes(bounce: float) -> None:
    """At a floor at zero bounces are not lost in rounding: the run ends with one that takes no time, as on groups."""
    limit = np.sqrt(2) * (1 + 2 * bounce / (1 - bounce))
    floor = dataclasses.replace(FLOOR, reset=nh.Impact(None, bounce))
    start: dict[str, Any] = {"configuration": (0.0, 1.0), "body_velocity": (1.0, 0.0), "events": [floor]}
    orbit = simulate(nh.discretize(FALL, 0.05), steps=1000, throw=False, **start)
    assert orbit.outcome == nh.Outcome.lasting_contact
    assert limit - 0.05 <= orbit.time[-1] <= limit
    assert len(orbit.events["floor"]) < 30
    if bounce > 0.1:
        with pytest.raises(nh.OutcomeError, match="lasting_contact") as failure:
            flow(FALL, times=(0.0, 3.0), **start)
        assert len(failure.value.orbit.events["floor"]) < 30  # type: ignore[attr-defined]


def test_thinned_iterated_and_stored_runs_have_the_same_bits(tmp_path: pathlib.Path) -> None:
    """Whatever is kept and wherever, states, events and the states after them are the same."""
    discrete = nh.discretize(DISK.system, 0.1)
    run: dict[str, Any] = {"steps": 140, "events": [ACROSS], **ROLLING}
    orbit, thin = simulate(discrete, **run), simulate(discrete, save_every=7, **run)
    stored = simulate(discrete, store=tmp_path / "a.zarr", checkpoint_every=25, **run)
    loaded = nh.load_orbit(tmp_path / "a.zarr", discrete=discrete)
    blocks = list(nh.iterate(discrete, block_steps=35, **run))
    assert len(orbit.events["wall"]) == 3
    for impulses in (orbit.to_dataset().multipliers, xarray.open_zarr(tmp_path / "a.zarr").multipliers):
        assert np.array_equal(np.isnan(impulses[:-1, 0]), orbit.has_impacts[:-1])
    for other in (stored, loaded, blocks[0].joined(blocks[1:])):
        for name, rows in orbit.rows().items():
            assert np.array_equal(rows, other.rows()[name], equal_nan=True), name
        for part in ("states", "after"):
            mine, theirs = (getattr(each.events["wall"], part).rows() for each in (orbit, other))
            assert all(np.array_equal(mine[name], theirs[name], equal_nan=True) for name in mine)
    assert np.array_equal(thin.configuration, orbit.configuration[::7])
    assert np.array_equal(thin.events["wall"].after.momentum, orbit.events["wall"].after.momentum)


QUARTIC = nh.LagrangeDAlembert(lambda _, v: v @ v / 2 + jnp.sum(v**4), None, dimension=2)
FAST = nh.LagrangeDAlembert(lambda _, v: -jnp.sqrt(1 - v @ v), None, dimension=2)
SLOW = nh.LagrangeDAlembert(lambda _, v: v @ v / 2 - 1e-12 * jnp.cos(1e5 * v[0]) ** 2, None, dimension=2)
POINT = {"configuration": np.zeros(2), "body_velocity": SPEED}


def bounced(system: Any = PARTICLE, steps: int = 2, events: Any = None) -> Any:
    """Run in a box."""
    return simulate(nh.discretize(system, 0.1), steps=steps, events=box() if events is None else events, **POINT)


# What impacts do not have is refused, with the reason.
test_what_impacts_do_not_have_is_refused = refusals(
    (lambda: bounced(QUARTIC), "Lagrangian quadratic in velocities"),
    (lambda: bounced(FAST), "Lagrangian quadratic in velocities"),
    (lambda: bounced(SLOW), "Lagrangian quadratic in velocities"),
    (lambda: bounced(events=box(normal=(1.0, 0.0, 0.0))), "have a normal of the space"),
    (lambda: bounced(events=box(normal=(-1.0, 0.0), point=(0.1, 0.0))), "and no point"),
    (lambda: bounced(steps=20, events=box(normal=(1.0, 0.0))[:1]), "in whose direction the function grows"),
    (lambda: bounced(events=[nh.Event(lambda s: 1 - s.body_velocity[:, 0], reset=nh.Impact())]), "the pose alone"),
    (lambda: flow(PARTICLE, times=(1.0, 0.0), events=box(), **POINT), "back in time"),
    (lambda: bounced(steps=20).tangent, "have no impacts"),
    (lambda: flow(PARTICLE, times=(0, 3), events=box(), **POINT).tangent, "have no impacts"),
)
