"""`nonholo resume`: resume a run or a sweep that stopped; `nonholo extend`: run past the end of a run."""

import functools
from pathlib import Path
from typing import Annotated

import typer

from nonholo.cli.commands.simulate import Json, Module
from nonholo.cli.commands.sweep import Scheduler, Workers

Store = Annotated[Path, typer.Argument(metavar="STORE", help="A store made by sweep, or by simulate(..., store=...).")]
Trust = Annotated[
    bool, typer.Option("--trust", help="Import the functions that the store of a sweep names, with your rights.")
]


def resume(
    store: Store,
    scheduler: Scheduler = None,
    workers: Workers = None,
    module: Module = None,
    trust: Trust = False,
    json: Json = False,
) -> None:
    """Continue from the last checkpoint of a run, or with the missing blocks of a sweep.

    Damaged blocks are named and computed again. The result has the bits of one
    that was never stopped. --scheduler, --workers and --trust are for sweeps.

    A sweep whose task or reductions are functions of somebody's own only names
    them: they are imported and run with --trust alone, after their names are shown.

    nonholo resume run.zarr
    nonholo resume sweep.zarr --workers 4
    """
    from nonholo import ensembles, io
    from nonholo.cli.commands._sweeps import continue_and_report, resume_sweep

    if io.format_of(store) == io.SWEEP_FORMAT:
        resume_sweep(store, module, scheduler, workers, trust=trust, json=json)
        return
    how = {"scheduler": scheduler, "workers": workers, "trust": trust}
    continue_and_report(store, module, functools.partial(ensembles.resume, store, **how), json=json)


def extend(
    store: Store,
    steps: Annotated[int, typer.Option("--steps", metavar="N", help="How many steps more.")],
    module: Module = None,
    json: Json = False,
) -> None:
    """Add steps to a run, with the bits of one that had been that long from the start.

    nonholo extend run.zarr --steps 1000000
    """
    from nonholo import io, simulation
    from nonholo.cli.commands._sweeps import continue_and_report
    from nonholo.cli.screen.errors import USAGE, leave

    if io.format_of(store) == io.SWEEP_FORMAT:
        again = f"nonholo info {store} --scenario > more.toml; nonholo sweep more.toml --set run.steps=..."
        leave(f"'{store}' holds a sweep, whose members are not extended. Run it again, longer: {again}", USAGE)
    continue_and_report(store, module, functools.partial(simulation.extend, store, steps), json=json)
