"""Stores of strangers: chunks in the place of others, damaged records, evil names and texts, other versions."""

import csv
import io
import json
import os
import shutil
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zarr
from damage import swap
from plot.runs import along
from refusals import assert_refused
from stopping import stopped_at
from typer.testing import CliRunner

import nonholo as nh
from nonholo.base.checks import is_name
from nonholo.cli._app import app
from nonholo.ensembles import sweep_to_csv
from nonholo.io import orbits, store_to_csv
from nonholo.io.blocks import edit_attributes
from nonholo.io.metadata import check_array, read_attributes
from nonholo.io.orbits import open_stream
from nonholo.io.places import SCHEMAS
from nonholo.io.tables import table_lines

SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.1, 0.7, 0.3, 0.1), 0.1)
RUN: dict[str, Any] = {"body_velocity": (0.3, -1.0, 0.0), "steps": 60}
NORTH = nh.Event(lambda states: np.cos(3 * states.heading), name="north")


def _run(store: Path, **more: Any) -> nh.Orbit:
    return nh.simulate(SLEIGH, **RUN, **more, store=store, checkpoint_every=10)


def _export(store: Path) -> None:
    store_to_csv(store, store.with_suffix(".csv"))


@pytest.mark.profile("faults", keep=["canonical*"])
@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("energy/c/2", "energy/c/3"),
        ("canonical/pose/c/2/0", "canonical/pose/c/3/0"),
        ("time/c/1", "time/c/2"),
        ("energy/c/2", "heading/c/2"),
        ("run/blocks/1.json", "run/blocks/3.json"),
        ("run/blocks/start.json", "run/blocks/0.json"),
        ("run/events/c/0/0", "run/events/c/1/0"),
    ],
)
def test_a_chunk_in_the_place_of_another_is_refused(one: str, other: str, tmp_path: Path) -> None:
    """Each of them has its checksum, so only their places tell; an unfinished run computes their blocks again."""
    run = tmp_path / "run.zarr"
    whole = _run(run, events=[NORTH])
    assert len(list((run / "run" / "events" / "c").iterdir())) > 1
    swap(run, one, other)
    assert_refused(run, r"hold|damaged", nh.load_orbit, _export)
    unfinished = tmp_path / "unfinished.zarr"
    with stopped_at(6):
        _run(unfinished, events=[NORTH])
    swap(unfinished, one, other)
    if "start" in one:
        assert_refused(unfinished, "start of the run", lambda path: nh.resume(path, events=[NORTH]))
        return
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that it is damaged
        result = nh.resume(unfinished, events=[NORTH])
    assert result.to_dataset().identical(whole.to_dataset())
    assert result.events["north"].step.tolist() == whole.events["north"].step.tolist()


def test_attributes_of_another_store_are_refused(tmp_path: Path) -> None:
    """Those of another run of this length have a checksum, too; the seals tell that they belong to other chunks."""
    own, other = tmp_path / "own.zarr", tmp_path / "other.zarr"
    _run(own)
    heavier = nh.discretize(nh.ChaplyginSleigh(2.0, 0.7, 0.3, 0.1), 0.1)
    nh.simulate(heavier, **RUN, store=other, checkpoint_every=10)
    shutil.copy(other / "zarr.json", own)
    assert_refused(own, "another place or store in block 0", nh.load_orbit, _export)
    with pytest.warns(RuntimeWarning, match="another place"), pytest.raises(ValueError, match="start of the run"):
        nh.resume(own)


def test_an_orbit_that_was_saved_whole_is_sealed(tmp_path: Path) -> None:
    """Chunks of two of its arrays that have one shape are not taken for each other."""
    nh.save_orbit(nh.simulate(SLEIGH, **RUN), tmp_path / "orbit.zarr")
    swap(tmp_path / "orbit.zarr", "energy/c/0", "heading/c/0")
    assert_refused(tmp_path / "orbit.zarr", "each chunk in its place", nh.load_orbit, _export)


def test_a_damaged_mark_exports_no_other_table(tmp_path: Path) -> None:
    """Poses of an unfinished run are those of its finished blocks; which these are is not guessed."""
    store = tmp_path / "run.zarr"
    with stopped_at(4):
        _run(store)
    (store / "run" / "blocks" / "3.json").write_bytes(b"")
    assert_refused(store, "must hold sound blocks", _export)


def test_a_run_that_failed_before_a_row_is_sealed_too(tmp_path: Path) -> None:
    """A block without rows, and one that an event ended, are as sound as the others."""
    store = tmp_path / "run.zarr"
    stop = nh.Event(lambda states: states.heading - 0.1, stop=1, name="stop")
    result = _run(store, events=[stop])
    assert result.events.stopped_by == "stop"
    assert (
        nh.resume(store, events=[stop]).time.tobytes() == nh.load_orbit(store).time.tobytes() == result.time.tobytes()
    )


