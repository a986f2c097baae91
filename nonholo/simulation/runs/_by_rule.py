"""Runs of tops and sleighs by a branch rule other than the principal one, in NumPy."""

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from nonholo.base.progress import progress_bar
from nonholo.base.results import Outcome
from nonholo.discrete import AbstractBranchRule, Discretization, Place, first_place, frame_of, next_places
from nonholo.groups import AbstractMatrixGroup

Rows: TypeAlias = tuple[np.ndarray, np.ndarray, np.ndarray | None]
Run: TypeAlias = Callable[..., tuple[Rows, Outcome, int]]

_BATCH = 256  # steps between two poses that are freed of their rounding errors


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
    begun = [] if place is None else [(place.momentum[None], frame.chart(place.point)[None], pose[None])]
    saved, done = [(np.empty((0, reduced.size)),) * 2 + (np.empty((0, pose.size)),), *begun], 0
    with progress_bar("steps", progress) as report:
        while place is not None and outcome == 0 and done < steps:
            outcome, ahead = next_places(discrete, frame, rule, place, min(_BATCH, steps - done))
            if not len(ahead.point):
                break
            points = np.concatenate([place.point[None], ahead.point])
            poses = _carried(group, pose, frame.increment(points[:-1]) + group.identity)
            kept = slice(every - 1 - done % every, None, every)
            saved.append((ahead.momentum[kept], frame.chart(ahead.point[kept]), poses[kept]))
            done, place, pose = done + len(poses), Place(points[-1], ahead.momentum[-1]), poses[-1]
            report(done, steps)
    momenta, charts, rows = map(np.concatenate, zip(*saved, strict=True))
    return (momenta, charts, rows), outcome, done


def _carried(group: AbstractMatrixGroup, pose: np.ndarray, displacements: np.ndarray) -> np.ndarray:
    """Return the poses after displacements, one after another."""
    g, matrices = group.matrix_from_pose(pose), np.empty_like(displacements)
    for step, W in enumerate(displacements):
        g = matrices[step] = g @ W
    return group.normalize_pose(group.pose_from_matrix(matrices))
