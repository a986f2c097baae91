"""`nonholo simulate`, `explore` and `sweep` run a scenario; `resume` and `extend` continue a run or a sweep."""

import functools
from pathlib import Path
from typing import Annotated

from typer import Argument, Option, echo

import nonholo
from nonholo import io
from nonholo.cli import commands
from nonholo.cli.screen.errors import USAGE, leave

Steps = Annotated[int | None, Option(metavar="N", help="Instead of run.steps.")]
TimeStep = Annotated[float | None, Option(metavar="H", help="Instead of run.time_step.")]
Settings = Annotated[list[str] | None, Option("--set", metavar="KEY=VALUE", help="Set a value, in TOML; repeatable.")]
Module = Annotated[Path | None, Option(metavar="FILE", help="Run your Python file; its functions are kinds of bodies.")]
Json = Annotated[bool, Option("--json", help="Print one JSON object instead of the table.")]
Overwrite = Annotated[bool, Option("--overwrite", help="Replace what an earlier call wrote there.")]
Quiet = Annotated[bool, Option("--quiet", "-q", help="Print only the path of the store.")]


def simulate(
    scenario: Annotated[str, Argument(metavar="SCENARIO", help="A TOML file, or a name of `systems` or `examples`.")],
    output: Annotated[Path | None, Option("-o", "--output", metavar="STORE", help="Where to keep the run.")] = None,
    steps: Steps = None,
    time_step: TimeStep = None,
    settings: Settings = None,
    plot: Annotated[bool | None, Option("--plot/--no-plot", help="Draw a picture beside the store.")] = None,
    gif: Annotated[bool | None, Option("--gif/--no-gif", help="Draw an animation beside the store.")] = None,
    module: Module = None,
    json: Json = False,
    overwrite: Overwrite = False,
    quiet: Quiet = False,
) -> None:
    """Run a scenario, keep the orbit and a picture, print how exact it was.

    Without -o each run gets a new store under runs/: nothing is overwritten.
    A run that cannot continue keeps its good steps, prints the reason and exits with code 1.
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
    options = {"run.steps": steps, "run.time_step": time_step, "output.plot": plot, "output.gif": gif}
    request = commands.runs.request_of(scenario, options, settings, module)
    commands.runs.simulate_and_keep(request, output, json=json, overwrite=overwrite, quiet=quiet)


Source = Annotated[str, Argument(metavar="SCENARIO | STORE", help="A scenario, or a store of `nonholo simulate`.")]


def explore(
    source: Source = "sleigh",
    output: Annotated[Path | None, Option("-o", "--output", metavar="FILE", help="Where to write the page.")] = None,
    steps: Steps = None,
    time_step: TimeStep = None,
    settings: Settings = None,
    module: Module = None,
    browser: Annotated[bool, Option("--browser/--no-browser", help="Open the page in the browser.")] = True,
    overwrite: Overwrite = False,
) -> None:
    """Write the live page of a motion, one file, and open it in the browser.

    Tops with n = 3 or 4 and sleighs in the plane run in the page itself, with the
    same numbers; others are replayed. Without -o the page is a temporary file.

    nonholo explore suslov
    nonholo explore snakeboard
    nonholo explore my.toml -o top.html --no-browser
    nonholo explore runs/sleigh-001.zarr
    """
    options = {"run.steps": steps, "run.time_step": time_step}
    ask = functools.partial(commands.runs.request_of, source, options, settings, module)
    echo(commands.runs.write_page(source, ask, output, browser=browser, overwrite=overwrite))


SweepStore = Annotated[Path | None, Option("-o", "--output", metavar="STORE", help="Where to keep it; a new path.")]
Members = Annotated[float | None, Option(metavar="N", help="About how many, as 1e6; ranges of a grid scale alike.")]
Scheduler = Annotated[str | None, Option(metavar="HOW", help="threads (default), processes, tcp://HOST:PORT of Dask.")]
Workers = Annotated[int | None, Option(metavar="N", min=1, help="Threads or processes; by default one a core.")]


def sweep(
    scenario: Annotated[str, Argument(metavar="SCENARIO", help="A TOML file; `nonholo new sweep` writes one.")],
    output: SweepStore = None,
    members: Members = None,
    scheduler: Scheduler = None,
    workers: Workers = None,
    settings: Settings = None,
    plot: Annotated[bool | None, Option("--plot/--no-plot", help="Draw a map beside the store.")] = None,
    module: Module = None,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    r"""Run every member of a design, keep the result and a map, print how members ended.

    A scenario has \[body], \[start], \[run] as for `simulate`, and

    \[design] kind = "grid" or "random"; members; rng
    \[design.values] what is varied, by key path of the same file:
      "body.a" = [0.1, 0.2, 0.5]
      "run.time_step" = {from = 0.1, to = 1.0, count = 9}
      "forces.gravity.force_2" = [-9.81, -1.6]
      "body.a" = {uniform = [0.1, 1.0]}       in a random design; also
      log_uniform, normal, direction, mass_tensor, choice
    \[keep] reductions = ["final_state"]       or energy_drift, ...
    \[output] color, x, y                      what the map shows

    Ctrl-C stops it and prints the command that resumes it; members that fail do not stop it.

    nonholo sweep my.toml
    nonholo sweep my.toml --members 1e6 -o large.zarr
    nonholo sweep my.toml --set design.values.body.a=[0.1,0.2] --no-plot
    nonholo sweep my.toml --scheduler tcp://127.0.0.1:8786
    nonholo sweep robots.toml --module my_robot.py
    nonholo resume large.zarr               resume one that stopped
    """
    whole = int(members) if members is not None and members.is_integer() else members  # 1e6 is a whole number
    options = {"design.members": whole, "output.plot": plot}
    request = commands.runs.request_of(scenario, options, settings, module, of_sweep=True)
    commands.runs.sweep_and_keep(request, output, {"scheduler": scheduler, "workers": workers}, json=json, quiet=quiet)


Store = Annotated[Path, Argument(metavar="STORE", help="A store made by sweep, or by simulate(..., store=...).")]
Trust = Annotated[bool, Option("--trust", help="Import functions that the store of a sweep names, with your rights.")]


def resume(
    store: Store,
    scheduler: Scheduler = None,
    workers: Workers = None,
    members: Annotated[int | None, Option(metavar="N", help="Members that a random design is to have.")] = None,
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
    nonholo resume sweep.zarr --members 10000
    """
    how = {"scheduler": scheduler, "workers": workers, "members": members, "trust": trust}
    if io.places.format_of(store) == io.places.SWEEP_FORMAT:
        commands.runs.resume_sweep(store, module, how, json=json)
        return
    commands.runs.continue_and_report(store, module, functools.partial(nonholo.resume, store, **how), json=json)


def extend(
    store: Store,
    steps: Annotated[int, Option("--steps", metavar="N", help="How many steps more.")],
    module: Module = None,
    json: Json = False,
) -> None:
    """Add steps to a run, with the bits of one that had been that long from the start.

    nonholo extend run.zarr --steps 1000000
    """
    if io.places.format_of(store) == io.places.SWEEP_FORMAT:
        again = f"nonholo info {store} --scenario > more.toml; nonholo sweep more.toml --set run.steps=..."
        leave(f"'{store}' holds a sweep, whose members are not extended. Run it again, longer: {again}", USAGE)
    commands.runs.continue_and_report(store, module, functools.partial(nonholo.extend, store, steps), json=json)
