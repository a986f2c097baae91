"""The cuts of a design: one block of members is one chunk of each array, and its members follow each other."""

import math
from typing import NamedTuple

import numpy as np


class Piece(NamedTuple):
    """A block: its number, where it lies in the arrays, its first member and how many it has."""

    number: int
    place: tuple[slice, ...]
    first: int
    count: int


class Layout(NamedTuple):
    """The lengths of the dimensions of a design and of a block.

    Example:
        >>> layout = layout_of((3, 5), block=2)
        >>> layout, layout.blocks
        (Layout(sizes=(3, 5), chunk=(1, 2)), 9)
        >>> layout.piece(5)
        Piece(number=5, place=(slice(1, 2, None), slice(4, 5, None)), first=9, count=1)
    """

    sizes: tuple[int, ...]
    chunk: tuple[int, ...]

    @property
    def blocks(self) -> int:
        """Number of blocks."""
        return math.prod(self.counts)

    @property
    def counts(self) -> tuple[int, ...]:
        """Numbers of blocks along each dimension."""
        return tuple(-(-size // chunk) for size, chunk in zip(self.sizes, self.chunk, strict=True))

    def index(self, block: int) -> tuple[int, ...]:
        """Return where a block stands among the blocks."""
        return tuple(int(at) for at in np.unravel_index(block, self.counts))

    def piece(self, block: int) -> Piece:
        """Return a block."""
        begins = [at * chunk for at, chunk in zip(self.index(block), self.chunk, strict=True)]
        ends = [min(begin + chunk, size) for begin, chunk, size in zip(begins, self.chunk, self.sizes, strict=True)]
        place = tuple(slice(begin, end) for begin, end in zip(begins, ends, strict=True))
        first = int(np.ravel_multi_index(begins, self.sizes))
        return Piece(block, place, first, math.prod(s.stop - s.start for s in place))


def layout_of(sizes: tuple[int, ...], block: int) -> Layout:
    """Cut a design in blocks of `block` members at most: whole last dimensions, a part of one, one of those before."""
    chunk, room = [], block
    for size in reversed(sizes):
        chunk.append(max(1, min(size, room)))
        room //= chunk[-1] if chunk[-1] == size else room
    return Layout(sizes, tuple(reversed(chunk)))
