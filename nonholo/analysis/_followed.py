"""Both ends of an orbit: its first state followed backwards and forwards until its velocity has settled."""

from typing import NamedTuple

import numpy as np

from nonholo._checks import error
from nonholo._types import Float
from nonholo.analysis._equilibria import EquilibriumSpectrum
from nonholo.discrete import Discretization
from nonholo.orbit import Orbit
from nonholo.simulation import flow, simulate

_SETTLED = 34.0  # natural logarithm of the factor by which the distance from the equilibria has fallen: 6e14
_LONGEST = 1_000_000  # steps


class Ends(NamedTuple):
    """The orbit run backwards (against time, from one step after its first state) and forwards."""

    first: Orbit
    last: Orbit


def followed(orbit: Orbit, spectrum: EquilibriumSpectrum, beside: float) -> Ends:
    """Follow an orbit to both ends.

    Args:
        orbit: From the identity if it has no poses.
        spectrum: The equilibria that it tends to.
        beside: Sine of the distance of its first state from the equilibria: near the repelling ones it leaves late.
    """
    decay = _SETTLED - float(np.log(beside))
    if isinstance(orbit.motion, Discretization):
        return _discrete(orbit, orbit.motion, spectrum, decay)
    start = {"momentum": orbit.restricted_momentum[0], "configuration": _pose(orbit)}
    time = decay / float(np.abs(spectrum.rates).min())
    method = "closed_form" if orbit.system.group.dim == 3 else None
    ends = (flow(orbit.system, **start, times=(0.0, t), rtol=1e-12, atol=1e-13, method=method) for t in (-time, time))
    return Ends(*ends)


def _discrete(orbit: Orbit, discrete: Discretization, spectrum: EquilibriumSpectrum, decay: float) -> Ends:
    """Run the map forwards, and backwards with the inverse displacement: the map is reversible."""
    slowest = float(np.abs(np.asarray(spectrum.multipliers)).max())
    wanted = decay / -np.log(slowest) if slowest < 1 else np.inf
    if wanted > _LONGEST:
        remedy = "Take a longer time step, or the limits of the flow."
        got = f"a slowest multiplier of {slowest:.17g}"
        raise error("asymptotics(subject=...)", f"settle within {_LONGEST} steps", got, remedy)
    group, W, g = discrete.system.group, orbit.displacement[0], _pose(orbit)
    steps = int(np.ceil(wanted)) + 1
    first = simulate(discrete, displacement=group.inverse(W), configuration=g @ W, steps=steps)
    last = simulate(discrete, momentum=orbit.restricted_momentum[0], configuration=g, steps=steps)
    return Ends(first, last)


def _pose(orbit: Orbit) -> Float[np.ndarray, "N N"]:
    return orbit.system.group.identity if orbit.pose is None else orbit.configuration[0]
