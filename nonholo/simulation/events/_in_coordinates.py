"""Runs in coordinates that look for events: at every single step, whatever states they keep."""

import dataclasses
from collections.abc import Iterator
from typing import Any, NamedTuple

from nonholo.base.checks import error, step_counts
from nonholo.base.results import Outcome, finished
from nonholo.simulation.events._event import checked_events
from nonholo.simulation.events._search import Watch, search
from nonholo.systems import AbstractCoordinateDiscretization

_FEW, _MOST = 64, 4096  # single steps that are searched at once


def simulated(discrete: AbstractCoordinateDiscretization, events: Any, **run: Any) -> Any:
    """Run a map in coordinates from a start; return its orbit with what was found, if there are events."""
    if events is None:
        return discrete.simulate(**run)
    (orbit,) = blocks_with_events(discrete, watched_in_coordinates("simulate", discrete, events), None, **run)
    return orbit


def iterated(discrete: AbstractCoordinateDiscretization, events: Any, block_steps: Any, **run: Any) -> Iterator[Any]:
    """Check and open a run in coordinates; return an iterator over its blocks, as `simulated` whole."""
    if events is None:
        return discrete.iterate(block_steps=block_steps, **run)
    watch = watched_in_coordinates("iterate", discrete, events)
    _, every = step_counts(run["steps"], run["save_every"])
    rows = discrete.rows_of_block(block_steps, every)
    return blocks_with_events(discrete, watch, rows * every, **run)


def watched_in_coordinates(owner: str, discrete: AbstractCoordinateDiscretization, events: Any) -> Watch:
    """Return what a run looks for, refused where parts of a step are not defined."""
    named = checked_events(owner, events)
    if not discrete.system.has_parts:
        got = "a table of forces, or discrete functions without a time step"
        remedy = "Pass functions that take the time or the time step, or look for changes of sign yourself."
        raise error(f"{owner}(events=...)", "have parts of a step", got, remedy)
    return Watch(named, discrete.after_parts)


def blocks_with_events(
    discrete: AbstractCoordinateDiscretization,
    watch: Watch,
    block_steps: int | None,
    *,
    steps: Any,
    save_every: Any,
    throw: bool,
    **run: Any,
) -> Iterator[Any]:
    """Check and open a run, and return an iterator over its blocks with what was found in each; None is one block."""
    steps, every = step_counts(steps, save_every)
    size = _MOST if block_steps is None else _divisor(block_steps)
    single = discrete.iterate(steps=steps, block_steps=size, save_every=1, throw=False, **run)
    pieces = steps if block_steps is None else block_steps // size  # of a block
    return _blocks(discrete, _searched(watch, single, steps, every, pieces), steps, throw)


def _divisor(steps: int) -> int:
    """Return the length of pieces into which a block can be cut; of no good length is its own."""
    most = max(size for size in range(1, min(steps, _MOST) + 1) if steps % size == 0)
    return most if most >= _FEW else steps


class _Piece(NamedTuple):
    """What is kept of a piece of a run: states, the last good step, what was found in this block, what ends here."""

    states: Any
    done: int
    watch: Watch
    ends_block: bool
    ends_run: bool


def _searched(watch: Watch, single: Iterator[Any], steps: int, every: int, pieces: int) -> Iterator[_Piece]:
    """Search pieces of single steps, and keep every n-th state."""
    last, done = None, 0
    for number, piece in enumerate(single, 1):
        seen = piece if last is None else last.joined([piece])
        watch, count = search(watch, seen)
        new = 0 if last is None else 1  # where states begin that were not seen before
        outcome = Outcome.successful if watch.stopped_by else piece.outcome
        kept = seen.chosen(slice(new + -(done + new) % every, count, every))
        last, done = seen.chosen(slice(max(count, 1) - 1, count)), done + max(count, 1) - 1
        ends = watch.stopped_by is not None or outcome != Outcome.successful or done == steps
        block = number % pieces == 0
        yield _Piece(dataclasses.replace(kept, outcome=outcome, save_every=every), done, watch, block or ends, ends)
        if ends:
            return
        watch = dataclasses.replace(watch, parts=()) if block else watch


def _blocks(
    discrete: AbstractCoordinateDiscretization, pieces: Iterator[_Piece], steps: int, throw: bool
) -> Iterator[Any]:
    """Join pieces to blocks; the impulse after the last state of the run belongs to none of its steps."""
    kept = []
    for piece in pieces:
        kept.append(piece.states)
        if not piece.ends_block:
            continue
        orbit = kept[0].joined(kept[1:])
        known = max(len(orbit) - 1, 0) if piece.ends_run else None
        orbit = dataclasses.replace(
            orbit, multipliers=orbit.multipliers[:known], outcome=piece.states.outcome, events=piece.watch.log()
        )
        if len(orbit) or (piece.ends_run and not throw):
            yield orbit
        finished(orbit, discrete.time_step, piece.done, steps, throw)
        kept = []
