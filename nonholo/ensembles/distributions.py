"""Distributions of a random design: functions of uniform numbers, so that members can be drawn in any order."""

import abc
import dataclasses
import math
from typing import Any

import numpy as np
import scipy  # its parts load on first use

from nonholo.base.checks import array, bounded_count, count, error, number, positive, shape_of, trailing, within_memory
from nonholo.base.types import Float

_LEAST = 2.0**-54  # instead of a uniform number zero, where its logarithm is needed


class AbstractDistribution(abc.ABC):
    """A distribution of numbers, vectors or matrices.

    Attributes:
        shape: Of one draw.
    """

    shape: tuple[int, ...]

    @property
    def width(self) -> int:
        """Uniform numbers that one draw takes: by default one for each of its numbers."""
        return math.prod(self.shape)

    @abc.abstractmethod
    def draw(self, uniform: Float[np.ndarray, "count width"]) -> Float[np.ndarray, "count ..."]:
        """Return draws, one for each row of uniform numbers."""


@dataclasses.dataclass(frozen=True)
class AbstractBounded(AbstractDistribution):
    """Numbers between two bounds, or vectors of them if the bounds are vectors."""

    low: Any
    high: Any

    def __post_init__(self) -> None:
        _bounds(self)


@dataclasses.dataclass(frozen=True)
class Uniform(AbstractBounded):
    """Numbers between two bounds, or vectors of them if the bounds are vectors.

    Example:
        >>> Uniform(1.0, 3.0).draw(np.array([[0.0], [0.5]]))
        array([1., 2.])
    """

    def draw(self, uniform: Float[np.ndarray, "count width"]) -> Float[np.ndarray, "count ..."]:
        """Return draws, one for each row of uniform numbers."""
        return self.low + (np.asarray(self.high) - self.low) * uniform.reshape(-1, *self.shape)


