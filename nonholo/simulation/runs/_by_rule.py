"""Runs of tops and sleighs by a branch rule other than the principal one, in NumPy."""

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from nonholo._progress import progress_bar
from nonholo._results import Outcome
from nonholo.discrete import AbstractBranchRule, Discretization, Frame, Place, first_place, frame_of, next_place

Rows: TypeAlias = tuple[np.ndarray, np.ndarray, np.ndarray | None]
Run: TypeAlias = Callable[..., tuple[Rows, Outcome, int]]


def run_by_rule(
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
