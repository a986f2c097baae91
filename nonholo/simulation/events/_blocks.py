"""Blocks of a compiled run; one with events is searched at every single step, whatever states it keeps."""

import dataclasses
import operator
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np

from nonholo.base.results import Outcome
from nonholo.io import Plan
from nonholo.simulation.events._search import Watch, search
from nonholo.simulation.runs import CompiledRun, Rows, RunState

PIECE, NUMBERS = 1 << 14, 1 << 20  # at most in a stretch that is searched at once: states, numbers in an array
_SHORT = 256  # steps of the first stretch, which an event may soon end; others are at most as long as all before


def searched_first(watch: Watch | None, first: Any) -> tuple[Any, Watch | None]:
    """Return the first state of a run with what was found there if there is a watch, and what is known then."""
    if watch is None:
        return first, None
    found, _ = search(watch, first)
    return dataclasses.replace(first, events=found.log()), found


class Block(NamedTuple):
    """A computed block: its orbit, the state and step of the last good one, and what is known of the events then."""

    orbit: Any
    state: Any
    done: int
    watch: Watch | None


def computed_block(
    run: Any, state: Any, watch: Watch | None, plan: Plan, block: int, report: Callable[[int], object]
) -> Block:
    """Compute a block of any run, to its end or to what ends the run, looking for events if there is a watch."""
    if watch is not None:
        return _searched_block(run, state, watch, plan, block, report)
    orbit, reached, done = run.stretch(state, plan, block, report)
    return Block(orbit, reached, done, None)


def _searched_block(
    run: CompiledRun, state: RunState, watch: Watch, plan: Plan, block: int, report: Callable[[int], object]
) -> Block:
    begun, stop, opening, fine = plan.begin(block), plan.stop(block), block == 0, dataclasses.replace(run, every=1)
    kernel, last = state.kernel.copy(), _each(lambda row: row[None], state.row)
    watch, _ = search(dataclasses.replace(watch, parts=()), fine.orbit(last, begun, True, Outcome.successful))
    kept, code, done = [_each(operator.itemgetter(slice(0, int(opening))), last)], 0, begun
    while code == 0 and done < stop and watch.stopped_by is None:
        code, seen = _advanced(run, kernel, last, min(stop - done, max(done, _SHORT)))
        watch, count = search(watch, fine.orbit(seen, done, True, Outcome.successful))
        saved = slice(run.every - done % run.every, count, run.every)
        kept.append(_each(lambda rows, saved=saved: rows[saved].copy(), seen))  # a view would hold every state
        last, done = _each(operator.itemgetter(slice(count - 1, count)), seen), done + count - 1
        report(done)
    outcome = Outcome.successful if watch.stopped_by else Outcome(code)
    orbit = run.orbit(_each(np.concatenate, zip(*kept, strict=True)), begun, opening, outcome)
    reached = RunState(_each(lambda row: row[0].copy(), last), kernel)
    return Block(dataclasses.replace(orbit, events=watch.log()), reached, done, watch)


def _advanced(run: CompiledRun, kernel: np.ndarray, last: Rows, most: int) -> tuple[int, Rows]:
    """Take steps with the state of a kernel; return the outcome, and the rows from the last one on."""
    size = min(max(1, min(PIECE, NUMBERS // max(1, *run.sizes))), most)
    rows = _each(lambda row: np.concatenate((row, np.empty((size, row.shape[1])))), last)
    good, code = run.route.advance(kernel, size, 1, _each(operator.itemgetter(slice(1, None)), rows))
    return code, _each(operator.itemgetter(slice(0, 1 + good)), rows)


def _each(function: Callable[[Any], np.ndarray], rows: Iterable[Any]) -> Rows:
    """Apply a function to momenta, charts and poses."""
    momenta, charts, poses = map(function, rows)
    return momenta, charts, poses
