"""The surface of all discrete momenta: its mesh, its equation, its singular points."""

import dataclasses

import numpy as np

from nonholo.analysis.planar import momenta_at, planar_map
from nonholo.base.checks import count, error, number, trailing
from nonholo.base.limits import within_memory
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
    checked, variety = planar_map("momentum_locus(discrete=...)", discrete)
    rows = count("momentum_locus(resolution=...)", resolution, "Pass 2 or more.")
    within_memory("momentum_locus(resolution=...)", 1000.0 * rows**2, "Pass a lower resolution.")
    if rows < 2:
        raise error("momentum_locus(resolution=...)", "be at least 2", str(rows), "A mesh needs two rows.")
    parameters, points = variety.mesh(rows)
    surface, momentum = variety.surface(float(checked.time_step)), momenta_at(checked, variety, points)
    return MomentumLocus(checked, parameters, points, momentum, surface.double_lines(), surface.triple_point())
