"""`iterate`: the run of `simulate`, block by block."""

from collections.abc import Iterator
from typing import Any

from nonholo.base.checks import flags
from nonholo.discrete import BranchRule
from nonholo.orbit import DiscreteMotion, OrbitT
from nonholo.simulation._options import RunOptions
from nonholo.simulation._run import Run, one_by_one, rows_of_block
from nonholo.simulation.events import watched
from nonholo.systems import Start


def iterate(
    discrete: DiscreteMotion[OrbitT],
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
) -> Iterator[OrbitT]:
    """Run the discrete map as `simulate` does, and give its orbit block by block, in bounded memory.

    The blocks together are the orbit of `simulate`, bit for bit: no state is given twice, the first state of a block
    follows the last one of the block before.

    Args:
        discrete: The discretized system.
        steps: Number of steps N.
        block_steps: Steps of a block, a multiple of `save_every`; by default blocks of a few megabytes.
        body_velocity: As in `simulate`, and so are the others.
        restricted_velocity: See `simulate`.
        displacement: See `simulate`.
        momentum: See `simulate`.
        configuration: See `simulate`.
        save_every: Steps between saved states.
        branch: As in `simulate`.
        reconstruct: Also compute poses.
        backend: As in `simulate`.
        events: As in `simulate`; the `events` of a block are those after the last step of the block before. The block
            in which an event stops the run is the last one.
        throw: Raise if the run cannot continue, after its last good block; otherwise that block's outcome says so.
        progress: Show a progress bar on standard error.

    Returns:
        An iterator over orbits of `block_steps // save_every` states, the last one of those that are left.

    Raises:
        ValueError: A bad argument, before any work.
        OutcomeError: As in `simulate`; with `throw` its `orbit` is the last block.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
        >>> [len(block) for block in nh.iterate(sleigh, body_velocity=(1, 0, 0), steps=1000, block_steps=400)]
        [400, 400, 201]
    """
    flags("iterate", reconstruct=reconstruct, throw=throw, progress=progress)
    how = {"branch": branch, "reconstruct": reconstruct, "backend": backend}
    options = RunOptions.of("iterate", discrete, steps=steps, save_every=save_every, **how)
    starts = {"body_velocity": body_velocity, "displacement": displacement, "momentum": momentum}
    starts |= {"restricted_velocity": restricted_velocity}
    start = Start.of("iterate", configuration, allowed=discrete.starts, **starts)
    options.refuse_too_large("iterate", 1)
    run = Run(*options, watched("iterate", options.stepper, events), throw, progress)
    rows = rows_of_block("iterate(block_steps=...)", run, block_steps)
    return one_by_one(run, discrete.first(start, posed=options.stepper.has_poses), rows)
