"""Formulas for series: derivatives of functions, and linear equations by elimination."""

import math
from collections.abc import Callable, Sequence
from typing import Any

from nonholo.lagrange_dalembert.compiled._scalars import Formulas, Scalar, UntranslatableError

LINEAR = {"add", "sub", "neg"}
BILINEAR = {"mul", "div"}
Rates = list[tuple[Scalar, Scalar]]
"""Arguments a and g in the rate of a function, the sum of a' g."""


def _over(f: Formulas, above: float, below: Scalar) -> Scalar:
    return f("div", f.constant(above), below)


def _squares(f: Formulas, constant: float, sign: str, x: Scalar) -> Scalar:
    return f(sign, f.constant(constant), f("mul", x, x))


def _root(f: Formulas, x: Scalar) -> Scalar:
    return f("sqrt", x)


_SLOPES: dict[str, Callable[[Formulas, Scalar, Scalar], Scalar]] = {
    "exp": lambda _, _x, y: y,
    "expm1": lambda f, _, y: f("add", y, f.constant(1.0)),
    "log": lambda f, x, _: _over(f, 1.0, x),
    "log1p": lambda f, x, _: _over(f, 1.0, f("add", x, f.constant(1.0))),
    "sqrt": lambda f, _, y: _over(f, 0.5, y),
    "cbrt": lambda f, x, y: f("div", y, f("mul", f.constant(3.0), x)),
    "sin": lambda f, x, _: f("cos", x),
    "cos": lambda f, x, _: f("neg", f("sin", x)),
    "tan": lambda f, _, y: _squares(f, 1.0, "add", y),
    "asin": lambda f, x, _: _over(f, 1.0, _root(f, _squares(f, 1.0, "sub", x))),
    "acos": lambda f, x, _: _over(f, -1.0, _root(f, _squares(f, 1.0, "sub", x))),
    "atan": lambda f, x, _: _over(f, 1.0, _squares(f, 1.0, "add", x)),
    "sinh": lambda f, x, _: f("cosh", x),
    "cosh": lambda f, x, _: f("sinh", x),
    "tanh": lambda f, _, y: _squares(f, 1.0, "sub", y),
    "asinh": lambda f, x, _: _over(f, 1.0, _root(f, _squares(f, 1.0, "add", x))),
    "acosh": lambda f, x, _: _over(f, 1.0, _root(f, f("sub", f("mul", x, x), f.constant(1.0)))),
    "atanh": lambda f, x, _: _over(f, 1.0, _squares(f, 1.0, "sub", x)),
    "erf": lambda f, x, _: f("mul", f.constant(2 / math.sqrt(math.pi)), f("exp", f("neg", f("mul", x, x)))),
}


def rates_of(f: Formulas, y: Scalar) -> Rates:
    """Return how the result of a function moves with its arguments.

    Raises:
        UntranslatableError: It has kinks, as a choice, a comparison and a rounding do.
    """
    if y.operation in _SLOPES:
        rates = [(y.arguments[0], _SLOPES[y.operation](f, y.arguments[0], y))]
    elif y.operation == "pow":
        x, power = y.arguments
        rates = [(x, f("div", f("mul", power, y), x))]
        if power.value is None:
            rates.append((power, f("mul", y, f("log", x))))
    elif y.operation == "atan2":
        above, right = y.arguments
        square = f("add", f("mul", above, above), f("mul", right, right))
        rates = [(above, f("div", right, square)), (right, f("neg", f("div", above, square)))]
    else:
        raise UntranslatableError(y.operation)
    return [(x, slope) for x, slope in rates if x.value is None]


class Elimination:
    r"""Symmetric equations $Kx = b$ of formulas by $K = LDL^T$, without exchange of rows.

    For $K = \begin{pmatrix} M & A^T \\ A & 0 \end{pmatrix}$ it exists if M is positive definite and the rows of A are
    independent; some pivot vanishes otherwise.
    """

    def __init__(self, f: Formulas, matrix: Sequence[Sequence[Scalar]]) -> None:
        self.f, self.lower, self.pivots = f, [], []
        for j, row in enumerate(matrix):
            lower: list[Scalar] = []
            products: list[Scalar] = []
            for i in range(j + 1):
                before = self.lower[i] if i < j else lower
                products.append(self._less(row[i], products, before))
                if i < j:
                    lower.append(self._quotient(products[i], self.pivots[i]))
            if products[j].value == 0:
                raise UntranslatableError("a pivot is zero")
            self.lower.append(lower)
            self.pivots.append(products[j])

    def _less(self, x: Scalar, left: Sequence[Scalar], right: Sequence[Scalar]) -> Scalar:
        """Return x less a sum of products; those with zero are left out."""
        for a, b in zip(left, right, strict=False):
            x = x if a.value == 0 or b.value == 0 else self.f("sub", x, self.f("mul", a, b))
        return x

    def _quotient(self, x: Scalar, pivot: Scalar) -> Scalar:
        return x if x.value == 0 else self.f("div", x, pivot)

    def solution(self, b: Sequence[Scalar]) -> list[Scalar]:
        """Return x."""
        ahead: list[Scalar] = []
        for i, x in enumerate(b):
            ahead.append(self._less(x, self.lower[i], ahead))
        x = [self._quotient(each, pivot) for each, pivot in zip(ahead, self.pivots, strict=True)]
        for i in reversed(range(len(x))):
            below = range(i + 1, len(x))
            x[i] = self._less(x[i], [self.lower[k][i] for k in below], [x[k] for k in below])
        return x


def bordered_elimination(f: Formulas, mass: Any, rows: Any) -> Elimination:
    """Return the elimination of the matrix of kinetic energy bordered by rows of constraints."""
    below = [[*row, *[f.constant(0.0)] * len(rows)] for row in rows]
    above = [[*row, *(each[i] for each in rows)] for i, row in enumerate(mass)]
    return Elimination(f, [*above, *below])
