"""`simulate`: an orbit of the discrete map, from a checked start to a decoded result; `iterate`: the same by blocks."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from nonholo.base.checks import checked_path, refuse_given
from nonholo.discrete import BranchRule
from nonholo.orbit import DiscreteMotion, OrbitT
from nonholo.simulation._options import FEW, checked_run, refuse_too_large
from nonholo.simulation._run import one_by_one, rows_of_block, run_to_end
from nonholo.simulation._stored import into_store
from nonholo.systems import Start


def simulate(
    discrete: DiscreteMotion[OrbitT],
    *,
    steps: int,
    body_velocity: Any = None,
    restricted_velocity: Any = None,
    displacement: Any = None,
    momentum: Any = None,
    configuration: Any = None,
    project: bool = False,
    save_every: int = 1,
    branch: BranchRule = "principal",
    reconstruct: bool = True,
    backend: str = "auto",
    events: Any = None,
    throw: bool = True,
    progress: bool = False,
    store: str | Path | None = None,
    checkpoint_every: int | None = None,
    scenario: str | None = None,
) -> OrbitT:
    r"""Run the discrete Euler-Poincare-Suslov map.

    $$ P(W_{k+1})|_{\mathfrak{d}} = (\mathrm{Ad}^*_{W_k} P(W_k))|_{\mathfrak{d}}, \qquad g_{k+1} = g_k W_k. $$

    The map is multivalued. The principal root is the one that momentum zero reaches along s r, 0 <= s <= 1; each root
    is verified to be the principal one; energy does not distinguish roots, since every root conserves it.

    Branch rules. "nearest" is the root reached from the present W by continuation of the right-hand side along the
    segment from $P(W)|_d$ to $(Ad^*_W P(W))|_d$: it continues a run that starts with a `displacement` off the
    principal branch. It exists for every system with a left-invariant constraint. For tops and sleighs with difference
    "matrix" all values are known: "smallest" and "largest" take the real one with the least or the largest norm of the
    full momentum, "inner" and "outer" the one in that part of the invariant curve (n = 3 and det B > 2|c|^2, below the
    saddle's energy; the nearest of three). A function `rule(branches, present)` gets the `Branches` and the present W,
    and returns the index of a real one or None. A tie or a double root ends the run with
    `branch_unverified`.

    A discretized `LagrangeDAlembert` runs its own map. It starts at a
    `configuration`, its q_0, and takes neither `restricted_velocity` nor `branch`, `reconstruct` and `backend`.

    Reference: [fedorov-zenkov-2004], equation (disc.momentum.eqn).

    Args:
        discrete: The discretized system.
        steps: Number of steps N; unthinned orbits have N + 1 states.
        body_velocity: Start with the principal W_0 that has the same momentum along the constraint (second order).
        restricted_velocity: The same, in rows of the constraint subspace.
        displacement: Start with this W_0, on the displacement variety; with branch "principal" on that branch. Not
            for compositions (order > 2), whose state is the restricted momentum.
        momentum: Start with this momentum, full (on the momentum locus) or along the constraint subspace.
        configuration: First pose, a matrix of the group; the identity by default.
        project: Start at the admissible configuration and `body_velocity` closest to these in the kinetic energy.
        save_every: Steps between saved states.
        branch: Which value of the map a step takes: "principal", "nearest", "smallest", "largest", "inner", "outer" or
            a function; see above. A start from a velocity or a restricted momentum uses the principal W_0
            under every rule.
        reconstruct: Also compute poses.
        backend: "numba" (closed forms, compiled), "jax" (the definition), or "auto" to choose.
        events: `Event`s, or functions of an orbit, whose changes of sign are found at every single step and located
            to rounding; see `Orbit.events`. A stopping event ends the run with the last saved state before it. One with
            a `reset` changes the motion (`Impact`).
        throw: Raise if the run cannot continue; otherwise return the good steps and the outcome.
        progress: Show a progress bar on standard error.
        store: A new path. The saved states of the run and the crossings of its events go there block by block, in
            bounded memory; `resume` and `extend` continue it. An orbit that would fill 1 GiB is not returned whole but
            as its last block.
        checkpoint_every: Steps between two checkpoints of the store, a multiple of `save_every`; by default blocks of a
            few megabytes. A run that is stopped loses at most this many steps.
        scenario: A text that describes the making of the orbit, kept in the store.

    Returns:
        The orbit; of a system in coordinates a `nonholo.lagrange_dalembert.CoordinateOrbit`.

    Raises:
        ValueError: A bad argument, before any work.
        FileExistsError: The path `store` exists.
        OSError: The disk is full; the store stays valid, and `resume` continues.
        OutcomeError: The start is not on the principal branch, or, with `throw`, the run could not continue; then the
            error's `orbit` holds every good step.

    Example:
        >>> top = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
        >>> orbit = nh.simulate(nh.discretize(top, 0.1), body_velocity=(0.4, 0.9, 0.0), steps=1000)
        >>> float(np.ptp(orbit.energy)) < 1e-14
        True
    """
    how = {"reconstruct": reconstruct, "throw": throw, "progress": progress}
    run = checked_run("simulate", discrete, steps, save_every, branch, backend, events, **how)
    starts = {"body_velocity": body_velocity, "displacement": displacement, "momentum": momentum}
    starts["restricted_velocity"] = restricted_velocity
    start = Start.of("simulate", configuration, choices=discrete.starts, project=project, **starts)
    if store is None and (checkpoint_every is not None or scenario is not None):
        of_stores = {"checkpoint_every": (checkpoint_every, None), "scenario": (scenario, None)}
        refuse_given("simulate", "come with a store", "Pass store='run.zarr' too, or leave it out.", **of_stores)
    if store is not None or run.watch is None:  # an event may stop a run in memory long before
        states = 1 if store is not None else 1 + run.steps // run.every
        if states * run.stepper.width > FEW:
            refuse_too_large("simulate", tuple(run.stepper.columns.values()), states)
    first = discrete.first(start, with_poses=run.stepper.has_poses)
    if store is None:
        return run.finish(*run_to_end(run, first, whole=True))
    return into_store(run, first, checked_path("simulate(store=...)", store), checkpoint_every, scenario)


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
    project: bool = False,
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
        project: See `simulate`.
        save_every: Steps between saved states.
        branch: As in `simulate`.
        reconstruct: Also compute poses.
        backend: As in `simulate`.
        events: As in `simulate`; the `events` of a block are those after the last step of the block before. The block
            in which an event stops the run is the last one.
        throw: Raise if the run cannot continue, after its last good block; otherwise that block's outcome reports it.
        progress: Show a progress bar on standard error.

    Returns:
        An iterator over orbits of `block_steps // save_every` states. The last one has the states that are left: none
        if an event ends the run before the next one.

    Raises:
        ValueError: A bad argument, before any work.
        OutcomeError: As in `simulate`; with `throw` its `orbit` is the last block.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
        >>> [len(block) for block in nh.iterate(sleigh, body_velocity=(1, 0, 0), steps=1000, block_steps=400)]
        [400, 400, 201]
    """
    how = {"reconstruct": reconstruct, "throw": throw, "progress": progress}
    run = checked_run("iterate", discrete, steps, save_every, branch, backend, events, **how)
    starts = {"body_velocity": body_velocity, "displacement": displacement, "momentum": momentum}
    starts["restricted_velocity"] = restricted_velocity
    start = Start.of("iterate", configuration, choices=discrete.starts, project=project, **starts)
    refuse_too_large("iterate", tuple(run.stepper.columns.values()), 1)
    rows = rows_of_block("iterate(block_steps=...)", run, block_steps)
    return one_by_one(run, discrete.first(start, with_poses=run.stepper.has_poses), rows)
