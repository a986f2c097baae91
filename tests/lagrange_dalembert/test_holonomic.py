"""Holonomic constraints: kept at every node by the discrete principle, beside minimal coordinates and closed forms."""

from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from comparisons import assert_near
from refusals import refusals
from scipy.special import ellipj, ellipk

import nonholo as nh
from nonholo.base.numerics import double_precision

GRAVITY = 9.81
LENGTHS = {"crank": 0.4, "coupler": 1.0, "rocker": 0.9, "ground": 1.0}
LOOP = (1.0, 0.5, 2.0), (3.0, 0.0, 0.0)  # beside an admissible place and velocity


def fall(q, v):  # noqa: ANN001, ANN201
    """Return the Lagrangian of unit masses, whose heights are the second coordinates of each."""
    return v @ v / 2 - GRAVITY * q[1::2].sum()


def rod(q):  # noqa: ANN001, ANN201
    """Return the constraint of a rod of length one."""
    return jnp.array([q @ q - 1.0])


def rods(q):  # noqa: ANN001, ANN201
    """Return the constraints of two rods, one at the end of the other."""
    return jnp.array([q[:2] @ q[:2] - 1.0, (q[2:] - q[:2]) @ (q[2:] - q[:2]) - 0.64])


def pendulum(rule: str = "midpoint") -> nh.LagrangeDAlembert:
    """Return a pendulum in Cartesian coordinates."""
    return nh.LagrangeDAlembert(fall, None, holonomic=rod, dimension=2, rule=rule)


def double_pendulum(rule: str = "midpoint") -> nh.LagrangeDAlembert:
    """Return two masses on two rods, in Cartesian coordinates."""
    return nh.LagrangeDAlembert(fall, None, holonomic=rods, dimension=4, rule=rule)


def four_bar(**lengths: float) -> nh.LagrangeDAlembert:
    """Return three bars of uniform density with the angles of a closed loop."""

    def lagrangian(q, v, p):  # noqa: ANN001, ANN202
        a, b, c = p["crank"], p["coupler"], p["rocker"]
        along = jnp.stack([jnp.cos(q), jnp.sin(q)], axis=1)
        middle = a * v[0] * along[0] + b / 2 * v[1] * along[1]
        kinetic = a**3 * v[0] ** 2 / 6 + b * (middle @ middle + b**2 * v[1] ** 2 / 12) / 2 + c**3 * v[2] ** 2 / 6
        height = a**2 * along[0, 1] / 2 + b * (a * along[0, 1] + b * along[1, 1] / 2) + c**2 * along[2, 1] / 2
        return kinetic - GRAVITY * height

    def loop(q, p):  # noqa: ANN001, ANN202
        along = jnp.stack([jnp.cos(q), jnp.sin(q)])
        return along @ jnp.stack([p["crank"], p["coupler"], -p["rocker"]]) - jnp.array([p["ground"], 0.0])

    return nh.LagrangeDAlembert(lagrangian, None, holonomic=loop, dimension=3, parameters=LENGTHS | lengths)


def height(x, y):  # noqa: ANN001, ANN201
    """Return the height of an elliptic bowl."""
    return (x**2 + 2 * y**2) / 4


def blade(q):  # noqa: ANN001, ANN201
    """Return the form of a blade along the last coordinate."""
    return jnp.array([[-jnp.sin(q[-1]), jnp.cos(q[-1]), *[0.0] * (len(q) - 2)]])


def sleigh_in_a_bowl() -> nh.LagrangeDAlembert:
    """Return a sleigh on a surface: one holonomic and one nonholonomic row."""
    return nh.LagrangeDAlembert(
        lambda q, v: (v[:3] @ v[:3] + 0.5 * v[3] ** 2) / 2 - GRAVITY * q[2],
        blade,
        holonomic=lambda q: jnp.array([q[2] - height(q[0], q[1])]),
        dimension=4,
    )


SYSTEMS = {
    "double pendulum": (double_pendulum(), (1.0, 0.0, 1.0, 0.8), (0.0, 0.0, 0.0, 0.0), 0.002),
    "four-bar": (four_bar(), *LOOP, 0.002),
    "sleigh in a bowl": (sleigh_in_a_bowl(), (1.0, 0.0, 0.25, 0.3), (0.5, 0.2, 0.0, 1.0), 0.005),
}


