"""The one loop over the steps of every kind of run, in blocks; and the sinks that keep its orbit in memory."""

import dataclasses
import time
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from nonholo.base.checks import count, error, within_memory
from nonholo.base.progress import progress_bar
from nonholo.base.results import OUTCOMES, Outcome, conclude
from nonholo.discrete import check_first_state
from nonholo.orbit import AbstractOrbit, AbstractStepper, First, Plan, Rows, State, keep_row, write_first
from nonholo.simulation._contact import after_contact
from nonholo.simulation._crossings import check_resets
from nonholo.simulation._search import Watch, piece_of, search

_PIECE, _SHORT = 1 << 20, 256  # steps of a call at most; of the first searched call, which an event may soon end
_AGAIN = 32  # steps of the first searched call after an impact
_NEAR = 1 << 19  # numbers in the rows of a call, which are settled while they are near the processor
_ROWS, _NUMBERS = 1 << 16, 1 << 22  # at most in a block: saved states, numbers in an array
_SOON, _LATE = 0.1, 0.3  # seconds: Ctrl-C waits for a call, whose steps are doubled and halved


Stepper: TypeAlias = AbstractStepper[Any]
Report: TypeAlias = Callable[[int, int], object]
"""Takes how many steps are done, and of how many."""
Searched: TypeAlias = tuple[State, int, int, Watch]
"""The state after the last good step, how many steps were good, the outcome, and what was seen."""


class Run(NamedTuple):
    """The motion of a run and its options.

    Attributes:
        stepper: The stepper that takes its steps.
        steps: Steps in total.
        every: Steps between saved states.
        watch: Its search for events; None without.
        throw: Whether a run that cannot continue raises.
        progress: Whether a progress bar is shown.
    """

    stepper: Stepper
    steps: int
    every: int
    watch: Watch | None
    throw: bool
    progress: bool

    def plan(self, rows: int) -> Plan:
        """Return how the run is cut into blocks of this many saved states."""
        return Plan(self.steps, self.every, rows, self.stepper.lead)

    def finish(self, orbit: Any, step: int) -> Any:
        """Return the orbit of the run, or raise if it ended early."""
        return conclude(orbit, float(self.stepper.motion.time_step), step, self.steps, self.throw)


class Reached(NamedTuple):
    """The state of a run between two blocks: good steps, the outcome so far, the state, what was seen of events."""

    step: int
    outcome: Outcome
    state: State
    watch: Watch | None

    @property
    def is_last(self) -> bool:
        """Whether the run ended here: it cannot continue, or an event ended it."""
        return self.outcome != Outcome.successful or (self.watch is not None and self.watch.stopped_by is not None)


def open_run(run: Run, first: First) -> tuple[Reached, AbstractOrbit | None]:
    """Begin a run; return how it stands at its start, and the empty orbit of one that cannot continue from there."""
    state, outcome = run.stepper.start(first)
    start = Reached(0, outcome, state, run.watch)
    if not outcome and first.demand is None and run.watch is None:
        return start, None
    there = orbit_at(run.stepper, state, 0)
    if outcome != Outcome.successful:
        there = dataclasses.replace(there.chosen(slice(0, 0)), outcome=outcome)
    if run.watch is not None:
        watch, _ = search(run.watch, there)
        check_resets(run.watch.events, there)
        start, there = start._replace(watch=watch), dataclasses.replace(there, events=watch.log())
    if outcome == Outcome.successful and first.demand is not None:
        check_first_state(first.demand, there)
    return start, None if outcome == Outcome.successful else run.finish(there, 0)


def orbit_at(stepper: Stepper, state: State, step: int) -> Any:
    """Return the row of a state as an orbit."""
    rows = empty_rows(stepper, 1)
    write_first(state, rows)
    return _states(stepper, rows, step)


def _states(stepper: Stepper, rows: Rows, step: int) -> Any:
    """Return rows of single steps as an orbit."""
    outcome = stepper.settle(rows)
    return stepper.orbit(_certain_rows(stepper, rows), step, 1, outcome)


def empty_rows(stepper: Stepper, places: int) -> Rows:
    """Return rows to be written, each column in separate memory: an orbit keeps its columns alone."""
    return tuple([np.empty((places, width)) for width in stepper.columns.values()])


def part_of(rows: Rows, begin: int, end: int) -> Rows:
    """Return the places of rows from one to another."""
    return rows if begin == 0 and end >= len(rows[0]) else tuple([column[begin:end] for column in rows])


def _certain_rows(stepper: Stepper, rows: Rows) -> Rows:
    """Return rows without what belongs to the step ahead of the last one, which may not be taken."""
    return rows if stepper.lead else (*rows[:-1], rows[-1][:-1])


