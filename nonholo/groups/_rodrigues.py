r"""Exponential and Cayley map of algebras in which $X^3 = -\theta^2 X$: so(3) and se(2).

There every analytic function of $X$ is $f_0 I + f_1 X + f_2 X^2$, free of cancellation for all angles. The matrices of
$\mathrm{ad}_x$ satisfy the same equation.
"""

import abc
from typing import ClassVar

from nonholo.base.numerics import cotangent_deficit, identity_like, sinc, versine
from nonholo.base.types import Array, Float
from nonholo.groups._base import AbstractMatrixGroup


class AbstractRodriguesGroup(AbstractMatrixGroup):
    """A group of rigid motions with such an algebra, of dimension three."""

    dim: ClassVar[int] = 3
    size: ClassVar[int] = 3
    pose_size: ClassVar[int] = 4
    is_rigid: ClassVar[bool] = True

    @abc.abstractmethod
    def _squared_angle(self, x: Float[Array, "... 3"]) -> Float[Array, "..."]:
        r"""Return $\theta^2$."""

    def exp_increment(self, x: Float[Array, "... 3"]) -> Float[Array, "... 3 3"]:
        r"""Return $\frac{\sin\theta}{\theta}X + \frac{1-\cos\theta}{\theta^2}X^2$, `exp(x)` minus the identity."""
        x = self._vector(x)
        X, squared = self.coordinates.matrix(x), self._squared_angle(x)
        return sinc(squared)[..., None, None] * X + versine(squared)[..., None, None] * (X @ X)

    def cayley_increment(self, x: Float[Array, "... 3"]) -> Float[Array, "... 3 3"]:
        r"""Return $(I - X/2)^{-1}(I + X/2) - I = (X + X^2/2)/(1 + \theta^2/4)$ without the subtraction."""
        x = self._vector(x)
        X = self.coordinates.matrix(x)
        return (X + X @ X / 2) / (1 + self._squared_angle(x) / 4)[..., None, None]

    def dexp_inverse(self, x: Float[Array, "... 3"]) -> Float[Array, "... 3 3"]:
        r"""Return $I - \mathrm{ad}/2 + \theta^{-2}\bigl(1 - \frac\theta2\cot\frac\theta2\bigr)\mathrm{ad}^2$."""
        x = self._vector(x)
        ad = self.ad(x)
        return identity_like(ad) - ad / 2 + cotangent_deficit(self._squared_angle(x))[..., None, None] * (ad @ ad)
