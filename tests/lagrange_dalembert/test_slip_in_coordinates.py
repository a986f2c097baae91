"""A constraint form that may yield in coordinates: the definition of a step, a block, the sleigh on SE(2)."""

from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from comparisons import assert_same
from refusals import refusals
from simulation.slipping import Continuous

import nonholo as nh
from nonholo.lagrange_dalembert import GroupLagrangeDAlembert, mass_tensor_lagrangian
from nonholo.systems import Contacts

simulate: Any = nh.simulate
ensemble: Any = nh.ensemble


def _lagrangian(q, v, p):  # noqa: ANN001, ANN202
    return v @ p["mass"] @ v / 2 + p["weight"] @ q


def _forms(q, p):  # noqa: ANN001, ANN202
    return jnp.stack([p["holds"], p["yields"] + p["bend"] * q[0] * p["holds"][::-1]])


_NUMBERS = {"mass": np.eye(3), "weight": np.zeros(3), "holds": np.eye(3)[2], "yields": np.eye(3)[0], "bend": 0.0}


def _body(slip: Any, **numbers: Any) -> nh.LagrangeDAlembert:
    """Return a body in space with one form that holds and one that may yield, or both as contacts."""
    return nh.LagrangeDAlembert(_lagrangian, _forms, dimension=3, parameters=_NUMBERS | numbers, force=slip)


def _random(rng: np.random.Generator, bend: float, several: int) -> tuple[nh.LagrangeDAlembert, float, np.ndarray]:
    """Return a body with any grip, a time step, and a velocity that the first form allows, unless it may yield too.

    Of several forms they are one contact for 1, contacts of their own for 2.
    """
    grip, viscous = 10.0 ** rng.uniform(-3, 1, 2) * rng.integers(0, 2, 2)
    root, weight, holds, yields, velocity = rng.normal(size=(3, 3)), *rng.normal(size=(4, 3))
    rows = np.eye(2) + 0.5 * rng.uniform(-1, 1, (2, 2)) if several else [[0.0, rng.uniform(0.5, 2)]]
    slip: Any = nh.Slip(rows, grip, viscous)
    if several == 2:
        slip = nh.Slip([[1.3, 0.0]], grip, viscous), nh.Slip([[0.0, 0.7]], *10.0 ** rng.uniform(-3, 1, 2))
    body = _body(slip, mass=root @ root.T + 0.1 * np.eye(3), weight=weight, holds=holds, yields=yields, bend=bend)
    across = 0 * holds if several else holds * (holds @ velocity) / (holds @ holds)
    return body, 10.0 ** rng.uniform(-2, 0), velocity - across


def test_a_block_slides_to_rest() -> None:
    """Dry friction is a constant force: the nodes lie on the parabola, up to rest within the step of the exact stop."""
    grip, mass, h = 0.7, 2.0, 0.07
    block = _body(nh.Slip([[0.0, 1.0]], grip), mass=mass * np.eye(3))
    orbit = simulate(nh.discretize(block, h), configuration=np.zeros(3), body_velocity=(1.0, 0.5, 0.0), steps=60)
    rate, t = grip / mass, orbit.time
    moving = t < 1 / rate - h
    np.testing.assert_allclose(orbit.configuration[moving, 0], (t - rate * t**2 / 2)[moving], atol=1e-14)
    np.testing.assert_allclose(orbit.momentum[moving, 0], mass * (1 - rate * t)[moving], atol=1e-14)
    np.testing.assert_allclose(orbit.multipliers[:30, 1], -h * grip, atol=1e-14)
    at_rest = t > 1 / rate
    assert not orbit.momentum[at_rest, 0].any()
    assert not orbit.multipliers[at_rest[:-1], 1].any()
    assert abs(orbit.configuration[-1, 0] - 1 / (2 * rate)) <= rate * h**2 / 2
    np.testing.assert_allclose(orbit.configuration[:, 1], t / 2, atol=1e-14)


def _board(length: float) -> Any:
    """Return the places of a board with a blade and a wheel that slide, in lengths."""

    def forms(q, p):  # noqa: ANN001, ANN202
        x, y = jnp.cos(q[2]), jnp.sin(q[2])
        return jnp.array([[-y, x, 0.0], [x, y, -0.3 * p["length"]]])

    def energy(_q, v, p):  # noqa: ANN001, ANN202
        return (v[0] ** 2 + v[1] ** 2 + 0.3 * (p["length"] * v[2]) ** 2) / 2

    slip, numbers, of_one = nh.Slip(np.eye(2), 0.3 * length, 0.1), {"length": length}, np.array([length, length, 1.0])
    board = nh.LagrangeDAlembert(energy, forms, dimension=3, force=slip, parameters=numbers)
    start = {"configuration": (0.3, 0.2, 0.1) * of_one, "body_velocity": (1.0, 0.4, 0.7) * of_one}
    return simulate(nh.discretize(board, 0.05), **start, steps=20).configuration / of_one


