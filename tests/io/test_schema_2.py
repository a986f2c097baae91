"""Stores of schema 2 of orbits and 1 of sweeps, which had canonical poses alone, are read and resumed.

`schema_2` was written by the last version of that kind: finished stores, and runs and a sweep stopped half way. Its
`expected.json` holds what that version made of the finished ones, and of the same runs without a stop.
"""

import io
import json
import shutil
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray

import nonholo as nh
from nonholo.ensembles import sweep_to_csv
from nonholo.io import read_attributes, store_to_csv

_STORES = Path(__file__).with_name("schema_2")
_EXPECTED = json.loads((_STORES / "expected.json").read_text())
SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.3, 0.7, 0.5, b=0.3), 0.1)


def _copied(name: str, folder: Path) -> Path:
    return Path(shutil.copytree(_STORES / f"{name}.zarr", folder / f"{name}.zarr"))


def _numbers(csv: str) -> np.ndarray:
    return np.array([line.split(",") for line in csv.splitlines()[1:]], dtype=float)


def _same(orbit: nh.Orbit, name: str) -> None:
    assert np.array_equal(orbit.canonical_pose, _EXPECTED[name]["pose"]) or name.startswith("stopped")
    for key in ("time", "reduced_momentum", "configuration", "energy"):
        assert np.allclose(getattr(orbit, key), _EXPECTED[name][key], rtol=0, atol=1e-12), key  # numbers of order one


@pytest.mark.parametrize("name", ["top", "flow"])
def test_finished_orbits(name: str) -> None:
    """A finished orbit has its canonical poses bit for bit, and its pose is the user's."""
    orbit = nh.load_orbit(_STORES / f"{name}.zarr")
    _same(orbit, name)
    assert np.abs(orbit.system.group.matrix_from_pose(orbit.pose) - orbit.configuration).max() < 1e-14
    assert np.abs(np.array(_EXPECTED[name]["pose"]) - orbit.pose).max() > 0.1, "frames have to differ"


def test_poses_as_csv() -> None:
    """The CSV of an older store is what it was."""
    stream = io.StringIO()
    store_to_csv(_STORES / "top.zarr", stream)
    assert np.abs(_numbers(stream.getvalue()) - _numbers(_EXPECTED["top"]["csv"])).max() < 1e-13


@pytest.mark.parametrize("name", ["stopped_top", "stopped_sleigh"])
def test_stopped_runs_go_on(name: str, tmp_path: Path) -> None:
    """A stopped run continues in its own schema to the run without a stop, and can be extended."""
    path, events = _copied(name, tmp_path), [nh.cusp] if name == "stopped_sleigh" else None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # other versions of packages
        orbit = nh.resume(path, events=events)
        _same(orbit, name)
        longer = nh.extend(path, 7, events=events)
    assert read_attributes(path)["schema"] == 2
    assert np.array_equal(longer.canonical_pose[:41], orbit.canonical_pose)
    assert len(longer) == 48
    if events:
        assert np.allclose(longer.events["cusp"].time, _EXPECTED["cusp"], rtol=0, atol=1e-12)


def _opened(path: Path) -> dict[str, Any]:
    with xarray.open_zarr(path, chunks=None) as found:
        return {str(name): rows.values for name, rows in found.variables.items()}


@pytest.mark.parametrize("given", [None, "restricted_velocity[0]", "restricted_velocity_0"])
def test_stopped_sweep_goes_on(given: str | None, tmp_path: Path) -> None:
    """A stopped sweep continues with the poses and names that it has, resumed or begun again under either name."""
    path = _copied("stopped_sweep", tmp_path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        if given is None:
            nh.resume(path)
        else:
            task = nh.EnsembleTask(SLEIGH, steps=20, restricted_velocity=(0.3, -1.0))
            nh.sweep(task, nh.Grid({"b": [0.0, 0.3], given: [0.5, 1.0, 1.5]}), path, resume=True)
    found = _opened(path)
    assert {"b", "restricted_velocity[0]"} <= found.keys()
    for name, values in _EXPECTED["stopped_sweep"].items():
        assert name == "csv" or np.allclose(found[name], values, rtol=0, atol=1e-12), name
    stream = io.StringIO()
    sweep_to_csv(path, stream)
    assert np.abs(_numbers(stream.getvalue()) - _numbers(_EXPECTED["stopped_sweep"]["csv"])).max() < 1e-12


def test_finished_sweep(tmp_path: Path) -> None:
    """A finished sweep is opened, drawn as it would be drawn now, and its poses are written in the user's frame."""
    path = _copied("random", tmp_path)
    with nh.load_sweep(path) as found:
        for name in ("final_pose", "final_momentum", "restricted_velocity[1]"):
            assert np.array_equal(found[name].values, _EXPECTED["random"][name]), name
    drawn = nh.RandomDesign(4, {"restricted_velocity_1": nh.Uniform(0.1, 1.0)}, seed=3).values(0, 4)
    assert drawn["restricted_velocity_1"].tolist() == _EXPECTED["random"]["restricted_velocity[1]"]
    with pytest.warns(RuntimeWarning, match=r'was begun with .*"nonholo": "0\.1\.0"'):
        nh.resume(path).close()
    stream = io.StringIO()
    sweep_to_csv(path, stream)
    assert np.abs(_numbers(stream.getvalue()) - _numbers(_EXPECTED["random"]["csv"])).max() < 1e-13
