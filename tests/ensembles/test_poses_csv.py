"""The last poses of a sweep as CSV: those of `simulate`, in the user's body frame."""

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import nonholo as nh
from nonholo.ensembles import sweep_to_csv
from nonholo.io.metadata import checksum

SLEIGH = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5, b=0.2), time_step=0.1)


def _read(path: Path) -> list[dict[str, str]]:
    with path.open() as file:
        return list(csv.DictReader(file))


def _task(discrete: nh.Discretization, **options: object) -> nh.EnsembleTask:
    return nh.EnsembleTask(discrete, steps=20, restricted_velocity=(1.0, 0.5), **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", ["a", "b"])
def test_plane(tmp_path: Path, name: str) -> None:
    """Rows of a plane sweep hold the number, the design, the outcome, the time and the pose of `simulate`."""
    nh.sweep(_task(SLEIGH), nh.Grid({name: [0.1, 0.3], "time_step": [0.1, 0.2, 0.3]}), tmp_path / "s.zarr", block=4)
    sweep_to_csv(tmp_path / "s.zarr", tmp_path / "poses.csv")
    rows = _read(tmp_path / "poses.csv")
    assert list(rows[0]) == ["member", name, "time_step", "outcome", "t", "x", "y", "theta"]
    assert [row["member"] for row in rows] == ["0", "1", "2", "3", "4", "5"]
    system = {"mass": 1.0, "inertia": 1.0, "a": 0.5, "b": 0.2, name: 0.3}
    orbit = nh.simulate(nh.discretize(nh.ChaplyginSleigh(**system), 0.2), restricted_velocity=(1.0, 0.5), steps=20)
    found = [float(rows[4][column]) for column in ("t", "x", "y", "theta")]
    g = orbit.configuration[-1]
    wanted = [orbit.time[-1], *orbit.position[-1], np.arctan2(g[1, 0], g[0, 0])]
    assert np.abs(np.subtract(found, wanted)).max() < 1e-13  # 20 products of numbers of size one


def test_reductions_need_not_be_found(tmp_path: Path) -> None:
    """Poses beside what a reduction without an importable name keeps are those of a sweep without it."""
    for name, more in (("plain", []), ("own", [lambda batch: {"mine": batch.outcome}])):
        task = _task(SLEIGH, reductions=["final_state", *more])
        nh.sweep(task, nh.Grid({"a": [0.1, 0.3]}), tmp_path / f"{name}.zarr")
        sweep_to_csv(tmp_path / f"{name}.zarr", tmp_path / f"{name}.csv")
    assert len(_read(tmp_path / "own.csv")) == 2
    assert (tmp_path / "own.csv").read_text() == (tmp_path / "plain.csv").read_text()


@pytest.mark.parametrize(
    ("task", "told"),
    [
        (lambda block: {"final_pose": block["a"]}, r"`sweep_to_csv\(store=\.\.\.\)` must hold poses"),
        (_task(SLEIGH, reconstruct=False), "Keep 'final_state' with reconstruct=True"),
    ],
    ids=["function", "no poses"],
)
def test_refused_without_poses(task: Any, told: str, tmp_path: Path) -> None:
    """A sweep that kept no poses says what to keep; what a function calls a pose is of no known system."""
    nh.sweep(task, nh.Grid({"a": [0.1, 0.3]}), tmp_path / "s.zarr")
    with pytest.raises(ValueError, match=told):
        sweep_to_csv(tmp_path / "s.zarr", tmp_path / "poses.csv")
    assert not (tmp_path / "poses.csv").exists()


def test_refused_without_the_system(tmp_path: Path) -> None:
    """A store whose discretization is no data is said to hold it, not to be passed a task."""
    nh.sweep(_task(SLEIGH), nh.Grid({"a": [0.1, 0.3]}), tmp_path / "s.zarr")
    document = json.loads((tmp_path / "s.zarr" / "zarr.json").read_text())
    told = json.loads(document["attributes"]["sweep"])
    told["task"]["motion"] = json.dumps(json.loads(told["task"]["motion"]) | {"difference": "callable"})
    document["attributes"]["sweep"] = json.dumps(told)
    document["attributes"]["checksum"] = checksum(document["attributes"])
    (tmp_path / "s.zarr" / "zarr.json").write_text(json.dumps(document))
    with pytest.raises(ValueError, match=r"hold its system as data\. Got .*one whose difference is a callable\."):
        sweep_to_csv(tmp_path / "s.zarr", tmp_path / "poses.csv")


def test_refused_when_damaged(tmp_path: Path) -> None:
    """A damaged chunk is named and nothing is written."""
    nh.sweep(_task(SLEIGH), nh.Grid({"a": [0.1, 0.3]}), tmp_path / "s.zarr")
    chunk = tmp_path / "s.zarr" / "final_pose" / "c" / "0" / "0"
    chunk.write_bytes(chunk.read_bytes()[:-3])
    with pytest.raises(ValueError, match="chunk c/0/0 of the array final_pose"):
        sweep_to_csv(tmp_path / "s.zarr", tmp_path / "poses.csv")
    assert not (tmp_path / "poses.csv").exists()
