r"""LLVM code of the Taylor coefficients of any equations that are formulas: x' = f(x).

Every operation has a recurrence for its coefficients, by which they come order by order [jorba-zou-2005]: products and
quotients that of Cauchy, and y = s(a) by integration of $y' = a'g$, so that
$k\,y_k = \sum_{j=1}^k j\,a_j\,g_{k-j}$, where g may depend on y. The code is called as that of quadratic equations,
by `nonholo.kernels.solve_series`.
"""

from typing import Any

from llvmlite import ir

from nonholo.lagrange_dalembert.compiled._derivatives import BILINEAR, LINEAR, Rates, rates_of
from nonholo.lagrange_dalembert.compiled._operations import DOUBLE, OPERATIONS
from nonholo.lagrange_dalembert.compiled._scalars import Formulas, Scalar, needed

ORDERS = 48
"""Room for coefficients of a number."""
_SIDE = 4  # numbers of a vector
_WORD, _LANE, _VECTOR = ir.IntType(64), ir.IntType(32), ir.VectorType(DOUBLE, _SIDE)


def _word(value: int) -> Any:
    return ir.Constant(_WORD, value)


def _number(value: float) -> Any:
    return ir.Constant(DOUBLE, float(value))


class Expansion:
    """A function while it is written.

    Attributes:
        inputs: The numbers of the state.
        rates: Their rates.
        order: The operations, one after another, with those that the rates of functions need.
        functions: The rates of each function.
        room: How many numbers the coefficients take.
    """

    def __init__(self, f: Formulas, inputs: list[Scalar], rates: list[Scalar]) -> None:
        self.inputs, self.rates, self.functions = inputs, rates, dict[Scalar, Rates]()
        self.order = self._ordered(f, [each for each in rates if each.value is None])
        moving = [a for pairs in self.functions.values() for a, _ in pairs]
        self.places = {each: i for i, each in enumerate([*inputs, *self.order])}
        self.moves = {a: len(self.places) + i for i, a in enumerate(dict.fromkeys(moving))}
        self.room = ORDERS * (len(self.places) + len(self.moves))

    def _ordered(self, f: Formulas, results: list[Scalar]) -> list[Scalar]:
        """Return the operations that results need, and note the rates of functions among them."""
        order = needed(results, self.inputs)
        new = [x for x in order if x.operation not in LINEAR | BILINEAR and x not in self.functions]
        if not new:
            return order
        self.functions |= {each: rates_of(f, each) for each in new}
        slopes = [slope for each in new for _, slope in self.functions[each]]
        return self._ordered(f, [*results, *(slope for slope in slopes if slope.value is None)])

    def write(self, module: Any, name: str, width: int) -> None:
        """Write the function to a module; `width` numbers stand in a row of its series."""
        kind = ir.FunctionType(ir.VoidType(), [DOUBLE.as_pointer()] * 5 + [_WORD])
        function = ir.Function(module, kind, name)
        _, self.coefficients, self.series, _, _, last = function.args
        self.dot, self.width = _dot(module, f"{name}.dot"), width
        self.builder = b = ir.IRBuilder(function.append_basic_block())
        self._write_values()
        entry, loop, end = b.block, b.append_basic_block(), b.append_basic_block()
        b.branch(loop)
        b.position_at_end(loop)
        self.k = b.phi(_WORD)
        self.k.add_incoming(_word(1), entry)
        self._write_order()
        following = b.add(self.k, _word(1))
        self.k.add_incoming(following, b.block)
        b.cbranch(b.icmp_signed("<=", following, last), loop, end)
        b.position_at_end(end)
        b.ret_void()

    def _write_values(self) -> None:
        """Write the coefficients of order 0: the values."""
        b, values = self.builder, {}

        def value(x: Scalar) -> Any:
            return values[x] if x.value is None else _number(x.value)

        for m, x in enumerate(self.inputs):
            values[x] = b.load(b.gep(self.series, [_word(m)]))
        for x in self.order:
            values[x] = OPERATIONS[x.operation].emit(b, *map(value, x.arguments))
        for x, number in values.items():
            b.store(number, self._at(self.places[x], _word(0)))

    def _write_order(self) -> None:
        """Write the coefficients of order k."""
        b, before, divisor = self.builder, self.builder.sub(self.k, _word(1)), self.builder.sitofp(self.k, DOUBLE)
        latest: dict[Scalar, Any] = {}
        for m, (x, rate) in enumerate(zip(self.inputs, self.rates, strict=True)):
            if rate.value is None:
                coefficient = b.fdiv(b.load(self._at(self.places[rate], before)), divisor)
            else:
                coefficient = b.select(b.icmp_signed("==", before, _word(0)), _number(rate.value), _number(0.0))
            row = b.add(b.mul(self.k, _word(self.width)), _word(m))
            b.store(coefficient, b.gep(self.series, [row]))
            self._keep(latest, x, coefficient, divisor)
        for x in self.order:
            write = self._integral if x in self.functions else getattr(self, f"_{x.operation}")
            self._keep(latest, x, write(latest, x, divisor), divisor)

    def _keep(self, latest: dict[Scalar, Any], x: Scalar, coefficient: Any, divisor: Any) -> None:
        """Store a coefficient, and k times it where a function needs that."""
        b, latest[x] = self.builder, coefficient
        b.store(coefficient, self._at(self.places[x], self.k))
        if x in self.moves:
            b.store(b.fmul(divisor, coefficient), self._at(self.moves[x], b.sub(self.k, _word(1))))

    def _add(self, latest: dict[Scalar, Any], x: Scalar, _: Any) -> Any:
        terms = [latest[each] for each in x.arguments if each.value is None]
        return self.builder.fadd(*terms) if len(terms) > 1 else terms[0]

    def _sub(self, latest: dict[Scalar, Any], x: Scalar, _: Any) -> Any:
        first, last = x.arguments
        if last.value is not None:
            return latest[first]
        return (
            self.builder.fneg(latest[last])
            if first.value is not None
            else self.builder.fsub(latest[first], latest[last])
        )

    def _neg(self, latest: dict[Scalar, Any], x: Scalar, _: Any) -> Any:
        return self.builder.fneg(latest[x.arguments[0]])

    def _mul(self, latest: dict[Scalar, Any], x: Scalar, _: Any) -> Any:
        first, last = sorted(x.arguments, key=lambda each: each.value is None)
        if first.value is not None:
            return self.builder.fmul(_number(first.value), latest[last])
        return self._sum(self.places[first], self.places[last], self.builder.add(self.k, _word(1)))

    def _div(self, latest: dict[Scalar, Any], x: Scalar, _: Any) -> Any:
        b, (above, below) = self.builder, x.arguments
        if below.value is not None:
            return b.fdiv(latest[above], _number(below.value))
        over = self._at(self.places[below], _word(1)), self._at(self.places[x], _word(0))
        earlier = b.call(self.dot, [*over, self.k])
        left = b.fneg(earlier) if above.value is not None else b.fsub(latest[above], earlier)
        return b.fdiv(left, b.load(self._at(self.places[below], _word(0))))

    def _integral(self, _: dict[Scalar, Any], x: Scalar, divisor: Any) -> Any:
        b, total = self.builder, _number(0.0)
        for a, slope in self.functions[x]:
            if slope.value is None:
                term = self._sum(self.moves[a], self.places[slope], self.k)
            else:
                term = b.fmul(_number(slope.value), b.load(self._at(self.moves[a], b.sub(self.k, _word(1)))))
            total = b.fadd(total, term)
        return b.fdiv(total, divisor)

    def _sum(self, first: int, last: int, terms: Any) -> Any:
        """Write a sum of products of coefficients, the first ones of one number with the last ones of another."""
        return self.builder.call(self.dot, [self._at(first, _word(0)), self._at(last, _word(0)), terms])

    def _at(self, place: int, order: Any) -> Any:
        """Return where a coefficient stands."""
        return self.builder.gep(self.coefficients, [self.builder.add(_word(ORDERS * place), order)])


