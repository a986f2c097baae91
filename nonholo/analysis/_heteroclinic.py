"""Orbits of the discrete map from the repelling to the attracting equilibrium, whole; what they say against a flow.

The map is reversible: the past of a displacement W is the future of its inverse, turned round. `flow_obstruction`
compares the linearizing coordinates at both ends, for tops with n = 3 and sleighs in the plane. The flow between two
equilibria in closed form lives in `nonholo.continuous`. Theory: docs/theory/invariant-measure.md.
"""

import dataclasses
import math
from typing import Any, cast

import numpy as np

from nonholo.analysis._asymptotics import Asymptotics, approach, asymptotics, follow
from nonholo.analysis._equilibria import equilibria
from nonholo.analysis.planar import planar_map, planar_variety
from nonholo.base.checks import choice, error, positive, shown
from nonholo.base.limits import bounded_count
from nonholo.base.progress import progress_bar
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
        limits: Its limits in the past and in the future.
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
    system = _top_or_sleigh(where, as_discretization(where, discrete))
    one_start("heteroclinic", energy=energy, momentum=momentum, displacement=displacement)
    sign = choice("heteroclinic(side=...)", side, (1, -1))
    start = {"momentum": momentum, "displacement": displacement}
    if energy is not None:
        start["momentum"] = middle(system, energy, sign)
    point = simulate(discrete, **start, configuration=configuration, steps=1)[:1]
    return HeteroclinicOrbit(both_ways("heteroclinic(...)", point), asymptotics(point))


def both_ways(where: str, point: Orbit) -> Orbit:
    """Return the whole orbit of a state, refused in the name of `where` on an equilibrium."""
    limits = approach(point)
    if limits is None:
        raise error(where, "start off the equilibria", "a constant velocity", "Start beside it.")
    return _join(*follow(point, limits, where))


def _top_or_sleigh(where: str, discrete: Discretization) -> AbstractLLSystem:
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


def _join(past: Orbit, future: Orbit) -> Orbit:
    r"""Return one orbit from the first state on and from the inverse of its displacement.

    State j of the past has $W_{-j}^{-1}$, the momentum $-r_{1-j}$ and the pose $g_{1-j}$.
    """
    earlier, later = slice(-2, 0, -1), slice(-1, 1, -1)
    h = float(future.time[1] - future.time[0])
    return dataclasses.replace(
        future,
        time=h * np.arange(2 - len(past), len(future)),
        reduced_momentum=np.concatenate([-past.reduced_momentum[later], future.reduced_momentum]),
        cayley=np.concatenate([-past.canonical_chart[earlier], future.canonical_chart]),
        canonical_pose=np.concatenate([np.asarray(past.canonical_pose)[later], np.asarray(future.canonical_pose)]),
    )


@dataclasses.dataclass(frozen=True, eq=False)
class FlowObstruction:
    r"""The conjugacy invariant of the map on one side of the equilibria, on one energy.

    Attributes:
        multiplier: $\mu$ at the attracting end; $1/\mu$ at the repelling one.
        phase: Values of $s_-$ modulo 1, which grows by 1 in a step, ascending, shape (samples,).
        difference: $s_+ - s_-$ at these orbits, less its mean, shape (samples,).
    """

    multiplier: float
    phase: Float[np.ndarray, "samples"]
    difference: Float[np.ndarray, "samples"]

    @property
    def amplitude(self) -> float:
        """The largest less the smallest difference; zero for the map of a flow."""
        return float(np.ptp(self.difference))


