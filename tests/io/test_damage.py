"""Chunks in the place of others, damaged records, columns of another version, texts that would control a terminal."""

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
from stopping import stopped_at
from typer.testing import CliRunner

import nonholo as nh
from nonholo.cli._app import app
from nonholo.io import orbits, store_to_csv
from nonholo.io.blocks import edit_attributes
from nonholo.io.metadata import check_array
from nonholo.io.orbits import open_stream

SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.1, 0.7, 0.3, 0.1), 0.1)
RUN: dict[str, Any] = {"body_velocity": (0.3, -1.0, 0.0), "steps": 60, "checkpoint_every": 10}
NORTH = nh.Event(lambda states: np.cos(3 * states.heading), name="north")


def _run(store: Path, **more: Any) -> nh.Orbit:
    return nh.simulate(SLEIGH, **RUN, **more, store=store)


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
    for opened in (nh.load_orbit, lambda store: store_to_csv(store, tmp_path / "poses.csv")):
        with pytest.raises(ValueError, match=r"hold|damaged"):
            opened(run)
    unfinished = tmp_path / "unfinished.zarr"
    with stopped_at(6):
        _run(unfinished, events=[NORTH])
    swap(unfinished, one, other)
    if "start" in one:
        with pytest.raises(ValueError, match="start of the run"):
            nh.resume(unfinished, events=[NORTH])
        return
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that it is damaged
        found = nh.resume(unfinished, events=[NORTH])
    assert found.to_dataset().identical(whole.to_dataset())
    assert found.events["north"].step.tolist() == whole.events["north"].step.tolist()


def test_attributes_of_another_store_are_refused(tmp_path: Path) -> None:
    """Those of another run of this length have a checksum, too; the seals tell that they belong to other chunks."""
    own, other = tmp_path / "own.zarr", tmp_path / "other.zarr"
    _run(own)
    nh.simulate(nh.discretize(nh.ChaplyginSleigh(2.0, 0.7, 0.3, 0.1), 0.1), **RUN, store=other)
    shutil.copy(other / "zarr.json", own)
    for opened in (nh.load_orbit, lambda store: store_to_csv(store, tmp_path / "poses.csv")):
        with pytest.raises(ValueError, match="another place or store in block 0"):
            opened(own)
    with pytest.warns(RuntimeWarning, match="another place"), pytest.raises(ValueError, match="start of the run"):
        nh.resume(own)


def test_an_orbit_that_was_saved_whole_is_sealed(tmp_path: Path) -> None:
    """Chunks of two of its arrays that have one shape are not taken for each other."""
    nh.save_orbit(nh.simulate(SLEIGH, body_velocity=(0.3, -1.0, 0.0), steps=20), tmp_path / "orbit.zarr")
    swap(tmp_path / "orbit.zarr", "energy/c/0", "heading/c/0")
    for opened in (nh.load_orbit, lambda store: store_to_csv(store, tmp_path / "poses.csv")):
        with pytest.raises(ValueError, match="each chunk in its place"):
            opened(tmp_path / "orbit.zarr")


def test_a_damaged_mark_exports_no_other_table(tmp_path: Path) -> None:
    """Poses of an unfinished run are those of its finished blocks; which these are is not guessed."""
    store = tmp_path / "run.zarr"
    with stopped_at(4):
        _run(store)
    (store / "run" / "blocks" / "3.json").write_bytes(b"")
    with pytest.raises(ValueError, match="must hold sound blocks"):
        store_to_csv(store, tmp_path / "poses.csv")


def test_a_run_that_failed_before_a_row_is_sealed_too(tmp_path: Path) -> None:
    """A block without rows, and one that an event ended, are as sound as the others."""
    store = tmp_path / "run.zarr"
    stop = nh.Event(lambda states: states.heading - 0.1, stop=1, name="stop")
    found = _run(store, events=[stop])
    assert found.events.stopped_by == "stop"
    assert nh.resume(store, events=[stop]).time.tobytes() == nh.load_orbit(store).time.tobytes() == found.time.tobytes()


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
    """Whoever changes an attribute by hand changes the checksum too, or is noticed: rows, end, number of steps."""
    _run(tmp_path / "run.zarr")
    document = json.loads((tmp_path / "run.zarr" / "zarr.json").read_text())
    told = document["attributes"]
    for name, value in (("save_every", 2), ("outcome", "not_converged"), ("run", told["run"].replace("60", "90"))):
        edited = document | {"attributes": told | {name: value}}
        (tmp_path / "run.zarr" / "zarr.json").write_text(json.dumps(edited))
        for opened in (nh.load_orbit, nh.resume):
            with pytest.raises(ValueError, match="checksum differs"):
                opened(tmp_path / "run.zarr")


@pytest.mark.parametrize(("key", "value"), [("shape", 10**400), ("clevel", 22)], ids=["shape", "level"])
def test_numbers_of_an_array_that_zarr_takes_are_refused(key: str, value: int, tmp_path: Path) -> None:
    """A shape beyond all floats, and a level that the compressor does not have."""
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
    for opened in (nh.load_orbit, nh.load_sweep, nh.resume):
        with pytest.raises(ValueError, match=r"must be a store of an? \w+"):
            opened(tmp_path / "deep.zarr")


def test_marked_blocks_are_listed_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Many blocks are not asked one by one whether they are there; files of other names do not count."""
    store = tmp_path / "run.zarr"
    with stopped_at(4):
        _run(store)
    folder = store / "run" / "blocks"
    for name in ("98.json", "77.txt", "-5.json", "2.json.partial"):
        shutil.copy(folder / "2.json", folder / name)
    stream, seen = open_stream(store), []
    listed: Callable[..., list[str]] = os.listdir
    monkeypatch.setattr(os, "listdir", lambda *folders: seen.append(folders) or listed(*folders))
    assert stream.store.block_numbers() == {*range(4), 98}
    assert stream.finished_blocks() == 4
    assert len(seen) == 2


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


SHORT_RUN: dict[str, Any] = {"body_velocity": (0.3, -1.0, 0.0), "steps": 60}
CHOSEN = orbits.stored_variables


def _without_energy(*args: Any) -> Any:
    return {name: variable for name, variable in CHOSEN(*args).items() if name != "energy"}


@pytest.mark.profile("faults", keep=["given"])
@pytest.mark.parametrize("given", [False, True], ids=["restored", "given"])
def test_a_later_column_breaks_no_unfinished_run(given: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Begun without a column that is written now, a run is resumed, repaired and extended to the bits of one run."""
    path = tmp_path / "run.zarr"
    monkeypatch.setattr(orbits, "stored_variables", _without_energy)
    with stopped_at(3):
        nh.simulate(SLEIGH, **SHORT_RUN, checkpoint_every=10, store=path)
    monkeypatch.undo()
    (path / "x" / "c" / "1").unlink()
    with pytest.warns(RuntimeWarning, match="chunk c/1 of the array x. Block 1 is computed again"):
        found = nh.resume(path, discrete=SLEIGH if given else None)
    assert found.to_dataset().identical(nh.simulate(SLEIGH, **SHORT_RUN).to_dataset())
    longer = nh.extend(path, 25)
    assert longer.to_dataset().identical(nh.simulate(SLEIGH, **SHORT_RUN | {"steps": 85}).to_dataset())
    assert "energy" not in json.loads(json.loads((path / "zarr.json").read_text())["attributes"]["arrays"])
    assert not (path / "energy").exists()
