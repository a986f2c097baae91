"""Sweeps over systems that a function makes: what members are, what stores name, and what is refused."""

import json
import types
from pathlib import Path

import numpy as np
import pytest
from refusals import refusals

import nonholo as nh
from nonholo.ensembles import functions_of

GRID = nh.Grid({"a": [0.2, 0.6], "speed": [0.5, 1.0, 2.0]})
SPRING = nh.LagrangeDAlembert(
    lambda q, v, p: (p["mass"] * v @ v - p["stiffness"] * q @ q) / 2,
    None,
    dimension=1,
    parameters={"mass": 1.0, "stiffness": 1.0},
)


def sleigh(*, a: float = 0.5, speed: float = 1.0, velocity: tuple[float, float] = (0.3, 0.0)) -> types.SimpleNamespace:
    """Return a sleigh that sets out with a speed, beside its turning rate."""
    start = np.array([velocity[0], velocity[1] + speed, 0.0])
    return types.SimpleNamespace(system=nh.ChaplyginSleigh(1.0, 1.0, a), configuration=np.eye(3), body_velocity=start)


def placed(*, a: float = 0.5) -> types.SimpleNamespace:
    """Return a sleigh that does not start at the identity."""
    return types.SimpleNamespace(
        system=nh.ChaplyginSleigh(1.0, 1.0, a),
        configuration=nh.SE(2).exp([0.3, 1.0, -2.0]),
        body_velocity=np.array([0.4, 1.0, 0.0]),
    )


def ends(batch: nh.Ensemble) -> dict:
    """Return the last headings."""
    return {"turned": batch.heading[:, -1]}


def test_members_are_runs_of_the_systems_that_the_family_makes(tmp_path: Path) -> None:
    """Parameters, starts, components of them and time steps; what is not named is as given, or the default."""
    task = nh.FamilyTask(sleigh, 0.1, 20, parameters={"velocity": (0.4, 0.0)})
    found = nh.sweep(task, GRID, tmp_path / "speeds.zarr")
    for a in (0.2, 0.6):
        for speed in (0.5, 1.0, 2.0):
            run = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, a), 0.1)
            alone = nh.simulate(run, body_velocity=(0.4, speed, 0.0), steps=20)
            member = found.sel(a=a, speed=speed)
            assert np.abs(member.final_configuration.values - alone.configuration[-1]).max() <= 1e-14
            assert member.final_time.item() == alone.time[-1]
            assert abs(member.final_energy.item() - alone.energy[-1]) <= 1e-14
    parts = nh.sweep(
        task, nh.Grid({"velocity_1": [0.5], "body_velocity_0": [0.7], "time_step": [0.05]}), tmp_path / "p.zarr"
    )
    alone = nh.simulate(nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.05), body_velocity=(0.7, 1.5, 0.0), steps=20)
    assert np.abs(parts.final_configuration.values[0, 0, 0] - alone.configuration[-1]).max() <= 1e-14
    assert parts.final_time.item() == 20 * 0.05


def test_reductions_of_families_are_joined(tmp_path: Path) -> None:
    """One array is a result, as of an `EnsembleTask`; systems that return other types than the first are named."""
    speeds = nh.FamilyTask(sleigh, 0.1, 2, reductions=["final_state", lambda batch: batch.energy[:, 0]])
    found = nh.sweep(speeds, GRID, tmp_path / "speeds.zarr", block=4)
    assert np.array_equal(found.result.values, found.final_energy.values)

    def fractions(batch: nh.Ensemble) -> dict:
        a = batch.members.discrete.system.a
        return {"b": np.full(len(batch), a) if a % 1 else np.full(len(batch), int(a))}

    mixed = nh.FamilyTask(sleigh, 0.1, 2, reductions=fractions)
    found = nh.sweep(mixed, nh.Grid({"a": [1.0, 2.0, 2.5, 3.0]}), tmp_path / "mixed.zarr")
    assert (found.outcome.values.tolist(), found.b.values.tolist()) == ([0, 0, 100, 0], [1, 2, np.iinfo(int).min, 3])
    task = nh.FamilyTask(sleigh, 0.1, 2, reductions=["final_state", lambda batch: {"final_time": batch.outcome}])
    with pytest.raises(ValueError, match=r"return each name once\. Got 'final_time'"):
        nh.sweep(task, GRID, tmp_path / "twice.zarr")


