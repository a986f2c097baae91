"""What a user holds can be pickled, copied and sent to another process, before and after it has computed things."""

import concurrent.futures
import contextlib
import copy
import dataclasses
import doctest
import functools
import inspect
import io
import multiprocessing
import operator
import pickle
import types
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

import nonholo as nh

TENSOR = [[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]
WITH_A_FUNCTION = {  # of the user's, which the examples define where they stand
    "Event": "east",
    "GroupLagrangeDAlembert": "orbit sleigh",
    "Impact": "wall",
    "LagrangeDAlembert": "discrete orbit particle pendulum swing",
    "LagrangeDAlembert.regularity": "free",
    "AbstractParametricSystem.with_parameters": "heavy orbit spring",
    "ShapedBody": "body",
    "equilibria": "pendulum",
    "linearize": "pendulum",
    "plot.section": "level",
}
REFUSED = {f"{example}: {name}" for example, names in WITH_A_FUNCTION.items() for name in names.split()}


VALUES = str, bytes, complex, float, int, set, frozenset, range, Fraction, Path


def foreign(thing: Any) -> bool:
    """Tell whether an object is of another library, whose state may have addresses in it: of matplotlib, numba."""
    return not type(thing).__module__.startswith("nonholo") or isinstance(thing, Figure)


def same(one: Any, other: Any, records: frozenset[int] = frozenset()) -> bool:
    """Tell whether two objects have the same fields, arrays to the last bit, or are of one kind of another library."""
    if id(one) in records or one is other:
        return True
    if type(one) is not type(other):
        return False
    records |= {id(one)}
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(same(value, other[name], records) for name, value in one.items())
    if isinstance(one, list | tuple):
        return len(one) == len(other) and all(
            same(ours, theirs, records) for ours, theirs in zip(one, other, strict=True)
        )
    if dataclasses.is_dataclass(one):
        names = {x.name for x in dataclasses.fields(one)} - {"minimum"}  # functions of a fit, which it says it loses
        return all(same(getattr(one, name), getattr(other, name), records) for name in names)
    if isinstance(one, functools.partial):
        return same([one.func, one.args, one.keywords], [other.func, other.args, other.keywords], records)
    if hasattr(one, "identical"):  # a dataset
        return bool(one.identical(other))
    if hasattr(one, "__array__"):
        ours, theirs = np.asarray(one), np.asarray(other)
        return ours.dtype == theirs.dtype and ours.tobytes() == theirs.tobytes()
    if isinstance(one, VALUES):
        return bool(one == other)
    return foreign(one) or same(getattr(one, "__dict__", {}), getattr(other, "__dict__", {}), records)


def computed(thing: Any, records: set[int]) -> list[str]:
    """Return what an object and its fields hold beside their own fields: what was computed and kept."""
    if id(thing) in records or isinstance(thing, type) or not type(thing).__module__.startswith("nonholo"):
        return []
    records.add(id(thing))
    kind, own = type(thing), dict(getattr(thing, "__dict__", {}))
    if "recipe" in own:
        return []  # made once, by a function of the library that remembers it
    bad = [name for name in own if "." in name or isinstance(getattr(kind, name, None), functools.cached_property)]
    return bad + [name for value in own.values() for name in computed(value, records)]


def sent_back(things: list[Any]) -> list[Any]:
    """Send objects to one new process and return what it sends back."""
    context = multiprocessing.get_context("spawn")
    with concurrent.futures.ProcessPoolExecutor(1, mp_context=context) as pool:
        return list(pool.map(operator.itemgetter(0), [(thing,) for thing in things]))


def used() -> dict[str, Any]:
    """Return objects of every kind that is cheap, each after a run, so that routes and numbers are kept."""
    top, sleigh = nh.SuslovTop(TENSOR), nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.2)
    discrete, wide = nh.discretize(top, 0.5), nh.discretize(nh.SuslovTop(np.diag([1.0, 2.0, 3.0, 4.0])), 0.1)
    heavy = nh.Forced(top, nh.Gravity([0.0, 0.0, -1.0], point=[0.1, 0.2, 0.3]))
    slipping = nh.Forced(sleigh, force=nh.Slip(sleigh.annihilator, 0.3))
    result = {
        "top": nh.simulate(discrete, restricted_velocity=(0.1, 0.2), steps=5),
        "sleigh": nh.simulate(nh.discretize(sleigh, 0.1), restricted_velocity=(0.1, 0.2), steps=5),
        "SO(4)": nh.simulate(wide, restricted_velocity=(0.1, 0.2, 0.3), steps=5),
        "ensemble": nh.ensemble(discrete, restricted_velocity=[[0.1, 0.2], [0.2, 0.1]], steps=5),
        "flow": nh.flow(sleigh, restricted_velocity=(0.1, 0.2), times=(0.0, 1.0)),
        "flow that slips": nh.flow(slipping, body_velocity=(0.1, 0.2, 0.3), times=(0.0, 1.0)),
        "forced": nh.simulate(nh.discretize(heavy, 0.1), restricted_velocity=(0.1, 0.2), steps=5),
    }
    for orbit in result.values():
        assert orbit.momentum.size  # decoding keeps numbers too
    return result | {"discretization": discrete, "example": nh.examples.snakeboard()}


