"""Orbits of every system, on every kind of group, come back from a store as they were."""

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray
from bodies import tensor
from groups.examples import HEISENBERG
from problems import EVERY
from refusals import assert_refused

import nonholo as nh
from nonholo.groups import AbstractMatrixGroup
from nonholo.io import orbit_to_dataset
from nonholo.io.metadata import read_attributes
from nonholo.io.provenance import describe_group, restore_group
from nonholo.lagrange_dalembert import GroupLagrangeDAlembert
from nonholo.systems import SYSTEMS

_PRODUCT = nh.ProductGroup(nh.SO(3), nh.ProductGroup(nh.SE(2), nh.Translations(2)), HEISENBERG)
_LORENTZ = nh.MatrixGroup(np.diag([1, 1, -1]) @ nh.SO(3).basis, form=np.diag([1, 1, -1]))
_RNG = np.random.default_rng(3)


MADE_UP: dict[str, Callable[[], Any]] = {  # JAX would have to compile their steps
    "inertia operator": lambda: nh.LLSystem(nh.SO(3), annihilator=[[0.0, 0, 1]], inertia_operator=tensor(3, _RNG)),
    "user group": lambda: EVERY["Heisenberg"],
    "product": lambda: nh.LLSystem(_PRODUCT, constraint_subspace=np.eye(11)[::2], inertia_operator=tensor(11, _RNG)),
    "logarithmic top of SO(4)": lambda: nh.discretize(nh.SuslovTop(tensor(4, _RNG)), 0.1, "logarithmic", "exponential"),
}
MOTIONS: dict[str, Callable[[], Any]] = {  # systems, or discretizations that are not the usual ones
    "arrowhead top": lambda: nh.SuslovTop.arrowhead(_RNG.uniform(1, 2, 4), 0.1 * _RNG.normal(size=3)),
    "arrowhead sleigh": lambda: nh.MultidimensionalSleigh.arrowhead(
        1.5, [0.3, 0.1, 0.2], _RNG.uniform(1, 2, 3), 0.1 * _RNG.normal(size=2)
    ),
    "body of SO(2, 1)": lambda: nh.LLSystem(_LORENTZ, np.diag([1.0, 2.0, -4.0]), [[0, 1, 0], [1, 0, 0]]),
    "one direction": lambda: nh.LLSystem(nh.SO(3), tensor(3, _RNG), [[1.0, 0.0, 0.0]]),
    "naive sleigh": lambda: nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1, constraint="naive"),
    **{name: lambda system=system: system for name, system in EVERY.items() if name not in ("Heisenberg", "product")},
}
COLUMNS = ("time", "reduced_momentum", "cayley", "canonical_pose", "energy", "displacement")


def _motion(things: Any) -> nh.Discretization:
    return things if isinstance(things, nh.Discretization) else nh.discretize(things, 0.1)


def _run(things: Any, **options: Any) -> nh.Orbit:
    motion = _motion(things)
    k = len(motion.system.constraint_subspace)
    return nh.simulate(motion, restricted_velocity=0.3 * np.cos(np.arange(k)), steps=6, **options)


def _made_up(motion: nh.Discretization) -> nh.Orbit:
    """Return an orbit of random numbers."""
    group, k = motion.system.group, len(motion.system.constraint_subspace)
    pose = group.pose_from_matrix(np.stack([group.random(_RNG) for _ in range(6)]))
    return nh.Orbit(motion, np.arange(6.0), _RNG.normal(size=(6, k)), _RNG.normal(size=(6, k)), pose)


_BRIEF = ["nothing moves", "sleigh 3", "right-invariant on SE(3)", "offset sleigh", "free on SO(4)", "veselova 3"]


@pytest.mark.profile("routes", keep=[*_BRIEF, "any d on SE(3)", *MADE_UP])
@pytest.mark.parametrize("kind", [*MOTIONS, *MADE_UP])
def test_round_trip(kind: str, tmp_path: Path) -> None:
    """Compact arrays, fields of the system and everything decoded from them have the bits of the saved orbit."""
    orbit = _made_up(_motion(MADE_UP[kind]())) if kind in MADE_UP else _run(MOTIONS[kind]())
    nh.save_orbit(orbit, tmp_path / "o.zarr")
    loaded = nh.load_orbit(tmp_path / "o.zarr")
    for field in dataclasses.fields(orbit.system):
        assert np.array_equal(getattr(loaded.system, field.name), getattr(orbit.system, field.name)), field.name
    assert (loaded.motion.difference, loaded.motion.constraint) == (orbit.motion.difference, orbit.motion.constraint)
    for name in (*COLUMNS, "configuration", *(() if kind in MADE_UP else ("multipliers", "momentum"))):
        one, two = getattr(orbit, name), getattr(loaded, name)
        assert one.shape == two.shape, name
        assert one.tobytes() == two.tobytes(), name


def test_every_system_is_tried() -> None:
    """No final system is missing from the round trips."""
    assert {type(_motion(make()).system) for make in MOTIONS.values()} == set(SYSTEMS)


@pytest.mark.parametrize(
    "group",
    [nh.SO(2), nh.SO(3), nh.SO(6), nh.SE(2), nh.SE(4), nh.Translations(1), HEISENBERG, _LORENTZ, _PRODUCT],
    ids=repr,
)
def test_groups_come_back(group: AbstractMatrixGroup) -> None:
    """The group of a description is equal to the described one, nested products included."""
    assert restore_group(describe_group(group)) == group


