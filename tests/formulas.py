"""Formulas as a C function of their own."""

from typing import Any

from nonholo.base.compiled import FUNCTION
from nonholo.lagrange_dalembert.compiled._machine import machine_code, write_function


def function_of(inputs: list[Any], results: list[Any], search: int = 1) -> Any:
    """Return a C function of inputs and results, of which nothing is kept."""
    addresses, _ = machine_code(lambda module: write_function(module, "function", inputs, results), search=search)
    return FUNCTION(addresses["function"])
