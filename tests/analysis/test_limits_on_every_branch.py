"""Orbits that take a random real value at every step tend to the attracting momentum, or end; limits and turns."""

import dataclasses
from collections.abc import Callable
from typing import Any

import mpmath
import numpy as np
import pytest
from bodies import ATTRACTING, mass_tensor
from refusals import refusals

import nonholo as nh

FAMILIES: dict[str, Callable[[np.random.Generator], Any]] = {
    "top SO(3)": lambda rng: nh.SuslovTop(mass_tensor(nh.SO(3), rng)),
    "top SO(5)": lambda rng: nh.SuslovTop(mass_tensor(nh.SO(5), rng)),
    "sleigh SE(2)": lambda rng: nh.ChaplyginSleigh(
        1.0, rng.uniform(0.3, 1.0), rng.choice([-1, 1]) * rng.uniform(0.4, 1)
    ),
    "sleigh SE(4)": lambda rng: nh.MultidimensionalSleigh(
        1.0, [rng.choice([-1, 1]) * rng.uniform(0.4, 1), *(0.3 * rng.normal(size=3))], mass_tensor(nh.SO(4), rng) / 4
    ),
}


def _walked(body: Any, rng: np.random.Generator, steps: int, **start: np.ndarray) -> nh.Orbit:
    """Run with a random real value at each step."""

    def chosen(result: Any, _: np.ndarray) -> int | None:
        return rng.choice(np.flatnonzero(result.is_real)) if result.is_real.any() else None

    run = {"branch": chosen, "throw": False, "reconstruct": False}
    return nh.simulate(nh.discretize(body, 1.0), **start, steps=steps, **run)


@pytest.mark.profile("problems", keep=["sleigh SE(2)", "top SO(3)"])
@pytest.mark.parametrize("name", FAMILIES)
def test_random_walks_have_the_limits_of_asymptotics(name: str) -> None:
    """Below the line of equilibria a walk ends, or on the velocity that `asymptotics` says; of sleighs none ends."""
    rng = np.random.default_rng(1)
    for _ in range(3):
        body = FAMILIES[name](rng)
        r = rng.normal(size=body.rank)
        line = nh.equilibria(nh.discretize(body, 1.0), 1e-9).highest_energy
        level = 10 ** rng.uniform(-1.0, 2.0) if "sleigh" in name else rng.uniform(0.05, 1.0) * line
        orbit = _walked(body, rng, 120, momentum=r * np.sqrt(level / body.constrained_energy(r)))
        limits = nh.asymptotics(orbit)
        assert not limits.persists
        if orbit.outcome == nh.Outcome.successful:
            assert np.abs(orbit.body_velocity[-1] - limits.velocity_after).max() <= 1e-4 * np.sqrt(level)
        else:
            assert ("top" in name, orbit.outcome) == (True, nh.Outcome.no_real_branch)


@pytest.mark.parametrize("n", [3, 6])
def test_above_the_line_every_walk_ends(n: int) -> None:
    """Above the line of equilibria tops take no more steps than the bound, whatever values they take."""
    rng, lengths = np.random.default_rng(n), []
    while len(lengths) < 8:
        top = nh.SuslovTop(mass_tensor(nh.SO(n), rng))
        turn = rng.normal(size=top.rank)
        W = top.group.exp(rng.uniform(1.2, 2.8) * turn / np.linalg.norm(turn) @ top.constraint_subspace)
        energy = _walked(top, rng, 1, displacement=W).energy[0]
        ratio = np.sqrt(energy / nh.equilibria(nh.discretize(top, 1.0), 1e-9).highest_energy)
        if ratio > 1.05:
            b, c = np.linalg.eigvalsh(top.constrained_inertia), np.linalg.norm(top.coupling)
            bound = 2 * ratio / (ratio - 1) ** 2 * (b[-1] / c + c / b[0])
            orbit = _walked(top, rng, int(bound) + 1, displacement=W)
            lengths.append(len(orbit))
            assert orbit.outcome == nh.Outcome.no_real_branch
            assert len(orbit) <= bound
    assert max(lengths) >= 2


def test_no_limits_above_the_line() -> None:
    """Above the highest energy of equilibria an orbit has no limits, since it ends; just below it has."""
    top = nh.discretize(TOP, 0.5)
    line = nh.critical_energies(top).line
    displacement = nh.SO(3).exp(np.array([0.5, 1.3, 0.0]))
    orbit = nh.simulate(top, displacement=displacement, steps=9, branch="smallest", throw=False)
    assert orbit.energy[0] > line
    assert orbit.outcome == nh.Outcome.no_real_branch
    limits = nh.asymptotics(orbit)
    assert (limits.velocity_after, limits.axis_before, limits.persists) == (None, None, False)


