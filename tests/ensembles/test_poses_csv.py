"""The last poses of a sweep as CSV: those of `simulate`, in the user's body frame."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import nonholo as nh
from nonholo.cli._app import app
from nonholo.ensembles import sweep_to_csv
from nonholo.io import checksum

SLEIGH = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5, b=0.2), time_step=0.1)
TOP = nh.discretize(nh.SuslovTop.from_inertia(np.diag([1.0, 2.0, 2.5]), axis=(0.6, 0, 0.8)), time_step=0.1)


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


def test_space(tmp_path: Path) -> None:
    """Rows of a sweep of tops hold the quaternion, scalar first, in the user's frame whatever the forbidden axis is."""
    design = nh.RandomDesign(3, {"restricted_velocity": nh.Direction(2)}, rng=5)
    found = nh.sweep(_task(TOP), design, tmp_path / "t.zarr")
    result = CliRunner().invoke(app, ["export", str(tmp_path / "t.zarr"), "-o", str(tmp_path / "poses.csv")])
    assert result.exit_code == 0, result.output
    row = _read(tmp_path / "poses.csv")[1]
    start = ["restricted_velocity_0", "restricted_velocity_1"]
    assert list(row) == ["member", *start, "outcome", "t", "qw", "qx", "qy", "qz"]
    orbit = nh.simulate(TOP, restricted_velocity=found["restricted_velocity"][1].values, steps=20)
    w, x, y, z = (float(row[name]) for name in ("qw", "qx", "qy", "qz"))
    g = orbit.configuration[-1]
    vector = np.array([g[2, 1] - g[1, 2], g[0, 2] - g[2, 0], g[1, 0] - g[0, 1]]) / (4 * w)
    assert abs(4 * w * w - 1 - np.trace(g)) < 1e-13
    assert np.abs(vector - [x, y, z]).max() < 1e-13


def test_reductions_need_not_be_found(tmp_path: Path) -> None:
    """Poses beside what a reduction without an importable name keeps are those of a sweep without it."""
    for name, more in (("plain", []), ("own", [lambda batch: {"mine": batch.outcome}])):
        task = _task(SLEIGH, reductions=["final_state", *more])
        nh.sweep(task, nh.Grid({"a": [0.1, 0.3]}), tmp_path / f"{name}.zarr")
        sweep_to_csv(tmp_path / f"{name}.zarr", tmp_path / f"{name}.csv")
    assert len(_read(tmp_path / "own.csv")) == 2
    assert (tmp_path / "own.csv").read_text() == (tmp_path / "plain.csv").read_text()


def test_refused_for_a_function(tmp_path: Path) -> None:
    """What a function calls a pose is of no known system, and is refused like a sweep without poses."""
    nh.sweep(lambda block: {"final_pose": block["a"]}, nh.Grid({"a": [0.1, 0.3]}), tmp_path / "s.zarr")
    with pytest.raises(ValueError, match=r"`sweep_to_csv\(store=\.\.\.\)` must hold poses"):
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


def test_refused_without_poses(tmp_path: Path) -> None:
    """A sweep that kept no poses says what to keep."""
    nh.sweep(_task(SLEIGH, reconstruct=False), nh.Grid({"a": [0.1, 0.3]}), tmp_path / "s.zarr")
    with pytest.raises(ValueError, match="Keep 'final_state' with reconstruct=True"):
        sweep_to_csv(tmp_path / "s.zarr", tmp_path / "poses.csv")
    assert not (tmp_path / "poses.csv").exists()


def test_refused_when_damaged(tmp_path: Path) -> None:
    """A damaged chunk is named and nothing is written."""
    nh.sweep(_task(SLEIGH), nh.Grid({"a": [0.1, 0.3]}), tmp_path / "s.zarr")
    chunk = tmp_path / "s.zarr" / "final_pose" / "c" / "0" / "0"
    chunk.write_bytes(chunk.read_bytes()[:-3])
    with pytest.raises(ValueError, match="chunk c/0/0 of the array final_pose"):
        sweep_to_csv(tmp_path / "s.zarr", tmp_path / "poses.csv")
    assert not (tmp_path / "poses.csv").exists()
