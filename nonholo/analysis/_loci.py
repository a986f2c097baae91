"""Loci of tops with n = 3 and sleighs in the plane: the surface of momenta, curves of one energy, half-planes.

Theory: docs/theory/momentum-locus.md, docs/theory/invariant-measure.md.
"""

from typing import Any, cast

import numpy as np

from nonholo.analysis import planar
from nonholo.analysis.planar import HalfPlanes, Strip
from nonholo.base import checks
from nonholo.base.checks import array, bounded_count, count, error, number, positive, shape_of, shown, trailing
from nonholo.base.results import result
from nonholo.base.types import Array, Float
from nonholo.discrete import Discretization, as_discretization


@result
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
        return planar.planar_map("MomentumLocus", self.discrete)[1].displacement(self.points)

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
        variety = planar.planar_map("MomentumLocus", self.discrete)[1]
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
    discrete, variety = planar.planar_map("momentum_locus(discrete=...)", discrete)
    rows = count("momentum_locus(resolution=...)", resolution, "Pass 2 or more.")
    checks.within_memory("momentum_locus(resolution=...)", 1000.0 * rows**2, "Pass a lower resolution.")
    if rows < 2:
        raise error("momentum_locus(resolution=...)", "be at least 2", str(rows), "A mesh needs two rows.")
    parameters, points = variety.mesh(rows)
    surface, momentum = variety.surface(float(discrete.time_step)), planar.momenta_at(discrete, variety, points)
    return MomentumLocus(discrete, parameters, points, momentum, surface.double_lines(), surface.triple_point())


@result
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
        variety = planar.planar_map("InvariantCurve", self.discrete)[1]
        return tuple(variety.displacement(points) for points in self.components)

    @property
    def momentum(self) -> tuple[Float[np.ndarray, "K 3"], ...]:
        """The body momenta, a curve on the momentum locus for each component."""
        discrete, variety = planar.planar_map("InvariantCurve", self.discrete)
        return tuple(planar.momenta_at(discrete, variety, points) for points in self.components)

    def over(self, direction: float) -> Float[np.ndarray, "m c"]:
        """Return the points, two at most, with a direction of z (tops, z_0 >= 0) or with a step angle (sleighs)."""
        angle = float(number("InvariantCurve.over(direction=...)", direction))
        variety = planar.planar_map("InvariantCurve", self.discrete)[1]
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
    discrete, variety = planar.planar_map("invariant_curve(discrete=...)", discrete)
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
    discrete, variety = planar.planar_map("half_planes(discrete=...)", discrete)
    if (displacement is None) == (momentum is None):
        got = "none" if momentum is None else "both"
        raise error("half_planes(...)", "be given displacement or momentum", got, "Choose one.")
    system = discrete.system
    if displacement is not None:
        shape = system.group.identity.shape
        W = trailing("half_planes(displacement=...)", displacement, shape, "Pass `orbit.displacement`.", real=True)
        return variety.sides(variety.points(W))[0]
    r = planar.restricted_momenta("half_planes(momentum=...)", system, momentum)
    return variety.sides_of_momenta(float(discrete.time_step) * r)


