"""Orbits of the discrete map from the repelling to the attracting equilibrium, whole.

The map is reversible: the past of a displacement W is the future of its inverse, turned round. Limits are those of
`_asymptotics`; the flow between two equilibria in closed form lives in `nonholo.continuous`.
"""

import dataclasses
from typing import Any, cast

import numpy as np

from nonholo.analysis.limits._asymptotics import Asymptotics, asymptotics
from nonholo.analysis.limits._followed import approach, followed
from nonholo.analysis.planar import planar_variety
from nonholo.base.checks import choice, error, positive, shown
from nonholo.base.types import Float
from nonholo.discrete import Discretization, as_discretization
from nonholo.orbit import Orbit
from nonholo.simulation import simulate
from nonholo.systems import AbstractLLSystem, one_start


@dataclasses.dataclass(frozen=True, eq=False)
class HeteroclinicOrbit:
    """An orbit traced both ways.

    Attributes:
        orbit: All states, the past first; the point that was given has time zero. At both ends the distance from the
            equilibria has fallen by 6e14, to rounding.
        limits: What it comes from and goes to.
    """

    orbit: Orbit
    limits: Asymptotics


def heteroclinic(
    discrete: Discretization,
    *,
    energy: Any = None,
    momentum: Any = None,
    displacement: Any = None,
    configuration: Any = None,
    side: int = 1,
) -> HeteroclinicOrbit:
    r"""Trace an orbit of the discrete map from near the repelling to near the attracting equilibrium.

    Forwards the map is run from W; backwards from $W^{-1}$, whose orbit is the past of W, inverted. Each value is
    the principal one of its direction, so the way back is on the branch on which the map was run.

    Reference: [fedorov-zenkov-2004], theorem (discr_sus_dyn) and the theorem of section 7.

    Args:
        discrete: A top or a sleigh of any dimension, discretized with "matrix" and "skew".
        energy: The energy, where the constraint leaves two directions (n = 3, the plane); the orbit then passes
            through the momentum half way between the equilibria.
        momentum: A momentum on the orbit, full or along the constraint subspace.
        displacement: A displacement on the orbit.
        configuration: The pose at time zero; the identity by default.
        side: With `energy`, which of the two half-planes of `half_planes`: 1 or -1.

    Raises:
        ValueError: Another system or discretization, a balanced body, a start on an equilibrium, none or several
            starts, an energy for other systems, an orbit that needs more than a million steps.
        OutcomeError: The start is not on the principal branch, or that ends on the way, forwards or backwards.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=0.75, a=0.5), 0.2)
        >>> connection = heteroclinic(sleigh, energy=0.5)
        >>> connection.orbit.body_velocity[[0, -1], 1].round(12)
        array([-1.,  1.])
        >>> bool(np.ptp(connection.orbit.energy) < 1e-14)
        True
    """
    where = "heteroclinic(discrete=...)"
    system = _checked(where, as_discretization(where, discrete))
    one_start("heteroclinic", energy=energy, momentum=momentum, displacement=displacement)
    sign = choice("heteroclinic(side=...)", side, (1, -1))
    start = {"momentum": momentum, "displacement": displacement}
    if energy is not None:
        start["momentum"] = middle(system, energy, sign)
    point = simulate(discrete, **start, configuration=configuration, steps=1)[:1]
    return HeteroclinicOrbit(both_ways("heteroclinic(...)", point), asymptotics(point))


def both_ways(where: str, point: Orbit) -> Orbit:
    """Return the whole orbit of a state, refused in the name of `where` on an equilibrium."""
    found = approach(point)
    if found is None:
        raise error(where, "start off the equilibria", "a constant velocity", "Start beside it.")
    return _joined(*followed(point, found, where))


def _checked(where: str, discrete: Discretization) -> AbstractLLSystem:
    system = cast("AbstractLLSystem", discrete.system)
    if system.normal_form is None or not discrete.conserves_energy:
        remedy = "Discretize a SuslovTop or a sleigh with the defaults."
        raise error(where, "be a top or a sleigh whose map keeps energy", shown(discrete), remedy)
    if system.equilibria().attracting is None:
        raise error(where, "have attracting equilibria", f"the balanced {system!r}", "Its velocity is constant.")
    return system


def middle(system: AbstractLLSystem, energy: Any, side: int) -> Float[np.ndarray, "2"]:
    """Return the restricted momentum of an energy half way between the equilibria, where the Lyapunov function is 0."""
    level = float(positive("heteroclinic(energy=...)", energy, "Pass the energy of the orbit."))
    attracting = np.linalg.pinv(system.constraint_subspace).T @ np.asarray(system.equilibria().attracting)
    variety = planar_variety(system)
    if variety is None:
        got = f"{len(attracting)} admissible directions, where many orbits have one energy"
        raise error("heteroclinic(energy=...)", "determine the orbit", got, "Pass a momentum or a displacement.")
    r = np.array([-attracting[1], attracting[0]])
    r = r * np.sqrt(level / float(system.constrained_energy(r)))
    return side * np.sign(variety.sides_of_momenta(r).side) * r


def _joined(past: Orbit, future: Orbit) -> Orbit:
    r"""Return one orbit from the first state on and from the inverse of its displacement.

    State j of the past has $W_{-j}^{-1}$, the momentum $-r_{1-j}$ and the pose $g_{1-j}$.
    """
    earlier, shifted = slice(-2, 0, -1), slice(-1, 1, -1)
    h = float(future.time[1] - future.time[0])
    return dataclasses.replace(
        future,
        time=h * np.arange(2 - len(past), len(future)),
        reduced_momentum=np.concatenate([-past.reduced_momentum[shifted], future.reduced_momentum]),
        cayley=np.concatenate([-past.canonical_chart[earlier], future.canonical_chart]),
        canonical_pose=np.concatenate([np.asarray(past.canonical_pose)[shifted], np.asarray(future.canonical_pose)]),
    )