@pytest.mark.profile("faults", keep=["run"])
@pytest.mark.parametrize("group", ["run", "canonical"])
def test_metadata_of_inner_groups_are_written_again(group: str, tmp_path: Path) -> None:
    """They say nothing that is not known, so a run continues where they are damaged."""
    store = tmp_path / "run.zarr"
    with stopped_at(3):
        _run(store)
    (store / group / "zarr.json").write_text('{"attributes": "abc"')
    assert nh.resume(store).outcome == nh.Outcome.successful
    assert nh.load_orbit(store).outcome == nh.Outcome.successful


def test_what_is_written_has_a_checksum(tmp_path: Path) -> None:
    """Whoever changes an attribute by hand changes the checksum too, or is noticed: rows, end, steps, the body."""
    _run(tmp_path / "run.zarr")
    document = json.loads((tmp_path / "run.zarr" / "zarr.json").read_text())
    report = document["attributes"]
    edits = {"run": report["run"].replace("60", "90"), "parameters": report["parameters"].replace("1.1", "7.0")}
    for name, value in (edits | {"save_every": 2, "outcome": "not_converged"}).items():
        assert value != report[name]
        edited = document | {"attributes": report | {name: value}}
        (tmp_path / "run.zarr" / "zarr.json").write_text(json.dumps(edited))
        assert_refused(tmp_path / "run.zarr", "checksum differs", nh.load_orbit, nh.resume)


@pytest.mark.parametrize(("key", "value"), [("shape", 10**400), ("clevel", 22), ("clevel", -3)])
def test_numbers_of_an_array_that_zarr_takes_are_refused(key: str, value: int, tmp_path: Path) -> None:
    """A shape beyond all floats, and levels that the compressor does not have."""
    _run(tmp_path / "run.zarr")
    file = tmp_path / "run.zarr" / "time" / "zarr.json"
    document = json.loads(file.read_text())
    (compressor,) = (codec["configuration"] for codec in document["codecs"] if codec["name"] == "blosc")
    (compressor if key == "clevel" else document).update({key: value if key == "clevel" else [value]})
    file.write_text(json.dumps(document))
    with pytest.raises(ValueError, match="The array time is damaged or was edited"):
        check_array("a store", "time", zarr.open_array(file.parent, mode="r"))


def test_texts_do_not_reach_a_terminal_raw(tmp_path: Path) -> None:
    """Texts of a store with control characters are refused when written and when read; errors show them harmless."""
    store, evil = tmp_path / "run.zarr", "a\x1b]0;gone\x07"
    with pytest.raises(ValueError, match="without control characters"):
        _run(store, scenario=evil)
    assert not store.exists()
    _run(store)
    edit_attributes(store, {"versions": json.dumps({"nonholo": evil})})
    done = CliRunner().invoke(app, ["info", str(store)])
    assert done.exit_code == 2
    assert "without control characters" in done.output
    assert "\x1b]" not in done.output
    edit_attributes(store, {"format": evil, "outcome": evil})
    with pytest.raises(ValueError, match="store of an orbit") as caught:
        nh.load_orbit(store)
    assert "\x1b" not in str(caught.value)


def test_deep_metadata_are_refused(tmp_path: Path) -> None:
    """Nested beyond what a reader follows, at any place: an error of ours."""
    (tmp_path / "deep.zarr").mkdir()
    (tmp_path / "deep.zarr" / "zarr.json").write_text('{"attributes": ' + "[" * 100_000 + "]" * 100_000 + "}")
    assert_refused(tmp_path / "deep.zarr", r"must be a store of an? \w+", nh.load_orbit, nh.load_sweep, nh.resume)