def test_charts_have_their_own_dimension(tmp_path: Path) -> None:
    """Where the chart has more coordinates than the subspace the store is still labeled without contradiction."""
    nh.save_orbit(_run(EVERY["any d on SE(3)"]), tmp_path / "o.zarr")
    with xarray.open_zarr(tmp_path / "o.zarr", group="canonical", chunks=None) as compact:
        sizes = compact.sizes
    assert (sizes["component"], sizes["chart"], sizes["pose_component"]) == (4, 6, 12)


@pytest.mark.profile("routes", keep=["vectors"])
@pytest.mark.parametrize(
    ("group", "size"),
    [(nh.SE(4), 5), (nh.ProductGroup(nh.Translations(2), nh.Translations(3)), 3)],
    ids=["matrices", "vectors"],
)
def test_dimensions_of_tables_have_one_length(group: AbstractMatrixGroup, size: int, tmp_path: Path) -> None:
    """Matrices of two sizes, or vectors of two lengths, do not share the name of a dimension."""
    body = nh.LLSystem(group, inertia_operator=np.eye(group.dim), constraint_subspace=np.eye(group.dim)[1:])
    orbit = _run(body)
    nh.save_orbit(orbit, tmp_path / "o.zarr")
    with xarray.open_zarr(tmp_path / "o.zarr", chunks=None) as result:
        assert set(result.sizes.values()) <= {2, 3, 4, 7, group.dim - 1}
    assert size in orbit.to_dataset(decoded=True).sizes.values()
    assert len(orbit.to_pandas().columns) == 1 + 3 * group.dim - 1 + (20 if group == nh.SE(4) else 5)
    free = GroupLagrangeDAlembert(group, lambda W, h: ((W - group.identity) ** 2).sum() / h, None)
    report = nh.simulate(nh.discretize(free, 0.1), body_velocity=np.full(group.dim, 0.1), steps=2)
    nh.save_orbit(report, tmp_path / "told.zarr")
    again = nh.load_orbit(tmp_path / "told.zarr", discrete=report.motion)
    assert list(again.to_pandas().columns) == list(report.to_pandas().columns)


def test_right_invariant_labels(tmp_path: Path) -> None:
    """Stores of right-invariant systems say that their momenta and displacements are spatial."""
    nh.save_orbit(_run(EVERY["veselova 3"]), tmp_path / "o.zarr")
    with xarray.open_zarr(tmp_path / "o.zarr", chunks=None) as dataset:
        assert "spatial momentum" in dataset["restricted_momentum"].attrs["long_name"]
    with xarray.open_zarr(tmp_path / "o.zarr", group="canonical", chunks=None) as compact:
        assert "spatial momentum" in compact["reduced_momentum"].attrs["long_name"]
        assert "spatial displacement" in compact["cayley"].attrs["long_name"]
    assert "U_k = g_(k+1) g_k^-1" in read_attributes(tmp_path / "o.zarr")["conventions"]


def test_right_invariant_orbits_without_poses(tmp_path: Path) -> None:
    """Without poses the energy of a right-invariant system is unknown; the rest of the orbit is still kept."""
    orbit = _run(EVERY["veselova 3"], reconstruct=False)
    assert set(orbit_to_dataset(orbit, decoded=True).variables) == {"step", "time", "restricted_momentum"}
    nh.save_orbit(orbit, tmp_path / "o.zarr")
    assert nh.load_orbit(tmp_path / "o.zarr").cayley.tobytes() == orbit.cayley.tobytes()


class _Own(nh.Translations):
    """A group that only its author knows."""


_GROUP = nh.ProductGroup(_Own(2), nh.SO(3))
OWN = {
    "constraint is a callable": nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1, constraint=lambda W: W[1, 2]),
    "group holds a custom object": nh.discretize(
        nh.LLSystem(_GROUP, constraint_subspace=np.eye(5)[1:4], inertia_operator=np.eye(5)), 0.1
    ),
}


@pytest.mark.parametrize("what", OWN)
def test_what_no_store_holds_must_be_given(what: str, tmp_path: Path) -> None:
    """A variety of functions, a group class of the user's own: the refusal says to pass what then serves."""
    orbit = _made_up(OWN[what])
    nh.save_orbit(orbit, tmp_path / "o.zarr")
    assert_refused(tmp_path / "o.zarr", rf"whose {what}\. Pass load_orbit\(path, discrete=", nh.load_orbit)
    assert nh.load_orbit(tmp_path / "o.zarr", discrete=OWN[what]).pose.tobytes() == orbit.pose.tobytes()


def test_large_rotations_are_kept_once(tmp_path: Path) -> None:
    """Of a body in 40 dimensions a store has the compact poses alone; its dataset leaves the matrices out."""
    orbit = nh.simulate(nh.discretize(nh.SuslovTop(np.diag(1 + np.arange(40.0))), 0.1), momentum=np.zeros(39), steps=2)
    assert set(orbit.to_dataset().data_vars) == {"energy", "restricted_momentum", "body_velocity", "momentum"}
    nh.save_orbit(orbit, tmp_path / "o.zarr")
    with xarray.open_zarr(tmp_path / "o.zarr", chunks=None) as result:
        assert set(result.data_vars) == {"energy", "restricted_momentum"}
    assert nh.load_orbit(tmp_path / "o.zarr").configuration.tobytes() == orbit.configuration.tobytes()
