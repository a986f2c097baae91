"""Tasks: members of an `EnsembleTask` run as those of `ensemble`, those of a `FamilyTask` as its systems alone."""

import json
import types
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bodies import GENERAL
from refusals import assert_refused, refusals

import nonholo as nh
from nonholo.ensembles import functions_of, standing_of
from nonholo.ensembles._ensemble_task import ensemble_task_from
from nonholo.ensembles._family_task import family_task_from
from nonholo.ensembles.designs import block_of

SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
TOP = nh.discretize(nh.SuslovTop(np.diag([1.0, 2.0, 3.0])), 0.1)
STARTS = [[1.0, 0.2], [-0.3, 0.9]]


def _task(discrete: nh.Discretization = SLEIGH, **options: Any) -> nh.EnsembleTask:
    return nh.EnsembleTask(discrete, **{"steps": 50, **options})


def _called(task: nh.EnsembleTask, design: Any) -> dict[str, Any]:
    result = task(block_of(design, 0, design.members))
    return {name: entry[1] if isinstance(entry, tuple) else entry for name, entry in result.items()}


def _assert_is_ensemble(result: dict[str, Any], batch: nh.Ensemble) -> None:
    assert result["final_momentum"].tobytes() == batch.restricted_momentum[:, -1].tobytes()
    assert batch.pose is not None
    assert result["final_pose"].tobytes() == batch.pose[:, -1].tobytes()
    assert result["outcome"].tolist() == batch.outcome.tolist()


@pytest.mark.parametrize("start", ["restricted_velocity", "momentum"])
def test_members_are_those_of_ensemble(start: str) -> None:
    """Parameters, time steps and components of a start by name are the members of `ensemble`, bit by bit."""
    design = nh.Grid({"a": [0.1, 0.5], "time_step": [0.05, 0.1, 0.2], f"{start}[1]": [-1.0, 0.4]})
    result = _called(_task(**{start: (1.0, 7.0)}), design)
    values = design.values(0, 12)
    rows = np.stack([np.ones(12), values[f"{start}_1"]], axis=1)
    parameters = {name: values[name] for name in ("a", "time_step")}
    _assert_is_ensemble(result, nh.ensemble(SLEIGH, steps=50, parameters=parameters, **{start: rows}))


@pytest.mark.parametrize("start", ["body_velocity", "restricted_velocity", "momentum"])
def test_whole_starts_of_a_design_replace_that_of_the_task(start: str) -> None:
    """A start of the design is used instead of that of the task, whatever that was."""
    rows = [[*row, 0.0] for row in STARTS] if start == "body_velocity" else STARTS
    result = _called(_task(restricted_velocity=(9.0, 9.0)), nh.Grid({start: rows}))
    _assert_is_ensemble(result, nh.ensemble(SLEIGH, steps=50, **{start: rows}))


def _path_length(batch: nh.Ensemble) -> dict[str, Any]:
    return {"length": np.linalg.norm(np.diff(batch.position, axis=1), axis=2).sum(axis=1)}


def test_functions_of_an_ensemble() -> None:
    """A custom reduction sees the states that are saved, beside built-in ones."""
    task = _task(restricted_velocity=(1.0, 0.2), save_every=10, reductions=[_path_length, "final_state"])
    result = _called(task, nh.Grid({"a": [0.1, 0.5]}))
    batch = nh.ensemble(SLEIGH, steps=50, restricted_velocity=(1.0, 0.2), save_every=10, parameters={"a": [0.1, 0.5]})
    assert np.array_equal(result["length"], _path_length(batch)["length"])
    assert result["final_momentum"].tobytes() == batch.restricted_momentum[:, -1].tobytes()


def test_functions_of_an_ensemble_may_return_one_array() -> None:
    """An array that is no dictionary is the result."""
    result = _called(_task(momentum=(1.0, 0.2), reductions=lambda batch: batch.time[:, -1]), nh.Grid({"a": [0.1, 0.5]}))
    assert result["result"].tolist() == [5.0, 5.0]


