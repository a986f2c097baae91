"""The curve of all displacements of one energy, on which orbits run."""

import dataclasses

import numpy as np

from nonholo.analysis.planar import momenta_at, planar_map
from nonholo.base.checks import number, positive
from nonholo.base.limits import bounded_count
from nonholo.base.types import Array, Float
from nonholo.discrete import Discretization


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
    checked, variety = planar_map("invariant_curve(discrete=...)", discrete)
    level = float(positive("invariant_curve(energy=...)", energy, "An orbit has one: `orbit.energy[0]`."))
    rows = bounded_count("invariant_curve(resolution=...)", resolution, 1000.0, "Pass the points of an arc.")
    curves = variety.level(level * float(checked.time_step) ** 2).components(rows)
    return InvariantCurve(checked, level, curves)
