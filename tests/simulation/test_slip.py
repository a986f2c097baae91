"""Rows of a constraint that may yield: the continuous equations, the definition of a step, the limits."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from comparisons import assert_same_run
from refusals import refusals
from simulation.slipping import Continuous, car, random_case, space_body

import nonholo as nh
from nonholo.discrete.routes._slipping import friction

SLEIGH = nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.2)
TOP = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
TILTED = nh.SuslovTop.from_inertia(np.diag([1.0, 1.3, 0.9]), axis=(0.36, -0.48, 0.8))
TOP4 = nh.SuslovTop(np.diag([1.0, 2.0, 1.5, 0.7]) + 0.1)
BODY, CAR = space_body(), car()
BLADE, AXIS = [[0.0, 0.0, 1.0]], [[0.0, 0.0, 1.0]]
FAST, SPIN, ALONG = (2.0, 1.0, 0.0), (0.9, -0.8, 0.0), np.array([0.9, -0.7, 0.8]) @ BODY.constraint_subspace
SLOPE, TURN = nh.Gravity([0.1, -0.3, 0.5], [0.3, 0.1, 0.0]), np.array([2.0]) @ CAR.constraint_subspace
HANGING = nh.Gravity([0.0, 0.0, -2.0], [0.1, 0.2, 0.4])
VISCOUS = nh.Forced(SLEIGH, nh.Gravity([0.5, -0.7], [0.3, 0.1]), nh.Slip(BLADE, 0.8, 0.5))
AXLES = nh.Forced(CAR, force=(nh.Slip(BLADE, 0.5), nh.Slip(CAR.annihilator[1:], 1.5, 0.1)))
CONE_AND_ROW = nh.Forced(BODY, SLOPE, (nh.Slip(BODY.annihilator[1:], 0.3), nh.Slip(BODY.annihilator[:1], 0.1)))
CASES: dict[str, tuple[nh.Forced, Any, str]] = {  # body and start, and how its contacts are in turn
    "sleigh": (nh.Forced(SLEIGH, force=nh.Slip(BLADE, 0.8)), FAST, "slide, hold"),
    "top": (nh.Forced(TOP, force=nh.Slip(AXIS, 0.15)), SPIN, "slide, hold, slide"),
    "body in space": (nh.Forced(BODY, force=nh.Slip(BODY.annihilator[1:2], 0.3)), ALONG, "slide"),
    "weight": (nh.Forced(TOP, HANGING, nh.Slip(AXIS, 0.3)), SPIN, "hold, slide"),
    "cone": (nh.Forced(BODY, force=nh.Slip(BODY.annihilator[1:], 0.4)), ALONG, "slide, hold"),
    "viscous": (VISCOUS, FAST, "slide, hold, slide, hold, slide"),
    "two axles": (AXLES, TURN, "slide hold, hold hold"),
    "cone and row": (CONE_AND_ROW, ALONG, "slide hold, slide slide, slide hold"),
}
TIME = 5.0


def _run(name: str, steps: int, **more: Any) -> nh.Orbit:
    forced, velocity, *_ = CASES[name]
    return nh.simulate(nh.discretize(forced, TIME / steps), body_velocity=velocity, steps=steps, **more)


def _momenta_of_slip(orbit: nh.Orbit) -> np.ndarray:
    return orbit.restricted_momentum[:, orbit.system.forces.system.rank :]


def _drive(time: float, g: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    return np.array([0.4 * np.sin(3 * time), 0.1, 0.3 * g[0, 0] - 0.1 * velocity[2]])


def _errors(forced: nh.Forced, start: Any, end: Any, time: float, *counts: int) -> np.ndarray:
    """Return by how much orbits miss the velocity and the pose at the end of a time, for numbers of steps."""
    missed = []
    for steps in counts:
        discrete = nh.discretize(forced, time / steps)
        last = nh.simulate(discrete, body_velocity=start, steps=steps, save_every=steps)[-1:]
        missed.append(max(abs(last.body_velocity[0] - end[0]).max(), abs(last.configuration[0] - end[1]).max()))
    return np.array(missed)


@pytest.mark.profile("problems", keep=["sleigh"])
@pytest.mark.parametrize("name", CASES)
def test_orbits_converge_to_the_continuous_motion(name: str) -> None:
    """Velocity and pose have order 2, also across the places where rows yield and come to rest; a flow has them."""
    forced, velocity, contacts = CASES[name]
    *end, kinds = Continuous(forced).run(velocity, TIME)
    assert ", ".join(kinds) == contacts
    flow = nh.flow(forced, body_velocity=velocity, times=(0, TIME))
    np.testing.assert_allclose(flow.body_velocity[-1], end[0], atol=1e-9)
    np.testing.assert_allclose(flow.configuration[-1], end[1], atol=1e-9)
    errors = _errors(forced, velocity, end, TIME, 200, 400, 800)
    assert errors[-1] < 2e-4
    assert (np.log2(errors[:-1] / errors[1:]) > 1.7).all()


@pytest.mark.profile("problems", instead="test_a_slip_may_turn_over_without_a_way")
def test_a_slip_that_turns_over_at_once_is_of_order_one() -> None:
    """Where friction is far below what drives the slip back, it turns over within a step; the error falls with h."""
    forced = nh.Forced(SLEIGH, nh.Gravity([0.5, -2.7], [0.3, 0.1]), nh.Slip(BLADE, 0.05))
    *end, kinds = Continuous(forced).run((1.5, 0.5, 0.4), 4.0)
    assert kinds.count("slide") > 1
    errors = _errors(forced, (1.5, 0.5, 0.4), end, 4.0, 100, 400, 1600)
    assert (errors * (100, 400, 1600) < 4).all()
    assert errors[0] / errors[2] > 10


@pytest.mark.profile("problems", cases=["viscous", "body in space", "weight"])
@pytest.mark.parametrize("name", CASES)
def test_every_step_satisfies_its_equations(name: str) -> None:
    """From the definition: contacts hold or their friction opposes the slip of the step, in equal halves at both ends.

    The first half of one that holds also ends its slip, by impulses along the rows that hold alone.
    """
    forced, _, contacts = CASES[name]
    orbit, inside, slips = _run(name, 60), forced.system, forced.slips
    h, group, W = TIME / 60, forced.group, orbit.displacement
    A, ends = np.concatenate([slip.rows for slip in slips]), np.cumsum([len(slip.rows) for slip in slips])
    inertia, S = np.asarray(inside.inertia_operator), np.asarray(inside.constraint_subspace)
    remaining = [a for a in inside.annihilator if np.linalg.matrix_rank([*A, a]) > len(A)]
    equations = np.concatenate([S @ inertia, np.reshape(remaining, (-1, group.dim)), A])
    V = np.linalg.inv(equations)[:, -len(A) :].T
    one = nh.discretize(nh.LLSystem(group, inside.homogeneous_mass_tensor, np.eye(group.dim)), h)
    free = nh.Forced(inside, forced.potential)
    pi, kinds = _momenta_of_slip(orbit), set()
    velocity = np.linalg.solve(V @ inertia @ V.T, pi.T).T
    for k in range(60):
        P, g = nh.discrete_legendre(one, W[k]), orbit.configuration[k : k + 1]
        f = free.mean_force(g, W[k : k + 1], h, np.zeros((1, group.dim)), orbit.time[k : k + 1])[0]
        arriving, X = group.coadjoint(W[k], P), group.vee((W[k] - np.linalg.inv(W[k])) / 2)
        np.testing.assert_allclose(S @ (P - h / 2 * f), orbit.restricted_momentum[k, : len(S)], atol=2e-14)
        np.testing.assert_allclose(S @ (arriving + h / 2 * f), orbit.restricted_momentum[k + 1, : len(S)], atol=2e-14)
        first, last = V @ (P - h / 2 * f) - pi[k], pi[k + 1] - V @ (arriving + h / 2 * f)
        np.testing.assert_allclose(np.reshape(remaining, (-1, group.dim)) @ X, 0, atol=2e-15)
        kind = []
        for slip, at in zip(slips, map(np.arange, [0, *ends[:-1]], ends), strict=True):
            x, size, rests = slip.rows @ X, np.linalg.norm(slip.rows @ X), abs(velocity[k + 1, at]).max() < 1e-14
            if rests:
                most = h * slip.grip + h / 2 * slip.viscous * np.linalg.norm(velocity[k, at])
                assert np.linalg.norm(first[at] + last[at]) <= most
                assert size < 1e-15
            else:
                j = -h * slip.grip * x / size - slip.viscous * x
                np.testing.assert_allclose(first[at], j / 2, atol=5e-15)
                np.testing.assert_allclose(last[at], j / 2, atol=5e-15)
            kind.append("hold" if rests else "slide")
        kinds.add(" ".join(kind))
    assert kinds == set(contacts.split(", "))


def _lawful(forced: nh.Forced, h: float, velocity: np.ndarray, steps: int) -> tuple[float, float, int]:
    """Return the largest growth of T + U without its work, the largest gap of the balance, and how many states.

    Rounding of momenta along directions that almost depend on one another counts as one of unit directions.
    """
    orbit = nh.simulate(nh.discretize(forced, h), restricted_velocity=velocity, steps=steps, throw=False)
    if len(orbit) < 2:
        return 0.0, 0.0, len(orbit)
    energy, potential = orbit.energy, forced.potential_energy(orbit.configuration)
    turned = abs(energy).max() + abs(energy - potential).max() + abs(potential).max() or 1.0
    gap = abs(energy - energy[0] - orbit.work).max()
    bent = 4 * np.finfo(float).eps * np.sqrt(np.linalg.cond(forced.free.constrained_inertia))
    return np.diff(energy).max() / turned, gap / turned - bent, len(orbit)


@pytest.mark.profile("problems", keep=["1"])
@pytest.mark.parametrize("seed", range(40))
def test_no_slip_adds_energy(seed: int) -> None:
    """T + U never grows and the balance closes to rounding: any body, contacts, step, grips and coefficients.

    Of 25 cases at least half have all their steps.
    """
    rng, long = np.random.default_rng(seed), 0
    for _ in range(25):
        growth, gap, states = _lawful(*random_case(rng), 4)
        assert growth < 1e-13
        assert gap < 1e-13
        long += states == 5
    assert long > 12


@pytest.mark.parametrize("seed", range(50))
def test_the_friction_of_several_contacts_is_the_root_of_its_laws(seed: int) -> None:
    """From the definition: A x = b + j, no slip or the grip against it, of up to four contacts."""
    rng = np.random.default_rng(seed)
    ends = np.cumsum(rng.integers(1, 4, size=rng.integers(1, 5)))
    B, free = rng.normal(size=(2, ends[-1], ends[-1]))
    A, free = B @ B.T + 0.01 * (B - B.T), 10.0 ** rng.uniform(-3, 3) * free[0]
    laws = [
        (slice(first, last), (0.0, 10.0 ** rng.uniform(-3, 3), np.inf)[rng.integers(3)], rng.choice([0.0, 0.1, 1e4]))
        for first, last in zip([0, *ends[:-1]], ends, strict=True)
    ]
    x, j = friction(A, free, laws)
    np.testing.assert_allclose(A @ x, free + j, atol=1e-13 * (abs(A).max() * abs(x).max() + abs(free).max()))
    for at, most, viscous in laws:
        size = np.linalg.norm(x[at])
        if size == 0:
            assert np.linalg.norm(j[at]) <= most
        else:
            np.testing.assert_allclose(j[at], -(most / size + viscous) * x[at], rtol=1e-9, atol=1e-12 * abs(free).max())


@pytest.mark.profile("problems", instead="test_an_infinite_grip_has_the_bits_of_the_ideal_map")
def test_a_contact_that_never_yields_is_rows_that_hold() -> None:
    """Of two axles one with an infinite grip: the motion, the impulses and the work of the other one alone."""
    rear, front = nh.Slip(BLADE, 0.5), nh.Slip(CAR.annihilator[1:], np.inf)
    start = np.array([2.0, 0.5]) @ nh.Forced(CAR, force=rear).constraint_subspace
    one, other = (
        nh.simulate(nh.discretize(nh.Forced(CAR, force=force), 0.02), body_velocity=start, steps=200)
        for force in (rear, (rear, front))
    )
    for column in ("body_velocity", "configuration", "multipliers", "work"):
        np.testing.assert_allclose(getattr(other, column), getattr(one, column), atol=1e-12)
    assert (abs(one.body_velocity[:, 2]) > 0.1).any()
    assert (one.body_velocity[1:, 2] == 0).any()


_TABLE = np.random.default_rng(1).normal(size=(100, 3))
_IDEAL: dict[str, tuple[Any, ...]] = {  # body, rows that could yield, potential, other forces
    "sleigh": (SLEIGH, BLADE),
    "top": (TOP, AXIS),
    "tilted top": (TILTED, TILTED.annihilator),
    "top in four dimensions": (TOP4, TOP4.annihilator),
    "body in space": (BODY, BODY.annihilator[1:]),
    "weight": (TOP, AXIS, HANGING),
    "friction and table": (SLEIGH, BLADE, None, nh.Friction([0.1, 0.2, 0.3]), _TABLE),
    "function": (SLEIGH, BLADE, lambda g: 0.3 * g[0, 2] ** 2, _drive),
}


@pytest.mark.parametrize("name", _IDEAL)
def test_an_infinite_grip_has_the_bits_of_the_ideal_map(name: str) -> None:
    """Rows that never yield: momenta along the constraint and poses bit for bit, and no slip at all."""
    system, rows, *acting = _IDEAL[name]
    potential, others = (acting or [None])[0], tuple(acting[1:])
    slip, start = nh.Slip(rows, np.inf), np.linspace(0.9, -0.6, system.rank)
    ideal = nh.Forced(system, potential, others or None, "energy") if acting else system
    orbit = nh.simulate(nh.discretize(ideal, 0.05), momentum=start, steps=100)
    yielding = nh.discretize(nh.Forced(system, potential, (slip, *others)), 0.05)
    yielding = nh.simulate(yielding, momentum=np.append(start, np.zeros(len(slip.rows))), steps=100)
    assert np.array_equal(yielding.restricted_momentum[:, : system.rank], orbit.restricted_momentum)
    assert np.array_equal(yielding.canonical_pose, orbit.canonical_pose)
    assert not _momenta_of_slip(yielding).any()


def test_without_grip_the_slip_is_free() -> None:
    """A grip of zero is the map without the rows: the energy is constant, and so is the momentum in space."""
    forced = nh.Forced(SLEIGH, force=nh.Slip(BLADE, 0.0))
    orbit = nh.simulate(nh.discretize(forced, 0.05), body_velocity=FAST, steps=400)
    still = nh.Linear(np.zeros((3, 3)))
    body = nh.Forced(nh.RigidBody(SLEIGH.homogeneous_mass_tensor, nh.SE(2)), still, None, "energy")
    free = nh.simulate(nh.discretize(body, 0.05), body_velocity=FAST, steps=400)
    assert np.ptp(orbit.energy) < 1e-13
    np.testing.assert_allclose(orbit.configuration, free.configuration, atol=1e-12)
    assert np.ptp(orbit.spatial_momentum, axis=0).max() < 1e-12


def test_stiff_viscous_friction_tends_to_the_ideal_map() -> None:
    """With c to infinity and no grip the errors of momenta and poses fall like 1 / c."""
    ideal = nh.simulate(nh.discretize(SLEIGH, 0.05), body_velocity=FAST, steps=80)
    errors = []
    for viscous in (1e2, 1e4, 1e6):
        forced = nh.Forced(SLEIGH, force=nh.Slip(BLADE, 0.0, viscous))
        orbit = nh.simulate(nh.discretize(forced, 0.05), body_velocity=FAST, steps=80)
        gap = abs(orbit.restricted_momentum[:, :2] - ideal.restricted_momentum).max()
        errors.append(max(gap, abs(orbit.configuration - ideal.configuration).max()))
    assert 70 < errors[0] / errors[1] < 130
    assert 95 < errors[1] / errors[2] < 105


@pytest.mark.profile("problems", keep=["sleigh"])
@pytest.mark.parametrize("name", CASES)
def test_one_motion_however_it_is_run(name: str, tmp_path: Path) -> None:
    """Blocks, thinned rows, ensembles and stores that are extended have the bits of one run."""
    forced, velocity, *_ = CASES[name]
    discrete, whole = nh.discretize(forced, TIME / 120), _run(name, 120)
    blocks = list(nh.iterate(discrete, body_velocity=velocity, steps=120, block_steps=17))
    thinned = _run(name, 120, save_every=7)
    nh.simulate(discrete, body_velocity=velocity, steps=50, store=tmp_path / "run.zarr", checkpoint_every=20)
    nh.extend(tmp_path / "run.zarr", 70)
    members = nh.ensemble(discrete, body_velocity=[velocity, velocity], steps=120, save_every=1)
    stored = nh.load_orbit(tmp_path / "run.zarr")
    assert_same_run(whole, blocks[0].joined(blocks[1:]))
    assert_same_run(whole, stored)
    assert_same_run(whole, thinned, 7)
    assert np.array_equal(members.restricted_momentum[1], whole.restricted_momentum)
    np.testing.assert_allclose(thinned.work, whole.work[::7], atol=1e-14)
    assert all(isinstance(each, nh.Slip) for each in stored.system.forces.slips)


@pytest.mark.profile("problems", keep=["sleigh", "top", "weight"])
@pytest.mark.parametrize("name", CASES)
def test_parts_of_steps_lead_to_the_next_state(name: str) -> None:
    """Events have parts of steps of both kinds: they begin at the state, end at the next one, and are continuous."""
    discrete, orbit = nh.discretize(CASES[name][0], TIME / 60), _run(name, 60)
    before = orbit[:-1]
    ends = discrete.after_parts(before, np.ones(60))
    np.testing.assert_allclose(ends.restricted_momentum, orbit.restricted_momentum[1:], atol=2e-14)
    np.testing.assert_allclose(ends.configuration, orbit.configuration[1:], atol=2e-14)
    np.testing.assert_allclose(ends.canonical_chart, orbit.canonical_chart[1:], atol=2e-14)
    near = discrete.after_parts(before, np.full(60, 1 - 1e-7))
    assert abs(near.configuration - ends.configuration).max() < 1e-6
    first = discrete.after_parts(before, np.full(60, 1e-7))
    assert abs(first.configuration - before.configuration).max() < 1e-6


_WALL = nh.Event(lambda orbit: 1.2 - orbit.position[:, 0], reset=nh.Impact([-1.0, 0.0], point=[0, 0]), name="wall")
_LINE = nh.Event(lambda orbit: orbit.position[:, 0] - 1.0, name="line")
_SLIPPING = CASES["sleigh"][0]
_MAP = nh.discretize(_SLIPPING, 0.1)


@pytest.mark.profile("problems", keep=["run"])
@pytest.mark.parametrize("way", ["run", "flow"])
def test_events_and_walls_are_found_while_rows_slide(way: str) -> None:
    """A crossing is located to rounding, and an impact of a body that slides keeps its energy."""
    how: dict[str, Any] = {"body_velocity": FAST, "events": [_WALL, _LINE]}
    if way == "run":
        orbit, error = nh.simulate(nh.discretize(_SLIPPING, 0.02), steps=300, **how), 1e-13
    else:
        orbit, error = nh.flow(_SLIPPING, times=np.linspace(0, 4, 81), **how), 1e-12
    assert len(orbit.events["wall"]) > 0
    assert abs(orbit.events["line"].states.position[:, 0] - 1).max() < error
    assert orbit.position[:, 0].max() < 1.2 + error
    assert np.diff(orbit.energy).max() < error


def test_multipliers_are_reactions_and_friction() -> None:
    """Of rows that hold the impulse is at most the grip; of rows that slide it is the grip against the slip."""
    orbit, h = _run("sleigh", 400), TIME / 400
    slip, force = orbit.body_velocity[:-1, 2], orbit.multipliers[:, 0] / h
    sliding = (abs(slip[1:]) > 0.02) & (abs(slip[:-1]) > 0.02)
    np.testing.assert_allclose(force[:-1][sliding], -0.8 * np.sign(slip[1:][sliding]), atol=1e-12)
    content = (slip[1:] == 0) & (slip[:-1] == 0)
    assert content.any()
    assert (abs(force[:-1][content]) < 0.8).all()
    S = orbit.system.constraint_subspace
    np.testing.assert_allclose(orbit.momentum @ S.T, orbit.restricted_momentum, atol=1e-14)


_BY_INERTIA = nh.LLSystem(nh.SO(3), annihilator=AXIS, inertia_operator=np.eye(3))
# One clear error that names the demand, before any work.
test_what_has_no_slip_is_refused = refusals(
    (lambda: nh.Forced(SLEIGH, force=nh.Slip([[0, 1, 1]], 1.0)), "vanish on the constraint"),
    (lambda: nh.Forced(SLEIGH, force=nh.Slip([[0, 1]], 1.0)), "have rows of 3 numbers"),
    (lambda: nh.Forced(BODY, force=nh.Slip([BODY.annihilator[1] + BODY.annihilator[2]], 1.0)), "span the same as rows"),
    (lambda: nh.Forced(nh.RigidBody(np.eye(3)), force=nh.Slip(AXIS, 1.0)), "a constraint that can yield"),
    (lambda: nh.Forced(nh.VeselovaTop(np.eye(3)), force=nh.Slip(AXIS, 1.0)), "fixed in the body"),
    (lambda: nh.Forced(nh.examples.knife_edge_on_incline().system, force=nh.Slip(AXIS, 1.0)), "rows of 1 numbers"),
    (lambda: nh.Forced(SLEIGH, force=(nh.Slip(BLADE, 1.0), nh.Slip(BLADE, 1.0))), "independent rows"),
    (lambda: nh.Forced(nh.SuslovTop(np.diag([0, 0, 1.0])), force=nh.Slip(AXIS, 1.0)), "have an inertia along the rows"),
    (lambda: nh.Slip(BLADE, -1.0), "never add energy"),
    (lambda: nh.Slip(BLADE, 1.0, -1.0), "never add energy"),
    (lambda: nh.Slip(BLADE, 1.0, np.inf), "be finite"),
    (lambda: nh.Slip(BLADE, np.nan), "be finite"),
    (lambda: nh.Slip([[0.0, 0.0, np.nan]], 1.0), "be finite"),
    (lambda: nh.Slip([[0, 0, 1], [0, 0, 2]], 1.0), "independent rows"),
    (lambda: nh.Slip([0.0, 0.0, 1.0], 1.0), "have shape"),
    (lambda: nh.Slip(np.zeros((0, 3)), 1.0), "have a row"),
    (lambda: nh.discretize(_SLIPPING, 0.1, order=4), "order 2.*back in time slips add energy"),
    (lambda: nh.discretize(_SLIPPING, 0.1, "logarithmic"), "the scheme 'energy'"),
    (lambda: nh.discretize(nh.Forced(SLEIGH, None, nh.Slip(BLADE, 1.0), "variational"), 0.1), "the scheme 'energy'"),
    (lambda: nh.discretize(nh.Forced(_BY_INERTIA, force=nh.Slip(AXIS, 1.0)), 0.1), "the scheme 'energy'"),
    (lambda: nh.flow(_SLIPPING, body_velocity=FAST, times=(0, -1)), "increase where rows"),
    (lambda: nh.vector_field(_SLIPPING), "never yields"),
    (lambda: nh.linearize(_SLIPPING, body_velocity=FAST), "never yields"),
    (lambda: nh.linearize(_MAP, body_velocity=(0.0, 1.0, 0.0)), "never yields"),
    (lambda: nh.rollout(_MAP, body_velocity=FAST, steps=3), "never yields"),
    (lambda: nh.testing.check_system(_SLIPPING), "never yields"),
    (lambda: nh.testing.check_discretization(_MAP), "never yields"),
    (lambda: nh.branches(_MAP, momentum=FAST), "a Slip, whose rows"),
)


def test_a_slip_ends_after_the_time_and_the_way_of_coulomb() -> None:
    """A balanced sleigh pushed sideward has v = v0 - mu t / m: it stops after m v0 / mu and m v0^2 / 2 mu, exactly."""
    mass, grip, speed = 1.5, 0.6, 0.8
    forced, end = nh.Forced(nh.ChaplyginSleigh(mass, 1.0, 0.0), force=nh.Slip(BLADE, grip)), mass * speed / grip
    times = np.array([0.0, end / 3, end, 2 * end])
    orbit = nh.flow(forced, body_velocity=(0.0, 0.0, speed), times=times)
    expected = speed - grip / mass * np.minimum(times, end)
    np.testing.assert_allclose(orbit.body_velocity[:, 2], expected, atol=1e-14)
    assert orbit.body_velocity[-1, 2] == 0
    np.testing.assert_allclose(orbit.position[:, 1], mass / (2 * grip) * (speed**2 - expected**2), atol=1e-14)
    np.testing.assert_allclose(orbit.multipliers[[1, 3], 0], [-grip, 0], atol=1e-13)


@pytest.mark.parametrize("name", ["viscous", "two axles"])
def test_a_flow_with_slips_obeys_its_equations(name: str) -> None:
    """Of the states between, by differences: I omega' = ad* + f + sum lambda a, with grips against slips."""
    forced, velocity, *_ = CASES[name]
    orbit = nh.flow(forced, body_velocity=velocity, times=np.linspace(0, TIME, 501))
    h, times = 1e-3, np.linspace(0.1, TIME - 0.1, 60)
    before, now, after = (orbit.at(times + shift) for shift in (-h, 0, h))
    rates = (after.body_velocity - before.body_velocity) @ np.asarray(forced.inertia_operator) / (2 * h)
    push = forced.group.coad(now.body_velocity, now.momentum) + forced.potential_force(now.configuration)
    gaps = abs(rates - push - now.multipliers @ np.asarray(forced.system.annihilator)).max(axis=1)
    assert (gaps < 1e-4).mean() > 0.9  # all but those with a stop between
    assert np.diff(orbit.energy).max() < 1e-12
    np.testing.assert_allclose(orbit.energy - orbit.energy[0], orbit.work, atol=1e-3)
    for i, slip in enumerate(forced.slips):
        v, force = now.body_velocity @ slip.rows[0], now.multipliers[:, i]
        slides = abs(v) > 1e-9
        against = -slip.grip * np.sign(v) - slip.viscous * v
        np.testing.assert_allclose(force[slides], against[slides], atol=1e-12)
        assert (abs(force[~slides]) <= slip.grip * (1 + 1e-11)).all()


