"""`nonholo systems`: what there is to simulate."""


def systems() -> None:
    """List the bodies that a scenario can hold, with their parameters, and the built-in scenarios.

    nonholo systems
    nonholo new suslov > my.toml        a scenario to edit
    """
    import tomllib

    from rich.console import Console
    from rich.table import Table

    from nonholo.cli.scenario.bodies import BODIES
    from nonholo.cli.scenario.files import built_in

    bodies = Table("kind", "what it is", "parameters", title="Bodies", title_justify="left")
    for kind, body in BODIES.items():
        bodies.add_row(kind, body.__doc__, ", ".join(name for name in body.model_fields if name != "kind"))
    scenarios = Table("name", "what happens", title="Built-in scenarios", title_justify="left")
    for name, text in built_in().items():
        scenarios.add_row(name, tomllib.loads(text)["title"])
    console = Console()
    console.print(bodies, scenarios)
