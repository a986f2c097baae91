"""`nonholo resume`: go on with a run that stopped."""

from pathlib import Path
from typing import Annotated

import typer

Store = Annotated[Path, typer.Argument(metavar="STORE", help="A store made by simulate(..., store=...).")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object instead of the table.")]


def resume(store: Store, json: Json = False) -> None:
    """Go on from the last checkpoint of a run; damaged blocks are named and computed again.

    The result has the bits of a run that was never stopped.

    nonholo resume run.zarr
    """
    from nonholo.cli._caches import use_cache_folders

    use_cache_folders()
    from nonholo.cli._going_on import go_on_and_report
    from nonholo.simulation import resume as going_on

    go_on_and_report(store, lambda progress: going_on(store, progress=progress), json=json)