def left(system: nh.LagrangeDAlembert, orbit: Any) -> float:
    """Return the largest residual of the holonomic constraints beside the size of the coordinates."""
    with double_precision():
        residual = np.abs(jax.vmap(system.plain.holonomic)(orbit.configuration)).max(axis=1)
    return float((residual / (1 + np.abs(orbit.configuration).max(axis=1))).max())


@pytest.mark.profile("routes", keep=["sleigh in a bowl"])
@pytest.mark.parametrize("name", SYSTEMS)
def test_constraints_of_places_hold_at_every_node(name: str) -> None:
    """After 100,000 steps as after one: a residual is the rounding of the coordinates, and does not gather.

    The energies oscillate: in all steps their largest change is at most twice that in the first tenth.
    """
    system, q, v, h = SYSTEMS[name]
    run: Any = {"configuration": q, "body_velocity": v, "project": True}
    orbit = nh.simulate(nh.discretize(system, h), **run, steps=100_000)
    assert len(orbit) == 100_001
    assert left(system, orbit) <= 1e-15
    change = np.abs(orbit.energy - orbit.energy[0])
    assert change.max() <= 2 * change[:10_000].max() <= 0.05 * np.ptp([q[1] for q in orbit.configuration])


@pytest.mark.profile("routes", keep=["midpoint"])
@pytest.mark.parametrize("rule", ["midpoint", "trapezoidal"])
def test_pendulum_beside_elliptic_functions(rule: str) -> None:
    """Places and forces of the rod have errors of order two: a quarter for half the step, to the next order."""
    k, rate = np.sin(1.0), np.sqrt(GRAVITY)  # swings to an angle of 2

    def errors(steps: int) -> tuple[float, float]:
        run: Any = {"configuration": (np.sin(2.0), -np.cos(2.0)), "body_velocity": (0, 0)}
        orbit = nh.simulate(nh.discretize(pendulum(rule), 2.0 / steps), **run, steps=steps)
        sn, cn, _, _ = ellipj(rate * orbit.time + ellipk(k**2), k**2)
        angle = 2 * np.arcsin(k * sn)
        tension = (2 * rate * k * cn) ** 2 + GRAVITY * np.cos(angle)
        gap = orbit.configuration - np.stack([np.sin(angle), -np.cos(angle)], axis=1)
        return np.abs(gap).max(), np.abs(orbit.multipliers[:-1, 0] * steps + tension[1:-1]).max()

    coarse, fine = errors(400), errors(800)
    assert np.abs(np.divide(coarse, fine) - 4).max() <= 0.05
    assert fine[0] <= 2e-4


def corners(angles):  # noqa: ANN001, ANN201
    """Return the masses of a double pendulum with these angles."""
    first = jnp.array([jnp.sin(angles[0]), -jnp.cos(angles[0])])
    return jnp.concatenate([first, first + 0.8 * jnp.array([jnp.sin(angles[1]), -jnp.cos(angles[1])])])


@pytest.mark.profile("routes", instead="test_pendulum_beside_elliptic_functions")
@pytest.mark.parametrize("rule", ["midpoint", "trapezoidal"])
def test_the_map_is_that_of_the_discrete_lagrangian_on_the_surface(rule: str) -> None:
    """Proposition 15.2: in angles, with the same L_d of the places of the masses, the nodes are the same.

    Over 40 steps a chaotic motion multiplies roundings of 1e-16 by less than 1e4.
    """

    def action(angles, after, h):  # noqa: ANN001, ANN202
        q, v = corners(angles), (corners(after) - corners(angles)) / h
        ends = [fall(q + h * v / 2, v)] if rule == "midpoint" else [fall(q, v), fall(q + h * v, v)]
        return h * sum(ends) / len(ends)

    def lagrangian(angles, rates):  # noqa: ANN001, ANN202
        q, v = jax.jvp(corners, (angles,), (rates,))
        return fall(q, v)

    minimal = nh.LagrangeDAlembert(lagrangian, None, dimension=2, discrete_lagrangian=action)
    angles, rates = np.array([1.5, 2.0]), np.array([0.3, -1.0])
    with double_precision():
        q, v = jax.jvp(corners, (jnp.asarray(angles),), (jnp.asarray(rates),))
    there = nh.simulate(nh.discretize(minimal, 0.02), configuration=angles, body_velocity=rates, steps=40)
    here = nh.simulate(nh.discretize(double_pendulum(rule), 0.02), configuration=q, body_velocity=v, steps=40)
    with double_precision():
        assert np.abs(here.configuration - jax.vmap(corners)(there.configuration)).max() <= 1e-12


