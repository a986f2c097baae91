r"""The change of volumes of restricted momenta by one step of the discrete map.

With $F(W) = P(W)|_\mathfrak{d}$ a step takes $r = F(W)$ to $r' = -F(W^{-1})$, so that along the displacement variety
$\det(\partial r'/\partial r) = \det F'(W^{-1})/\det F'(W)$. Theory: docs/theory/invariant-measure.md.
"""

import numpy as np

from nonholo.analysis.planar import planar_variety
from nonholo.base.types import Array, Float
from nonholo.discrete import Discretization, momentum_slope


def step_determinants(discrete: Discretization, W: Float[np.ndarray, "... N N"]) -> Float[Array, "..."]:
    """Return the determinant of one step from each displacement; infinite at a fold."""
    system, variety = discrete.system, planar_variety(discrete.system)
    with np.errstate(divide="ignore"):
        if variety is not None:
            even, odd = variety.area_factor(variety.points(W))
            return (even - odd) / (even + odd)
        after, before = (np.linalg.det(momentum_slope(discrete, V)) for V in (system.group.inverse(W), W))
        return after / before
