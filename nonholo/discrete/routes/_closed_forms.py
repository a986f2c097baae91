"""The bodies whose step is known in closed form, one entry each, and what their kernels make of a normal form."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from nonholo import kernels
from nonholo.base.checks import is_traced
from nonholo.base.types import Float
from nonholo.systems import NormalForm


class ClosedForm(NamedTuple):
    """A scalar kernel, and the bodies that it is for.

    Attributes:
        covers: Tells whether a planar normal form is one of its bodies.
        body: Makes its body; of many systems in one a body whose fields have an axis in front.
        share: The part of the time step in its momenta, m = share h r.
        rows: C with r_kernel = C r_form; None where its rows are those of the normal form.
    """

    covers: Callable[[NormalForm], bool]
    body: Callable[[NormalForm], kernels.Body]
    share: float
    rows: Float[np.ndarray, "2 2"] | None


def _slides_with_inertia(form: NormalForm) -> bool:
    """A plane sleigh needs a moment about its center of mass."""
    return form.is_sleigh and (is_traced(form.stiffness) or bool(np.all(form.stiffness > 0)))


def _sleigh(form: NormalForm) -> kernels.SleighBody:
    numbers = (form.mass, form.stiffness[..., 0, 0], form.arm)
    return kernels.SleighBody(*(x if is_traced(x) or np.ndim(x) else float(x) for x in numbers))


def _turns(form: NormalForm) -> bool:
    """What does not slide is a top."""
    return not form.is_sleigh


def _top(form: NormalForm) -> kernels.SuslovBody:
    if form.stiffness.ndim > 2:
        return kernels.SuslovBody(*kernels.suslov_table(form.stiffness, form.coupling))
    return kernels.suslov_body(form.stiffness, form.coupling)


_CLOSED_FORMS = (
    ClosedForm(_slides_with_inertia, _sleigh, 1.0, np.diag([-1.0, 1.0])),  # by omega, against e1 ^ e2 of the form
    ClosedForm(_turns, _top, 0.5, None),
)
"""Looked through from the first to the last: one that is for fewer bodies comes first."""


def closed_form(form: NormalForm | None) -> ClosedForm | None:
    """Return the closed form of the step of a body; None where there is none."""
    if form is None or not form.is_planar or form.is_diagonal:
        return None
    return next((closed for closed in _CLOSED_FORMS if closed.covers(form)), None)
