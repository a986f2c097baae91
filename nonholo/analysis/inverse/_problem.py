"""Residuals of records under the numbers of a body and starts, with derivatives, as least squares take them."""

import dataclasses
import functools
from collections.abc import Callable
from typing import Any

import numpy as np

from nonholo.base.types import Array, Float

Shapes = tuple[tuple[str, tuple[int, ...]], ...]


def named(shapes: Shapes, numbers: Array) -> dict[str, Array]:
    """Return the parameters in a vector by name, traced ones too."""
    cuts = np.cumsum([0, *(int(np.prod(shape)) for _, shape in shapes)])
    return {name: numbers[i:j].reshape(shape)[()] for (name, shape), i, j in zip(shapes, cuts, cuts[1:], strict=False)}


@dataclasses.dataclass(eq=False)
class Problem:
    """Residuals and derivatives at a point: parameters, then the start of each trial.

    Attributes:
        missed: Residuals with derivatives, of parameters, starts, poses and kinds.
        poses: Where the changes of pose in the starts begin.
        kinds: What was measured.
        count: How many parameters there are.
        shape: Of the starts: trials, numbers of each.
        known: The last point with what is missed there.
    """

    missed: Callable[..., Any]
    poses: Float[np.ndarray, "T N N"]
    kinds: dict[str, Float[np.ndarray, "T K _"]]
    count: int
    shape: tuple[int, int]
    known: tuple[np.ndarray, Any] | None = None

    @functools.cached_property
    def there(self) -> dict[str, np.ndarray]:
        """Which residuals belong to measured numbers, of the kinds that have some."""
        found = {kind: np.isfinite(rows) for kind, rows in self.kinds.items()}
        return {k: x[..., :3] if k == "turn" else x for k, x in found.items() if x.any()}

    def at(self, point: np.ndarray) -> dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Return by kind the residuals and both derivatives, computed once for each point."""
        if self.known is None or not np.array_equal(self.known[0], point):
            starts = point[self.count :].reshape(self.shape)
            self.known = point.copy(), self.missed(point[: self.count], starts, self.poses, self.kinds)
        return self.known[1]

    def rows(self, point: np.ndarray) -> np.ndarray:
        """Return the residuals of measured numbers, kind after kind."""
        found = self.at(point)
        return np.concatenate([found[kind][0][there] for kind, there in self.there.items()])

    def slope(self, point: np.ndarray) -> np.ndarray:
        """Return their derivatives: a trial depends on its own start alone."""
        found, parts, (T, width) = self.at(point), [], self.shape
        for kind, there in self.there.items():
            _, by_numbers, by_starts = found[kind]
            whole = np.zeros((*there.shape, self.count + T * width))
            whole[..., : self.count] = by_numbers
            for i in range(T):
                whole[i, ..., self.count + i * width : self.count + (i + 1) * width] = by_starts[i]
            parts.append(whole[there])
        return np.concatenate(parts)

    @functools.cached_property
    def kind_of(self) -> np.ndarray:
        """The kind of each measured number, as a position in `there`."""
        return np.repeat(np.arange(len(self.there)), [np.count_nonzero(x) for x in self.there.values()])