def test_description_makes_the_task_again() -> None:
    """A task comes back from its description as plain data, and describes itself in the same way."""
    task = _task(TOP, body_velocity=(0.1, 1 / 3, 0.0), reductions=["energy_drift", "lyapunov"], reconstruct=False)
    again = ensemble_task_from(task.describe())
    assert again.describe() == task.describe()
    design = nh.RandomDesign(3, {"mass_tensor": nh.MassTensor(3, 0.5, 2.0)})
    assert {n: x.tolist() for n, x in _called(again, design).items()} == {
        n: x.tolist() for n, x in _called(task, design).items()
    }


def largest(result: Any, _: np.ndarray) -> int:
    """Choose the real value with the largest momentum, as the rule of that name."""
    real = np.flatnonzero(result.is_real)
    return int(real[np.argmax(np.linalg.norm(result.momentum[real], axis=1))])


def test_members_take_a_branch_rule() -> None:
    """A rule reaches the members, by name or as a function, and comes back from a description; blocks are small."""
    design = nh.Grid({"time_step": [0.3, 0.4]})
    top = nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 0.3)
    start = {"momentum": (0.2, 0.3)}
    named, own = (_task(top, **start, branch=rule) for rule in ("largest", largest))
    rows = {**start, "parameters": design.values(0, 2)}
    batch, principal = (nh.ensemble(top, steps=50, **rows, branch=rule) for rule in ("largest", "principal"))
    assert np.abs(batch.restricted_momentum - principal.restricted_momentum).max() > 0.1
    for task in (named, own, ensemble_task_from(named.describe()), ensemble_task_from(own.describe())):
        _assert_is_ensemble(_called(task, design), batch)
    assert "branch" not in _task(top, **start).describe()  # as in stores of versions without rules
    assert _task(top, **start, steps=2**10, branch="nearest").block == 2**10


def test_systems_that_data_cannot_hold_are_refused() -> None:
    """A task with a function as its difference does not come back from its description, and says why."""
    described = _task(restricted_velocity=(1.0, 0.2)).describe()
    motion = json.loads(described["motion"]) | {"difference": "callable"}  # as a function is described
    with pytest.raises(ValueError, match="one whose difference is a callable"):
        ensemble_task_from({**described, "motion": json.dumps(motion)})


@pytest.mark.parametrize(
    ("steps", "every", "members"),
    [(10, None, 2**16), (10_000, None, 26_816), (10_000, 1, 32), (100, 1, 5184), (10**9, None, 32)],
)
def test_blocks_are_pieces_of_work(steps: int, every: int | None, members: int) -> None:
    """Blocks are whole ones of the kernel, at most 2^16 members, 2^22 numbers in states and 2^28 steps."""
    assert _task(restricted_velocity=(1.0, 0.2), steps=steps, save_every=every).block == members


def test_blocks_of_systems_that_run_one_by_one() -> None:
    """Members of other systems make small blocks, one at least."""
    for steps, members in ((2**10, 2**10), (10**7, 1)):
        discrete = nh.discretize(GENERAL["sleigh 3"][0], 0.05)
        assert _task(discrete, restricted_velocity=GENERAL["sleigh 3"][1], steps=steps).block == members


def test_refused_members_are_isolated_and_named(tmp_path: Path) -> None:
    """Members without a body are recorded with their number in the sweep and the reason; the others are done."""
    masses = np.ones(200)
    masses[[130, 131, 177]] = -1.0, 0.0, -2.5
    path, task = tmp_path / "run.zarr", _task(restricted_velocity=(1.0, 0.2))
    result = nh.sweep(task, nh.Grid({"mass": masses}), path, block=100).load()
    bad = np.flatnonzero(~(masses > 0))
    assert np.flatnonzero(result["outcome"] == 100).tolist() == bad.tolist()
    report = dict(standing_of(path).messages)
    assert sorted(report) == bad.tolist()
    assert report[177] == (
        "ValueError: `ChaplyginSleigh(mass=...)` must be positive. Got -2.5. Pass the mass of the body. "
        "This is member 177."
    )
    good = np.flatnonzero(masses > 0)
    batch = nh.ensemble(SLEIGH, steps=50, restricted_velocity=(1.0, 0.2), parameters={"mass": masses[good]})
    assert result["final_momentum"].values[good].tobytes() == batch.restricted_momentum[:, -1].tobytes()
    assert np.isnan(result["final_momentum"].values[bad]).all()


