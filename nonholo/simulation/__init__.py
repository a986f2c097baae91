"""Entry points that run a motion: loops, thinning, outcomes."""

from nonholo.simulation._blocks import iterate
from nonholo.simulation._ensemble import ensemble
from nonholo.simulation._ensemble_result import Ensemble
from nonholo.simulation._flow import flow
from nonholo.simulation._resume import extend, resume
from nonholo.simulation._simulate import simulate

__all__ = ["Ensemble", "ensemble", "extend", "flow", "iterate", "resume", "simulate"]
