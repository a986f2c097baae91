"""Stores of orbits in coordinates and of constraints that depend on the pose: the bits of one undisturbed run."""

import dataclasses
import functools
import json
from pathlib import Path
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest
import xarray
from refusals import refusals
from stopping import stopped_at
from typer.testing import CliRunner

import nonholo as nh
from nonholo.cli._app import app
from nonholo.examples import Example
from nonholo.io import store_to_csv
from nonholo.io.blocks import edit_attributes
from nonholo.io.provenance import described_system, system_of
from nonholo.lagrange_dalembert import AbstractCoordinateOrbit


@functools.cache
def ready(name: str) -> Example:
    """Return an example with its default parameters."""
    return getattr(nh.examples, name)()


def discrete(name: str = "particle") -> Any:
    """Return its map."""
    return ready(name).discretize(2 * ready(name).time_step)


def own() -> Any:
    """Return the map of the same functions, whose system no store can name."""
    return nh.discretize(dataclasses.replace(ready("particle").system, name="Mine"), 0.1)


def start(name: str = "particle") -> dict[str, Any]:
    """Return its start."""
    return {"configuration": ready(name).configuration, "body_velocity": ready(name).body_velocity}


def same(one: AbstractCoordinateOrbit, other: AbstractCoordinateOrbit) -> bool:
    """Tell whether two orbits have the same bits."""
    rows = [[getattr(orbit, name) for name in orbit.motion.columns] for orbit in (one, other)]
    bits = [[row if row is None else (row.shape, row.tobytes()) for row in each] for each in rows]
    return bits[0] == bits[1] and (one.outcome, one.save_every) == (other.outcome, other.save_every)


@pytest.mark.profile("routes", keep=["20"])
@pytest.mark.parametrize("rows", [1, 20, 21])
def test_blocks_of_any_size_hold_the_run(rows: int, tmp_path: Path) -> None:
    """Also a last block of one state, whose impulse is not known, and is NaN for xarray."""
    path, whole = tmp_path / "run.zarr", nh.simulate(discrete(), **start(), steps=41, save_every=2)
    assert same(
        nh.simulate(discrete(), **start(), steps=41, save_every=2, store=path, checkpoint_every=2 * rows), whole
    )
    with xarray.open_zarr(path, chunks=None) as dataset:
        report = whole.to_dataset().drop_vars(["coordinate", "step"])
        xarray.testing.assert_equal(dataset.load(), report)
        assert dataset.configuration.attrs["components"] == ["x", "y", "z"]
        assert np.isnan(dataset.multipliers.values[:, 0]).tolist() == [False] * 20 + [True]
    nh.save_orbit(whole, tmp_path / "orbit.zarr")
    assert same(nh.load_orbit(tmp_path / "orbit.zarr"), whole)
    whole.to_csv(tmp_path / "orbit.csv")
    store_to_csv(path, tmp_path / "run.csv")
    assert (tmp_path / "run.csv").read_text() == (tmp_path / "orbit.csv").read_text()


def test_the_store_of_a_custom_lagrangian_opens_as_data(tmp_path: Path) -> None:
    """Everything the orbit tells is there; what needs the functions asks for the discretization, which is compared."""
    path, whole = tmp_path / "run.zarr", nh.simulate(own(), **start(), steps=40)
    nh.simulate(own(), **start(), steps=30, store=path, checkpoint_every=8)
    questions = (nh.resume, lambda store: nh.extend(store, 10), lambda store: nh.load_orbit(store).restricted_momentum)
    for question in questions:
        with pytest.raises(ValueError, match=r"`load_orbit\(discrete=\.\.\.\)` must be .* Pass the one that made"):
            question(path)
    for other in (discrete(), nh.discretize(own().system, 0.2), nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)):
        with pytest.raises(ValueError, match="must be the discretization of the store"):
            nh.extend(path, 10, discrete=other)
    assert same(nh.extend(path, 10, discrete=own()), whole)
    opened = nh.load_orbit(path)
    assert same(opened, whole)
    assert (opened.system.name, opened.coordinates, opened.space) == ("Mine", ("x", "y", "z"), ("x", "y", "z"))
    assert nh.invariants(opened) == nh.invariants(whole)
    assert np.array_equal(opened.to_pandas(), whole.to_pandas(), equal_nan=True)
    nh.save_orbit(opened, tmp_path / "again.zarr")
    assert same(nh.load_orbit(tmp_path / "again.zarr", discrete=own()), whole)


