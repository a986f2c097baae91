r"""Exponential and Cayley map of algebras in which $X^3 = -\theta^2 X$: so(3) and se(2); unit quaternions.

There every analytic function of $X$ is $f_0 I + f_1 X + f_2 X^2$, free of cancellation for all angles. The matrices of
$\mathrm{ad}_x$ satisfy the same equation. Quaternions have Hamilton's product and are written scalar first.
"""

import abc
from typing import ClassVar

from nonholo.base.numerics import cotangent_deficit, identity_like, of_length_one, sinc, versine
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
        X, square = self.coordinates.matrix(x), self._squared_angle(x)
        return sinc(square)[..., None, None] * X + versine(square)[..., None, None] * (X @ X)

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


def matrix_from_quaternion(q: Float[Array, "... 4"]) -> Float[Array, "... 3 3"]:
    """Return the active rotation matrix of a quaternion, which is normalized first."""
    xp = q.__array_namespace__()
    unit = of_length_one(q, 4)
    w, x, y, z = (unit[..., i] for i in range(4))
    xx, yy, zz, xy, xz, yz, wx, wy, wz = x * x, y * y, z * z, x * y, x * z, y * z, w * x, w * y, w * z
    first = 1 - 2 * (yy + zz), 2 * (xy - wz), 2 * (xz + wy)
    second = 2 * (xy + wz), 1 - 2 * (xx + zz), 2 * (yz - wx)
    third = 2 * (xz - wy), 2 * (yz + wx), 1 - 2 * (xx + yy)
    return xp.stack([*first, *second, *third], axis=-1).reshape(*q.shape[:-1], 3, 3)


def quaternion_from_matrix(R: Float[Array, "... 3 3"]) -> Float[Array, "... 4"]:
    """Return the unit quaternion with non-negative scalar part; accurate for every angle.

    The symmetric matrix 4 q q^T is read off R; its row with the largest diagonal entry, normalized, is q.
    """
    xp = R.__array_namespace__()
    a, b, c, d, e, f, g, h, i = R.reshape(-1, 9).T.copy()
    more, less, wx, wy, wz, xy, xz, yz = 1 + a, 1 - a, h - f, c - g, d - b, b + d, c + g, f + h
    ww, xx, yy, zz = more + e + i, more - e - i, less + e - i, less - e + i
    products = xp.asarray([ww, wx, wy, wz, wx, xx, xy, xz, wy, xy, yy, yz, wz, xz, yz, zz])
    best = xp.argmax(products[::5], axis=0)
    q = of_length_one(products.reshape(4, 4, -1)[best, :, xp.arange(len(best))], 4)
    return xp.where(q[:, :1] < 0, -q, q).reshape(*R.shape[:-2], 4)


def quaternion_product(p: Float[Array, "... 4"], q: Float[Array, "... 4"]) -> Float[Array, "... 4"]:
    """Return Hamilton's product, divided by its length, its scalar non-negative: first the rotation q, then p."""
    xp = p.__array_namespace__()
    (a, b, c, d), (w, x, y, z) = (tuple(each[..., i] for i in range(4)) for each in (p, q))
    scalar = a * w - b * x - c * y - d * z
    vector = a * x + b * w + c * z - d * y, a * y - b * z + c * w + d * x, a * z + b * y - c * x + d * w
    product = of_length_one(xp.stack([scalar, *vector], axis=-1), 4)
    return xp.where(product[..., :1] < 0, -product, product)