def test_with_both_kinds_of_constraints_the_order_is_two() -> None:
    """Beside the flow in coordinates of the surface alone, which has no holonomic constraint."""

    def lagrangian(q, v):  # noqa: ANN001, ANN202
        z, rate = jax.jvp(height, (q[0], q[1]), (v[0], v[1]))
        return (v[:2] @ v[:2] + rate**2 + 0.5 * v[2] ** 2) / 2 - GRAVITY * z

    minimal = nh.LagrangeDAlembert(lagrangian, blade, dimension=3)
    tan = np.tan(0.3)
    exact = nh.flow(minimal, configuration=(1.0, 0.0, 0.3), body_velocity=(0.5, 0.5 * tan, 1.0), times=[0.0, 2.0])
    system, start = sleigh_in_a_bowl(), (1.0, 0.0, 0.25, 0.3)
    run: Any = {"configuration": start, "body_velocity": (0.5, 0.5 * tan, 0.25, 1.0)}
    flow = nh.flow(system, **run, times=np.linspace(0.0, 2.0, 21))
    assert np.abs(flow.configuration[-1, [0, 1, 3]] - exact.configuration[-1]).max() <= 1e-13

    def errors(steps: int) -> tuple[float, float]:
        orbit = nh.simulate(nh.discretize(system, 2.0 / steps), **run, steps=steps)
        forces = orbit.multipliers[steps // 20 - 1 :: steps // 20][:19] * steps / 2
        gap = orbit.configuration[-1, [0, 1, 3]] - exact.configuration[-1]
        return np.abs(gap).max(), np.abs(forces - flow.multipliers[1:20]).max()

    assert np.abs(np.divide(errors(200), errors(400)) - 4).max() <= 0.05


def test_flows_stay_on_the_surface() -> None:
    """For 1000 units of time: at rounding, with a series and, where a formula has a kink, with diffrax."""
    run: Any = {"configuration": (0.6, -0.8), "body_velocity": (4.0, 3.0)}
    series = nh.flow(pendulum(), **run, times=np.linspace(0.0, 1000.0, 101))
    assert left(pendulum(), series) <= 1e-15
    assert series.constraint_residual.max() <= 1e-14
    assert np.ptp(series.energy) <= 1e-8  # of 5: grows with the square of the time
    kinked = nh.LagrangeDAlembert(fall, None, holonomic=lambda q: jnp.array([jnp.abs(q @ q) - 1.0]), dimension=2)
    other = nh.flow(kinked, **run, times=np.linspace(0.0, 10.0, 11))
    assert left(kinked, other) <= 1e-15
    assert np.abs(other.configuration[-1] - nh.flow(pendulum(), **run, times=[0, 10.0]).configuration[-1]).max() < 1e-7


@pytest.mark.profile("routes", instead="test_moving_constraints_and_a_lagrangian_of_time")
def test_a_moving_constraint_is_a_prescribed_coordinate() -> None:
    """q_0 = s(t), as a holonomic constraint or prescribed: one motion, one multiplier, one work."""

    def s(t):  # noqa: ANN001, ANN202
        return 0.5 * jnp.sin(3 * t)

    def lagrangian(q, v):  # noqa: ANN001, ANN202
        return v @ v / 2 + v[0] * v[1] * jnp.cos(q[1]) / 2 + GRAVITY * jnp.cos(q[1])

    one = nh.LagrangeDAlembert(lagrangian, None, dimension=2, prescribed={0: s})
    two = nh.LagrangeDAlembert(lagrangian, None, dimension=2, holonomic=lambda q, time: jnp.array([q[0] - s(time)]))
    run: Any = {"configuration": (0.0, 0.4), "body_velocity": (1.5, 0.2)}
    here, there = (nh.simulate(nh.discretize(each, 0.02), **run, steps=200) for each in (one, two))
    assert_near(here, there, 1e-11, "configuration", "multipliers", "energy", "work")
    here, there = (nh.flow(each, **run, times=np.linspace(0, 4, 9)) for each in (one, two))
    assert np.abs(here.configuration - there.configuration).max() <= 1e-13
    assert np.abs(here.multipliers - there.multipliers).max() <= 1e-12


_SWINGING, _MOVING = nh.discretize(pendulum(), 0.1), lambda q, t: jnp.array([q @ q - 1 - t])
_OFF = r"simulate\(configuration=...\)` must satisfy the holonomic constraints. Got residual \[0.21\]. The near.*1.0"


def _at(*configuration: float, **how: Any) -> Any:
    return nh.simulate(_SWINGING, configuration=configuration, **how, steps=1)


# With the residual and what is admissible beside them: places, and velocities off the surface.
test_starts_that_are_not_admissible_are_refused = refusals(
    (lambda: _at(1.1, 0.0, body_velocity=(0, 0)), _OFF),
    (
        lambda: nh.flow(pendulum(), configuration=(0.0, 0.0), body_velocity=(0, 0), times=[0.0], project=True),
        r"flow\(configuration=...\)` must satisfy the holonomic .* Start elsewhere",
    ),
    (lambda: _at(1.0, 0.0, body_velocity=(0.1, 1)), r"body_velocity=...\)` must satisfy the .* Got residual \[0.2\]"),
    (
        lambda: nh.flow(
            nh.LagrangeDAlembert(fall, None, dimension=2, holonomic=_MOVING),
            configuration=(1.0, 0.0), body_velocity=(0, 1), times=[0.0, 1.0],
        ),
        r"must satisfy the constraint. Got residual \[-1.\]",
    ),
    (lambda: _at(1, 0, displacement=(0, 0.1), project=True), r"project=...\)` must be left out. Got displacement"),
    (lambda: _at(1, 0, body_velocity=(0, 1), project=1), r"simulate\(project=...\)` must be True or False"),
)  # fmt: skip


def test_projections_are_nearest_in_the_kinetic_energy() -> None:
    """M (y - x) and M (w - v) have no part along the surface, far from it, too; admissible starts keep their bits."""
    mass = np.array([[2.0, 0.5], [0.5, 1.0]])
    system = nh.LagrangeDAlembert(lambda q, v: v @ mass @ v / 2 + 0 * q[0], None, holonomic=rod, dimension=2)
    x, v = np.array([1.3, 0.9]), np.array([1.0, 2.0])
    orbit = nh.flow(system, configuration=x, body_velocity=v, project=True, times=[0.0])
    y, w = orbit.configuration[0], orbit.body_velocity[0]
    along = np.array([-y[1], y[0]])
    assert abs(y @ y - 1) <= 4e-16
    assert abs(y @ w) <= 1e-15
    assert abs(along @ mass @ (y - x)) <= 1e-14
    assert abs(along @ mass @ (w - v)) <= 1e-14
    assert (y - x) @ mass @ (y - x) < (x / np.hypot(*x) - x) @ mass @ (x / np.hypot(*x) - x)
    run: Any = {"configuration": (0.6, -0.8), "body_velocity": (0, 0)}
    first, second = (nh.flow(pendulum(), **run, project=project, times=[0, 1]) for project in (False, True))
    assert np.array_equal(first.configuration, second.configuration)


def test_velocities_on_groups_are_projected() -> None:
    """That of a sleigh pushed sideways keeps its momentum along the constraint, in every door alike."""
    sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 0.5, a=0.3), 0.1)
    push = np.array([0.4, 1.0, 0.7])
    along = sleigh.system.constraint_subspace @ (sleigh.system.inertia_operator @ push)
    run: Any = {"body_velocity": push, "project": True}
    orbit = nh.simulate(sleigh, **run, steps=5)
    assert np.abs(orbit.restricted_momentum[0] - along).max() <= 1e-15
    member = nh.ensemble(sleigh, **run | {"body_velocity": push[None]}, steps=5)
    assert np.array_equal(member.restricted_momentum[0, -1], orbit.restricted_momentum[-1])
    assert np.abs(nh.flow(sleigh.system, **run, times=[0.0]).restricted_momentum[0] - along).max() <= 1e-15
    with pytest.raises(ValueError, match="must satisfy the constraint"):
        nh.simulate(sleigh, body_velocity=push, steps=5)


