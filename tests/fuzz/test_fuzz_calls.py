"""The table of calls is whole: every public name is in it, and its calls work."""

import inspect

import numpy as np
import pytest
from fuzz import bad, kinds
from fuzz.calls import NOT_CALLED, Call, all_calls, is_picture, public_names

import nonholo as nh


@pytest.fixture(name="calls", scope="module")
def _calls() -> dict[str, Call]:
    return all_calls()


def test_every_public_name_is_called(calls: dict[str, Call]) -> None:
    """A new public name needs a call, or a reason why there is none."""
    called = {name.split(" [")[0] for name in calls}
    missing = [name for name in public_names() if name not in called | NOT_CALLED.keys() and not is_picture(name)]
    assert not missing
    assert not NOT_CALLED.keys() & called
    assert NOT_CALLED.keys() <= set(public_names())


def test_every_method_of_a_group_is_called(calls: dict[str, Call]) -> None:
    """A new method of groups needs a call too."""
    methods = inspect.getmembers(nh.groups.AbstractMatrixGroup, inspect.isfunction)
    called = {name.split(".")[1] for name in calls if name.startswith("SO(3).")}
    assert {name for name, _ in methods if not name.startswith("_")} <= called


def test_calls_work(calls: dict[str, Call]) -> None:
    """Nothing fails as long as nothing is changed; calls that compile or need stores run in the profile."""
    for call in calls.values():
        if not (call.slow or call.stores or call.name.startswith(_LONG)) and "path" not in _kinds_of(call):
            call()


def test_calls_that_go_on_and_on_end(calls: dict[str, Call]) -> None:
    """A million million steps block by block are legal: the first blocks are taken."""
    assert [len(block) for block in calls["iterate [sleigh]"](steps=10**12)][-3:] == [2, 2, 2]


_LONG = ("flow", "ensemble", "simulate", "iterate", "invariants", "LagrangeDAlembert")


def _kinds_of(call: Call) -> set[str]:
    return {argument.kind for argument in call.arguments.values()}


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
