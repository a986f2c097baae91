"""A short share of each fuzzer, and their table of calls, which is whole; the long ones run by `python tests/fuzz`.

That the calls work as long as nothing is changed is seen in `test_light_core`.
"""

import dataclasses
import inspect
import json
import os
import random
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pytest
from fuzz import api, bad, judge, kills, kinds, openings, shelf, steps, stores
from fuzz.calls import NOT_CALLED, Call, all_calls, is_picture, public_names
from fuzz.damage import damage_file, edit_json
from fuzz.following import followed
from fuzz.trials import draw, from_text, told, verdict
from fuzz.worker import Worker

import nonholo as nh


@pytest.mark.profile("faults", instead="test_no_value_passes_a_check_unseen")
def test_calls_with_bad_values_are_refused() -> None:
    """A few trials of each seed: none is raw, silent, hangs or aborts."""
    calls = {name: call for name, call in all_calls().items() if not (call.slow or call.stores)}
    result = api.figures(api.verdicts(draw(calls, 60, seed=5), workers=1))
    assert not result["broken"], api.lines(result)


@pytest.mark.profile("faults", instead="test_damaged_chunk_is_named")
def test_damaged_stores_are_refused_or_right(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Cut, changed and missing files of an unfinished run and of a sweep."""
    chosen = [*openings.trials("orbit", "damage", 3, seed=2)[10:], *openings.trials("sweep", "damage", 1, seed=0)]
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    do = openings.prepared()
    result = [(trial, *do(trial)) for trial in chosen]
    assert not [row for row in result if row[-1].kind not in stores.RIGHT]


@pytest.mark.profile("faults", instead="test_runs_cut_at_random_blocks_go_on")
@pytest.mark.skipif(not hasattr(os, "fork"), reason="kills forked processes")
def test_killed_runs_and_sweeps_go_on(tmp_path: Path) -> None:
    """SIGKILL at random times: the bits are those of a run that nobody disturbed, and nothing is left."""
    file = tmp_path / "kills.json"
    command = [sys.executable, kills.__file__, "--trials", "6", "--restarts", "0", "--json", str(file)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)  # noqa: S603  # it forks: a process without threads
    for result in json.loads(file.read_text()).values():
        assert result["killed"] >= 6
        assert not result["wrong"]


def test_random_steps_are_right() -> None:
    """Steps of a top and of a sleigh of any size solve their equation; sampled ones are on the principal branch."""
    result = steps.figures(2000, seed=1, families=("top 3", "sleigh"))
    assert not [name for name in result["all"] if name.startswith(("wrong", "not finite")) and result["all"][name]]
    assert result["all"]["solve the equation"] == result["all"]["steps"] >= 2000
    assert result["all"]["the root of the continuation"] > 10


@dataclasses.dataclass
class _Found:
    value: float
    outcome: int = 0


@pytest.mark.parametrize(
    ("function", "value", "expected"),
    [
        (lambda x: x, "nan", "silent"),
        (lambda x: x, "0.5", "accepted"),
        (lambda x: _Found(x / 0.0 if x else x), "0", "accepted"),
        (lambda x: _Found(np.inf * x), "0.5", "silent"),
        (lambda x: _Found(np.inf * x, 2), "0.5", "accepted"),
        (lambda x: 1 / x, "0", "raw"),
        (lambda x: float(x), "text", "raw"),
        (lambda x: np.zeros((int(x), 10**4)), "10**12", "memory"),
        (lambda x: nh.ChaplyginSleigh(x, 1.0, 0.5), "nan", "refused"),
        (lambda x: nh.load_orbit("nowhere.zarr"), "0", "refused"),  # noqa: ARG005
    ],
)
def test_the_judge_tells_classes_apart(function: object, value: str, expected: str) -> None:
    """A function that accepts NaN is silent, one that divides by zero is raw, one that refuses is not."""
    call = Call("x", function, {"x": kinds.number(1.0)})
    assert verdict(call, {"x": value}, set()).kind == expected


def test_workers_survive() -> None:
    """A job that hangs and one that ends the process are noted, and the next one is done."""
    with Worker("fuzz.marker:answering", seconds=0.3) as worker:
        answers = [worker.answer(job) for job in ("hang", "die", "say")]
    assert answers == ["hang", "abort", "said"]


def test_trials_have_names() -> None:
    """A trial is done again from the line that is printed."""
    calls = {"f [x]": Call("f [x]", print, {"x": kinds.array(np.eye(2)), "y": kinds.number(1.0)})}
    for trial in draw(calls, 50, seed=0):
        assert from_text(told(trial)) == trial


def test_damage_is_damage(tmp_path: Path) -> None:
    """Most damage changes a file, every edit leaves JSON that differs."""
    run = {"restricted_velocity": (0.3, 0.2), "steps": 20, "checkpoint_every": 10}
    nh.simulate(shelf.DISCRETE, **run, store=tmp_path / "run.zarr")
    before = openings.prints_of(tmp_path)
    for seed in range(5):
        edit_json(tmp_path / "run.zarr", random.Random(seed))  # noqa: S311
    edited = openings.prints_of(tmp_path)
    damage_file(tmp_path / "run.zarr", random.Random(1))  # noqa: S311
    assert before != edited != openings.prints_of(tmp_path)


def test_numbers_that_are_not_finite_are_seen() -> None:
    """In arrays, in fields and below them; a result that says that it failed may have them."""
    assert judge.nonfinite([np.array([1.0, np.nan])]) == {".*"}
    assert judge.nonfinite(_Found(np.inf)) == {".value"}
    assert judge.nonfinite(_Found(np.inf), infinite=True) == set()
    assert judge.nonfinite(_Found(np.nan), infinite=True) == {".value"}
    assert judge.nonfinite(_Found(np.inf, 1)) == judge.nonfinite(_Found(1.0)) == set()


@pytest.mark.parametrize("family", ["top 3", "sleigh", "any d on SE(3)"])
def test_the_continuation_is_that_of_the_definition(family: str) -> None:
    """Its momenta are those of the library, its root has the momentum that was asked for and lies on the variety."""
    system = steps.FAMILIES[family](np.random.default_rng(2))
    equations, size = steps.equations_of(system)
    orbit = nh.simulate(nh.discretize(system, 0.1), restricted_velocity=np.full(system.rank, 0.2), steps=3)
    r = 0.1 * system.restrict(orbit.momentum) / size
    np.testing.assert_allclose(equations.momentum(orbit.displacement), r, rtol=0, atol=1e-14)
    path = followed(equations, r)
    assert path.whole.all()
    np.testing.assert_allclose(path.roots, orbit.displacement, rtol=0, atol=1e-12)


@pytest.fixture(name="calls", scope="module")
def _calls() -> dict[str, Call]:
    return all_calls()


def test_every_public_name_is_called(calls: dict[str, Call]) -> None:
    """A new public name needs a call, or a reason why there is none."""
    called = {name.split(" [")[0] for name in calls}
    missing = [name for name in public_names() if name not in called | NOT_CALLED.keys() and not is_picture(name)]
    assert not missing, f"add a call of {missing} to a file tests/fuzz/calls_*.py, or a reason to NOT_CALLED"
    assert not NOT_CALLED.keys() & called
    assert NOT_CALLED.keys() <= set(public_names())


def test_every_method_of_a_group_is_called(calls: dict[str, Call]) -> None:
    """A new method of groups needs a call too."""
    methods = inspect.getmembers(nh.groups.AbstractMatrixGroup, inspect.isfunction)
    called = {name.split(".")[1] for name in calls if name.startswith("SO(3).")}
    assert {name for name, _ in methods if not name.startswith("_")} <= called


def test_calls_that_go_on_and_on_end(calls: dict[str, Call]) -> None:
    """A million million steps block by block are legal: the first blocks are taken."""
    assert [len(block) for block in calls["iterate [sleigh]"](steps=10**12)][-3:] == [2, 2, 2]


@pytest.mark.parametrize(
    ("argument", "right", "wrong"),
    [
        (kinds.number(1.0), "fraction, -1", "nan, text of a number, datetime64, np.True_, 10**400"),
        (kinds.positive(1.0), "5e-324", "-1"),
        (kinds.count(1), "np.int8", "True, 2.0"),
        (kinds.array(np.eye(3)), "as integers", "masked in part, three of them, one nan, very many of them"),
        (kinds.array(np.eye(3), "batch"), "three of them", "text"),
        (kinds.array(np.eye(3), "rows"), "one row less", "text"),
        (kinds.array(np.ones(2), "stack"), "vector, nan matrix", "one nan"),
        (kinds.array(np.ones(2), "any"), "vector", "nan matrix"),
        (kinds.path("a", none=True), "None", "bytes"),
        (kinds.thing(nh.SO, none=True), "None", "text"),
        (kinds.flag(True), "False", "text"),
    ],
    ids=lambda given: given.kind if isinstance(given, kinds.Argument) else str(given),
)
def test_what_is_legal(argument: kinds.Argument, right: str, wrong: str) -> None:
    """The judge of the fuzzers knows which values may be accepted."""
    for names, expected in ((right, True), (wrong, False)):
        for name in names.split(", "):
            assert kinds.legal(argument, bad.bad_value(name, argument.value)) == expected, name


@pytest.mark.parametrize("value", [np.eye(3), np.zeros((2, 0)), np.array(0.5)], ids=["matrix", "empty", "number"])
def test_every_value_can_be_made(value: np.ndarray) -> None:
    """No value fails while it is made, whatever it is made of."""
    for name in bad.names(value):
        bad.bad_value(name, value)
