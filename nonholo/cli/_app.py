"""The command `nonholo` itself: its help, its version, its subcommands."""

import contextlib
import signal
import sys
from typing import Annotated

import typer

from nonholo import __version__
from nonholo.cli.commands.about import cite, examples, new, systems
from nonholo.cli.commands.dataset import dataset
from nonholo.cli.commands.paper import paper
from nonholo.cli.commands.run import explore, extend, resume, simulate, sweep
from nonholo.cli.commands.stores import export, info, plot

app = typer.Typer(
    name="nonholo",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
_COMMANDS = (simulate, sweep, dataset, new, systems, examples, info, plot, explore, export, resume, extend, paper, cite)
for _command in _COMMANDS:
    app.command()(_command)


def main() -> None:
    """Run the command line."""
    for name in ("SIGTERM", "SIGHUP"):  # which stop a run as Ctrl-C does: at a state that can be resumed
        with contextlib.suppress(AttributeError, ValueError):  # Windows; a thread that is not the main one
            number = getattr(signal, name)
            if signal.getsignal(number) == signal.SIG_DFL:  # nohup has it ignored
                signal.signal(number, signal.default_int_handler)
    try:
        app()
    except OSError as failure:  # a full disk under the standard output; commands report other files
        sys.exit(str(failure))


def _show_version(is_asked: bool) -> None:
    if is_asked:
        typer.echo(f"nonholo {__version__}")
        raise typer.Exit


@app.callback()
def describe(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version and exit.")
    ] = False,
) -> None:
    """Nonholonomic mechanics on Lie groups: simulate tops and sleighs, keep the runs, look at them.

    nonholo simulate suslov             run a built-in scenario
    nonholo simulate snakeboard         run a system of the literature
    nonholo new sleigh > my.toml        write a commented scenario to edit
    nonholo simulate my.toml            run it; the result is kept under runs/
    nonholo sweep sweep.toml            many motions: a grid or random draws
    nonholo dataset sleigh -o sleighs   orbits for people who train models
    nonholo info runs/my-001.zarr       what was run, and how exact it is
    nonholo explore suslov              the live page, in the browser
    nonholo export run.zarr -o run.csv  its poses, for other programs
    nonholo resume run.zarr             resume what stopped, run or sweep
    nonholo examples                    what is known of those systems
    nonholo paper                       the paper behind it, recomputed
    """
