"""`nonholo resume`: resume a run or a sweep that stopped."""

from pathlib import Path
from typing import Annotated

import typer

from nonholo.cli.commands.simulate import Json
from nonholo.cli.commands.sweep import Scheduler, Workers

Store = Annotated[Path, typer.Argument(metavar="STORE", help="A store made by sweep, or by simulate(..., store=...).")]
Trust = Annotated[
    bool, typer.Option("--trust", help="Import the functions that the store of a sweep names, with your rights.")
]


def resume(
    store: Store, scheduler: Scheduler = None, workers: Workers = None, trust: Trust = False, json: Json = False
) -> None:
    """Continue from the last checkpoint of a run, or with the missing blocks of a sweep.

    Damaged blocks are named and computed again. The result has the bits of one
    that was never stopped. --scheduler, --workers and --trust are for sweeps.

    A sweep whose task or reductions are functions of somebody's own only names
    them: they are imported and run with --trust alone, after their names are shown.

    nonholo resume run.zarr
    nonholo resume sweep.zarr --workers 4
    """
    from nonholo import io
    from nonholo.cli.commands._resuming import continue_and_report, resume_sweep
    from nonholo.ensembles import resume as continued

    if io.format_of(store) == io.SWEEP_FORMAT:
        resume_sweep(store, scheduler, workers, trust=trust, json=json)
    else:
        options = {"scheduler": scheduler, "workers": workers, "trust": trust}
        continue_and_report(store, lambda progress: continued(store, progress=progress, **options), json=json)
