"""The words above the panels of an overview: what moves, its parameters, how long, and how the run ended."""

from matplotlib.figure import Figure

from nonholo.base.results import Outcome
from nonholo.orbit import Orbit
from nonholo.plotting.parts import is_free, time_step
from nonholo.plotting.sheets import sheet_of
from nonholo.systems import LLSystem, System

_FIXED = {False: "System with a left-invariant constraint", True: "System with a right-invariant constraint"}


def write_head(figure: Figure, orbit: Orbit) -> None:
    """Write what moves, and how, above the panels."""
    figure.text(0.012, 0.985, _name(orbit.system), va="top", fontsize=17, fontweight="bold")
    facts = "      ".join(_facts(orbit)).replace("-", "\u2212")
    figure.text(0.012, 0.934, facts, va="top", fontsize=10.5, color="#555a62")


def _facts(orbit: Orbit) -> list[str]:
    step = time_step(orbit)
    if step is None:
        run = f"continuous flow from time {orbit.time[0]:g} to {orbit.time[-1]:g}"
    else:
        steps = (len(orbit) - 1) * orbit.save_every
        run = f"{steps:,} step{'s' * (steps != 1)} of $h$ = {step:g}".replace(",", "\u2009")
    stopped = [] if orbit.outcome == Outcome.successful else [f"stopped: {orbit.outcome}"]
    return [_parameters(orbit.system), run, *stopped]


def _name(system: System) -> str:
    form = system.normal_form
    if form is not None:
        sleigh = "Chaplygin sleigh" if form.is_planar else "Multidimensional sleigh"
        return sleigh if form.is_sleigh else "Suslov top"
    if system.homogeneous_mass_tensor is not None and system.group.is_rigid:
        if is_free(system):
            return "Free rigid body"
        if system.is_spatial and _is_top_in_body(system):
            return "Veselova top"
    return _FIXED[system.is_spatial]


def _is_top_in_body(system: System) -> bool:
    """Tell whether the body would be a top if its constraint were fixed in it."""
    form = LLSystem(system.group, system.homogeneous_mass_tensor, system.constraint_subspace).normal_form
    return form is not None and not form.is_sleigh


def _parameters(system: System) -> str:
    sheet = sheet_of(system)
    if sheet is not None:
        return sheet.facts(system)
    free, all_directions = system.rank, system.group.dim
    if free == all_directions:
        return f"{system.group},  no constraint"
    side = "space" if system.is_spatial else "the body"
    return f"{system.group},  {free} of {all_directions} directions of velocity allowed, fixed in {side}"