@dataclasses.dataclass(frozen=True)
class LogUniform(AbstractBounded):
    """Positive numbers whose logarithms lie evenly between those of two bounds.

    Example:
        >>> LogUniform(0.01, 100.0).draw(np.array([[0.5]]))
        array([1.])
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        if not np.min(self.low) > 0:
            raise error("LogUniform(low=...)", "be positive", f"{self.low}", "Pass positive bounds, or use Uniform.")

    def draw(self, uniform: Float[np.ndarray, "count width"]) -> Float[np.ndarray, "count ..."]:
        """Return draws, one for each row of uniform numbers."""
        draws = np.exp(Uniform(np.log(self.low), np.log(self.high)).draw(uniform))
        return np.clip(draws, self.low, self.high)  # logarithms of the bounds are rounded


@dataclasses.dataclass(frozen=True)
class Normal(AbstractDistribution):
    """Normal numbers, or with `size` vectors of independent ones.

    Example:
        >>> Normal(1.0, 2.0).draw(np.array([[0.5]]))
        array([1.])
    """

    mean: Any = 0.0
    deviation: Any = 1.0
    size: int | None = None

    def __post_init__(self) -> None:
        mean = float(number("Normal(mean=...)", self.mean))
        spread = float(positive("Normal(deviation=...)", self.deviation, "Pass a positive standard deviation."))
        vars(self).update(mean=mean, deviation=spread, shape=() if self.size is None else (self.size,))
        if self.size is not None:
            bounded_count("Normal(size=...)", self.size, 8.0, "Pass the length of the vectors.")

    def draw(self, uniform: Float[np.ndarray, "count width"]) -> Float[np.ndarray, "count ..."]:
        """Return draws, one for each row of uniform numbers."""
        return self.mean + self.deviation * scipy.special.ndtri(np.maximum(uniform, _LEAST)).reshape(-1, *self.shape)


@dataclasses.dataclass(frozen=True)
class Direction(AbstractDistribution):
    """Vectors of one length that point anywhere with the same probability.

    Example:
        >>> Direction(3, length=2.0).draw(np.array([[0.5, 0.9, 0.5]])).round(12)
        array([[0., 2., 0.]])
    """

    size: int
    length: Any = 1.0

    def __post_init__(self) -> None:
        bounded_count("Direction(size=...)", self.size, 8.0, "Pass the length of the vectors.")
        length = float(positive("Direction(length=...)", self.length, "Pass their norm."))
        vars(self).update(length=length, shape=(self.size,))

    def draw(self, uniform: Float[np.ndarray, "count width"]) -> Float[np.ndarray, "count ..."]:
        """Return draws, one for each row of uniform numbers."""
        x = Normal(size=self.size).draw(uniform)
        return self.length * x / np.sqrt((x * x).sum(axis=1, keepdims=True))


@dataclasses.dataclass(frozen=True)
class MassTensor(AbstractDistribution):
    r"""Mass tensors $J = Q\,\mathrm{diag}(\lambda)\,Q^T$: eigenvalues between two bounds, axes that point anywhere.

    Example:
        >>> J = MassTensor(3, 0.5, 2.0).draw(np.random.default_rng(0).random((5, 12)))
        >>> bool((J == J.swapaxes(1, 2)).all()), bool((np.linalg.eigvalsh(J) > 0.49).all())
        (True, True)
    """

    n: int
    low: Any
    high: Any

    def __post_init__(self) -> None:
        n = count("MassTensor(n=...)", self.n, "Pass the dimension of the body.")
        within_memory("MassTensor(n=...)", 24.0 * n * n, "Pass a smaller n.")
        _bounds(self)
        vars(self).update(shape=(n, n))
        if np.ndim(self.low) or not self.low > 0:
            raise error("MassTensor(low=...)", "be one positive number", f"{self.low}", "Pass the least eigenvalue.")

    @property
    def width(self) -> int:
        """Uniform numbers that one draw takes."""
        return self.n * (self.n + 1)

    def draw(self, uniform: Float[np.ndarray, "count width"]) -> Float[np.ndarray, "count ..."]:
        """Return draws, one for each row of uniform numbers."""
        eigenvalues = self.low + (self.high - self.low) * np.ascontiguousarray(uniform[:, : self.n].T)
        normal = np.ascontiguousarray(Normal(size=self.n**2).draw(uniform[:, self.n :]).T)
        J = np.zeros((self.n, self.n, len(uniform)))  # members last: NumPy is slow along short axes
        for eigenvalue, x in zip(eigenvalues, _orthonormal(normal.reshape(self.n, self.n, -1)), strict=True):
            J += eigenvalue * x[:, None] * x[None]
        return np.ascontiguousarray(np.moveaxis((J + J.swapaxes(0, 1)) / 2, -1, 0))


@dataclasses.dataclass(frozen=True)
class Choice(AbstractDistribution):
    """One of some values, all with the same probability.

    Example:
        >>> Choice([1.0, 5.0]).draw(np.array([[0.2], [0.7]]))
        array([1., 5.])
    """

    values: Any

    def __post_init__(self) -> None:
        values = checked_list("Choice(values=...)", self.values)
        vars(self).update(values=values.tolist(), shape=values.shape[1:])

    @property
    def width(self) -> int:
        """Uniform numbers that one draw takes."""
        return 1

    def draw(self, uniform: Float[np.ndarray, "count width"]) -> Float[np.ndarray, "count ..."]:
        """Return draws, one for each row of uniform numbers."""
        return np.asarray(self.values)[(uniform[:, 0] * len(self.values)).astype(int)]


DISTRIBUTIONS = {kind.__name__: kind for kind in (Uniform, LogUniform, Normal, Direction, MassTensor, Choice)}


def checked_list(where: str, values: Any) -> Float[np.ndarray, "count ..."]:
    """Return a list of numbers, vectors or matrices, at least one, as an array."""
    remedy = "Pass a list of values."
    values_checked = array(where, values, (None,) * max(1, len(shape_of(values))), remedy)
    if not len(values_checked):
        raise error(where, "hold at least one value", "none", remedy)
    return values_checked


def _bounds(owner: Any) -> None:
    """Check and keep two bounds and their shape, as plain numbers, which are written to stores exactly."""
    name, remedy = type(owner).__name__, "Pass numbers, or vectors of one length."
    low, high = (trailing(f"{name}({side}=...)", getattr(owner, side), (), remedy) for side in ("low", "high"))
    for side, bound in (("low", low), ("high", high)):
        if not bound.size:
            raise error(f"{name}({side}=...)", "have a number", "none", remedy)
    if 1 not in (low.size, high.size) and low.shape != high.shape:
        raise error(f"{name}(high=...)", "have the shape of `low`", f"{high.shape} and {low.shape}", remedy)
    low, high = np.broadcast_arrays(low, high)
    low, high = (array(f"{name}({side}=...)", x, low.shape, remedy) for side, x in (("low", low), ("high", high)))
    if not np.all(low <= high):
        raise error(f"{name}(high=...)", "not be below `low`", f"{high} for low {low}", "Exchange the two.")
    vars(owner).update(low=low.tolist(), high=high.tolist(), shape=low.shape)


def _orthonormal(rows: Float[np.ndarray, "n n count"]) -> list[Float[np.ndarray, "n count"]]:
    """Return orthonormal rows of the same flags by Gram-Schmidt, which has the same bits in any company."""
    rows_before: list[np.ndarray] = []
    for x in rows:
        for y in 2 * rows_before:  # twice is enough
            x = x - (x * y).sum(axis=0) * y
        rows_before.append(x / np.sqrt((x * x).sum(axis=0)))
    return rows_before
