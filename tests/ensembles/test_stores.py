"""Stores of sweeps that are moved, of something else or not to be written; tasks passed again; last poses as CSV."""

import csv
import json
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray
from damage import damage
from ensembles.faults import DESIGN, SWEEPS, noisy, resumed, same, simple, swept
from refusals import assert_refused
from stopping import stopped_at

import nonholo as nh
from nonholo.ensembles import standing_of, sweep_to_csv
from nonholo.io.blocks import edit_attributes
from nonholo.io.metadata import read_attributes

SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
SLEIGHS = nh.Grid({"a": [0.1, 0.2]})


def test_moved_store_goes_on(tmp_path: Path) -> None:
    """A store that was moved to another folder continues there; another one in its old place is another one."""
    path, moved = tmp_path / "run.zarr", tmp_path / "elsewhere" / "moved.zarr"
    with stopped_at(1):
        swept(path)
    moved.parent.mkdir()
    path.rename(moved)
    whole = swept(path, block=3)
    assert same(resumed(moved), whole)
    assert same(nh.load_sweep(moved), whole)


def test_store_made_again_at_the_same_path(tmp_path: Path) -> None:
    """A store that is removed and made again with other blocks is not taken for the old one."""
    path = tmp_path / "run.zarr"
    swept(path, block=1)
    path.rename(tmp_path / "old.zarr")
    assert same(swept(path, block=3), nh.load_sweep(tmp_path / "old.zarr").load())
    assert standing_of(path).done == 6