@pytest.mark.profile("problems", instead="test_a_flow_with_slips_obeys_its_equations")
@pytest.mark.parametrize("seed", range(8))
def test_no_flow_with_slips_gains_energy(seed: int) -> None:
    """T + U does not grow beyond the tolerance: any body, contacts, grips and coefficients; or the outcome is said."""
    forced, _, velocity = random_case(np.random.default_rng(seed))
    try:
        orbit = nh.flow(forced, restricted_velocity=velocity, times=np.linspace(0, 2, 21))
    except nh.OutcomeError as failure:
        orbit = failure.orbit
    assert orbit.outcome in (nh.Outcome.successful, nh.Outcome.too_stiff, nh.Outcome.not_converged)
    assert np.diff(orbit.energy).max(initial=0.0) < 1e-9 * abs(orbit.energy).max()


@pytest.mark.profile("problems", instead="test_events_and_walls_are_found_while_rows_slide")
def test_members_of_flows_with_slips_are_flows_alone() -> None:
    """Members have the bits of single flows, and so have momenta without poses."""
    times = np.linspace(0, 4, 81)
    alone, bare = (nh.flow(_SLIPPING, body_velocity=FAST, times=times, reconstruct=each) for each in (True, False))
    members = nh.ensemble(_SLIPPING, body_velocity=[FAST, SPIN], times=times)
    assert np.array_equal(members.restricted_momentum[0], alone.restricted_momentum)
    assert np.array_equal(bare.restricted_momentum, alone.restricted_momentum)


