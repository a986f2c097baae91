"""Subjects of pictures, and refusals in words: orbits that are not empty, of the right system, with poses if needed.

Also the few questions that several pictures ask of an orbit. No mechanics.
"""

from typing import Any, cast

import numpy as np

from nonholo.base.checks import error, instance, shown
from nonholo.base.types import Float
from nonholo.discrete import Discretization
from nonholo.orbit import AbstractOrbit, Orbit, as_orbit
from nonholo.systems import AbstractLLSystem, AbstractSystem, Equilibria, System

_SMOOTH = 1000  # states of a flow, in which a curve has no corners
_ROUNDING = 1e-12  # relative
NEAR_EQUILIBRIUM = 0.03  # sine, in the metric of the energy, of the angle to the line of equilibria


def drawable(where: str, orbit: Any) -> Orbit:
    """Return the same of an orbit on a group."""
    as_orbit(where, orbit, "for one in coordinates use `overview` and `energy_error`.")
    return drawable_in_time(where, orbit)


def drawable_in_time(where: str, orbit: Any) -> Any:
    """Return an orbit of any kind with at least one state; a flow that knows those between with enough for a curve."""
    remedy = "Pass what `simulate` or `flow` returned."
    if len(instance(where, orbit, AbstractOrbit, "be an orbit", remedy)) == 0:
        raise error(where, "have a state to draw", "none", "`orbit.outcome` has the reason.")
    if orbit.span is None or not 1 < len(orbit) < _SMOOTH:
        return orbit
    more = np.linspace(orbit.time[0], orbit.time[-1], _SMOOTH)
    times = np.union1d(orbit.time, more)
    return orbit.at(times if more[-1] > more[0] else times[::-1])


def with_poses(where: str, orbit: Any) -> Orbit:
    """Return the same of an orbit with poses."""
    orbit = drawable(where, orbit)
    if orbit.canonical_pose is None:
        raise error(where, "have poses", "an orbit without them", "Run with reconstruct=True.")
    return orbit


def same_group(where: str, orbit: Any, other: Orbit) -> Orbit | None:
    """Return the same of an orbit, if there is one, that moves on the same group as the orbit it is drawn beside."""
    if orbit is None:
        return None
    orbit = with_poses(where, orbit)
    if orbit.system.group != other.system.group:
        raise error(where, f"move on {other.system.group}", f"{orbit.system.group}", "Pass a motion of the same body.")
    return orbit


def is_free(system: System) -> bool:
    """Return whether nothing constrains the body or acts on it, whose spatial momentum is then conserved."""
    return system.rank == system.group.dim and not system.is_forced


def forbidden_axis(system: AbstractSystem) -> Float[np.ndarray, "3"] | None:
    """Return the body axis about which a body on SO(3) does not turn; None if there is not one."""
    if system.is_spatial or system.rank != 2:
        return None
    axis = system.annihilator[0]
    return axis / np.linalg.norm(axis)


def is_same_body(system: System, other: System) -> bool:
    """Return whether two systems have the same constraint and inertia, up to rounding, in any classes."""
    if (system.group, system.is_spatial, system.rank) != (other.group, other.is_spatial, other.rank):
        return False
    same_rows = np.allclose(system.constraint_subspace, other.constraint_subspace, rtol=0.0, atol=_ROUNDING)
    scale = np.abs(other.inertia_operator).max(initial=0.0)
    return same_rows and np.allclose(system.inertia_operator, other.inertia_operator, rtol=0.0, atol=_ROUNDING * scale)


def own_orbit(where: str, orbit: Any, discrete: Discretization) -> None:
    """Refuse an orbit that belongs to another discretized system."""
    if orbit is None:
        return
    same = drawable(where, orbit).time_step == float(discrete.time_step)
    if not (same and is_same_body(orbit.system, discrete.system)):
        raise error(where, "be an orbit of the same discretized system", shown(orbit), "Run `nh.simulate` with it.")


def known_equilibria(system: System) -> Equilibria | None:
    """Return the equilibria of a system; None where they are no linear space, or where the library has none."""
    if system.is_spatial or system.is_forced:
        return None
    try:
        equilibria = cast(AbstractLLSystem, system).equilibria()
    except ValueError:
        return None
    return None if equilibria.others else equilibria


def permanent_velocity(orbit: Orbit, state: int) -> Float[np.ndarray, "dim"] | None:
    r"""Return the constant body velocity that a state is close to, up to its size; None if there is none.

    Close means that the sine of the angle to the line of equilibria is small, in the metric of the kinetic energy.
    """
    system = orbit.system
    equilibria = known_equilibria(system)
    if equilibria is None or len(equilibria.subspace) == 0:
        return None
    velocity, inertia = orbit[state : state + 1].body_velocity[0], np.asarray(system.inertia_operator)
    if not velocity @ inertia @ velocity > 0:
        return None
    if len(equilibria.subspace) == len(system.constraint_subspace):
        return velocity
    line = equilibria.subspace[0]
    along = (velocity @ inertia @ line) / (line @ inertia @ line)
    across = velocity - along * line
    near = across @ inertia @ across <= NEAR_EQUILIBRIUM**2 * (velocity @ inertia @ velocity)
    return along * line if near else None
