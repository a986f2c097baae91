"""Built-in reductions: what a sweep keeps of each member of an ensemble."""

import dataclasses
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from nonholo.analysis import turn_of_flow
from nonholo.analysis.planar import blade_axes
from nonholo.base.checks import error, shown
from nonholo.base.numerics import applied
from nonholo.base.results import Outcome
from nonholo.base.types import Float
from nonholo.discrete import refuse_composition, step_jacobians
from nonholo.discrete.branching import displacements_over, frame_of
from nonholo.groups import components_of
from nonholo.io.datasets import compact_names
from nonholo.simulation import Ensemble, ScalarMembers, in_lanes, tangents
from nonholo.systems import AbstractSystem

Reduced = dict[str, tuple[tuple[str, ...], np.ndarray, dict[str, Any]]]
_MOST = 100  # components that have names


class Reduction(NamedTuple):
    """A reduction, and whether it needs every state of a system."""

    function: Callable[[Ensemble], Reduced]
    needs_all: Callable[[AbstractSystem], bool] = lambda _: False


def _final_state(batch: Ensemble) -> Reduced:
    last, system = last_states(batch), batch.members.discrete.system
    momentum = _labels("restricted momentum") | _names(_names_along(system))
    results: Reduced = {
        "final_time": ((), last.time[:, 0], _labels("time of the last good state", "time unit")),
        "final_momentum": (("component",), last.restricted_momentum[:, 0], momentum),
        "final_energy": ((), last.energy[:, 0], _labels("reduced constrained energy")),
        "steps_done": ((), batch.steps_done, _labels("good steps", "1")),
    }
    if (pose := last.pose) is not None:
        labels = _labels("compact pose") | _names(compact_names(system.group))
        results["final_pose"] = ("pose_component",), pose[:, 0], labels
    return results


def _names_along(system: AbstractSystem) -> list[str]:
    """Return the names of the rows of the constraint subspace; none unless each is along an axis or against it."""
    if system.group.dim > _MOST:
        return []
    names, rows = components_of(system.group), np.asarray(system.constraint_subspace)
    both = [*names, *(f"minus_{name}" for name in names)]
    is_axis = (rows[:, None] == np.concatenate([np.eye(len(names)), -np.eye(len(names))])).all(axis=2)
    return [both[place] for place in is_axis.argmax(axis=1)] if is_axis.any(axis=1).all() else []


def _names(components: list[str]) -> dict[str, Any]:
    return {"components": components} if 0 < len(components) <= _MOST else {}


def _energy_drift(batch: Ensemble) -> Reduced:
    first, last = batch.first_energy, last_states(batch).energy[:, 0]
    with np.errstate(invalid="ignore"):  # 0/0 at rest, where energy cannot drift
        drift = np.where(last == first, 0.0, np.abs((last - first) / first))
    return {"energy_drift": ((), np.where(np.isfinite(last), drift, np.nan), _labels("relative error of energy", "1"))}


def _is_plane_sleigh(system: AbstractSystem) -> bool:
    return blade_axes(system) is not None


def _limit_angle(batch: Ensemble) -> Reduced:
    if (form := batch.members.discrete.system.normal_form) is None or not in_lanes(batch.members):
        got, remedy = shown(batch.members.discrete), "Write your own reduction."
        raise error("reduction 'limit_angle'", "have a plane sleigh or a top with n = 3", got, remedy)
    if form.is_sleigh:
        return {"heading_turn": ((), _heading_turn(batch), _labels("total turn of the heading", "rad"))}
    return {"axis_angle": ((), _axis_angle(batch), _labels("angle between the axes in space", "rad"))}


def _heading_turn(batch: Ensemble) -> Float[np.ndarray, "M"]:
    """Sum the angles of the steps, which know of full turns: the first chart coordinate is the tangent of the half."""
    angles = 2 * np.arctan(ScalarMembers(batch.members).charts(batch.cayley[:, :-1])[..., 0])
    turn = np.where(np.arange(angles.shape[1]) < batch.steps_done[:, None], angles, 0.0).sum(axis=1)
    return np.where(np.isfinite(batch.reduced_momentum[:, 0, 0]), turn, np.nan)


def _turning_deviation(batch: Ensemble) -> Reduced:
    """Compare the turn of sleighs with that of the flow, to which it tends from below as the time step tends to 0."""
    if not (in_lanes(batch.members) and _is_plane_sleigh(batch.members.discrete.system)):
        got, remedy = shown(batch.members.discrete), "Keep another reduction."
        raise error("reduction 'turning_deviation'", "have a plane sleigh", got, remedy)
    mass, inertia, a = ScalarMembers(batch.members).fields
    with np.errstate(divide="ignore", invalid="ignore"):  # a balanced sleigh turns forever
        part = np.abs(_heading_turn(batch)) / np.where(a == 0, np.nan, turn_of_flow(mass, inertia, a))
    missing = np.where(batch.outcome == Outcome.successful, 1 - part, np.nan)
    return {"turning_deviation": ((), missing, _labels("part of the flow's total turn that is missing", "1"))}


