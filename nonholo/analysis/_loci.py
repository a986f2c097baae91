"""Loci of tops with n = 3 and sleighs in the plane: the surface of momenta, curves of one energy, half-planes.

Theory: docs/theory/momentum-locus.md, docs/theory/invariant-measure.md.
"""

import dataclasses
from typing import Any

import numpy as np

from nonholo.analysis.planar import HalfPlanes, momenta_at, planar_map
from nonholo.base.checks import count, error, number, positive, shape_of, trailing
from nonholo.base.limits import bounded_count, within_memory
from nonholo.base.types import Array, Float
from nonholo.discrete import Discretization


@dataclasses.dataclass(frozen=True, eq=False)
class MomentumLocus:
    r"""A mesh of the momentum locus and its singular points; momenta are physical, in the user's frame.

    Attributes:
        discrete: The discretized system.
        parameters: Of a top the step angle, 0 to pi, and the direction of $z$; of a sleigh the step angle, -pi to pi,
            and the translation along the chord; shape (R, C, 2).
        points: The same as coordinates of the variety: $(z_0, z_1, z_2)$, or the parameters again.
        momentum: Shape (R, C, 3).
        double_lines: The two ends, pinch points, of each segment along which the surface meets itself, (L, 2, 3).
        triple_point: Where three such segments meet; None if there is no such real point.
    """

    discrete: Discretization
    parameters: Float[np.ndarray, "R C 2"]
    points: Float[np.ndarray, "R C c"]
    momentum: Float[np.ndarray, "R C 3"]
    double_lines: Float[np.ndarray, "L 2 3"]
    triple_point: Float[np.ndarray, "3"] | None

    @property
    def displacement(self) -> Float[np.ndarray, "R C N N"]:
        """The displacements of the mesh."""
        return planar_map("MomentumLocus", self.discrete)[1].displacement(self.points)

    @property
    def pinch_points(self) -> Float[np.ndarray, "Q 3"]:
        """The ends of the segments along which the surface meets itself."""
        return self.double_lines.reshape(-1, 3)

    def implicit(self, momentum: Array) -> Float[np.ndarray, "..."]:
        """Return the polynomial of the surface at momenta of shape (..., 3); it is dimensionless.

        Besides the locus it vanishes on the `whiskers`.
        """
        where = "MomentumLocus.implicit(momentum=...)"
        p = trailing(where, momentum, (3,), "Pass full body momenta.", real=True)
        variety = planar_map("MomentumLocus", self.discrete)[1]
        return variety.surface(float(self.discrete.time_step)).implicit(p)

    def whiskers(self, length: float = 1.0) -> Float[np.ndarray, "V 2 3"]:
        """Return pieces of the double lines that are not on the locus, as long as `length` times the segment.

        There the polynomial vanishes, but the two displacements are complex.
        """
        length = float(number("MomentumLocus.whiskers(length=...)", length))
        first, last = self.double_lines[:, 0], self.double_lines[:, 1]
        outwards = length * (last - first)
        before, after = np.stack([first, first - outwards], axis=1), np.stack([last, last + outwards], axis=1)
        return np.concatenate([before, after])


def momentum_locus(discrete: Discretization, resolution: int = 80) -> MomentumLocus:
    r"""Return the surface $\{P(W) : W \in \exp\mathfrak{d}\}$ of the discrete momenta of a top (n = 3) or a sleigh.

    For a top it is a Steiner surface of degree four, the image of the projective plane; for the sleigh Pluecker's
    conoid, of degree three, the image of a Moebius band, of which the mesh shows a part about its double segment. A
    step changes the momentum by $\mathrm{Ad}^*_W$ and then moves it, along the annihilator of $\mathfrak{d}$, back to
    this surface: several values are several sheets over one point.

    Reference: [fedorov-zenkov-2004], equations (Steiner) and (full); docs/theory/momentum-locus.md.

    Args:
        discrete: A top with n = 3 or a sleigh, discretized with "matrix" and "skew".
        resolution: Rows of the mesh; it has twice as many columns, and one more.

    Raises:
        ValueError: Another system, another discretization, a resolution below 2.

    Example:
        >>> top = nh.discretize(nh.SuslovTop(np.diag([1.0, 2.0, 3.0])), 0.1)
        >>> locus = momentum_locus(top)
        >>> locus.double_lines.shape, locus.triple_point.round(12) + 0.0
        ((3, 2, 3), array([0., 0., 0.]))
        >>> bool(abs(locus.implicit(locus.momentum)).max() < 1e-13)
        True
    """
    discrete, variety = planar_map("momentum_locus(discrete=...)", discrete)
    rows = count("momentum_locus(resolution=...)", resolution, "Pass 2 or more.")
    within_memory("momentum_locus(resolution=...)", 1000.0 * rows**2, "Pass a lower resolution.")
    if rows < 2:
        raise error("momentum_locus(resolution=...)", "be at least 2", str(rows), "A mesh needs two rows.")
    parameters, points = variety.mesh(rows)
    surface, momentum = variety.surface(float(discrete.time_step)), momenta_at(discrete, variety, points)
    return MomentumLocus(discrete, parameters, points, momentum, surface.double_lines(), surface.triple_point())


