"""Both ends of an orbit: its first state followed backwards and forwards until its velocity has settled."""

from typing import NamedTuple, cast

import numpy as np

from nonholo.analysis._equilibria import EquilibriumSpectrum, equilibria
from nonholo.base.checks import error
from nonholo.base.types import Float
from nonholo.discrete import Discretization
from nonholo.orbit import Orbit
from nonholo.simulation import flow, simulate
from nonholo.systems import AbstractLLSystem

_ROUNDING = 8 * np.finfo(np.float64).eps
_SETTLED = 34.0  # natural logarithm of the factor by which the distance from the equilibria has fallen: 6e14
_LONGEST = 1_000_000  # steps


class Ends(NamedTuple):
    """The orbit run backwards (against time, from one step after its first state) and forwards."""

    first: Orbit
    last: Orbit


class Approach(NamedTuple):
    """The limits of an orbit.

    Attributes:
        kept: The part of the body velocity that never changes.
        energy: The energy of the rest.
        spectrum: The equilibria that the rest tends to.
        beside: Sine of the distance of the first state from the equilibria: near the repelling ones it leaves late.
    """

    kept: Float[np.ndarray, "dim"]
    energy: float
    spectrum: EquilibriumSpectrum
    beside: float


def approach(orbit: Orbit) -> Approach | None:
    """Return what an orbit of a top or a sleigh tends to; None if its velocity never changes."""
    system, velocity = cast("AbstractLLSystem", orbit.system), orbit.body_velocity[0]
    known = system.equilibria()
    rows = known.subspace
    beside = float(np.linalg.norm(velocity - velocity @ np.linalg.pinv(rows) @ rows) / (np.linalg.norm(velocity) or 1))
    if known.attracting is None or beside <= _ROUNDING:
        return None
    kept, energy = kept_velocity(orbit)
    subject = orbit.motion if isinstance(orbit.motion, Discretization) else system
    return Approach(kept, energy, equilibria(subject, energy), beside)


def kept_velocity(orbit: Orbit) -> tuple[Float[np.ndarray, "dim"], float]:
    """Return the part of the velocity that never changes, and the energy of the rest."""
    system, velocity = cast("AbstractLLSystem", orbit.system), orbit.body_velocity[0]
    form, kept = system.normal_form, np.zeros_like(velocity)
    if form is not None and form.is_sleigh and form.arm == 0:  # the advance u
        rows = system.form_map @ system.constraint_subspace
        w = velocity @ np.linalg.pinv(rows)
        kept = (w[-1] + form.offset @ w[:-1]) * rows[-1]
    return kept, float(orbit.energy[0]) - float(system.constrained_energy(kept @ np.asarray(system.inertia_operator)))


def followed(orbit: Orbit, found: Approach, where: str = "asymptotics(subject=...)") -> Ends:
    """Follow an orbit, from the identity if it has no poses, to both ends; refuse in the name of `where`."""
    spectrum, decay = found.spectrum, _SETTLED - float(np.log(found.beside))
    if isinstance(orbit.motion, Discretization):
        return _discrete(orbit, orbit.motion, spectrum, decay, where)
    start = {"momentum": orbit.restricted_momentum[0], "configuration": _pose(orbit)}
    time = decay / float(np.abs(spectrum.rates).min())
    method = "closed_form" if orbit.system.group.dim == 3 else None
    ends = (flow(orbit.system, **start, times=(0.0, t), rtol=1e-12, atol=1e-13, method=method) for t in (-time, time))
    return Ends(*ends)


def _discrete(orbit: Orbit, discrete: Discretization, spectrum: EquilibriumSpectrum, decay: float, where: str) -> Ends:
    """Run the map forwards, and backwards from the inverse displacement: the map is reversible.

    A composition goes back from the opposite momentum.
    """
    slowest = float(np.abs(np.asarray(spectrum.multipliers)).max())
    wanted = decay / -np.log(slowest) if slowest < 1 else np.inf
    if wanted > _LONGEST:
        remedy = "Take a longer time step, or the limits of the flow."
        got = f"a slowest multiplier of {slowest:.17g}"
        raise error(where, f"settle within {_LONGEST} steps", got, remedy)
    group, W, g = discrete.system.group, orbit.displacement[0], _pose(orbit)
    steps = int(np.ceil(wanted)) + 1
    last = simulate(discrete, momentum=orbit.restricted_momentum[0], configuration=g, steps=steps)
    composed = discrete.order > 2
    back = {"momentum": -last.restricted_momentum[1]} if composed else {"displacement": group.inverse(W)}
    return Ends(simulate(discrete, **back, configuration=g @ W, steps=steps), last)


def _pose(orbit: Orbit) -> Float[np.ndarray, "N N"]:
    return orbit.system.group.identity if orbit.canonical_pose is None else orbit.configuration[0]
