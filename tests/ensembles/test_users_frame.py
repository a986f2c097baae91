"""Whatever a user reads of a motion, from any door, is in the user's body frame, in which runs are not computed."""

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray

import nonholo as nh
from nonholo.ensembles import sweep_to_csv
from nonholo.io import orbit_to_csv, store_to_csv
from nonholo.systems import AbstractSystem

_INERTIA = np.diag([3.0, 2.0, 1.5]) + 0.1
SYSTEMS: dict[str, AbstractSystem] = {
    "about e2": nh.SuslovTop.from_inertia(np.diag([3, 2, 1.5]), axis=(0, 1, 0)),
    "about -e3": nh.SuslovTop.from_inertia(_INERTIA, axis=(0, 0, -1)),
    "about -e1": nh.SuslovTop.from_inertia(_INERTIA, axis=(-1, 0, 0)),
    "askew": nh.SuslovTop.from_inertia(_INERTIA, axis=(0.48, -0.6, 0.64)),
    "about e3": nh.SuslovTop.from_inertia(_INERTIA),
    "sleigh": nh.ChaplyginSleigh(1.3, 0.7, 0.5, b=0.3),
    "sleigh on its line": nh.ChaplyginSleigh(1.3, 0.7, 0.5),
    "sleigh in space": nh.MultidimensionalSleigh(1.2, [0.4, 0.2, -0.3], np.diag([1.0, 0.7, 0.5]) + 0.05),
    "top of SO(4)": nh.SuslovTop(np.diag([1.0, 2.0, 3.0, 4.0]) + 0.1),
    "Veselova": nh.VeselovaTop(np.diag([1.0, 2.0, 3.0]) + 0.1),
}


def _start(system: AbstractSystem) -> dict[str, Any]:
    return {"restricted_velocity": 0.9 * np.cos(1.0 + np.arange(system.rank)), "steps": 40}


def _orbit(name: str, **options: Any) -> nh.Orbit:
    """Return a run that starts in a pose without symmetry and turns through more than half a turn."""
    g = SYSTEMS[name].group.random(np.random.default_rng(4))
    return nh.simulate(nh.discretize(SYSTEMS[name], 0.1), configuration=g, **_start(SYSTEMS[name]) | options)


def _matrices(result: Any, group: Any) -> np.ndarray:
    """Return the matrices of the poses that a dataset tells under names that people know."""
    n = group.size - int(str(group).startswith("SE"))
    g = np.broadcast_to(group.identity, (*np.shape(result["energy"]), group.size, group.size)).copy()
    if "heading" in result:
        c, s = np.cos(result["heading"]), np.sin(result["heading"])
        g[..., 0, 0], g[..., 0, 1], g[..., 1, 0], g[..., 1, 1] = c, -s, s, c
    elif "quaternion" in result:
        g[..., :3, :3] = nh.SO(3).matrix_from_pose(np.asarray(result["quaternion"]))
    else:
        g[..., :n, :n] = result["rotation"]
    for axis, name in enumerate("xyz"):
        if name in result:
            g[..., axis, n] = result[name]
    return g


def _close(one: Any, other: Any) -> bool:
    return np.abs(np.asarray(one) - np.asarray(other)).max() < 1e-13  # numbers of order one; a product of matrices


@pytest.mark.parametrize("name", SYSTEMS)
def test_orbits_and_their_datasets(name: str) -> None:
    """`pose` and the named variables are those of `configuration`, which begins where the user said."""
    orbit = _orbit(name)
    group, result = orbit.system.group, orbit.to_dataset()
    assert _close(orbit.configuration[0], group.random(np.random.default_rng(4)))
    assert _close(group.matrix_from_pose(orbit.pose), orbit.configuration)
    assert _close(_matrices(result, group), orbit.configuration)
    for quantity in ("body_velocity", "momentum", "restricted_momentum", "energy"):
        assert np.array_equal(result[quantity], getattr(orbit, quantity)), quantity
    if "quaternion" in result:
        assert (np.diff(result["quaternion"], axis=0) ** 2).sum(axis=1).max() < 0.1, "signs have to continue"


@pytest.mark.profile("routes", keep=["sleigh", "askew"])
@pytest.mark.parametrize("name", ["about e2", "about -e3", "askew", "sleigh", "sleigh in space", "Veselova"])
def test_stores_as_xarray_opens_them(name: str, tmp_path: Path) -> None:
    """A store has the variables of the dataset bit for bit, saved whole or block by block, and no canonical ones."""
    orbit = _orbit(name)
    nh.save_orbit(orbit, tmp_path / "whole.zarr")
    _orbit(name, store=tmp_path / "run.zarr", checkpoint_every=7)
    for path in ("whole.zarr", "run.zarr"):
        with xarray.open_zarr(tmp_path / path, chunks=None) as result:
            report = orbit.to_dataset().drop_vars(["body_velocity", "momentum", "step"])
            xarray.testing.assert_identical(result.load().drop_attrs(), report.drop_attrs())
    again = nh.load_orbit(tmp_path / "run.zarr")
    assert np.array_equal(again.canonical_pose, orbit.canonical_pose)
    assert _close(again.pose, orbit.pose)