def test_what_was_used_is_pickled_without_what_it_keeps() -> None:
    """Pickles, deep copies and what another process sends back have the fields of the object, and nothing else."""
    things = used()
    for name, back in zip(things, sent_back(list(things.values())), strict=True):
        for other in (back, copy.deepcopy(things[name]), pickle.loads(pickle.dumps(things[name]))):  # noqa: S301
            assert computed(other, set()) == [], name
            assert same(things[name], other), name
    assert computed(things["top"], set()) != []


def test_what_calls_a_function_of_a_script_names_it() -> None:
    """The error of what cannot be pickled says which function has no module."""
    heavy = nh.Forced(nh.SuslovTop(TENSOR), lambda g: g[2, 2])
    with pytest.raises((pickle.PicklingError, AttributeError), match="<lambda>"):
        pickle.dumps(nh.discretize(heavy, 0.1))


def examples() -> Iterator[doctest.DocTest]:
    """Yield the examples of every public name, its methods too, also those of a class below it."""
    finder, names = doctest.DocTestFinder(), {name: getattr(nh, name) for name in dir(nh)}
    rooms = {name: thing for name, thing in names.items() if inspect.ismodule(thing)}
    public = {f"{room}.{name}": getattr(rooms[room], name) for room in rooms for name in rooms[room].__all__}
    met = set()
    for name, thing in (names | public).items():
        if not inspect.isclass(thing) and not inspect.isfunction(thing):
            continue
        classes = inspect.getmro(thing)[1:] if inspect.isclass(thing) else ()
        owners = {name: thing} | {each.__name__: each for each in classes if each.__module__.startswith("nonholo")}
        for own, each in owners.items():
            module = inspect.getmodule(each)
            for test in finder.find(each, own, globs={**vars(module), **names, "np": np, "nh": nh}):
                if test.examples and test.docstring not in met:
                    met.add(test.docstring)
                    yield test


def results(test: doctest.DocTest, request: pytest.FixtureRequest) -> dict[str, Any]:
    """Run an example and return the values of its expressions and names."""
    test.globs["getfixture"] = request.getfixturevalue
    before, result = dict(test.globs), {}
    for example in test.examples:
        if example.options.get(doctest.SKIP):
            continue
        refused = contextlib.suppress(Exception) if example.exc_msg else contextlib.nullcontext()
        with refused, contextlib.redirect_stdout(io.StringIO()):
            try:
                code = compile(example.source.strip(), test.name, "eval")
            except SyntaxError:
                exec(example.source, test.globs)  # noqa: S102
            else:
                result[example.source.strip()] = eval(code, test.globs)  # noqa: S307
    return result | {name: value for name, value in test.globs.items() if before.get(name, result) is not value}


def plain(thing: Any) -> bool:
    """Tell whether nothing of the library, and nothing but functions and pictures of others, is in an object."""
    if isinstance(thing, list | tuple):
        return all(map(plain, thing))
    ours = any(kind.__module__.startswith(("nonholo", "numpy", "xarray")) for kind in type(thing).__mro__)
    return not ours or isinstance(thing, type | types.FunctionType | types.ModuleType | types.BuiltinFunctionType)


@pytest.mark.profile("faults", instead="test_what_was_used_is_pickled_without_what_it_keeps")
def test_every_result_of_every_example(
    request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Results of all examples of public names are pickled, copied and sent by "spawn"; those with functions say so."""
    monkeypatch.chdir(tmp_path)
    named = {f"{test.name}: {what}": value for test in examples() for what, value in results(test, request).items()}
    things = {name: value for name, value in named.items() if not plain(value)}
    refused = {name for name in things if name in REFUSED}
    for name in refused:
        with pytest.raises((pickle.PicklingError, AttributeError), match=r"<lambda>|forms|lagrangian|action|energy"):
            pickle.dumps(things[name])
    whole = {name: value for name, value in things.items() if name not in refused}
    failures = {}
    for name, value in list(whole.items()):
        try:
            back = pickle.loads(pickle.dumps(value))  # noqa: S301
        except Exception as failure:
            failures[name] = repr(failure)
            del whole[name]
            continue
        for other in (back, copy.deepcopy(value)):
            if computed(other, set()) or not same(value, other):
                failures[name] = "another"
    others = sent_back(list(whole.values()))
    failures |= {name: "sent" for name, other in zip(whole, others, strict=True) if not same(whole[name], other)}
    print(f"{len(whole)} results, {len(refused)} with functions")  # noqa: T201
    assert not failures, "; ".join(f"{name} ({why})" for name, why in failures.items())
    assert refused == REFUSED
    assert len(whole) > 200
