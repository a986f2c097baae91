"""The start of a recorded motion, nearly: a pose and a velocity from the first numbers that were measured."""

import numpy as np

from nonholo.analysis.inverse._measurements import WHERE
from nonholo.base.checks import error
from nonholo.groups import SE, SO
from nonholo.systems import System

_ENOUGH = 12  # rows, of which a few may be outliers
_NEAR = 5  # nodes between the poses that a first velocity is taken from


def first(system: System, h: float, kinds: dict[str, np.ndarray], *, is_robust: bool) -> tuple[np.ndarray, np.ndarray]:
    """Return a first pose and a first start: velocity along the constraint, and what is fitted of the change of pose.

    Positions see all of a pose, turns alone its turn, angular velocities nothing of it. Outliers do not count
    if they are to be borne.
    """
    group, S = system.group, system.constraint_subspace
    is_seen = {kind: bool(np.isfinite(rows).any()) for kind, rows in kinds.items()}
    poses = {
        kind: measured_rows(kind, kinds[kind], is_robust, is_angle=kinds[kind].shape[1] == 1)
        for kind in ("position", "turn")
        if is_seen.get(kind)
    }
    if not poses:
        rate = kinds["rate"]
        whole = rate[np.isfinite(rate).all(axis=1)][:1].ravel()
        return group.identity, np.linalg.lstsq(S[:, : len(whole)].T, whole)[0]
    if "turn" not in poses and group != SE(2):
        raise error(WHERE, "have turns beside positions in space", "positions", "Measure turns, such as quaternions.")
    begin, end = ends = ends_of(poses)
    g = _matrices(system, {kind: at_nodes(ends, *rows) for kind, rows in poses.items()}, poses, ends)
    velocity = group.log(group.inverse(g[0]) @ g[1]) / ((end - begin) * h)
    unseen = 0 if "position" in poses else kinds.get("position", np.zeros((0, 0))).shape[1]
    start = np.concatenate([np.linalg.lstsq(S.T, velocity)[0], np.zeros(group.dim - unseen)])
    return g[0] @ group.exp(-velocity * begin * h), start


def ends_of(known: dict[str, tuple[np.ndarray, np.ndarray]]) -> tuple[int, int]:
    """Return two nodes between which all that is measured moves clearly, the first where all of it is known."""
    begin = max(int(nodes[0]) for nodes, _ in known.values())
    after = max(int(nodes[nodes > begin][:1].sum()) for nodes, _ in known.values())
    return begin, max(after, begin + _NEAR)


def measured_rows(kind: str, rows: np.ndarray, is_robust: bool, *, is_angle: bool) -> tuple[np.ndarray, np.ndarray]:
    """Return the nodes where a kind is measured whole, and what was measured without jumps of angles and signs."""
    nodes = np.flatnonzero(np.isfinite(rows).all(axis=1))
    if len(nodes) < 2:
        remedy = "Leave the columns out that hold so little."
        raise error(WHERE, f"have two whole {kind}s in each trial", f"{len(nodes)}", remedy)
    found = rows[nodes]
    if found.shape[1] == 4:  # a quaternion, up to its sign
        found[1:] *= np.cumprod(np.where(np.sum(found[1:] * found[:-1], axis=1) < 0, -1.0, 1.0))[:, None]
    found = np.unwrap(found, axis=0) if is_angle else found
    return nodes, _straight(nodes, found, is_angle) if is_robust and len(found) >= _ENOUGH else found


def _straight(nodes: np.ndarray, rows: np.ndarray, is_angle: bool) -> np.ndarray:
    """Return rows of which the first dozen lie on straight lines by Theil and Sen, which bear a quarter of outliers."""
    times, some, (i, j) = nodes[:_ENOUGH], rows[:_ENOUGH], np.triu_indices(_ENOUGH, 1)
    if is_angle:  # headings, which an outlier of half a turn may have shifted by a whole one
        middle = np.angle(np.exp(1j * some).sum())
        some = middle + np.angle(np.exp(1j * (some - middle)))
    slope = np.median((some[j] - some[i]) / (times[j] - times[i])[:, None], axis=0)
    middle = np.median(some - slope * times[:, None], axis=0)
    return np.concatenate([middle + slope * times[:, None], rows[_ENOUGH:]])


def at_nodes(where: tuple[int, ...], nodes: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Return what is measured at some nodes, on straight lines between those where it is."""
    return np.stack([np.interp(where, nodes, column) for column in rows.T], axis=1)


def _matrices(system: System, at: dict[str, np.ndarray], poses: dict, ends: tuple[int, int]) -> np.ndarray:
    """Return two poses as matrices; where no turn is measured, a body that moves forward along its blade."""
    group, S = system.group, system.constraint_subspace
    g = np.broadcast_to(group.identity, (2, group.size, group.size)).copy()
    if "position" in at:
        g[:, :-1, -1] = at["position"]
    turn = at.get("turn")
    if turn is None:
        later = at_nodes((ends[1], 2 * ends[1] - ends[0]), *poses["position"])
        x, y = np.stack([np.diff(at["position"], axis=0)[0], np.diff(later, axis=0)[0]]).T
        blade = np.linalg.svd(S[:, :1].T)[2][-1] @ S  # a velocity without rotation
        turn = np.unwrap(np.arctan2(y, x) - np.arctan2(*(blade[:0:-1] * np.sign(blade[1] or 1.0))))[:, None]
    if turn.shape[1] == 1:
        return g @ SE(2).exp(np.pad(turn, ((0, 0), (0, 2))))
    g[:, :3, :3] = SO(3).matrix_from_pose(SO(3).normalize_pose(turn))
    return g
