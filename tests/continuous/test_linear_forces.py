"""Flows under weights and friction by Taylor series: 60 digits, DOP853 on the definition, what free flows have."""

import signal
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from comparisons import assert_same
from problems import EVERY
from references import golden, numbers
from scipy.integrate import solve_ivp

import nonholo as nh
from nonholo.continuous import _forced
from nonholo.systems import AbstractSystem

TILTED, SLEIGH = EVERY["tilted top"], nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.3)
_GENERAL = "suslov 4", "top on SO(7)", "free on SO(4)", "any d on SE(3)", "sleigh 3"
BODIES: dict[str, AbstractSystem] = {
    "tilted top": TILTED,
    "sleigh with b": SLEIGH,
    **{name: EVERY[name] for name in (*_GENERAL, "Heisenberg", "nothing moves", "product")},
}
TIMES = np.array([0.0, 0.3, 1.0, 4.0])


def _under(body: AbstractSystem, kinds: str, seed: int = 3) -> nh.Forced:
    """Return a body under a weight at a random point, and friction that also turns, or one of them."""
    rng, group = np.random.default_rng(seed), body.group
    n = group.size - group.is_affine
    heavy = nh.Gravity(*(rng.normal(size=(2, n)) / np.sqrt(n)))
    C = rng.normal(size=(2, group.dim, group.dim)) / (2 * group.dim)
    friction = nh.Friction(C[0] @ C[0].T + C[1] - C[1].T + np.eye(group.dim) / 8)
    return nh.Forced(body, heavy if "weight" in kinds else None, friction if "friction" in kinds else None)


def _start(body: AbstractSystem, seed: int = 5) -> dict[str, Any]:
    rng = np.random.default_rng(seed)
    return {"restricted_velocity": rng.normal(size=body.rank) / 2, "configuration": body.group.random(rng)}


def _missed(result: np.ndarray, wanted: np.ndarray) -> float:
    """Return the largest error, relative to the size of each row."""
    scale = np.maximum(1.0, np.abs(wanted).reshape(len(wanted), -1).max(axis=1, initial=0.0))
    gaps = np.abs(result - wanted).reshape(len(wanted), -1).max(axis=1, initial=0.0)
    return float((gaps / scale).max())


@pytest.mark.profile("problems", cases=["heavy top on SO(4)"])
@pytest.mark.parametrize("case", golden("linear_forces.json"), ids=lambda case: case["name"])
def test_sixty_digits(case: dict[str, Any]) -> None:
    """Velocities and poses are right to 3e-13 of their size over twenty units of time; rounding alone is 1e-14."""
    group = {"O": nh.SO, "E": nh.SE}[case["group"][1]](int(case["group"][3]))
    body = nh.LLSystem(group, case["mass_tensor"], case["constraint_subspace"])
    friction = nh.Friction(case["friction"]) if case["friction"] else None
    forced = nh.Forced(body, nh.Gravity(case["force"], case["point"]), friction)
    orbit = nh.flow(forced, restricted_velocity=case["restricted_velocity"], times=case["times"])
    wanted = numbers(case["restricted_velocities"]) @ body.constraint_subspace
    assert np.abs(orbit.body_velocity - wanted).max() <= 3e-13 * np.abs(wanted).max()
    assert _missed(orbit.configuration, numbers(case["configurations"])) <= 3e-13


@pytest.mark.profile("routes", cases=["product*", "top on*", "suslov 4-friction", "suslov 4-weight", "any d*-weight"])
@pytest.mark.parametrize("kinds", ["weight", "friction", "weight and friction"])
@pytest.mark.parametrize("name", BODIES)
def test_the_definition_solved_by_another_method(name: str, kinds: str) -> None:
    """DOP853 on `vector_field`, whose forces come from their own definitions, agrees to its errors of 1e-13 a step."""
    body, forced = BODIES[name], _under(BODIES[name], kinds)
    start = _start(body)
    orbit = nh.flow(forced, **start, times=TIMES)
    first = np.concatenate([orbit.restricted_momentum[0], np.ravel(start["configuration"])])
    field, k = nh.vector_field(forced), body.rank
    rows = solve_ivp(field, (0.0, TIMES[-1]), first, "DOP853", TIMES, rtol=1e-13, atol=1e-15).y.T
    assert _missed(orbit.restricted_momentum, rows[:, :k]) <= 2e-12
    assert _missed(orbit.configuration.reshape(len(TIMES), -1), rows[:, k:]) <= 2e-12


