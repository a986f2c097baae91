"""`nonholo extend`: run past the end of a run."""

from typing import Annotated

import typer

from nonholo.cli.commands.resume import Store
from nonholo.cli.commands.simulate import Json


def extend(
    store: Store,
    steps: Annotated[int, typer.Option("--steps", metavar="N", help="How many steps more.")],
    json: Json = False,
) -> None:
    """Add steps to a run, with the bits of one that had been that long from the start.

    nonholo extend run.zarr --steps 1000000
    """
    from nonholo import io
    from nonholo.cli.commands._resuming import continue_and_report
    from nonholo.cli.screen.errors import USAGE, leave
    from nonholo.simulation import extend as continued

    if io.format_of(store) == io.SWEEP_FORMAT:
        again = f"nonholo info {store} --scenario > more.toml; nonholo sweep more.toml --set run.steps=..."
        leave(f"'{store}' holds a sweep, whose members are not extended. Run it again, longer: {again}", USAGE)
    continue_and_report(store, lambda progress: continued(store, steps, progress=progress), json=json)
