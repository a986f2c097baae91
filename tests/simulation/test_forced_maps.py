"""Maps and flows under forces: order, balance, what is conserved, what is stored; what does not know of forces."""

import functools
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zarr
from bodies import GENERAL, weight
from comparisons import assert_near, assert_same
from refusals import refusals
from simulation.forces import HEAVY, RUB, SLEIGH, SLOPE, TOP, VESELOVA, drive, hill, start_of

import nonholo as nh
from nonholo.discrete.routes._forced import FunctionRoute
from nonholo.orbit import First
from nonholo.systems import AbstractSystem

SYSTEMS: dict[str, AbstractSystem] = {
    "top": TOP,
    "tilted top": nh.SuslovTop.from_inertia(np.diag([2.0, 3.0, 4.0]), (0.6, 0.8, 0)),
    "sleigh": SLEIGH,
    "sleigh on SE(3)": GENERAL["sleigh 3"][0],
    "veselova": VESELOVA,
    **{name: GENERAL[name][0] for name in ("suslov 4", "any d on SE(3)", "right-invariant on SE(3)")},
}
THREE = pytest.mark.parametrize("system", [TOP, SLEIGH, VESELOVA], ids=["top", "sleigh", "veselova"])
SPAN = 0.8


def push(time: float, g: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Return a force of time alone: a map has a table of it."""
    del g
    return np.cos(3 * time + np.arange(len(w)))


def _table(time_step: float, dim: int) -> np.ndarray:
    return np.array([push((k + 0.5) * time_step, np.eye(3), np.zeros(dim)) for k in range(round(SPAN / time_step))])


def _friction(system: AbstractSystem) -> nh.Friction:
    dim = system.group.dim
    return nh.Friction(0.1 * np.eye(dim) + 0.05 + 0.1 * (np.eye(dim, k=1) - np.eye(dim, k=-1)))


KINDS: dict[str, Callable[[AbstractSystem], tuple[Any, list[Any]]]] = {
    "gravity": lambda system: (weight(system), []),
    "potential": lambda _: (hill, []),
    "friction": lambda system: (None, [_friction(system)]),
    "coefficients": lambda system: (None, [nh.Friction(np.linspace(0.1, 0.4, system.group.dim))]),
    "gravity with friction": lambda system: (weight(system), [_friction(system)]),
    "function": lambda _: (None, [drive]),
    "both functions": lambda _: (hill, [drive]),
    "table": lambda _: (None, [push]),
    "friction and table": lambda system: (None, [_friction(system), push]),
    "weight and all three": lambda system: (weight(system), [_friction(system), drive, push]),
}


def _under(system: AbstractSystem, potential: Any, forces: list[Any]) -> nh.Forced:
    return nh.Forced(system, potential, forces[0] if len(forces) == 1 else forces or None)


def _of_flow(forces: list[Any]) -> list[Any]:
    """Return the forces with one function of the time, which a flow may have."""
    functions = [force for force in forces if callable(force)]
    others = [force for force in forces if not callable(force)]
    return [*others, lambda *state: sum(force(*state) for force in functions)] if functions else others


def _slope(errors: list[float]) -> float:
    return float(np.polyfit(range(len(errors)), -np.log2(errors), 1)[0])


LATER = ["any d*-[!g]*", "right*)-[!g]*", "suslov 4-[!g]*", "veselova*", "*-both functions", "sleigh on SE(3)-p*"]
LATER += ["tilted top-*"]


@pytest.mark.profile("routes", cases=LATER)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("system", SYSTEMS.values(), ids=SYSTEMS)
def test_the_map_is_of_order_two(system: AbstractSystem, kind: str) -> None:
    """Momentum, pose and the balance of energy are of order 2 in the time step, constraint and group are kept."""
    (potential, forces), start, missed = KINDS[kind](system), start_of(system), []
    flow = nh.flow(_under(system, potential, _of_flow(forces)), **start, times=(0.0, SPAN))
    for h in (0.08, 0.04, 0.02):
        own = [_table(h, system.group.dim) if force is push else force for force in forces]
        orbit = nh.simulate(nh.discretize(_under(system, potential, own), h), **start, steps=round(SPAN / h))
        balance = orbit.energy - orbit.energy[0] - orbit.work
        momentum = orbit.restricted_momentum[-1] - flow.restricted_momentum[-1]
        pose = orbit.configuration[-1] - flow.configuration[-1]
        missed.append([float(np.abs(x).max()) for x in (momentum, pose, balance)])
        invariants = nh.invariants(orbit)
        assert max(invariants.constraint_residual, invariants.group_residual or 0.0) < 1e-13
    for errors in np.transpose(missed)[: 3 if kind != "friction" else 2]:
        assert errors[-1] < 1e-13 or abs(_slope(list(errors)) - 2) < 0.1, errors


def test_no_force_gives_the_bits_of_the_free_map_and_flow() -> None:
    """Forced with neither argument is the free system, and so is one with a table of zeros, to the last bit."""
    for system in (TOP, SLEIGH, VESELOVA):
        arguments = [system, nh.Forced(system)]
        if system is not VESELOVA:
            arguments.append(nh.Forced(system, force=np.zeros((50, 3)), scheme="variational"))
        free, plain, *resting = (
            nh.simulate(nh.discretize(each, 0.1), **start_of(system), steps=50) for each in arguments
        )
        assert_same(free, plain, "momentum", "configuration", "multipliers")
        for same in resting:
            assert_same(free, same, "restricted_momentum", "pose", "chart")
        flows = [nh.flow(each, **start_of(system), times=(0.0, 1.0)) for each in arguments[:2]]
        assert np.array_equal(flows[0].momentum, flows[1].momentum)


def test_functions_give_the_impulses_of_what_is_compiled() -> None:
    """Weight, friction, table and a force of the time, by the definition of the impulses, agree with the kernel."""
    tilted = nh.SuslovTop.from_inertia(np.diag([2.0, 3.0, 4.0]), (0.6, 0.8, 0))
    spatial = nh.Gravity([0.1, -0.2, -0.5], [0.3, 0.1, 0.2])
    rng = np.random.default_rng(6)
    for system, heavy in ((TOP, HEAVY), (SLEIGH, SLOPE), (tilted, HEAVY), (GENERAL["any d on SE(3)"][0], spatial)):
        rub, dim = nh.Friction(rng.uniform(0, 0.3, system.group.dim)), system.group.dim
        free = nh.discretize(nh.Forced(system, heavy, rub, "variational"), 0.05).route.compiled_route.single  # type: ignore[union-attr]
        for force in (rub, rng.normal(size=(16, dim)), (rng.normal(size=(16, dim)), rub), push):
            forced = nh.Forced(system, heavy, force, "variational")
            discrete, g = nh.discretize(forced, 0.05), system.group.random(rng)
            orbit = nh.simulate(discrete, restricted_velocity=rng.normal(size=system.rank), configuration=g, steps=16)
            route = FunctionRoute(free, forced)
            stepper = route.stepper(discrete, with_poses=True)
            state, _ = stepper.start(First((orbit.reduced_momentum[0], orbit.canonical_pose[0])))
            rows = tuple(np.empty((17, width)) for width in stepper.columns.values())
            assert stepper.advance(state, 16, 1, rows) == (16, 0)
            mine = stepper.orbit(rows, 0, 1, stepper.settle(rows))
            assert_near(mine, orbit, 1e-13, "reduced_momentum", "cayley", "canonical_pose")


@pytest.mark.profile("problems", keep=["1000 cases"])
@pytest.mark.parametrize("bodies", [10, 100], ids=["1000 cases", "10,000"])
def test_friction_never_adds_energy(bodies: int) -> None:
    """The kinetic energy falls in every step, for random bodies, friction, step sizes and a hundred starts of each."""
    rng, count = np.random.default_rng(8), 0
    for case in range(bodies):
        root = rng.normal(size=(3, 3))
        top, sleigh = nh.SuslovTop(root @ root.T + 0.1 * np.eye(3)), (*rng.uniform(0.2, 3, 2), *rng.normal(size=2))
        system = nh.ChaplyginSleigh(*sleigh) if case % 2 else top
        root, turning = rng.normal(size=(2, 3, 3)) * 10 ** rng.uniform(-3, 3)
        forced = nh.Forced(system, force=nh.Friction(root @ root.T + turning - turning.T))
        discrete = nh.discretize(forced, 10 ** rng.uniform(-3, 3))
        slow = 10 ** rng.uniform(-3, -0.5, (100, 1)) / discrete.time_step * rng.normal(size=(100, 2))
        energy = nh.ensemble(discrete, restricted_velocity=slow, steps=4, save_every=1).energy
        count += np.isfinite(energy[:, 1]).sum()
        assert np.all(np.diff(np.nan_to_num(energy), axis=1) <= 1e-14 * energy[:, :1])
    assert count > 90 * bodies


def test_friction_of_a_balanced_body_is_exact() -> None:
    """Where the free motion has constant velocity, speeds fall by the exact exponentials of kicks at any step size."""
    rub = nh.Friction([0.3, 0.8, 5.0])
    forced = nh.Forced(nh.ChaplyginSleigh(2.0, 0.5, 0.0), force=rub, scheme="variational")
    orbit = nh.simulate(nh.discretize(forced, 2.0), body_velocity=(0.2, 0.3, 0.0), steps=20)
    exact = np.array([0.2, 0.3]) * np.exp(-np.outer(orbit.time, [0.3 / 0.5, 0.8 / 2.0]))
    assert np.abs(orbit.body_velocity[:, :2] - exact).max() < 1e-15


def test_rows_of_a_table_act_over_their_steps() -> None:
    """On a straight motion the momentum gains h times each row; the beginning of a run does not know its end."""
    rows = np.random.default_rng(2).normal(size=(6, 3)) * [0.0, 1.0, 3.0]
    forced = nh.Forced(nh.ChaplyginSleigh(2.0, 0.5, 0.0), force=rows)
    orbit = nh.simulate(nh.discretize(forced, 0.1), body_velocity=(0.0, 0.3, 0.0), steps=6)
    assert np.abs(orbit.restricted_momentum[1:, 1] - 0.6 - 0.1 * np.cumsum(rows[:, 1])).max() < 1e-15
    shorter = nh.simulate(nh.discretize(forced, 0.1), body_velocity=(0.0, 0.3, 0.0), steps=3)
    assert np.array_equal(shorter.momentum, orbit.momentum[:4])
    with pytest.raises(ValueError, match=r"simulate\(steps=...\)"):
        nh.simulate(nh.discretize(forced, 0.1), body_velocity=(0.0, 0.3, 0.0), steps=7)


@THREE
def test_multipliers_hold_no_force(system: AbstractSystem) -> None:
    """Impulses of the constraint are the time step times the reactions of the flow, and hold no part of the force."""
    forced = nh.Forced(system, weight(system), drive)
    h, missed = 0.01, []
    for each in (h, h / 2):
        orbit = nh.simulate(nh.discretize(forced, each), **start_of(system), steps=round(0.1 / each))
        flow = nh.flow(forced, **start_of(system), times=orbit.time)
        missed.append(np.abs(orbit.multipliers / each - flow.multipliers[1:]).max())
    assert missed[0] < 1e-3
    assert missed[0] / missed[1] > 3.8


def _energy_errors(system: AbstractSystem, point: list[float], h: float, velocity: tuple[float, ...]) -> np.ndarray:
    """Return the largest errors of T + U in the first and in the last tenth of a long run."""
    heavy = nh.Forced(system, nh.Gravity([0.0, 0.0, -1.0], point), scheme="variational")
    orbit = nh.simulate(nh.discretize(heavy, h), body_velocity=velocity, steps=round(2500 / h), save_every=10)
    error, tenth = np.abs(orbit.energy - orbit.energy[0]), len(orbit) // 10
    return np.array([error[:tenth].max(), error[-tenth:].max()])


@THREE
def test_momenta_are_those_of_the_nodes(system: AbstractSystem) -> None:
    """Along the constraint the full momenta are the momenta of the state, and each is a start that gives the rest."""
    for forced in (nh.Forced(system, weight(system), RUB), nh.Forced(system, hill, lambda *state: -state[2])):
        discrete = nh.discretize(forced, 0.05)
        orbit = nh.simulate(discrete, **start_of(system), steps=12)
        along = system.restrict_at(orbit.momentum, orbit.configuration)
        assert np.abs(along - orbit.restricted_momentum).max() < 1e-14
        rest = nh.simulate(discrete, momentum=orbit.momentum[4], configuration=orbit.configuration[4], steps=8)
        assert np.abs(rest.momentum - orbit.momentum[4:]).max() < 1e-13


def test_a_flow_knows_its_time() -> None:
    """A flow that begins later, and one backward, continue a flow under a force that depends on time."""
    forced = nh.Forced(TOP, force=drive)
    flow = nh.flow(forced, **start_of(TOP), times=(0.0, 0.7, 1.1))
    start = {"momentum": flow.restricted_momentum[1], "configuration": flow.configuration[1]}
    for time, state in ((1.1, 2), (0.0, 0)):
        result = nh.flow(forced, **start, times=(0.7, time))
        assert np.abs(result.momentum[1] - flow.momentum[state]).max() < 1e-11
        assert np.abs(result.at(0.7).configuration[0] - flow.configuration[1]).max() < 1e-11


def test_the_energy_error_stays_bounded_or_grows_at_a_rate_of_order_two() -> None:
    """Bounded for a free heavy top and for one symmetric in time; on another orbit a slow drift, of order 2."""
    tensor = np.diag([1.0, 1.2, 0.7])
    for system, point, velocity in (
        (nh.RigidBody(tensor), [0.0, 0.1, 0.4], (0.3, 0.2, 1.0)),
        (nh.SuslovTop(tensor), [0.0, 0.0, 0.4], (0.3, 0.2, 0.0)),
    ):
        first, last = _energy_errors(system, point, 0.05, velocity)
        assert last < 1.2 * first < 4e-3
    drifting = [_energy_errors(nh.SuslovTop(tensor), [0.0, 0.1, 0.4], h, (0.3, 0.2, 0.0))[1] for h in (0.05, 0.025)]
    assert drifting[0] / drifting[1] == pytest.approx(4, rel=0.2)


def test_a_push_beyond_the_fold_ends_the_run() -> None:
    """The branch ends at the step whose row of the table is too large, under the name of a fold."""
    rows = np.zeros((9, 3))
    rows[4, 0] = 1e3
    ended = nh.simulate(nh.discretize(nh.Forced(TOP, force=rows), 0.1), **start_of(TOP), steps=9, throw=False)
    assert (str(ended.outcome), len(ended)) == ("no_real_branch", 4)


def test_stiff_friction_of_a_function_is_solved() -> None:
    """A friction so stiff that substitution fails is solved by Newton's method."""
    forced = nh.Forced(nh.ChaplyginSleigh(2.0, 0.5, 0.0), force=lambda *state: -1e3 * state[2])
    orbit = nh.simulate(nh.discretize(forced, 0.1), body_velocity=(0.2, 0.3, 0.0), steps=10)
    assert np.all(np.diff(np.abs(orbit.restricted_momentum), axis=0) < 0)


START: dict[str, Any] = {"restricted_velocity": [0.5, -0.3]}
READ = ("momentum", "pose", "energy")


def _brake(time: float, g: np.ndarray, w: np.ndarray) -> np.ndarray:
    del g
    return -time * w


@pytest.mark.parametrize("scheme", ["energy", "variational"])
def test_an_orbit_without_states_has_columns_without_rows(scheme: str) -> None:
    """As after a run whose functions are undefined at its start."""
    forced = nh.Forced(TOP, lambda _: np.nan, lambda *_: np.full(3, np.nan), scheme)
    orbit = nh.simulate(nh.discretize(forced, 0.1), **START, steps=3, throw=False)
    shapes = [getattr(orbit, name).shape for name in ("momentum", "multipliers", "work")]
    assert shapes == [(0, 3), (0, 1), (0,)]


def test_a_stored_function_is_not_run(tmp_path: Path) -> None:
    """A store names neither functions nor anything else than our systems and forces; a function has to be passed."""
    discrete = nh.discretize(nh.Forced(TOP, force=_brake), 0.05)
    orbit, path = nh.simulate(discrete, **START, steps=3), tmp_path / "orbit.zarr"
    nh.save_orbit(orbit, path)
    with pytest.raises(ValueError, match="force is a callable"):
        nh.load_orbit(path)
    assert_same(nh.load_orbit(path, discrete=discrete), orbit, *READ)
    run = tmp_path / "run.zarr"
    assert_same(nh.simulate(discrete, **START, steps=3, store=run), orbit, *READ)
    with pytest.raises(ValueError, match="force is a callable"):
        nh.extend(run, 2)
    assert_same(nh.extend(run, 2, discrete=discrete), nh.simulate(discrete, **START, steps=5), *READ)
    task = nh.EnsembleTask(discrete, steps=3, **START)
    nh.sweep(task, nh.Grid({"time_step": [0.05]}), tmp_path / "sweep.zarr")
    with pytest.raises(ValueError, match="force is a callable"):
        nh.resume(tmp_path / "sweep.zarr")
    pushed = nh.discretize(nh.Forced(SLEIGH, force=np.ones((3, 3))), 0.05)
    nh.save_orbit(nh.simulate(pushed, **START, steps=3), tmp_path / "table.zarr")
    report = json.loads(zarr.open_group(tmp_path / "table.zarr", mode="r").attrs["parameters"])  # type: ignore[arg-type]
    assert report["system"] == {"kind": "ChaplyginSleigh", "parameters": {"mass": 1, "inertia": 1, "a": 0.5, "b": 0.3}}


_FORCED = nh.Forced(TOP, HEAVY, RUB)
_MAP = nh.discretize(_FORCED, 0.1)
_RUN = nh.simulate(_MAP, **START, steps=5)
_PUSHED = nh.discretize(nh.Forced(TOP, force=np.ones((5, 3))), 0.1)
_PAIR = nh.Forced(TOP, force=lambda *state: state[2][:2])
_OF_BODIES = nh.equilibria, nh.invariant_measure, nh.conserved_momenta, nh.lyapunov_function, nh.plot.phase_portrait
_OF_DISPLACEMENTS = nh.fold_distance, nh.discrete_legendre, nh.consistency_defect
_REFUSED: list[Callable[[], Any]] = [
    *(functools.partial(ask, _FORCED) for ask in _OF_BODIES),
    *(functools.partial(ask, _MAP) for ask in (nh.momentum_locus, nh.critical_energies, nh.equilibria)),
    *(functools.partial(ask, _MAP, 0.1) for ask in (nh.invariant_curve, nh.flow_obstruction)),
    *(functools.partial(ask, _MAP, np.eye(3)) for ask in _OF_DISPLACEMENTS),
    lambda: nh.step(_MAP, [0.1, 0.2]),
    lambda: nh.branches(_MAP, momentum=[0.1, 0.2], certify=True),
    lambda: nh.inverse_discrete_legendre(_MAP, np.zeros(3)),
    lambda: nh.heteroclinic(_MAP, energy=0.1),
    lambda: nh.asymptotics(_RUN),
    lambda: nh.vector_field(_PUSHED.system),
    lambda: nh.ensemble(_PUSHED, restricted_velocity=np.ones((2, 2)), steps=9),
    lambda: nh.ensemble(nh.Forced(TOP, force=np.ones((3, 3))), restricted_velocity=np.ones((2, 2)), times=(0.0, 1.0)),
    lambda: nh.EnsembleTask(_PUSHED, steps=9),
    lambda: nh.EnsembleTask(_MAP, steps=3, reductions=["final_state", "energy_drift"]),
    lambda: nh.simulate(_MAP, **START, steps=5, branch="nearest"),
    lambda: nh.simulate(_MAP, **START, steps=5, backend="jax"),
    lambda: nh.simulate(_MAP, displacement=np.eye(3), steps=5),
    lambda: nh.discretize(nh.Forced(nh.VeselovaTop(np.diag([1.0, 2.0, 3.0])), HEAVY), 0.1, order=4),
    lambda: nh.discretize(nh.Forced(TOP, HEAVY, scheme="energy"), 0.1, difference="logarithmic"),
    lambda: nh.Forced(TOP, nh.Linear(np.eye(2))),
    lambda: nh.Forced(TOP, nh.Spring([0.1, 0.2], [0.0, 0.0], 1.0)),
    lambda: nh.Forced(TOP, (lambda g: g[0, 0], lambda g: g[1, 1])),
    lambda: nh.Forced(nh.examples.particle().system, lambda q: q[0], scheme="energy"),
    lambda: nh.discretize(_FORCED, 0.1, difference="logarithmic", order=4),
    lambda: nh.flow(_FORCED, **START, times=(0.0, 1.0), method="closed_form"),
    lambda: nh.flow(nh.Forced(TOP, force=np.ones((3, 3))), **START, times=(0.0, 1.0)),
    lambda: nh.Forced(_FORCED, force=RUB),
    lambda: nh.Forced(_FORCED, SLOPE),
    lambda: nh.Forced(3),  # type: ignore[arg-type]
    lambda: nh.Forced(TOP, 3.0),
    lambda: nh.Forced(TOP, SLOPE),
    lambda: nh.Forced(TOP, force=nh.Friction([1.0, 2.0])),
    lambda: nh.Friction([1.0, -2.0, 0.0]),
    lambda: nh.Forced(TOP, force=(RUB, RUB)),
    lambda: nh.Forced(TOP, force=(RUB, np.ones((5, 3)), np.ones((5, 3)))),
    lambda: nh.Forced(TOP, force=(RUB, np.ones((3, 2)))),
    lambda: nh.flow(nh.Forced(TOP, force=(RUB, np.ones((3, 3)))), **START, times=(0.0, 1.0)),
    lambda: nh.Forced(TOP, force=np.ones((3, 2))),
    lambda: nh.Forced(TOP, lambda g: g[0]).potential_energy(np.eye(3)),
    lambda: _PAIR.applied_force(0.0, np.eye(3), np.ones(3)),
]


# Whatever serves free motions alone says so, in place of leaving the forces out.
test_what_does_not_know_of_forces_is_refused = refusals(
    *((ask, r"Force|force|Friction|Gravity") for ask in _REFUSED),
    # the second argument is the potential: friction there is refused with the name of its own argument
    (lambda: nh.Forced(TOP, nh.Friction([1.0, 2.0, 0.0])), r"Friction and other forces as force="),
)
