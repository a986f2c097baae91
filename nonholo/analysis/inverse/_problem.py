"""Residuals of records under the numbers of a body and starts, with derivatives, as least squares take them."""

import dataclasses
import functools
from collections.abc import Callable
from typing import Any

import numpy as np

from nonholo.analysis.inverse._profile import Minimum
from nonholo.base.types import Float


@dataclasses.dataclass(eq=False)
class Problem:
    """Residuals and derivatives at a point: parameters, then the start of each trial."""

    missed: Callable[..., Any]
    poses: Float[np.ndarray, "T N N"]
    kinds: dict[str, Float[np.ndarray, "T K _"]]
    count: int
    shape: tuple[int, int]
    known: tuple[np.ndarray, Any] | None = None

    @functools.cached_property
    def there(self) -> dict[str, np.ndarray]:
        """Which residuals belong to measured numbers."""
        found = {kind: np.isfinite(rows) for kind, rows in self.kinds.items()}
        return {k: x[..., :3] if k == "turn" else x for k, x in found.items()}

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
        """The kind of each measured number, as a position in `kinds`."""
        return np.repeat(np.arange(len(self.there)), [np.count_nonzero(x) for x in self.there.values()])

    def minimum(self, point: np.ndarray, noise: np.ndarray, exists: Callable[[np.ndarray], bool]) -> Minimum:
        """Return what profiles need of the best point under noise levels of the kinds."""
        scale, free = noise[self.kind_of], len(self.kind_of) - len(point)
        return Minimum(lambda x: self.rows(x) / scale, lambda x: self.slope(x) / scale[:, None], exists, point, free)
