"""Geometric mechanics of nonholonomic systems: bodies whose velocity, but not whose position, is constrained."""

import importlib
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from nonholo import plotting as plot  # noqa: F401
    from nonholo._results import Outcome as Outcome
    from nonholo._results import OutcomeError as OutcomeError
    from nonholo.analysis import invariants as invariants
    from nonholo.continuous import vector_field as vector_field
    from nonholo.discrete import (
        Discretization as Discretization,
    )
    from nonholo.discrete import (
        discrete_legendre as discrete_legendre,
    )
    from nonholo.discrete import (
        discretize as discretize,
    )
    from nonholo.discrete._precision import allow_float32 as allow_float32
    from nonholo.discrete._step import step as step
    from nonholo.groups import SE as SE
    from nonholo.groups import SO as SO
    from nonholo.io import load_orbit as load_orbit
    from nonholo.io import save_orbit as save_orbit
    from nonholo.orbit import Orbit as Orbit
    from nonholo.simulation import flow as flow
    from nonholo.simulation import simulate as simulate
    from nonholo.systems import ChaplyginSleigh as ChaplyginSleigh
    from nonholo.systems import SuslovTop as SuslovTop

_HOMES = {
    "Outcome": "_results",
    "OutcomeError": "_results",
    "SE": "groups",
    "SO": "groups",
    "load_orbit": "io",
    "save_orbit": "io",
    "ChaplyginSleigh": "systems",
    "SuslovTop": "systems",
    "Discretization": "discrete",
    "allow_float32": "discrete._precision",
    "discrete_legendre": "discrete",
    "discretize": "discrete",
    "step": "discrete._step",
    "Orbit": "orbit",
    "flow": "simulation",
    "invariants": "analysis",
    "simulate": "simulation",
    "vector_field": "continuous",
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
