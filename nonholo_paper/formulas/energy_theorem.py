"""Why the energy is kept: the step as a mirror image in the metric of the energy."""

from nonholo_paper import _twin as twin
from nonholo_paper._twin import Matrix, Number, ctx


def skew_part(W: Matrix) -> Matrix:
    """Return (W - W^-1)/2."""
    return (W - W**-1) / 2


def mirrored(r: Matrix, line: Matrix, inertia: Matrix) -> Matrix:
    """Return the mirror image of a restricted momentum in a line, in the metric of the inverse inertia."""
    dual = inertia**-1 * line
    return 2 * twin.dot(r, dual) / twin.dot(line, dual) * line - r


def with_skew_part(X: Matrix) -> Matrix:
    """Return the W near the identity with (W - W^-1)/2 = X."""
    return X + ctx.sqrtm(X * X + ctx.eye(X.rows))


def lyapunov_step(c: Matrix, z: Matrix) -> Number:
    """Return the change of (c, r) of a top in a step whose half-angle vector is z."""
    return -4 * (twin.dot(z, z) * twin.dot(c, c) - twin.dot(c, z) ** 2)
