"""One trial of the public API: a call that works, with one or two arguments replaced by values that nobody expects."""

import contextlib
import random
import shutil
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias

import numpy as np
from fuzz import shelf
from fuzz.bad import bad_value, names
from fuzz.calls import Call, all_calls
from fuzz.judge import Verdict, nonfinite, of_exception
from fuzz.kinds import legal, real_array

Trial: TypeAlias = tuple[str, tuple[tuple[str, str], ...]]
"""The name of a call, and the names of changed arguments with those of the values in their place."""

_PAIRS = 0.2  # the share of trials with two changed arguments


def draw(calls: dict[str, Call], count: int, seed: int) -> list[Trial]:
    """Draw trials: each call is as likely as any other, then each of its arguments, then each value."""
    chance = random.Random(seed)  # noqa: S311
    able = [call for call in calls.values() if call.arguments]
    return [_drawn(chance.choice(able), chance) for _ in range(count)]


def _drawn(call: Call, chance: random.Random) -> Trial:
    pair = len(call.arguments) > 1 and chance.random() < _PAIRS
    changed = chance.sample(sorted(call.arguments), 2 if pair else 1)
    return call.name, tuple((name, chance.choice(names(call.arguments[name].value))) for name in changed)


def told(trial: Trial) -> str:
    """Return a trial as a text."""
    return trial[0] + ": " + ", ".join(f"{name} = {value}" for name, value in trial[1])


def from_text(text: str) -> Trial:
    """Return the trial of a text."""
    name, _, changes = text.rpartition(": ")
    pairs = [change.split(" = ", 1) for change in changes.split(", ")]
    return name, tuple((argument, value) for argument, value in pairs)


def prepared() -> Callable[[Trial], Verdict]:
    """Return what does trials; it holds the calls, and stores for those that open some."""
    calls, home = all_calls(), Path(tempfile.mkdtemp(prefix="fuzz-"))
    shelf.fill(home)
    usual: dict[str, set[str]] = {}

    def do(trial: Trial) -> Verdict:
        call = calls[trial[0]]
        with _folder(home if call.stores else None):
            if call.name not in usual:
                usual[call.name] = nonfinite(call())
        with _folder(home if call.stores else None):
            return verdict(call, dict(trial[1]), usual[call.name])

    return do


@contextlib.contextmanager
def _folder(shelf_: Path | None) -> contextlib.AbstractContextManager[None]:
    """Work in a private folder below another one, with the stores if there are some."""
    with tempfile.TemporaryDirectory(prefix="fuzz-") as outside:
        inside = Path(outside) / "in" / "side"
        if shelf_ is None:
            inside.mkdir(parents=True)
        else:
            shutil.copytree(shelf_, inside)
        (inside / "some.txt").write_text("some text")
        with contextlib.chdir(inside):
            yield


def _has_nan(value: object) -> bool:
    result = real_array(value, nan=True)
    return result is not None and bool(np.isnan(result).any())


def verdict(call: Call, changes: dict[str, str], usual: set[str]) -> Verdict:
    """Do a trial and classify what comes of it."""
    changed = {name: bad_value(value, call.arguments[name].value) for name, value in changes.items()}
    illegal = [name for name, value in changed.items() if not legal(call.arguments[name], value)]
    try:
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            strange = nonfinite(call(**changed), infinite=call.infinite) - usual
    except Exception as failure:  # whatever comes is classified
        result = of_exception(failure, list(changes))
        theirs = result.kind == "raw" and not illegal and any(map(callable, changed.values()))
        return Verdict("accepted", "an error of the function that was passed") if theirs else result
    if illegal:
        return Verdict("silent", f"accepted, though {illegal[0]} is not legal")
    if not strange or any(map(_has_nan, changed.values())):
        return Verdict("accepted")
    warned = any(issubclass(warning.category, RuntimeWarning) for warning in said)
    return Verdict("warned" if warned else "silent", f"not finite, though successful: {sorted(strange)}"[:300])
