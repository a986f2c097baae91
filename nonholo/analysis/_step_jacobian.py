r"""How one step of the discrete map changes volumes of restricted momenta.

With $F(W) = P(W)|_\mathfrak{d}$ a step takes $r = F(W)$ to $r' = -F(W^{-1})$, so that along the displacement variety
$\det(\partial r'/\partial r) = \det F'(W^{-1})/\det F'(W)$. Theory: docs/theory/invariant-measure.md.
"""

from typing import cast

import numpy as np

from nonholo._types import Array, Float
from nonholo.analysis._variety_points import points_of
from nonholo.discrete import Discretization
from nonholo.systems import ChaplyginSleigh, SuslovTop


def step_determinants(discrete: Discretization, W: Float[np.ndarray, "... N N"]) -> Float[Array, "..."]:
    """Return the determinant of one step from each displacement; infinite at a fold."""
    system = discrete.system
    with np.errstate(divide="ignore"):
        if isinstance(system, ChaplyginSleigh) or (isinstance(system, SuslovTop) and system.group.dim == 3):
            even, odd = area_factor(discrete, W)
            return (even - odd) / (even + odd)
        after, before = (np.linalg.det(momentum_slope(discrete, V)) for V in (system.group.inverse(W), W))
        return after / before


def step_jacobians(discrete: Discretization, W: Float[np.ndarray, "... N N"]) -> Float[np.ndarray, "... k k"]:
    """Return the derivatives of restricted momenta after a step by those before it, at each displacement."""
    after, before = (momentum_slope(discrete, V) for V in (discrete.system.group.inverse(W), W))
    return after @ np.linalg.inv(before)


def area_factor(
    discrete: Discretization, W: Float[np.ndarray, "... 3 3"]
) -> tuple[Float[Array, "..."], Float[Array, "..."]]:
    r"""Return the even and the odd part, under inversion, of the area factor of W -> hr for the closed forms.

    For a top, on the sphere of $(z_0, z)$ and up to a constant,

    $$ f = D z_0(z_0^2 - |z|^2) + 2z_0\,(c\cdot z^\perp)^2 \; - \; c\cdot Bz + 2(c\cdot z)(z\cdot Bz); $$

    for a sleigh, in the angle and half the translation $\nu$, over m,
    $f = \cos\tfrac\Delta2\,(J\cos\Delta + ma^2) + \tfrac12 am\nu$. Folds are where it vanishes.
    """
    body, points = cast("SuslovTop | ChaplyginSleigh", discrete.system.canonical), points_of(discrete, W)
    if isinstance(body, ChaplyginSleigh):
        angle, along = points[..., 0], points[..., 1]
        lever = float(body.mass * body.a)
        even = np.cos(angle / 2) * (float(body.inertia) * np.cos(angle) + lever * float(body.a))
        return even, lever * along / 2
    B, c = np.asarray(body.constrained_inertia), np.asarray(body.coupling)
    z0, z = points[..., 0], points[..., 1:]
    square, across = (z * z).sum(axis=-1), z[..., 0] * c[1] - z[..., 1] * c[0]
    even = z0 * (np.linalg.det(B) * (z0 * z0 - square) + 2 * across * across)
    return even, 2 * (z @ c) * np.einsum("...i,ij,...j->...", z, B, z) - z @ (B @ c)


def momentum_slope(discrete: Discretization, W: Float[np.ndarray, "... N N"]) -> Float[np.ndarray, "... k k"]:
    r"""Return the derivative of hF by the definition, in directions of Cayley coordinates.

    From $W = (I - Y)^{-1}(I + Y)$ follows $dW = \tfrac12(W + I)\,dY\,(W + I)$, and
    $h\langle P, x\rangle = \mathrm{tr}(\hat x W\mathbb{J}(W - I)^*)$.
    """
    system, star = discrete.system, discrete.system.group.form_adjoint
    rows, tensor = system.group.hat(system.constraint_subspace), np.asarray(system.homogeneous_mass_tensor)
    sum_, X = (W + system.group.identity)[..., None, :, :], W - system.group.identity
    dW = sum_ @ rows @ sum_ / 2
    arm = dW @ tensor @ star(X)[..., None, :, :]
    turned = (W @ tensor)[..., None, :, :] @ star(dW)
    return np.einsum("iab,...jba->...ij", rows, arm + turned)