class _Table:
    """The rows of a block: where the steps of a call are written, and which of them are kept."""

    outcome = Outcome.successful

    def __init__(self, stepper: Stepper, plan: Plan, number: int, *, fine: bool) -> None:
        self.stepper, self.every, self.fine = stepper, plan.every, fine
        self.number, self.begin, self.stop, self.ends = number, *plan.stretch(number)
        self.places = 1 + (self.stop - self.begin) // self.every
        self.rows = empty_rows(stepper, 1 if fine else self.places)  # an event may stop the run long before
        self.fresh, self.least = 0, _SHORT  # where steps of searched calls begin to double, and from how many on

    def room(self, step: int, pace: int) -> tuple[int, int, Rows]:
        """Return how many steps to take from a step, after how many of them a row is written, and where.

        Whole rows are written in place. A part of a row is written beside them, and so are single steps, each of which
        is checked: for events, and on a group that poses leave by rounding.
        """
        past = (step - self.begin) % self.every
        most = min(max(step - self.fresh, self.least) if self.fine else pace, self.stop - step)
        if self.fine:
            each, count = 1, min(most, piece_of(self.stepper.columns.values()))
            if (places := 1 + (step - self.begin + count) // self.every) > (have := len(self.rows[0])):
                longer = empty_rows(self.stepper, min(self.places, max(places, 2 * have)))
                for column, old in zip(longer, self.rows, strict=True):
                    column[:have] = old
                self.rows = longer
        elif past == 0 and most >= self.every:
            each, count = self.every, min(most // self.every, 1 + _NEAR // self.stepper.width)
        else:
            each, count = min(most, self.every - past), 1
        if each != self.every:
            return each * count, each, empty_rows(self.stepper, 1 + count)
        first = (step - self.begin) // each
        return each * count, each, part_of(self.rows, first, first + count + 1)

    def take(self, room: Rows, step: int, good: int, each: int) -> None:
        """Keep the saved states among the rows of a call, if they are not in place; settle them while they are near."""
        begin, end = step - self.begin, step - self.begin + good
        if each != self.every:
            past = begin + each * np.arange(1 + good // each)
            at = np.flatnonzero(past % self.every == 0)
            for column, new in zip(self.rows, room, strict=True):
                column[past[at] // self.every] = new[at]
        rows = part_of(self.rows, -(-begin // self.every), 1 + end // self.every)
        self.outcome = self.stepper.settle(rows) or self.outcome


def blocks(
    run: Run, plan: Plan, start: Reached, report: Report, look_up: Callable[[int], Reached | None] = lambda _: None
) -> Iterator[tuple[int, Any, Reached]]:
    """Give the blocks of a run in order, up to the one that ends it; nothing of those that are known is computed.

    Each is its number, its orbit (None if it was known), and how the run stands at its end.
    """
    for number in range(plan.blocks):
        orbit, there = None, look_up(number)
        if there is None:
            orbit, there = compute_block(run.stepper, plan, number, start, report)
        else:
            report(there.step, plan.steps)
        yield number, orbit, there
        if (start := there).is_last:
            return


def compute_block(stepper: Stepper, plan: Plan, number: int, start: Reached, report: Report) -> tuple[Any, Reached]:
    """Take the steps of a block: the only loop over steps."""
    table, watch = _Table(stepper, plan, number, fine=start.watch is not None or stepper.has_drift), start.watch
    state, step, code, pace = start.state, table.begin, 0, stepper.pace
    if watch is not None:  # a block without steps has a log too
        watch, _ = search(dataclasses.replace(watch, parts=()), orbit_at(stepper, state, step))
    over = watch is not None and watch.stopped_by is not None
    while code == 0 and step < table.stop and not over:
        since = time.monotonic()
        steps, each, room = table.room(step, pace)
        if watch is None:
            state, good, code = _advance(stepper, state, steps, each, room)
        else:
            state, good, code, watch = _watch_steps(stepper, watch, state, (step, steps), room)
            over = watch.stopped_by is not None
            if good < steps:  # up to an impact
                table.fresh, table.least = step + good, _AGAIN
        table.take(room, step, good, each)
        step += good
        report(step, plan.steps)
        pace = _pace(pace, time.monotonic() - since)
    standing = Reached(step, Outcome.successful if over else OUTCOMES[code], state, watch)
    return _orbit_of(stepper, table, plan, standing), standing


def _watch_steps(stepper: Stepper, watch: Watch, state: State, stretch: tuple[int, int], room: Rows) -> Searched:
    """Take single steps up to an event that ends the motion, or through the step with an impact; search them."""
    step, steps = stretch
    if watch.is_at_wall:
        write_first(state, room)
        return _through(stepper, watch, state, step, room)
    state, good, code = _advance(stepper, state, steps, 1, room)
    rows = tuple([column[: 1 + good].copy() for column in room])
    watch, states = search(watch, _states(stepper, rows, step))
    if watch.reset_by is not None:
        return _through(stepper, watch, state, step, room)
    if watch.stopped_by is not None:
        keep_row(state, room, states - 1)
    return state, states - 1, code, watch


def _through(stepper: Stepper, watch: Watch, state: State, step: int, room: Rows) -> Searched:
    """Take the step from a node at a wall, or the part that is left of the step with the impact that was seen last."""
    node, good = state.copy(), 0 if watch.reset_by is None else watch.cut - step
    keep_row(node, room, good)
    there = orbit_at(stepper, node, step + good)
    after, watch, outcome = after_contact(lambda states: stepper.start(states.as_start()), watch, there)
    if after is None:
        return node, good, outcome, watch
    write_first(after, part_of(room, good + 1, good + 2))
    return after, good + 1, outcome, watch


def _advance(stepper: Stepper, state: State, steps: int, each: int, room: Rows) -> tuple[State, int, int]:
    """Return the state after the last good step, how many steps were good, and the outcome.

    No good step leads to a row whose pose has left its group. Where poses may, each step has a row.
    """
    after = state.copy()
    good, code = stepper.advance(after, steps, each, room)
    last = max(1, stepper.states_on_group(part_of(room, 0, 1 + good))) - 1 if stepper.has_drift else good
    has_left = last < good
    if has_left:
        good, code = last, Outcome.nonfinite
    if good % each or has_left:  # no row stands there
        after = state.copy()
        if good:
            stepper.advance(after, good, good, empty_rows(stepper, 2))
    return after, good, code


def _orbit_of(stepper: Stepper, table: _Table, plan: Plan, standing: Reached) -> Any:
    """Return the saved states of a block as an orbit."""
    last, ends = (standing.step - table.begin) // plan.every, table.ends or standing.is_last
    first = int(stepper.lead == 1 and table.number > 0)
    if standing.step == table.begin:  # no step was taken
        write_first(standing.state, table.rows)
        table.take(table.rows, standing.step, 0, plan.every)
    rows = part_of(table.rows, first, last + (stepper.lead or ends))
    rows = _certain_rows(stepper, rows) if ends else rows
    orbit = stepper.orbit(rows, table.begin + first * plan.every, plan.every, standing.outcome or table.outcome)
    return orbit if standing.watch is None else dataclasses.replace(orbit, events=standing.watch.log())


def _pace(pace: int, seconds: float) -> int:
    """Return how many steps to take next, after that many took so long."""
    if seconds < _SOON:
        return min(2 * pace, _PIECE)
    return max(1, pace // 2) if seconds > _LATE else pace


def run_to_end(run: Run, first: First, *, whole: bool) -> tuple[Any, int]:
    """Run in memory; return the saved states, or the last good one alone, as an orbit, and the good steps."""
    start, orbit = open_run(run, first)
    if orbit is not None:
        return orbit, 0
    with progress_bar("steps", run.progress) as report:
        orbit, standing = compute_block(run.stepper, run.plan(1 + run.steps // run.every), 0, start, report)
    if whole:
        return orbit, standing.step
    last = orbit_at(run.stepper, standing.state, standing.step)
    return dataclasses.replace(last, outcome=orbit.outcome, events=orbit.events), standing.step


def one_by_one(run: Run, first: First, rows: int) -> Iterator[Any]:
    """Begin a run, before its first block; return the iterator over the orbits of its blocks."""
    start, empty = open_run(run, first)
    return iter((empty,)) if empty is not None else _orbits(run, start, rows)


def _orbits(run: Run, start: Reached, rows: int) -> Iterator[Any]:
    with progress_bar("steps", run.progress) as report:
        for _, orbit, standing in blocks(run, run.plan(rows), start, report):
            if len(orbit) or not (run.throw and orbit.outcome):  # an event may end it before the first state of a block
                yield orbit
            run.finish(orbit, standing.step)


def rows_of_block(where: str, run: Run, block_steps: int | None) -> int:
    """Return the number of saved states in a block of this many steps; by default blocks of a few megabytes."""
    if block_steps is None:
        widest = max(1, *run.stepper.columns.values())
        least = min(1 + run.steps // run.every, _ROWS, _NUMBERS // widest, run.stepper.block // run.every)
        return max(1, least)
    steps = count(where, block_steps, "Pass the number of steps.")
    if steps % run.every:
        remedy = f"Pass {-(-steps // run.every) * run.every}."
        raise error(where, f"be a multiple of save_every = {run.every}", str(steps), remedy)
    within_memory(where, 16.0 * (steps // run.every) * run.stepper.width, "Pass fewer steps: a block is held whole.")
    return steps // run.every