@pytest.mark.profile("routes", keep=["tilted top", "sleigh*"])
@pytest.mark.parametrize("name", ["tilted top", "sleigh with b", "suslov 4", "any d on SE(3)"])
def test_potentials_of_several_vectors(name: str) -> None:
    """U = tr(A^T g), told by its levers, moves a body as the function U does, by its differences."""
    body, start = BODIES[name], _start(BODIES[name])
    A = np.random.default_rng(7).normal(size=(body.group.size,) * 2) / 2

    one, other = (
        nh.flow(nh.Forced(body, U), **start, times=TIMES) for U in (nh.Linear(A), lambda g: float(np.sum(A * g)))
    )
    assert 0 < _missed(one.configuration, other.configuration) <= 1e-10
    assert np.ptp(one.energy) <= 1e-13 * (1 + np.abs(one.energy).max())


@pytest.mark.parametrize("name", BODIES)
def test_energy_is_kept_under_a_weight_and_lost_by_friction(name: str) -> None:
    """T + U to rounding over a hundred units of time, and a way back; with friction it falls from look to look."""
    forced, start = _under(BODIES[name], "weight"), _start(BODIES[name])
    there = nh.flow(forced, **start, times=np.append(np.linspace(0.0, 1.0, 3), np.linspace(20.0, 100.0, 5)))
    scale = 1.0 + np.abs(there.energy - forced.potential_energy(there.configuration)).max()
    assert np.ptp(there.energy) <= 1e-12 * scale
    last = {"momentum": there.restricted_momentum[2], "configuration": there.configuration[2]}
    back = nh.flow(forced, **last, times=there.time[2::-1])
    assert _missed(back.configuration[::-1], there.configuration[:3]) <= 1e-12
    slowed = nh.flow(_under(BODIES[name], "weight and friction"), **start, times=np.linspace(0.0, 5.0, 50))
    assert np.diff(slowed.energy).max() <= 1e-14 * scale


@pytest.mark.parametrize("name", ["tilted top", "sleigh with b", "any d on SE(3)"])
def test_states_between_and_among_others(name: str) -> None:
    """A state has the same bits alone, among thousands, and asked for later; so have those of a start at rest."""
    forced, start = _under(BODIES[name], "weight and friction"), _start(BODIES[name])
    for factor in (1.0, 0.0):
        arguments = start | {"restricted_velocity": factor * start["restricted_velocity"]}
        alone, among = (
            nh.flow(forced, **arguments, times=times) for times in ((0.0, 9.0), np.arange(9 * 128 + 1) / 128)
        )
        for orbit in (alone, alone.at(among.time)):
            chosen = among.at([0.0, 9.0]) if len(orbit) == 2 else among
            assert_same(orbit, chosen, "reduced_momentum", "configuration")


@pytest.mark.profile(
    "routes", keep=["any d on SE(3)-friction", "sleigh*-weight", "tilted top-weight and friction", "free*-weight"]
)
@pytest.mark.parametrize("kinds", ["weight", "friction", "weight and friction"])
@pytest.mark.parametrize("name", [name for name, body in BODIES.items() if body.homogeneous_mass_tensor is not None])
def test_members_have_the_bits_of_flows_alone(name: str, kinds: str) -> None:
    """From rest, slow and quick, each with its own unit of time."""
    forced, start = _under(BODIES[name], kinds), _start(BODIES[name])
    velocities = np.multiply.outer([0.0, 1e-9, 0.3, 1.0, 40.0, -3.0, 5.0, 7.0, 2.0], start["restricted_velocity"])
    batch = nh.ensemble(forced, restricted_velocity=velocities, configuration=start["configuration"], times=TIMES)
    for member, velocity in enumerate(velocities):
        alone = nh.flow(forced, **(start | {"restricted_velocity": velocity}), times=TIMES)
        assert_same(batch.orbit(member), alone, "reduced_momentum", "configuration")