START = {"restricted_velocity": (1.0, 0.2)}


# A design that the task cannot run is refused before there is a store.
test_designs_without_a_meaning_are_refused = refusals(
    ({}, {"a": [1.0]}, "have a start. Got none"),
    (START, {"Mass": [1.0]}, "name parameters of the system or starts. Got 'Mass'. ChaplyginSleigh has mass,"),
    (START, {"velocity": [[1.0, 2.0]]}, "name parameters"),
    (START, {"momentum[0]": [1.0]}, "components of the start of the task. Got 'momentum_0'"),
    (START, {"momentum": STARTS, "restricted_velocity[0]": [1.0]}, "components of the start of the task"),
    ({}, {"restricted_velocity[0]": [1.0]}, r"vary all 2 components of a start that is not given. Got \[0\]"),
    ({}, {"momentum_0": [1.0], "momentum_3": [1.0]}, r"vary all 2 or 3 components .* Got \[0, 3\]"),
    ({}, {"momentum_0": [1.0], "body_velocity_1": [1.0]}, "vary components of one start"),
    (START, {"restricted_velocity[2]": [1.0]}, "existing components. Got .* of a start with 2"),
    ({}, {"momentum": STARTS, "body_velocity": [[1.0, 0.0, 0.0]]}, "vary one start"),
    (START, {"mass": [-1.0, 0.0]}, "run for at least one tested member. Got ValueError.*must be positive"),
    (START, {"mass": [[1.0, 2.0]]}, "run for at least one tested member.*must have shape"),
    ({}, {"momentum": [1.0, 2.0]}, "run for at least one tested member.*must have shape"),
    ask=lambda options, axes: nh.sweep(_task(**options), nh.Grid(axes), Path("run.zarr")),
)


# A task that makes no sense is refused when it is made.
test_bad_tasks_are_refused = refusals(
    (lambda: nh.EnsembleTask(SLEIGH, steps=0), "must be a positive integer"),
    (lambda: nh.EnsembleTask(SLEIGH, steps=5, save_every=0), "must be a positive integer"),
    (lambda: nh.EnsembleTask(SLEIGH.system, steps=5), r"EnsembleTask\(discrete=...\)"),  # type: ignore[arg-type]
    (lambda: _task(reductions=["final", "energy_drift"]), "Got 'final'. Choose among final_state,"),
    (lambda: _task(reductions=[["final_state"]]), "names or functions"),
    (lambda: _task(reductions=None), "names or functions. Got None"),
    (lambda: _task(momentum=(1.0, 0.0), branch="next"), r"EnsembleTask\(branch=...\)` must be"),
    (lambda: _task(momentum=(1.0, 0.0), branch="inner"), r"EnsembleTask\(branch=...\)` must be a rule without"),
    (lambda: _task(momentum=STARTS), r"EnsembleTask\(momentum=...\)` must have shape"),
    (lambda: _task(momentum="left"), "array of real numbers"),
    (lambda: _task(momentum=(1.0, 0.0), body_velocity=(1.0, 0.0, 0.0)), "exactly one of"),
)


def test_names_that_two_reductions_return_are_refused() -> None:
    """No reduction silently replaces what another one returned."""
    for name in ("final_energy", "outcome"):
        task = _task(reductions=["final_state", lambda batch, name=name: {name: batch.outcome}], **START)
        with pytest.raises(ValueError, match=f"return each name once. Got '{name}'"):
            _called(task, nh.Grid({"a": [1.0]}))


