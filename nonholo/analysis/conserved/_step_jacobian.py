r"""The change of volumes of restricted momenta by one step of the discrete map.

With $F(W) = P(W)|_\mathfrak{d}$ a step takes $r = F(W)$ to $r' = -F(W^{-1})$, so that along the displacement variety
$\det(\partial r'/\partial r) = \det F'(W^{-1})/\det F'(W)$. Theory: docs/theory/invariant-measure.md.
"""

import numpy as np

from nonholo.analysis.planar import planar_variety
from nonholo.base.types import Array, Float
from nonholo.discrete import Discretization


def step_determinants(discrete: Discretization, W: Float[np.ndarray, "... N N"]) -> Float[Array, "..."]:
    """Return the determinant of one step from each displacement; infinite at a fold."""
    system, variety = discrete.system, planar_variety(discrete.system)
    with np.errstate(divide="ignore"):
        if variety is not None:
            even, odd = variety.area_factor(variety.points(W))
            return (even - odd) / (even + odd)
        after, before = (np.linalg.det(momentum_slope(discrete, V)) for V in (system.group.inverse(W), W))
        return after / before


def step_jacobians(discrete: Discretization, W: Float[np.ndarray, "... N N"]) -> Float[np.ndarray, "... k k"]:
    r"""Return the derivatives of restricted momenta after a step by those before it, at each displacement.

    Where the constraint is no chart, $(W - W^{-1})/2 \in \mathfrak{d}$ ties the directions of Cayley coordinates.
    """
    group, system = discrete.system.group, discrete.system
    if discrete.variety.exact:
        after, before = (momentum_slope(discrete, V) for V in (group.inverse(W), W))
        return after @ np.linalg.inv(before)
    (after, _), tied = (_all_slopes(discrete, V) for V in (group.inverse(W), W))
    return after @ np.linalg.inv(np.concatenate(tied, axis=-2))[..., : system.rank]


def _all_slopes(discrete: Discretization, W: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the derivatives of hF and of the forbidden part of (W - W^-1)/2 in all directions."""
    group = discrete.system.group
    sum_, inverse = (W + group.identity)[..., None, :, :], group.inverse(W)[..., None, :, :]
    dW = sum_ @ group.basis @ sum_ / 2
    forbidden = group.vee((dW + inverse @ dW @ inverse) / 2) @ discrete.system.annihilator.T
    return momentum_slope(discrete, W, group.basis), np.swapaxes(forbidden, -1, -2)


def momentum_slope(
    discrete: Discretization, W: Float[np.ndarray, "... N N"], directions: Float[np.ndarray, "m N N"] | None = None
) -> Float[np.ndarray, "... k m"]:
    r"""Return the derivative of hF by the definition, in directions of Cayley coordinates, by default those of d.

    From $W = (I - Y)^{-1}(I + Y)$ follows $dW = \tfrac12(W + I)\,dY\,(W + I)$, and
    $h\langle P, x\rangle = \mathrm{tr}(\hat x W\mathbb{J}(W - I)^*)$.
    """
    system, star = discrete.system, discrete.system.group.form_adjoint
    rows, tensor = system.group.hat(system.constraint_subspace), np.asarray(system.homogeneous_mass_tensor)
    sum_, X = (W + system.group.identity)[..., None, :, :], W - system.group.identity
    dW = sum_ @ (rows if directions is None else directions) @ sum_ / 2
    arm = dW @ tensor @ star(X)[..., None, :, :]
    turned = (W @ tensor)[..., None, :, :] @ star(dW)
    return np.einsum("iab,...jba->...ij", rows, arm + turned)
