"""Quantities that an orbit should keep, measured: energy, constraint, group, reversibility."""

import dataclasses
from typing import cast

import numpy as np

from nonholo.base.checks import error
from nonholo.base.results import Outcome
from nonholo.discrete import Discretization, reversal_defects
from nonholo.orbit import Orbit, as_orbit
from nonholo.systems import NormalForm

_SAMPLED = 100_000  # states on which the matrix residuals are measured, spread evenly; the energy uses all
_SAMPLED_LARGE = 1_000  # of them where the group has more than three dimensions, and logarithms cost more


@dataclasses.dataclass(frozen=True)
class Invariants:
    """Measured defects of an orbit; None where a quantity is not defined for it.

    Attributes:
        states: Saved states.
        steps: Steps they span (0 for a flow).
        energy_drift: Largest change of the reduced constrained energy, relative to it (absolute at rest). Under forces
            what is left of the balance: the largest change of the energy less the work of the force, relative to the
            largest energy.
        constraint_residual: Largest forbidden part of the logarithm of a displacement, or of a velocity; where the
            variety is given by equations, their largest residual.
        group_residual: Largest distance of a pose from the group.
        reversal_defect: Largest relative miss of one step forward and back.
        largest_step_angle: In degrees.
        outcome: How the run ended.
        work: What the force did on the whole, minus what friction dissipated; None of a free system.
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


def invariants(orbit: Orbit) -> Invariants:
    """Measure what an orbit should keep.

    Raises:
        ValueError: The orbit has no states.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
        >>> orbit = nh.simulate(sleigh, body_velocity=(1, 0, 0), steps=100)
        >>> invariants(orbit).energy_drift < 1e-14
        True
    """
    as_orbit("invariants(orbit=...)", orbit, "one in coordinates has energy and constraint_residual itself.")
    if len(orbit) == 0:
        raise error("invariants(orbit=...)", "have at least one state", str(orbit), "Its outcome says why it has none.")
    group = orbit.system.group
    sample = orbit[:: max(1, len(orbit) // (_SAMPLED if group.dim == 3 else _SAMPLED_LARGE))]
    discrete = sample.cayley is not None
    energy, work = orbit.energy, orbit.work
    size = np.abs(energy if orbit.system.forces is not None else energy[0]).max()
    return Invariants(
        states=len(orbit),
        steps=(len(orbit) - 1) * orbit.save_every if discrete else 0,
        energy_drift=float(np.abs(energy - energy[0] - work).max() / (size or 1.0)),
        constraint_residual=float(np.abs(orbit.motion.constraint_residual(sample)).max(initial=0.0)),
        group_residual=None if orbit.canonical_pose is None else _group_residual(sample),
        reversal_defect=_reversal_defect(sample),
        largest_step_angle=_largest_angle(sample) if discrete else None,
        outcome=orbit.outcome,
        work=float(work[-1]) if orbit.system.forces is not None else None,
    )


def _largest_angle(orbit: Orbit) -> float:
    group = orbit.system.group
    if orbit.system.is_wide:
        turning = len(cast(NormalForm, orbit.system.normal_form).coupling)
        y = orbit.canonical_chart[:, :turning]  # tan of half the angle, in planes through one axis
        return float(np.degrees(2 * np.arctan(np.linalg.norm(y, axis=1)).max()))
    return float(np.degrees(group.angle(group.log(orbit.displacement)).max()))


def _group_residual(orbit: Orbit) -> float:
    group, pose = orbit.system.group, orbit.canonical_pose
    decoded = group.residual(orbit.configuration).max()
    return float(max(decoded, np.abs(pose - group.normalize_pose(pose)).max()))


def _reversal_defect(orbit: Orbit) -> float | None:
    motion = orbit.motion
    route = motion.route.compiled if isinstance(motion, Discretization) and motion.forces is None else None
    if route is None:
        return None
    moving = np.abs(orbit.canonical_chart).sum(axis=1) > 0
    defects = reversal_defects(route, orbit.chosen(moving))
    return float(np.max(defects, initial=0.0, where=~np.isnan(defects)))
