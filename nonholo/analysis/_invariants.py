"""Quantities that a motion keeps: measured along an orbit, and the linear integrals that a system has.

The integrals follow from linear algebra on the quadratic terms of the equations; no motion is computed.
"""

import dataclasses
from typing import Any, cast

import numpy as np

from nonholo.base.checks import error, instance
from nonholo.base.results import Outcome, as_table, result
from nonholo.base.types import Float
from nonholo.discrete import Discretization, reversal_defects
from nonholo.orbit import AbstractOrbit, Orbit, any_orbit
from nonholo.systems import AbstractSystem, NormalForm, gyroscopic_form, null_space, refuse_forces, row_space

_SAMPLED = 100_000  # states on which the matrix residuals are measured, spread evenly; the energy uses all
_MOST_ENTRIES = 1_000_000  # of displacements of arrowheads, whose logarithms are taken
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
        work: The total work of forces and drives, less the dissipation by friction; None of a free
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
    __repr__ = as_table


def invariants(orbit: AbstractOrbit) -> Invariants:
    """Measure the errors of an orbit in its invariants.

    Returns:
        `Invariants`, with the fields `states`, `steps`, `energy_drift` (relative), `constraint_residual`,
        `group_residual`, `reversal_defect`, `largest_step_angle` (in degrees), `outcome`, `work`: the last five None
        where they are not defined. `help(type(nh.invariants(orbit)))` describes each of them.

    Raises:
        ValueError: The orbit has no states.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
        >>> orbit = nh.simulate(sleigh, body_velocity=(1, 0, 0), steps=100)
        >>> invariants(orbit).energy_drift < 1e-14
        True
    """
    if len(any_orbit(where := "invariants(orbit=...)", orbit)) == 0:
        raise error(where, "have at least one state", str(orbit), "Its outcome gives the reason.")
    driven = orbit.system.forces is not None if isinstance(orbit, Orbit) else orbit.system.is_driven
    energy, work, steps = orbit.energy, orbit.known_work, int(np.ptp(orbit.step)) if orbit.is_discrete else 0
    size = np.abs(energy if driven else energy[0]).max() or 1.0
    drift = float(np.abs(energy - energy[0] - work).max() / size)
    rest = _of_body(orbit) if isinstance(orbit, Orbit) else _in_coordinates(orbit)
    return Invariants(len(orbit), steps, drift, *rest, orbit.outcome, float(work[-1]) if driven else None)


def _in_coordinates(orbit: Any) -> tuple[float, float | None, None, None]:
    """Return the residuals of constraint and group; defect and angle are not measured."""
    off_group = None if orbit.coordinates else float(np.max(orbit.space.residual(orbit.configuration)))
    return float(orbit.constraint_residual.max()), off_group, None, None