@pytest.mark.parametrize("size", [2.0**-60, 2.0**40])
def test_units_of_time_change_no_bit(size: float) -> None:
    """Velocities and friction times a power of two, a weight times its square: the same path to the last bit."""
    paths = []
    for factor in (1.0, size):
        heavy, friction = nh.Gravity([0.3 * factor**2, -(factor**2)], [0.5, 0.25]), nh.Friction([0.125 * factor] * 3)
        forced, velocity = nh.Forced(SLEIGH, heavy, friction), np.array([0.8, -0.5]) * factor
        paths.append(nh.flow(forced, restricted_velocity=velocity, times=np.array([0.0, 3.0, 20.0]) / factor))
    assert np.array_equal(paths[0].configuration, paths[1].configuration)
    assert np.array_equal(paths[0].restricted_momentum * size, paths[1].restricted_momentum)


def test_small_things_keep_their_digits() -> None:
    """A body of 1e-12 kg under its weight, and one that leaves an unstable equilibrium, to the digits of large ones."""
    tiny, usual = (
        nh.flow(
            nh.Forced(nh.SuslovTop(mass * np.diag([1.0, 1.2, 0.6])), nh.Gravity([0, 0, -2 * mass], [0.1, 0, 0.3])),
            restricted_velocity=(0.4, -0.2), times=(0.0, 5.0, 20.0),
        )
        for mass in (2.0**-40, 1.0)
    )  # fmt: skip
    assert np.abs(tiny.configuration - usual.configuration).max() < 1e-13
    upright = nh.Forced(nh.SuslovTop(np.diag([1.0, 1.0, 0.5])), nh.Gravity([0.0, 0.0, -1.0], [0.0, 0.0, 1.5]))
    falling = nh.flow(upright, restricted_velocity=(1e-12, 0.0), times=(0.0, 5.0, 10.0))
    # linear there: the angle is sinh(t) v
    assert falling.body_velocity[:, 1] == pytest.approx(1e-12 * np.cosh(falling.time), rel=1e-9)


def test_events_under_a_weight() -> None:
    """A crossing is located where DOP853 of a function that is the same potential has it."""
    F, x = np.array([0.3, -0.2, -1.0]), np.array([0.2, 0.1, 0.5])
    result = [
        nh.flow(
            nh.Forced(TILTED, potential), restricted_velocity=(0.4, -0.5), times=np.linspace(0.0, 6.0, 3),
            events=[lambda orbit: orbit.configuration[:, 2, 2] - 0.5],
        ).events[0].time
        for potential in (nh.Gravity(F, x), lambda g: -F @ g @ x)
    ]  # fmt: skip
    assert len(result[0]) >= 1
    assert result[0] == pytest.approx(result[1], abs=1e-10)


@pytest.mark.parametrize("heavy", [None, nh.Gravity([3.0, -1.0], [0.1, 0.2])], ids=["friction", "weight"])
def test_strong_friction_is_not_too_stiff(heavy: nh.Gravity | None) -> None:
    """Of 1e8 over three units of time: at once as quick as weight and friction balance, to 1e-9 of a free motion."""
    nh.flow(_under(SLEIGH, "friction"), restricted_velocity=(0.3, -0.7), times=(0.0, 1e8))
    forced = nh.Forced(SLEIGH, heavy, nh.Friction([1e8] * 3))  # steps of series would be 1e8: `too_stiff`
    orbit = nh.flow(forced, restricted_velocity=(0.3, -0.7), times=np.linspace(0.0, 3.0, 7))
    push = np.zeros((7, 3)) if heavy is None else heavy.covector(nh.SE(2), orbit.configuration)
    assert np.abs(orbit.body_velocity[1:] - (push * [1, 1, 0] / 1e8)[1:]).max() < 1e-9 * 1e-3
    assert np.abs(orbit.configuration - np.eye(3)).max() < 1e-6


