"""Stores of before routes had names continue by the route that began them, to the bits of a run without a stop.

`earlier_routes` was written by the last version of that kind, with the program `earlier_stores.py`.
"""

import dataclasses
import json
import shutil
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from earlier_stores import MORE, STEPS, digest, digest_of, motions, rounding_of_lapack, sweep_of

import nonholo as nh
from nonholo.systems import LLSystem

_FOLDER = Path(__file__).with_name("earlier_routes")
_EXPECTED = json.loads((_FOLDER / "expected.json").read_text())
_SAME_LAPACK = rounding_of_lapack() == _EXPECTED["lapack"]
_ORBITS = list(_EXPECTED["orbits"])
_GENERAL = {name for name in _ORBITS if "LLSystem" in name} | {"any d on SE(3)", "veselova", "free body"}
_ROUNDED_ANEW = _GENERAL | {"top on SO(4)", "sleigh on SE(3)"}
"""Motions of the general step, or that solve a linear system: by other arithmetic since, so with other last bits."""
_QUICK = ["suslov top", "LLSystem that is a top", "veselova"]


@pytest.fixture(scope="module")
def stores(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of the stores."""
    folder = tmp_path_factory.mktemp("earlier")
    shutil.unpack_archive(_FOLDER / "stores.tar.xz", folder, filter="data")
    return folder


def _copied(stores: Path, name: str, folder: Path) -> Path:
    return Path(shutil.copytree(stores / f"{name}.zarr", folder / f"{name}.zarr"))


@contextmanager
def _whatever_versions() -> Iterator[None]:
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", ".* was begun with ", RuntimeWarning)
        yield


def _same_bits(name: str) -> bool:
    return _SAME_LAPACK and name not in _ROUNDED_ANEW


def _check_longer(orbit: nh.Orbit, name: str) -> None:
    """Compare with the run without a stop: bit for bit where LAPACK and the kernel round as they did then."""
    expected = _EXPECTED["orbits"][name]
    assert len(orbit) == 1 + STEPS + MORE
    if _same_bits(name):
        assert digest_of(orbit) == expected["longer"]
    assert np.allclose(orbit.reduced_momentum[-1], expected["momentum"], rtol=0, atol=1e-12)  # numbers of order one
    assert np.allclose(orbit.canonical_pose[-1], expected["pose"], rtol=0, atol=1e-12)


@pytest.mark.parametrize("name", _ORBITS)
def test_finished_runs_are_loaded(name: str, stores: Path) -> None:
    """A finished store has the states that were written."""
    assert digest_of(nh.load_orbit(stores / f"{name}.zarr")) == _EXPECTED["orbits"][name]["digest"]


@pytest.mark.profile("routes", keep=[f"{name}-*" for name in _QUICK])
@pytest.mark.parametrize("given", [False, True], ids=["restored", "given"])
@pytest.mark.parametrize("name", _ORBITS)
def test_finished_runs_are_extended(name: str, given: bool, stores: Path, tmp_path: Path) -> None:
    """A finished run is extended by its own route, also if it comes with a discretization that would take another."""
    path = _copied(stores, name, tmp_path)
    # numbers of systems that are made with LAPACK have the last bits of a machine: those of the store are taken
    discrete = dataclasses.replace(motions()[name], system=nh.load_orbit(path).system) if given else None
    with _whatever_versions():
        _check_longer(nh.extend(path, MORE, discrete=discrete), name)


@pytest.mark.profile("routes", keep=_QUICK)
@pytest.mark.parametrize("name", _ORBITS)
def test_stopped_runs_go_on(name: str, stores: Path, tmp_path: Path) -> None:
    """A stopped run is resumed by its own route, then extended."""
    path = _copied(stores, f"{name}, stopped", tmp_path)
    with _whatever_versions():
        orbit = nh.resume(path)
        assert digest_of(orbit) == _EXPECTED["orbits"][name]["digest"] or not _same_bits(name)
        _check_longer(nh.extend(path, MORE), name)


@pytest.mark.parametrize("given", [False, True], ids=["restored", "given"])
@pytest.mark.parametrize("name", list(_EXPECTED["sweeps"]))
def test_stopped_sweeps_go_on(name: str, given: bool, stores: Path, tmp_path: Path) -> None:
    """A stopped sweep is resumed by its own route, whether its task is restored or given."""
    path, expected = _copied(stores, f"{name}, stopped sweep", tmp_path), _EXPECTED["sweeps"][name]
    with _whatever_versions(), nh.resume(path, task=sweep_of(motions()[name])[0] if given else None) as found:
        numbers = [found[key].values for key in ("final_momentum", "final_pose")]
    if _same_bits(name) and name != "suslov top":  # whose restricted momenta are sums in another order since
        assert digest(*numbers) == expected["digest"]
    assert np.allclose(numbers[0], expected["final_momentum"], rtol=0, atol=1e-12)  # numbers of order one


def test_what_the_stores_hold(stores: Path) -> None:
    """Among the stores are systems whose route of today is another one than that of their time."""
    kinds = {type(nh.load_orbit(stores / f"{name}.zarr").system) for name in _ORBITS}
    assert {nh.SuslovTop, nh.ChaplyginSleigh, LLSystem, nh.VeselovaTop, nh.RigidBody} <= kinds
