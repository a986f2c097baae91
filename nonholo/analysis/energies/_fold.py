r"""Up to which energy the momenta of a discrete top (n = 3) determine the displacement around the identity.

On a ray of displacements with one axis $\cot(\theta/2)$ of a fold is a root of a cubic; the least energy of all folds
is found by a search along the circle of axes. Theory: docs/theory/critical-energies-and-limits.md, "The first fold".
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import scipy  # its parts load on first use

from nonholo.base.numerics import real_cubic_roots
from nonholo.base.types import Float

_UNIFORM = 720  # directions around the circle, once in the metric of the energy and once in that of the plane
_NEAR_SADDLE = 200  # on each side: folds leave the saddle at every scale


class Directions(NamedTuple):
    r"""The numbers that the energy and the folds over directions u need.

    Attributes:
        b: $u\cdot Bu$.
        slope: $c\cdot Bu/D$.
        sharp: $s = (c\cdot u^\perp)/\sqrt D$.
        along: $(c\cdot u)\,b/D$.
    """

    b: Float[np.ndarray, "K"]
    slope: Float[np.ndarray, "K"]
    sharp: Float[np.ndarray, "K"]
    along: Float[np.ndarray, "K"]

    @classmethod
    def over(cls, u: Float[np.ndarray, "K 2"], B: Float[np.ndarray, "2 2"], c: Float[np.ndarray, "2"]) -> "Directions":
        """Return them for unit vectors."""
        D, Bu = np.linalg.det(B), u @ B
        b = np.einsum("ki,ki->k", u, Bu)
        return cls(b, Bu @ c / D, (u[:, 0] * c[1] - u[:, 1] * c[0]) / np.sqrt(D), (u @ c) * b / D)

    def ridge(self) -> Float[np.ndarray, "K"]:
        r"""Return $x = \cot(\theta/2)$ where the energy is greatest on the ray; 0, half-turns, where it only grows."""
        return np.sqrt(np.maximum(1 - 2 * self.sharp**2, 0.0))

    def fold(self) -> Float[np.ndarray, "K"]:
        r"""Return the first fold on the ray, the largest root of $x^3 - px^2 - (1 - 2s^2)x + 2\gamma - p$."""
        rest = zip(-self.slope, 2 * self.sharp**2 - 1, 2 * self.along - self.slope, strict=True)
        return np.array([max(real_cubic_roots(1.0, *map(float, row))[1:]) for row in rest])

    def energy(self, x: Float[np.ndarray, "K"]) -> Float[np.ndarray, "K"]:
        r"""Return $b\,(x^2 + s^2)/(1 + x^2)^2$, the energy times $h^2/2$."""
        return self.b * (x * x + self.sharp**2) / (1 + x * x) ** 2


def fold_energy(B: Float[np.ndarray, "2 2"], c: Float[np.ndarray, "2"]) -> float:
    r"""Return $h^2/2$ times the least energy at which a ray from the identity meets a fold or its ridge.

    Args:
        B: Inertia along the constraint, symmetric and positive definite.
        c: Coupling.
    """
    values, vectors = np.linalg.eigh(B)
    root = vectors / np.sqrt(values) @ vectors.T  # B^(-1/2)

    def least(angle: Float[np.ndarray, "K"]) -> Float[np.ndarray, "K"]:
        u = np.stack([np.cos(angle), np.sin(angle)], axis=-1) @ root
        over = Directions.over(u / np.linalg.norm(u, axis=1)[:, None], B, c)
        return over.energy(np.maximum(over.fold(), over.ridge()))

    angles = _angles(B, c, root)
    sampled = least(angles)
    low = np.flatnonzero((sampled <= np.roll(sampled, 1)) & (sampled <= np.roll(sampled, -1)))
    ends = np.stack([np.roll(angles, 1)[low], np.roll(angles, -1)[low]], axis=1)
    ends[ends[:, 0] > ends[:, 1], 0] -= 2 * np.pi
    return min([float(sampled.min()), *(_polished(least, pair) for pair in ends)])


def _polished(least: Callable, ends: Float[np.ndarray, "2"]) -> float:
    """Return the least value between two angles."""
    minimize: Any = scipy.optimize.minimize_scalar
    found = minimize(lambda a: least(np.array([a]))[0], bounds=ends, method="bounded", options={"xatol": 1e-12})
    return float(found.fun)


def _angles(B: np.ndarray, c: np.ndarray, root: np.ndarray) -> Float[np.ndarray, "K"]:
    r"""Return sorted angles of $B^{1/2}u$ to search: uniform in it and in u, dense around both saddles."""
    across = np.array([-c[1], c[0]])
    kappa = np.eye(2) - np.outer(across, across) / np.linalg.det(B)
    top = scipy.linalg.eigh(root @ kappa @ root)[1][:, -1]  # the saddle has the least b/kappa
    uniform = np.linspace(0.0, 2 * np.pi, _UNIFORM, endpoint=False)
    turned = np.linalg.solve(root, np.stack([np.cos(uniform), np.sin(uniform)]))
    near = np.geomspace(1e-7, 0.3, _NEAR_SADDLE)
    saddle = np.arctan2(top[1], top[0]) + np.concatenate([-near, [0.0], near])
    angles = np.concatenate([uniform, np.arctan2(turned[1], turned[0]), saddle, saddle + np.pi])
    return np.unique(angles % (2 * np.pi))
