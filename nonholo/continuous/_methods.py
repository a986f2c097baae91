"""The solver that a method of `flow` names; diffrax is imported on first use, since JAX loads slowly."""

import functools
from collections.abc import Callable

from nonholo.base.checks import choice, error, needs
from nonholo.continuous._closed_form import closed_form
from nonholo.continuous._forced import by_runge_kutta
from nonholo.continuous._series import by_series
from nonholo.continuous._solution import Solved
from nonholo.systems import AbstractSystem


def solver_for(system: AbstractSystem, begins: float, method: str | None) -> Callable[..., Solved]:
    """Return what solves the equations of a system from a time on; those with forces are solved by DOP853 alone."""
    solver, forced = solver_of(method), system.forces
    if forced is None:
        return functools.partial(solver, system.canonical)
    if method is not None:
        remedy = "Leave it out: forces are integrated by DOP853."
        raise error("flow(method=...)", "be None under forces", repr(method), remedy)
    return functools.partial(by_runge_kutta, forced, begins)


def solver_of(method: str | None) -> Callable[..., Solved]:
    """Return what solves the equations, refused with a method that there is not."""
    choice("flow(method=...)", method, (None, "closed_form", "diffrax"))
    if method is None:
        return by_series
    if method == "closed_form":
        return closed_form
    with needs("jax", "flow(method='diffrax')"):
        from nonholo.continuous._integration_jax import integrate_by_diffrax

    return integrate_by_diffrax
