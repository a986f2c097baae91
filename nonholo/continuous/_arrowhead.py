r"""Momenta of tops and sleighs without poses, in O(n) operations a Taylor coefficient.

In the principal axes of B, with $D = B + ma_1^2$, $\pi = Dw$ and $p_1 = mu$ (`NormalForm`), the momenta along the rows
of the form are $(\pi + \alpha p_1, p_1)$. The kernel's numbers are $\pi/\sqrt D$ and $p_1/\sqrt m$.
"""

import functools
from typing import cast

import numpy as np

from nonholo.base.numerics import applied
from nonholo.base.results import Outcome
from nonholo.base.types import Float
from nonholo.continuous._series import GUARD, Problem, Solved, States, power_of_two
from nonholo.kernels import Arrowhead, solve_arrowhead
from nonholo.orbit import looked_at
from nonholo.systems import AbstractSystem, NormalForm


def momenta_by_series(system: AbstractSystem, problem: Problem) -> Solved:
    """Solve for the momenta of a top or sleigh, without its pose."""
    form, elapsed, tolerance = cast(NormalForm, system.normal_form), problem.elapsed, problem.tolerances[0] * GUARD
    f, x = equations(form)[0], encode(form, problem.momentum)
    unit = power_of_two(np.append(np.sqrt(f.rates) * x, f.rates.max() * (f.coupling @ x)))
    start, end = np.zeros((2, len(x) + 1)), float(elapsed[-1]) * unit
    start[0, :-1] = x / unit
    rows, nodes = solve_arrowhead(f, start, elapsed[1:] * unit, end, tolerance)
    outcome = Outcome.successful if len(rows) == len(elapsed) - 1 else Outcome.not_converged
    states = States(decode(form, np.vstack([start[0, :-1], rows]) * unit), None, None)
    at = functools.partial(_between, form, nodes, unit, end, tolerance)
    ends = [*(node[0, -1] for node in nodes), end]
    return Solved(states, outcome, at, functools.partial(looked_at, ends, unit))


def _between(
    form: NormalForm, nodes: list[np.ndarray], unit: float, end: float, tolerance: float, elapsed: np.ndarray
) -> States:
    """Return the states at times since the start, in the order of the solve, from the nodes before them."""
    f, times, begins = equations(form)[0], elapsed * unit, np.array([node[0, -1] for node in nodes])
    backward = np.copysign(1.0, end)
    after = np.maximum(np.searchsorted(backward * begins, backward * times) - 1, 0)
    parts = (solve_arrowhead(f, nodes[node], times[after == node], end, tolerance)[0] for node in np.unique(after))
    return States(decode(form, np.concatenate([np.empty((0, len(f.rates))), *parts]) * unit), None, None)


def equations(form: NormalForm) -> tuple[Arrowhead, Float[np.ndarray, "k"]]:
    r"""Return the equations that the kernel solves, and the units $\sqrt D$, of a sleigh then $\sqrt m$."""
    b, c = form.principal[0], form.to_principal(form.coupling)
    if not form.is_sleigh:
        return Arrowhead(1 / b, c / np.sqrt(b)), np.sqrt(b)
    D, slide = b + form.mass * form.arm**2, np.sqrt(form.mass)
    f = Arrowhead(np.append(1 / D, 0.0), np.append(c / np.sqrt(D), -form.arm * slide))
    return f, np.append(np.sqrt(D), slide)


def encode(form: NormalForm, momentum: Float[np.ndarray, "k"]) -> Float[np.ndarray, "k"]:
    """Return the numbers of the kernel from canonical momenta."""
    r = momentum if form.frame_map is None else form.frame_map @ momentum
    return form.to_principal(form.turned_about(r, -1.0)) / equations(form)[1]


def decode(form: NormalForm, rows: Float[np.ndarray, "K k"]) -> Float[np.ndarray, "K k"]:
    """Return canonical momenta from the numbers of the kernel."""
    momenta = form.turned_about(form.from_principal(rows * equations(form)[1]), 1.0)
    return momenta if form.frame_map is None else applied(np.linalg.inv(form.frame_map), momenta)
