"""Sweeps: designs of many members, tasks that run them, one store for the result; Dask is used only here."""

from nonholo.ensembles._begin import functions_of
from nonholo.ensembles._block import MemberBlock
from nonholo.ensembles._design import AbstractDesign, Grid, RandomDesign
from nonholo.ensembles._distributions import (
    AbstractDistribution,
    Choice,
    Direction,
    LogUniform,
    MassTensor,
    Normal,
    Uniform,
)
from nonholo.ensembles._ensemble_task import EnsembleTask
from nonholo.ensembles._names import component_name
from nonholo.ensembles._poses_csv import sweep_to_csv
from nonholo.ensembles._reductions import REDUCTIONS
from nonholo.ensembles._resume import resume
from nonholo.ensembles._standing import SweepStanding, standing_of
from nonholo.ensembles._sweep import load_sweep, sweep

__all__ = [
    "REDUCTIONS",
    "AbstractDesign",
    "AbstractDistribution",
    "Choice",
    "Direction",
    "EnsembleTask",
    "Grid",
    "LogUniform",
    "MassTensor",
    "MemberBlock",
    "Normal",
    "RandomDesign",
    "SweepStanding",
    "Uniform",
    "component_name",
    "functions_of",
    "load_sweep",
    "resume",
    "standing_of",
    "sweep",
    "sweep_to_csv",
]
