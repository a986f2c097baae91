"""Data sets: the same numbers again, starts as defined, splits, noise, tables, stopped calls, refusals."""

import hashlib
import json
import shutil
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
import xarray
from refusals import refusals

import nonholo as nh
from nonholo.ensembles import DEFINITIONS
from nonholo.ensembles.datasets import system_of
from nonholo.ensembles.stores import RAISED

DIGESTS = Path(__file__).parent / "dataset_definitions.json"
FAMILIES = [name for name, each in DEFINITIONS.items() if "start_energy" not in each.distributions]


def sleighs(a: Any = nh.Uniform(0.2, 0.5), speed: Any = nh.Normal(0.0, 0.3, size=2)) -> SimpleNamespace:  # noqa: B008
    """Sleighs of our own."""
    system = nh.ChaplyginSleigh(1.0, 1.0, a)
    return SimpleNamespace(system=system, configuration=np.eye(3), body_velocity=np.append(speed, 0.0))


def _written(folder: Path, name: Any = "sleigh", **options: Any) -> tuple[xarray.Dataset, dict[str, Any]]:
    """Write a small data set, and return it with its record."""
    nh.dataset(name, folder, **{"orbits": 10, "steps": 6, **options})
    return nh.load_sweep(folder / "orbits.zarr").load(), json.loads((folder / "metadata.json").read_text())


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small data set with noise."""
    return nh.dataset("sleigh", tmp_path_factory.mktemp("data") / "sleighs", orbits=10, steps=6, noise=0.01, rng=3)


def test_the_same_seed_gives_the_same_bits(folder: Path, tmp_path: Path) -> None:
    """Another call has the same hashes; fewer orbits are the first of them; another seed has others."""
    again, record = _written(tmp_path / "again", noise=0.01, rng=3)
    assert record["fields"] == json.loads((folder / "metadata.json").read_text())["fields"]
    few, _ = _written(tmp_path / "few", noise=0.01, rng=3, orbits=4)
    for name in set(few.variables) - {"split"}:
        assert few[name].values.tobytes() == again[name].values[:4].tobytes()
    other, _ = _written(tmp_path / "other", rng=4)
    assert not (other.start_energy == again.start_energy).any()


def test_hashes_are_those_of_the_arrays(folder: Path) -> None:
    """The record has the SHA-256 of the numbers as xarray opens them."""
    data, record = xarray.open_zarr(folder / "orbits.zarr"), json.loads((folder / "metadata.json").read_text())
    assert set(record["fields"]) == set(data.variables)
    for name, field in record["fields"].items():
        values = data[name].values
        assert hashlib.sha256(values.astype(values.dtype.newbyteorder("<")).tobytes()).hexdigest() == field["sha256"]
        assert list(values.shape) == field["shape"]
        assert list(data[name].dims) == field["dimensions"]


def test_the_body_is_named_with_its_parameters(folder: Path) -> None:
    """Record and card say which body moved: what is learned from orbits can be compared with it."""
    system = json.loads((folder / "metadata.json").read_text())["system"]
    body = system_of("sleigh")
    assert system["kind"] == "ChaplyginSleigh"
    assert repr(nh.ChaplyginSleigh(**system["parameters"])) == repr(body)
    assert "- a: 0.5" in (folder / "README.md").read_text()


@pytest.mark.profile("routes", keep=["top", "sleigh_se3"])
@pytest.mark.parametrize("name", [name for name in DEFINITIONS if name not in FAMILIES])
def test_every_definition_runs_as_it_says(name: str, tmp_path: Path) -> None:
    """Orbits succeed, and their first kinetic energies and configurations are those that were drawn."""
    data, _ = _written(tmp_path / name, name, orbits=3, steps=20, time_step=0.02)
    system, definition = system_of(name), cast(Any, DEFINITIONS[name])
    assert (data.outcome == 0).all()
    assert ((definition.energy[0] <= data.start_energy) & (data.start_energy <= definition.energy[1])).all()
    for member in range(3):
        start = {name: data[name].values[member] for name in data if str(name).startswith("start_")}
        q = start.get("start_configuration")
        if q is not None and "configuration" in data:
            assert np.array_equal(data.configuration[member, 0], q)
        q = q if q is None or "configuration" in data else system.group.exp(q)
        p = np.array(definition.weights) * start["start_direction"]
        energies = [nh.flow(system, configuration=q, momentum=s * p, times=[0.0]).energy[0] for s in (-1.0, 0.0, 1.0)]
        kinetic = np.dot(energies, [0.5, -1.0, 0.5])
        again = nh.flow(system, configuration=q, momentum=np.sqrt(start["start_energy"] / kinetic) * p, times=[0.0])
        assert again.energy[0] == pytest.approx(data.energy.values[member, 0], rel=0.05, abs=0.02)  # of a step


@pytest.mark.profile("routes", instead="test_a_function_of_our_own_makes_systems_with_their_starts")
@pytest.mark.parametrize("name", FAMILIES)
def test_orbits_of_a_family_are_those_of_the_ready_system(name: str, tmp_path: Path) -> None:
    """Those that its function makes of the arguments that were drawn, in its own step, to the bit."""
    data, record = _written(tmp_path / name, name, orbits=3, steps=20)
    assert (data.outcome == 0).all()
    arguments = {each: data[each].values[2] for each in DEFINITIONS[name].distributions}
    orbit = getattr(nh.examples, name)(**arguments).simulate(steps=20, time_step=record["time_step"])
    assert np.array_equal(data.configuration[2], orbit.configuration)


def test_a_function_of_our_own_makes_systems_with_their_starts(tmp_path: Path) -> None:
    """Its random arguments are fields; a store that is stopped imports it only if it is trusted."""
    data, record = _written(tmp_path / "own", sleighs)
    assert record["title"] == "Sleighs of our own"
    assert record["command"].endswith(f"--module {sleighs.__module__}.py")
    ready = sleighs(*(data[name].values[3] for name in ("a", "speed")))
    start: dict[str, Any] = {"configuration": ready.configuration, "body_velocity": ready.body_velocity}
    orbit = nh.simulate(nh.discretize(ready.system, 0.05), **start, steps=6)
    assert np.array_equal(data.body_velocity[3], orbit.body_velocity)
    store = tmp_path / "own" / "orbits.zarr"
    (store / "run" / "blocks" / "0.json").unlink()
    with pytest.raises(ValueError, match=r"unless trusted"):
        nh.resume(store)
    assert nh.resume(store, trust=True).load().identical(data)


def test_orbits_whose_system_cannot_be_made_are_labeled(tmp_path: Path) -> None:
    """The record has the first system that there is, also if it is not that of orbit 0; no command makes it again."""

    def few(a: Any = nh.Uniform(-1.0, 0.5)) -> SimpleNamespace:  # noqa: B008
        return sleighs(a if a > 0 else [a], np.ones(2))

    data, record = _written(tmp_path / "few", few, file_format="zarr")
    first = int(np.argmax(data.a.values > 0))
    assert (data.outcome.values == np.where(data.a > 0, 0, RAISED)).all()
    assert first > 0
    assert record["system"]["parameters"]["a"] == data.a.values[first]
    assert record["command"] == "the Python call nonholo.dataset"


def test_energies_are_those_that_were_drawn(folder: Path) -> None:
    """A sleigh has no other energy than its kinetic one, which it keeps."""
    data = nh.load_sweep(folder / "orbits.zarr").load()
    np.testing.assert_allclose(data.energy, data.start_energy.expand_dims(step=7, axis=1), rtol=1e-13)


def test_orbits_are_those_of_the_library(folder: Path) -> None:
    """An orbit is what `simulate` returns for its momentum, impulses too; the last one is missing."""
    data = nh.load_sweep(folder / "orbits.zarr").load()
    discrete = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, a=0.5, b=0.3), 0.05)
    orbit = nh.simulate(discrete, momentum=data.restricted_momentum.values[7, 0], steps=6)
    np.testing.assert_allclose(data.heading[7], orbit.heading, rtol=1e-13)
    np.testing.assert_allclose(data.multipliers[7, :-1], orbit.multipliers, rtol=1e-12)
    assert np.isnan(data.multipliers[:, -1]).all()
    assert np.array_equal(data.time[7], orbit.time)


def test_parts_are_disjoint_and_of_the_sizes_asked_for(tmp_path: Path) -> None:
    """The label counts the parts, one after the other, which the record names."""
    data, record = _written(tmp_path / "parts", split=(0.5, 0.0, 0.5), steps=1)
    assert data.split.values.tolist() == 5 * [0] + 5 * [2]
    assert record["split"] == {"train": [0, 5], "validation": [5, 5], "test": [5, 10]}
    assert data.split.attrs["flag_meanings"] == "train validation test"


def test_noise_is_beside_the_exact_numbers(folder: Path, tmp_path: Path) -> None:
    """Observed fields differ by the deviation asked for, independently; without noise there are none."""
    exact, _ = _written(tmp_path / "exact", rng=3)
    noisy = nh.load_sweep(folder / "orbits.zarr").load()
    assert set(noisy) - set(exact) == {f"observed_{name}" for name in ("x", "y", "heading", "body_velocity")}
    assert all(noisy[name].equals(exact[name]) for name in exact)
    added = [(noisy[f"observed_{name}"] - noisy[name]).values.ravel() / 0.01 for name in ("x", "y", "body_velocity")]
    added = np.concatenate(added)  # 350 normal numbers
    assert abs(added.mean()) < 4 / np.sqrt(added.size)
    assert abs(added.std() - 1) < 4 / np.sqrt(2 * added.size)
    assert len(np.unique(added.round(9))) == added.size


def test_tables_have_the_numbers_of_the_store(folder: Path, tmp_path: Path) -> None:
    """A row for each state, every number read back exactly, each part in its own file; no store stays."""
    tables = nh.dataset("sleigh", tmp_path / "t", orbits=10, steps=6, noise=0.01, rng=3, file_format="csv")
    assert {each.name for each in tables.iterdir()} == {
        *("train.csv", "validation.csv", "test.csv"),
        *("README.md", "metadata.json"),
    }
    data = nh.load_sweep(folder / "orbits.zarr").load()
    for part, orbits in {"train": slice(0, 8), "validation": slice(8, 9), "test": slice(9, 10)}.items():
        table = np.genfromtxt(tables / f"{part}.csv", delimiter=",", names=True)
        assert (table.dtype.names or ())[:2] == ("orbit", "time")
        assert table["orbit"].tolist() == np.repeat(np.arange(10)[orbits], 7).tolist()
        for name in ("time", "heading", "observed_heading", "energy"):
            assert np.array_equal(table[name], data[name].values[orbits].ravel())
        assert np.array_equal(table["body_velocity_1"], data.body_velocity.values[orbits, :, 1].ravel())


def test_tables_name_numbers_as_data_frames_do(tmp_path: Path) -> None:
    """Columns of a top are those of `to_pandas`, so `fit` knows its quaternions."""
    header = (nh.dataset("top", tmp_path / "t", orbits=2, steps=2, file_format="csv") / "train.csv").read_text()
    orbit = nh.simulate(nh.discretize(system_of("top"), 0.1), restricted_velocity=(0.1, 0.2), steps=2)
    columns = header.splitlines()[0].split(",")
    assert columns == ["orbit", "time", *orbit.to_pandas().columns, "multipliers_0"]
    assert "quaternion_w" in columns


def test_a_stopped_call_is_resumed(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A call that was stopped when blocks were missing is resumed by the same call, with the same bits."""
    options: dict[str, Any] = {"orbits": 10, "steps": 6, "noise": 0.01, "rng": 3}
    with monkeypatch.context() as stop:
        stop.setattr("nonholo.ensembles._dataset.record_of", lambda *_: (_ for _ in ()).throw(KeyboardInterrupt))
        with pytest.raises(KeyboardInterrupt):
            nh.dataset("sleigh", tmp_path / "stopped", **options)
    store = tmp_path / "stopped" / "orbits.zarr"
    for lost in (store / "run" / "blocks" / "0.json", store / "heading" / "c" / "0" / "0"):
        lost.unlink()
    with pytest.raises(ValueError, match="steps is 7 instead of 6"):
        nh.dataset("sleigh", tmp_path / "stopped", **{**options, "steps": 7})
    nh.dataset("sleigh", tmp_path / "stopped", **options)
    records = [json.loads((each / "metadata.json").read_text()) for each in (folder, tmp_path / "stopped")]
    assert records[0]["fields"] == records[1]["fields"]


