"""The subcommands that say what there is, and run nothing."""
