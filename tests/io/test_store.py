"""Stores: what is read is what was saved, whole or not at all, and damage is named."""

import dataclasses
import errno
import hashlib
import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zarr
from damage import DAMAGE, damage
from refusals import assert_refused
from stopping import stopped_at

import nonholo as nh
from nonholo.base.compiled import way_of_kernels
from nonholo.io import orbit_to_dataset, orbits
from nonholo.io.blocks import edit_attributes
from nonholo.io.datasets import stored_variables
from nonholo.io.metadata import read_attributes
from nonholo.io.places import write_lock

NAMES = ("time", "reduced_momentum", "cayley", "canonical_pose", "turned")


def _orbit(steps: int = 20, **options: Any) -> nh.Orbit:
    discrete = nh.discretize(nh.ChaplyginSleigh(1.1, 0.7, 0.3, 0.1), 0.1)
    return nh.simulate(discrete, body_velocity=(0.3, -1.0, 0.0), steps=steps, **options)


def _flow(times: Any, **options: Any) -> nh.Orbit:
    return nh.flow(nh.ChaplyginSleigh(1.1, 0.7, 0.3, 0.1), body_velocity=(0.3, -1.0, 0.0), times=times, **options)


def _same(one: nh.Orbit, other: nh.Orbit) -> bool:
    return all(np.array_equal(getattr(one, name), getattr(other, name)) for name in NAMES)


@pytest.fixture
def store(tmp_path: Path) -> Path:
    """A sound store of 21 states."""
    nh.save_orbit(_orbit(), tmp_path / "run.zarr")
    return tmp_path / "run.zarr"


@pytest.mark.parametrize(
    "orbit",
    [
        *(_orbit(save_every=5), _orbit(reconstruct=False), _orbit()[3:15:2], _orbit()[:0]),
        nh.examples.sleigh_in_a_well().simulate(steps=2)[:0],
        dataclasses.replace(_orbit(), turned=np.linspace(0, 9, 21), outcome=nh.Outcome.no_real_branch),
        *(_flow(np.linspace(0.0, 4.0, 9), method=method) for method in (None, "closed_form")),
    ],
    ids=["thinned", "no poses", "slice", "empty", "empty under a potential", "stopped", "flow", "closed form"],
)
def test_orbits_of_any_kind_round_trip(orbit: nh.Orbit, tmp_path: Path) -> None:
    """Thinned, unreconstructed, sliced, empty, stopped and continuous orbits come back as they were."""
    nh.save_orbit(orbit, tmp_path / "o.zarr")
    loaded = nh.load_orbit(tmp_path / "o.zarr")
    assert _same(orbit, loaded)
    assert (loaded.save_every, loaded.outcome) == (orbit.save_every, orbit.outcome)
    assert type(loaded.motion) is type(orbit.motion)


