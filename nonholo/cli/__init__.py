"""The command `nonholo`: one file per subcommand in `commands`, which imports heavy rooms where it needs them."""

from nonholo.cli._app import main
