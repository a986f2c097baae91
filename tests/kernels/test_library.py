"""The library of kernels that are compiled ahead: what it has, what it leaves to numba, and when it is not used."""

import gzip
import importlib
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bodies import GENERAL
from scripts import printed, script

import nonholo as nh
from nonholo.base import compiled
from nonholo.base.compiled import build, first_way, key_of, library, library_of_kernels, tokens
from nonholo.discrete.routes import make_route
from nonholo.kernels import SleighBody, _driver, _small
from nonholo.kernels.general import _step as general
from nonholo.kernels.secular import _step

LINES = Path(library.__file__).parents[2].joinpath("kernels", "ahead.txt").read_text(encoding="utf-8").splitlines()
RUN = """
import json, sys
import nonholo as nh
from nonholo.base.compiled import way_of_kernels
orbit = nh.simulate(nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1), body_velocity=(1, 0.3, 0), steps=20)
heavy = nh.Forced(orbit.system, nh.Gravity([1.0, -0.5], [0.5, 0.25]), nh.Friction([0.1, 0.3, 0.2]))
flow = nh.flow(heavy, body_velocity=(1, 0.3, 0), times=(0.0, 1.0, 3.0))
rows = [x.tolist() for x in (orbit.momentum, orbit.pose, flow.momentum, flow.pose)]
print(json.dumps([way_of_kernels(), "numba" in sys.modules, rows]))
"""


def _ran(**variables: str) -> Any:
    return printed("-c", RUN, **{"NUMBA_BOUNDSCHECK": "0", **variables})


@pytest.fixture(scope="module")
def known() -> compiled.Library:
    """Return the library of this text."""
    if first_way() != "library":
        pytest.skip("kernels run by another way")
    result = library_of_kernels()
    assert result is not None, "Compile it: python -m nonholo.base.compiled.build nonholo/kernels"
    return result


def test_all_that_is_listed_is_there(known: compiled.Library) -> None:
    """Every line of the list is a function of the library, and the list is sorted, without doubles."""
    assert sorted(set(LINES)) == LINES
    absent = []
    for line in LINES:
        name, key = line.split(" ")
        module, _, function = name.rpartition(".")
        kernel = getattr(importlib.import_module(module), function)
        is_there = known.entry(kernel, key) if isinstance(kernel, compiled.Kernel) else known.address(name, key)
        absent += [] if is_there else [line]
    assert absent == []


def test_three_ways_have_the_same_bits() -> None:
    """A sleigh, free and on a slope, by the library without numba, by numba, and by plain Python: the same numbers."""
    by_library, by_numba, by_python = (_ran(NONHOLO_KERNELS=way) for way in ("library", "numba", "python"))
    assert by_library[:2] == ["library", False]
    assert by_numba[:2] == ["numba", True]
    assert by_python[:2] == ["python", False]
    assert by_library[2] == by_numba[2] == by_python[2]


PLAIN = """
import runpy, sys
from nonholo.base.compiled import _kernel
_kernel._flags_of_processor = set
runpy.run_path(sys.argv.pop(1), run_name="__main__")
"""


@pytest.mark.usefixtures("known")
def test_calls_are_replayed_elsewhere(tmp_path: Path) -> None:
    """Calls have the same digests in Python, and by code for a processor with no more than the first of its kind."""
    replay = script("tests/kernels/replay.py")
    calls = replay.recorded(len(replay.KINDS))
    (tmp_path / "calls.gz").write_bytes(gzip.compress(pickle.dumps(calls)))
    here = [*map(replay.digest, calls)]
    assert any("taylor" in digest for digest in here)
    for way in ("python", "library"):
        variables = {"NONHOLO_KERNELS": way, "PYTHONPATH": str(Path(nh.__file__).parents[1])}
        elsewhere = printed("-c", PLAIN, replay.__file__, "bits", "calls.gz", cwd=tmp_path, **variables)
        assert elsewhere == [way, *here]


