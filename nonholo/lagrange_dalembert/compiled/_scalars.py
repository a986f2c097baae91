"""Formulas of single numbers: each operation made once, constants computed, zeros left out."""

from collections.abc import Collection
from typing import Any

import numpy as np

from nonholo.lagrange_dalembert.compiled._operations import OPERATIONS, TRUTHS

_MOST = 200_000  # operations asked for: those of 50 coordinates; beyond, JAX is sooner ready


class UntranslatableError(Exception):
    """A JAX program cannot be had as formulas."""


class Scalar:
    """A number of a formula: an input, a constant, or the result of an operation.

    Attributes:
        operation: The name of the operation; "constant" and "input" are none.
        arguments: What it acts on.
        value: That of a constant, else None.
        varies: Whether it depends on an input that varies.
        is_total: Whether it is finite wherever the inputs are, overflow apart.
        is_truth: Whether it is true or false.
    """

    __slots__ = ("arguments", "is_total", "is_truth", "operation", "value", "varies")

    def __init__(
        self, operation: str, arguments: tuple["Scalar", ...] = (), value: Any = None, varies: bool = False
    ) -> None:
        self.operation, self.arguments, self.value = operation, arguments, value
        self.varies = varies or any(each.varies for each in arguments)
        self.is_total = operation not in OPERATIONS or (
            OPERATIONS[operation].is_total and all(each.is_total for each in arguments)
        )
        chooses_truth = operation == "select" and arguments[1].is_truth
        self.is_truth = chooses_truth or operation in TRUTHS or value is True or value is False


class Formulas:
    """Makes the numbers of formulas, each one once.

    0 x becomes 0, and so does 0 / x: derivatives are full of them. That is wrong where x is not finite, or zero. So the
    product joins `doubts`, which are 0 wherever the formulas may be trusted, unless x is always finite.
    """

    def __init__(self) -> None:
        self.doubts: dict[Scalar, None] = {}
        self._made: dict[Any, Scalar] = {}
        self._asked = 0

    def constant(self, value: Any) -> Scalar:
        """Return a constant."""
        number = np.asarray(value).item()
        return self._made.setdefault((type(number), repr(number)), Scalar("constant", value=number))

    def __call__(self, name: str, *arguments: Scalar) -> Scalar:
        """Return the result of an operation."""
        self._asked += 1
        if self._asked > _MOST:
            raise UntranslatableError("too many operations")
        if all(each.value is not None for each in arguments):
            with np.errstate(all="ignore"):
                return self.constant(OPERATIONS[name].evaluate(*(each.value for each in arguments)))
        return self._shorter(name, arguments) or self._result(name, arguments)

    def _result(self, name: str, arguments: tuple[Scalar, ...]) -> Scalar:
        key = name, arguments
        return self._made.get(key) or self._made.setdefault(key, Scalar(name, arguments))

    def _shorter(self, name: str, arguments: tuple[Scalar, ...]) -> Scalar | None:
        """Return what an operation with 0 or 1, or a choice that is fixed, comes to."""
        first, last = arguments[0], arguments[-1]
        if name == "select":
            truth = True if arguments[1] is last else first.value
            return None if truth is None else last if truth else arguments[1]
        rule = _IF_FIRST.get((name, first.value)) or _IF_LAST.get((name, last.value))
        return rule and rule(self, name, first, last)

    def _zero(self, name: str, *factors: Scalar) -> Scalar:
        product = self._result(name, factors)
        if not product.is_total:
            self.doubts[product] = None
        return self.constant(0.0)


_IF_FIRST: dict[Any, Any] = {
    **dict.fromkeys([("mul", 0), ("div", 0)], Formulas._zero),
    **dict.fromkeys([("add", 0), ("mul", 1)], lambda _f, _name, _, y: y),
    **dict.fromkeys([("sub", 0), ("mul", -1)], lambda f, _name, _, y: f("neg", y)),
}
_IF_LAST: dict[Any, Any] = {
    ("mul", 0): Formulas._zero,
    **dict.fromkeys([("add", 0), ("sub", 0), ("mul", 1), ("div", 1)], lambda _f, _name, x, _: x),
}


def operations_between(results: Collection[Scalar], inputs: Collection[Scalar]) -> list[Scalar]:
    """Return the operations between given numbers and results, each after those that it acts on."""
    order: dict[Scalar, None] = {}
    start, stack = set(inputs), list(results)
    while stack:
        each = stack[-1]
        waiting = [] if each in start else [other for other in each.arguments if other not in order]
        waiting = [other for other in waiting if other not in start]
        if waiting:
            stack += waiting
        else:
            order.setdefault(stack.pop())
    return [each for each in order if each.arguments and each not in start]
