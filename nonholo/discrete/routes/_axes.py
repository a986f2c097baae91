"""The axes that a kernel works in, as seen from the canonical frame of a system."""

import dataclasses
import functools

import numpy as np

from nonholo.base.numerics import applied
from nonholo.base.types import Float
from nonholo.groups import AbstractMatrixGroup


@dataclasses.dataclass(frozen=True, eq=False)
class Axes:
    """A change of the body frame and of the rows along the constraint; nothing is computed where there is none.

    Attributes:
        group: The group.
        frame: The axes of the kernel as seen from the canonical frame; None where they are the same.
        rows: C with m = C r for canonical momenta r, and y_canonical = y C for charts; None where rows are the same.
    """

    group: AbstractMatrixGroup
    frame: Float[np.ndarray, "N N"] | None
    rows: Float[np.ndarray, "k k"] | None

    def momenta(self, canonical: np.ndarray) -> np.ndarray:
        """Return momenta along the kernel's rows."""
        return canonical if self.rows is None else applied(self.rows, canonical)

    def canonical_momenta(self, momenta: np.ndarray) -> np.ndarray:
        """Return momenta along the canonical rows."""
        return momenta if self.rows is None else applied(self._inverse, momenta)

    def charts(self, canonical: np.ndarray) -> np.ndarray:
        """Return charts along the kernel's rows."""
        return canonical if self.rows is None else applied(self._inverse.T, canonical)

    def canonical_charts(self, charts: np.ndarray) -> np.ndarray:
        """Return charts along the canonical rows."""
        return charts if self.rows is None else applied(self.rows.T, charts)

    def turned(self, g: np.ndarray) -> np.ndarray:
        """Return matrices of poses of the kernel's axes."""
        return g if self.frame is None else g @ self.frame

    def turned_back(self, g: np.ndarray) -> np.ndarray:
        """Return matrices of poses of the canonical axes."""
        return g if self.frame is None else g @ self.group.inverse(self.frame)

    @functools.cached_property
    def _inverse(self) -> np.ndarray:
        return np.linalg.inv(np.asarray(self.rows))
