"""Sweeps: designs of many members, tasks that run them, one store for the result; Dask is used only here."""

from nonholo.ensembles._dataset import dataset
from nonholo.ensembles._ensemble_task import EnsembleTask
from nonholo.ensembles._family_task import FamilyTask
from nonholo.ensembles._names import STARTS, component_name, component_of, force_numbers, start_component
from nonholo.ensembles._reductions import REDUCTIONS
from nonholo.ensembles._sweep import functions_of, load_sweep, resume, sweep, sweep_to_csv
from nonholo.ensembles.datasets import DEFINITIONS
from nonholo.ensembles.designs import AbstractDesign, MemberBlock
from nonholo.ensembles.distributions import AbstractDistribution
from nonholo.ensembles.stores import SweepStanding, standing_of