def test_several_chunks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An orbit longer than a chunk is cut and joined without loss."""
    monkeypatch.setattr(orbits, "_ROWS", 8)
    nh.save_orbit(_orbit(), tmp_path / "o.zarr")
    assert zarr.open_array(tmp_path / "o.zarr" / "canonical" / "cayley", mode="r").nchunks == 3
    assert _same(_orbit(), nh.load_orbit(tmp_path / "o.zarr"))


def test_every_array_is_checked_by_crc32c(store: Path) -> None:
    """Every array ends its codecs with crc32c and has NaN as fill value."""
    arrays = [(name, x) for name, x in zarr.open_group(store, mode="r").members(None) if hasattr(x, "shape")]
    assert len(arrays) > 8
    for name, array in arrays:
        assert array.metadata.to_dict()["codecs"][-1]["name"] == "crc32c", name
        assert np.isnan(array.fill_value), name


def _known(orbit: nh.Orbit) -> Any:
    return orbit_to_dataset(orbit, decoded=True).variables


def test_units_of_every_array() -> None:
    """Each array of a dataset says in which unit its numbers are."""
    variables = [part for orbit in (_orbit(), _flow([0.0, 1.0])) for part in (_known(orbit), stored_variables(orbit))]
    units = {
        "time unit": "time",
        "1": "step canonical/cayley configuration displacement",
        "momentum unit": "restricted_momentum canonical/reduced_momentum momentum",
        "length unit": "x y",
        "rad": "heading canonical/turned",
        "force unit, or times time": "multipliers",
        "1, lengths in length unit": "canonical/pose",
        "energy unit": "energy",
        "1 / time unit": "body_velocity",
    }
    report = {str(name): rows.attrs["units"] for result in variables for name, rows in result.items()}
    assert report == {name: unit for unit, names in units.items() for name in names.split()}


def test_provenance(tmp_path: Path) -> None:
    """A store names system, motion, versions, precision, conventions and the scenario with its hash."""
    nh.save_orbit(_orbit(), tmp_path / "o.zarr", scenario="title = 'x'\n")
    stored = read_attributes(tmp_path / "o.zarr")
    assert stored["system"] == "ChaplyginSleigh"
    assert json.loads(stored["parameters"]) == {"mass": 1.1, "inertia": 0.7, "a": 0.3, "b": 0.1}
    assert json.loads(stored["motion"])["time_step"] == 0.1
    assert json.loads(stored["versions"])["nonholo"] == nh.__version__
    assert stored["kernels"] == way_of_kernels()
    assert stored["scenario_sha256"] == hashlib.sha256(b"title = 'x'\n").hexdigest()


def test_a_store_is_replaced_only_when_asked(store: Path) -> None:
    """An existing store is kept and the remedy named; with overwrite=True the new one takes its place, alone."""
    with pytest.raises(FileExistsError, match="overwrite=True"):
        nh.save_orbit(_orbit(5), store)
    assert len(nh.load_orbit(store)) == 21
    nh.save_orbit(_orbit(5), store, overwrite=True)
    assert len(nh.load_orbit(store)) == 6
    assert list(store.parent.iterdir()) == [store]


@pytest.mark.parametrize("make", [Path.touch, Path.mkdir], ids=["file", "folder"])
def test_overwrite_never_replaces_anything_else(make: Callable[[Path], None], tmp_path: Path) -> None:
    """Files and folders that are no stores survive overwrite=True."""
    make(tmp_path / "precious")
    with pytest.raises(FileExistsError, match="not a store"):
        nh.save_orbit(_orbit(5), tmp_path / "precious", overwrite=True)
    assert (tmp_path / "precious").exists()


@pytest.mark.parametrize(
    ("name", "remedy"),
    [
        ("o.nc", r"'.*/o\.zarr', or use orbit.to_dataset\(\)\.to_netcdf\(path\)"),
        ("o.H5", "to_netcdf"),
        ("o.csv", r"or use orbit\.to_csv\(path\)"),
        ("o.json", r"Write a store: '.*/o\.zarr'\.$"),
    ],
)
def test_suffixes_of_other_formats_are_refused(name: str, remedy: str, tmp_path: Path) -> None:
    """A store is not written under the suffix of another format, saved or run into, old or new."""
    assert_refused(tmp_path / name, f"^`save_orbit.*{remedy}", lambda path: nh.save_orbit(_orbit(5), path))
    assert_refused(tmp_path / name, f"^`simulate.*{remedy}", lambda path: _orbit(5, store=path))
    assert not list(tmp_path.iterdir())
    nh.save_orbit(_orbit(5), tmp_path / "run.2")
    assert len(nh.load_orbit(tmp_path / "run.2")) == 6


def test_full_disk_leaves_the_old_store(store: Path) -> None:
    """If the disk fills up while writing, the error says so, the old store is intact, nothing is left behind."""
    full = OSError(errno.ENOSPC, "No space left on device")
    with stopped_at(0, full, r"No space left on device\. Nothing at this path was changed") as caught:
        nh.save_orbit(_orbit(5), store, overwrite=True)
    assert caught.value.errno == errno.ENOSPC
    assert len(nh.load_orbit(store)) == 21
    assert list(store.parent.iterdir()) == [store]


@pytest.mark.parametrize("place", ["run.zarr", "folder/run.zarr"])
def test_refused_place_is_named(place: str, tmp_path: Path) -> None:
    """A place below a file is refused with its path and a remedy, for a run into a store as for a saved orbit."""
    (tmp_path / "file").write_text("mine")
    path = tmp_path / "file" / place
    for write in (lambda: nh.save_orbit(_orbit(5), path), lambda: _orbit(5, store=path)):
        with pytest.raises(OSError, match=r"Nothing at this path was changed\. .*choose another path") as caught:
            write()
        assert caught.value.filename == str(path)
    assert (tmp_path / "file").read_text() == "mine"


def test_failed_swap_brings_the_old_store_back(store: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """If the new store cannot take its place, the old one returns to it."""
    rename = Path.rename

    def refuse(path: Path, target: Path) -> Path:
        if path.name.endswith(".partial"):
            raise PermissionError(errno.EACCES, "refused")
        return rename(path, target)

    monkeypatch.setattr(Path, "rename", refuse)
    with pytest.raises(OSError, match="refused"):
        nh.save_orbit(_orbit(5), store, overwrite=True)
    assert len(nh.load_orbit(store)) == 21
    assert list(store.parent.iterdir()) == [store]


@pytest.mark.profile("faults", keep=["x-*", "canonical/pose-cut"])
@pytest.mark.parametrize("how", DAMAGE)
@pytest.mark.parametrize("name", ["time", "energy", "x", "restricted_momentum", "canonical/cayley", "canonical/pose"])
def test_damaged_chunk_is_named(how: str, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A chunk that is missing, changed or cut is an error that names array and chunk, never data."""
    monkeypatch.setattr(orbits, "_ROWS", 8)
    nh.save_orbit(_orbit(), tmp_path / "o.zarr")
    key = "c/1" if name in ("time", "energy", "x") else "c/1/0"
    damage(tmp_path / "o.zarr" / name / key, how)
    assert_refused(tmp_path / "o.zarr", f"chunk {key} of the array {name}", nh.load_orbit)