@functools.cache
def turning() -> nh.GroupLagrangeDAlembert:
    """Return a custom system on SE(2): a sleigh whose blade turns in the body as it moves along x."""
    action = nh.mass_tensor_lagrangian(nh.SE(2), nh.ChaplyginSleigh(1.0, 0.5, a=0.3).homogeneous_mass_tensor)
    return nh.GroupLagrangeDAlembert(
        nh.SE(2), action, lambda g: jnp.array([[0.0, -jnp.sin(g[0, 2]), jnp.cos(g[0, 2])]])
    )


def test_custom_systems_are_described_by_data() -> None:
    """What a store says of them, as JSON, and what is known of them again."""
    for system in (own().system, turning()):
        kind, parameters = described_system(system)
        again = system_of({"system": kind, "parameters": json.dumps(parameters)}, "load_orbit(path=...)", "")
        assert nh.discretize(again, 0.1).columns == nh.discretize(system, 0.1).columns
        for name in ("name", "coordinates", "shapes", "constraints", "is_driven", "orbits"):
            assert getattr(again, name) == getattr(system, name)


@pytest.mark.profile("routes", instead="test_custom_systems_are_described_by_data")
def test_a_custom_system_on_a_group_opens_as_data(tmp_path: Path) -> None:
    """Its headings count full turns across blocks, as those of the orbit do."""
    run, path = {"body_velocity": (2.5, 1.0, 0.0), "steps": 40}, tmp_path / "run.zarr"
    whole, moved = nh.simulate(nh.discretize(turning(), 0.3), **run), nh.discretize(turning(), 0.3)
    with stopped_at(4):
        nh.simulate(moved, **run, store=path, checkpoint_every=3)
    assert same(nh.resume(path, discrete=moved), whole)
    opened = nh.load_orbit(path)
    assert same(opened, whole)
    assert opened.space == nh.SE(2)
    whole.to_csv(tmp_path / "orbit.csv")
    store_to_csv(path, tmp_path / "run.csv")
    assert (tmp_path / "run.csv").read_text() == (tmp_path / "orbit.csv").read_text()
    assert np.genfromtxt(tmp_path / "run.csv", delimiter=",", names=True)["theta"][-1] > 2 * np.pi


@pytest.mark.profile("routes", instead="test_the_store_of_a_custom_lagrangian_opens_as_data")
@pytest.mark.parametrize(("every", "block"), [(1, 1), (1, 8), (5, 5), (5, 40)])
def test_other_functions_are_refused(every: int, block: int, tmp_path: Path) -> None:
    """The last saved step must come out with its bits: a mass that is larger by 1e-13, or another form, does not."""

    def mine(mass: float = 1.0, slope: float = 1.0) -> Any:
        system = nh.LagrangeDAlembert(
            lambda _, v: mass * (v @ v) / 2, lambda q: jnp.array([[-slope * q[1], 0.0, 1.0]]), dimension=3
        )
        return nh.discretize(system, 0.1)

    path = tmp_path / "run.zarr"
    nh.simulate(mine(), **start(), steps=33, save_every=every, store=path, checkpoint_every=block)
    for other in (mine(mass=1.0 + 1e-13), mine(slope=1.0 + 1e-12)):
        with pytest.raises(ValueError, match=r"`extend\(discrete=\.\.\.\)` must have the functions of the store"):
            nh.extend(path, 7, discrete=other)
    assert same(nh.extend(path, 7, discrete=mine()), nh.simulate(mine(), **start(), steps=40, save_every=every))


