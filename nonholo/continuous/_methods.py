"""The solver that a method of `flow` names; diffrax is imported on first use, since JAX loads slowly."""

from collections.abc import Callable

from nonholo.base.checks import choice, needs
from nonholo.continuous._arrowhead import momenta_by_series
from nonholo.continuous._closed_form import closed_form
from nonholo.continuous._series import by_series
from nonholo.continuous._solution import Solved
from nonholo.systems import NormalForm


def solver_of(method: str | None, form: NormalForm | None = None) -> Callable[..., Solved]:
    """Return what solves the equations, refused with a method that there is not.

    With a normal form it is what solves for momenta alone, where the method has it.
    """
    choice("flow(method=...)", method, (None, "closed_form", "diffrax"))
    if method is None:
        return by_series if form is None else momenta_by_series
    if method == "closed_form":
        return closed_form
    with needs("jax", "flow(method='diffrax')"):
        from nonholo.continuous._integration_jax import integrate_by_diffrax

    return integrate_by_diffrax
