r"""On which side of the line of equilibria a motion runs, and which half of the line attracts.

Tops with n = 3 and sleighs in the plane. Theory: docs/theory/invariant-measure.md.
"""

from typing import Any

from nonholo.analysis.planar import HalfPlanes, planar_map
from nonholo.base.checks import error, shape_of, trailing
from nonholo.discrete import Discretization


def half_planes(discrete: Discretization, *, displacement: Any = None, momentum: Any = None) -> HalfPlanes:
    r"""Tell in which half-planes displacements or momenta lie.

    Of displacements of a top, $\pm(z_0, z)$ with $z_0 \ge 0$, and of a sleigh, with a step angle $\Delta$ up to
    $\pi$ and the translation $\nu$ along the chord,

    $$ (s, Q) = (c\cdot z^\perp,\ -c\cdot Bz), \qquad (s, Q) = (\sin\tfrac\Delta2,\ am\nu); $$

    of momenta $\bigl((Bc)\cdot r^\perp, -c\cdot r\bigr)$ and $(\pi, a p_1)$. Of one displacement and its momentum
    the sides agree where $Dz_0 + Q > 0$ (tops) or $2I\cos\tfrac\Delta2 + Q > 0$ (sleighs). An orbit of a top in the
    regular regime below the saddle, or of a sleigh in its single-valued region, stays on one side forever. It comes
    from equilibria in $\Theta_-$ and tends to those in $\Theta_+$. Values are in the units of h = 1.

    Reference: [fedorov-zenkov-2004], theorem (discr_sus_dyn), which puts both ends in $\Theta_-$.

    Args:
        discrete: A top with n = 3 or a sleigh, discretized with "matrix" and "skew".
        displacement: Displacements on the variety, leading axes free.
        momentum: Body momenta or their components along the constraint subspace, leading axes free.

    Raises:
        ValueError: Another system or discretization; none or both of displacement and momentum; a wrong shape.

    Example:
        >>> top = nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 0.2)
        >>> orbit = nh.simulate(top, restricted_velocity=(0.6, 0.7), steps=100)
        >>> side, forward = half_planes(top, displacement=orbit.displacement)
        >>> bool(np.all(side < 0)), bool(forward[0] < 0 < forward[-1])
        (True, True)
    """
    checked, variety = planar_map("half_planes(discrete=...)", discrete)
    if (displacement is None) == (momentum is None):
        got = "none" if momentum is None else "both"
        raise error("half_planes(...)", "be given displacement or momentum", got, "Choose one.")
    system = checked.system
    if displacement is not None:
        shape = system.group.identity.shape
        W = trailing("half_planes(displacement=...)", displacement, shape, "Pass `orbit.displacement`.", real=True)
        return variety.sides(variety.points(W))[0]
    k, dim = system.constraint_subspace.shape
    size = k if shape_of(momentum)[-1:] == (k,) else dim
    p = trailing("half_planes(momentum=...)", momentum, (size,), f"Pass {dim} body momenta or {k} along d.", real=True)
    r = p if size == k else system.restrict(p)
    return variety.sides_of_momenta(float(checked.time_step) * r)
