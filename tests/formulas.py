"""Formulas as a C function of their own, and none that a process remembers."""

from typing import Any

import jax

from nonholo.base.compiled import FUNCTION
from nonholo.lagrange_dalembert.compiled import _flow, _machine, _run
from nonholo.lagrange_dalembert.compiled._machine import machine_code, write_function


def forget() -> None:
    """Forget all formulas of this process; those on disk stay."""
    for each in (_run.programs, _run.values, _flow.formulation, _machine._digest):
        each.cache_clear()
    jax.clear_caches()


def function_of(inputs: list[Any], results: list[Any], search: int = 1) -> Any:
    """Return a C function of inputs and results, of which nothing is kept."""
    addresses, _ = machine_code(lambda module: write_function(module, "function", inputs, results), search=search)
    return FUNCTION(addresses["function"])
