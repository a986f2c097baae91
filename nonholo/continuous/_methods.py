"""The solver that a method of `flow` names; diffrax is imported on first use, since JAX loads slowly."""

from collections.abc import Callable

from nonholo.base.checks import choice, needs
from nonholo.continuous._closed_form import closed_form
from nonholo.continuous._series import by_series
from nonholo.continuous._solution import Solved


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