REDUNDANT = {
    "twice": (lambda q: jnp.array([q @ q - 1, q @ q - 1]), "rank 1 of 2 rows"),
    "squared": (lambda q: jnp.array([(q @ q - 1) ** 2]), "rank 0 of 1 rows"),
}


@pytest.mark.parametrize("name", REDUNDANT)
def test_dependent_constraints_are_refused(name: str) -> None:
    """One written twice, and one whose derivative vanishes where it does, by maps and flows, projected or not."""
    function, got = REDUNDANT[name]
    system = nh.LagrangeDAlembert(fall, None, holonomic=function, dimension=2)
    for project in (False, True):
        run: Any = {"configuration": (1.0, 0.0), "body_velocity": (0, 0), "project": project}
        with pytest.raises(ValueError, match=rf"LagrangeDAlembert\(holonomic=...\)` must have independent rows.*{got}"):
            nh.simulate(nh.discretize(system, 0.1), **run, steps=3)
        with pytest.raises(ValueError, match=got):
            nh.flow(system, **run, times=[0.0, 1.0])


def test_more_constraints_than_coordinates_are_refused() -> None:
    """Three rows for two coordinates, of three kinds; two of them determine the motion."""

    def flat(_q):  # noqa: ANN001, ANN202
        return jnp.array([[0.0, 1.0]])

    system = nh.LagrangeDAlembert(fall, None, holonomic=rod, dimension=2, prescribed={0: lambda t: 0.5 * jnp.sin(t)})
    orbit = nh.simulate(nh.discretize(system, 0.1), configuration=(0, -1), body_velocity=(0.5, 0), steps=50)
    assert left(system, orbit) <= 1e-15
    full = nh.LagrangeDAlembert(fall, flat, holonomic=rod, dimension=2, prescribed=dict(system.prescribed))
    with pytest.raises(ValueError, match="rank 2 of 3 rows"):
        nh.simulate(nh.discretize(full, 0.1), configuration=(0, -1), body_velocity=(0.5, 0), steps=1)


