"""Even functions of an angle, written as functions of its square so that they are smooth at zero.

They take NumPy arrays or JAX tracers; near zero a Taylor polynomial replaces the quotient, and the untaken branch
gets a harmless argument so that derivatives stay finite.
"""

import math

from nonholo.base.types import Array, Float

_SMALL = 1e-3  # squared angle below which the truncated series are exact to rounding


def sinc(squared: Float[Array, "..."]) -> Float[Array, "..."]:
    r"""Return $\sin\theta/\theta$ for $\theta^2$ = `squared`.

    Example:
        >>> import numpy as np
        >>> float(sinc(np.float64(0.0))), round(float(sinc(np.float64(np.pi**2))), 12)
        (1.0, 0.0)
    """
    return _switch(squared, lambda xp, angle: xp.sin(angle) / angle, (-1 / 6, 1 / 120, -1 / 5040))


def versine(squared: Float[Array, "..."]) -> Float[Array, "..."]:
    r"""Return $(1 - \cos\theta)/\theta^2$ for $\theta^2$ = `squared`, as half a squared sinc of the half angle."""
    half = sinc(squared / 4)
    return half * half / 2


def half_cotangent(squared: Float[Array, "..."]) -> Float[Array, "..."]:
    r"""Return $(\theta/2)\cot(\theta/2)$ for $\theta^2$ = `squared` (zero at $\theta = \pi$)."""

    def quotient(xp: Array, angle: Array) -> Array:
        return angle / 2 * xp.cos(angle / 2) / xp.sin(angle / 2)

    return _switch(squared, quotient, (-1 / 12, -1 / 720, -1 / 30240))


def _switch(squared: Array, quotient: Array, series: tuple[float, float, float]) -> Array:
    xp = squared.__array_namespace__()
    small = squared < _SMALL
    angle = xp.sqrt(xp.where(small, math.pi**2 / 4, squared))
    first, second, third = series
    return xp.where(small, 1 + squared * (first + squared * (second + squared * third)), quotient(xp, angle))