def test_nan_is_refused(tmp_path: Path) -> None:
    """NaN among the states is an error, since every saved state is a good one."""
    orbit = _orbit()
    momentum = orbit.reduced_momentum.copy()
    momentum[7, 1] = np.nan
    nh.save_orbit(dataclasses.replace(orbit, reduced_momentum=momentum), tmp_path / "o.zarr")
    assert_refused(tmp_path / "o.zarr", "hold sound chunks. Got NaN, chunk .* of the array energy", nh.load_orbit)


def test_missing_array_is_named(store: Path) -> None:
    """An array whose metadata are gone is named."""
    (store / "canonical" / "pose" / "zarr.json").unlink()
    assert_refused(store, "hold the array canonical/pose", nh.load_orbit)


def test_changed_shape_is_refused(store: Path) -> None:
    """An array that is shorter than the store says is refused."""
    metadata = json.loads((store / "time" / "zarr.json").read_text())
    (store / "time" / "zarr.json").write_text(json.dumps(metadata | {"shape": [20]}))
    assert_refused(store, r"array time as float64 of shape \(21,\)", nh.load_orbit)


CUTS = {
    "chunks of nothing": {"chunk_shape": [0, 0]},
    "backwards": {"chunk_shape": [-1, -1]},
    "huge chunks": {"chunk_shape": [2**62, 2**62]},
    "other rank of chunks": {"chunk_shape": [4]},
    "no axis": {"shape": [], "chunk_shape": []},
    "one axis": {"shape": [8], "chunk_shape": [8]},
    "three axes": {"shape": [2, 4, 2], "chunk_shape": [2, 4, 2]},
    "no columns": {"shape": [3, 0], "chunk_shape": [1, 1]},
    "endless": {"shape": [2**70, 4], "chunk_shape": [1, 4]},
}


_MORE = ["canonical/pose-*axes", "*-backwards", "*-endless", "canonical/pose-no*", "run/events-no c*", "run/events-h*"]


