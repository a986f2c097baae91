"""Stores written by earlier versions are read as they were: `schema_1` was written by the first release of stores.

Its `expected.json` holds the arrays and the decoded motion as the version that wrote the stores saw them.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import nonholo as nh
from nonholo.io import read_attributes
from nonholo.orbit import STATES

_STORES = Path(__file__).with_name("schema_1")
_EXPECTED = json.loads((_STORES / "expected.json").read_text())
_MOTIONS = {
    "top": nh.discretize(nh.SuslovTop.from_inertia(np.diag([3.0, 2.0, 1.5]) + 0.1, axis=(0.6, 0.0, 0.8)), 0.1),
    "sleigh": nh.discretize(nh.ChaplyginSleigh(1.3, 0.7, 0.5, b=0.3), 0.1, "logarithmic", "exponential"),
}


@pytest.mark.parametrize("name", _EXPECTED)
def test_compact_arrays_bit_for_bit(name: str) -> None:
    """Times, momenta, charts, poses and headings of a store of schema 1 have the bits that were written."""
    orbit = nh.load_orbit(_STORES / f"{name}.zarr")
    assert read_attributes(_STORES / f"{name}.zarr")["schema"] == 1
    for key in STATES:
        value, expected = getattr(orbit, key), _EXPECTED[name][key.removeprefix("canonical_")]
        assert (value is None and expected is None) or np.array_equal(value, expected), key


def _decoded() -> list[Any]:
    keys = ("configuration", "displacement", "body_velocity", "momentum", "multipliers", "energy")
    return [(name, key) for name, told in _EXPECTED.items() for key in keys if key in told]


@pytest.mark.profile("routes", keep=["top-*", "flow-*", "sleigh-[!m]*"])
@pytest.mark.parametrize(("name", "key"), _decoded())
def test_decoded_motion(name: str, key: str) -> None:
    """What the library makes of the compact arrays is what it made of them then, to a few units in the last place."""
    value = getattr(nh.load_orbit(_STORES / f"{name}.zarr"), key)
    assert np.allclose(
        value, _EXPECTED[name][key], rtol=0, atol=1e-14
    )  # numbers of order one; formulas were rearranged


@pytest.mark.parametrize("name", _MOTIONS)
def test_a_given_motion_is_recognized(name: str) -> None:
    """The discretization that made a store of schema 1 is accepted, another one is refused."""
    assert nh.load_orbit(_STORES / f"{name}.zarr", discrete=_MOTIONS[name]).motion is _MOTIONS[name]
    other = nh.discretize(_MOTIONS[name].system, 0.2)
    with pytest.raises(ValueError, match="be the discretization of the store"):
        nh.load_orbit(_STORES / f"{name}.zarr", discrete=other)


@pytest.mark.parametrize("name", _EXPECTED)
def test_saved_again_in_the_new_schema(name: str, tmp_path: Path) -> None:
    """An old orbit saved by this version has the new schema and the same bits."""
    old = nh.load_orbit(_STORES / f"{name}.zarr")
    nh.save_orbit(old, tmp_path / "o.zarr")
    new = nh.load_orbit(tmp_path / "o.zarr")
    assert read_attributes(tmp_path / "o.zarr")["schema"] == 4
    assert new.reduced_momentum.tobytes() == old.reduced_momentum.tobytes()
    assert new.canonical_pose.tobytes() == old.canonical_pose.tobytes()
