"""Runs that are written to a store block by block, in bounded memory, and can stop at any moment."""

from nonholo.simulation.stores._same_events import watch_of_store
from nonholo.simulation.stores._same_functions import refuse_other_functions
from nonholo.simulation.stores._stored_run import (
    continue_run,
    refuse_without_store,
    rows_of_block,
    run_into_store,
    size_in_blocks,
)

__all__ = [
    "continue_run",
    "refuse_other_functions",
    "refuse_without_store",
    "rows_of_block",
    "run_into_store",
    "size_in_blocks",
    "watch_of_store",
]