def test_a_loop_at_its_dead_point_ends_the_run() -> None:
    """A parallelogram that lies flat may unfold in two ways: not a start; runs and flows end before it, in words."""
    flat = four_bar(crank=0.5, rocker=0.5)
    with pytest.raises(ValueError, match="must have independent rows"):
        nh.simulate(nh.discretize(flat, 0.01), configuration=(0, 0, 0), body_velocity=(1, 0, 1), steps=1)
    run: Any = {"configuration": (1.0, 0.0, 1.0), "body_velocity": (2.0, 0.0, 2.0)}
    orbit = nh.simulate(nh.discretize(flat, 0.01), **run, steps=3000, throw=False)
    assert orbit.outcome in (nh.Outcome.branch_unverified, nh.Outcome.no_real_branch)
    assert len(orbit) < 3000
    assert left(flat, orbit) <= 1e-15
    assert abs(np.sin(orbit.configuration[-1, 0])) < 0.2


# No row, a matrix, more than coordinates, a list, no function.
test_what_is_no_constraint_of_places_is_refused = refusals(
    (lambda q: q @ q - 1.0, r"shape \(\)"),
    (lambda q: jnp.array([[q @ q - 1.0]]), r"shape \(1, 1\)"),
    (lambda q: jnp.array([q @ q - 1.0, q[0], q[1]]), r"shape \(3,\)"),
    (lambda q: [q @ q - 1.0], "TypeError"),
    (3, "3"),
    ask=lambda function: nh.LagrangeDAlembert(fall, None, holonomic=function, dimension=2),
    begin=r"LagrangeDAlembert\(holonomic=...\)` must .*",
)


