"""The part of a sweep that a task sees: some members in order, their values by name, their random numbers."""

import dataclasses
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from nonholo.base.checks import natural, text
from nonholo.base.limits import bounded_count
from nonholo.base.types import Float
from nonholo.ensembles._names import component_name
from nonholo.ensembles.designs import AbstractDesign, uniform_numbers


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class MemberBlock(Mapping[str, Any]):
    """Some members of a sweep in order: a mapping of names to arrays whose first axis is that of the members.

    Attributes:
        first: Number of the first member.
        count: How many.
        seed: Seed of the design.
        arrays: Values by name.

    Example:
        >>> block = block_of(nh.Grid({"a": [1.0, 2.0, 3.0]}), first=1, count=2)
        >>> block["a"], block.index, block.random(3).shape
        (array([2., 3.]), array([1, 2]), (2, 3))
    """

    first: int
    count: int
    seed: int
    arrays: dict[str, np.ndarray]

    def __getitem__(self, name: str) -> np.ndarray:
        name = name if name in self.arrays else component_name(name)
        if name not in self.arrays:
            raise KeyError(f"{name!r}: the design has {', '.join(self.arrays)}")
        return self.arrays[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.arrays)

    def __len__(self) -> int:
        return len(self.arrays)

    def __repr__(self) -> str:
        return f"<MemberBlock: members {self.first} to {self.first + self.count - 1}, {', '.join(self)}>"

    @property
    def index(self) -> np.ndarray:
        """Numbers of the members."""
        return np.arange(self.first, self.first + self.count)

    def random(self, width: int, stream: str = "") -> Float[np.ndarray, "count width"]:
        """Return uniform numbers in [0, 1) of each member, the same in any block; streams are independent."""
        remedy = "Pass how many numbers each member needs."
        width = bounded_count("MemberBlock.random(width=...)", width, 24.0 * self.count, remedy)
        text("MemberBlock.random(stream=...)", stream)
        return uniform_numbers(self.seed, f"task {stream}", self.first, self.count, width)

    def part(self, begin: int, end: int) -> "MemberBlock":
        """Return some of the members, counted from the first one here."""
        begin, end = (natural("MemberBlock.part(...)", x, "Pass numbers of members here.") for x in (begin, end))
        arrays = {name: values[begin:end] for name, values in self.arrays.items()}
        return MemberBlock(self.first + begin, end - begin, self.seed, arrays)


def block_of(design: AbstractDesign, first: int, count: int) -> MemberBlock:
    """Return some members of a design."""
    return MemberBlock(first, count, design.seed, design.values(first, count))
