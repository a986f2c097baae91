"""The solver that a method of `flow` names; diffrax is imported on first use, since JAX loads slowly."""

import functools
from collections.abc import Callable

from nonholo.base.checks import choice, error, needs
from nonholo.continuous._arrowhead import momenta_by_series
from nonholo.continuous._closed_form import closed_form
from nonholo.continuous._linear_forces import under_forces
from nonholo.continuous._series import by_series
from nonholo.continuous._solution import Solved
from nonholo.systems import System, refuse_slip


def solver_of(
    system: System, method: str | None, begins: float, *, reconstruct: bool
) -> tuple[Callable[..., Solved], bool]:
    """Return what solves the equations from a time on, and whether with poses; refuse an unknown method."""
    refuse_slip("flow(system=...)", system)
    choice("flow(method=...)", method, (None, "closed_form", "diffrax"))
    if system.forces is not None:
        if method is not None:
            remedy = "Leave it out: the forces say which one it is."
            raise error("flow(method=...)", "be None under forces", repr(method), remedy)
        return functools.partial(under_forces, system.forces, begins), True
    alone = not reconstruct and method is None and system.canonical.normal_form is not None
    return functools.partial(_named(method, alone=alone), system.canonical), not alone


def _named(method: str | None, *, alone: bool) -> Callable[..., Solved]:
    if method is None:
        return momenta_by_series if alone else by_series
    if method == "closed_form":
        return closed_form
    with needs("jax", "flow(method='diffrax')"):
        from nonholo.continuous._integration_jax import integrate_by_diffrax

    return integrate_by_diffrax