def test_existing_path_is_refused(tmp_path: Path) -> None:
    """What is at a path is never overwritten, be it a store, a folder or a file."""
    store, folder, file = (tmp_path / name for name in ("run.zarr", "folder", "file"))
    whole = swept(store)
    folder.mkdir()
    file.write_text("mine")
    for path in (store, folder, file):
        assert_refused(path, r"must be new.*Choose another path.*resume=True", swept, kind=FileExistsError)
    assert same(nh.load_sweep(store), whole)
    assert not list(folder.iterdir())
    assert file.read_text() == "mine"


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="root has to become another user")
def test_read_only_folder_is_refused() -> None:
    """A folder that may not be written is an error with its path; a finished store there can still be loaded."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        whole = swept(folder / "run.zarr")
        folder.chmod(0o755)
        os.seteuid(65534)
        try:
            words = r"denied\. Nothing at this path was changed.*new\.zarr"
            assert_refused(folder / "new.zarr", words, swept, kind=PermissionError)
            assert_refused(folder / "run.zarr", "denied", resumed, kind=PermissionError)
            result = nh.load_sweep(folder / "run.zarr").load()
        finally:
            os.seteuid(0)
        assert same(result, whole)
        assert [path.name for path in folder.iterdir()] == ["run.zarr"]


def _sleighs(path: Path, *, time_step: float = 0.1, values: Any = (0.1, 0.2), **options: Any) -> xarray.Dataset:
    sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), time_step)
    task = nh.EnsembleTask(sleigh, **{"steps": 3, "restricted_velocity": (1.0, 0.5), **options})
    return nh.sweep(task, nh.Grid({"a": values}), path, resume=True)


@pytest.mark.parametrize(
    ("changes", "match"),
    [
        ({"steps": 4}, r"task\.steps is 4 instead of 3"),
        ({"restricted_velocity": (1.0, 0.6)}, r"task\.start is .*0\.6\]\] instead of .*0\.5"),
        ({"reductions": ["energy_drift"]}, r'task\.reductions is \["energy_drift"\] instead of \["final_state"\]'),
        ({"time_step": 0.2}, r"task\.motion is .*0\.2.* instead of .*0\.1"),
        ({"values": (0.1, 0.3)}, r"design\.axes\.a is"),
        ({"values": (0.1, 0.2, 0.3)}, r"design\.axes\.a is"),
    ],
)
def test_another_sweep_is_refused(changes: dict[str, Any], match: str, tmp_path: Path) -> None:
    """A store is not resumed by another task or design: the difference is named, and nothing is changed."""
    path = tmp_path / "run.zarr"
    whole = _sleighs(path).load()
    with pytest.raises(ValueError, match=f"must hold this sweep.*where {match}"):
        _sleighs(path, **changes)
    assert same(_sleighs(path), whole)


def _another_schema(path: Path) -> None:
    swept(path)
    edit_attributes(path, {"schema": 99})


def _orbit(path: Path) -> None:
    nh.simulate(SLEIGH, steps=20, restricted_velocity=(1.0, 0.0), store=path)


RANDOM = nh.RandomDesign(6, {"x": nh.Normal()}, rng=1)


@pytest.mark.parametrize(
    ("thing", "mistake", "match"),
    [
        (swept, lambda path: nh.resume(path, task=noisy), r'name is "ensembles.faults:noisy" instead of ".*le"'),
        (swept, lambda p: nh.sweep(simple, nh.Grid(DESIGN.axes, rng=2), p, resume=True), r"seed is 2 instead of 1"),
        (swept, lambda path: nh.sweep(simple, RANDOM, path, resume=True), r'kind is "RandomDesign" instead of "Grid"'),
        (_another_schema, resumed, r"have schema \d, the one that this version reads. Got schema 99. Upgrade"),
        (_orbit, lambda path: swept(path, resume=True), "a store of an orbit"),
        (_orbit, nh.load_sweep, "a store of an orbit"),
        (swept, nh.load_orbit, "a store of a sweep"),
        (_orbit, lambda path: nh.resume(path, task=simple), "come with the store of a sweep"),
        (_orbit, lambda path: nh.resume(path, scheduler="threads"), "come with the store of a sweep"),
        (swept, lambda path: nh.resume(path, discrete=SLEIGH), "come with the store of an orbit"),
        (Path.mkdir, nh.resume, "must be a store of a run or a sweep"),
    ],
)
def test_wrong_stores_are_refused(thing: Callable[..., Any], mistake: Callable, match: str, tmp_path: Path) -> None:
    """What does not belong together is refused, with the difference named."""
    thing(tmp_path / "run.zarr")
    assert_refused(tmp_path / "run.zarr", match, mistake)


def test_nothing_at_the_path_is_refused(tmp_path: Path) -> None:
    """A path at which there is nothing is named."""
    path = tmp_path / "nothing.zarr"
    assert_refused(path, r"nothing\.zarr", nh.resume, nh.load_sweep, kind=FileNotFoundError)


def test_tasks_without_a_name_have_to_be_passed(tmp_path: Path) -> None:
    """A task that no process can import is asked for by `resume`, and continues once it is passed."""
    path, task = tmp_path / "run.zarr", lambda block: simple(block)
    mixed = nh.EnsembleTask(SLEIGH, steps=3, restricted_velocity=(1.0, 0.5), reductions=[lambda batch: batch.outcome])
    for store, each, design in ((path, task, DESIGN), (tmp_path / "mixed.zarr", mixed, SLEIGHS)):
        with stopped_at(0):
            nh.sweep(each, design, store, "synchronous")
        assert_refused(store, r"task can be made again.*without an importable name.*task=\.\.\.", nh.resume)
        assert same(nh.resume(store, task=each).load(), nh.sweep(each, design, f"{store}.whole").load())


def test_functions_run_only_if_they_are_passed_or_trusted(tmp_path: Path) -> None:
    """A store names the functions of its task: none of them is imported unless the caller says so."""
    task, design, _ = SWEEPS["noisy"]
    whole = nh.sweep(task, design, tmp_path / "noisy", block=design.members).load()
    mark = tmp_path / "noisy" / "run" / "blocks" / "0.json"
    for options in ({"task": task}, {"trust": True}):
        mark.unlink()
        words = r"names ensembles.faults:noisy. Pass it: .*task=...*trust=True"
        assert_refused(tmp_path / "noisy", words, nh.resume)
        assert same(nh.resume(tmp_path / "noisy", **options).load(), whole)


@pytest.mark.parametrize("place", ["name", "reductions", "branch_function"])
def test_stores_of_strangers_run_nothing(place: str, tmp_path: Path) -> None:
    """A store that names a command of the system as its task, a reduction or a rule, is refused before the import."""
    path, design = tmp_path / "evil.zarr", nh.RandomDesign(3, {"a": nh.Uniform(0.1, 1.0)})
    task = lambda block: block["a"]  # noqa: E731
    if place != "name":
        task = nh.EnsembleTask(SLEIGH, steps=3, restricted_velocity=(1.0, 0.5))
    nh.sweep(task, design, path, "synchronous")
    described = json.loads(read_attributes(path, "nonholo.sweep")["sweep"])
    name = f"{tmp_path.name}:call"
    described["task"] |= {place: [name] if place == "reductions" else name}
    edit_attributes(path, {"sweep": json.dumps(described), "finished": False})
    (path / "run" / "blocks" / "0.json").unlink()
    with pytest.raises(ValueError, match=f"names {name}. Pass it"):  # an import would say: no such module
        nh.resume(path, scheduler="synchronous")


OFFSET = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5, b=0.2), time_step=0.1)


def _read(path: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(path.read_text().splitlines()))


def _export(store: Path) -> None:
    sweep_to_csv(store, store.with_suffix(".csv"))


def _task(discrete: nh.Discretization, **options: object) -> nh.EnsembleTask:
    return nh.EnsembleTask(discrete, steps=20, restricted_velocity=(1.0, 0.5), **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", ["a", "b"])
def test_plane(tmp_path: Path, name: str) -> None:
    """Rows of a plane sweep hold the number, the design, the outcome, the time and the pose of `simulate`."""
    nh.sweep(_task(OFFSET), nh.Grid({name: [0.1, 0.3], "time_step": [0.1, 0.2, 0.3]}), tmp_path / "s.zarr", block=4)
    sweep_to_csv(tmp_path / "s.zarr", tmp_path / "poses.csv")
    rows = _read(tmp_path / "poses.csv")
    assert list(rows[0]) == ["member", name, "time_step", "outcome", "t", "x", "y", "theta"]
    assert [row["member"] for row in rows] == ["0", "1", "2", "3", "4", "5"]
    system = {"mass": 1.0, "inertia": 1.0, "a": 0.5, "b": 0.2, name: 0.3}
    orbit = nh.simulate(nh.discretize(nh.ChaplyginSleigh(**system), 0.2), restricted_velocity=(1.0, 0.5), steps=20)
    result = [float(rows[4][column]) for column in ("t", "x", "y", "theta")]
    g = orbit.configuration[-1]
    wanted = [orbit.time[-1], *orbit.position[-1], np.arctan2(g[1, 0], g[0, 0])]
    assert np.abs(np.subtract(result, wanted)).max() < 1e-13  # 20 products of numbers of size one


def test_reductions_need_not_be_found(tmp_path: Path) -> None:
    """Poses beside what a reduction without an importable name keeps are those of a sweep without it."""
    for name, more in (("plain", []), ("own", [lambda batch: {"mine": batch.outcome}])):
        task = _task(OFFSET, reductions=["final_state", *more])
        nh.sweep(task, nh.Grid({"a": [0.1, 0.3]}), tmp_path / f"{name}.zarr")
        sweep_to_csv(tmp_path / f"{name}.zarr", tmp_path / f"{name}.csv")
    assert len(_read(tmp_path / "own.csv")) == 2
    assert (tmp_path / "own.csv").read_text() == (tmp_path / "plain.csv").read_text()


@pytest.mark.parametrize(
    ("task", "message"),
    [
        (lambda block: {"final_pose": block["a"]}, r"`sweep_to_csv\(store=\.\.\.\)` must hold poses"),
        (_task(OFFSET, reconstruct=False), "Keep 'final_state' with reconstruct=True"),
    ],
    ids=["function", "no poses"],
)
def test_refused_without_poses(task: Any, message: str, tmp_path: Path) -> None:
    """A sweep that kept no poses says what to keep; what a function calls a pose is of no known system."""
    nh.sweep(task, nh.Grid({"a": [0.1, 0.3]}), tmp_path / "s.zarr")
    assert_refused(tmp_path / "s.zarr", message, _export)
    assert [path.name for path in tmp_path.iterdir()] == ["s.zarr"]


def test_refused_without_the_system_or_when_damaged(tmp_path: Path) -> None:
    """A store whose discretization is no data is said to hold it, not to be passed a task; a damaged chunk is named."""
    store = tmp_path / "s.zarr"
    nh.sweep(_task(OFFSET), nh.Grid({"a": [0.1, 0.3]}), store)
    damage(store / "final_pose" / "c" / "0" / "0", "cut")
    assert_refused(store, "chunk c/0/0 of the array final_pose", _export)
    report = json.loads(read_attributes(store, "nonholo.sweep")["sweep"])
    report["task"]["motion"] = json.dumps(json.loads(report["task"]["motion"]) | {"difference": "callable"})
    edit_attributes(store, {"sweep": json.dumps(report)})
    assert_refused(store, r"hold its system as data\. Got .*one whose difference is a callable\.", _export)
    assert list(tmp_path.iterdir()) == [store]