def test_highest_energy_of_equilibria() -> None:
    """It is q_c / (2 h^2 |c|^2) for a top with n = 4 and a sleigh that turns at rest; a sleigh that glides has none."""
    top, h, J = nh.SuslovTop(np.diag([1.0, 0.7, 0.9, 0.6]) + 0.2), 0.5, np.diag([0.5, 0.7, 0.4]) + 0.1
    gliding, turning = (nh.MultidimensionalSleigh(1.3, [a, 0.2, -0.1], J) for a in (0.6, 0.0))
    rolled = J[1:, 1:] + J[0, 0] * np.eye(2), J[0, 1:]
    for body, (B, c) in ((top, (top.constrained_inertia, top.coupling)), (turning, rolled)):
        highest = nh.equilibria(nh.discretize(body, h), 0.1).highest_energy
        assert highest == pytest.approx(c @ B @ c / (c @ c) / (2 * h * h), rel=1e-13)
    assert nh.equilibria(nh.discretize(gliding, h), 0.1).highest_energy is None


TOP = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
TILTED = nh.SuslovTop.from_inertia([[3.0, 0.1, 0.2], [0.1, 2.0, 0.3], [0.2, 0.3, 2.5]], (2 / 3, -1 / 3, 2 / 3))
SLEIGH = nh.ChaplyginSleigh(0.9, 0.4, 0.7, 0.35)


SLEIGHS = [(1.0, 1.0, 0.5, 0.0), (0.9, 0.4, 0.7, 0.35), (1.5, 0.6, -0.5, 0.2), (1.0, 0.75, 0.5, 0.1), (1, 1, 0.02, 0)]


@pytest.mark.parametrize("parameters", SLEIGHS)
@pytest.mark.parametrize("omega", [0.8, -0.8])
def test_turns_of_a_flow(parameters: tuple, omega: float) -> None:
    """The heading of a long flow turns as said, and its direction of motion by half a turn less, modulo full ones."""
    sleigh, start = nh.ChaplyginSleigh(*parameters), {"restricted_velocity": (omega, 0.3), "method": "closed_form"}
    result = nh.asymptotics(nh.flow(sleigh, times=[0.0, 1.0], **start))
    ends = [nh.flow(sleigh, times=[0.0, t, 1.01 * t], **start) for t in (-1e4, 1e4)]
    assert ends[1].heading[-1] - ends[0].heading[-1] == pytest.approx(result.heading_turn, rel=1e-14)
    assert nh.asymptotics(sleigh).heading_turn == abs(result.heading_turn)
    directions = [np.array([1, 1j]) @ np.diff(end.position[1:], axis=0)[0] for end in ends]
    turned = np.angle(-directions[1] / directions[0])  # the early one is taken against time
    assert np.angle(np.exp(1j * (result.motion_turn - turned))) == pytest.approx(0.0, abs=1e-12)
    for end, limit in zip(ends, (result.velocity_before, result.velocity_after), strict=True):
        assert np.abs(end.body_velocity[-1] - limit).max() <= 1e-14


def test_turn_of_the_map_is_second_order() -> None:
    """The turn of discrete orbits tends to that of the flow with h^2; the limits of the velocity are the same."""
    exact, errors = nh.asymptotics(SLEIGH).heading_turn, []
    for h in (0.2, 0.1, 0.05):
        orbit = nh.simulate(nh.discretize(SLEIGH, h), restricted_velocity=(0.8, 0.1), steps=5)
        result = nh.asymptotics(orbit)
        assert result.persists
        errors.append(result.heading_turn - exact)
        speed = np.sqrt(2 * orbit.energy[0] / SLEIGH.mass)
        assert np.abs(result.velocity_after - [0.0, speed, 0.0]).max() <= 1e-14
    assert np.abs(np.log2(np.divide(errors[:-1], errors[1:])) - 2).max() <= 0.1


@pytest.mark.parametrize("top", [TOP, TILTED], ids=["e3", "tilted"])
@pytest.mark.parametrize("kind", ["flow", "map"])
def test_axes_of_a_top(top: nh.SuslovTop, kind: str) -> None:
    """Axes in body and space are those that long runs end on, and do not depend on the state one starts from."""
    start = {"restricted_velocity": (0.6, 0.7)}
    if kind == "flow":
        orbit, later = (nh.flow(top, times=[0.0, t], rtol=1e-12, atol=1e-13, **start) for t in (2.0, 100.0))
        tail = nh.flow(top, momentum=orbit.restricted_momentum[1], configuration=orbit.configuration[1], times=[0, 1])
    else:
        orbit, later = (nh.simulate(nh.discretize(top, 0.2), steps=steps, **start) for steps in (10, 1000))
        tail = orbit[3:]
    result, same = nh.asymptotics(orbit), nh.asymptotics(tail)
    assert np.abs(result.axis_after + result.axis_before).max() <= 1e-15
    assert np.abs(result.axis_after - nh.asymptotics(top).axis_after).max() <= 1e-14
    assert np.abs(later.body_velocity[-1] - result.velocity_after).max() <= 1e-8
    spatial = later.configuration[-1] @ later.body_velocity[-1]
    assert np.abs(spatial / np.linalg.norm(spatial) - result.spatial_axis_after).max() <= 1e-7
    for name in ("spatial_axis_before", "spatial_axis_after"):
        assert np.abs(getattr(result, name) - getattr(same, name)).max() <= 1e-8


