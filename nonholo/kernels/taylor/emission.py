r"""LLVM code of the Taylor coefficients of one structure of `Quadratic` equations.

Loops over orders stay; the rows of products and the terms are written out, for numbers that come at run time. It is
what `expand` does, sum by sum. Where components of a vector have fewer terms than others they get zeros, which change
no sum that began with zero.
"""

import functools
import itertools
from typing import Any

from llvmlite import ir

_SIDE, _ROWS = 8, 12  # numbers of a vector; rows of products that one loop sums
_NUMBER, _WORD, _LANE = ir.DoubleType(), ir.IntType(64), ir.IntType(32)
_VECTOR = ir.VectorType(_NUMBER, _SIDE)
_ZERO = ir.Constant(_VECTOR, [0.0] * _SIDE)


def code_of(structure: str, name: str) -> str:
    """Return LLVM code of a function: of the addresses of V, of factors and of series, and of the order."""
    module = ir.Module()
    kind = ir.FunctionType(ir.VoidType(), [_NUMBER.as_pointer()] * 3 + [_WORD])
    function = ir.Function(module, kind, name)
    for argument in function.args[:3]:
        argument.add_attribute("noalias")
    _Expansion(structure, function).write()
    return str(module)


class _Expansion:
    """The function while it is written.

    A place of z is a number in a vector of eight, or a vector if there are eight motions; vectors are called blocks.
    """

    def __init__(self, structure: str, function: Any) -> None:
        parts = [[int(each) for each in part.split(",") if each] for part in structure.split(";")]
        (lanes, self.k), rows, first, self.found = parts
        self.side = _SIDE // lanes
        self.rows = list(zip(rows[: len(rows) // 2], rows[len(rows) // 2 :], strict=True))
        self.terms = [list(range(begin, end)) for begin, end in itertools.pairwise(first)]
        self.blocks, self.moving = (-(-places // self.side) for places in (self.k + len(self.terms), self.k))
        self.velocities, self.factors, self.series, self.order = function.args
        self.builder = ir.IRBuilder(function.append_basic_block())

    def write(self) -> None:
        """Write the coefficients of order 0, then a loop over the orders."""
        b = self.builder
        self.columns = [
            [self.gathered(self.velocities, self.column(i, B)) for B in range(self.moving)] for i in range(self.k)
        ]
        self.scales = [[self.gathered(self.factors, at) for _, at in self.slots(B)] for B in range(self.blocks)]
        z0 = self.moved([self.load(_word(0), B) for B in range(self.blocks)], _word(0))
        w0 = [self.spread(z0, a) for a in range(self.k)]
        entry, loop, end = b.block, b.append_basic_block(), b.append_basic_block()
        b.cbranch(b.icmp_signed(">", self.order, _word(0)), loop, end)
        b.position_at_end(loop)
        j = self.joined({entry: _word(0)})
        z = [self.joined({entry: x}) for x in z0]
        oldest = [self.joined({entry: _ZERO}) for _ in z0]  # which order 0 has not twice
        sums = [total for at in range(0, len(self.rows), _ROWS) for total in self.summed(j, self.rows[at : at + _ROWS])]
        for q, (a, B) in enumerate(self.rows):
            outer = b.fadd(b.fmul(w0[a], z[B]), b.fmul(self.spread(z, a), oldest[B]))
            sums[q] = b.fadd(sums[q], outer)
        following = b.add(j, _word(1))
        rates = self.collected([*sums, *z[: self.moving]], self.splat(b.sitofp(following, _NUMBER)))
        after = self.moved(rates, following)
        for phi, value in zip([j, *z, *oldest], [following, *after, *z0], strict=True):
            phi.add_incoming(value, b.block)
        b.cbranch(b.icmp_signed("<", following, self.order), loop, end)
        b.position_at_end(end)
        b.ret_void()

    def summed(self, j: Any, rows: list[tuple[int, int]]) -> list[Any]:
        """Write the sums of z_a[i] z_b[j - i], 0 < i < j, of some rows: of odd i and of even i, then of both."""
        b, before, R = self.builder, self.builder.block, len(rows)
        loop, middle, last, after = (b.append_basic_block() for _ in range(4))
        end = b.sub(j, _word(1))
        b.cbranch(b.icmp_signed(">", end, _word(1)), loop, middle)
        b.position_at_end(loop)
        i, totals = self.joined({before: _word(1)}), [self.joined({before: _ZERO}) for _ in range(2 * R)]
        new = [*self.added(totals[:R], rows, i, j), *self.added(totals[R:], rows, b.add(i, _word(1)), j)]
        following = b.add(i, _word(2))
        for phi, value in zip([i, *totals], [following, *new], strict=True):
            phi.add_incoming(value, loop)
        b.cbranch(b.icmp_signed("<", following, end), loop, middle)
        b.position_at_end(middle)
        totals = [self.joined({before: _ZERO, loop: total}) for total in new]
        is_even = b.icmp_signed("==", b.and_(j, _word(1)), _word(0))
        b.cbranch(b.and_(is_even, b.icmp_signed(">", j, _word(0))), last, after)
        b.position_at_end(last)
        longer = self.added(totals[:R], rows, end, j)
        b.branch(after)
        b.position_at_end(after)
        odd = [self.joined({middle: one, last: other}) for one, other in zip(totals, longer, strict=False)]
        return [b.fadd(*each) for each in zip(odd, totals[R:], strict=True)]

    def added(self, totals: list[Any], rows: list[tuple[int, int]], i: Any, j: Any) -> list[Any]:
        """Write sums with z_a[i] z_b[j - i] more."""
        b, other = self.builder, self.builder.sub(j, i)
        left = {a: self.load_spread(i, a) for a, _ in rows}
        right = {B: self.load(other, B) for _, B in rows}
        return [b.fadd(total, b.fmul(left[a], right[B])) for total, (a, B) in zip(totals, rows, strict=True)]

    def collected(self, sums: list[Any], divisor: Any) -> list[Any]:
        """Write the next coefficients of x: those of its rates, divided."""
        b, found = self.builder, []
        for B, scales in enumerate(self.scales):
            rate = _ZERO
            for (q, at), scale in zip(self.slots(B), scales, strict=True):
                places = [_SIDE if term is None else self.found[term] % self.side for term in at]
                rate = b.fadd(rate, b.fmul(scale, self.shuffled(sums[q], _ZERO, places)))
            found.append(b.fdiv(rate, divisor) if scales else rate)
        return found

    def moved(self, z: list[Any], j: Any) -> list[Any]:
        """Write z of an order with its velocities, w = V r, and store it."""
        b, momenta = self.builder, [self.spread(z, len(self.terms) + i) for i in range(self.k)]
        for B in range(self.moving):
            w = _ZERO
            for column, momentum in zip(self.columns, momenta, strict=True):
                w = b.fadd(w, b.fmul(column[B], momentum))
            own = [at + _SIDE * (at < self.k - B * self.side) for at in range(self.side)]
            z[B] = self.shuffled(z[B], w, own)
        for B, value in enumerate(z):
            b.store(value, self.block_at(j, B), align=8)
        return z

    @functools.cache  # noqa: B019  # it lives as long as a function is written
    def slots(self, B: int) -> list[tuple[int, list[int | None]]]:
        """Return what is added to a block one after another: of which sum, and the term of each of its places, or None.

        The terms of a component keep their order.
        """
        components = range(B * self.side - self.k, (B + 1) * self.side - self.k)
        left = [self.terms[m][::-1] if 0 <= m < len(self.terms) else [] for m in components]
        slots: list[tuple[int, list[int | None]]] = []
        while any(left):
            sums = [self.found[terms[-1]] // self.side if terms else len(self.found) for terms in left]
            q = min(sums)
            slots.append(
                (q, [terms.pop() if of == q and terms else None for of, terms in zip(sums, left, strict=True)])
            )
        return slots

    def column(self, i: int, B: int) -> list[int | None]:
        """Return which numbers of V stand at the places of a block, of a column."""
        return [a * self.k + i if a < self.k else None for a in range(B * self.side, (B + 1) * self.side)]

    def gathered(self, base: Any, places: list[int | None]) -> Any:
        """Load numbers from anywhere, or zeros, into a vector."""
        b, vector = self.builder, _ZERO
        if self.side == 1:
            return b.load(b.bitcast(b.gep(base, [_word(_SIDE * (places[0] or 0))]), _VECTOR.as_pointer()), align=8)
        for lane, place in enumerate(places):
            if place is not None:
                vector = b.insert_element(vector, b.load(b.gep(base, [_word(place)])), _LANE(lane))
        return vector

    def address(self, j: Any, place: int) -> Any:
        """Return where a place of a coefficient stands."""
        at = self.builder.add(self.builder.mul(j, _word(self.blocks * _SIDE)), _word(place * _SIDE // self.side))
        return self.builder.gep(self.series, [at])

    def block_at(self, j: Any, B: int) -> Any:
        """Return where a block of a coefficient stands."""
        return self.builder.bitcast(self.address(j, B * self.side), _VECTOR.as_pointer())

    def load(self, j: Any, B: int) -> Any:
        """Load a block of a coefficient."""
        return self.builder.load(self.block_at(j, B), align=8)

    def load_spread(self, j: Any, place: int) -> Any:
        """Load a place of a coefficient for each number of a vector."""
        return self.load(j, place) if self.side == 1 else self.splat(self.builder.load(self.address(j, place)))

    def spread(self, z: list[Any], place: int) -> Any:
        """Return a place of a coefficient for each number of a vector."""
        return self.shuffled(z[place // self.side], _ZERO, [place % self.side] * self.side)

    def splat(self, number: Any) -> Any:
        """Return a vector of one number."""
        one = self.builder.insert_element(_ZERO, number, _LANE(0))
        return self.builder.shuffle_vector(one, _ZERO, _lanes([0] * _SIDE))

    def shuffled(self, first: Any, second: Any, places: list[int]) -> Any:
        """Return places of two blocks in one."""
        if self.side == 1:
            return first if places == [0] else second
        return self.builder.shuffle_vector(first, second, _lanes(places))

    def joined(self, values: dict[Any, Any]) -> Any:
        """Return a value that depends on the instructions before."""
        phi = self.builder.phi(next(iter(values.values())).type)
        for block, value in values.items():
            phi.add_incoming(value, block)
        return phi


def _word(value: int) -> Any:
    return ir.Constant(_WORD, value)


def _lanes(places: list[int]) -> Any:
    return ir.Constant(ir.VectorType(_LANE, _SIDE), places)