@pytest.mark.parametrize("spelling", ["{}_{}", "{}[{}]"])
def test_a_start_that_is_varied_whole_need_not_be_given(spelling: str, tmp_path: Path) -> None:
    """Components that are all varied are the start; results are selected by names that Python takes."""
    name = "body_velocity"
    design = nh.Grid({spelling.format(name, axis): values for axis, values in enumerate([[0.1, 0.3], [0.2], [0.0]])})
    with nh.sweep(_task(), design, tmp_path / "s.zarr") as result:
        cell = result.sel(body_velocity_0=0.3).isel(body_velocity_1=0, body_velocity_2=0)
        assert result.body_velocity_0.values.tolist() == [0.1, 0.3]
        orbit = nh.simulate(SLEIGH, body_velocity=(0.3, 0.2, 0.0), steps=50)
        assert np.abs(cell.final_momentum.values - orbit.restricted_momentum[-1]).max() < 1e-13


def test_blocks_know_components_under_both_names() -> None:
    """A function of a block reads a component as the design wrote it, or as the result calls it."""
    block = block_of(nh.Grid({"speed[2]": [1.0, 2.0]}), 0, 2)
    assert block["speed[2]"].tolist() == block["speed_2"].tolist() == [1.0, 2.0]
    with pytest.raises(ValueError, match="name each value once"):
        nh.Grid({"speed[2]": [1.0], "speed_2": [1.0]})


OBLIQUE = nh.LLSystem(nh.SE(2), np.eye(3), [[1.0, 0.0, 0.0], [0.0, 0.6, 0.8]])
NAMES: dict[str, tuple[Any, list[str] | None, list[str] | None]] = {
    "sleigh": (SLEIGH, ["omega", "v1"], ["cos", "sin", "x", "y"]),
    "top": (TOP, ["omega2", "minus_omega1"], ["qw", "qx", "qy", "qz"]),
    "oblique rows": (nh.discretize(OBLIQUE, 0.1), None, ["cos", "sin", "x", "y"]),
}


@pytest.mark.parametrize("name", NAMES)
def test_components_of_results_have_names(name: str, tmp_path: Path) -> None:
    """Momenta bear the names of the axes they are along, compact poses those of their numbers."""
    discrete, along, of_poses = NAMES[name]
    result = nh.sweep(_task(discrete), nh.Grid({"restricted_velocity": [[0.3, 0.4]]}), tmp_path / "a.zarr")
    for dimension, names in (("component", along), ("pose_component", of_poses)):
        assert (result[dimension].values.tolist() if dimension in result.coords else None) == names
    if along:
        assert float(result["final_momentum"].sel(component=along[1])[0]) == result["final_momentum"].values[0, 1]


GRID = nh.Grid({"a": [0.2, 0.6], "speed": [0.5, 1.0, 2.0]})
PLACE = nh.SE(2).exp([0.3, 1.0, -2.0])
SPRING = nh.LagrangeDAlembert(
    lambda q, v, p: (p["mass"] * v @ v - p["stiffness"] * q @ q) / 2,
    None,
    dimension=1,
    parameters={"mass": 1.0, "stiffness": 1.0},
)


def sleigh(*, a: float = 0.5, speed: float = 1.0, velocity: tuple[float, float] = (0.3, 0.0)) -> types.SimpleNamespace:
    """Return a sleigh that sets out with a speed, beside its turning rate, and not from the identity."""
    start = np.array([velocity[0], velocity[1] + speed, 0.0])
    return types.SimpleNamespace(system=nh.ChaplyginSleigh(1.0, 1.0, a), configuration=PLACE, body_velocity=start)


def ends(batch: nh.Ensemble) -> dict:
    """Return the last headings."""
    return {"turned": batch.heading[:, -1]}