def _dot(module: Any, name: str) -> Any:
    """Write a function of (a, b, n): the sum of a[i] b[n - 1 - i], four products at once."""
    kind = ir.FunctionType(DOUBLE, [DOUBLE.as_pointer()] * 2 + [_WORD])
    function = ir.Function(module, kind, name)
    function.linkage = "internal"
    function.attributes.add("noinline")
    a, other, n = function.args
    b, zero = ir.IRBuilder(function.append_basic_block()), ir.Constant(_VECTOR, [0.0] * _SIDE)
    entry, wide, middle, narrow, end = b.block, *(b.append_basic_block() for _ in range(4))
    full = b.and_(n, _word(-_SIDE))
    b.cbranch(b.icmp_signed(">", full, _word(0)), wide, middle)
    b.position_at_end(wide)
    i, sums = _joined(b, {entry: _word(0)}), _joined(b, {entry: zero})
    left = b.load(b.bitcast(b.gep(a, [i]), _VECTOR.as_pointer()), align=8)
    right = b.load(b.bitcast(b.gep(other, [b.sub(b.sub(n, i), _word(_SIDE))]), _VECTOR.as_pointer()), align=8)
    backward = ir.Constant(ir.VectorType(_LANE, _SIDE), list(range(_SIDE))[::-1])
    total = b.fadd(sums, b.fmul(left, b.shuffle_vector(right, right, backward)))
    following = b.add(i, _word(_SIDE))
    i.add_incoming(following, wide)
    sums.add_incoming(total, wide)
    b.cbranch(b.icmp_signed("<", following, full), wide, middle)
    b.position_at_end(middle)
    lanes = _joined(b, {entry: zero, wide: total})
    each: list[Any] = [b.extract_element(lanes, _LANE(at)) for at in range(_SIDE)]
    begun: Any = b.fadd(b.fadd(each[0], each[2]), b.fadd(each[1], each[3]))
    b.cbranch(b.icmp_signed("<", full, n), narrow, end)
    b.position_at_end(narrow)
    j, sofar = _joined(b, {middle: full}), _joined(b, {middle: begun})
    product = b.fmul(b.load(b.gep(a, [j])), b.load(b.gep(other, [b.sub(b.sub(n, j), _word(1))])))
    longer, after = b.fadd(sofar, product), b.add(j, _word(1))
    j.add_incoming(after, narrow)
    sofar.add_incoming(longer, narrow)
    b.cbranch(b.icmp_signed("<", after, n), narrow, end)
    b.position_at_end(end)
    b.ret(_joined(b, {middle: begun, narrow: longer}))
    return function


def _joined(builder: Any, values: dict[Any, Any]) -> Any:
    """Return a value that depends on the block before."""
    phi = builder.phi(next(iter(values.values())).type)
    for block, value in values.items():
        phi.add_incoming(value, block)
    return phi