def test_slips_have_no_units() -> None:
    """Of forms with lengths and angles: meters and micrometers have the same motion."""
    np.testing.assert_allclose(_board(1e-6), _board(1.0), rtol=0, atol=1e-13)


@pytest.mark.profile("problems", keep=["0", "1", "2", "3"])
@pytest.mark.parametrize("seed", range(200))
def test_no_slip_adds_energy(seed: int) -> None:
    """Under constant masses, forms and weights the energy never grows: one contact or two, any grip and step."""
    body, h, velocity = _random(np.random.default_rng(seed), 0.0, seed % 3)
    orbit = simulate(nh.discretize(body, h), configuration=np.zeros(3), body_velocity=velocity, steps=6)
    potential = orbit.configuration @ body.parameters["weight"]
    assert np.diff(orbit.energy).max() < 1e-13 * (abs(potential).max() + abs(orbit.energy).max())


@pytest.mark.profile("problems", keep=["0", "1", "2", "5"])
@pytest.mark.parametrize("seed", range(60))
def test_every_step_satisfies_its_equations(seed: int) -> None:
    """From the definition: each contact holds within its grip, or friction opposes the slip, in halves at both ends."""
    body, h, velocity = _random(np.random.default_rng(seed), 0.5, seed % 3)
    slips, p, steps, h = body.slips, body.parameters, 8, h / 4
    orbit = simulate(nh.discretize(body, h), configuration=np.zeros(3), body_velocity=velocity, steps=steps)
    rows = np.concatenate([each.rows for each in slips])
    mass, weight, others = p["mass"], p["weight"], np.eye(2)[: 2 - len(rows)]
    s = len(others)  # forms that never yield
    for k in range(steps):
        q, end = orbit.configuration[k : k + 2]
        v = (end - q) / h
        leaving, arriving = mass @ v - h / 2 * weight, mass @ v + h / 2 * weight
        with jax.enable_x64(True):
            A, after, middle = (
                np.concatenate([others, rows]) @ np.array(_forms(x, p)) for x in (q, end, (q + end) / 2)
            )
        a, off = np.linalg.lstsq(A.T, leaving - orbit.momentum[k])[:2]
        a, b = a[s:], np.linalg.lstsq(after.T, orbit.momentum[k + 1] - arriving)[0][s:]
        u, size = middle[s:] @ v, np.abs(orbit.momentum).max() + h * (1 + max(each.grip for each in slips))
        scale = 1e-11 * size * np.linalg.cond(mass)
        assert np.sqrt(off.sum()) < scale
        assert np.linalg.norm(middle[:s] @ v) < scale
        inverse = np.linalg.inv(np.block([[mass, A[:s].T], [A[:s], np.zeros((s, s))]]))[:3, :3]
        moving = A[s:] @ inverse @ orbit.momentum[k]
        for at, slip in Contacts(np.eye(len(rows)), slips).each:
            if (speed := np.linalg.norm(u[at])) < scale:
                most = h * slip.grip + h / 2 * slip.viscous * np.linalg.norm(moving[at])
                assert np.linalg.norm(a[at] + b[at]) <= most + scale
            else:
                friction = -h / 2 * (slip.grip * u[at] / speed + slip.viscous * u[at])
                np.testing.assert_allclose([a[at], b[at]], [friction] * 2, atol=10 * scale)


_ROWS = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])


def _contacts(rows: np.ndarray) -> tuple[nh.Slip, ...]:
    return nh.Slip(rows[:1], 0.8), nh.Slip(rows[1:], 0.3, 0.2)


def _both(q):  # noqa: ANN001, ANN202
    return jnp.concatenate([_blade(q), jnp.array([[jnp.cos(q[2]), jnp.sin(q[2]), 0.0]])])


