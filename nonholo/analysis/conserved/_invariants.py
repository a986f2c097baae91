"""Quantities that an orbit should keep, measured: energy, constraint, group, reversibility."""

import dataclasses
from typing import Any, cast

import numpy as np

from nonholo.base.checks import error, instance
from nonholo.base.results import Outcome
from nonholo.base.types import Float
from nonholo.discrete import Discretization, reversal_defects
from nonholo.orbit import AbstractOrbit, Orbit
from nonholo.systems import NormalForm

_SAMPLED = 100_000  # states on which the matrix residuals are measured, spread evenly; the energy uses all
_SAMPLED_LARGE = 1_000  # of them where the group has more than three dimensions, and logarithms cost more


@dataclasses.dataclass(frozen=True)
class Invariants:
    """Measured defects of an orbit; None where a quantity is not defined for it.

    Attributes:
        states: Saved states.
        steps: Steps they span (0 for a flow); of given poses the times between them.
        energy_drift: Largest change of the reduced constrained energy, relative to it (absolute at rest). Under forces
            what is left of the balance: the largest change of the energy less the work of the force, relative to the
            largest energy; NaN where that work is not known, of a thinned run under a table.
        constraint_residual: Largest forbidden part of (W - W^-1)/2 of a displacement, of log W where the variety is
            exp d alone, or of a velocity, of a flow and of given poses; where the variety is given by equations, and in
            coordinates, their largest residual.
        group_residual: Largest distance of a pose from the group.
        reversal_defect: Largest relative miss of one step forward and back; not measured in coordinates.
        largest_step_angle: In degrees.
        outcome: How the run ended.
        work: What forces, and what else drives it, did on the whole, less what friction dissipated; None of a free
            system.
    """

    states: int
    steps: int
    energy_drift: float
    constraint_residual: float
    group_residual: float | None
    reversal_defect: float | None
    largest_step_angle: float | None
    outcome: Outcome
    work: float | None = None


def invariants(orbit: AbstractOrbit) -> Invariants:
    """Measure what an orbit should keep.

    Returns:
        `Invariants`, with the fields `states`, `steps`, `energy_drift` (relative), `constraint_residual`,
        `group_residual`, `reversal_defect`, `largest_step_angle` (in degrees), `outcome`, `work`: the last five None
        where they are not defined. `help(type(nh.invariants(orbit)))` says what each of them is.

    Raises:
        ValueError: The orbit has no states.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
        >>> orbit = nh.simulate(sleigh, body_velocity=(1, 0, 0), steps=100)
        >>> invariants(orbit).energy_drift < 1e-14
        True
    """
    where, remedy = "invariants(orbit=...)", "Pass what `simulate` or `flow` returned."
    if len(instance(where, orbit, AbstractOrbit, "be an orbit", remedy)) == 0:
        raise error(where, "have at least one state", str(orbit), "Its outcome says why it has none.")
    return _of_body(orbit) if isinstance(orbit, Orbit) else _in_coordinates(orbit)


def _in_coordinates(orbit: Any) -> Invariants:
    work, driven = orbit.known_work, orbit.system.is_driven
    on_group = None if orbit.coordinates else float(np.max(orbit.space.residual(orbit.configuration)))
    return Invariants(
        states=len(orbit),
        steps=int(np.ptp(orbit.step)) if orbit.is_discrete else 0,
        energy_drift=_energy_drift(orbit.energy, work, forced=driven),
        constraint_residual=float(orbit.constraint_residual.max()),
        group_residual=on_group,
        reversal_defect=None,
        largest_step_angle=None,
        outcome=orbit.outcome,
        work=float(work[-1]) if driven else None,
    )


def _of_body(orbit: Orbit) -> Invariants:
    group = orbit.system.group
    stride = max(1, len(orbit) // (_SAMPLED if group.dim == 3 else _SAMPLED_LARGE))
    sample = orbit[::stride] if stride > 1 else orbit
    discrete = orbit.motion if isinstance(orbit.motion, Discretization) else None
    work, forced = orbit.known_work, orbit.system.forces is not None
    return Invariants(
        states=len(orbit),
        steps=int(np.ptp(orbit.step)) if orbit.is_discrete else 0,
        energy_drift=_energy_drift(orbit.energy, work, forced=forced),
        constraint_residual=float(np.abs(orbit.motion.constraint_residual(sample)).max(initial=0.0)),
        group_residual=None if orbit.canonical_pose is None else _group_residual(sample),
        reversal_defect=None if discrete is None else _reversal_defect(discrete, sample),
        largest_step_angle=None if orbit.cayley is None else _largest_angle(sample),
        outcome=orbit.outcome,
        work=float(work[-1]) if forced else None,
    )


def _energy_drift(energy: Float[np.ndarray, "K"], work: Any, *, forced: bool) -> float:
    size = np.abs(energy if forced else energy[0]).max()
    return float(np.abs(energy - energy[0] - work).max() / (size or 1.0))


def _largest_angle(orbit: Orbit) -> float:
    system, y, motion = orbit.system, orbit.canonical_chart, orbit.motion
    if system.is_wide:
        turning = len(cast(NormalForm, system.normal_form).coupling)
        angles = 2 * np.arctan(np.linalg.norm(y[:, :turning], axis=1))  # of planes through one axis
    elif isinstance(motion, Discretization) and motion.order == 2:
        angles = motion.variety.angle(y)
    else:
        angles = system.group.angle(system.group.log(orbit.displacement))
    return float(np.degrees(angles.max()))


def _group_residual(orbit: Orbit) -> float:
    """Return the largest change that normalizing makes in a pose, and the residual of those that are matrices."""
    group, pose = orbit.system.group, orbit.canonical_pose
    moved = np.abs(pose - group.normalize_pose(pose)).max()
    return float(moved if group.pose_size < group.size**2 else max(moved, group.residual(orbit.configuration).max()))


def _reversal_defect(discrete: Discretization, orbit: Orbit) -> float | None:
    route = discrete.route.compiled_route if discrete.forces is None else None
    if route is None:
        return None
    moving = np.asarray(orbit.canonical_chart.any(axis=1))
    defects = reversal_defects(route, orbit if moving.all() else orbit.chosen(moving))
    return float(np.fmax.reduce(defects, initial=0.0))  # without NaN
