r"""The principal root by arc length on the sphere, through angle pi up to its fold; shares no code with the library.

Unknowns are $(z_0, z, w, s)$ with $z_0^2 + z\cdot z = 1$ for tops and sleighs on SO(n), SE(n), not diagonalized:

$$ z_0Bz + (z\cdot z)c - (c\cdot z)z + wz = s\,r, \qquad wz_0 = s\,a\,p + ma^2 \quad (w = 0 \text{ for a top}). $$

Steps of equal length along the curve in all unknowns, s among them: a fold is where s turns back.
"""

import numpy as np

_LONGEST = 0.02  # of the steps along the curve
_SHORTEST = 1e-9
_BEND = 0.995  # least cosine between the tangents of neighboring points
_NEWTON = 8
REACHED, FOLDED, LOST = 0, 1, 2


def _equations(B, c, r, lever, push, slides, x):  # noqa: ANN001, ANN202
    """Return the equations at (z0, z, w, s), sphere included, and their Jacobian."""
    k = len(c)
    z0, z, w, s = x[0], x[1 : k + 1], x[k + 1], x[k + 2]
    along, square, turned = c @ z, z @ z, B @ z
    F, J = np.zeros(k + 3), np.zeros((k + 3, k + 3))
    F[:k] = z0 * turned + square * c - along * z + w * z - s * r
    J[:k, 0] = turned
    J[:k, 1 : k + 1] = z0 * B + 2 * c[:, None] * z - z[:, None] * c + (w - along) * np.eye(k)
    J[:k, k + 1], J[:k, k + 2] = z, -r
    F[k], J[k, 0], J[k, 1 : k + 1] = z0 * z0 + square - 1, 2 * z0, 2 * z
    if slides:
        F[k + 1], J[k + 1, 0], J[k + 1, k + 1], J[k + 1, k + 2] = w * z0 - s * push - lever, w, z0, -push
    else:
        F[k + 1], J[k + 1, k + 1] = w, 1.0
    return F, J


def _corrected(B, c, r, lever, push, slides, x, across, at):  # noqa: ANN001, ANN202
    """Correct a point with its component along `across` held at a value."""
    for _ in range(_NEWTON):
        F, J = _equations(B, c, r, lever, push, slides, x)
        F[-1], J[-1] = across @ x - at, across
        step = np.linalg.solve(J, F)
        x = x - step
        if step @ step < 1e-26 * (x @ x):
            return True, x
    return False, x


def _tangent(B, c, r, lever, push, slides, x, before):  # noqa: ANN001, ANN202
    """Return the unit tangent of the curve that points the way of the one before."""
    _, J = _equations(B, c, r, lever, push, slides, x)
    J[-1] = before
    right = np.zeros(len(x))
    right[-1] = 1.0
    found = np.linalg.solve(J, right)
    return found / np.sqrt(found @ found)


def followed(B, c, r, lever, push, slides):  # noqa: ANN001, ANN201
    """Return how the path from momentum zero ended, (z0, z) there, its w and the least z0 on the way.

    `lever` is m a^2 and `push` a p; all momenta are multiplied by half the time step.
    """
    k = len(c)
    x, t = np.zeros(k + 3), np.zeros(k + 3)
    x[0], x[k + 1], t[k + 2] = 1.0, lever, 1.0
    t = _tangent(B, c, r, lever, push, slides, x, t)
    size, least, last = _LONGEST, 1.0, t * 0
    last[k + 2] = 1.0
    while size > _SHORTEST:
        guess = x + size * t
        good, found = _corrected(B, c, r, lever, push, slides, guess, t, t @ guess)
        if good and np.sum((found - guess) ** 2) < 0.01 * size * size:
            ahead = _tangent(B, c, r, lever, push, slides, found, t)
            if ahead @ t > _BEND:
                if found[k + 2] >= 1.0:
                    good, end = _corrected(B, c, r, lever, push, slides, found, last, 1.0)
                    return (REACHED if good else LOST), end[: k + 1], end[k + 1], least
                if ahead[k + 2] <= 0:
                    return FOLDED, found[: k + 1], found[k + 1], least
                x, t, size, least = found, ahead, min(_LONGEST, 2 * size), min(least, found[0])
                continue
        size /= 4
    return LOST, x[: k + 1], x[k + 1], least
