"""Poses as CSV: every number is read back exactly, rows continue from one another, and a file is whole or not there."""

import functools
import io
import json
import os
import tracemalloc
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from damage import damage
from groups.examples import HEISENBERG
from refusals import assert_refused, refusals
from stopping import stopped_at

import nonholo as nh
from nonholo.io import store_to_csv
from nonholo.io.blocks import edit_attributes
from nonholo.io.metadata import read_attributes
from nonholo.io.places import write_lock

SPINNING = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.0, 0.3), 0.1)  # turns forever
TOP = nh.SuslovTop(np.diag([1.0, 2.0, 3.0]))
SPIN: dict[str, Any] = {"restricted_velocity": (3.0, 0.5)}


def _read(text: str) -> tuple[list[str], np.ndarray]:
    """Return the names and the rows, each number as Python reads it."""
    header, *lines = text.splitlines()
    return header.split(","), np.array([[float(cell) for cell in line.split(",")] for line in lines])


def _written(orbit: nh.Orbit, tmp_path: Path) -> str:
    orbit.to_csv(tmp_path / "poses.csv", overwrite=True)
    return (tmp_path / "poses.csv").read_text()


def _of_store(store: Path, **options: Any) -> str:
    target = io.StringIO()
    store_to_csv(store, target, **options)
    return target.getvalue()


@pytest.fixture
def store(tmp_path: Path) -> Path:
    """A spinning sleigh of 101 states in chunks of 8, which turns through five circles."""
    nh.simulate(SPINNING, steps=100, store=tmp_path / "run.zarr", checkpoint_every=8, **SPIN)
    return tmp_path / "run.zarr"


@pytest.mark.parametrize(
    ("group", "position", "size"),
    [
        (nh.SO(2), 0, 2),
        (nh.SO(4), 0, 4),
        (nh.SE(4), 4, 4),
        (nh.Translations(3), 3, 0),
        (HEISENBERG, 0, 3),
        (nh.ProductGroup(nh.SE(2), nh.Translations(1)), 0, 5),
    ],
    ids=repr,
)
def test_other_groups_have_the_entries_of_the_matrix(group: Any, position: int, size: int, tmp_path: Path) -> None:
    """Numbered positions, then the matrix row by row, with the bits of the orbit."""
    unit = np.eye(group.dim)
    motion = nh.discretize(nh.LLSystem(group, None, unit, inertia_operator=unit), 0.1)
    g = np.stack([group.exp(t * np.cos(np.arange(group.dim))) for t in (0.0, 0.3, 0.7)])
    nothing = np.zeros((3, group.dim))
    orbit = nh.Orbit(motion, np.arange(3.0), nothing, nothing, group.pose_from_matrix(g))
    names, rows = _read(_written(orbit, tmp_path))
    entries = [f"r{i}{j}" for i in range(1, size + 1) for j in range(1, size + 1)]
    assert names == ["t", *(f"x{i}" for i in range(1, position + 1)), *entries]
    result = orbit.configuration
    assert np.array_equal(rows[:, 1 : 1 + position], result[:, :position, -1])
    assert np.array_equal(rows[:, 1 + position :], result[:, :size, :size].reshape(3, -1))


def test_entries_from_ten_rows_on_are_told_apart(tmp_path: Path) -> None:
    """Column names are unique where an index has two digits."""
    group = nh.SO(11)
    none = np.zeros((1, 10))
    top = nh.discretize(nh.SuslovTop(np.diag(np.arange(1.0, 12.0))), 0.1)
    orbit = nh.Orbit(top, np.zeros(1), none, none, group.pose_from_matrix(group.identity[None]))
    names, rows = _read(_written(orbit, tmp_path))
    assert names[1] == "r1_1"
    assert len(set(names)) == rows.shape[1] == 122


@pytest.mark.parametrize(
    ("discrete", "how"),
    [
        (SPINNING, {**SPIN, "steps": 100, "checkpoint_every": 8}),
        (SPINNING, {**SPIN, "steps": 100, "save_every": 10, "checkpoint_every": 10}),
        (nh.discretize(TOP, 0.5), {"restricted_velocity": (0.9, 0.4), "steps": 40, "checkpoint_every": 1}),
    ],
    ids=["headings", "nearly half a turn", "quaternions"],
)
def test_store_in_chunks_gives_the_text_of_the_orbit(discrete: Any, how: dict[str, Any], tmp_path: Path) -> None:
    """Headings and signs continue over the borders of chunks; of nearly half a turn the shorter one is taken."""
    nh.simulate(discrete, store=tmp_path / "run.zarr", **how)
    orbit = nh.simulate(discrete, **{name: value for name, value in how.items() if name != "checkpoint_every"})
    assert "save_every" not in how or 2.9 < abs(orbit.heading[1] - orbit.heading[0]) < np.pi
    assert _of_store(tmp_path / "run.zarr") == _written(orbit, tmp_path)


