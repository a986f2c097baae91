r"""LLVM code of the Taylor coefficients of any equations that are formulas: x' = f(x).

Every operation has a recurrence for its coefficients, by which they come order by order [jorba-zou-2005]: products and
quotients that of Cauchy, and y = s(a) by integration of $y' = a'g$, so that
$k\,y_k = \sum_{j=1}^k j\,a_j\,g_{k-j}$, where g may depend on y. The code is called as that of quadratic equations,
by `nonholo.kernels.solve_series`.

Derivatives of functions, and linear equations by elimination, are formulas, too.
"""

import collections
import graphlib
import itertools
import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from llvmlite import ir

from nonholo.lagrange_dalembert.compiled import _scalars as scalars
from nonholo.lagrange_dalembert.compiled._scalars import DOUBLE, Formulas, Scalar

LINEAR = {"add", "sub", "neg"}
BILINEAR = {"mul", "div"}


def _over(f: Formulas, above: float, below: Scalar) -> Scalar:
    return f("div", f.constant(above), below)


def _squares(f: Formulas, constant: float, sign: str, x: Scalar) -> Scalar:
    return f(sign, f.constant(constant), f("mul", x, x))


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
    "asin": lambda f, x, _: _over(f, 1.0, f("sqrt", _squares(f, 1.0, "sub", x))),
    "acos": lambda f, x, _: _over(f, -1.0, f("sqrt", _squares(f, 1.0, "sub", x))),
    "atan": lambda f, x, _: _over(f, 1.0, _squares(f, 1.0, "add", x)),
    "sinh": lambda f, x, _: f("cosh", x),
    "cosh": lambda f, x, _: f("sinh", x),
    "tanh": lambda f, _, y: _squares(f, 1.0, "sub", y),
    "asinh": lambda f, x, _: _over(f, 1.0, f("sqrt", _squares(f, 1.0, "add", x))),
    "acosh": lambda f, x, _: _over(f, 1.0, f("sqrt", f("sub", f("mul", x, x), f.constant(1.0)))),
    "atanh": lambda f, x, _: _over(f, 1.0, _squares(f, 1.0, "sub", x)),
    "erf": lambda f, x, _: f("mul", f.constant(2 / math.sqrt(math.pi)), f("exp", f("neg", f("mul", x, x)))),
}


