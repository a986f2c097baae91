"""`iterate`: the run of `simulate`, block by block."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from nonholo._checks import flags
from nonholo._progress import progress_bar
from nonholo._results import Outcome, OutcomeError
from nonholo.discrete import Discretization
from nonholo.discrete._branch_rules import BranchRule
from nonholo.io import Plan
from nonholo.orbit import Orbit
from nonholo.simulation.events import Watch, searched_first, stretch_of, watched
from nonholo.simulation.runs import (
    CompiledRun,
    checked_counts,
    closed_step,
    compiled_run,
    first_state,
    opened,
    refuse_too_large,
    refuse_too_long,
)
from nonholo.simulation.stores import rows_of_block


def iterate(
    discrete: Discretization,
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
) -> Iterator[Orbit]:
    """Run the discrete map as `simulate` does, and give its orbit block by block, in bounded memory.

    The blocks together are the orbit of `simulate`, bit for bit: no state is given twice, the first state of a block
    follows the last one of the block before. (Where `simulate` decodes momenta and poses by products of matrices, for
    n > 3, the last bits of these products can depend on how many rows are decoded at once; the motion does not.)

    Args:
        discrete: The discretised system, with a compiled step.
        steps: Number of steps N.
        block_steps: Steps of a block, a multiple of `save_every`; by default blocks of a few megabytes.
        body_velocity: As in `simulate`, and so are the others.
        restricted_velocity: See `simulate`.
        displacement: See `simulate`.
        momentum: See `simulate`.
        configuration: See `simulate`.
        save_every: Keep every so many steps.
        branch: "principal".
        reconstruct: Also compute poses.
        backend: "auto" or "numba".
        events: As in `simulate`; the `events` of a block are those after the last step of the block before. The block
            in which an event stops the run is the last one.
        throw: Raise if the run cannot go on, after its last good block; otherwise that block's outcome says so.
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
    starts = {"body_velocity": body_velocity, "displacement": displacement, "momentum": momentum}
    starts["restricted_velocity"] = restricted_velocity
    steps, every, rule = checked_counts(discrete, steps, save_every, branch, backend, displacement)
    run = compiled_run("iterate(discrete=...)", discrete, closed_step(discrete, rule, backend), every, reconstruct)
    refuse_too_large("iterate", discrete, 1, reconstruct)
    refuse_too_long("iterate", discrete, steps, compiled=True)
    plan = Plan(steps, every, rows_of_block("iterate(block_steps=...)", run, steps, block_steps))
    watch = None if events is None else watched("iterate", discrete, events, rule.name, reconstruct)
    start = first_state(discrete, configuration, int(reconstruct), True, starts)
    vector, first = opened(run, start, steps, throw)
    if not len(first):
        return iter((searched_first(watch, first)[0],))
    return _blocks(run, vector, watch, plan, throw=throw, progress=progress)


def _blocks(
    run: CompiledRun, vector: np.ndarray, watch: Watch | None, plan: Plan, *, throw: bool, progress: bool
) -> Iterator[Orbit]:
    with progress_bar("steps", progress) as report:
        for number in range(plan.blocks):
            block, done, watch = stretch_of(run, vector, watch, plan, number, lambda now: report(now, plan.steps))
            yield from _given(run, block, done, plan.steps, throw)
            if block.outcome != Outcome.successful or (watch is not None and watch.stopped_by):
                return


def _given(run: CompiledRun, block: Orbit, done: int, steps: int, throw: bool) -> Iterator[Orbit]:
    """Give a block, and raise if the run cannot go on after it."""
    if len(block) or not throw:
        yield block
    if throw and block.outcome != Outcome.successful:
        where = f"Step {done + 1} of {steps} (time_step {run.discrete.time_step:g})"
        raise OutcomeError(block.outcome, where, block)
