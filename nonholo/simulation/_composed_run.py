"""Runs of compositions that have no compiled step."""

from nonholo._checks import needs
from nonholo.discrete import Discretization
from nonholo.simulation._rule_run import Run


def composed_runner(discrete: Discretization) -> Run:
    """Return the run of a composition by its definition."""
    with needs("jax", "simulate(...) of a step that is not compiled"):
        from nonholo.discrete._composition_definition import run_composed_by_definition

    return lambda *arguments: run_composed_by_definition(discrete, *arguments)