def test_members_are_runs_of_the_systems_that_the_family_makes(tmp_path: Path) -> None:
    """Parameters, poses, starts, components of them, time steps; what is not named is as given, or the default."""
    task = nh.FamilyTask(sleigh, 0.1, 20, parameters={"velocity": (0.4, 0.0)})
    result = nh.sweep(task, GRID, tmp_path / "speeds.zarr")
    for a in (0.2, 0.6):
        for speed in (0.5, 1.0, 2.0):
            run = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, a), 0.1)
            alone = nh.simulate(run, configuration=PLACE, body_velocity=(0.4, speed, 0.0), steps=20)
            member = result.sel(a=a, speed=speed)
            assert np.abs(member.final_configuration.values - alone.configuration[-1]).max() <= 1e-14
            assert member.final_time.item() == alone.time[-1]
            assert abs(member.final_energy.item() - alone.energy[-1]) <= 1e-14
    parts = nh.sweep(
        task, nh.Grid({"velocity_1": [0.5], "body_velocity_0": [0.7], "time_step": [0.05]}), tmp_path / "p.zarr"
    )
    run, start = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.05), (0.7, 1.5, 0.0)
    alone = nh.simulate(run, configuration=PLACE, body_velocity=start, steps=20)
    assert np.abs(parts.final_configuration.values[0, 0, 0] - alone.configuration[-1]).max() <= 1e-14
    assert parts.final_time.item() == 20 * 0.05


def test_reductions_of_families_are_joined(tmp_path: Path) -> None:
    """One array is a result, as of an `EnsembleTask`; systems that return other types than the first are named."""
    speeds = nh.FamilyTask(sleigh, 0.1, 2, reductions=["final_state", lambda batch: batch.energy[:, 0]])
    result = nh.sweep(speeds, GRID, tmp_path / "speeds.zarr", block=4)
    assert np.array_equal(result.result.values, result.final_energy.values)

    def fractions(batch: nh.Ensemble) -> dict:
        a = batch.members.discrete.system.a
        return {"b": np.full(len(batch), a) if a % 1 else np.full(len(batch), int(a))}

    mixed = nh.FamilyTask(sleigh, 0.1, 2, reductions=fractions)
    result = nh.sweep(mixed, nh.Grid({"a": [1.0, 2.0, 2.5, 3.0]}), tmp_path / "mixed.zarr")
    assert (result.outcome.values.tolist(), result.b.values.tolist()) == ([0, 0, 100, 0], [1, 2, np.iinfo(int).min, 3])
    task = nh.FamilyTask(sleigh, 0.1, 2, reductions=["final_state", lambda batch: {"final_time": batch.outcome}])
    with pytest.raises(ValueError, match=r"return each name once\. Got 'final_time'"):
        nh.sweep(task, GRID, tmp_path / "twice.zarr")


def test_a_store_names_the_family_and_runs_nothing_of_the_users(tmp_path: Path) -> None:
    """A function of the user's is imported only if it is trusted; a ready system of the library is data."""
    task = nh.FamilyTask(sleigh, 0.1, 5, reductions=["final_state", ends])
    result = nh.sweep(task, GRID, tmp_path / "own.zarr")
    assert sorted(functions_of(tmp_path / "own.zarr")) == sorted(f"{__name__}:{name}" for name in ("sleigh", "ends"))
    assert_refused(tmp_path / "own.zarr", "name no function but the library's", nh.resume)
    assert nh.resume(tmp_path / "own.zarr", task=task).equals(result)
    other = nh.FamilyTask(sleigh, 0.2, 5, reductions=["final_state", ends])
    with pytest.raises(ValueError, match="time_step"):
        nh.resume(tmp_path / "own.zarr", task=other)
    ready = nh.FamilyTask(nh.examples.sleigh_in_a_well, 0.1, 3)
    described = ready.describe()
    assert described["family"] == "examples.sleigh_in_a_well"
    assert json.loads(json.dumps(described)) == described
    swept = nh.sweep(ready, nh.Grid({"stiffness": [0.1, 0.3]}), tmp_path / "ready.zarr")
    assert functions_of(tmp_path / "ready.zarr") == []
    assert nh.resume(tmp_path / "ready.zarr").equals(swept)


@pytest.mark.parametrize("name", ["examples.Example", "examples.needs", "examples.no_such"])
def test_what_is_no_ready_system_is_not_made(name: str) -> None:
    """Names of a store are looked up among the ready systems alone."""
    entry = nh.FamilyTask(nh.examples.particle, 0.1, 3).describe()
    with pytest.raises(ValueError, match="no ready system"):
        family_task_from(entry | {"family": name})


