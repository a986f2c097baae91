"""`nonholo info`: what a store holds, how it was made, how exact it is or how far it came."""

from pathlib import Path
from typing import Annotated

import typer


def info(
    store: Annotated[Path, typer.Argument(metavar="STORE", help="A store made by simulate, sweep or save_orbit.")],
    json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
    scenario: Annotated[bool, typer.Option("--scenario", help="Print the scenario that was run, as TOML.")] = False,
) -> None:
    """Show the provenance of a run and measure again what it should keep.

    Of a sweep: how far it came, how members ended, the first errors, its ranges.

    nonholo info runs/suslov-001.zarr
    nonholo info runs/suslov-001.zarr --scenario > again.toml
    """
    from nonholo.cli.screen.errors import FAILED, USAGE, leave, store_errors
    from nonholo.cli.screen.stores import show_provenance, show_standing, show_sweep_standing
    from nonholo.ensembles.stores import attributes_of
    from nonholo.io import SWEEP_FORMAT, format_of, load_orbit, read_attributes, standing

    is_sweep = format_of(store) == SWEEP_FORMAT
    with store_errors(USAGE):
        stored = attributes_of(store) if is_sweep else read_attributes(store)
    if scenario:
        if "scenario" not in stored:
            leave("This store was not made from a scenario.", FAILED)
        typer.echo(stored["scenario"], nl=False)
        return
    if is_sweep:
        show_sweep_standing(store, stored, json=json)
        return
    if unfinished := standing(store):
        show_standing(store, stored, unfinished, json=json)
        return
    try:
        orbit, failure = load_orbit(store), None
    except (OSError, ValueError) as caught:
        orbit, failure = None, caught
    show_provenance(store, stored, orbit, json=json)
    if failure:
        leave(f"Its orbit cannot be loaded. {failure}", FAILED)