def test_common_paths(tmp_path: Path) -> None:
    """Parameters, ensembles, events, stores, blocks and derivatives see a loop as any other system."""
    bars = four_bar()
    discrete: Any = nh.discretize(bars, 0.01)
    start: Any = {"configuration": LOOP[0], "body_velocity": LOOP[1], "project": True}
    members = nh.ensemble(discrete, **start, parameters={"crank": [0.3, 0.45]}, steps=100)
    other = nh.simulate(nh.discretize(bars.with_parameters(crank=0.45), 0.01), **start, steps=100)
    assert np.array_equal(members.configuration[1, -1], other.configuration[-1])
    event = nh.Event(lambda orbit: np.sin(orbit.configuration[:, 0]))
    whole = nh.simulate(discrete, **start, steps=200, events=[event], store=tmp_path / "run.zarr")
    assert len(whole.events[0]) == 3
    assert np.array_equal(nh.load_orbit(tmp_path / "run.zarr").multipliers, whole.multipliers)
    blocks = list(nh.iterate(discrete, **start, steps=200, block_steps=70))
    assert np.array_equal(np.concatenate([each.configuration for each in blocks]), whole.configuration)


@pytest.mark.profile("routes", instead="test_constraints_of_places_hold_at_every_node")
def test_derivatives_see_the_surface_move() -> None:
    """The last place of a rollout by the length of the rod, on which the start depends, too."""
    swing = nh.LagrangeDAlembert(
        lambda q, v, p: fall(q, v),  # noqa: ARG005
        None,
        holonomic=lambda q, p: jnp.array([q @ q - p["length"] ** 2]),
        dimension=2,
        parameters={"length": 1.0},
    )

    def last(length):  # noqa: ANN001, ANN202
        """Return the last abscissa."""
        start = {"configuration": length * jnp.array([0.6, -0.8]), "momentum": jnp.zeros(2)}
        return nh.rollout(nh.discretize(swing.with_parameters(length=length), 0.05), **start, steps=20).configuration[
            -1, 0
        ]

    with jax.enable_x64(True):
        slope, step = jax.grad(last)(1.0), 1e-5
        assert abs(slope - (last(1.0 + step) - last(1.0 - step)) / (2 * step)) <= 1e-8


@pytest.mark.profile("routes", instead="test_constraints_of_places_hold_at_every_node")
def test_checks_and_linearizations_see_the_surface() -> None:
    """`check_system`, `check_discretization`; a pendulum hangs with the frequency sqrt(g), in two states."""
    place = nh.flow(four_bar(), configuration=LOOP[0], momentum=(0, 0, 0), project=True, times=[0.0]).configuration[0]
    assert nh.testing.check_system(four_bar(), configuration=place).passed
    sleigh: Any = nh.discretize(sleigh_in_a_bowl(), 0.02)
    assert nh.testing.check_discretization(sleigh).passed
    hanging = nh.linearize(pendulum(), configuration=(0.0, -1.0))
    assert hanging.names == ("q1", "q1'")
    assert np.abs(np.sort(np.imag(hanging.eigenvalues)) - np.sqrt(GRAVITY) * np.array([-1, 1])).max() <= 1e-13
    stepped = nh.linearize(nh.discretize(pendulum(), 0.05), configuration=(0.0, -1.0))
    assert np.abs(np.abs(stepped.eigenvalues) - 1).max() <= 1e-13
    orbit = nh.simulate(nh.discretize(pendulum(), 0.05), configuration=(0.6, -0.8), body_velocity=(0, 0), steps=4)
    assert orbit.tangent.shape == (4, 2, 2)
    assert nh.accessibility(pendulum(), configuration=(0.0, -1.0)).growth == (1,)


def test_short_parts_of_steps_hold_the_constraint() -> None:
    """Down to 1e-15 of a step, where the rounding of a place is a velocity of its own; an event at a node is found."""
    discrete: Any = nh.discretize(pendulum(), 0.05)
    run: Any = {"configuration": (0.6, -0.8), "body_velocity": (0, 0), "steps": 20}
    orbit = nh.simulate(discrete, **run)
    for fraction in 10.0 ** -np.arange(1, 16):
        assert left(pendulum(), discrete.after_parts(orbit, np.full(21, fraction))) <= 1e-15
    event = nh.Event(lambda states: states.configuration[:, 0] - orbit.configuration[5, 0])
    assert np.abs(nh.simulate(discrete, **run, events=[event]).events[0].time - 0.25).max() <= 1e-15
