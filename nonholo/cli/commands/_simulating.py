"""The work of `nonholo simulate`, once the compilers know where to keep their code."""

import sys
from pathlib import Path
from typing import Any

import typer

from nonholo.base.progress import waiting
from nonholo.cli.commands._running import Ran, check_output, continued, is_stopped, run_and_keep, scenario_text
from nonholo.cli.scenario.files import Loaded, given_settings, load_scenario
from nonholo.cli.screen.errors import FAILED, USAGE, leave, reporting_warnings, scenario_errors, store_errors
from nonholo.cli.screen.pictures import beside, draw, warn_of_older
from nonholo.cli.screen.report import as_json, duration, figures, show
from nonholo.io import read_attributes
from nonholo.orbit import Orbit


def simulate_and_keep(
    name: str,
    chosen: dict[str, tuple[str, Any]],
    settings: list[str],
    output: Path | None,
    *,
    json: bool,
    overwrite: bool,
    quiet: bool,
) -> None:
    """Load, run, save, draw, report; options of the command line come before the settings of `--set`."""
    with scenario_errors(), reporting_warnings():
        loaded = load_scenario(name, given_settings(chosen, settings))
    stopped = _stopped(loaded, output, overwrite=overwrite)
    shown = sys.stderr.isatty() and not quiet
    store, ran = _run_and_keep(loaded, output, stopped, overwrite=overwrite, progress=shown)
    if store is None or ran.orbit is None:
        leave(f"Nothing to keep. {ran.stopped}", FAILED)
    wanted = loaded.scenario.output
    paths = (beside(store, "png") if wanted.plot else None, beside(store, "gif") if wanted.gif else None)
    drawn = draw(ran.orbit, *paths, progress=shown)
    warn_of_older(store, drawn)
    _report(loaded, ran, ran.orbit, {"store": str(store), **drawn}, json=json, quiet=quiet)
    if ran.stopped:
        leave(f"Stopped early; the good steps are kept. {ran.stopped}", FAILED)


def _stopped(loaded: Loaded, output: Path | None, *, overwrite: bool) -> Path | None:
    """Return the store at a path if this very command began it and was stopped; refuse what else is in the way."""
    suffixes = ["png"] * loaded.scenario.output.plot + ["gif"] * loaded.scenario.output.gif
    with store_errors(USAGE), scenario_errors(), reporting_warnings():
        again = False
        if output is not None and not overwrite and output.exists():
            again = is_stopped(output, scenario_text(loaded), suffixes, read_attributes)
        check_output(output, overwrite=overwrite or again)
    return output if again else None


def _run_and_keep(
    loaded: Loaded, store: Path | None, stopped: Path | None, *, overwrite: bool, progress: bool
) -> tuple[Path | None, Ran]:
    try:
        with store_errors(FAILED), scenario_errors(), reporting_warnings():
            if stopped:
                return stopped, continued(stopped, progress=progress)
            return run_and_keep(loaded, store, overwrite=overwrite, progress=progress)
    except KeyboardInterrupt as stop:
        leave(str(stop) or "Stopped. A run this short is not kept.", FAILED)
    except MemoryError:
        leave("The states do not fit in memory. Keep fewer of them: raise run.save_every.", USAGE)


def _report(loaded: Loaded, ran: Ran, orbit: Orbit, paths: dict[str, str | None], *, json: bool, quiet: bool) -> None:
    if quiet and not json:
        typer.echo(paths["store"])
        return
    with waiting("measuring", sys.stderr.isatty()):
        measured = figures(orbit)
    if is_part := bool(orbit.step[0] > 0):  # only the last block of so large a run was loaded
        measured["steps"] = int(orbit.step[-1])
    each = ran.seconds / max(1, measured["steps"])
    if json:
        times = {"seconds": ran.seconds, "seconds_per_step": each}
        typer.echo(as_json({"scenario": loaded.name, **paths, **times, **measured, "stopped": ran.stopped}))
        return
    length = f"{measured['steps']} of {loaded.scenario.run.steps}, time step {loaded.scenario.run.time_step:g}"
    title = loaded.scenario.title or loaded.name
    heading = {"title": title, "steps": length, "time per step": f"{duration(each)}, once compiled"}
    heading |= loaded.scenario.forces.about(orbit.system)
    if is_part:
        heading["shown"] = f"the last {len(orbit):,} states; the store has all"
    show(measured, heading)
    for kind, path in paths.items():
        if path:
            typer.echo(f"{kind:<9} {path}")
