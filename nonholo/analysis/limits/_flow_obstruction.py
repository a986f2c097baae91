r"""Against a smooth flow: the linearizing coordinates of the discrete map at both ends, whose difference is computed.

Tops with n = 3 and sleighs in the plane. Theory: docs/theory/invariant-measure.md.
"""

import dataclasses
import math
from typing import Any, cast

import numpy as np

from nonholo.analysis._equilibria import equilibria
from nonholo.analysis.limits._heteroclinic import both_ways, middle
from nonholo.analysis.planar import planar_map
from nonholo.base.checks import error
from nonholo.base.limits import bounded_count
from nonholo.base.progress import progress_bar
from nonholo.base.types import Float
from nonholo.discrete import Discretization
from nonholo.simulation import simulate
from nonholo.systems import AbstractLLSystem


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
    checked = planar_map(where, discrete)[0]
    number = bounded_count("flow_obstruction(samples=...)", samples, 100.0, "Pass the number of orbits.")
    spectrum = equilibria(checked, energy)
    if spectrum.multipliers is None or spectrum.attracting is None:
        got = f"the balanced {checked.system!r}"
        raise error(where, "have attracting equilibria", got, "Its momenta are constant.")
    multiplier = float(spectrum.multipliers[0])
    ends = np.empty((number, 2))
    with progress_bar("orbits", progress) as report:
        for sample, r in enumerate(_one_step(checked, energy, number)):
            ends[sample] = _ends(checked, multiplier, r)
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
