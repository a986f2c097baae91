r"""Energy levels on the projective plane of displacements of a top, in polar coordinates.

With $z = \sqrt\rho\,u(\varphi)$, $b = u\cdot Bu$, $\sigma = c\cdot u^\perp$ and $\kappa = 1 - \sigma^2/D$ the level is
$b(\rho - \kappa\rho^2) = e$, $e = h^2E/2$, on $0 \le \rho \le 1$.
"""

import dataclasses
import itertools

import numpy as np

from nonholo.analysis.planar._level_arcs import EQUATOR, FOLD, Arc, closed_curves
from nonholo.base.types import Float


@dataclasses.dataclass(frozen=True, eq=False)
class DiscLevel:
    """The level e of a top with restricted inertia B and coupling c."""

    B: Float[np.ndarray, "2 2"]
    c: Float[np.ndarray, "2"]
    e: float

    def over(self, direction: float) -> Float[np.ndarray, "m 3"]:
        """Return the points over a direction, the inner one first."""
        angle = np.array([direction])
        found = [self._points(sign, angle, 1) for sign in (-1, 1) if self._valid(sign, direction)]
        return np.concatenate([np.empty((0, 3)), *found])

    def components(self, count: int) -> tuple[Float[np.ndarray, "K 3"], ...]:
        """Return the connected curves, lifted to the sphere."""
        arcs = [arc for sign in (-1, 1) for arc in self._arcs(sign)]
        return closed_curves(arcs, lambda arc, directions, side: self._points(arc.sign, directions, side), count)

    def _arcs(self, sign: int) -> list[Arc]:
        breaks = [(angle, FOLD) for angle in self._folds()]
        breaks += [(angle, EQUATOR) for angle in self._crossings() if self._reaches(angle) == sign]
        if not breaks:
            whole = all(self._valid(sign, angle) for angle in (0.0, 1.0, 2.0, 3.0))
            return [Arc(sign, 0.0, 2 * np.pi)] if whole else []
        breaks.sort()
        turned = [(angle + turn, kind) for turn in (0.0, np.pi, 2 * np.pi) for angle, kind in breaks]
        pairs = list(itertools.pairwise(turned))[: 2 * len(breaks)]
        return [Arc(sign, p, q, (s, t)) for (p, s), (q, t) in pairs if self._valid(sign, (p + q) / 2)]

    def _shape(self, angle: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        u = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        b = np.einsum("...i,ij,...j->...", u, self.B, u)
        kappa = 1 - (u @ self._normal) ** 2 / np.linalg.det(self.B)
        return u, b, kappa

    @property
    def _normal(self) -> Float[np.ndarray, "2"]:
        return np.array([self.c[1], -self.c[0]])

    def _size(self, sign: int, angle: np.ndarray) -> np.ndarray:
        """Return rho: the smaller solution, or the larger one; infinity where that one has passed it."""
        _, b, kappa = self._shape(angle)
        root = np.sqrt(np.maximum(1 - 4 * kappa * self.e / b, 0.0))
        if sign < 0:
            return 2 * self.e / (b * (1 + root))
        return np.divide(1 + root, 2 * kappa, out=np.full_like(b, np.inf), where=kappa > 0)

    def _points(self, sign: int, angle: np.ndarray, side: int) -> Float[np.ndarray, "K 3"]:
        u, rho = self._shape(angle)[0], np.minimum(self._size(sign, angle), 1.0)
        return np.concatenate([side * np.sqrt(1 - rho)[..., None], np.sqrt(rho)[..., None] * u], axis=-1)

    def _valid(self, sign: int, angle: float) -> bool:
        _, b, kappa = self._shape(np.array(angle))
        return bool(b >= 4 * kappa * self.e and self._size(sign, np.array([angle]))[0] <= 1)

    def _reaches(self, angle: float) -> int:
        """Return which solution is 1 in a direction where one of them is."""
        return 1 if self._shape(np.array(angle))[2] >= 0.5 else -1

    def _folds(self) -> list[float]:
        """Return the directions, modulo pi, where b = 4 kappa e: the zeros of a quadratic form."""
        n = self._normal
        form = self.B - 4 * self.e * (np.eye(2) - np.outer(n, n) / np.linalg.det(self.B))
        (low, high), vectors = np.linalg.eigh(form)
        if low >= 0 or high <= 0:
            return []
        half = np.arctan2(np.sqrt(-low), np.sqrt(high))
        zeros = (vectors @ [np.cos(half), side * np.sin(half)] for side in (1, -1))
        return [float(np.arctan2(v[1], v[0]) % np.pi) for v in zeros]

    def _crossings(self) -> list[float]:
        r"""Return the directions, modulo pi, where $b\sigma^2 = De$: a quartic in the tangent."""
        (b11, b12), (_, b22) = self.B
        n1, n2 = self._normal
        product = np.convolve([b22, 2 * b12, b11], [n2 * n2, 2 * n1 * n2, n1 * n1])
        quartic = product - np.linalg.det(self.B) * self.e * np.array([1.0, 0.0, 2.0, 0.0, 1.0])
        roots = np.roots(quartic)
        return [float(np.arctan(t.real) % np.pi) for t in roots if abs(t.imag) <= 1e-9 * (1 + abs(t))]