@dataclasses.dataclass(frozen=True, eq=False)
class InvariantCurve:
    r"""The displacements with one reduced constrained energy.

    Attributes:
        discrete: The discretized system.
        energy: The energy, in physical units.
        components: Connected curves, each of shape (K, c), as points of the variety in the canonical frame: unit
            vectors $(z_0, z_1, z_2)$ of a top, which mean the same with the other sign, or $(\Delta, \nu)$ of a
            sleigh, where $(\Delta + 2\pi, -\nu)$ means the same. They are continuous. No component: no displacement
            has so large an energy.
    """

    discrete: Discretization
    energy: float
    components: tuple[Float[np.ndarray, "K c"], ...]

    @property
    def displacement(self) -> tuple[Float[np.ndarray, "K N N"], ...]:
        """The displacements, for each component."""
        variety = planar_map("InvariantCurve", self.discrete)[1]
        return tuple(variety.displacement(points) for points in self.components)

    @property
    def momentum(self) -> tuple[Float[np.ndarray, "K 3"], ...]:
        """The body momenta, a curve on the momentum locus for each component."""
        discrete, variety = planar_map("InvariantCurve", self.discrete)
        return tuple(momenta_at(discrete, variety, points) for points in self.components)

    def over(self, direction: float) -> Float[np.ndarray, "m c"]:
        """Return the points, two at most, with a direction of z (tops, z_0 >= 0) or with a step angle (sleighs)."""
        angle = float(number("InvariantCurve.over(direction=...)", direction))
        variety = planar_map("InvariantCurve", self.discrete)[1]
        return variety.level(self.energy * float(self.discrete.time_step) ** 2).over(angle)


def invariant_curve(discrete: Discretization, energy: Array, resolution: int = 400) -> InvariantCurve:
    r"""Return the curve of displacements with a reduced constrained energy, all its components.

    The map has several values, and each of them keeps the energy: from a point of the curve it leads to other points
    of the curve. For a top, with $z = \sqrt\rho\,u$, $|u| = 1$, and the notation of the theory page,

    $$ \tfrac{h^2}2 E = (u\cdot Bu)\,\bigl(\rho - (1 - (c\cdot u^\perp)^2/D)\rho^2\bigr); $$

    for a sleigh, with $x = \sin^2(\Delta/2)$, the angles that occur satisfy $4x(I - Jx) \le 2Eh^2$, and over each
    there are two translations. A component about the identity exists for every energy below the largest.

    Reference: [fedorov-zenkov-2004], equations (sus_int) and (quatern_int); docs/theory/momentum-locus.md.

    Args:
        discrete: A top with n = 3 or a sleigh, discretized with "matrix" and "skew".
        energy: The energy, positive.
        resolution: Points for each arc.

    Raises:
        ValueError: Another system, another discretization, an energy that is not positive.

    Example:
        >>> top = nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 0.5)
        >>> curve = invariant_curve(top, 0.5)
        >>> len(curve.components)  # about the identity, and about a half-turn
        2
        >>> bool(np.ptp(top.system.constrained_energy(top.system.restrict(curve.momentum[1]))) < 1e-14)
        True
    """
    discrete, variety = planar_map("invariant_curve(discrete=...)", discrete)
    level = float(positive("invariant_curve(energy=...)", energy, "An orbit has one: `orbit.energy[0]`."))
    rows = bounded_count("invariant_curve(resolution=...)", resolution, 1000.0, "Pass the points of an arc.")
    curves = variety.level(level * float(discrete.time_step) ** 2).components(rows)
    return InvariantCurve(discrete, level, curves)


def half_planes(discrete: Discretization, *, displacement: Any = None, momentum: Any = None) -> HalfPlanes:
    r"""Return the half-planes in which displacements or momenta lie.

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
    discrete, variety = planar_map("half_planes(discrete=...)", discrete)
    if (displacement is None) == (momentum is None):
        got = "none" if momentum is None else "both"
        raise error("half_planes(...)", "be given displacement or momentum", got, "Choose one.")
    system = discrete.system
    if displacement is not None:
        shape = system.group.identity.shape
        W = trailing("half_planes(displacement=...)", displacement, shape, "Pass `orbit.displacement`.", real=True)
        return variety.sides(variety.points(W))[0]
    k, dim = system.constraint_subspace.shape
    size = k if shape_of(momentum)[-1:] == (k,) else dim
    p = trailing("half_planes(momentum=...)", momentum, (size,), f"Pass {dim} body momenta or {k} along d.", real=True)
    r = p if size == k else system.restrict(p)
    return variety.sides_of_momenta(float(discrete.time_step) * r)