@pytest.mark.parametrize("way", ["nmba", "", "Library"])
def test_an_unknown_way_is_refused(way: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The variable has one of three values; another one is an error before any kernel runs."""
    monkeypatch.setenv("NONHOLO_KERNELS", way)
    with pytest.raises(ValueError, match=f"NONHOLO_KERNELS must be one of library, numba, python. Got '{way}'"):
        first_way.__wrapped__()


@pytest.mark.parametrize(("way", "said"), [("library", "from "), ("numba", "by numba"), ("python", "as Python")])
def test_the_log_names_the_way(way: str, said: str, known: compiled.Library, caplog: pytest.LogCaptureFixture) -> None:
    """What asks for the library says once how kernels run."""
    with pytest.MonkeyPatch.context() as patch, caplog.at_level("INFO", "nonholo"):
        patch.setattr(compiled._kernel, "first_way", lambda: way)
        patch.setattr(compiled._kernel, "_by_numba", compiled._kernel._by_numba.__wrapped__)
        result = library_of_kernels.__wrapped__()
    assert caplog.messages == [f"Kernels run {said}{known.path if way == 'library' else ''}."]
    assert (result is not None) == (way == "library")


@pytest.mark.parametrize("size", [2**21, 2**40], ids=["no memory", "no number of bytes"])
def test_a_kernel_that_fails_is_an_error(size: int, known: compiled.Library) -> None:
    """An array that cannot be made, of a size from an argument, is an error of Python; the process continues."""
    del known
    body = make_route(nh.discretize(GENERAL["suslov 4"][0], 0.1), "matrix").body
    with pytest.raises(RuntimeError, match=r"kernel nonholo.kernels.general._step.workspace failed.*=python"):
        general.workspace(body._replace(tensor=np.empty((size, 0))))
    assert general.workspace(body) is not None


def test_objects_for_every_machine(tmp_path: Path) -> None:
    """A kernel that makes an array becomes an object in the format of each machine, which has its name."""
    begin = {"linux": b"\x7fELF", "darwin": b"\xcf\xfa\xed\xfe", "windows": b"\x64\x86"}
    folders = {name: tmp_path / name for name in build.MACHINES}
    for folder in folders.values():
        folder.mkdir()
    line = f"{_step.__name__}.room_for_sums "
    build.write_objects(line, folders)
    for name, folder in folders.items():
        (file,) = folder.iterdir()
        content = file.read_bytes()
        assert content.startswith(begin[name.split("-")[0]])
        assert compiled.symbol_of(*line.split(" ")).encode() in content


def test_an_unknown_machine_is_refused(tmp_path: Path) -> None:
    """It is, before anything is compiled or written."""
    with pytest.raises(ValueError, match=r"must be one of linux-x86_64, .*Got linux-arm\."):
        build.build(tmp_path / "new", "linux-aarch64", "linux-arm")
    assert not list(tmp_path.iterdir())


def test_a_library_of_another_text_is_not_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is found by a digest of the text: a changed kernel has none until it is compiled."""
    monkeypatch.setattr(library, "_PACKAGE", tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    for folder in ("kernels", "base/numerics", "nonholo"):
        (tmp_path / folder).mkdir(parents=True)
    for file in ("kernels/one.py", "kernels/ahead.txt"):
        (tmp_path / file).write_text("one")
    library.digest_of.cache_clear()
    assert library.place() is None
    file = tmp_path / "nonholo" / library.name_of_library()
    file.write_bytes(b"")
    assert library.place() == file
    (tmp_path / "kernels/one.py").write_text("another")
    library.digest_of.cache_clear()
    assert library.place() is None
    library.digest_of.cache_clear()


def test_arrays_of_another_kind_go_to_numba(known: compiled.Library) -> None:
    """Arrays that are not in C order, or hold other numbers, have no function in the library: the results are right."""
    del known
    rows = np.arange(12.0).reshape(3, 4)
    for source in (rows[1], rows.T[1], np.arange(3), np.arange(4.0).astype(">f8")[:4]):
        target = np.zeros(len(source))
        if source.dtype.isnative:
            _small.assign(target, source)
            np.testing.assert_array_equal(target, source)
        else:
            assert "o" in key_of((target, source))


def test_results_of_every_kind(known: compiled.Library) -> None:
    """Numbers, truth values, arrays, and named tuples of them come back as from numba."""
    body = SleighBody(1.0, 1.0, 0.5)
    code, first, second = _driver._solve(body, 0.1, 0.2, 0.0, 0.0)
    assert (type(code), type(first), type(second)) == (int, float, float)
    assert known.entry(_driver._solve, key_of((body, 0.1, 0.2, 0.0, 0.0)))
    room = _step.room_for_sums()
    assert room.flags.owndata
    assert room.shape == _step.room_for_sums.dispatcher().shape
    rows = np.array([[0.1, 0.2], [0.3, -0.1]])
    results = _driver.step_each(body, rows, rows, rows, True)
    for own, other in zip(results, _driver.step_each.dispatcher(body, rows, rows, rows, True), strict=True):
        np.testing.assert_array_equal(own, other)


def test_kinds_of_arguments() -> None:
    """A key says the kinds of all numbers, and which tuples hold them."""
    key = key_of((SleighBody(1.0, 1.0, 0.5), 3, None, True, (np.zeros((2, 2)), 1.0), "text", np.zeros(2, dtype=int)))
    assert key == "SleighBody(ddd)qn?(d2d)oq1"
    assert "".join(tokens(key)) == key
    assert tokens(key)[:3] == ["SleighBody(", "d", "d"]
