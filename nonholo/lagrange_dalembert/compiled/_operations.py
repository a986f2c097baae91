"""The operations on single numbers: the value of constants, and the instruction of the processor."""

import operator
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import scipy.special
from llvmlite import ir

DOUBLE, TRUTH = ir.DoubleType(), ir.IntType(1)


class Operation(NamedTuple):
    """An operation.

    Attributes:
        evaluate: The function of constants.
        emit: Maps a builder of LLVM code and arguments to the result.
        is_total: Whether finite arguments have a finite result, overflow apart.
    """

    evaluate: Callable[..., Any]
    emit: Callable[..., Any]
    is_total: bool = True


def _instruction(name: str) -> Callable[..., Any]:
    return lambda builder, *arguments: getattr(builder, name)(*arguments)


def _function(name: str) -> Callable[..., Any]:
    """Call a function of the C library, or what LLVM knows as an instruction."""

    def emit(builder: ir.IRBuilder, *arguments: Any) -> Any:
        kind = ir.FunctionType(DOUBLE, [DOUBLE] * len(arguments))
        return builder.call(builder.module.globals.get(name) or ir.Function(builder.module, kind, name), arguments)

    return emit


def _comparison(sign: str) -> Callable[..., Any]:
    name = "fcmp_unordered" if sign == "!=" else "fcmp_ordered"
    return lambda builder, a, b: getattr(builder, "icmp_unsigned" if a.type == TRUTH else name)(sign, a, b)


_COMPARISONS = {"lt": "<", "le": "<=", "gt": ">", "ge": ">=", "eq": "==", "ne": "!="}
LOGIC = {"and", "or", "not"}
TRUTHS = LOGIC.union(_COMPARISONS)

_TOTAL = {"sin": np.sin, "cos": np.cos, "tanh": np.tanh, "atan": np.arctan, "atan2": np.arctan2, "asinh": np.arcsinh}
_TOTAL |= {"cbrt": np.cbrt, "erf": scipy.special.erf, "floor": np.floor, "ceil": np.ceil, "rint": np.rint}
_PARTIAL = {"exp": np.exp, "log": np.log, "pow": np.power, "sqrt": np.sqrt, "tan": np.tan, "asin": np.arcsin}
_PARTIAL |= {"acos": np.arccos, "sinh": np.sinh, "cosh": np.cosh, "acosh": np.arccosh, "atanh": np.arctanh}
_PARTIAL |= {"expm1": np.expm1, "log1p": np.log1p}
_OF_LLVM = {"sin", "cos", "exp", "log", "pow", "sqrt", "floor", "ceil", "rint"}


def _functions(table: dict[str, Callable[..., Any]], is_total: bool) -> dict[str, Operation]:
    names = {name: f"llvm.{name}.f64" if name in _OF_LLVM else name for name in table}
    return {name: Operation(table[name], _function(symbol), is_total) for name, symbol in names.items()}


OPERATIONS: dict[str, Operation] = {
    "add": Operation(operator.add, _instruction("fadd")),
    "sub": Operation(operator.sub, _instruction("fsub")),
    "mul": Operation(operator.mul, _instruction("fmul")),
    "div": Operation(np.true_divide, _instruction("fdiv"), is_total=False),
    "rem": Operation(np.fmod, _instruction("frem"), is_total=False),
    "neg": Operation(operator.neg, _instruction("fneg")),
    "abs": Operation(abs, _function("llvm.fabs.f64")),
    "max": Operation(np.maximum, _function("llvm.maximum.f64")),
    "min": Operation(np.minimum, _function("llvm.minimum.f64")),
    "not": Operation(operator.not_, _instruction("not_")),
    "float": Operation(float, lambda builder, truth: builder.uitofp(truth, DOUBLE)),
    "select": Operation(
        lambda which, no, yes: yes if which else no, lambda builder, which, no, yes: builder.select(which, yes, no)
    ),
    **{name: Operation(getattr(operator, name), _comparison(sign)) for name, sign in _COMPARISONS.items()},
    "and": Operation(operator.and_, _instruction("and_")),
    "or": Operation(operator.or_, _instruction("or_")),
    **_functions(_TOTAL, True),
    **_functions(_PARTIAL, False),
}
