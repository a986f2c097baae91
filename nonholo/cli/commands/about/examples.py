"""`nonholo examples`: the ready systems and scenarios, and what is known about one of them."""

from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from nonholo.examples import Example


def examples(
    name: Annotated[str | None, typer.Argument(metavar="[NAME]", help="One of those that are listed.")] = None,
) -> None:
    """List the ready systems of the literature and the built-in scenarios; of one, show what is known.

    Ready systems are for Python, scenarios for `nonholo simulate` and `explore`.

    nonholo examples
    nonholo examples snakeboard
    nonholo examples suslov
    """
    import tomllib

    from nonholo.base.checks import needs
    from nonholo.cli.scenario.files import built_in
    from nonholo.cli.scenario.problems import suggestion
    from nonholo.cli.screen.errors import USAGE, leave, store_errors

    scenarios = {each: tomllib.loads(text)["title"] for each, text in built_in().items()}
    if name in scenarios:
        typer.echo(
            f"{name}: {scenarios[name]}\n\n  nonholo simulate {name}\n  nonholo explore {name}\n  nonholo new {name}"
        )
        return
    with store_errors(USAGE), needs("jax", "nonholo examples"):
        import nonholo.examples as library

    ready = {each: getattr(library, each) for each in library.__all__ if each != "Example"}
    if name is None:
        _show_all({each: (make.__doc__ or "").split("\n")[0] for each, make in ready.items()}, scenarios)
    elif name in ready:
        _show(ready[name]())
    else:
        leave(f"There is no ready system or scenario {name!r}. {suggestion(name, [*ready, *scenarios])}", USAGE)


def _show_all(ready: dict[str, str], scenarios: dict[str, str]) -> None:
    from rich.console import Console
    from rich.table import Table

    for title, rows in {"Ready systems, nonholo.examples": ready, "Built-in scenarios": scenarios}.items():
        table = Table("name", "what it is", title=title, title_justify="left")
        for row in rows.items():
            table.add_row(*row)
        Console().print(table)


def _show(example: "Example") -> None:
    """Print the start, the facts and the conserved quantities of a system, and how to run it."""
    import inspect

    import nonholo.examples as library

    about = inspect.getdoc(getattr(library, example.name)) or ""
    parts: dict[str, list[Any]] = {
        "Start": [
            f"coordinates: {', '.join(example.coordinates)}",
            f"configuration: {example.configuration.tolist()}",
            f"velocity: {example.body_velocity.round(12).tolist()}",
        ],
        "Facts": [*example.facts],
        "Conserved along the motion": [*example.conserved],
        "In Python": [
            f"ready = nh.examples.{example.name}()",
            "discrete = nh.discretize(ready.system, 0.05)",
            "start = dict(configuration=ready.configuration, body_velocity=ready.body_velocity)",
            "orbit = nh.simulate(discrete, **start, steps=400)",
        ],
    }
    typer.echo(about.split("\n")[0])
    for title, lines in parts.items():
        if lines:
            typer.echo("\n".join([f"\n{title}", *(f"  {line}" for line in lines)]))
