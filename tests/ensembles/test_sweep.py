"""`sweep` with functions: what they may return, who is recorded as failed, and that blocks change nothing."""

import contextlib
import warnings
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray
from ensembles.faults import TOP_DESIGN, TOPS, done, same
from refusals import refusals
from stopping import stopped_at, stopped_in

import nonholo as nh
from nonholo.ensembles import standing_of
from nonholo.ensembles.stores import ABSENT, RAISED

GRID = nh.Grid({"x": [1.0, 2.0, 3.0], "y": [10.0, 20.0, 30.0, 40.0]}, rng=7)
FEW = nh.RandomDesign(50, TOP_DESIGN, rng=6)


def _swept(task: Any, path: Path, design: Any = GRID, **options: Any) -> xarray.Dataset:
    return nh.sweep(task, design, path / "run.zarr", **{"scheduler": "synchronous", **options}).load()


def test_result_is_labeled(tmp_path: Path) -> None:
    """Members lie along the axes of the grid, other axes have the names of the task or names of their own."""

    def task(block: nh.MemberBlock) -> dict[str, Any]:
        products = block["x"][:, None] * np.arange(5.0)
        report = {"long_name": "products", "units": "m"}
        return {"sum": block["x"] + block["y"], "products": (("factor",), products, report), "plain": products}

    result = _swept(task, tmp_path)
    assert result["sum"].dims == ("x", "y")
    assert np.array_equal(result["sum"], np.add.outer([1.0, 2.0, 3.0], [10.0, 20.0, 30.0, 40.0]))
    assert result["products"].dims == ("x", "y", "factor")
    assert float(result["products"].sel(x=2.0, y=30.0).isel(factor=4)) == 8.0
    assert (result["products"].attrs["long_name"], result["products"].attrs["units"]) == ("products", "m")
    assert result["plain"].dims == ("x", "y", "plain_1")
    assert (result["outcome"] == 0).all()


def test_draws_are_kept_beside_the_result(tmp_path: Path) -> None:
    """What a random design drew is in the store, bit by bit, with dimensions of its own."""
    result = _swept(lambda block: {"trace": np.trace(block["mass_tensor"], axis1=1, axis2=2)}, tmp_path, FEW, block=7)
    drawn = FEW.values(0, 50)
    assert result["mass_tensor"].dims == ("member", "mass_tensor_1", "mass_tensor_2")
    for name in ("mass_tensor", "restricted_velocity"):
        assert result[name].values.tobytes() == drawn[name].tobytes()
    assert np.array_equal(result["trace"], np.trace(drawn["mass_tensor"], axis1=1, axis2=2))


def test_axes_of_vectors_are_data(tmp_path: Path) -> None:
    """Vectors along an axis have a number as their place, and stand in the result."""
    result = _swept(lambda block: block["start"][:, 1], tmp_path, nh.Grid({"start": [[1.0, 2.0], [3.0, 4.0]]}))
    assert result["result"].dims == ("start_number",)
    assert result["start"].dims == ("start_number", "start_1")
    assert result["result"].values.tolist() == result["start"].values[:, 1].tolist()


WIDEST = {"b": np.int8, "i": np.int64, "u": np.uint64, "f": np.float64, "c": np.complex128}
ABSENT_OF = {"b": -128, "i": np.iinfo(np.int64).min, "u": np.iinfo(np.uint64).max, "f": np.nan, "c": np.nan}


@pytest.mark.parametrize("kind", [bool, np.int16, np.uint8, np.float32, np.float64, np.complex64])
def test_types_of_numbers(kind: type, tmp_path: Path) -> None:
    """Numbers of any kind are kept with their values, in the widest type; a member that fails has none."""

    def task(block: nh.MemberBlock) -> Any:
        if (block["y"] == 20.0).any():
            raise RuntimeError("twenty")
        return (block["x"] - 1).astype(kind)

    result, letter = _swept(task, tmp_path)["result"], np.dtype(kind).kind
    assert result.dtype == WIDEST[letter]
    wanted = np.array([0, 1, 2]).astype(kind)
    assert np.array_equal(result.values[:, [0, 2, 3]], np.repeat(wanted[:, None], 3, axis=1))
    np.testing.assert_array_equal(result.values[:, 1].real, ABSENT_OF[letter])


