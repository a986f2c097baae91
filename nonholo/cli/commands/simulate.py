"""`nonholo simulate`: run a scenario and keep the result."""

from pathlib import Path
from typing import Annotated

import typer

Scenario = Annotated[
    str, typer.Argument(metavar="SCENARIO", help="A TOML file, or a name of `nonholo systems` or `nonholo examples`.")
]
Store = Annotated[Path | None, typer.Option("-o", "--output", metavar="STORE", help="Where to keep the run.")]
Steps = Annotated[int | None, typer.Option(metavar="N", help="Instead of run.steps.")]
TimeStep = Annotated[float | None, typer.Option(metavar="H", help="Instead of run.time_step.")]
Settings = Annotated[
    list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Change any value, in TOML; repeatable.")
]
Plot = Annotated[bool | None, typer.Option("--plot/--no-plot", help="Draw a picture beside the store.")]
Gif = Annotated[bool | None, typer.Option("--gif/--no-gif", help="Draw an animation beside the store.")]
Module = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="Run your own Python file, whose functions are kinds of bodies."),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object instead of the table.")]
Overwrite = Annotated[bool, typer.Option("--overwrite", help="Replace what an earlier call wrote there.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print only the path of the store.")]


def simulate(
    scenario: Scenario,
    output: Store = None,
    steps: Steps = None,
    time_step: TimeStep = None,
    settings: Settings = None,
    plot: Plot = None,
    gif: Gif = None,
    module: Module = None,
    json: Json = False,
    overwrite: Overwrite = False,
    quiet: Quiet = False,
) -> None:
    """Run a scenario, keep the orbit and a picture, print how exact it was.

    Without -o each run gets a new store under runs/: nothing is overwritten.
    A run that cannot continue keeps its good steps, says why, exits with code 1.
    Long runs go to the store as they are computed: after Ctrl-C or a kill,
    `nonholo resume STORE` continues. Weight, friction and tables of forces
    are the table `forces` of a scenario.

    nonholo simulate suslov
    nonholo simulate particle --set body.mass=2
    nonholo simulate sleigh --steps 1000 --time-step 0.05 --gif
    nonholo simulate my.toml --set body.a=0.3 --set 'run.difference="logarithmic"'
    nonholo simulate my.toml --set 'start={momentum=[0.1, 1.0]}'
    nonholo simulate my.toml -o study/first.zarr --json
    nonholo simulate robot.toml --module my_robot.py
    """
    from nonholo.cli.commands._runs import simulate_and_keep

    options = {"run.steps": ("--steps", steps), "run.time_step": ("--time-step", time_step)}
    options |= {"output.plot": ("--plot", plot), "output.gif": ("--gif", gif)}
    how = {"json": json, "overwrite": overwrite, "quiet": quiet}
    simulate_and_keep(scenario, options, settings or [], output, module=module, **how)
