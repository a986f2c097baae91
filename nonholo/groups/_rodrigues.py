r"""Exponential and Cayley map of algebras in which $X^3 = -\theta^2 X$: so(3) and se(2).

There every analytic function of $X$ is $f_0 I + f_1 X + f_2 X^2$, free of cancellation for all angles. The matrices of
$\mathrm{ad}_x$ satisfy the same equation.
"""

from nonholo.base.numerics import cotangent_deficit, identity_like, sinc, versine
from nonholo.base.types import Array, Float


def exp_increment(X: Float[Array, "... N N"], squared: Float[Array, "..."]) -> Float[Array, "... N N"]:
    r"""Return $\frac{\sin\theta}{\theta}X + \frac{1-\cos\theta}{\theta^2}X^2$ for $\theta^2$ = `squared`."""
    return sinc(squared)[..., None, None] * X + versine(squared)[..., None, None] * (X @ X)


def cayley_increment(X: Float[Array, "... N N"], squared: Float[Array, "..."]) -> Float[Array, "... N N"]:
    r"""Return $(I - X/2)^{-1}(I + X/2) - I = (X + X^2/2)/(1 + \theta^2/4)$ without the subtraction."""
    return (X + X @ X / 2) / (1 + squared / 4)[..., None, None]


def dexp_inverse(ad: Float[Array, "... dim dim"], squared: Float[Array, "..."]) -> Float[Array, "... dim dim"]:
    r"""Return $I - \mathrm{ad}/2 + \theta^{-2}\bigl(1 - \frac\theta2\cot\frac\theta2\bigr)\mathrm{ad}^2$."""
    return identity_like(ad) - ad / 2 + cotangent_deficit(squared)[..., None, None] * (ad @ ad)