# Before any work, with what to pass.
test_bad_families_are_refused = refusals(
    (lambda: nh.FamilyTask(5, 0.1, 3), r"FamilyTask\(family=...\)` must be a function"),
    (lambda: nh.FamilyTask(sleigh, 0.0, 3), r"FamilyTask\(time_step=...\)` must be positive"),
    (lambda: nh.FamilyTask(sleigh, 0.1, 0), r"FamilyTask\(steps=...\)` must be a positive integer"),
    (lambda: nh.FamilyTask(sleigh, 0.1, 3, parameters={"mass": 1.0}), "It has a, speed, velocity"),
    (lambda: nh.FamilyTask(sleigh, 0.1, 3, parameters=[1.0]), "be a mapping of names"),
    (lambda: nh.FamilyTask(sleigh, 0.1, 3, reductions="lyapunov"), "functions of an ensemble"),
    (lambda: nh.FamilyTask(sleigh, 0.1, 3, save_every=1.5), r"FamilyTask\(save_every=...\)"),
    (lambda: nh.FamilyTask(sleigh, 0.1, 3, save_every=0), r"FamilyTask\(save_every=...\)"),
    kind=(ValueError, TypeError),
)


# Names that the family does not have, components beyond the last.
test_bad_designs_of_families_are_refused = refusals(
    ("mass", "name arguments of the family. Got 'mass'"),
    ("velocity_2", "vary existing components"),
    ask=lambda axis: nh.sweep(nh.FamilyTask(sleigh, 0.1, 3), nh.Grid({axis: [1.0]}), Path("bad.zarr")),
)


def springs(*, stiffness: float = 1.0, mass: float = 1.0) -> types.SimpleNamespace:
    """Return one system in coordinates for all numbers."""
    system = SPRING.with_parameters(stiffness=stiffness, mass=mass)
    return types.SimpleNamespace(system=system, configuration=np.ones(1), body_velocity=np.zeros(1))


def test_systems_that_differ_by_parameters_run_as_one_ensemble(tmp_path: Path) -> None:
    """Each member has the bits of its run alone, and the reduction sees all of them at once."""
    sizes: list[int] = []

    def counted(batch: nh.Ensemble) -> dict:
        sizes.append(len(batch))
        return {"weight": batch.parameters["mass"]}

    task = nh.FamilyTask(springs, 0.1, 20, reductions=["final_state", counted])
    result = nh.sweep(task, nh.Grid({"mass": [0.5, 2.0], "stiffness": [1.0, 2.0, 3.0]}), tmp_path / "springs.zarr")
    assert max(sizes) == 6
    for mass in (0.5, 2.0):
        alone = nh.discretize(SPRING.with_parameters(mass=mass, stiffness=3.0), 0.1)
        orbit = nh.simulate(alone, configuration=[1.0], body_velocity=[0.0], steps=20)
        member = result.sel(mass=mass, stiffness=3.0)
        assert np.array_equal(member.final_configuration.values, orbit.configuration[-1])


def test_components_have_the_names_of_coordinates(tmp_path: Path) -> None:
    """A result has the names of coordinates along its components, those of the algebra for velocities on groups."""
    task = nh.FamilyTask(nh.examples.particle, time_step=0.1, steps=3)
    result = nh.sweep(task, nh.Grid({"mass": [1.0, 2.0]}), tmp_path / "a.zarr")
    assert result["coordinate"].values.tolist() == result["component"].values.tolist() == ["x", "y", "z"]
    orbit = nh.examples.particle(mass=2.0).simulate(time_step=0.1, steps=3)
    assert float(result["final_configuration"].sel(mass=2.0, coordinate="y")) == orbit.configuration[-1, 1]
    top = nh.FamilyTask(nh.examples.heavy_suslov_top, time_step=0.1, steps=3)
    turned = nh.sweep(top, nh.Grid({"velocity_0": [0.5]}), tmp_path / "b.zarr")
    assert turned["component"].values.tolist() == ["omega1", "omega2", "omega3"]
