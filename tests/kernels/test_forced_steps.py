"""Compiled runs under forces: the bits of the same steps in plain Python, whole and in pieces."""

import numpy as np
import pytest
from bodies import GENERAL

import nonholo as nh
from nonholo import kernels
from nonholo.kernels._driver import _solve
from nonholo.kernels._forced import add_compensated, kicked, pulled
from nonholo.kernels._substeps import at_rest, charted, prepared, pushed, solved
from nonholo.systems import AbstractSystem

BODIES: dict[str, tuple[AbstractSystem, list[float]]] = {
    "top": (nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), [0.5, -0.3]),
    "sleigh": (nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.3), [0.5, -0.3]),
    "suslov 4": (GENERAL["suslov 4"][0], [0.3, -0.2, 0.4]),
}
STEPS = 24


def _forced(system: AbstractSystem, kind: str) -> nh.Forced:
    rng = np.random.default_rng(4)
    n = system.group.size - bool(np.all(system.group.basis[:, -1] == 0))
    heavy, rub = nh.Gravity(rng.normal(size=n), rng.normal(size=n)), nh.Friction(rng.uniform(0, 1, system.group.dim))
    table = rng.normal(size=(STEPS - 3, system.group.dim))
    return nh.Forced(system, heavy, {"weight": None, "friction": rub, "table": table}[kind])


def _kicked(kick: kernels.Kick, row: int, half: int, m: np.ndarray, pose: np.ndarray) -> np.ndarray:
    """Return momenta after half an impulse, from the numbers of the kick, in plain Python."""
    if len(m) > 2:
        out = np.empty_like(m)
        kicked.py_func(kick, row, half, m, pose, out)
        return out
    kept = m.tolist()
    if len(kick.keep):
        kept = [row[0] * m[0] + row[1] * m[1] for row in kick.keep]
    width = kick.pull.shape[1]
    force = pulled(width, [*np.pad(kick.pull, ((0, 0), (0, 10 - width))).ravel()], *pose)
    rows = kick.rows[row, half] if row < len(kick.rows) else (0.0, 0.0)
    return np.array([total + (f + r) for total, f, r in zip(kept, force, rows, strict=True)])


def _run(forced: kernels.ForcedBody, m: np.ndarray, pose: np.ndarray, steps: int) -> list[tuple[np.ndarray, ...]]:
    """Run the steps one by one with the pieces of a body; return momenta, chart and pose of each node."""
    body, kick = forced
    lost, pose, found = np.zeros_like(m), pose.copy(), []
    y = u = v = at_rest(body)
    for k in range(steps + 1):
        s, w = _kicked(kick, k, 0, m, pose), None
        root, chart, change = y.copy(), np.empty_like(m), np.empty_like(m)
        if len(m) == 2:
            code, *root[:] = _solve(body, *s, *(3 * (y - u) + v))  # type: ignore[misc]
            chart[:] = root
        else:
            w = prepared(body, s, np.ones(1))
            code, chart = solved(body, w, 0, s, 3 * (y - u) + v, pose, root), np.empty(kernels.sizes(body)[1])
            charted(body, s, root, chart)
        assert code == 0
        v, u, y = (u, y, root) if k else (root, root, root)
        found.append((m, chart, pose.copy()))
        if len(m) == 2:
            change[:], pose[:] = kernels.increment(body, *s, *root), kernels.move(body, *root, *pose)
        else:
            pushed(body, w, s, root, change, pose)
        add_compensated(s, lost, change)
        m = _kicked(kick, k, 1, s, pose)
    return found


@pytest.mark.parametrize("kind", ["weight", "friction", "table"])
@pytest.mark.parametrize("name", BODIES)
def test_the_loop_has_the_bits_of_plain_python(name: str, kind: str) -> None:
    """The compiled loop, at once and in pieces, gives the bits of a Python loop over the same half impulses."""
    system, velocity = BODIES[name]
    route = nh.discretize(_forced(system, kind), 0.05).route.compiled
    assert route is not None
    m = route.encode(np.asarray(system.to_canonical(system.restricted_momentum(velocity))))
    pose = route.encode_poses(np.asarray(system.frame_pose))
    wanted = [np.array(column) for column in zip(*_run(route.body, m, pose, STEPS), strict=True)]
    for pieces in ((STEPS,), (1, 7, STEPS - 8)):
        code, state = kernels.start(route.body, m, pose)
        assert code == 0
        assert np.array_equal(kernels.chart_of(route.body, state), wanted[1][0])
        found, done = tuple(np.empty((STEPS, width)) for width in route.sizes), 0
        for piece in pieces:
            room = (found[0][done:], found[1][done:], found[2][done:])
            assert kernels.advance(route.body, state, piece, 1, room) == (piece, 0)
            done += piece
        for mine, theirs in zip(found, wanted, strict=True):
            assert np.array_equal(mine, theirs[1:])
