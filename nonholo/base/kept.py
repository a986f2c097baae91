"""Properties that are computed once."""

from typing import TYPE_CHECKING, Any

import numpy as np

from nonholo.base.checks import is_traced

_SMALL = 1 << 15  # bytes; larger arrays take longer to compute than anyone saves by keeping them

if TYPE_CHECKING:
    kept = property
else:

    class kept(property):  # noqa: N801
        """A property of a system, computed once; small arrays are kept, and given as copies.

        What is traced belongs to its trace: nothing is kept by a system one of whose `leaves` is.
        """

        def __get__(self, owner: Any, kind: type | None = None) -> Any:
            """Return the value."""
            if owner is None:
                return self
            name = self.fget.__qualname__
            value = owner.__dict__.get(name)
            if value is None:
                value = self.fget(owner)
                is_large = isinstance(value, np.ndarray) and value.nbytes > _SMALL
                if is_large or any(is_traced(getattr(owner, leaf)) for leaf in owner.leaves):
                    return value
                owner.__dict__[name] = value
            return value.copy() if isinstance(value, np.ndarray) else value
