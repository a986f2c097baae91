"""The command `nonholo`: one file per subcommand in `commands`; heavy rooms are imported inside the commands that need them."""

from nonholo.cli._app import main

__all__ = ["main"]
