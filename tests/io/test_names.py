"""What a store may hold: names from anywhere are checked when made and read; schemas before 0.3.0 are refused."""

import csv
import io
import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import nonholo as nh
from nonholo.base.checks import is_name
from nonholo.cli._app import app
from nonholo.ensembles import sweep_to_csv
from nonholo.io import store_to_csv
from nonholo.io.blocks import edit_attributes
from nonholo.io.metadata import read_attributes
from nonholo.io.places import SCHEMAS
from nonholo.io.tables import table_lines
from nonholo.lagrange_dalembert import CoordinateOrbit

FORMULA, FORGED = "=cmd|' /C calc'!A0", "a\n9,9,9,9"
HOSTILE = ("", FORMULA, FORGED, "a,b", "a b", "../a", "1a", "_a", "größe", "a\x1b[2J", "a" * 101, 1, None)


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The store of a free particle in coordinates, and the result of a sweep."""
    folder = tmp_path_factory.mktemp("names")
    particle = nh.LagrangeDAlembert(lambda _, v: v @ v / 2, None, dimension=3, coordinates=("x", "y", "z"))
    rows, one = np.zeros((2, 3)), np.array([0.0, 0.1])
    names = ("configuration", "displacement", "body_velocity", "momentum")
    states = {**dict.fromkeys(names, rows), "multipliers": rows[:1, :0], "energy": one, "constraint_residual": one}
    nh.save_orbit(CoordinateOrbit(time=one, **states, system=particle, time_step=0.1), folder / "run.zarr")
    nh.sweep(lambda block: {"total": (("side",), block["x"][:, None])}, nh.Grid({"x": [1.0]}), folder / "sweep.zarr")
    assert nh.load_orbit(folder / "run.zarr").coordinates == ("x", "y", "z")
    return folder


def _refused(store: Path, *reads: Callable[[Path], Any]) -> None:
    """Check that every way to read a store refuses it in words, and that no command writes a file or a traceback."""
    for read in reads:
        with pytest.raises(ValueError, match="name"):
            read(store)
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


SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.3, 0.7, 0.5, b=0.3), 0.1)
REFUSAL = (
    r"must have schema {now}, the one that this version reads\. Got schema {schema}, of before 0\.3\.0, from which on "
    r"later versions read stores\. Read it with the version that wrote it, .*\"nonholo\": \"0\.2\.0\".*, and save "
    r"it as CSV, or repeat the run\."
)


def _orbit(path: Path) -> None:
    nh.simulate(SLEIGH, restricted_velocity=(0.3, -1.0), steps=9, store=path, checkpoint_every=4)


def _sweep(path: Path) -> None:
    task = nh.EnsembleTask(SLEIGH, steps=9, restricted_velocity=(0.3, -1.0))
    nh.sweep(task, nh.Grid({"b": [0.0, 0.3]}), path).close()


def _save_as_schema(path: Path, schema: int) -> None:
    versions = json.dumps({"nonholo": "0.2.0", "numpy": "2.2.0"})
    edit_attributes(path, {"schema": schema, "versions": versions})


MADE = {"nonholo.orbit": _orbit, "nonholo.sweep": _sweep}
EARLIER = [(MADE[kind], newest, schema) for kind, newest in SCHEMAS.items() for schema in range(1, newest)]
EARLIER_NAMES = [f"{make.__name__[1:]}-{schema}" for make, _, schema in EARLIER]


@pytest.mark.profile("faults", keep=["*-1", "*-3"])
@pytest.mark.parametrize(("make", "now", "schema"), EARLIER, ids=EARLIER_NAMES)
def test_every_earlier_schema_is_refused(make: Callable[[Path], None], now: int, schema: int, tmp_path: Path) -> None:
    """Whoever reads, resumes, extends or exports it reads its schema, that of this version, and what to do."""
    path = tmp_path / "run.zarr"
    make(path)
    _save_as_schema(path, schema)
    poses = tmp_path / "poses.csv"
    of_both: dict[Any, list[Callable[[Path], Any]]] = {
        _orbit: [nh.load_orbit, lambda path: nh.extend(path, 3), lambda path: store_to_csv(path, poses)],
        _sweep: [nh.load_sweep, lambda path: sweep_to_csv(path, poses)],
    }
    for opened in (nh.resume, *of_both[make]):
        with pytest.raises(ValueError, match=REFUSAL.format(now=now, schema=schema)):
            opened(path)
    assert not poses.exists()