def test_turn_of_an_orbit_without_poses() -> None:
    """The turn does not depend on where one starts, and needs no poses; its sign is that of omega."""
    discrete = nh.discretize(SLEIGH, 0.1)
    for omega in (0.8, -0.8):
        posed, bare = (
            nh.simulate(discrete, restricted_velocity=(omega, 0.1), steps=7, reconstruct=poses)
            for poses in (True, False)
        )
        turn = nh.asymptotics(posed).heading_turn
        assert nh.asymptotics(bare).heading_turn == turn
        assert nh.asymptotics(posed[4:]).heading_turn == pytest.approx(turn, rel=1e-12)
        assert np.sign(turn) == np.sign(omega)


@pytest.mark.profile("routes", keep=["turning sleigh 3"])
@pytest.mark.parametrize("name", ["top 6", "sleigh 3", "turning sleigh 3"])
def test_limits_in_higher_dimensions(name: str) -> None:
    """The velocity limits are reached by long discrete orbits; for a_1 = 0 the advance u is kept."""
    system = ATTRACTING[name]
    start = 0.4 * np.array([1.0, -0.7, 0.5, 0.8, -0.3])[: system.rank]
    orbit = nh.simulate(nh.discretize(system, 0.2), restricted_velocity=start, steps=20_000, save_every=20_000)
    result = nh.asymptotics(orbit)
    assert result.persists == (name == "top 6")  # Theorem 9.5: below the first fold
    assert np.abs(orbit.body_velocity[-1] - result.velocity_after).max() <= 1e-8
    assert system.constrained_energy(result.velocity_before @ system.inertia_operator) == pytest.approx(orbit.energy[0])


def test_motions_that_stay() -> None:
    """From an equilibrium nothing changes; a balanced sleigh turns forever, and a balanced top keeps its axis."""
    straight = nh.asymptotics(nh.simulate(nh.discretize(SLEIGH, 0.1), restricted_velocity=(0.0, -1.0), steps=3))
    assert straight.heading_turn == 0
    assert np.array_equal(straight.velocity_before, straight.velocity_after)
    circling = nh.asymptotics(nh.flow(nh.ChaplyginSleigh(1.0, 1.0, 0.0), restricted_velocity=(1.0, 1.0), times=[0, 1]))
    assert circling.heading_turn is None
    assert nh.asymptotics(nh.ChaplyginSleigh(1.0, 1.0, 0.0)).heading_turn is None
    top = nh.SuslovTop(np.diag([1.0, 2.0, 3.0]))
    limits = nh.asymptotics(nh.simulate(nh.discretize(top, 0.1), restricted_velocity=(0.3, 0.4), steps=3))
    assert np.array_equal(limits.spatial_axis_before, limits.spatial_axis_after)


def _of_another_map() -> nh.Orbit:
    """Return an orbit of the logarithmic difference, above the line of equilibria too."""
    orbit = nh.simulate(nh.discretize(TOP, 0.2), restricted_velocity=(1.0, -0.5), steps=1)
    return dataclasses.replace(orbit, motion=nh.discretize(TOP, 2.0, difference="logarithmic"))


# Other systems and maps, and orbits that settle too slowly.
test_refusals = refusals(
    (_of_another_map, "conserve the energy"),
    (lambda: nh.VeselovaTop(np.diag([1.0, 2.0, 3.0])), "top or a sleigh"),
    (lambda: nh.simulate(nh.discretize(SLEIGH, 1e-6), restricted_velocity=(0.5, 0.5), steps=2), "within 1000000 steps"),
    ask=lambda make: nh.asymptotics(make()),
)


@pytest.mark.parametrize("parameters", [(0.9, 0.4, 0.7, 0.35), (1.5, 0.6, -0.5, 0.2), (1.0, 0.75, 0.5, 0.1)])
def test_heading_turn_to_twelve_digits(parameters: tuple) -> None:
    """The turn is the integral of dtheta = du/(a omega(u)) over the level, taken to 30 digits."""
    with mpmath.workdps(30):
        m, J, a, _ = (mpmath.mpf(x) for x in parameters)
        E, inertia = mpmath.mpf(2), J + m * a * a
        edge = mpmath.sqrt(2 * E / m)

        def turned(x: mpmath.mpf) -> mpmath.mpf:
            return edge * mpmath.cos(x) / (abs(a) * mpmath.sqrt((2 * E - m * (edge * mpmath.sin(x)) ** 2) / inertia))

        expected = mpmath.quad(
            turned, [-mpmath.pi / 2 + mpmath.mpf(10) ** -13, 0, mpmath.pi / 2 - mpmath.mpf(10) ** -13]
        )
    assert abs(nh.asymptotics(nh.ChaplyginSleigh(*parameters)).heading_turn / float(expected) - 1) <= 1e-12
