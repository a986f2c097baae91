"""Data sets of orbits of ready systems for people who train models: their definitions, task, tables and record."""

from nonholo.ensembles.datasets._definitions import DEFINITIONS, SPLITS, DatasetTask, dataset_task_from, system_of
from nonholo.ensembles.datasets._record import card, record_of, write_tables