@result
class Deltoid:
    r"""The discriminant curve of the discrete sleigh; momenta are restricted ones, $(p_\theta, p_1)$, physical.

    Attributes:
        discrete: The discretized sleigh.
        cusps: The lower one and the two upper ones (for a > 0), where all three branches meet; shape (3, 2).
    """

    discrete: Discretization
    cusps: Float[np.ndarray, "3 2"]

    def boundary(self, points: int = 361) -> Float[np.ndarray, "K 2"]:
        r"""Return the closed curve where two branches meet, $\varkappa = 2e^{i\alpha} + e^{-2i\alpha}$.

        Raises:
            ValueError: A number of points that is not positive.
        """
        rows = bounded_count("Deltoid.boundary(points=...)", points, 100.0, "Pass the number of points.")
        return self.touching(np.linspace(0.0, 2 * np.pi, rows))

    def touching(self, angle: Array) -> Float[np.ndarray, "... 2"]:
        r"""Return where the momenta of all displacements with a step angle, a line, touch the boundary.

        The line over the angle $\alpha$ is the tangent at $\varkappa = 2e^{i\alpha} + e^{-2i\alpha}$: the values over a
        momentum are the tangents through it.
        """
        where, remedy = "Deltoid.touching(angle=...)", "Pass step angles."
        turn = np.exp(1j * array(where, angle, (None,) * len(shape_of(angle)), remedy))
        return _restricted(self.discrete, 2 * turn + turn**-2)

    def discriminant(self, restricted_momentum: Array) -> Float[np.ndarray, "..."]:
        r"""Return $27 - 18|\varkappa|^2 + 8\,\mathrm{Re}\,\varkappa^3 - |\varkappa|^4$, positive inside."""
        strip, momentum = _strip(self.discrete), self._plane("discriminant", restricted_momentum)
        pi, p1 = np.moveaxis(strip.canonical_momenta(momentum) * float(self.discrete.time_step), -1, 0)
        phat = strip.arm * p1 + 2 * strip.mass * strip.arm**2
        trace = (-(2 * phat + strip.inertia) + 2j * pi) / strip.inertia
        square = np.abs(trace) ** 2
        return 27 - 18 * square + 8 * np.real(trace**3) - square**2

    def real_branches(self, restricted_momentum: Array) -> np.ndarray:
        """Return the number of displacements over restricted momenta, with multiplicity: 3 inside, 1 outside."""
        where = self._plane("real_branches", restricted_momentum)
        return np.where(self.discriminant(where) >= 0, 3, 1)

    def resting(self, points: int = 361) -> Float[np.ndarray, "K 2"]:
        r"""Return the ellipse $\pi = I\sin\Delta$, $p_1 = -am(1 - \cos\Delta)$: turns without translation.

        For b = 0 these are the displacements with $V_1 = 0$ but for those of angle pi.
        """
        strip = _strip(self.discrete)
        rows = bounded_count("Deltoid.resting(points=...)", points, 100.0, "Pass the number of points.")
        m, a, angle = strip.mass, strip.arm, np.linspace(0.0, 2 * np.pi, rows)
        canonical = np.stack([(strip.inertia + m * a * a) * np.sin(angle), -a * m * (1 - np.cos(angle))], axis=-1)
        return strip.restricted_momenta(canonical) / float(self.discrete.time_step)

    def _plane(self, method: str, value: Array) -> Float[np.ndarray, "... 2"]:
        leading = (None,) * (len(shape_of(value)) - 1)
        where = f"Deltoid.{method}(restricted_momentum=...)"
        return array(where, value, (*leading, 2), "Pass the two components (p_theta, p_1).")


def deltoid(discrete: Discretization) -> Deltoid:
    r"""Return the deltoid of a sleigh: inside it the map has three real values, outside it one.

    The three step angles over a momentum are the angles of the roots U of

    $$ U^3 - \varkappa U^2 + \bar\varkappa U - 1 = 0, \qquad
       J\varkappa = -(2\hat p + J) + 2i\,h\pi, \qquad \hat p = a\,hp_1 + 2ma^2, $$

    the characteristic polynomial of a matrix of SU(3) with trace $\varkappa$ if all three are real.

    Reference: [fedorov-zenkov-2004], section 6, figure of the discriminant curve; docs/theory/chaplygin-sleigh.md.

    Args:
        discrete: A discretized sleigh with a not zero.

    Raises:
        ValueError: Another system or discretization, or a = 0 (then two values are real if h |pi| < J, none beyond).

    Example:
        >>> curve = deltoid(nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=1.0), 1.0))
        >>> curve.cusps
        array([[ 0.        , -4.        ],
               [ 1.29903811, -1.75      ],
               [-1.29903811, -1.75      ]])
        >>> curve.real_branches([[0.0, -2.5], [0.0, 0.0]]).tolist()
        [3, 1]
    """
    _checked_strip("deltoid(discrete=...)", discrete)
    return Deltoid(discrete, _restricted(discrete, 3 * np.exp(2j * np.pi * np.array([0.0, 1.0, -1.0]) / 3)))


def _strip(discrete: Discretization) -> Strip:
    return cast(Strip, planar.planar_map("Deltoid", discrete)[1])


def _restricted(discrete: Discretization, trace: np.ndarray) -> Float[np.ndarray, "... 2"]:
    """Return the restricted momenta of kappa."""
    half = _strip(discrete).inertia / 2
    return _of_scaled(discrete, np.stack([np.imag(trace) * half, -(np.real(trace) + 1) * half], axis=-1))


def _of_scaled(discrete: Discretization, points: Float[np.ndarray, "... 2"]) -> Float[np.ndarray, "... 2"]:
    r"""Return restricted momenta of scaled points $(\pi, \hat p)$, $\hat p = ap_1 + 2ma^2$."""
    strip = _strip(discrete)
    p1 = (points[..., 1] - 2 * strip.mass * strip.arm**2) / strip.arm
    return strip.restricted_momenta(np.stack([points[..., 0], p1], axis=-1)) / float(discrete.time_step)


