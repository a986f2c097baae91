"""Runs by a branch rule other than the principal one: in NumPy for tops and sleighs, by the definition for others."""

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from nonholo._checks import error, shown
from nonholo._progress import progress_bar
from nonholo._results import Outcome
from nonholo.discrete import Discretization
from nonholo.discrete._branch_equations import Frame, frame_of, has_frame
from nonholo.discrete._branch_rules import AbstractBranchRule
from nonholo.discrete._branch_steps import Place, first_place, next_place

Rows: TypeAlias = tuple[np.ndarray, np.ndarray, np.ndarray | None]
Run: TypeAlias = Callable[..., tuple[Rows, Outcome, int]]


def rule_runner(
    discrete: Discretization, rule: AbstractBranchRule, backend: str, demanded: np.ndarray | None
) -> Run:
    """Return the run by a rule, from the displacement or full momentum of the start if one is demanded."""
    if backend == "numba":
        got = f"the branch rule {rule.name!r}"
        raise error("simulate(backend=...)", "be 'auto' or 'jax'", got, "Only 'principal' runs compiled by numba.")
    if has_frame(discrete) and backend == "auto":
        return lambda *arguments: _run(discrete, rule, demanded, *arguments)
    if rule.needs_all_values:
        raise error(
            "simulate(backend=...)", "be 'auto'", f"{shown(backend)} with branch {rule.name!r}", "Leave it out."
        )
    from nonholo.discrete._definition import run_by_definition

    chart = None
    if demanded is not None and demanded.ndim == 2:
        frame = discrete.system.frame
        chart = discrete.variety.coordinates(discrete.system.group.inverse(frame) @ demanded @ frame)
    return lambda *arguments: run_by_definition(discrete, *arguments, nearest=True, chart=chart)


def _run(
    discrete: Discretization,
    rule: AbstractBranchRule,
    demanded: np.ndarray | None,
    reduced: np.ndarray,
    pose: np.ndarray,
    steps: int,
    every: int,
    progress: bool,
) -> tuple[Rows, Outcome, int]:
    frame, group = frame_of("simulate(discrete=...)", discrete), discrete.system.group
    outcome, place = first_place("simulate", discrete, frame, rule, reduced, demanded)
    saved, done = [] if place is None else [_row(frame, place, pose)], 0
    with progress_bar("steps", progress) as report:
        while place is not None and outcome == 0 and done < steps:
            displacement = frame.increment(place.point) + group.identity
            outcome, place = next_place(discrete, frame, rule, place)
            if outcome == 0:
                done += 1
                pose = group.normalize_pose(group.pose_from_matrix(group.matrix_from_pose(pose) @ displacement))
                if done % every == 0:
                    saved.append(_row(frame, place, pose))
                report(done, steps)
    columns = list(zip(*saved, strict=True)) or [(), (), ()]
    momenta, charts = (np.reshape(column, (-1, reduced.size)) for column in columns[:2])
    return (momenta, charts, np.reshape(columns[2], (-1, pose.size))), outcome, done


def _row(frame: Frame, place: Place, pose: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return place.momentum, frame.chart(place.point), pose