def test_marked_blocks_are_listed_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Many blocks are not asked one by one whether they are there; files of other names do not count."""
    store = tmp_path / "run.zarr"
    with stopped_at(4):
        _run(store)
    folder = store / "run" / "blocks"
    for name in ("98.json", "77.txt", "-5.json", "2.json.partial"):
        shutil.copy(folder / "2.json", folder / name)
    stream, blocks = open_stream(store), []
    listed: Callable[..., list[str]] = os.listdir
    monkeypatch.setattr(os, "listdir", lambda *folders: blocks.append(folders) or listed(*folders))
    assert stream.store.block_numbers() == {*range(4), 98}
    assert stream.finished_blocks() == 4
    assert len(blocks) == 2


def test_a_path_that_exists_is_refused_in_the_words_of_who_asks(tmp_path: Path) -> None:
    """`simulate` has no `overwrite`, so its error does not speak of it."""
    _run(tmp_path / "run.zarr")
    with pytest.raises(FileExistsError, match=r"`simulate\(store=...\)` must be new.*nonholo.resume") as caught:
        _run(tmp_path / "run.zarr")
    assert "overwrite" not in str(caught.value)


@pytest.mark.skipif(not Path("/proc/self/fd").exists(), reason="names of open files are asked of Linux")
def test_metadata_of_a_finished_run_are_on_the_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """When a run is over its attributes and the metadata of all arrays are synced, the folders that name them too."""
    synced, true, name_of = [], os.fsync, "/proc/self/fd/{}".format
    monkeypatch.setattr(os, "fsync", lambda number: synced.append(os.readlink(name_of(number))) or true(number))
    store = tmp_path / "run.zarr"
    _run(store)
    now = set(map(Path, synced))
    assert now >= {*store.rglob("zarr.json"), *(file.parent for file in store.rglob("zarr.json")), tmp_path}
    assert any(path.name.startswith(".zarr.json") for path in now), "a new text is synced before it takes its name"


def test_a_scenario_that_no_file_can_hold_is_refused(tmp_path: Path) -> None:
    """A lone surrogate has no UTF-8."""
    with pytest.raises(ValueError, match="text that files can hold"):
        _run(tmp_path / "run.zarr", scenario="\udcff")


CHOSEN = orbits.stored_variables


def _without_energy(*args: Any) -> Any:
    return {name: variable for name, variable in CHOSEN(*args).items() if name != "energy"}


@pytest.mark.profile("faults", keep=["given"])
@pytest.mark.parametrize("is_passed", [False, True], ids=["restored", "given"])
def test_a_later_column_breaks_no_unfinished_run(
    is_passed: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Begun without a column that is written now, a run is resumed, repaired and extended to the bits of one run."""
    path = tmp_path / "run.zarr"
    monkeypatch.setattr(orbits, "stored_variables", _without_energy)
    with stopped_at(3):
        _run(path)
    monkeypatch.undo()
    (path / "x" / "c" / "1").unlink()
    with pytest.warns(RuntimeWarning, match="chunk c/1 of the array x. Block 1 is computed again"):
        result = nh.resume(path, discrete=SLEIGH if is_passed else None)
    assert result.to_dataset().identical(nh.simulate(SLEIGH, **RUN).to_dataset())
    longer = nh.extend(path, 25)
    assert longer.to_dataset().identical(nh.simulate(SLEIGH, **RUN | {"steps": 85}).to_dataset())
    assert "energy" not in json.loads(json.loads((path / "zarr.json").read_text())["attributes"]["arrays"])
    assert not (path / "energy").exists()


