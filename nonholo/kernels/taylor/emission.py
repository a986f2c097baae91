"""LLVM code of the Taylor coefficients of one structure of `Quadratic` equations.

Loops over orders stay; rows of products and terms are written out, for numbers that come at run time. It is what
`expand` does, sum by sum. Where components of a vector have fewer terms than others they get zeros, which change no sum
that began with zero.
"""

import functools
import itertools
from collections.abc import Callable, Sequence
from typing import Any

from llvmlite import ir

_SIDE, _ROWS = 8, 12  # numbers of a vector; rows of products that one loop sums
_NUMBER, _WORD, _LANE = ir.DoubleType(), ir.IntType(64), ir.IntType(32)
_VECTOR = ir.VectorType(_NUMBER, _SIDE)
_ZERO = ir.Constant(_VECTOR, [0.0] * _SIDE)


def code_of(structure: str, name: str) -> str:
    """Return LLVM code of a function: of addresses, and of the order; see `nonholo.kernels._scalar.expand_at`."""
    module = ir.Module()
    kind = ir.FunctionType(ir.VoidType(), [_NUMBER.as_pointer()] * 5 + [_WORD])
    function = ir.Function(module, kind, name)
    for argument in function.args[:5]:
        argument.add_attribute("noalias")
    _Expansion(structure, function).write()
    return str(module)


