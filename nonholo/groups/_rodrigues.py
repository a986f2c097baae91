r"""Exponential and Cayley map of algebras in which $X^3 = -\theta^2 X$: so(3) and se(2).

There every analytic function of $X$ is $f_0 I + f_1 X + f_2 X^2$, free of cancellation for all angles.
"""

from nonholo._types import Array, Float
from nonholo.numerics import sinc, versine


def exponential(X: Float[Array, "... N N"], squared: Float[Array, "..."]) -> Float[Array, "... N N"]:
    r"""Return $I + \frac{\sin\theta}{\theta}X + \frac{1-\cos\theta}{\theta^2}X^2$ for $\theta^2$ = `squared`."""
    return _identity(X) + sinc(squared)[..., None, None] * X + versine(squared)[..., None, None] * (X @ X)


def cayley(X: Float[Array, "... N N"], squared: Float[Array, "..."]) -> Float[Array, "... N N"]:
    r"""Return $(I - X/2)^{-1}(I + X/2)$."""
    return _identity(X) + cayley_increment(X, squared)


def cayley_increment(X: Float[Array, "... N N"], squared: Float[Array, "..."]) -> Float[Array, "... N N"]:
    r"""Return $(I - X/2)^{-1}(I + X/2) - I = (X + X^2/2)/(1 + \theta^2/4)$ without the subtraction."""
    return (X + X @ X / 2) / (1 + squared / 4)[..., None, None]


def _identity(X: Array) -> Array:
    xp = X.__array_namespace__()
    return xp.eye(X.shape[-1], dtype=X.dtype)
