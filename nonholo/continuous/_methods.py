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
    """Return what solves the equations of a system from a time on, refused with a method that it does not have."""
    choice("flow(method=...)", method, (None, "closed_form", "diffrax"))
    if system.forces is not None:
        if method is not None:
            remedy = "Leave it out: forces are integrated by DOP853."
            raise error("flow(method=...)", "be None under forces", repr(method), remedy)
        return functools.partial(by_runge_kutta, system.forces, begins)
    if method != "diffrax":
        return functools.partial(closed_form if method else by_series, system.canonical)
    with needs("jax", "flow(method='diffrax')"):
        from nonholo.continuous._integration_jax import integrate_by_diffrax

    return functools.partial(integrate_by_diffrax, system.canonical)