def _raising(block: nh.MemberBlock) -> dict[str, Any]:
    bad = block.index[block.index % 5 == 3]
    if len(bad):
        raise ZeroDivisionError(f"at {bad[0]}")
    return _calm(block)


def _calm(block: nh.MemberBlock) -> dict[str, Any]:
    return {"value": np.sin(block["x"]) * block["y"], "noise": block.random(2, "noise"), "count": block.index}


@pytest.mark.profile("faults", keep=["1", "5"])
@pytest.mark.parametrize("block", [1, 3, 5, 12])
def test_members_that_raise_are_recorded(block: int, tmp_path: Path) -> None:
    """Members for which the task raises have no numbers, outcome 100 and a message; the others have the same bits."""
    result = _swept(_raising, tmp_path, block=block)
    calm = nh.sweep(_calm, GRID, tmp_path / "calm.zarr").load()
    bad = np.arange(12).reshape(3, 4) % 5 == 3
    assert np.array_equal(result["outcome"], np.where(bad, RAISED, 0))
    for name in ("value", "noise", "count"):
        assert result[name].values[~bad].tobytes() == calm[name].values[~bad].tobytes()
    assert np.isnan(result["value"].values[bad]).all()
    assert np.isnan(result["noise"].values[bad]).all()
    now = standing_of(tmp_path / "run.zarr")
    assert sorted(now.messages) == [(3, "ZeroDivisionError: at 3"), (8, "ZeroDivisionError: at 8")]
    assert (now.done, now.failure_count, now.outcomes) == (12, 2, {"successful": 10, "raised": 2})


def test_tasks_that_always_raise_are_refused(tmp_path: Path) -> None:
    """A task that fails for all members tried is refused with its own error, before there is a store."""

    def broken(block: nh.MemberBlock) -> Any:
        return block["z"]

    with pytest.raises(ValueError, match=r"run for at least one tested member. Got KeyError.*the design has x, y"):
        _swept(broken, tmp_path)
    assert not list(tmp_path.iterdir())


def test_one_good_member_is_enough_to_begin(tmp_path: Path) -> None:
    """If the first members fail, others tell what a task returns."""

    def late(block: nh.MemberBlock) -> Any:
        if (block.index < 9).any():
            raise ValueError("too early")
        return block["x"]

    result = _swept(late, tmp_path)
    assert np.array_equal(result["outcome"].values.ravel() == RAISED, np.arange(12) < 9)
    assert (result["result"].values.ravel()[9:] == 3.0).all()


def test_own_outcomes_are_kept(tmp_path: Path) -> None:
    """A task may say how its members ended; the codes are counted by name where they have one."""
    codes = np.array([0, 1, 5, 77, -1, 0, 0, 0, 0, 0, 0, 0])
    result = _swept(lambda block: {"outcome": codes[block.index]}, tmp_path)
    assert np.array_equal(result["outcome"].values.ravel(), codes)
    outcomes = standing_of(tmp_path / "run.zarr").outcomes
    assert outcomes == {"successful": 8, "no_real_branch": 1, "nonfinite": 1, "77": 1, "-1": 1}


def test_outcomes_are_explained(tmp_path: Path) -> None:
    """The codes of outcomes and their meanings are attributes of the array, as CF conventions write flags."""
    report = _swept(_calm, tmp_path)["outcome"].attrs
    meanings = dict(zip(report["flag_values"], report["flag_meanings"].split(), strict=True))
    assert meanings == {ABSENT: "absent", **{int(code): code.name for code in nh.Outcome}, RAISED: "raised"}


