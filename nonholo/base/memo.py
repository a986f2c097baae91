"""Properties that are computed once, and are no part of what is copied or pickled."""

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from nonholo.base.checks import is_traced
from nonholo.base.types import read_only

_SMALL = 1 << 15  # bytes; larger arrays take longer to compute than anyone saves by keeping them


class Keeper:
    """An object that keeps what it computes; its copies and pickles have what it was made of, nothing else."""

    def __reduce_ex__(self, protocol: Any) -> Any:
        """Return the call that made it, where it was made by one that has a name; otherwise its fields."""
        return vars(self).get("recipe") or object.__reduce_ex__(self, protocol)

    def __getstate__(self) -> dict[str, Any]:
        kind, own = type(self), vars(self)
        properties = {x for x in own if "." in x or isinstance(getattr(kind, x, None), functools.cached_property)}
        return {name: own[name] for name in own if name not in properties}


if TYPE_CHECKING:
    memo = system_memo = property
else:

    class memo(functools.cached_property):  # noqa: N801
        """A property of a `Keeper` that is computed once, at any size; its array is read-only.

        Example:
            >>> class Row(Keeper):
            ...     @memo
            ...     def squares(self) -> np.ndarray:
            ...         return np.arange(3.0) ** 2
            >>> row = Row()
            >>> row.squares is row.squares, row.squares.flags.writeable
            (True, False)
        """

        def __init__(self, compute: Callable[[Any], Any]) -> None:
            super().__init__(functools.wraps(compute)(lambda owner: read_only(compute(owner))))

    class system_memo(functools.cached_property):  # noqa: N801
        """A property of a system, computed once; small arrays are kept, and given as copies.

        A traced value belongs to its trace: a system with a traced one among its `leaves` keeps nothing.
        """

        def __get__(self, owner: Any, kind: type | None = None) -> Any:
            """Return the value."""
            if owner is None:
                return self
            own, name = owner.__dict__, self.func.__qualname__  # has a dot, which no name of a field has
            if (value := own.get(name)) is not None:
                return value.copy()
            value = self.func(owner)
            is_array = isinstance(value, np.ndarray)
            if (is_array and value.nbytes > _SMALL) or any(is_traced(getattr(owner, leaf)) for leaf in owner.leaves):
                return value
            own[name if is_array else self.attrname] = value  # what stands under its name is found there
            return value.copy() if is_array else value
