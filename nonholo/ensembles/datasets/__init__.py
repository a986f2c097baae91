"""Data sets of orbits of ready systems for people who train models: their definitions, task, tables and record."""

from nonholo.ensembles.datasets._definitions import DEFINITIONS, system_of
from nonholo.ensembles.datasets._record import card, record_of
from nonholo.ensembles.datasets._tables import write_tables
from nonholo.ensembles.datasets._task import SPLITS, DatasetTask, dataset_task_from