class _Expansion:
    """The function while it is written.

    A place of z is a number in a vector of eight, or a vector if there are eight motions; vectors are called blocks.
    """

    def __init__(self, structure: str, function: Any) -> None:
        parts = [[int(each) for each in part.split(",") if each] for part in structure.split(";")]
        (lanes, self.k, self.tensor), rows, first, self.sources = parts
        self.side, self.rows = _SIDE // lanes, list(zip(rows[: len(rows) // 2], rows[len(rows) // 2 :], strict=True))
        self.terms = [list(range(begin, end)) for begin, end in itertools.pairwise(first)]
        self.blocks, self.moving = (-(-places // self.side) for places in (self.k + len(self.terms), self.k))
        self.matrix, self.factors, self.series, self.forms, self.inertia, self.order = function.args
        self.builder = ir.IRBuilder(function.append_basic_block())

    def write(self) -> None:
        """Write loads of what is constant, then a loop over the orders."""
        own = range(self.k)
        self.columns = [[self.gather(self.matrix, self.column(B, i)) for i in own] for B in range(self.moving)]
        self.parts = [[self.gather(self.forms, self.entry(c, e)) for e in range(self.tensor)] for c in own]
        self.scales = [[self.gather(self.factors, at) for _, at in self.slots(B)] for B in range(self.blocks)]
        self.loop()

    def loop(self) -> None:
        """Write the loop over the orders."""
        b = self.builder
        z0 = [self.load(self.z_at(_word(0), B * self.side)) for B in range(self.blocks)]
        entry, loop, end = b.block, b.append_basic_block(), b.append_basic_block()
        b.cbranch(b.icmp_signed(">", self.order, _word(0)), loop, end)
        b.position_at_end(loop)
        j = self.join({entry: _word(0)})
        z, oldest = ([self.join({entry: x}) for x in each] for each in (z0, [_ZERO] * self.blocks))
        sums = self.products(z0, z, oldest, j)
        following = b.add(j, _word(1))
        rates = self.collect([*sums, *z[: self.moving]], self.splat(b.sitofp(following, _NUMBER)))
        after = self.move(rates, following)
        for phi, value in zip([j, *z, *oldest], [following, *after, *z0], strict=True):
            phi.add_incoming(value, b.block)
        b.cbranch(b.icmp_signed("<", following, self.order), loop, end)
        b.position_at_end(end)
        b.ret_void()

    def products(self, z0: list[Any], z: list[Any], oldest: list[Any], j: Any) -> list[Any]:
        """Write the coefficients of the products; `oldest` is z_0, or zero at order 0, which has it in z."""
        b, last, sums = self.builder, self.builder.sub(j, _word(1)), []
        for at in range(0, len(self.rows), _ROWS):
            rows = self.rows[at : at + _ROWS]
            inner = self.sum_loop(
                [_ZERO] * (2 * len(rows)), last, lambda i, rows=rows: self.inner(rows, i, b.sub(j, i))
            )
            sums += [b.fadd(*each) for each in zip(inner[: len(rows)], inner[len(rows) :], strict=True)]
        outer = (b.fadd(b.fmul(self.spread(z0, a), z[B]), b.fmul(self.spread(z, a), oldest[B])) for a, B in self.rows)
        return [b.fadd(*each) for each in zip(sums, outer, strict=True)]

    def sum_loop(self, totals: list[Any], last: Any, terms: Callable[[Any], list[Any]]) -> list[Any]:
        """Write a loop over i = 1, ..., last: terms of odd i are added to half of the totals, of even i to the rest."""
        b, before, half = self.builder, self.builder.block, len(totals) // 2
        loop, middle, tail, after = (b.append_basic_block() for _ in range(4))
        b.cbranch(b.icmp_signed(">", last, _word(1)), loop, middle)
        b.position_at_end(loop)
        i, old = self.join({before: _word(1)}), [self.join({before: total}) for total in totals]
        new = [b.fadd(*each) for each in zip(old, [*terms(i), *terms(b.add(i, _word(1)))], strict=True)]
        following = b.add(i, _word(2))
        for phi, value in zip([i, *old], [following, *new], strict=True):
            phi.add_incoming(value, loop)
        b.cbranch(b.icmp_signed("<", following, last), loop, middle)
        b.position_at_end(middle)
        totals = [self.join({before: one, loop: other}) for one, other in zip(totals, new, strict=True)]
        b.cbranch(b.and_(b.trunc(last, ir.IntType(1)), b.icmp_signed(">", last, _word(0))), tail, after)
        b.position_at_end(tail)
        longer = [b.fadd(*each) for each in zip(totals[:half], terms(last), strict=True)]
        b.branch(after)
        b.position_at_end(after)
        odd = [self.join({middle: one, tail: other}) for one, other in zip(totals[:half], longer, strict=True)]
        return odd + totals[half:]

    def inner(self, rows: list[tuple[int, int]], i: Any, other: Any) -> list[Any]:
        """Write products of coefficients of two orders."""
        left = {a: self.load_spread(i, a) for a, _ in rows}
        right = {B: self.load(self.z_at(other, B * self.side)) for _, B in rows}
        return [self.builder.fmul(left[a], right[B]) for a, B in rows]

    def collect(self, sums: list[Any], divisor: Any) -> list[Any]:
        """Write the next coefficients of x: those of its rates, divided."""
        b, coefficients = self.builder, []
        for B, scales in enumerate(self.scales):
            rate = _ZERO
            for (q, at), scale in zip(self.slots(B), scales, strict=True):
                places = [_SIDE if term is None else self.sources[term] % self.side for term in at]
                rate = b.fadd(rate, b.fmul(scale, self.shuffle(sums[q], _ZERO, places)))
            coefficients.append(b.fdiv(rate, divisor) if scales else rate)
        return coefficients

    def move(self, z: list[Any], j: Any) -> list[Any]:
        """Write z of an order with its velocities: V r, or what the inverse of B_0 makes of what earlier ones leave."""
        b, momenta = self.builder, [self.spread(z, len(self.terms) + i) for i in range(self.k)]
        if self.tensor:
            left = b.fsub(_ZERO, self.earlier(z, j))
            momenta = [self.spread([left], i) for i in range(self.k)]
        for B, columns in enumerate(self.columns):
            w = self.combine(columns, momenta)
            z[B] = self.shuffle(z[B], w, [at + _SIDE * (a < self.k) for at, a in enumerate(self.places(B))])
        for B, value in enumerate(z):
            self.store(value, self.z_at(j, B * self.side))
        return z

    def earlier(self, z: list[Any], j: Any) -> Any:
        """Write B_1 w_(j-1) + ... + B_j w_0, and store the columns of B_j."""
        b, first, totals = self.builder, self.k + len(self.terms) - self.tensor, [_ZERO, _ZERO]
        tensor = [self.spread(z, first + e) for e in range(self.tensor)]
        for c in range(self.k):
            self.store(self.combine(self.parts[c], tensor), self.column_at(j, c))
        for c in range(self.k):
            totals = self.sum_loop(
                totals, j, lambda i, c=c: [b.fmul(self.load(self.column_at(i, c)), self.load_spread(b.sub(j, i), c))]
            )
        return b.fadd(totals[0], totals[1])

    def combine(self, columns: list[Any], factors: list[Any]) -> Any:
        """Write a sum of columns times factors."""
        b, total = self.builder, _ZERO
        for column, factor in zip(columns, factors, strict=True):
            total = b.fadd(total, b.fmul(column, factor))
        return total

    @functools.cache  # noqa: B019  # it lives as long as a function is written
    def slots(self, B: int) -> list[tuple[int, list[int | None]]]:
        """Return what is added to a block one after another: of which sum, and the term of each of its places, or None.

        The terms of a component keep their order.
        """
        components = [place - self.k for place in self.places(B)]
        left = [self.terms[m][::-1] if 0 <= m < len(self.terms) else [] for m in components]
        slots: list[tuple[int, list[int | None]]] = []
        while any(left):
            sums = [self.sources[terms[-1]] // self.side if terms else len(self.sources) for terms in left]
            q = min(sums)
            slots.append(
                (q, [terms.pop() if terms and of == q else None for of, terms in zip(sums, left, strict=True)])
            )
        return slots

    def places(self, B: int) -> range:
        """Return the places of z in a block."""
        return range(B * self.side, (B + 1) * self.side)

    def column(self, B: int, i: int) -> list[int | None]:
        """Return which numbers of V stand at the places of a block, of a column."""
        return [a * self.k + i if a < self.k else None for a in self.places(B)]

    def entry(self, c: int, e: int) -> list[int]:
        """Return which numbers of the forms one entry of the tensor has in a column of B."""
        return [(a * self.k + c) * self.tensor + e for a in range(self.k)]

    def gather(self, base: Any, places: Sequence[int | None]) -> Any:
        """Load numbers from anywhere, or zeros, into a vector."""
        b, vector = self.builder, _ZERO
        if self.side == 1:
            return self.load(b.gep(base, [_word(_SIDE * (places[0] or 0))]))
        for lane, place in enumerate(places):
            if place is not None:
                vector = b.insert_element(vector, b.load(b.gep(base, [_word(place)])), _LANE(lane))
        return vector

    def z_at(self, j: Any, place: int) -> Any:
        """Return where a place of a coefficient stands."""
        b, width = self.builder, _word(self.blocks * _SIDE)
        return b.gep(self.series, [b.add(b.mul(j, width), _word(place * _SIDE // self.side))])

    def column_at(self, j: Any, c: int) -> Any:
        """Return where a column of B_j stands."""
        b = self.builder
        return b.gep(self.inertia, [b.add(b.mul(j, _word(self.k * _SIDE)), _word(c * _SIDE))])

    def load(self, place: Any) -> Any:
        """Load a vector."""
        return self.builder.load(self.builder.bitcast(place, _VECTOR.as_pointer()), align=8)

    def store(self, value: Any, place: Any) -> None:
        """Store a vector."""
        self.builder.store(value, self.builder.bitcast(place, _VECTOR.as_pointer()), align=8)

    def load_spread(self, j: Any, place: int) -> Any:
        """Load a place of a coefficient for each number of a vector."""
        at = self.z_at(j, place)
        return self.load(at) if self.side == 1 else self.splat(self.builder.load(at))

    def spread(self, z: list[Any], place: int) -> Any:
        """Return a place of a coefficient for each number of a vector."""
        return self.shuffle(z[place // self.side], _ZERO, [place % self.side] * self.side)

    def splat(self, number: Any) -> Any:
        """Return a vector of one number."""
        return self.builder.shuffle_vector(
            self.builder.insert_element(_ZERO, number, _LANE(0)), _ZERO, _lanes([0] * _SIDE)
        )

    def shuffle(self, first: Any, second: Any, places: list[int]) -> Any:
        """Return places of two blocks in one."""
        if self.side == 1:
            return first if places == [0] else second
        return self.builder.shuffle_vector(first, second, _lanes(places))

    def join(self, values: dict[Any, Any]) -> Any:
        """Return a value that depends on the instructions before."""
        phi = self.builder.phi(next(iter(values.values())).type)
        for block, value in values.items():
            phi.add_incoming(value, block)
        return phi


def _word(value: int) -> Any:
    return ir.Constant(_WORD, value)


def _lanes(places: list[int]) -> Any:
    return ir.Constant(ir.VectorType(_LANE, _SIDE), places)
