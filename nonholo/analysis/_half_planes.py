r"""On which side of the line of equilibria a motion runs, and which half of the line attracts.

Tops with n = 3 and sleighs in the plane. Theory: docs/theory/invariant-measure.md.
"""

from typing import Any, NamedTuple, cast

import numpy as np

from nonholo._checks import error, shape_of, trailing
from nonholo._types import Array, Float
from nonholo.analysis._variety_points import closed_form, points_of
from nonholo.discrete import Discretization
from nonholo.systems import AbstractSystem, ChaplyginSleigh, SuslovTop


class HalfPlanes(NamedTuple):
    r"""Numbers whose signs tell half-planes; they are zero for every motion of a balanced body.

    Attributes:
        side: Positive in $\Delta_+$, negative in $\Delta_-$, zero on the line of equilibria.
        forward: Positive in $\Theta_+$, which contains the attracting equilibria, negative in $\Theta_-$.
    """

    side: Float[Array, "..."]
    forward: Float[Array, "..."]


def half_planes(discrete: Discretization, *, displacement: Any = None, momentum: Any = None) -> HalfPlanes:
    r"""Tell in which half-planes displacements or momenta lie.

    Of displacements of a top, $\pm(z_0, z)$ with $z_0 \ge 0$, and of a sleigh, with a step angle $\Delta$ up to
    $\pi$ and the translation $\nu$ along the chord,

    $$ (s, Q) = (c\cdot z^\perp,\ -c\cdot Bz), \qquad (s, Q) = (\sin\tfrac\Delta2,\ am\nu); $$

    of momenta $\bigl((Bc)\cdot r^\perp, -c\cdot r\bigr)$ and $(\pi, a p_1)$. Of one displacement and its momentum
    the sides agree where $Dz_0 + Q > 0$ (tops) or $2I\cos\tfrac\Delta2 + Q > 0$ (sleighs). An orbit of a top in the
    regular regime below the saddle, or of a sleigh in its single-valued region, stays on one side for ever. It comes
    from equilibria in $\Theta_-$ and tends to those in $\Theta_+$. Values are in the units of h = 1.

    Reference: [fedorov-zenkov-2004], theorem (discr_sus_dyn), which puts both ends in $\Theta_-$.

    Args:
        discrete: A top with n = 3 or a sleigh, discretised with "matrix" and "skew".
        displacement: Displacements on the variety, leading axes free.
        momentum: Body momenta or their components along the constraint subspace, leading axes free.

    Raises:
        ValueError: Another system or discretisation; none or both of displacement and momentum; a wrong shape.

    Example:
        >>> top = nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 0.2)
        >>> orbit = nh.simulate(top, restricted_velocity=(0.6, 0.7), steps=100)
        >>> side, forward = half_planes(top, displacement=orbit.displacement)
        >>> bool(np.all(side < 0)), bool(forward[0] < 0 < forward[-1])
        (True, True)
    """
    checked = closed_form("half_planes(discrete=...)", discrete)
    if (displacement is None) == (momentum is None):
        got = "none" if momentum is None else "both"
        raise error("half_planes(...)", "be given displacement or momentum", got, "Choose one.")
    system = checked.system
    if displacement is not None:
        shape = system.group.identity.shape
        W = trailing("half_planes(displacement=...)", displacement, shape, "Pass `orbit.displacement`.", real=True)
        return sides_of_displacements(checked, W)[0]
    k, dim = system.constraint_subspace.shape
    size = k if shape_of(momentum)[-1:] == (k,) else dim
    p = trailing("half_planes(momentum=...)", momentum, (size,), f"Pass {dim} body momenta or {k} along d.", real=True)
    r = p if size == k else system.restrict(p)
    return sides_of_momenta(system, float(checked.time_step) * r)


def sides_of_displacements(
    discrete: Discretization, W: Float[np.ndarray, "... 3 3"]
) -> tuple[HalfPlanes, Float[Array, "..."]]:
    r"""Return the half-planes of displacements, and the weight $\Lambda$: $Dz_0$ or $2I\cos\tfrac\Delta2$.

    The side of the momentum is $s\,(\Lambda + Q)$ before the step and $s\,(\Lambda - Q)$ after it, times 2 for a top.
    """
    body, points = _body(discrete.system), points_of(discrete, W)
    if isinstance(body, ChaplyginSleigh):
        angle, along = points[..., 0], points[..., 1]
        lever = float(body.a * body.mass)
        whole = float(body.inertia) + lever * float(body.a)
        return HalfPlanes(np.sin(angle / 2), lever * along), 2 * whole * np.cos(angle / 2)
    points = np.where(points[..., :1] < 0, -points, points)
    z0, z = points[..., 0], points[..., 1:]
    B, c = np.asarray(body.constrained_inertia), np.asarray(body.coupling)
    return HalfPlanes(_quarter_turned(z) @ c, -z @ (B @ c)), np.linalg.det(B) * z0


def sides_of_momenta(system: AbstractSystem, r: Float[np.ndarray, "... 2"]) -> HalfPlanes:
    """Return the half-planes of momenta along the constraint subspace of a top or a sleigh."""
    body, canonical = _body(system), system.to_canonical(r)
    if isinstance(body, ChaplyginSleigh):
        return HalfPlanes(canonical[..., 0], float(body.a) * canonical[..., 1])
    B, c = np.asarray(body.constrained_inertia), np.asarray(body.coupling)
    return HalfPlanes(_quarter_turned(canonical) @ (B @ c), -canonical @ c)


def _body(system: AbstractSystem) -> SuslovTop | ChaplyginSleigh:
    return cast("SuslovTop | ChaplyginSleigh", system.canonical)


def _quarter_turned(z: Float[np.ndarray, "... 2"]) -> Float[np.ndarray, "... 2"]:
    return np.stack([-z[..., 1], z[..., 0]], axis=-1)