@pytest.mark.profile("routes", keep=["group"])
@pytest.mark.parametrize("place", ["coordinates", "group"])
def test_a_blade_and_a_brake_slide_by_themselves(place: str) -> None:
    """The brake slides on while the blade comes to rest: order 2 to the flow of the body on SE(2), and T falls."""
    ideal = nh.LLSystem(nh.SE(2), SLEIGH.homogeneous_mass_tensor, annihilator=_ROWS)
    g = nh.flow(nh.Forced(ideal, force=_contacts(_ROWS)), body_velocity=(2.0, 1.0, 0.0), times=(0.0, 3.0))
    x, y, errors = *g.configuration[-1, :2, 2], []
    body: Any = nh.LagrangeDAlembert(_energy, _both, dimension=3, force=_contacts(np.eye(2)))
    start = START
    if place == "group":
        action = mass_tensor_lagrangian(nh.SE(2), ideal.homogeneous_mass_tensor)
        body, start = GroupLagrangeDAlembert(nh.SE(2), action, lambda _: jnp.asarray(_ROWS)), {}
        body, start = nh.Forced(body, force=_contacts(np.eye(2))), {"body_velocity": (2.0, 1.0, 0.0)}
    for steps in (50, 100):
        orbit = simulate(nh.discretize(body, 3.0 / steps), **start, steps=steps)
        end = orbit.configuration[-1, :2] if place == "coordinates" else orbit.configuration[-1, :2, 2]
        errors.append(np.abs(end - (x, y)).max())
        assert np.diff(orbit.energy).max() < 0
    assert errors[0] / errors[1] > 3.2
    if place == "group":
        slips = np.abs(orbit.body_velocity @ _ROWS.T) < 1e-13
        assert slips.any(axis=0).tolist() == [True, False]


SLEIGH = nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.2)
START: dict[str, Any] = {"configuration": (0.0, 0.0, 0.0), "body_velocity": (1.0, 0.0, 2.0)}


def _energy(q, v):  # noqa: ANN001, ANN202
    c, s = jnp.cos(q[2]), jnp.sin(q[2])
    w = v[:2] + v[2] * jnp.array([-s * 0.5 - c * 0.2, c * 0.5 - s * 0.2])
    return (w @ w + v[2] ** 2) / 2


def _blade(q):  # noqa: ANN001, ANN202
    return jnp.array([[-jnp.sin(q[2]), jnp.cos(q[2]), 0.0]])


def _sleigh(*slip: float, **more: Any) -> nh.LagrangeDAlembert:
    force = nh.Slip([[1.0]], *slip) if slip else None
    return nh.LagrangeDAlembert(_energy, _blade, dimension=3, force=force, **more)


@pytest.mark.profile("problems", instead="test_every_step_satisfies_its_equations")
@pytest.mark.parametrize("slip", [(0.8,), (0.8, 0.5), (0.0, 2.0)])
@pytest.mark.parametrize("rule", ["midpoint", "trapezoidal"])
def test_the_sleigh_is_that_on_the_plane(rule: str, slip: tuple[float, ...]) -> None:
    """The pose tends at order 2 to the continuous motion of the body on SE(2), across the stop, as does its own map."""
    body = nh.Forced(SLEIGH, force=nh.Slip([[0.0, 0.0, 1.0]], *slip))
    _, g, _ = Continuous(body).run((2.0, 1.0, 0.0), 5.0)
    errors = []
    for steps in (100, 200, 400):
        discrete = nh.discretize(_sleigh(*slip, rule=rule), 5.0 / steps)
        x, y, turn = simulate(discrete, **START, steps=steps).configuration[-1]
        errors.append(max(abs(x - g[0, 2]), abs(y - g[1, 2]), abs(np.exp(1j * turn) - g[0, 0] - 1j * g[1, 0])))
    assert errors[-1] < 1e-3
    assert (np.log2(np.divide(errors[:-1], errors[1:])) > 1.7).all()


@pytest.mark.profile("problems", instead="test_every_step_satisfies_its_equations")
def test_limits_and_runs(tmp_path: Path) -> None:
    """Rows that never yield have the bits of the ideal map; blocks, thinned rows and stores those of one run."""
    ideal, bound = (simulate(nh.discretize(each, 0.05), **START, steps=100) for each in (_sleigh(), _sleigh(np.inf)))
    assert np.array_equal(bound.configuration, ideal.configuration)
    assert np.array_equal(bound.body_velocity, ideal.body_velocity)
    np.testing.assert_allclose(bound.multipliers, ideal.multipliers, atol=1e-14)
    discrete = nh.discretize(_sleigh(0.8, 0.1), 0.05)
    whole = simulate(discrete, **START, steps=60)
    blocks = list(nh.iterate(discrete, **START, steps=60, block_steps=13))
    simulate(discrete, **START, steps=40, store=tmp_path / "run.zarr", checkpoint_every=20)
    nh.extend(tmp_path / "run.zarr", 20, discrete=discrete)
    stored = nh.load_orbit(tmp_path / "run.zarr", discrete=discrete)
    for other in (blocks[0].joined(blocks[1:]), stored):
        assert_same(whole, other, *whole.motion.columns)
    thin = simulate(discrete, **START, steps=60, save_every=7)
    assert np.array_equal(thin.momentum, whole.momentum[::7])
    assert np.array_equal(thin.multipliers, whole.multipliers[::7][: len(thin.multipliers)])
    twice = ensemble(discrete, **{name: [value] * 2 for name, value in START.items()}, steps=60, save_every=1)
    assert np.array_equal(twice.configuration[1], whole.configuration)