@result
class SingleValuedRegion:
    """The region in which the discrete sleigh has one real branch, and where its branches merge.

    Attributes:
        energy: The sharp bound: below it every momentum has exactly one real branch, and at it one has more.
        principal_energy: The larger bound below which every momentum has a principal value, though others may be real:
            no orbit on the principal branch ends. Above it a part of the energy level has none.
        bound_of_the_paper: The bound printed in the paper, between 3.79 and 4 times smaller.
        contact: Momenta (p_theta, p_1) at the sharp bound where real branches merge, shape (j, 2).
        cusps: Momenta (p_theta, p_1) of the three cusps of the deltoid, where all three branches merge, shape (3, 2).
    """

    energy: float
    principal_energy: float
    bound_of_the_paper: float
    contact: Float[np.ndarray, "j 2"]
    cusps: Float[np.ndarray, "3 2"]


def single_valued_region(sleigh: Discretization) -> SingleValuedRegion:
    r"""Return the energy below which the discrete sleigh is single-valued.

    With $M = ma^2$ and $I = J + M$

    $$ E^* = \frac{1}{2Mh^2}\,\min\Bigl\{4M^2,\ \bigl(\tfrac J4 - 2M\bigr)^2 + \frac{27MJ^2}{16\,I}\Bigr\}, \qquad
       E_\mathrm{paper} = \frac{M}{2h^2} . $$

    The principal branch ends only on two of the three sides of the deltoid. The least energy on them is

    $$ E^\dagger = \frac{1}{2Mh^2}\Bigl[\bigl(\tfrac J4 - 2M\bigr)^2 + \frac{27MJ^2}{16\,I}\Bigr] \ (J \le 2M), \qquad
       E^\dagger = \frac{I^2}{2Jh^2} \ (J \ge 2M). $$

    On $E < E^*$ the momentum $\pi = p_\theta + bp_1$ keeps its sign and $ap_1$ grows: the orbit runs from one straight
    motion to the opposite one.

    Reference: [fedorov-zenkov-2004], the theorem of section 7, which is not sharp.

    Args:
        sleigh: A discretized `ChaplyginSleigh`, difference "matrix", constraint "skew" or "exponential".

    Raises:
        ValueError: Another system or discretization, or a = 0 (then two branches are real however small the energy).

    Example:
        >>> region = single_valued_region(nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1))
        >>> print(f"{region.energy:.10f} {region.principal_energy:.10f} {region.bound_of_the_paper:.10f}")
        50.0000000000 78.1250000000 12.5000000000
    """
    strip, h = _checked_strip("single_valued_region(sleigh=...)", sleigh), float(sleigh.time_step)
    J, M = strip.inertia, strip.mass * strip.arm**2
    cusp_at = 3 * np.sqrt(3) / 4 * J, J / 4
    cusps = np.array([[0.0, -2 * J], [-cusp_at[0], cusp_at[1]], cusp_at])
    ratio = J / M  # the two entries divided by 4 M^2; Python numbers do not overflow where a tends to zero
    at_cusp = (ratio / 8 - 1) ** 2 + 27 * ratio * (ratio / (1 + ratio)) / 64
    touching = [[0.0, 0.0]] if at_cusp > 1 else cusps[1:] if at_cusp < 1 else [[0.0, 0.0], *cusps[1:]]
    return SingleValuedRegion(
        energy=float(2 * M / h**2 * min(1.0, at_cusp)),
        principal_energy=float(2 * M / h**2 * at_cusp if ratio <= 2 else (J + M) ** 2 / (2 * J * h**2)),
        bound_of_the_paper=float(M / (2 * h**2)),
        contact=_of_scaled(sleigh, np.array(touching)),
        cusps=_of_scaled(sleigh, cusps),
    )


def _checked_strip(where: str, discrete: Any) -> Strip:
    """Return the displacements of a sleigh in the plane whose map has three branches."""
    variety = planar.planar_variety(as_discretization(where, discrete).system)
    if not isinstance(variety, Strip):
        remedy = "Tops have no deltoid: pass `discretize(ChaplyginSleigh(...), time_step)`."
        raise error(where, "be of a sleigh in the plane", shown(discrete.system), remedy)
    planar.check_conserves_energy(where, discrete, "be the map with three branches")
    if variety.arm == 0:
        remedy = "A balanced sleigh has two real branches, at D and pi - D, if |p_theta + b p_1| < J/h, else none."
        raise error(where, "have a != 0, a center of mass off the blade's normal", shown(discrete.system), remedy)
    return variety