@pytest.mark.profile("faults", cases=_MORE)
@pytest.mark.parametrize("cut", CUTS)
@pytest.mark.parametrize("name", ["canonical/pose", "run/events"])
def test_other_cuts_are_refused(cut: str, name: str, tmp_path: Path) -> None:
    """Metadata of an array that is cut otherwise than ours are refused by its name, whoever reads it."""
    _orbit(8, events=[nh.cusp], store=tmp_path / "run.zarr")
    file = tmp_path / "run.zarr" / name / "zarr.json"
    metadata, changed = json.loads(file.read_text()), dict(CUTS[cut])
    metadata["chunk_grid"]["configuration"]["chunk_shape"] = changed.pop("chunk_shape")
    file.write_text(json.dumps(metadata | changed | {"dimension_names": None}))
    doors = (nh.load_orbit, lambda path: nh.extend(path, 3, events=[nh.cusp]))
    assert_refused(tmp_path / "run.zarr", f"`.* must .*{name}", *doors)


def test_foreign_stores_are_refused(tmp_path: Path) -> None:
    """A Zarr group of another program, a folder and a file are refused as stores; a path without anything too."""
    zarr.create_group(tmp_path / "foreign")
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").write_text("x")
    for name in ("foreign", "folder", "file"):
        assert_refused(tmp_path / name, "must be a store of an orbit", nh.load_orbit)
    assert_refused(tmp_path / "nothing", "must exist", nh.load_orbit, kind=FileNotFoundError)


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("save_every", 0, "save_every: Input should be greater than 0"),
        ("save_every", "1", "save_every: Input should be a valid integer"),
        ("save_every", 10**400, "save_every"),
        ("parameters", "[1]", "parameters: Input should be a valid dictionary"),
        ("motion", "[" * 100_000, "motion"),
        ("arrays", '{"../other.zarr/time": [21], "time": [21]}', "'../other.zarr/time' is no name"),
        ("arrays", '{"/etc/time": [21], "time": [21]}', "is no name"),
        ("arrays", '{"time": [21], "energy": [20]}', "must have one length"),
        ("arrays", '{"time": [21], "energy": [21]}', "must have momenta"),
        ("versions", "7", "versions"),
        ("outcome", "splendid", "outcome: Input should be 'successful'"),
        ("run", '{"steps": 1e300, "rows": 1, "reconstruct": true}', "run.steps"),
        ("scenario", "a text that was not run", "scenario_sha256 differs"),
        ("arrays", "not json", "arrays: Invalid JSON"),
        ("schema", 99, "schema 99. Upgrade nonholo: "),
        ("system", "Warp", "system of this version. Got 'Warp'"),
        ("motion", {"kind": "Beam"}, "motion of this version. Got 'Beam'"),
        ("motion", {"route": "elliptic"}, "hold a run by a route of this version"),
        ("parameters", {"color": 1.0}, "hold parameters of nonholo.ChaplyginSleigh. Got "),
    ],
)
def test_edited_attributes_are_refused(name: str, value: Any, message: str, tmp_path: Path) -> None:
    """What a store says of itself, or another version would say, is checked as data, and each problem is named."""
    store = tmp_path / "run.zarr"
    _orbit(store=store)
    if isinstance(value, dict):
        value = json.dumps(json.loads(read_attributes(store)[name]) | value)
    edit_attributes(store, {name: value})
    assert_refused(store, re.escape(message), nh.load_orbit, nh.resume)


def test_only_what_is_ours_is_replaced(store: Path) -> None:
    """A store that holds a foreign file, or that is being written, stays, whatever `overwrite` says."""
    orbit = nh.load_orbit(store)
    (store / "thesis.tex").write_text("years of work")
    with pytest.raises(FileExistsError, match=r"holds 'thesis.tex', which is no part of a store"):
        nh.save_orbit(orbit, store, overwrite=True)
    (store / "thesis.tex").unlink()
    with write_lock(store), pytest.raises(BlockingIOError, match=r"is being written by process \d+ .* not replaced"):
        nh.save_orbit(orbit, store, overwrite=True)
    nh.save_orbit(orbit, store, overwrite=True)
    assert nh.load_orbit(store).canonical_pose.tobytes() == orbit.canonical_pose.tobytes()
