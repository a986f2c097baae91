"""`nonholo sweep`: run every member of a design and keep what is asked of each."""

from pathlib import Path
from typing import Annotated

import typer

from nonholo.cli.commands.simulate import Json, Module, Quiet, Settings

Scenario = Annotated[
    str, typer.Argument(metavar="SCENARIO", help="A TOML file; `nonholo new sweep` writes one, with comments.")
]
Store = Annotated[
    Path | None, typer.Option("-o", "--output", metavar="STORE", help="Where to keep the result; a new path.")
]
Members = Annotated[
    float | None,
    typer.Option(metavar="N", help="Approximate number of members, such as 1e6: scales every range of a grid alike."),
]
Scheduler = Annotated[
    str | None,
    typer.Option(metavar="HOW", help="threads (default), processes, or tcp://HOST:PORT of a Dask scheduler."),
]
Workers = Annotated[int | None, typer.Option(metavar="N", min=1, help="Threads or processes; by default one a core.")]
Plot = Annotated[bool | None, typer.Option("--plot/--no-plot", help="Draw a map beside the store.")]


def sweep(
    scenario: Scenario,
    output: Store = None,
    members: Members = None,
    scheduler: Scheduler = None,
    workers: Workers = None,
    settings: Settings = None,
    plot: Plot = None,
    module: Module = None,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    r"""Run every member of a design, keep the result and a map, print how members ended.

    A scenario has \[body], \[start], \[run] as for `simulate`, and

    \[design] kind = "grid" or "random"; members; seed
    \[design.values] what is varied, by key path of the same file:
      "body.a" = [0.1, 0.2, 0.5]
      "run.time_step" = {from = 0.1, to = 1.0, count = 9}
      "forces.gravity.force_2" = [-9.81, -1.6]
      "body.a" = {uniform = [0.1, 1.0]}       in a random design; also
      log_uniform, normal, direction, mass_tensor, choice
    \[keep] reductions = ["final_state"]       or energy_drift, ...
    \[output] color, x, y                      what the map shows

    Ctrl-C stops it and says how to resume; members that fail do not stop it.

    nonholo sweep my.toml
    nonholo sweep my.toml --members 1e6 -o large.zarr
    nonholo sweep my.toml --set design.values.body.a=[0.1,0.2] --no-plot
    nonholo sweep my.toml --scheduler tcp://127.0.0.1:8786
    nonholo sweep robots.toml --module my_robot.py
    nonholo resume large.zarr               resume one that stopped
    """
    from nonholo.cli.commands._sweeps import sweep_and_keep

    whole = int(members) if members is not None and members.is_integer() else members  # 1e6 is a whole number
    options = {"design.members": ("--members", whole), "output.plot": ("--plot", plot)}
    how = {"scheduler": scheduler, "workers": workers, "json": json, "quiet": quiet}
    sweep_and_keep(scenario, options, settings or [], output, module=module, **how)
