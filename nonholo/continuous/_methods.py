"""The solver that a method of `flow` names; diffrax is imported on first use, since JAX loads slowly."""

from collections.abc import Callable
from typing import Any

from nonholo.base.checks import choice, needs
from nonholo.continuous._closed_form import closed_form
from nonholo.continuous._integration import Solved, by_runge_kutta
from nonholo.continuous._series import by_series
from nonholo.systems import AbstractSystem


def solver_of(method: str | None) -> Callable[..., Any]:
    """Return what solves the equations, refused with a method that there is not."""
    choice("flow(method=...)", method, (None, "closed_form", "diffrax"))
    if method is None:
        return _numerical
    if method == "closed_form":
        return closed_form
    with needs("jax", "flow(method='diffrax')"):
        from nonholo.continuous._integration_jax import integrate_by_diffrax

    return integrate_by_diffrax


def usual_tolerance(system: AbstractSystem, method: str | None) -> float:
    """Return the relative error of a step where none is asked for: a series is as quick when it is exact."""
    return 1e-14 if method is None and not system.is_spatial else 1e-10


def _numerical(system: AbstractSystem, *rest: Any, tolerances: tuple[float, float]) -> Solved:
    return (by_runge_kutta if system.is_spatial else by_series)(system, *rest, tolerances)