def test_members_to_come_are_absent(tmp_path: Path) -> None:
    """In an unfinished store members that are not done are NaN, with the outcome that says so."""
    with stopped_at(2):
        _swept(lambda block: block["x"], tmp_path, block=4)
    with xarray.open_zarr(tmp_path / "run.zarr", chunks=None, consolidated=False) as result:
        assert (result["outcome"].values[2] == ABSENT).all()
        assert np.isnan(result["result"].values[2]).all()


def _failing(later: Callable[[nh.MemberBlock], Any]) -> Callable[[nh.MemberBlock], Any]:
    """Return a task whose first member is right, and which returns something else for the sixth."""

    def task(block: nh.MemberBlock) -> Any:
        return later(block) if 5 in block.index else {"a": block["x"], "b": block.index}

    return task


@pytest.mark.parametrize(
    ("later", "match"),
    [
        (lambda block: {"a": block["x"]}, r"return the same names for all members. Got \['a', 'outcome'\]"),
        (lambda block: {"a": block["x"], "b": block.random(2)}, r"have one shape for all members. Got \(2,\)"),
        (lambda block: {"a": block["x"] * 1j, "b": block.index}, "have one type for all members. Got complex128"),
        (lambda block: {"a": block["x"], "b": block["x"]}, "have one type for all members. Got float64 after int64"),
        (lambda block: {"a": block["x"][:0], "b": block.index}, r"leading member axis. Got shape \(0,\) for 1"),
        (lambda block: {"a": ["one"] * block.count, "b": block.index}, "be an array of numbers"),
        (lambda block: {"a": block["x"], "b": block.index, "outcome": 300 + block.index}, "from -127 to 127"),
    ],
    ids=["names", "shape", "complex", "float", "no members", "text", "outcome"],
)
def test_changing_results_are_refused(later: Callable[[nh.MemberBlock], Any], match: str, tmp_path: Path) -> None:
    """A member for which a task returns something else is recorded with the difference, the others are done."""
    result = _swept(_failing(later), tmp_path, block=4)
    assert np.flatnonzero(result["outcome"].values.ravel() == RAISED).tolist() == [5]
    ((member, report),) = standing_of(tmp_path / "run.zarr").messages
    assert member == 5
    with pytest.raises(ValueError, match=match):
        raise ValueError(report)


# What cannot be written, or not be opened by xarray, is refused before anything is computed.
test_results_that_nobody_could_open_are_refused = refusals(
    (lambda _: "text", "be an array of numbers"),
    (lambda _: 1.0, "leading member axis"),
    (lambda block: block["x"][:1], r"leading member axis. Got shape \(1,\) for 2 members"),
    (lambda block: np.ones((block.count, 0)), "hold numbers"),
    (lambda block: (("one", "two"), block.random(2)), "name each axis but the first"),
    (lambda block: {"k": (block["x"],)}, "Got a tuple of 1"),
    (lambda block: {"k": (("c",), block.random(2), {"width": np.ones(1)})}, "have attributes that JSON has"),
    (lambda block: {"k": [[1.0], [1.0, 2.0]][: block.count]}, r"be an array of numbers\. Got setting an array"),
    (lambda block: {"run": block["x"]}, "taken: run"),
    (lambda block: {"a/b": block["x"]}, "be a name: a letter"),
    (lambda block: {"outcome": block["x"]}, "a number from -127 to 127"),
    (lambda block: {"x": block["x"]}, "a name that the design and dimensions do not have"),
    (lambda block: {"k": (("k",), block.random(2))}, "a name that the design and dimensions do not have"),
    (lambda block: {"k": (("x",), block.random(2))}, "have a different name for each axis"),
    (lambda block: {"k": (("c",), block.random(2)), "l": (("c",), block.random(3))}, "one length along 'c'"),
    ask=lambda returned: _swept(returned, Path()),
)


