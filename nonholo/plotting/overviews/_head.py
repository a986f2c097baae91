"""The words above the panels of an overview: what moves, its parameters, how long, and how the run ended."""

import numpy as np
from matplotlib.figure import Figure

from nonholo._results import Outcome
from nonholo.orbit import Orbit
from nonholo.plotting.parts import time_step
from nonholo.systems import (
    AbstractLLSystem,
    ChaplyginSleigh,
    LLSystem,
    LRSystem,
    MultidimensionalSleigh,
    RigidBody,
    SuslovTop,
    System,
    VeselovaTop,
)

_NAMES = {
    SuslovTop: "Suslov top",
    ChaplyginSleigh: "Chaplygin sleigh",
    MultidimensionalSleigh: "Multidimensional sleigh",
    RigidBody: "Free rigid body",
    VeselovaTop: "Veselova top",
    LLSystem: "System with a left-invariant constraint",
    LRSystem: "System with a right-invariant constraint",
}


def write_head(figure: Figure, orbit: Orbit) -> None:
    """Write what moves, and how, above the panels."""
    figure.text(
        0.012,
        0.985,
        _NAMES.get(type(orbit.system), type(orbit.system).__name__),
        va="top",
        fontsize=17,
        fontweight="bold",
    )
    figure.text(
        0.012, 0.934, "      ".join(_facts(orbit)).replace("-", "\u2212"), va="top", fontsize=10.5, color="#555a62"
    )


def _facts(orbit: Orbit) -> list[str]:
    step = time_step(orbit)
    if step is None:
        run = f"continuous flow from time {orbit.time[0]:g} to {orbit.time[-1]:g}"
    else:
        steps = (len(orbit) - 1) * orbit.save_every
        run = f"{steps:,} step{'s' * (steps != 1)} of $h$ = {step:g}".replace(",", "\u2009")
    stopped = [] if orbit.outcome == Outcome.successful else [f"stopped: {orbit.outcome}"]
    return [_parameters(orbit.system), run, *stopped]


def _parameters(system: System) -> str:
    if isinstance(system, ChaplyginSleigh):
        symbols = {"m": system.mass, "J": system.inertia, "a": system.a, "b": system.b}
        return ",  ".join(f"${symbol}$ = {float(value):.4g}" for symbol, value in symbols.items())
    if isinstance(system, SuslovTop) and system.axis is not None:
        axis = ", ".join(f"{number:.3g}" for number in np.asarray(system.axis) + 0.0)
        return rf"SO(3),  $\langle\gamma,\omega\rangle = 0$  with  $\gamma$ = ({axis})"
    free, all_directions = system.rank, system.group.dim
    if free == all_directions:
        return f"{system.group},  no constraint"
    side = "the body" if isinstance(system, AbstractLLSystem) else "space"
    return f"{system.group},  {free} of {all_directions} directions of velocity allowed, fixed in {side}"
