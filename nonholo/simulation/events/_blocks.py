"""Blocks of a compiled run; one with events is searched at every single step, whatever states it keeps."""

import dataclasses
import operator
from collections.abc import Callable, Iterable
from typing import Any, TypeAlias

import numpy as np

from nonholo import kernels
from nonholo._results import Outcome
from nonholo.io import Plan
from nonholo.orbit import Orbit
from nonholo.simulation.events._search import Watch, search
from nonholo.simulation.runs import CompiledRun

KernelRows: TypeAlias = tuple[np.ndarray, np.ndarray, np.ndarray]

PIECE, NUMBERS = 1 << 14, 1 << 20  # at most in a stretch that is searched at once: states, numbers in an array
_SHORT = 256  # steps of the first stretch, which an event may soon end; others are at most as long as all before


def searched_first(watch: Watch | None, first: Orbit) -> tuple[Orbit, Watch | None]:
    """Return the first state of a run with what was found there if there is a watch, and what is known then."""
    if watch is None:
        return first, None
    found, _ = search(watch, first, 0)
    return dataclasses.replace(first, events=found.log()), found


def stretch_of(
    run: CompiledRun, vector: np.ndarray, watch: Watch | None, plan: Plan, block: int, report: Callable[[int], object]
) -> tuple[Orbit, int, Watch | None]:
    """Compute a block of a run, to its end or to what ends the run, looking for events if there is a watch.

    The vector becomes that of the last good step.

    Returns:
        The states of the block, the last good step, and what is known of the events then.
    """
    begun, stop, opening = plan.begin(block), plan.stop(block), block == 0
    if watch is None:
        return *run.stretch(vector, begun, stop, report, opening=opening), None
    width, fine = sum(run.sizes), dataclasses.replace(run, every=1)
    state = vector[width:]  # before it is, with events, the row of the state reached: the last one that was searched
    last = _each(lambda row: row[None], np.split(vector[:width], np.cumsum(run.sizes)[:-1]))
    first = fine.orbit(last, begun, True, Outcome.successful)
    watch, _ = search(dataclasses.replace(watch, parts=()), first, begun)
    kept, code, done = [_each(operator.itemgetter(slice(0, int(opening))), last)], 0, begun
    while code == 0 and done < stop and watch.stopped_by is None:
        code, seen = _advanced(run, state, last, min(stop - done, max(done, _SHORT)))
        watch, count = search(watch, fine.orbit(seen, done, True, Outcome.successful), done)
        saved = slice(run.every - done % run.every, count, run.every)
        kept.append(_each(lambda rows, saved=saved: rows[saved].copy(), seen))  # a view would hold every state
        last, done = _each(operator.itemgetter(slice(count - 1, count)), seen), done + count - 1
        report(done)
    outcome = Outcome.successful if watch.stopped_by else Outcome(code)
    orbit = run.orbit(_each(np.concatenate, zip(*kept, strict=True)), begun, opening, outcome)
    vector[:width] = np.concatenate([row[0] for row in last])
    return dataclasses.replace(orbit, events=watch.log()), done, watch


def _advanced(run: CompiledRun, state: np.ndarray, last: KernelRows, most: int) -> tuple[int, KernelRows]:
    """Take steps with the state of a kernel; return the outcome, and the rows from the last one on."""
    size = min(max(1, min(PIECE, NUMBERS // max(1, *run.sizes))), most)
    rows = _each(lambda row: np.concatenate((row, np.empty((size, row.shape[1])))), last)
    good, code = kernels.advance(run.closed.body, state, size, 1, _each(operator.itemgetter(slice(1, None)), rows))
    return code, _each(operator.itemgetter(slice(0, 1 + good)), rows)


def _each(function: Callable[[Any], np.ndarray], rows: Iterable[Any]) -> KernelRows:
    """Apply a function to momenta, charts and poses."""
    momenta, charts, poses = map(function, rows)
    return momenta, charts, poses