def _ensemble(name: str, **options: Any) -> nh.Ensemble:
    velocity = _start(SYSTEMS[name])["restricted_velocity"]
    rows = velocity * np.array([1.0, 0.5, -0.8])[:, None]
    return nh.ensemble(nh.discretize(SYSTEMS[name], 0.1), restricted_velocity=rows, steps=12, **options)


@pytest.mark.parametrize("name", ["about e2", "about -e3", "askew", "sleigh", "sleigh in space", "Veselova"])
def test_ensembles(name: str) -> None:
    """Poses and datasets of ensembles are those of their orbits."""
    batch, group = _ensemble(name, save_every=4), SYSTEMS[name].group
    assert _close(group.matrix_from_pose(batch.pose), batch.configuration)
    assert _close(_matrices(batch.to_dataset(), group), batch.configuration)
    assert _close(batch.orbit(1).configuration, batch.configuration[1])


@pytest.mark.parametrize("order", [2, 4])
def test_ensembles_of_bodies_with_frames_of_their_own(order: int) -> None:
    """Where b differs from member to member each pose is in the frame of its own body."""
    discrete = nh.discretize(nh.ChaplyginSleigh(1.3, 0.7, 0.5), 0.1, order=order)
    arguments = {"parameters": {"b": [0.0, 0.3, -0.2]}, "restricted_velocity": (0.9, -0.4), "steps": 20}
    batch = nh.ensemble(discrete, save_every=5, **arguments)
    for member in range(3):
        assert _close(batch.pose[member], batch.orbit(member).pose)
        assert _close(batch.orbit(member).configuration[0], np.eye(3))


@pytest.mark.parametrize(
    ("name", "axes"),
    [("about e2", {"time_step": [0.1, 0.2]}), ("about -e3", {"time_step": [0.1, 0.2]}), ("sleigh", {"b": [0.0, 0.3]})],
)
def test_last_poses_of_sweeps(name: str, axes: dict[str, Any], tmp_path: Path) -> None:
    """The last poses of a sweep, and their CSV, are those of runs one by one."""
    system, arguments = SYSTEMS[name], _start(SYSTEMS[name])
    task = nh.EnsembleTask(nh.discretize(system, 0.1), **arguments)
    ((parameter, values),) = axes.items()
    stream = io.StringIO()
    with nh.sweep(task, nh.Grid(axes), tmp_path / "s.zarr") as result:
        poses = result["final_pose"].values
    sweep_to_csv(tmp_path / "s.zarr", stream)
    rows = np.array([line.split(",") for line in stream.getvalue().splitlines()[1:]], dtype=float)
    for member, value in enumerate(values):
        step = value if parameter == "time_step" else 0.1
        body = nh.ChaplyginSleigh(1.3, 0.7, 0.5, b=value) if parameter == "b" else system
        g = nh.simulate(nh.discretize(body, step), **arguments).configuration[-1]
        assert _close(system.group.matrix_from_pose(poses[member]), g)
        report = {"heading": rows[member, -1], "x": rows[member, -3], "y": rows[member, -2]}
        report = report if parameter == "b" else {"quaternion": rows[member, -4:]}
        assert _close(_matrices({**report, "energy": 0.0}, system.group), g)


@pytest.mark.profile("routes", keep=["sleigh", "askew", "sleigh in space"])
@pytest.mark.parametrize("name", ["about e2", "about -e3", "askew", "sleigh", "sleigh in space"])
def test_tables(name: str, tmp_path: Path) -> None:
    """CSV from an orbit and from a store has the numbers of the dataset."""
    orbit, stream = _orbit(name, store=tmp_path / "run.zarr", checkpoint_every=7), io.StringIO()
    orbit_to_csv(orbit, tmp_path / "o.csv")
    store_to_csv(tmp_path / "run.zarr", stream)
    assert stream.getvalue() == (tmp_path / "o.csv").read_text()
    result = orbit.to_dataset()
    names = [reference for reference in ("x", "y", "z", "heading", "quaternion") if reference in result]
    report = np.column_stack([result["time"], *(result[reference] for reference in names)])
    rows = np.array([line.split(",") for line in stream.getvalue().splitlines()[1:]], dtype=float)
    assert np.array_equal(rows, report)


def test_products_have_their_factors_by_name() -> None:
    """Poses on a product are named by its factors: the plane motion by x, y and heading, what slides as shape."""
    group = nh.ProductGroup(nh.SE(2), nh.Translations(2), nh.SO(3))
    system = nh.LLSystem(group, constraint_subspace=np.eye(8)[:3], inertia_operator=np.eye(8))
    rng = np.random.default_rng(0)
    g = np.stack([group.random(rng) for _ in range(5)])
    motion = nh.flow(system, restricted_velocity=(0.1, 0.2, 0.0), times=[0.0, 1.0]).motion
    result = nh.Orbit(motion, np.arange(5.0), np.ones((5, 3)), None, group.pose_from_matrix(g)).to_dataset()
    assert {"x", "y", "heading", "shape", "quaternion"} <= set(result.variables)
    assert _close(np.column_stack([result["x"], result["y"]]), g[:, :2, 2])
    assert _close(np.cos(result["heading"]), g[:, 0, 0])
    assert _close(result["shape"], g[:, 3:5, 5])
    assert _close(nh.SO(3).matrix_from_pose(result["quaternion"].values), g[:, 6:, 6:])
