r"""The equations of `_branch_equations` with the doubles of a system taken as exact rational numbers.

Everything of the dimension of an inertia is an integer here, after multiplication by one power of two. Axes are those
of the body: nothing is diagonalized.

Reference: docs/theory/branches.md, "Certificates".
"""

from typing import NamedTuple

import numpy as np
from flint import fmpq, fmpq_mat, fmpz, fmpz_mat

from nonholo.systems import NormalForm

_ZERO = fmpq(0)


class Lever(NamedTuple):
    """Parameters of a sleigh that a top lacks, in units of length: a_1, h p_1/m, the center of mass across axis 1."""

    arm: fmpq
    push: fmpq
    offset: list[fmpq]
    moment: fmpq  # m a_1 in the unit of inertia of the problem


class Problem(NamedTuple):
    r"""The equations $(B + \mu)y = sd + c$, $\mu = \tfrac12 s\hat p - c\cdot y$, $s = 1 + y\cdot y$ in integers."""

    stiffness: fmpz_mat
    coupling: list[fmpz]
    excess: list[fmpz]  # d = r - c
    half: fmpz  # half of p-hat
    lever: Lever | None


def problem_of(form: NormalForm, time_step: float, momentum: np.ndarray) -> Problem:
    """Return the exact problem of a body, in its own doubles, for canonical restricted momenta."""
    h = _exact(time_step)
    p = [h * _exact(x) for x in (momentum if form.frame_map is None else form.frame_map @ momentum).tolist()]
    B, c = _stiffness(_rows(form.across), _exact(form.along)), [_exact(x) for x in form.coupling]
    if not form.is_sleigh:
        return _problem(B, c, [x / 2 for x in p])
    a, m, offset = _exact(form.arm), _exact(form.mass), [_exact(x) for x in form.offset]
    r = [(x - o * p[-1]) / 2 for x, o in zip(p[:-1], offset, strict=True)]
    return _problem(B, c, r, a * p[-1] / 2 + m * a * a, (a, p[-1] / m, offset, m * a))


def _problem(B: list, c: list, r: list, half: fmpq = _ZERO, lever: tuple | None = None) -> Problem:
    d = [x - y for x, y in zip(r, c, strict=True)]
    whole_B, denominator = fmpq_mat(B).numer_denom()
    unit = max(denominator, *(x.q for x in (*c, *d, half)))

    def whole(x: fmpq) -> fmpz:
        return (x * unit).p

    exact = None
    if lever is not None:
        arm, push, offset, moment = lever
        exact = Lever(arm, push, offset, moment * unit)
    return Problem(whole_B * (unit // denominator), [whole(x) for x in c], [whole(x) for x in d], whole(half), exact)


def _stiffness(rows: list[list[fmpq]], diagonal: fmpq) -> list[list[fmpq]]:
    return [[x + diagonal if i == j else x for j, x in enumerate(row)] for i, row in enumerate(rows)]


def _rows(matrix: np.ndarray) -> list[list[fmpq]]:
    return [[_exact(x) for x in row] for row in np.asarray(matrix).tolist()]


def _exact(x: float) -> fmpq:
    return fmpq(*float(x).as_integer_ratio())