def _spring(q, v):  # noqa: ANN001, ANN202
    return v @ v / 2 - q @ q / 2


def _along(_q):  # noqa: ANN001, ANN202
    return jnp.array([[1.0, 0.0]])


@pytest.mark.profile("problems", instead="test_every_step_satisfies_its_equations")
def test_belts_loops_and_other_forces() -> None:
    """On a belt a block sticks and slips, a bead on a loop comes to rest on it, and a table acts beside a slip."""
    common: dict[str, Any] = {"dimension": 2, "force": nh.Slip([[1.0]], 0.5)}
    belt = nh.LagrangeDAlembert(_spring, _along, constraint_velocities=lambda _q, _t: jnp.array([0.3]), **common)
    orbit = simulate(nh.discretize(belt, 0.05), configuration=(0, 0.2), body_velocity=(0.3, 0), steps=400)
    sticks = abs(orbit.body_velocity[:, 0] - 0.3) < 1e-14
    assert abs(0.05 * sticks.sum() - 0.5 / 0.3) < 0.1  # up to where the spring exceeds the grip
    assert abs(orbit.configuration[:, 0]).max() < 0.9
    loop = nh.LagrangeDAlembert(
        lambda q, v: v @ v / 2 - q[1],
        lambda q: jnp.array([[-q[1], q[0]]]),
        holonomic=lambda q: jnp.array([q @ q - 1]),
        **common,
    )
    orbit = simulate(nh.discretize(loop, 0.05), configuration=(1, 0), body_velocity=(0, 0), steps=200)
    assert abs((orbit.configuration**2).sum(axis=1) - 1).max() < 1e-14
    assert np.ptp(orbit.configuration[100:], axis=0).max() < 1e-14
    assert abs(orbit.configuration[-1, 0]) < 0.5
    common["force"] = common["force"], np.tile([2.0, 0.0], (20, 1))
    pulled = nh.LagrangeDAlembert(_spring, _along, **common)
    orbit = simulate(nh.discretize(pulled, 0.05), configuration=(0, 0), body_velocity=(0, 0), steps=40)
    np.testing.assert_allclose(orbit.momentum[1], [0.075, 0.0], atol=1e-4)


_crooked = lambda q, r, h: _blade(q) @ (r - q) / h  # noqa: E731
_YIELDS: Any = nh.discretize(_body(nh.Slip([[0.0, 1.0]], 0.7)), 0.1)
_AT: dict[str, Any] = {"configuration": np.zeros(3), "body_velocity": (1.0, 0.5, 0.0)}
test_what_has_no_slip_is_refused = refusals(
    (lambda: _body(nh.Slip([[1.0, 1.0]], 0.7)), "Slips with rows of 2 numbers, one for each form"),
    (lambda: _body((nh.Slip([[1.0, 0.0]], 0.7), nh.Slip([[2.0, 0.0]], 0.7))), "each form in one Slip"),
    (lambda: _body(nh.Slip([[1.0, 0.0, 0.0]], 0.7)), "Slips with rows of 2 numbers"),
    (lambda: _sleigh(0.7, discrete_constraints=_crooked), "no Slip beside own discrete functions"),
    (lambda: simulate(_YIELDS, configuration=np.zeros(3), displacement=np.zeros(3), steps=1), "never yield"),
    (lambda: simulate(_YIELDS, **_AT, steps=2, events=[lambda states: states.time]), "forms that may yield"),
    (lambda: simulate(_YIELDS, **_AT, steps=2).work, "never yield"),
    (lambda: simulate(_YIELDS, **_AT, steps=2).tangent, "never yield"),
    (lambda: nh.flow(_YIELDS.system, **_AT, times=(0, 1)), "never yield"),
    (lambda: nh.vector_field(_YIELDS.system)(0.0, np.zeros(6)), "never yield"),
    (lambda: nh.linearize(_YIELDS, **_AT), "never yield"),
    (lambda: nh.rollout(_YIELDS, **_AT, steps=2), "never yield"),
    (lambda: nh.testing.check_discretization(_YIELDS), "never yield"),
)
