"""Unit quaternions, scalar first, Hamilton's product: the compact pose of a rotation of space."""

from nonholo.base.types import Array, Float


def normalized(q: Float[Array, "... 4"]) -> Float[Array, "... 4"]:
    """Return a quaternion divided by its length."""
    xp = q.__array_namespace__()
    return q / xp.sqrt(xp.sum(q * q, axis=-1, keepdims=True))


def matrix_from_quaternion(q: Float[Array, "... 4"]) -> Float[Array, "... 3 3"]:
    """Return the active rotation matrix of a quaternion, which is normalized first."""
    xp = q.__array_namespace__()
    unit = normalized(q)
    w, x, y, z = (unit[..., i] for i in range(4))
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )
    return xp.stack([xp.stack(row, axis=-1) for row in rows], axis=-2)


def quaternion_from_matrix(R: Float[Array, "... 3 3"]) -> Float[Array, "... 4"]:
    """Return the unit quaternion with non-negative scalar part; accurate for every angle.

    The symmetric matrix 4 q q^T is read off R; its row with the largest diagonal entry, normalized, is q.
    """
    xp = R.__array_namespace__()
    products = _four_times_outer(R)
    diagonal = xp.stack([products[..., i, i] for i in range(4)], axis=-1)
    best = xp.argmax(diagonal, axis=-1)[..., None, None]
    q = normalized(xp.take_along_axis(products, xp.broadcast_to(best, (*best.shape[:-1], 4)), axis=-2)[..., 0, :])
    return xp.where(q[..., :1] < 0, -q, q)


def _four_times_outer(R: Array) -> Array:
    xp = R.__array_namespace__()
    (a, b, c), (d, e, f), (g, h, i) = (tuple(R[..., j, k] for k in range(3)) for j in range(3))
    rows = (
        (1 + a + e + i, h - f, c - g, d - b),
        (h - f, 1 + a - e - i, b + d, c + g),
        (c - g, b + d, 1 - a + e - i, f + h),
        (d - b, c + g, f + h, 1 - a - e + i),
    )
    return xp.stack([xp.stack(row, axis=-1) for row in rows], axis=-2)
