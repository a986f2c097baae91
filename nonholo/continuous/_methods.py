"""The solver that a method of `flow` names. The adaptive one is imported on first use, since JAX loads slowly."""

from collections.abc import Callable
from typing import Any

from nonholo.continuous._closed_form import closed_form


def solver_of(method: str | None) -> Callable[..., Any]:
    """Return the closed form, or for None the adaptive Runge-Kutta method."""
    if method == "closed_form":
        return closed_form
    from nonholo.continuous._integration import integrate

    return integrate