def test_bodies_start_where_the_family_puts_them(tmp_path: Path) -> None:
    """The pose of the family is that of the run."""
    found = nh.sweep(nh.FamilyTask(placed, 0.1, 20), nh.Grid({"a": [0.2, 0.6]}), tmp_path / "placed.zarr")
    for a in (0.2, 0.6):
        start = {"configuration": placed().configuration, "body_velocity": placed().body_velocity}
        alone = nh.simulate(nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, a), 0.1), **start, steps=20)
        assert np.abs(found.sel(a=a).final_configuration.values - alone.configuration[-1]).max() <= 1e-14


def test_a_store_names_the_family_and_runs_nothing_of_the_users(tmp_path: Path) -> None:
    """A function of the user's is imported only if it is trusted; a ready system of the library is data."""
    task = nh.FamilyTask(sleigh, 0.1, 5, reductions=["final_state", ends])
    found = nh.sweep(task, GRID, tmp_path / "own.zarr")
    assert sorted(functions_of(tmp_path / "own.zarr")) == sorted(f"{__name__}:{name}" for name in ("sleigh", "ends"))
    with pytest.raises(ValueError, match="name no function but the library's"):
        nh.resume(tmp_path / "own.zarr")
    assert nh.resume(tmp_path / "own.zarr", task=task).equals(found)
    other = nh.FamilyTask(sleigh, 0.2, 5, reductions=["final_state", ends])
    with pytest.raises(ValueError, match="time_step"):
        nh.resume(tmp_path / "own.zarr", task=other)
    ready = nh.FamilyTask(nh.examples.sleigh_in_a_well, 0.1, 3)
    assert (ready.describe()["family"], json.loads(json.dumps(ready.describe()))) == (
        "examples.sleigh_in_a_well",
        ready.describe(),
    )
    kept = nh.sweep(ready, nh.Grid({"stiffness": [0.1, 0.3]}), tmp_path / "ready.zarr")
    assert functions_of(tmp_path / "ready.zarr") == []
    assert nh.resume(tmp_path / "ready.zarr").equals(kept)


@pytest.mark.parametrize("name", ["examples.Example", "examples.needs", "examples.no_such"])
def test_what_is_no_ready_system_is_not_made(name: str) -> None:
    """Names of a store are looked up among the ready systems alone."""
    from nonholo.ensembles._family_task import family_task_from

    entry = nh.FamilyTask(nh.examples.particle, 0.1, 3).describe()
    with pytest.raises(ValueError, match="no ready system"):
        family_task_from(entry | {"family": name})


# Before any work, with what to pass.
test_bad_tasks_are_refused = refusals(
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
test_bad_designs_are_refused = refusals(
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
    found = nh.sweep(task, nh.Grid({"mass": [0.5, 2.0], "stiffness": [1.0, 2.0, 3.0]}), tmp_path / "springs.zarr")
    assert max(sizes) == 6
    for mass in (0.5, 2.0):
        alone = nh.discretize(SPRING.with_parameters(mass=mass, stiffness=3.0), 0.1)
        orbit = nh.simulate(alone, configuration=[1.0], body_velocity=[0.0], steps=20)
        member = found.sel(mass=mass, stiffness=3.0)
        assert np.array_equal(member.final_configuration.values, orbit.configuration[-1])


def test_components_have_the_names_of_coordinates(tmp_path: Path) -> None:
    """A result has the names of coordinates along its components, those of the algebra for velocities on groups."""
    task = nh.FamilyTask(nh.examples.particle, time_step=0.1, steps=3)
    found = nh.sweep(task, nh.Grid({"mass": [1.0, 2.0]}), tmp_path / "a.zarr")
    assert found["coordinate"].values.tolist() == found["component"].values.tolist() == ["x", "y", "z"]
    orbit = nh.examples.particle(mass=2.0).simulate(time_step=0.1, steps=3)
    assert float(found["final_configuration"].sel(mass=2.0, coordinate="y")) == orbit.configuration[-1, 1]
    top = nh.FamilyTask(nh.examples.heavy_suslov_top, time_step=0.1, steps=3)
    turned = nh.sweep(top, nh.Grid({"velocity_0": [0.5]}), tmp_path / "b.zarr")
    assert turned["component"].values.tolist() == ["omega1", "omega2", "omega3"]