def test_the_store_of_a_stranger_runs_nothing(tmp_path: Path) -> None:
    """Names that are none of ready systems, and parameters that these refuse, are refused; so are other columns."""
    path = tmp_path / "orbit.zarr"
    nh.save_orbit(nh.simulate(discrete(), **start(), steps=4), path)
    stored = json.loads((path / "zarr.json").read_text())["attributes"]
    ball = {"system": "examples.chaplygin_ball", "parameters": "{}"}
    for edited, match in (
        ({"system": "examples.Example", "parameters": "{}"}, "hold a ready system of this version. Got 'Example'"),
        ({"system": "examples.os"}, "hold a ready system of this version. Got 'os'"),
        ({"parameters": '{"mass": -1.0}'}, r"`examples.particle\(mass=...\)` must be"),
        ({"parameters": '{"weight": 1.0}'}, "hold parameters of nonholo.examples.particle. Got .*weight"),
        (ball, "hold a run by a route of this version"),
        (ball | {"motion": '{"kind": "GroupDiscretization", "time_step": 0.1}'}, "hold the columns of"),
        ({"motion": '{"kind": "CoordinateFlow"}'}, "hold the columns of"),
        ({"system": "LagrangeDAlembert"}, "hold a system of this version"),
        ({"parameters": '{"orbits": "CoordinateOrbit", "force": "callable"}'}, "describe its system. Got name"),
    ):
        edit_attributes(path, edited)
        with pytest.raises(ValueError, match=match):
            nh.load_orbit(path)
        edit_attributes(path, {name: stored[name] for name in edited})
    assert len(nh.load_orbit(path)) == 5


def test_what_is_changed_is_no_ready_system_any_more() -> None:
    """A potential, a replaced field: such a system is its own; numbers of the body alone tell it from others."""
    system = ready("particle").system
    assert system.description == ("examples.particle", {"mass": 1.0})
    assert nh.examples.particle(mass=1, planar_velocity=(2.0, 3.0)).system is system
    assert nh.Forced(system, lambda q: q[2]).description is None
    assert dataclasses.replace(system, rule="trapezoidal").description is None
    assert nh.examples.chaotic_quartic_oscillator(pairs=1).system.description[1] == {"pairs": 1, "coupling": 1.0}


# As those of bodies: what only a store keeps, blocks that are no multiple, more than a disk holds.
test_arguments_of_stores_are_refused = refusals(
    ({"store": None, "scenario": "mine"}, r"`simulate\(scenario=\.\.\.\)` must come with a store"),
    (
        {"save_every": 2, "checkpoint_every": 3},
        r"`simulate\(checkpoint_every=\.\.\.\)` must be a multiple of save_every",
    ),
    ({"steps": 10**14}, "must fit on the disk"),
    ask=lambda how: nh.simulate(discrete(), **start(), **{"steps": 4, "store": "a.zarr"} | how),
)


def test_commands_show_extend_and_write_stores(tmp_path: Path) -> None:
    """`info`, `plot`, `export`, `resume`, `extend`; of custom functions the last two say what to do."""
    for name, motion in (("ready", discrete()), ("own", own())):
        nh.simulate(motion, **start(), steps=9, store=tmp_path / f"{name}.zarr", checkpoint_every=4)

    def answer(command: str, store: str, *options: str) -> str:
        return CliRunner().invoke(app, [command, str(tmp_path / store), *options]).output

    assert json.loads(answer("info", "ready.zarr", "--json"))["body"]["mass"] == 1.0
    assert "x, y, z" in answer("info", "own.zarr")
    assert answer("export", "own.zarr", "--every", "9").splitlines()[:2] == ["t,x,y,z", "0.0,0.0,0.0,0.0"]
    assert (tmp_path / "own.png").name in answer("plot", "own.zarr", "--dpi", "20")
    assert (tmp_path / "own.png").exists()
    assert "successful" in answer("resume", "ready.zarr")
    assert json.loads(answer("extend", "ready.zarr", "--steps", "3", "--json"))["states"] == 13
    assert "stores hold no functions" in answer("extend", "own.zarr", "--steps", "3")