def rates_of(f: Formulas, y: Scalar) -> list[tuple[Scalar, Scalar]]:
    """Return how the result of a function moves with its arguments: those a and g in its rate, the sum of a' g.

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
        raise scalars.UntranslatableError(y.operation)
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
                products.append(self._less(row[i], products, self.lower[i] if i < j else lower))
                if i < j:
                    lower.append(self._quotient(products[i], self.pivots[i]))
            if products[j].value == 0:
                raise scalars.UntranslatableError("a pivot is zero")
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
    return Elimination(f, [*([*row, *(each[i] for each in rows)] for i, row in enumerate(mass)), *below])


ORDERS = 48
"""Room for coefficients of a number."""
_MANY = 256  # operations; more of them are a table, which LLVM need not compile
_SIDE = 4  # numbers of a vector
_WORD, _LANE, _VECTOR = ir.IntType(64), ir.IntType(32), ir.VectorType(DOUBLE, _SIDE)


def _constant(value: float) -> Any:
    return ir.Constant(_WORD if type(value) is int else DOUBLE, value)


class Expansion:
    """A function while it is written.

    Attributes:
        inputs: The numbers of the state, the last of which is a constant: the unit of time.
        rates: Their rates.
        order: The operations, one after another, with those that the rates of functions need.
        functions: The rates of each function.
        room: How many numbers the coefficients take.
    """

    def __init__(self, f: Formulas, inputs: list[Scalar], rates: list[Scalar]) -> None:
        self.inputs, self.rates, self.functions = inputs, rates, dict[Scalar, Any]()
        self.order = self._order_of(f, [each for each in rates if each.value is None])
        moving = [a for pairs in self.functions.values() for a, _ in pairs]
        self.places = {each: i for i, each in enumerate([*inputs, *self.order])}
        self.moves = {a: len(self.places) + i for i, a in enumerate(dict.fromkeys(moving))}
        self.room = ORDERS * (len(self.places) + len(self.moves))

    def _order_of(self, f: Formulas, results: list[Scalar]) -> list[Scalar]:
        """Return the operations that results need, and note the rates of functions among them."""
        order = scalars.operations_between(results, self.inputs)
        new = [x for x in order if x.operation not in LINEAR | BILINEAR and x not in self.functions]
        if not new:
            return order
        self.functions |= {each: rates_of(f, each) for each in new}
        slopes = [slope for each in new for _, slope in self.functions[each]]
        return self._order_of(f, [*results, *(slope for slope in slopes if slope.value is None)])

    def write(self, module: Any, name: str, width: int) -> None:
        """Write the function to a module; `width` numbers stand in a row of its series.

        An order is a separate function, which a loop calls.
        """
        pointer, self.width = DOUBLE.as_pointer(), width
        function = ir.Function(module, ir.FunctionType(ir.VoidType(), [pointer] * 5 + [_WORD]), name)
        _, self.first, self.series, _, _, last = function.args
        self.table = self._table(module, f"{name}.table") if len(self.order) >= _MANY else None
        self.dot = _dot(module, f"{name}.dot", "alwaysinline" if self.table else "noinline")
        self.builder = b = ir.IRBuilder(function.append_basic_block())
        for m, x in enumerate(self.inputs):
            b.store(b.load(b.gep(self.series, [_constant(m)])), b.gep(self.first, [_constant(self._place(x))]))
        self._write_operations(self._write_value)
        entry, loop, end = b.block, b.append_basic_block(), b.append_basic_block()
        b.branch(loop)
        b.position_at_end(loop)
        order = _internal(module, f"{name}.order", ir.VoidType(), [pointer, pointer, _WORD])
        k = _phi(b, {entry: _constant(1)})
        b.call(order, [self.first, self.series, k])
        following = b.add(k, _constant(1))
        k.add_incoming(following, loop)
        b.cbranch(b.icmp_signed("<=", following, last), loop, end)
        b.position_at_end(end)
        b.ret_void()
        self.builder = b = ir.IRBuilder(order.append_basic_block())
        self.first, self.series, self.k = order.args
        self.before, self.divisor = b.sub(self.k, _constant(1)), b.sitofp(self.k, DOUBLE)
        self.latest = b.gep(self.first, [self.k])
        self._write_states()
        self._write_operations(self._write_coefficient)
        b.ret_void()

    def _place(self, x: Scalar) -> int | float:
        """Return where the coefficients of a number begin, or a constant itself."""
        return ORDERS * self.places[x] if x.value is None else float(x.value)

    def _row(self, x: Scalar) -> list[int | float]:
        """Return the places of an operation, its arguments, their rates and the slopes, and of the rate that it has."""
        row = [*map(self._place, (x, *x.arguments))]
        for a, slope in self.functions.get(x, ()):
            row += [ORDERS * self.moves[a], self._place(slope)]
        return [*row, ORDERS * self.moves[x]] if x in self.moves else row

    def _kind(self, x: Scalar) -> Any:
        """Return what operations have in common that differ in places and constants alone."""
        return x.operation, x in self.moves, *map(type, self._row(x))

    def _in_groups(self) -> list[Scalar]:
        """Return the operations in an order in which many of a kind follow each other, as processors foresee.

        Of those whose arguments are there, the kind comes next on which the longest chain depends.
        """
        kinds, chain = {x: self._kind(x) for x in self.order}, dict.fromkeys(self.places, 0)
        for x in reversed(self.order):
            chain |= {y: max(chain[y], 1 + chain[x]) for y in x.arguments if y.value is None}
        sorter = graphlib.TopologicalSorter({x: [y for y in x.arguments if y in kinds] for x in self.order})
        sorter.prepare()
        ready, order = collections.defaultdict[Any, list[Scalar]](list), list[Scalar]()
        while sorter.is_active():
            for x in sorter.get_ready():
                ready[kinds[x]].append(x)
            group = ready.pop(max(ready, key=lambda kind: max(chain[x] for x in ready[kind])))
            sorter.done(*group)
            order += group
        return order

    def _table(self, module: Any, name: str) -> Any:
        """Put the kinds and the rows of all operations into a module, each a word."""
        kinds = {kind: i for i, kind in enumerate(dict.fromkeys(map(self._kind, self.order)))}
        rows = ([kinds[self._kind(x)], *self._row(x)] for x in self._in_groups())
        words = [np.array(each).view(np.int64) for each in itertools.chain(*rows, [len(kinds)])]
        text = bytearray(np.array(words).tobytes())
        table: Any = ir.GlobalVariable(module, ir.ArrayType(ir.IntType(8), len(text)), name)
        table.initializer, table.linkage, table.align = ir.Constant(table.value_type, text), "internal", 8
        return table.bitcast(_WORD.as_pointer())

    def _write_operations(self, write: Callable[..., None]) -> None:
        """Write all operations by `write`, one after another; many as a loop, which reads them from a table."""
        if self.table is None:
            for x in self.order:
                write(x, *map(_constant, self._row(x)))
            return
        b = self.builder
        before, loop, end = b.block, b.append_basic_block(), b.append_basic_block()
        b.branch(loop)
        b.position_at_end(loop)
        at = _phi(b, {before: _constant(0)})
        choice = b.switch(b.load(b.gep(self.table, [at])), end)
        for number, x in enumerate({self._kind(x): x for x in self.order}.values()):
            block, row = b.append_basic_block(), self._row(x)
            choice.add_case(_constant(number), block)
            b.position_at_end(block)
            words = (b.load(b.gep(self.table, [b.add(at, _constant(1 + m))])) for m in range(len(row)))
            write(x, *(b.bitcast(word, _constant(each).type) for word, each in zip(words, row, strict=True)))
            at.add_incoming(b.add(at, _constant(1 + len(row))), b.block)
            b.branch(loop)
        b.position_at_end(end)

    def _write_value(self, x: Scalar, target: Any, *rest: Any) -> None:
        """Write the coefficient of order 0: the value."""
        values = [y if y.type == DOUBLE else self._of(y, self.first) for y in rest[: len(x.arguments)]]
        text = scalars.OPERATIONS[x.operation].emit(self.builder.module, *map(scalars.reference, values))
        self.builder.store(scalars.Text(self.builder, DOUBLE, text), self.builder.gep(self.first, [target]))

    def _write_states(self) -> None:
        """Write the coefficients of order k of the state."""
        b, earlier = self.builder, self.builder.gep(self.first, [self.before])
        unit = self._of(_constant(self._place(self.inputs[-1])), self.first)
        for m, (x, rate) in enumerate(zip(self.inputs, self.rates, strict=True)):
            if rate.value is None:
                coefficient = b.fdiv(b.fmul(unit, self._of(_constant(self._place(rate)), earlier)), self.divisor)
            else:
                is_first = b.icmp_signed("==", self.before, _constant(0))
                coefficient = b.select(is_first, b.fmul(unit, _constant(float(rate.value))), _constant(0.0))
            b.store(coefficient, b.gep(self.series, [b.add(b.mul(self.k, _constant(self.width)), _constant(m))]))
            self._keep(x, coefficient, *map(_constant, self._row(x)))

    def _write_coefficient(self, x: Scalar, *row: Any) -> None:
        """Write the coefficient of order k."""
        end, is_function = 1 + len(x.arguments), x in self.functions
        write = self._integral if is_function else getattr(self, f"_{x.operation}")
        self._keep(x, write(*(row[end:] if is_function else row[:end])), *row)

    def _keep(self, x: Scalar, coefficient: Any, *row: Any) -> None:
        """Store a coefficient, and k times it where a function needs that."""
        b = self.builder
        b.store(coefficient, b.gep(self.latest, [row[0]]))
        if x in self.moves:
            b.store(b.fmul(self.divisor, coefficient), b.gep(self.first, [b.add(row[-1], self.before)]))

    def _of(self, word: Any, order: Any) -> Any:
        """Load a coefficient."""
        return self.builder.load(self.builder.gep(order, [word]))

    def _add(self, _: Any, *arguments: Any) -> Any:
        terms = [self._of(each, self.latest) for each in arguments if each.type == _WORD]
        return self.builder.fadd(*terms) if len(terms) > 1 else terms[0]

    def _sub(self, _: Any, first: Any, last: Any) -> Any:
        if last.type == DOUBLE:
            return self._of(first, self.latest)
        if first.type == DOUBLE:
            return self.builder.fneg(self._of(last, self.latest))
        return self.builder.fsub(self._of(first, self.latest), self._of(last, self.latest))

    def _neg(self, _: Any, x: Any) -> Any:
        return self.builder.fneg(self._of(x, self.latest))

    def _mul(self, _: Any, *factors: Any) -> Any:
        first, last = sorted(factors, key=lambda each: each.type == _WORD)
        if first.type == DOUBLE:
            return self.builder.fmul(first, self._of(last, self.latest))
        return self._sum(first, last, self.builder.add(self.k, _constant(1)))

    def _div(self, target: Any, above: Any, below: Any) -> Any:
        b = self.builder
        if below.type == DOUBLE:
            return b.fdiv(self._of(above, self.latest), below)
        earlier = self._sum(b.add(below, _constant(1)), target, self.k)
        left = b.fneg(earlier) if above.type == DOUBLE else b.fsub(self._of(above, self.latest), earlier)
        return b.fdiv(left, self._of(below, self.first))

    def _integral(self, *rates: Any) -> Any:
        b, total = self.builder, _constant(0.0)
        for move, slope in zip(rates[::2], rates[1::2], strict=False):
            latest = self._of(b.add(move, self.before), self.first)
            total = b.fadd(total, b.fmul(slope, latest) if slope.type == DOUBLE else self._sum(move, slope, self.k))
        return b.fdiv(total, self.divisor)

    def _sum(self, first: Any, last: Any, terms: Any) -> Any:
        """Write a sum of products of coefficients, the first ones of one number with the last ones of another."""
        return self.builder.call(self.dot, [self.first, first, last, terms])


def _dot(module: Any, name: str, inlining: str) -> Any:
    """Write a function of an array, two places and n: the sum of a[i] b[n - 1 - i], four products at once."""
    function = _internal(module, name, DOUBLE, [DOUBLE.as_pointer(), *[_WORD] * 3], inlining)
    array, *places, n = function.args
    b, zero = ir.IRBuilder(function.append_basic_block()), ir.Constant(_VECTOR, [0.0] * _SIDE)
    a, other = (b.gep(array, [place]) for place in places)
    entry, wide, middle, narrow, end = b.block, *(b.append_basic_block() for _ in range(4))
    full = b.and_(n, _constant(-_SIDE))
    b.cbranch(b.icmp_signed(">", full, _constant(0)), wide, middle)
    b.position_at_end(wide)
    i, sums = _phi(b, {entry: _constant(0)}), _phi(b, {entry: zero})
    left = b.load(b.bitcast(b.gep(a, [i]), _VECTOR.as_pointer()), align=8)
    right = b.load(b.bitcast(b.gep(other, [b.sub(b.sub(n, i), _constant(_SIDE))]), _VECTOR.as_pointer()), align=8)
    backward = ir.Constant(ir.VectorType(_LANE, _SIDE), list(range(_SIDE))[::-1])
    total = b.fadd(sums, b.fmul(left, b.shuffle_vector(right, right, backward)))
    following = b.add(i, _constant(_SIDE))
    i.add_incoming(following, wide)
    sums.add_incoming(total, wide)
    b.cbranch(b.icmp_signed("<", following, full), wide, middle)
    b.position_at_end(middle)
    lanes = _phi(b, {entry: zero, wide: total})
    each: list[Any] = [b.extract_element(lanes, _LANE(at)) for at in range(_SIDE)]
    lane_sum: Any = b.fadd(b.fadd(each[0], each[2]), b.fadd(each[1], each[3]))
    b.cbranch(b.icmp_signed("<", full, n), narrow, end)
    b.position_at_end(narrow)
    j, sofar = _phi(b, {middle: full}), _phi(b, {middle: lane_sum})
    product = b.fmul(b.load(b.gep(a, [j])), b.load(b.gep(other, [b.sub(b.sub(n, j), _constant(1))])))
    longer, after = b.fadd(sofar, product), b.add(j, _constant(1))
    j.add_incoming(after, narrow)
    sofar.add_incoming(longer, narrow)
    b.cbranch(b.icmp_signed("<", after, n), narrow, end)
    b.position_at_end(end)
    b.ret(_phi(b, {middle: lane_sum, narrow: longer}))
    return function


def _internal(module: Any, name: str, result: Any, arguments: list[Any], inlining: str = "noinline") -> Any:
    """Return a function that is called and never copied into its callers, or always."""
    function = ir.Function(module, ir.FunctionType(result, arguments), name)
    function.linkage = "internal"
    function.attributes.add(inlining)
    return function


def _phi(builder: Any, values: dict[Any, Any]) -> Any:
    """Return a value that depends on the block before."""
    phi = builder.phi(next(iter(values.values())).type)
    for block, value in values.items():
        phi.add_incoming(value, block)
    return phi
