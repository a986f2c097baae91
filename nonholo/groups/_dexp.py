"""The inverse of the derivative of the exponential from its definition, for any Lie algebra."""

from nonholo.base.numerics import integrated_exponential, inverted
from nonholo.base.types import Array, Float


def dexp_inverse(ad: Float[Array, "... dim dim"]) -> Float[Array, "... dim dim"]:
    r"""Return $\varphi_1(\mathrm{ad})^{-1}$, which is $\sum_k B_k\,\mathrm{ad}^k/k!$ where that converges."""
    return inverted(integrated_exponential(ad))
