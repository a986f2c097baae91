"""Runs that are written to a store block by block, in bounded memory, and can stop at any moment."""

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nonholo import io
from nonholo.base.checks import count, error, shown
from nonholo.base.limits import within_disk, within_memory
from nonholo.base.progress import progress_bar
from nonholo.base.results import Outcome, finished
from nonholo.discrete import PRINCIPAL, BranchRule, Discretization
from nonholo.io import Checkpoint, Plan
from nonholo.orbit import AbstractMotion
from nonholo.simulation.events import Watch, computed_block, searched_first
from nonholo.simulation.runs import CompiledRun
from nonholo.simulation.stores._stored_events import descriptions, seen_by, watch_at_checkpoint

if TYPE_CHECKING:
    from nonholo.io import Stream

_ROWS, _NUMBERS = 1 << 16, 1 << 22  # at most in a block: states, numbers in an array
_LOADED = 1 << 27  # numbers of an orbit that is returned whole, 1 GiB


def run_into_store(
    run: Any,
    opened: Callable[[], tuple[Any, Any]],
    steps: int,
    store: Path,
    watch: Watch | None,
    *,
    checkpoint_every: int | None,
    scenario: str | None,
    throw: bool,
    progress: bool,
) -> Any:
    """Run into a new store, looking for events if there is a watch; return the orbit.

    Args:
        run: A `CompiledRun`, or the run of a system in coordinates.
        opened: Returns the run at its start, and its empty orbit (or raises) if it cannot continue from there.
        steps: Steps in total.
        store: Where to.
        watch: What is looked for.
        checkpoint_every: Steps of a block.
        scenario: A text for the store.
        throw: Whether a run that cannot continue raises.
        progress: Whether a progress bar is shown.
    """
    io.check_target(store, new="simulate(store=...)")
    rows = rows_of_block("simulate(checkpoint_every=...)", run, steps, checkpoint_every)
    plan = Plan(steps, run.every, rows, run.lead)
    state, ended = opened()
    first, found = searched_first(watch, run.first(state) if ended is None else ended)
    if ended is not None:
        return first
    opening, events = Checkpoint(0, Outcome.successful, state.vector), None
    if found is not None:
        opening, events = opening._replace(seen=seen_by(found, 0)), descriptions(found.events)
    remedy = "Raise save_every to keep fewer states."
    within_disk("simulate(store=...)", 8.0 * (1 + steps // run.every) * (1 + sum(run.sizes)), store, remedy)
    stream = io.create_stream(store, first, plan, opening, events, scenario)
    with io.locked(stream.path):
        return continue_run(run, stream, watch, throw=throw, progress=progress)


def rows_of_block(where: str, run: Any, steps: int, block_steps: int | None) -> int:
    """Return the number of saved states in a block of this many steps; by default blocks of a few megabytes."""
    if block_steps is None:
        widest = max(1, *run.sizes)
        return max(1, min(1 + steps // run.every, _ROWS, _NUMBERS // widest, run.most_steps // run.every))
    asked = count(where, block_steps, "Pass the number of steps.")
    if asked % run.every:
        remedy = f"Pass {-(-asked // run.every) * run.every}."
        raise error(where, f"be a multiple of save_every = {run.every}", str(asked), remedy)
    within_memory(where, 16.0 * (asked // run.every) * sum(run.sizes), "Pass fewer steps: a block is held whole.")
    return asked // run.every


def size_in_blocks(discrete: AbstractMotion, branch: BranchRule, steps: int, every: int) -> int:
    """Return the bytes of all states of a run if it can go into a store block by block and takes several, else 0."""
    if (
        branch != PRINCIPAL.name
        or not isinstance(discrete, Discretization)
        or (closed := discrete.route.compiled) is None
    ):
        return 0
    run, states = CompiledRun(discrete, closed, every, True), 1 + steps // every
    return 8 * states * sum(run.sizes) if states > rows_of_block("", run, steps, None) else 0


def refuse_without_store(**given: Any) -> None:
    """Refuse what only a store can keep."""
    for name, value in given.items():
        if value is not None:
            got, remedy = f"{shown(value)} without a store", "Pass store='run.zarr' too, or leave it out."
            raise error(f"simulate({name}=...)", "come with a store", got, remedy)


def continue_run(run: Any, stream: "Stream", watch: Watch | None, *, throw: bool, progress: bool) -> Any:
    """Compute what a locked store lacks, block after block, and return the orbit."""
    stream.prepare()
    _warn_of_other_versions(stream)
    with io.reporting_how_to_resume(stream.path, "The run", lambda: f"step {_standing(stream)}"):
        reached = _completed(run, stream, watch, progress)
    orbit = _loaded(run, stream, reached)
    return finished(orbit, float(run.discrete.time_step), reached.done, stream.plan.steps, throw)


def _warn_of_other_versions(stream: "Stream") -> None:
    """Say so if what is still to compute may differ in its last bits from a run with the versions of the store."""
    others = io.other_versions(io.read_attributes(stream.path))
    if others and not stream.is_finished:
        message = f"The store '{stream.path}' was begun with {others}: the last bits of what follows may differ."
        warnings.warn(message, RuntimeWarning, stacklevel=4)


def _standing(stream: "Stream") -> str:
    return f"{stream.reached()} of {stream.plan.steps}"


def _completed(run: Any, stream: "Stream", watch: Watch | None, progress: bool) -> Checkpoint:
    """Compute every block that is missing or damaged; return the end of the run."""
    plan, computed = stream.plan, not stream.is_finished
    marked = max(stream.marked(), default=-1)
    reached = None
    with progress_bar("steps", progress) as report:
        for block in range(plan.blocks):
            sound = _sound(stream, block) if block <= marked else None
            computed = computed or sound is None
            begin = sound or reached or _first(stream)
            reached = sound or _computed(run, stream, watch, block, begin, lambda done: report(done, plan.steps))
            report(reached.done, plan.steps)
            if reached.is_last:
                break
    end = reached or _first(stream)
    if computed:
        stream.finish(end)
    return end


def _sound(stream: "Stream", block: int) -> Checkpoint | None:
    """Return the end of a block that is marked as finished; None, with a warning, if it is damaged."""
    try:
        return stream.sound(block) if _is_final(stream, block, stream.checkpoint(block + 1)) else None
    except io.DamagedError as flaw:
        message = f"The store '{stream.path}' is damaged: {flaw}. Block {block} is computed again from its checkpoint."
        warnings.warn(message, RuntimeWarning, stacklevel=5)
        return None


def _is_final(stream: "Stream", block: int, reached: Checkpoint) -> bool:
    """Tell whether a block needs no more rows: not so if the run was extended, or ended and was not yet cut."""
    return reached.done == stream.plan.stop(block) or (reached.is_last and stream.is_finished)


def _computed(
    run: Any,
    stream: "Stream",
    watch: Watch | None,
    block: int,
    begin: Checkpoint,
    report: Callable[[int], object],
) -> Checkpoint:
    """Compute a block and write it."""
    current, chunks = watch_at_checkpoint(watch, begin.seen)
    made = computed_block(run, run.state_of(begin.vector), current, stream.plan, block, report)
    seen = None if made.watch is None else seen_by(made.watch, stream.chunks_after(chunks, made.orbit.events))
    reached = Checkpoint(made.done, made.orbit.outcome, made.state.vector, seen)
    stream.write(block, made.orbit, reached)
    return reached


def _first(stream: "Stream") -> Checkpoint:
    try:
        return stream.checkpoint(0)
    except io.DamagedError as flaw:
        remedy = "It is lost: run it again."
        raise error("resume(store=...)", "hold the start of the run", str(flaw), remedy) from None


def _loaded(run: Any, stream: "Stream", reached: Checkpoint) -> Any:
    """Return the orbit, of one that would fill the memory the last block."""
    states = 1 + reached.done // run.every + (0 if reached.seen is None else int(reached.seen.counts.sum()))
    if states * (2 + sum(run.sizes)) <= _LOADED:
        return io.load_orbit(stream.path, discrete=run.discrete)
    return io.load_last_block(stream.path, run.discrete)
