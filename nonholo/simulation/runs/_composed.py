"""Runs of compositions that have no compiled step."""

from nonholo.discrete import Discretization
from nonholo.simulation.runs._by_rule import Run


def composed_runner(discrete: Discretization) -> Run:
    """Return the run of a composition by its definition."""
    from nonholo.discrete._composition_definition import run_composed_by_definition

    return lambda *arguments: run_composed_by_definition(discrete, *arguments)