# Bad arguments, and a result with the name of something drawn, are refused before there is a store.
test_bad_arguments_are_refused = refusals(
    ({"task": 5}, r"sweep\(task=...\)` must be callable"),
    (
        {"task": lambda block: {"mass_tensor": block.index}, "design": FEW},
        "return names that the design does not have. Got 'mass_tensor'",
    ),
    ({"design": {"x": [1.0]}}, r"sweep\(design=...\)` must be a design"),
    ({"scheduler": "fast"}, "must be one of threads, processes, synchronous or an address"),
    ({"scheduler": 5}, "must be one of threads"),
    ({"workers": 0}, r"sweep\(workers=...\)` must be a positive integer"),
    ({"block": 0}, r"sweep\(block=...\)` must be a positive integer"),
    ask=lambda options: nh.sweep(**{"task": _calm, "design": GRID, "store": Path("run.zarr"), **options}),
)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> xarray.Dataset:
    """The tops in one block."""
    return nh.sweep(TOPS, FEW, tmp_path_factory.mktemp("whole") / "run.zarr", "synchronous").load()


@pytest.mark.profile("faults", keep=["threads-7", "synchronous-7"])
@pytest.mark.parametrize(
    ("scheduler", "block"), [("threads", 1), ("threads", 7), ("threads", 64), ("synchronous", 7), ("processes", 7)]
)
def test_bits_of_ensembles_in_blocks(scheduler: str, block: int, whole: xarray.Dataset, tmp_path: Path) -> None:
    """Tops have the same bits in blocks of any size, by any scheduler, alone or beside others in a vector register."""
    assert same(_swept(TOPS, tmp_path, FEW, block=block, scheduler=scheduler, workers=2), whole)


@pytest.mark.profile("faults", cases=["_calm-1000*"])
@pytest.mark.parametrize(
    ("task", "members", "blocks"), [(_calm, 1000, 32), (_calm, 20, 20), (TOPS, 1000, 32), (TOPS, 40, 2)]
)
def test_small_sweeps_are_cut_for_all_cores(task: Any, members: int, blocks: int, tmp_path: Path) -> None:
    """A sweep that would be one block is some thirty, but not of fewer members than the compiled loop takes at once."""
    names = {"x": nh.Normal(), "y": nh.Normal()} if task is _calm else TOP_DESIGN
    _swept(task, tmp_path, nh.RandomDesign(members, names))
    assert done(tmp_path / "run.zarr") == blocks


def test_loaded_sweep_is_the_sweep(tmp_path: Path) -> None:
    """What `sweep` returned, `load_sweep` and plain xarray open; nothing warns, and the scenario is kept."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        result = _swept(_calm, tmp_path, scenario="[design]")
        path = tmp_path / "run.zarr"
        with xarray.open_zarr(path, chunks=None) as opened:
            assert same(opened.load(), result)
        assert same(nh.load_sweep(path).load(), result)
    assert result.attrs["scenario"] == "[design]"


def test_resumed_sweep_keeps_its_blocks(tmp_path: Path) -> None:
    """With `resume` a new path is begun; a finished store is opened, whatever `block` says now."""
    first = _swept(_calm, tmp_path, block=3, resume=True)
    times = [mark.stat().st_mtime_ns for mark in (tmp_path / "run.zarr" / "run" / "blocks").iterdir()]
    assert len(times) == 6
    assert same(_swept(_calm, tmp_path, block=1, resume=True), first)
    assert times == [mark.stat().st_mtime_ns for mark in (tmp_path / "run.zarr" / "run" / "blocks").iterdir()]


def test_a_large_design_costs_nothing(tmp_path: Path) -> None:
    """Of 10^9 members nothing is made before the first block, and nothing after it has failed."""
    design = nh.Grid({name: np.arange(1000.0) for name in "xyz"})
    with stopped_in("nonholo.ensembles._scheduling.attempt", match="Stopped at 0 of 1000000000 members"):
        _swept(lambda block: block["x"], tmp_path, design)
    assert sum(file.stat().st_size for file in tmp_path.rglob("*")) < 100_000


def test_two_sweeps_at_a_time(tmp_path: Path) -> None:
    """Sweeps in two threads of one process do not hear of each other's blocks."""
    with ThreadPoolExecutor(2) as pool:
        stores = [tmp_path / "one.zarr", tmp_path / "two.zarr"]
        result = list(pool.map(lambda store: nh.sweep(_calm, GRID, store, block=1, workers=2).load(), stores))
    wanted = _swept(_calm, tmp_path)
    assert all(same(each, wanted) for each in result)


