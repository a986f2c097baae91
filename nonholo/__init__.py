"""Geometric mechanics of nonholonomic systems: bodies whose velocity, but not whose position, is constrained."""

import importlib
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from nonholo import plotting as plot
    from nonholo._results import Outcome, OutcomeError
    from nonholo.analysis import invariants
    from nonholo.discrete import Discretization, discrete_legendre, discretize
    from nonholo.groups import SE, SO
    from nonholo.orbit import Orbit
    from nonholo.simulation import simulate
    from nonholo.systems import ChaplyginSleigh, SuslovTop

_HOMES = {
    "Outcome": "_results",
    "OutcomeError": "_results",
    "SE": "groups",
    "SO": "groups",
    "ChaplyginSleigh": "systems",
    "SuslovTop": "systems",
    "Discretization": "discrete",
    "discrete_legendre": "discrete",
    "discretize": "discrete",
    "Orbit": "orbit",
    "invariants": "analysis",
    "simulate": "simulation",
}

__version__ = version("nonholo")


def __getattr__(name: str) -> Any:
    if name == "plot":
        return importlib.import_module("nonholo.plotting")
    if name not in _HOMES:
        raise AttributeError(f"module 'nonholo' has no attribute {name!r}")
    return getattr(importlib.import_module(f"nonholo.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return sorted([*_HOMES, "plot"])
