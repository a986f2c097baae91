"""The even function in the inverse of the derivative of an exponential; for NumPy arrays and JAX tracers."""

from nonholo.base.numerics._even import half_cotangent
from nonholo.base.types import Array, Float

# |B_2k| / (2k)!, k = 1 .. 10: exact to rounding for angles up to 1
_SERIES = (
    1 / 12,
    1 / 720,
    1 / 30240,
    1 / 1209600,
    1 / 47900160,
    691 / 1307674368000,
    1 / 74724249600,
    3617 / 10670622842880000,
    43867 / 5109094217170944000,
    174611 / 802857662698291200000,
)


def cotangent_deficit(squared: Float[Array, "..."]) -> Float[Array, "..."]:
    r"""Return $(1 - (\theta/2)\cot(\theta/2))/\theta^2$ for $\theta^2$ = `squared`, smooth at zero.

    Example:
        >>> import numpy as np
        >>> float(12 * cotangent_deficit(np.float64(0.0)))
        1.0
    """
    xp = squared.__array_namespace__()
    small = squared < 1
    inside, outside = xp.where(small, squared, 0.0), xp.where(small, 4.0, squared)
    series = 0.0 * inside
    for coefficient in reversed(_SERIES):
        series = coefficient + inside * series
    return xp.where(small, series, (1 - half_cotangent(outside)) / outside)
