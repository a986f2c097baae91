"""Unit quaternions, scalar first, Hamilton's product: the compact pose of a rotation of space."""

from nonholo.base.numerics import of_length_one
from nonholo.base.types import Array, Float


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