def test_phases_without_end_are_an_outcome(monkeypatch: pytest.MonkeyPatch) -> None:
    """A flow whose rows yield and rest again and again ends with the reason, and has its good states."""
    monkeypatch.setattr("nonholo.continuous._forced._PHASES", 6)
    forced = nh.Forced(SLEIGH, force=(nh.Slip(BLADE, 0.1), lambda time, *_: np.array([0, 0, np.sin(8 * time)])))
    with pytest.raises(nh.OutcomeError) as failure:
        nh.flow(forced, body_velocity=(0.0, 0.1, 0.0), times=np.linspace(0, 9, 91))
    assert failure.value.outcome == nh.Outcome.too_stiff
    assert 0 < len(failure.value.orbit) < 91


def test_a_slip_may_turn_over_without_a_way() -> None:
    """Where the grip cannot stop a slip, nor push through, it turns over: no slip of the step, and no work."""
    push = np.tile([0.0, 0.0, -15.0], (1, 1))
    forced = nh.Forced(nh.ChaplyginSleigh(1.0, 1.0, 0.0), force=(nh.Slip(BLADE, 5.0), push))
    orbit = nh.simulate(nh.discretize(forced, 0.1), body_velocity=(0.0, 0.0, 0.7), steps=1)
    np.testing.assert_allclose(orbit.body_velocity[:, 2], [0.7, -0.7], rtol=1e-14)
    np.testing.assert_allclose(orbit.position[1], 0.0, atol=1e-15)
    assert abs(np.ptp(orbit.energy)) < 1e-15
    np.testing.assert_allclose(orbit.work, 0.0, atol=1e-15)


def test_a_step_without_a_root_is_an_outcome() -> None:
    """A step that is too long ends the run with the reason, whether rows hold or slide."""
    weight = nh.Gravity([0.0, 0.0, -9.0], [0.1, 0.2, 0.4])
    for grip in (np.inf, 1e-3):
        discrete = nh.discretize(nh.Forced(TOP, weight, nh.Slip(AXIS, grip)), 2.0)
        orbit = nh.simulate(discrete, body_velocity=(2.0, -1.0, 0.0), steps=5, throw=False)
        assert orbit.outcome in (nh.Outcome.no_real_branch, nh.Outcome.branch_unverified, nh.Outcome.not_converged)