def test_stiff_and_other_steps_agree(monkeypatch: pytest.MonkeyPatch) -> None:
    """A flow that is solved by series and by the implicit method, whose errors are 1e-9 a step; exact along a line."""
    blade = nh.Forced(nh.ChaplyginSleigh(1.0, 1.0, 0.0), nh.Gravity([2.0, 0.0], [0.0, 0.0]), nh.Friction([0, 5e3, 0]))
    slow, times = _under(TILTED, "weight and friction"), np.linspace(0.0, 5.0, 11)
    result = []
    for bound in (2e6, 0.0):
        monkeypatch.setattr(_forced, "_STIFF", bound)
        result.append(nh.flow(slow, restricted_velocity=(0.4, -0.5), times=times))
        line = nh.flow(blade, body_velocity=(0.0, 1.0, 0.0), times=times)
        exact = 2.0 / 5e3 + (1 - 2.0 / 5e3) * np.exp(-5e3 * times)
        assert np.abs(line.body_velocity[:, 1] - exact).max() < (1e-15 if bound else 1e-10)
    assert 0 < np.abs(result[0].configuration - result[1].configuration).max() < 1e-7


def test_fast_motions_of_members_end_early() -> None:
    """More steps than are allowed at the rate so far are not taken: the outcome is `too_stiff`."""
    quick = nh.Forced(SLEIGH, nh.Gravity([1e60, 0.0], [0.1, 0.2]))
    batch = nh.ensemble(quick, restricted_velocity=[(0.3, -0.7)] * 2, times=(0.0, 3.0))
    assert [nh.Outcome(code) for code in batch.outcome] == [nh.Outcome.too_stiff] * 2


def _switch(*state: Any) -> np.ndarray:
    return np.array([np.sign(np.sin(1e3 * state[0])), 0.0, 0.0])


def _stick(*state: Any) -> np.ndarray:
    return -3.0 * np.sign(state[2])


def _drag(*state: Any) -> np.ndarray:
    return -1e8 * state[2]


def _flow(potential: Any, force: Any, times: Any = TIMES) -> nh.Orbit:
    return nh.flow(nh.Forced(SLEIGH, potential, force), times=times, restricted_velocity=(0.3, -0.7))


ENDLESS: dict[str, tuple[Any, Any, str, str]] = {
    "drag": (None, _drag, "too_stiff", "_drag"),
    "switch": (None, _switch, "too_stiff", "_switch"),
    "sticks": (None, _stick, "too_stiff", "_stick"),
    "weight": (nh.Gravity([1e16, 0.0], [0.1, 0.2]), None, "too_stiff", "Gravity"),
    "heavy weight": (nh.Gravity([1e149, 0.0], [0.1, 0.2]), None, "too_stiff", "Gravity"),
    "at once": (None, lambda *_: np.array([1e200, 0.0, 0.0]), "nonfinite", "<lambda>"),
}


@pytest.mark.profile("problems", keep=["weight", "heavy weight", "at once"])
@pytest.mark.parametrize("name", ENDLESS)
def test_flows_without_end_are_given_up(name: str) -> None:
    """After some thousand steps at most, with the orbit so far, the force by name and what to try."""
    potential, force, outcome, acting = ENDLESS[name]
    with pytest.raises(nh.OutcomeError, match=rf"under `{acting}` .*: {outcome}\. .*Try ") as ended:
        _flow(potential, force)
    assert (str(ended.value.outcome), len(ended.value.orbit)) == (outcome, 1)


def test_ctrl_c_ends_a_flow_under_forces() -> None:
    """Python is asked at every step, so that it comes within a second."""

    def slow(*state: Any) -> np.ndarray:
        return np.array([np.sin(50 * state[0]), 0.0, 0.0])

    def stop(*_: Any) -> None:
        raise KeyboardInterrupt

    before: Callable[..., Any] | int | None = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, 0.1)
    begun = time.process_time()
    try:
        with pytest.raises(KeyboardInterrupt):
            _flow(None, slow, (0.0, 1e4))
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    assert time.process_time() - begun < 1.1