def flow_obstruction(
    discrete: Discretization, energy: Any, samples: int = 16, *, progress: bool = False
) -> FlowObstruction:
    r"""Return the periodic function that would be constant if the map were that of a smooth flow.

    On a half of an energy level the side $\sigma_k$ of the momentum (`half_planes`) tends to zero at both ends. There

    $$ s_+ = \lim_{k\to\infty}\Bigl(\frac{\log|\sigma_k|}{\log\mu} - k\Bigr), \qquad
       s_- = -\lim_{k\to-\infty}\Bigl(\frac{\log|\sigma_k|}{\log\mu} + k\Bigr) $$

    are coordinates in which the map is $s \mapsto s + 1$, the only smooth ones up to a constant. If the map were the
    time-h map of a smooth flow on the closed half level, both would be times of that flow, and their difference
    constant. It is a function of period 1 of $s_-$. Since $\sigma_{k+1}/\sigma_k = (\Lambda - Q)/(\Lambda + Q)$ is
    a function of the displacement, the limits are sums without cancellation; they are right to about $10^{-14}$ over
    $|\log\mu|$. Smaller amplitudes, those of short steps, are beyond double precision.

    Args:
        discrete: A top with n = 3 or a sleigh, discretized with "matrix" and "skew".
        energy: The energy of the level; on it orbits have to stay on their side.
        samples: Orbits, spread over one step.
        progress: Show a progress bar on standard error.

    Raises:
        ValueError: Another system or discretization, a balanced body, an energy that is not positive or so large that
            orbits change sides.
        OutcomeError: The branch ends on the way.

    Example:
        >>> obstruction = flow_obstruction(nh.discretize(nh.ChaplyginSleigh(1.0, 0.2, 1.0), 1.0), energy=1.125)
        >>> print(f"{obstruction.amplitude:.1e}")
        4.5e-03
    """
    where = "flow_obstruction(discrete=...)"
    discrete = planar_map(where, discrete)[0]
    number = bounded_count("flow_obstruction(samples=...)", samples, 100.0, "Pass the number of orbits.")
    spectrum = equilibria(discrete, energy)
    if spectrum.multipliers is None or spectrum.attracting is None:
        got = f"the balanced {discrete.system!r}"
        raise error(where, "have attracting equilibria", got, "Its momenta are constant.")
    multiplier = float(spectrum.multipliers[0])
    ends = np.empty((number, 2))
    with progress_bar("orbits", progress) as report:
        for sample, r in enumerate(_one_step(discrete, energy, number)):
            ends[sample] = _ends(discrete, multiplier, r)
            report(sample + 1, number)
    order = np.argsort(ends[:, 0] % 1.0)
    difference = ends[order, 1] - ends[order, 0]
    return FlowObstruction(multiplier, ends[order, 0] % 1.0, difference - difference.mean())


def _one_step(discrete: Discretization, energy: Any, number: int) -> Float[np.ndarray, "samples 2"]:
    """Return momenta from the middle of the half level to where one step takes it."""
    system = cast("AbstractLLSystem", discrete.system)
    first = middle(system, energy, 1)
    after = simulate(discrete, momentum=first, steps=1, reconstruct=False).restricted_momentum[1]
    level = 2 * float(system.constrained_energy(first))
    cosine = float(after @ system.restricted_velocity(first)) / level
    across = after - cosine * first
    angles = np.arctan2(np.sqrt(2 * system.constrained_energy(across) / level), cosine) * np.arange(number) / number
    toward = across * np.sqrt(level / (2 * system.constrained_energy(across)))
    return np.cos(angles)[:, None] * first + np.sin(angles)[:, None] * toward


def _ends(discrete: Discretization, multiplier: float, r: Float[np.ndarray, "2"]) -> tuple[float, float]:
    """Return the linearizing coordinates of a momentum at the repelling and at the attracting end."""
    point = simulate(discrete, momentum=r, steps=1)[:1]
    orbit, variety = both_ways("flow_obstruction(...)", point), planar_map("flow_obstruction(...)", discrete)[1]
    (_, forward), weight = variety.sides(variety.points(orbit.displacement))
    ratio = (weight - forward) / (weight + forward)
    if multiplier <= 0 or ratio.min() <= 0:
        remedy = "Take a smaller energy or time step."
        got = f"a step that multiplies the side by {ratio.min():.3g}"
        raise error("flow_obstruction(energy=...)", "keep orbits on their side", got, remedy)
    here, rate = math.log(abs(float(variety.sides_of_momenta(r).side))), math.log(multiplier)
    factors, now = np.log(ratio), int(np.flatnonzero(orbit.time == 0)[0])
    after = here + math.fsum(factors[now:] - rate)
    before = here - math.fsum(factors[:now] + rate)
    return -before / rate, after / rate