def _axis_angle(batch: Ensemble) -> Float[np.ndarray, "M"]:
    scalar, last = ScalarMembers(batch.members), last_states(batch)
    if last.canonical_pose is None:
        raise error("reduction 'limit_angle'", "have poses", "reconstruct=False", "Leave that out.")
    pose = np.stack([np.broadcast_to(scalar.pose, (len(batch), 4)), last.canonical_pose[:, 0]], axis=1)
    r = np.stack([batch.first_momentum, last.reduced_momentum[:, 0]], axis=1)
    velocity = applied(np.linalg.inv(scalar.inertia), r)
    body = applied(scalar.route.system.canonical.constraint_subspace.T, velocity)
    axes = (batch.members.discrete.system.group.matrix_from_pose(pose) @ body[..., None])[..., 0]
    before, after = axes[:, 0], axes[:, 1]
    return np.arctan2(np.linalg.norm(np.cross(before, after), axis=1), (before * after).sum(axis=1))


def _branch_counts(batch: Ensemble) -> Reduced:
    each = [(batch.members.of(member), r) for member, r in enumerate(batch.first_momentum)]
    counts = np.array([displacements_over(one, one.system.from_canonical(r)).real_count for one, r in each])
    return {"real_branches": ((), counts, _labels("real values of the map over the first momentum", "1"))}


def _lyapunov(batch: Ensemble) -> Reduced:
    discrete = batch.members.discrete
    refuse_composition(where := "reduction 'lyapunov'", discrete, "Write your own reduction.")
    frame_of(where, discrete)
    product, growth = _products(_jacobians(batch))
    growth += np.log(np.linalg.norm(product, ord=2, axis=(1, 2)))
    elapsed = batch.steps_done * batch.members.time_step
    with np.errstate(invalid="ignore", divide="ignore"):
        exponent = np.where(elapsed > 0, growth / elapsed, np.nan)
    return {"lyapunov": ((), exponent, _labels("largest finite-time Lyapunov exponent of momenta", "1 / time unit"))}


def _products(slopes: Float[np.ndarray, "M K k k"]) -> tuple[Float[np.ndarray, "M k k"], Float[np.ndarray, "M"]]:
    """Return the products of the steps, of norm one, and the logarithms of their norms; halves are paired again."""
    growth = np.zeros(len(slopes))
    while True:
        norms = np.sqrt((slopes * slopes).sum(axis=(2, 3)))
        slopes, growth = slopes / norms[..., None, None], growth + np.log(norms).sum(axis=1)
        if slopes.shape[1] == 1:
            return slopes[:, 0], growth
        even = slopes.shape[1] // 2 * 2
        slopes = np.concatenate([slopes[:, 1:even:2] @ slopes[:, :even:2], slopes[:, even:]], axis=1)


def _jacobians(batch: Ensemble) -> Float[np.ndarray, "M K k k"]:
    """Return the derivatives of the steps of members, the identity after their end."""
    is_step, k = np.arange(batch.steps) < batch.steps_done[:, None], batch.reduced_momentum.shape[-1]
    if in_lanes(batch.members):
        slopes = tangents(batch.members, batch.reduced_momentum[:, :-1], batch.cayley[:, :-1])
        return np.where(is_step[..., None, None], slopes, np.eye(k))
    slopes = np.broadcast_to(np.eye(k), (*is_step.shape, k, k)).copy()
    for member, count in enumerate(batch.steps_done):
        slopes[member, :count] = step_jacobians(batch.members.of(member), batch.orbit(member)[:count].displacement)
    return slopes


def last_states(batch: Ensemble) -> Ensemble:
    """Return the last good state of each member alone; of one that did not start any row, which is NaN."""
    every, rows = batch.save_every, np.arange(len(batch))
    last = np.zeros_like(rows) if every is None else batch.steps_done // every
    states = {name: column[rows, last][:, None] for name, column in batch.columns.items()}
    step_count = batch.steps_done if every is None else last * every
    return dataclasses.replace(batch, save_every=None, steps_done=step_count, columns=states)


def _labels(meaning: str, units: str = "") -> dict[str, str]:
    return {"long_name": meaning} | ({"units": units} if units else {})


REDUCTIONS = {
    "final_state": Reduction(_final_state),
    "energy_drift": Reduction(_energy_drift),
    "limit_angle": Reduction(_limit_angle, _is_plane_sleigh),
    "turning_deviation": Reduction(_turning_deviation, _is_plane_sleigh),
    "branch_counts": Reduction(_branch_counts),
    "lyapunov": Reduction(_lyapunov, lambda _: True),
}
