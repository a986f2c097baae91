"""`iterate`: the run of `simulate`, block by block."""

from collections.abc import Iterator
from typing import Any

from nonholo.base.checks import flags
from nonholo.base.progress import progress_bar
from nonholo.base.results import Outcome, OutcomeError
from nonholo.discrete import BranchRule, Discretization
from nonholo.io import Plan
from nonholo.orbit import Orbit
from nonholo.simulation._simulate import refuse_what_bodies_have
from nonholo.simulation.events import Watch, computed_block, iterated, searched_first, watched
from nonholo.simulation.runs import (
    CompiledRun,
    RunOptions,
    RunState,
    closed_step,
    compiled_run,
    first_state,
    opened,
    refuse_too_large,
    refuse_too_long,
)
from nonholo.simulation.stores import rows_of_block
from nonholo.systems import AbstractCoordinateDiscretization, Start, in_coordinates


def iterate(
    discrete: Discretization | AbstractCoordinateDiscretization,
    *,
    steps: int,
    block_steps: int | None = None,
    body_velocity: Any = None,
    restricted_velocity: Any = None,
    displacement: Any = None,
    momentum: Any = None,
    configuration: Any = None,
    save_every: int = 1,
    branch: BranchRule = "principal",
    reconstruct: bool = True,
    backend: str = "auto",
    events: Any = None,
    throw: bool = True,
    progress: bool = False,
) -> Iterator[Any]:
    """Run the discrete map as `simulate` does, and give its orbit block by block, in bounded memory.

    The blocks together are the orbit of `simulate`, bit for bit: no state is given twice, the first state of a block
    follows the last one of the block before. (Where `simulate` decodes momenta and poses by products of matrices, for
    n > 3, the last bits of these products can depend on how many rows are decoded at once; the motion does not.)

    Args:
        discrete: The discretized system, with a compiled step; or a discretized `LagrangeDAlembert`, which takes what
            its `simulate` takes.
        steps: Number of steps N.
        block_steps: Steps of a block, a multiple of `save_every`; by default blocks of a few megabytes.
        body_velocity: As in `simulate`, and so are the others.
        restricted_velocity: See `simulate`.
        displacement: See `simulate`.
        momentum: See `simulate`.
        configuration: See `simulate`.
        save_every: Steps between saved states.
        branch: "principal".
        reconstruct: Also compute poses.
        backend: "auto" or "numba".
        events: As in `simulate`; the `events` of a block are those after the last step of the block before. The block
            in which an event stops the run is the last one.
        throw: Raise if the run cannot continue, after its last good block; otherwise that block's outcome says so.
        progress: Show a progress bar on standard error.

    Returns:
        An iterator over orbits of `block_steps // save_every` states, the last one of those that are left.

    Raises:
        ValueError: A bad argument or a run without compiled step, before any work.
        OutcomeError: As in `simulate`; with `throw` its `orbit` is the last block.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
        >>> [len(block) for block in nh.iterate(sleigh, body_velocity=(1, 0, 0), steps=1000, block_steps=400)]
        [400, 400, 201]
    """
    flags("iterate", reconstruct=reconstruct, throw=throw, progress=progress)
    how = {"branch": branch, "reconstruct": reconstruct, "backend": backend}
    starts = {"body_velocity": body_velocity, "displacement": displacement, "momentum": momentum}
    if in_coordinates(discrete):
        refuse_what_bodies_have("iterate", restricted_velocity=restricted_velocity, **how)
        rest = {"steps": steps, "save_every": save_every, "throw": throw, "progress": progress}
        return iterated(discrete, events, block_steps, configuration=configuration, **starts, **rest)
    options = RunOptions.of(discrete, steps=steps, save_every=save_every, throw=throw, progress=progress, **how)
    start = Start.of("simulate", configuration, **starts, restricted_velocity=restricted_velocity)
    return _blocks(discrete, start, options, block_steps, events)


def _blocks(
    discrete: Discretization, start: Start, options: RunOptions, block_steps: int | None, events: Any
) -> Iterator[Orbit]:
    """Check and open a run, before any block is asked for, and return the iterator."""
    closed = closed_step(discrete, options.rule, options.backend)
    run = compiled_run("iterate(discrete=...)", discrete, closed, options.every, options.reconstruct)
    refuse_too_large("iterate", discrete, 1, options.reconstruct)
    refuse_too_long("iterate", discrete, options.steps, compiled=True)
    rows = rows_of_block("iterate(block_steps=...)", run, options.steps, block_steps)
    watch = None if events is None else watched("iterate", discrete, events, options.rule.name, options.reconstruct)
    first_one = first_state(discrete, start, posed=options.reconstruct, compiled=True)
    state, ended = opened(run, first_one, options.steps, options.throw)
    if ended is not None:
        return iter((searched_first(watch, ended)[0],))
    return _computed(run, state, watch, Plan(options.steps, options.every, rows), options)


def _computed(
    run: CompiledRun, state: RunState, watch: Watch | None, plan: Plan, options: RunOptions
) -> Iterator[Orbit]:
    with progress_bar("steps", options.progress) as report:
        for number in range(plan.blocks):
            block = computed_block(run, state, watch, plan, number, lambda now: report(now, plan.steps))
            state, watch = block.state, block.watch
            yield from _given(run, block.orbit, block.done, plan.steps, options.throw)
            if block.orbit.outcome != Outcome.successful or (watch is not None and watch.stopped_by):
                return


def _given(run: CompiledRun, block: Orbit, done: int, steps: int, throw: bool) -> Iterator[Orbit]:
    """Give a block, and raise if the run cannot continue after it."""
    if len(block) or not throw:
        yield block
    if throw and block.outcome != Outcome.successful:
        where = f"Step {done + 1} of {steps} (time_step {run.discrete.time_step:g})"
        raise OutcomeError(block.outcome, where, block)