FORMULA, FORGED = "=cmd|' /C calc'!A0", "a\n9,9,9,9"
HOSTILE = ("", FORMULA, FORGED, "a,b", "a b", "../a", "1a", "_a", "größe", "a\x1b[2J", "a" * 101, 1, None)


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The store of a free particle in coordinates, and the result of a sweep."""
    folder = tmp_path_factory.mktemp("names")
    particle = nh.LagrangeDAlembert(lambda _, v: v @ v / 2, None, dimension=3, coordinates=("x", "y", "z"))
    nh.save_orbit(along(particle, np.zeros((2, 3))), folder / "run.zarr")
    nh.sweep(lambda block: {"total": (("side",), block["x"][:, None])}, nh.Grid({"x": [1.0]}), folder / "sweep.zarr")
    assert nh.load_orbit(folder / "run.zarr").coordinates == ("x", "y", "z")
    return folder


def _refused(store: Path, *reads: Callable[[Path], Any]) -> None:
    """Check that every way to read a store refuses it in words, and that no command writes a file or a traceback."""
    assert_refused(store, "name", *reads)
    for command in (["export", "-o", f"{store}.csv"], ["resume"], ["info"]):
        result = CliRunner().invoke(app, [command[0], str(store), *command[1:]])
        assert (result.exit_code, type(result.exception)) in ((1, SystemExit), (2, SystemExit))
        assert "name" in result.output or "saved whole" in result.output
        assert not Path(f"{store}.csv").exists()


@pytest.mark.parametrize(
    "coordinates",
    [["x", "y", FORMULA], ["x", "y", FORGED], ["x"] * 3, ["t", "x", "y"], ["x", "y"], ["x", "energy", "y"], []],
    ids=["formula", "forged row", "thrice", "time", "two", "energy", "none"],
)
def test_coordinates_of_a_strangers_store(coordinates: list[str], kept: Path, tmp_path: Path) -> None:
    """A store of a system in coordinates gives its columns names that the class would take, or is refused."""
    store = shutil.copytree(kept / "run.zarr", tmp_path / "run.zarr")
    parameters = json.loads(read_attributes(store)["parameters"])
    edit_attributes(store, {"parameters": json.dumps(parameters | {"coordinates": coordinates})})
    _refused(store, nh.load_orbit, lambda path: store_to_csv(path, io.StringIO()))


@pytest.mark.parametrize("name", [FORMULA, FORGED, "=1+1", "a b"])
@pytest.mark.parametrize("place", ["axes", "outputs", "dimension"])
def test_names_of_a_strangers_sweep(place: str, name: str, kept: Path, tmp_path: Path) -> None:
    """So do the design, the outputs and the dimensions of a sweep."""
    store = shutil.copytree(kept / "sweep.zarr", tmp_path / "sweep.zarr")
    content = json.loads(read_attributes(store, "nonholo.sweep")["sweep"])
    match place:
        case "axes":
            content["design"]["axes"] = {name: content["design"]["axes"]["x"]}
        case "outputs":
            content["outputs"][name] = content["outputs"].pop("total")
        case _:
            content["outputs"]["total"][0] = [name]
    edit_attributes(store, {"sweep": json.dumps(content)})
    _refused(store, nh.load_sweep, nh.resume)


@pytest.mark.parametrize("name", HOSTILE, ids=ascii)
def test_no_class_takes_such_a_name(name: Any, tmp_path: Path) -> None:
    """Coordinates, shapes, events, designs, results of tasks and their dimensions are called by names alone."""
    assert not is_name(name)
    makers = {
        "coordinates": lambda: nh.LagrangeDAlembert(lambda _, v: v @ v, None, dimension=1, coordinates=(name,)),
        "shape": lambda: nh.ShapedBody(nh.SO(3), (name,), lambda _s, _v, w: w @ w),
        "event": lambda: nh.Event(len, name=name) if name is not None else nh.Event(len, name=0),  # type: ignore[arg-type]
        "grid": lambda: nh.Grid({name: [1.0]}),
        "draw": lambda: nh.RandomDesign(1, {name: nh.Normal()}),
        "output": lambda: nh.sweep(lambda block: {name: block["x"]}, nh.Grid({"x": [1.0]}), tmp_path / "a"),
        "dimension": lambda: nh.sweep(
            lambda block: {"y": ((name,), block["x"][:, None])}, nh.Grid({"x": [1.0]}), tmp_path / "b"
        ),
    }
    for maker in makers.values():
        with pytest.raises(ValueError, match="name"):
            maker()
    assert not list(tmp_path.iterdir())


def test_headers_are_quoted() -> None:
    """A header is written as CSV besides: whatever a column is called, it stays one cell."""
    names = ["t", FORGED, 'a "b", c']
    assert next(csv.reader(io.StringIO("".join(table_lines(names, []))))) == names


REFUSAL = (
    r"must have schema {now}, the one that this version reads\. Got schema {schema}, of before 0\.3\.0, from which on "
    r"later versions read stores\. Read it with the version that wrote it, .*\"nonholo\": \"0\.2\.0\".*, and save "
    r"it as CSV, or repeat the run\."
)


def _sweep(path: Path) -> None:
    task = nh.EnsembleTask(SLEIGH, steps=9, restricted_velocity=(0.3, -1.0))
    nh.sweep(task, nh.Grid({"b": [0.0, 0.3]}), path).close()


DOORS: dict[str, tuple[Any, list[Callable[[Path], Any]]]] = {
    "nonholo.orbit": (_run, [nh.load_orbit, lambda path: nh.extend(path, 3), _export]),
    "nonholo.sweep": (_sweep, [nh.load_sweep, lambda path: sweep_to_csv(path, path.with_suffix(".csv"))]),
}
EARLIER = [(kind, schema) for kind, newest in SCHEMAS.items() for schema in range(1, newest)]


@pytest.mark.profile("faults", keep=["*-1", "*-3"])
@pytest.mark.parametrize(("kind", "schema"), EARLIER)
def test_every_earlier_schema_is_refused(kind: str, schema: int, tmp_path: Path) -> None:
    """Whoever reads, resumes, extends or exports it reads its schema, that of this version, and what to do."""
    path, (make, doors) = tmp_path / "run.zarr", DOORS[kind]
    make(path)
    edit_attributes(path, {"schema": schema, "versions": json.dumps({"nonholo": "0.2.0", "numpy": "2.2.0"})})
    assert_refused(path, REFUSAL.format(now=SCHEMAS[kind], schema=schema), nh.resume, *doors)
    assert list(tmp_path.iterdir()) == [path]