def test_a_store_is_resumed_by_itself(folder: Path, tmp_path: Path) -> None:
    """`resume` makes the task again from the store; one of another version is refused."""
    copy = shutil.copytree(folder / "orbits.zarr", tmp_path / "copy.zarr")
    before = nh.load_sweep(copy).load()
    (copy / "run" / "blocks" / "0.json").unlink()
    assert nh.resume(copy).load().identical(before)


def test_finished_folders_and_files_are_refused(folder: Path, tmp_path: Path) -> None:
    """Nothing is overwritten: neither a data set, nor what is no data set."""
    (tmp_path / "mine.txt").write_text("mine")
    for there in (folder, tmp_path, tmp_path / "mine.txt"):
        with pytest.raises(FileExistsError, match=r"must be new"):
            nh.dataset("sleigh", there, orbits=10, steps=6)


# The message names the argument and what it must be; nothing is written.
test_bad_arguments_are_refused = refusals(
    ({"name": "slegh"}, r"must be one of 'top'"),
    ({"name": len}, r"an argument whose default is a distribution. Got <built-in function len>"),
    ({"split": (0.5, 0.4, 0.2)}, r"fractions whose sum is 1"),
    ({"split": (1.5, -0.4, -0.1)}, r"fractions whose sum is 1"),
    ({"noise": -1.0}, r"not be negative"),
    ({"file_format": "hdf5"}, r"must be one of 'zarr', 'csv'"),
    ({"orbits": 10**12, "steps": 10**6}, r"must"),
    ask=lambda given: nh.dataset(**{"name": "sleigh", "folder": "new", "orbits": 3, "steps": 3} | given),
)


def test_a_definition_that_changes_gets_another_version() -> None:
    """Versions and digests of all definitions are those on record: a changed one must raise its version there."""
    result = {
        name: [each.version, hashlib.sha256(repr(each._replace(title="")).encode()).hexdigest()[:16]]
        for name, each in DEFINITIONS.items()
    }
    assert result == json.loads(DIGESTS.read_text())


def test_the_card_says_how_to_load_it(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The lines of the card run, and have the training orbits; it names the command."""
    text = (folder / "README.md").read_text()
    lines = [line.strip() for line in text.splitlines() if line.startswith("    ")]
    assert lines[0].startswith("nonholo dataset sleigh -o sleighs --orbits 10 --steps 6")
    monkeypatch.chdir(folder)
    names: dict[str, Any] = {}
    exec("\n".join(lines[1:]), names)  # noqa: S102
    assert names["train"].sizes["member"] == 8