def _of_body(orbit: Orbit) -> tuple[float, float | None, float | None, float | None]:
    """Return the residuals of constraint and group, the reversal defect and the largest angle of a step."""
    stride = max(1, len(orbit) // (_SAMPLED if orbit.system.group.dim == 3 else _SAMPLED_LARGE))
    sample = orbit[::stride] if stride > 1 else orbit
    residual = float(np.abs(orbit.motion.constraint_residual(sample)).max(initial=0.0))
    off_group = None if orbit.canonical_pose is None else _group_residual(sample)
    angle = None if orbit.cayley is None else _largest_angle(sample)
    return residual, off_group, _reversal_defect(sample), angle


def _largest_angle(orbit: Orbit) -> float | None:
    """Return the largest angle of a step; None of many large steps that are no turns in planes through one axis."""
    system, y, motion = orbit.system, orbit.canonical_chart, orbit.motion
    if isinstance(motion, Discretization) and motion.order == 2:
        turning = len(cast(NormalForm, system.normal_form).coupling) if system.is_wide else 0
        angles = 2 * np.arctan(np.linalg.norm(y[:, :turning], axis=1)) if turning else motion.variety.angle(y)
    elif system.is_wide and len(y) * system.group.size**2 > _MOST_ENTRIES:
        return None
    else:
        angles = system.group.angle(system.group.log(orbit.displacement))
    return float(np.degrees(angles.max()))


def _group_residual(orbit: Orbit) -> float:
    """Return the largest change that normalizing makes in a pose, and the residual of those that are matrices."""
    group, pose = orbit.system.group, orbit.canonical_pose
    change = np.abs(pose - group.normalize_pose(pose)).max()
    return float(change if group.pose_size < group.size**2 else max(change, group.residual(orbit.configuration).max()))


def _reversal_defect(orbit: Orbit) -> float | None:
    """Return the largest miss of a step forward and back; None of flows, forced motions and those not compiled."""
    motion: Any = orbit.motion
    is_free = isinstance(motion, Discretization) and motion.forces is None
    route = motion.route.compiled_route if is_free else None
    if route is None:
        return None
    moving = np.asarray(orbit.canonical_chart.any(axis=1))
    defects = reversal_defects(route, orbit if moving.all() else orbit.chosen(moving))
    return float(np.fmax.reduce(defects, initial=0.0))  # without NaN


_RANK = 1e-11  # relative size below which a rate of change counts as zero


@result
class ConservedMomenta:
    r"""The linear integrals of a system.

    Attributes:
        body: Orthonormal rows x with $\langle p, x\rangle$ constant, p the body momentum; shape (m, dim). For an LL
            system x lies in the constraint subspace.
        spatial: Orthonormal rows $\eta$ with $\langle\mu, \eta\rangle$ constant, $\mu = \mathrm{Ad}^*_{g^{-1}}p$ the
            spatial momentum; shape (m', dim).
    """

    body: Float[np.ndarray, "m dim"]
    spatial: Float[np.ndarray, "mm dim"]


def conserved_momenta(system: AbstractSystem) -> ConservedMomenta:
    r"""Return the components of body and spatial momentum that every motion of a system conserves.

    With the reaction $\rho = \sum_j\lambda_j a^j$, a quadratic function of the velocity, an LL system has

    $$ \langle p, x\rangle^{\textstyle\cdot} = \langle\mathbb{I}\omega, [\omega, x]\rangle \quad (x \in \mathfrak{d}),
       \qquad \langle\mu, \eta\rangle^{\textstyle\cdot} = \langle\rho(\omega), \mathrm{Ad}_{g^{-1}}\eta\rangle. $$

    A body component is conserved if the first form vanishes on $\mathfrak{d}$; components outside $\mathfrak{d}$ add
    nothing, since $p = \mathbb{I}\omega$ is known from its restriction to $\mathfrak{d}$. A spatial one is conserved if
    $\eta$ lies in the largest ideal that the reactions annihilate: the horizontal symmetries, ideals inside
    $\mathfrak{d}$, and those that the body's symmetry adds. For an LR system, with $\dot\mu = \rho(g, \xi)$, the
    conditions are imposed at dim + 1 random configurations (a fixed seed), which decides them with probability one;
    the spatial components always contain $\mathfrak{d}$.

    The lists are complete for connected groups: a linear function of p or of $\mu$ that is not in their span changes
    along some motion. A discrete map keeps the spatial components along ideals inside $\mathfrak{d}$, for every
    Lagrangian. That it keeps the others is not implied.

    Args:
        system: An LL or LR system with concrete numbers.

    Raises:
        ValueError: `system` is not a system.

    Example:
        A balanced top keeps its momenta along the constraint; the sleigh keeps nothing.

        >>> conserved_momenta(nh.SuslovTop(np.diag([1.0, 2.0, 3.0]))).body
        array([[1., 0., 0.],
               [0., 1., 0.]])
        >>> conserved_momenta(nh.ChaplyginSleigh(1.0, 1.0, 0.5)).body.shape
        (0, 3)
    """
    remedy = "Pass a SuslovTop, an LLSystem, ..."
    instance("conserved_momenta(system=...)", system, AbstractSystem, "be a system on a group", remedy)
    refuse_forces("conserved_momenta(system=...)", system)
    # in units of displacements, with orthonormal rows along the constraint
    group, units, rng = system.group, system.displacement_units, np.random.default_rng(0)
    rows, inertia = _span(system.constraint_subspace / units), system.inertia_operator * units * units[:, None]
    brackets, largest = _brackets(system, rows, np.eye(group.dim)), np.abs(inertia).max()
    if not system.is_spatial:
        form = gyroscopic_form(inertia, _brackets(system, rows, rows), rows)
        body = _vanishing(form.reshape(len(rows) ** 2, len(rows)), largest) @ rows
        spatial = _largest_ideal(system, _vanishing(_reactions(inertia, rows, brackets), largest))
        return ConservedMomenta(_span(body * units), _span(spatial * units))
    rates, reactions = [], []
    for _ in range(group.dim + 1):
        back = group.adjoint(group.exp(units * rng.normal(size=group.dim))) * units / units[:, None]
        spatial = back.T @ inertia @ back
        reactions.append(_reactions(spatial, rows, brackets))
        gyroscopic = gyroscopic_form(spatial, brackets, rows).reshape(-1, group.dim)
        rates.append((gyroscopic + reactions[-1]) @ np.linalg.inv(back))
    both = (_vanishing(np.concatenate(part), largest) for part in (rates, reactions))
    return ConservedMomenta(*(_span(rows * units) for rows in both))


def _brackets(system: AbstractSystem, x: np.ndarray, y: np.ndarray) -> Float[np.ndarray, "i j dim"]:
    """Return the brackets of rows in units of displacements."""
    units = system.displacement_units
    return system.group.bracket((x * units)[:, None, :], (y * units)[None, :, :]) / units


def _largest_ideal(system: AbstractSystem, subspace: Float[np.ndarray, "m dim"]) -> Float[np.ndarray, "n dim"]:
    """Return the largest subspace of the given one that all brackets map to itself."""
    while len(subspace):
        escape = _brackets(system, subspace, np.eye(system.group.dim)) @ null_space(subspace).T
        smaller = _vanishing(escape.reshape(len(subspace), -1).T, 1.0) @ subspace
        if len(smaller) == len(subspace):
            break
        subspace = smaller
    return subspace


def _reactions(
    inertia: Float[np.ndarray, "dim dim"], rows: Float[np.ndarray, "k dim"], brackets: Float[np.ndarray, "k dim dim"]
) -> Float[np.ndarray, "kk dim"]:
    r"""Return covectors that span the reactions.

    They are $\mathbb{I}S^T(S\mathbb{I}S^T)^{-1}S\tau - \tau$ with $\tau = \mathrm{ad}^*_\omega p$, also in space for
    an LR system, where the inertia is that of the turned body.
    """
    torque = gyroscopic_form(inertia, brackets, rows).reshape(-1, len(inertia))
    along = rows @ inertia
    return torque @ rows.T @ np.linalg.solve(along @ rows.T, along) - torque


def _vanishing(conditions: Float[np.ndarray, "c m"], scale: float) -> Float[np.ndarray, "n m"]:
    """Return orthonormal rows on which the conditions vanish; entries that are small beside `scale` count as zero."""
    return null_space(np.where(np.abs(conditions) > _RANK * scale, conditions / scale, 0.0), _RANK)


def _span(rows: Float[np.ndarray, "n dim"]) -> Float[np.ndarray, "n dim"]:
    """Return orthonormal rows that span what independent ones do, whose sizes may differ by any factor."""
    return row_space(rows / np.linalg.norm(rows, axis=1, keepdims=True), 0.0)
