"""The surface of all discrete momenta: its mesh, its equation, its singular points."""

import dataclasses
from typing import cast

import numpy as np

from nonholo._checks import count, error, number, trailing
from nonholo._limits import within_memory
from nonholo._types import Array, Float
from nonholo.analysis._conoid import Conoid, conoid
from nonholo.analysis._steiner import SteinerSurface, steiner_surface
from nonholo.analysis._variety_points import closed_form, displacement_at, momentum_at
from nonholo.discrete import Discretization
from nonholo.systems import ChaplyginSleigh, SuslovTop


@dataclasses.dataclass(frozen=True, eq=False)
class MomentumLocus:
    r"""A mesh of the momentum locus and its singular points; momenta are physical, in the user's frame.

    Attributes:
        discrete: The discretised system.
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
        return displacement_at(self.discrete, self.points)

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
        return surface_of(self.discrete).implicit(p)

    def whiskers(self, length: float = 1.0) -> Float[np.ndarray, "V 2 3"]:
        """Return pieces of the double lines that are not on the locus, as long as `length` times the segment.

        There the polynomial vanishes, but the two displacements are complex.
        """
        length = float(number("MomentumLocus.whiskers(length=...)", length))
        first, last = self.double_lines[:, 0], self.double_lines[:, 1]
        outwards = length * (last - first)
        before, after = np.stack([first, first - outwards], axis=1), np.stack([last, last + outwards], axis=1)
        return np.concatenate([before, after])


def surface_of(discrete: Discretization) -> SteinerSurface | Conoid:
    """Return the algebra of the surface."""
    system, time_step = discrete.system, float(discrete.time_step)
    if isinstance(system, ChaplyginSleigh):
        return conoid(system, time_step)
    return steiner_surface(cast(SuslovTop, system), time_step)


def momentum_locus(discrete: Discretization, resolution: int = 80) -> MomentumLocus:
    r"""Return the surface $\{P(W) : W \in \exp\mathfrak{d}\}$ of the discrete momenta of a top (n = 3) or a sleigh.

    For a top it is a Steiner surface of degree four, the image of the projective plane; for the sleigh Pluecker's
    conoid, of degree three, the image of a Moebius band, of which the mesh shows a part about its double segment. A
    step changes the momentum by $\mathrm{Ad}^*_W$ and then moves it, along the annihilator of $\mathfrak{d}$, back to
    this surface: several values are several sheets over one point.

    Reference: [fedorov-zenkov-2004], equations (Steiner) and (full); docs/theory/momentum-locus.md.

    Args:
        discrete: A top with n = 3 or a sleigh, discretised with "matrix" and "skew".
        resolution: Rows of the mesh; it has twice as many columns, and one more.

    Raises:
        ValueError: Another system, another discretisation, a resolution below 2.

    Example:
        >>> top = nh.discretize(nh.SuslovTop(np.diag([1.0, 2.0, 3.0])), 0.1)
        >>> locus = momentum_locus(top)
        >>> locus.double_lines.shape, locus.triple_point.round(12) + 0.0
        ((3, 2, 3), array([0., 0., 0.]))
        >>> bool(abs(locus.implicit(locus.momentum)).max() < 1e-13)
        True
    """
    checked = closed_form("momentum_locus(discrete=...)", discrete)
    rows = count("momentum_locus(resolution=...)", resolution, "Pass 2 or more.")
    within_memory("momentum_locus(resolution=...)", 1000.0 * rows**2, "Pass a lower resolution.")
    if rows < 2:
        raise error("momentum_locus(resolution=...)", "be at least 2", str(rows), "A mesh needs two rows.")
    if isinstance(checked.system, ChaplyginSleigh):
        parameters = points = _sleigh_mesh(checked.system, rows)
    else:
        parameters, points = _top_mesh(rows)
    surface = surface_of(checked)
    triple = surface.triple_point() if isinstance(surface, SteinerSurface) else None
    return MomentumLocus(checked, parameters, points, momentum_at(checked, points), surface.double_lines(), triple)


def _top_mesh(rows: int) -> tuple[np.ndarray, np.ndarray]:
    angle, direction = np.meshgrid(np.linspace(0, np.pi, rows), np.linspace(0, 2 * np.pi, 2 * rows + 1), indexing="ij")
    z0, size = np.cos(angle / 2), np.sin(angle / 2)
    points = np.stack([z0, size * np.cos(direction), size * np.sin(direction)], axis=-1)
    return np.stack([angle, direction], axis=-1), points


def _sleigh_mesh(system: ChaplyginSleigh, rows: int) -> np.ndarray:
    """Return angles and translations of pieces of the rulings whose middles are on the axis."""
    m, J, a = float(system.mass), float(system.inertia), float(system.a)
    reach = (2 * J + 2 * m * a * a) / (m * abs(a)) if a else 2 * np.sqrt(J / m)
    along, angle = np.meshgrid(np.linspace(-1, 1, rows), np.linspace(-np.pi, np.pi, 2 * rows + 1), indexing="ij")
    return np.stack([angle, reach * along - 2 * a * np.cos(angle / 2)], axis=-1)
