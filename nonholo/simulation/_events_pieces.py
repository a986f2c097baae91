"""Stretches of a compiled run that is searched for events at every single step, whatever states it keeps."""

import dataclasses
import operator
from collections.abc import Callable, Iterable, Iterator
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from nonholo import kernels
from nonholo._results import Outcome
from nonholo.io import Plan
from nonholo.orbit import EventLog
from nonholo.simulation._events_scan import Watch, search
from nonholo.simulation._stretch import CompiledRun

KernelRows: TypeAlias = tuple[np.ndarray, np.ndarray, np.ndarray]

PIECE, NUMBERS = 1 << 14, 1 << 20  # at most in a stretch that is searched at once: states, numbers in an array
_SHORT = 256  # steps of the first stretch, which an event may soon end; others are at most as long as all before


class Piece(NamedTuple):
    """A stretch of a watched run.

    Attributes:
        rows: The saved states as the kernel sees them: momenta, charts, poses.
        begun: The step before which the stretch begins.
        done: The last good step.
        outcome: How it ended.
        log: The crossings in it.
    """

    rows: KernelRows
    begun: int
    done: int
    outcome: Outcome
    log: EventLog


def watched_pieces(
    run: CompiledRun, vector: np.ndarray, watch: Watch, plan: Plan, report: Callable[[int], object]
) -> Iterator[Piece]:
    """Go through a compiled run block by block, looking for events at every step; end with the run."""
    for block in range(plan.blocks):
        begin, stop = plan.begin(block), plan.stop(block)
        piece, watch = watched_piece(run, vector, watch, begin, stop, report, opening=block == 0)
        yield piece
        if piece.outcome != Outcome.successful or watch.stopped_by:
            return


def watched_piece(
    run: CompiledRun,
    vector: np.ndarray,
    watch: Watch,
    begun: int,
    stop: int,
    report: Callable[[int], object],
    *,
    opening: bool,
) -> tuple[Piece, Watch]:
    """Go on from step `begun` to step `stop` or to what ends the run; return the stretch, and what is known after it.

    The vector, whose first part is here the row of the state reached, becomes that of the last good step.
    """
    width, fine = sum(run.sizes), dataclasses.replace(run, every=1)
    state = vector[width:]
    last = _each(lambda row: row[None], np.split(vector[:width], np.cumsum(run.sizes)[:-1]))
    first = fine.orbit(last, begun, True, Outcome.successful)
    watch, _ = search(dataclasses.replace(watch, parts=()), first, begun)
    kept, code, done = [_each(operator.itemgetter(slice(0, int(opening))), last)], 0, begun
    while code == 0 and done < stop and watch.stopped_by is None:
        code, seen = _advanced(run, state, last, min(stop - done, max(done, _SHORT)))
        watch, count = search(watch, fine.orbit(seen, done, True, Outcome.successful), done)
        saved = slice(run.every - done % run.every, count, run.every)
        kept.append(_each(operator.itemgetter(saved), seen))
        last, done = _each(operator.itemgetter(slice(count - 1, count)), seen), done + count - 1
        report(done)
    outcome = Outcome.successful if watch.stopped_by else Outcome(code)
    rows = joined_rows(kept)
    vector[:width] = np.concatenate([row[0] for row in last])
    return Piece(rows, begun, done, outcome, watch.log()), watch


def joined_rows(parts: Iterable[KernelRows]) -> KernelRows:
    """Return rows of the kernel one after another."""
    return _each(np.concatenate, zip(*parts, strict=True))


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