@pytest.mark.profile("faults", keep=["13"])
@pytest.mark.parametrize("every", [3, 8, 13, 200])
def test_thinned_rows_are_rows_of_the_whole(every: int, store: Path) -> None:
    """`every` keeps states 0, N, 2 N, ...; headings still count every turn between them."""
    header, *lines = _of_store(store).splitlines()
    assert _of_store(store, every=every).splitlines() == [header, *lines[::every]]


def test_flow_keeps_the_heading_it_knows(tmp_path: Path) -> None:
    """Of a flow saved at few times headings are those of the solver, which counts full turns between them."""
    system = nh.ChaplyginSleigh(1.0, 1.0, 0.0)
    orbit = nh.flow(system, body_velocity=(2.0, 0.3, 0.0), times=[0.0, 5.0, 10.0])
    nh.save_orbit(orbit, tmp_path / "run.zarr")
    rows = _read(_of_store(tmp_path / "run.zarr"))[1]
    assert np.array_equal(rows[:, 3], orbit.heading)
    assert rows[:, 3] == pytest.approx([0.0, 10.0, 20.0], abs=1e-8)  # tolerance of the solver


def test_callable_difference_is_no_obstacle(tmp_path: Path) -> None:
    """The poses of a store need its body, not a function that the store could not keep."""
    system, h = nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1
    orbit = nh.simulate(nh.discretize(system, h), body_velocity=(1.0, 0.3, 0.0), steps=5)
    nh.save_orbit(orbit, tmp_path / "run.zarr")
    motion = json.loads(read_attributes(tmp_path / "run.zarr")["motion"]) | {"difference": "callable"}
    edit_attributes(tmp_path / "run.zarr", {"motion": json.dumps(motion)})
    assert_refused(tmp_path / "run.zarr", "difference is a callable", nh.load_orbit)
    assert _of_store(tmp_path / "run.zarr") == _written(orbit, tmp_path)


@pytest.mark.parametrize("block", [0, 1, 5])
def test_unfinished_store_gives_its_finished_blocks(block: int, tmp_path: Path) -> None:
    """What a stopped run finished is exported, and a warning says how far it goes and how to resume."""
    path, arguments = tmp_path / "run.zarr", {"save_every": 2, **SPIN}
    with stopped_at(block):
        nh.simulate(SPINNING, steps=99, store=path, checkpoint_every=16, **arguments)
    last = max(0, 16 * block - 2)
    with pytest.warns(RuntimeWarning, match=rf"up to step {last} of 99\. Resume with nonholo\.resume\('.*run\.zarr'\)"):
        text = _of_store(path)
    whole = _written(nh.simulate(SPINNING, steps=99, **arguments), tmp_path)
    assert text == "".join(whole.splitlines(keepends=True)[: 1 + 8 * block])


def test_run_that_is_being_written_is_exported(tmp_path: Path) -> None:
    """While a process writes a store its finished blocks are there for others, and the warning names the writer."""
    path = tmp_path / "run.zarr"
    with stopped_at(2):
        nh.simulate(SPINNING, steps=99, store=path, checkpoint_every=16, **SPIN)
    with (
        write_lock(path),
        pytest.warns(RuntimeWarning, match=rf"step 31 of 99\. It is being written by process {os.getpid()}"),
    ):
        assert len(_of_store(path).splitlines()) == 33


def test_extended_store_gives_its_full_blocks(store: Path, tmp_path: Path) -> None:
    """A last block that was not full is written anew when a run is extended, and left out until then."""
    with stopped_at(12):
        nh.extend(store, 50)
    with pytest.warns(RuntimeWarning, match="up to step 95 of 150"):
        text = _of_store(store)
    assert text == _written(nh.simulate(SPINNING, steps=95, **SPIN), tmp_path)


