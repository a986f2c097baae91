"""Formulas of single numbers: operations, each result made once, constants computed, zeros left out."""

import math
import operator
from collections.abc import Callable, Collection
from typing import Any, NamedTuple

import numpy as np
from llvmlite import ir

DOUBLE, TRUTH = ir.DoubleType(), ir.IntType(1)


class Operation(NamedTuple):
    """An operation.

    Attributes:
        evaluate: The function of constants.
        emit: Maps a module of LLVM code and arguments, each with its type, to an instruction.
        is_total: Whether finite arguments have a finite result, overflow apart.
    """

    evaluate: Callable[..., Any]
    emit: Callable[..., str]
    is_total: bool = True


class Text(ir.Instruction):
    """Lines of LLVM code at the end of a builder's block, whose text costs a fraction of objects for each.

    Unless the type is void they have the value of the last one.
    """

    def __init__(self, builder: Any, kind: ir.Type, text: str) -> None:
        super().__init__(builder.block, kind, "text", ())
        self.text = text
        builder.block.instructions.append(self)
        builder.position_at_end(builder.block)

    def descr(self, buf: list[str]) -> None:
        """Write the lines."""
        buf.append(self.text)


def reference(value: Any) -> str:
    """Return how an instruction refers to a value."""
    return f"{value.type} {value.get_reference()}"


def _instruction(name: str, end: str = "") -> Callable[..., str]:
    return lambda _, first, *others: ", ".join([f"{name} {first}", *(x.split()[1] for x in others)]) + end


def _function(name: str) -> Callable[..., str]:
    """Call a function of the C library, or what LLVM knows as an instruction."""

    def emit(module: ir.Module, *arguments: str) -> str:
        if name not in module.globals:
            ir.Function(module, ir.FunctionType(DOUBLE, [DOUBLE] * len(arguments)), name)
        return f"call double @{name}({', '.join(arguments)})"

    return emit


def _comparison(name: str) -> Callable[..., str]:
    of_truths, of_doubles = f"icmp {name}", f"fcmp {'u' if name == 'ne' else 'o'}{name}"
    return lambda _, a, b: f"{of_truths if a.startswith(str(TRUTH)) else of_doubles} {a}, {b.split()[1]}"


def _look_up(module: ir.Module, *arguments: str) -> str:
    """Call a function that is made once: of an address, a step, a column and the length of rows.

    At the address stand the number of rows and the rows, the last one zero, which steps outside have.
    """
    if "look" not in module.globals:
        function, word = ir.Function(module, ir.FunctionType(DOUBLE, [DOUBLE] * 4), "look"), ir.IntType(64)
        b, (address, step, column, length) = ir.IRBuilder(function.append_basic_block()), function.args
        table, zero = b.inttoptr(b.fptosi(address, word), DOUBLE.as_pointer()), DOUBLE(0.0)
        number = b.call(module.declare_intrinsic("llvm.rint", [DOUBLE]), [step])
        inside = b.and_(b.fcmp_ordered(">=", number, zero), b.fcmp_ordered("<", number, b.load(table)))
        at = b.fadd(b.fadd(b.fmul(b.select(inside, number, zero), length), column), DOUBLE(1.0))
        b.ret(b.select(inside, b.load(b.gep(table, [b.fptosi(at, word)])), zero))
    return f"call double @look({', '.join(arguments)})"


_COMPARISONS = "lt", "le", "gt", "ge", "eq", "ne"
LOGIC = {"and", "or", "not"}
TRUTHS = LOGIC.union(_COMPARISONS)

_TOTAL = {"sin": np.sin, "cos": np.cos, "tanh": np.tanh, "atan": np.arctan, "atan2": np.arctan2, "asinh": np.arcsinh}
_TOTAL |= {"cbrt": np.cbrt, "erf": math.erf, "floor": np.floor, "ceil": np.ceil, "rint": np.rint}
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
    "not": Operation(operator.not_, _instruction("xor", ", true")),
    "float": Operation(float, _instruction("uitofp", " to double")),
    "select": Operation(
        lambda which, no, yes: yes if which else no, lambda _, which, no, yes: f"select {which}, {yes}, {no}"
    ),
    **{name: Operation(getattr(operator, name), _comparison(name)) for name in _COMPARISONS},
    "and": Operation(operator.and_, _instruction("and")),
    "or": Operation(operator.or_, _instruction("or")),
    "look": Operation(operator.getitem, _look_up),
    **_functions(_TOTAL, True),
    **_functions(_PARTIAL, False),
}


_MOST = 200_000  # operations asked for: those of 50 coordinates; beyond, JAX is sooner ready


class UntranslatableError(Exception):
    """A JAX program cannot be had as formulas."""


class Scalar:
    """A number of a formula: an input, a constant, or the result of an operation.

    Attributes:
        operation: The name of the operation; "constant" and "input" are none.
        arguments: Its operands.
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
        own = OPERATIONS.get(operation)
        self.is_total = own is None or (own.is_total and all(each.is_total for each in arguments))
        chooses_truth = operation == "select" and arguments[1].is_truth
        self.is_truth = chooses_truth or operation in TRUTHS or value is True or value is False

    @property
    def kind(self) -> ir.Type:
        """The type in LLVM."""
        return TRUTH if self.is_truth else DOUBLE


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
        key = name, arguments
        return self._made.get(key) or self._made.setdefault(key, self._result(name, arguments))

    def _result(self, name: str, arguments: tuple[Scalar, ...]) -> Scalar:
        values = [each.value for each in arguments]
        if None not in values:
            with np.errstate(all="ignore"):
                return self.constant(OPERATIONS[name].evaluate(*values))
        return self._shorter(name, arguments) or Scalar(name, arguments)

    def _shorter(self, name: str, arguments: tuple[Scalar, ...]) -> Scalar | None:
        """Return what an operation with 0 or 1, or a choice that is fixed, comes to."""
        first, last = arguments[0], arguments[-1]
        if name == "select":
            truth = True if arguments[1] is last else first.value
            return None if truth is None else last if truth else arguments[1]
        rule = _IF_FIRST.get((name, first.value)) or _IF_LAST.get((name, last.value))
        return rule and rule(self, name, first, last)

    def _zero(self, name: str, *factors: Scalar) -> Scalar:
        product = Scalar(name, factors)
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