def test_progress_counts_members(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every member is counted once, those of blocks that were there too."""
    from nonholo.ensembles import _sweep

    counted: list[tuple[int, int]] = []
    bar = contextlib.nullcontext(lambda *count: counted.append(count))
    monkeypatch.setattr(_sweep, "progress_bar", lambda *_: bar)
    for _ in range(2):
        counted.clear()
        _swept(_calm, tmp_path, block=4, progress=True, resume=True)
        assert counted == [(0, 12), (4, 12), (8, 12), (12, 12)]


def _numbers(block: nh.MemberBlock) -> np.ndarray:
    return block.index


def _drawn_twice(block: nh.MemberBlock) -> dict[str, Any]:
    return {"twice": 2 * block["x"], "noise": block.random(1)[:, 0]}


@pytest.mark.profile("faults", keep=["4"])
@pytest.mark.parametrize("block", [4, 7, 100])
def test_a_random_design_grows(block: int, tmp_path: Path) -> None:
    """With more members, once and again, a store has the bits of a sweep of all of them; what is there is not done."""
    few, many = (nh.RandomDesign(size, {"x": nh.Uniform(0.0, 1.0)}, rng=3) for size in (10, 29))
    whole = _swept(_drawn_twice, tmp_path / "whole", many)
    _swept(_drawn_twice, tmp_path, few, block=block)
    calls = []

    def counted(members: nh.MemberBlock) -> dict[str, Any]:
        calls.extend(members.index)
        return _drawn_twice(members)

    counted.__module__, counted.__qualname__ = _drawn_twice.__module__, _drawn_twice.__qualname__
    path, how = tmp_path / "run.zarr", {"task": counted, "scheduler": "synchronous"}
    assert nh.resume(path, members=17, **how).sizes == {"member": 17}
    assert same(nh.resume(path, members=29, **how).load(), whole)
    assert same(nh.load_sweep(path).load(), whole)
    first = 10 // min(block, 10) * min(block, 10)
    assert min(calls) == first
    assert standing_of(path).done == 29


def test_a_growth_that_was_killed_continues(tmp_path: Path) -> None:
    """Killed as soon as the store says how many members it is to have, a growth is done by a plain `resume`."""
    few, many = (nh.RandomDesign(size, {"x": nh.Uniform(0.0, 1.0)}, rng=3) for size in (10, 23))
    _swept(_drawn_twice, tmp_path, few, block=4)
    path, how = tmp_path / "run.zarr", {"task": _drawn_twice, "scheduler": "synchronous"}
    with stopped_in("nonholo.ensembles._sweep.continue_sweep"):
        nh.resume(path, members=23, **how)
    assert not standing_of(path).finished
    assert same(nh.resume(path, **how).load(), _swept(_drawn_twice, tmp_path / "whole", many))


@pytest.mark.parametrize(
    ("design", "members", "message"),
    [
        (GRID, 20, "must come with a random design"),
        (FEW, 49, "must not be below the 50 members of the design. Got 49"),
        (FEW, 1.5, r"resume\(members=...\)"),
    ],
)
def test_growth_that_is_refused(design: Any, members: Any, message: str, tmp_path: Path) -> None:
    """A grid has no more members, a random design never fewer."""
    _swept(_numbers, tmp_path, design)
    with pytest.raises(ValueError, match=message):
        nh.resume(tmp_path / "run.zarr", task=_numbers, members=members)