def test_empty_orbit_has_a_header(tmp_path: Path) -> None:
    """An orbit without states gives the names alone, from memory and from a store."""
    orbit = nh.simulate(SPINNING, steps=3, **SPIN)[:0]
    nh.save_orbit(orbit, tmp_path / "run.zarr")
    assert _written(orbit, tmp_path) == _of_store(tmp_path / "run.zarr") == "t,x,y,theta\n"


def test_memory_does_not_grow_with_the_length(tmp_path: Path) -> None:
    """Four times as many states need no more memory than one chunk and its text.

    The longer orbit has 8e4 states, 3 MB in its arrays and 7 MB as text; one chunk and a piece of 16384 states need
    3.7 MB, and a reading thread that is slow to let go sometimes 0.6 MB more.
    """
    peaks = []
    for steps in (20_000, 80_000):
        path = tmp_path / f"{steps}.zarr"
        nh.simulate(SPINNING, steps=steps, store=path, checkpoint_every=10_000, **SPIN)
        store_to_csv(path, tmp_path / "warm.csv", overwrite=True, every=1000)
        tracemalloc.start()
        store_to_csv(path, tmp_path / f"{steps}.csv")
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < 1.4 * peaks[0]


@pytest.mark.profile("faults", keep=["time"])
@pytest.mark.parametrize("name", ["time", "canonical/pose"])
def test_damaged_chunk_is_refused_by_name(name: str, store: Path, tmp_path: Path) -> None:
    """A changed byte late in the store is named before anything is written, to a file or to a stream."""
    damage(next(path for path in (store / name / "c").rglob("*") if path.is_file() and "11" in path.parts), "flipped")
    stream = io.StringIO()
    for target in (tmp_path / "poses.csv", stream):
        assert_refused(target, f"chunk c/11.* of the array {name}", functools.partial(store_to_csv, store))
    assert stream.getvalue() == ""
    assert list(tmp_path.iterdir()) == [store]


def test_no_poses_are_refused(tmp_path: Path) -> None:
    """An orbit without poses, in memory or in a store, is refused with the remedy, and nothing is written."""
    orbit = nh.simulate(SPINNING, steps=5, reconstruct=False, **SPIN)
    words = r"with poses\. Got reconstruct=False\. Run with reconstruct=True"
    assert_refused(tmp_path / "poses.csv", words, orbit.to_csv)
    nh.save_orbit(orbit, tmp_path / "run.zarr")
    assert_refused(tmp_path / "run.zarr", r"hold poses.*Run it again with reconstruct=True", _of_store)
    assert [path.name for path in tmp_path.iterdir()] == ["run.zarr"]


def test_existing_file_is_refused_unless_asked(store: Path, tmp_path: Path) -> None:
    """An older file stays as it is; `overwrite` replaces it, but only a file."""
    target = tmp_path / "poses.csv"
    target.write_text("older")
    doors, words = (nh.load_orbit(store).to_csv, functools.partial(store_to_csv, store)), "or pass overwrite"
    assert_refused(target, rf"which exists\. Choose another path, {words}", *doors, kind=FileExistsError)
    assert target.read_text() == "older"
    store_to_csv(store, target, overwrite=True)
    assert target.read_text() == _of_store(store)
    assert sorted(tmp_path.iterdir()) == [target, store]
    with pytest.raises(FileExistsError, match="not a file"):
        store_to_csv(store, store, overwrite=True)
    assert len(nh.load_orbit(store)) == 101


def test_other_stores_are_refused(tmp_path: Path) -> None:
    """A saved ensemble is no store of an orbit, and is called what it is."""
    batch = nh.ensemble(SPINNING, restricted_velocity=[[1.0, 0.5], [2.0, 0.5]], steps=3, save_every=1)
    batch.to_dataset().to_zarr(tmp_path / "members.zarr", consolidated=False)
    assert_refused(tmp_path / "members.zarr", r"members\.zarr', a store of an ensemble", _of_store)
    assert _written(batch.orbit(1), tmp_path).startswith("t,x,y,theta\n")


# What is not an orbit, and a number of states that counts nothing, end before any work.
test_wrong_arguments_are_refused = refusals(
    (lambda: nh.Orbit.to_csv(np.zeros(3), Path("poses.csv")), "must be an orbit\\. Got array"),  # type: ignore[arg-type]
    (lambda: store_to_csv(Path("run.zarr"), Path("poses.csv"), every=0), r"`store_to_csv\(every=\.\.\.\)`"),
)
