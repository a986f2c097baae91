"""The store of a sweep: how it is cut, what a task returns, its progress, its poses as CSV."""

from nonholo.ensembles.stores._poses_csv import sweep_to_csv
from nonholo.ensembles.stores._results import OUTCOME, RAISED, Output, Results, Task, attempt, probe_outputs
from nonholo.ensembles.stores._store import (
    SCHEMA,
    Mark,
    SweepStanding,
    SweepStore,
    attributes_of,
    create_store,
    layout_of,
    open_store,
    opened_result,
    standing_of,
    store_of,
)
