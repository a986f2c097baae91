"""Compiled runs under forces: the bits of the same steps in plain Python, whole and in pieces."""

import mpmath
import numpy as np
import pytest
from bodies import GENERAL

import nonholo as nh
from nonholo import kernels
from nonholo.kernels._composition import at_rest, find_root, prepare, push_and_move, write_chart
from nonholo.kernels._scalar import corrections, residual
from nonholo.kernels.forced._kick import (
    RENEWED,
    _numbers,
    _root,
    apply_arms,
    kicked_two,
    linear,
    pulled_by_weight,
    to_body,
    turn_weight,
)
from nonholo.kernels.forced.run import add_compensated
from nonholo.systems import AbstractSystem

BODIES: dict[str, tuple[AbstractSystem, list[float]]] = {
    "top": (nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), [0.5, -0.3]),
    "sleigh": (nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.3), [0.5, -0.3]),
    "suslov 4": (GENERAL["suslov 4"][0], [0.3, -0.2, 0.4]),
}
STEPS = 70  # past the first renewal of a weight


def _forced(system: AbstractSystem, kind: str) -> nh.Forced:
    rng = np.random.default_rng(4)
    n = system.group.size - bool(np.all(system.group.basis[:, -1] == 0))
    heavy, rub = nh.Gravity(rng.normal(size=n), rng.normal(size=n)), nh.Friction(rng.uniform(0, 1, system.group.dim))
    table = rng.normal(size=(STEPS - 3, system.group.dim))
    force = {"weight": None, "friction": rub, "table": table, "both": (rub, table)}[kind]
    return nh.Forced(system, heavy, force, "variational")


def _kicked(kick: kernels.Kick, row: int, m: np.ndarray, force: np.ndarray) -> np.ndarray:
    """Return momenta after half an impulse, from the numbers of the kick, in plain Python."""
    if len(m) == 2:
        last = kick.rows[min(row, len(kick.rows) - 1)]
        return np.array(kicked_two(_numbers.py_func(kick), *m, *(force + last)))
    out = np.empty_like(m)
    linear(kick, force, row, row, m, out)
    return out


def _run(forced: kernels.ForcedBody, m: np.ndarray, pose: np.ndarray, steps: int) -> list[tuple[np.ndarray, ...]]:
    """Run the steps one by one with the pieces of a body; return momenta, chart and pose of each node."""
    body, kick = forced
    lost, pose, found, force = np.zeros_like(m), pose.copy(), [], np.empty_like(m)
    y = u = v = t = at_rest(body)
    n, _, F, L, _ = _numbers.py_func(kick) if len(m) == 2 else (0, False, (), (), ())
    weight = to_body(n, F, *pose) if len(m) == 2 else ()
    force[:] = apply_arms(L, *weight) if len(m) == 2 else 0.0
    for k in range(steps + 1):
        if len(m) > 2:
            pulled_by_weight(kick, force, pose)
        s, w = _kicked(kick, k, m, force), None
        guess = 4 * (y + v) - (6 * u + t) if n else 3 * (y - u) + v
        root, chart, change = y.copy(), np.empty_like(m), np.empty_like(m)
        if len(m) == 2:
            code, *root[:] = _root.py_func(body, n > 0, *s, *guess)  # type: ignore[misc]
            chart[:] = root
        else:
            w = prepare(body, s, np.ones(1))
            code, chart = find_root(body, w, 0, s, guess, pose, root), np.empty(kernels.sizes(body)[1])
            write_chart(body, s, root, chart)
        assert code == 0
        t, v, u, y = (v, u, y, root) if k else (root, root, root, root)
        found.append((m, chart, pose.copy()))
        if len(m) == 2:
            *force[:], weight = turn_weight(n, L, *root, weight)
            change[:], pose[:] = kernels.increment(body, *s, *root), kernels.move(body, *root, *pose)
            if n and (k + 1) % RENEWED == 0:
                weight = to_body(n, F, *pose)
        else:
            push_and_move(body, w, s, root, change, pose)
            pulled_by_weight(kick, force, pose)
        add_compensated(s, lost, change)
        m = _kicked(kick, k, s, force)
    return found


def test_weights_seen_from_the_body_are_those_of_matrices() -> None:
    """Of quaternions and headings of every size of turn the weight is R^T F, and after a displacement W^T R^T F."""
    rng, F = np.random.default_rng(9), (0.3, -0.7, 1.1)
    for y in [*rng.normal(size=(20, 2)), *(10.0 ** rng.uniform(-200, 4, (9, 2))), np.zeros(2), np.array([1.0, 0.0])]:
        for group, n in ((nh.SO(3), 3), (nh.SE(2), 2)):
            pose = np.pad(group.pose_from_matrix(group.random(rng)), (0, 4 - group.pose_size))
            body = nh.discretize(BODIES["top" if n == 3 else "sleigh"][0], 0.1).route.compiled_route.body  # type: ignore[union-attr]
            here = to_body(n, F, *pose)
            R, after = (
                group.matrix_from_pose(q[: group.pose_size])[:n, :n]
                for q in (pose, np.array(kernels.move(body, *y, *pose)))
            )
            assert np.abs(here[:n] - R.T @ F[:n]).max() < 1e-15
            assert np.abs(turn_weight(n, np.ones(6), *y, here)[2][:n] - after.T @ F[:n]).max() < 2e-15


@pytest.mark.parametrize("kind", ["weight", "friction", "table", "both"])
@pytest.mark.parametrize("name", BODIES)
def test_the_loop_has_the_bits_of_plain_python(name: str, kind: str) -> None:
    """The compiled loop, at once and in pieces, gives the bits of a Python loop over the same half impulses."""
    system, velocity = BODIES[name]
    route = nh.discretize(_forced(system, kind), 0.05).route.compiled_route
    assert route is not None
    m = route.encode(np.asarray(system.to_canonical(system.restricted_momentum(velocity))))
    pose = route.encode_poses(np.asarray(system.frame_pose))
    wanted = [np.array(column) for column in zip(*_run(route.body, m, pose, STEPS), strict=True)]
    for pieces in ((STEPS,), (1, 7, RENEWED - 9, STEPS - RENEWED + 1)):
        code, state = kernels.runs_of(route.body).start(route.body, m, pose)
        assert code == 0
        assert np.array_equal(kernels.runs_of(route.body).chart_of(route.body, state), wanted[1][0])
        found, done = tuple(np.empty((STEPS, width)) for width in route.sizes), 0
        for piece in pieces:
            room = (found[0][done:], found[1][done:], found[2][done:])
            assert kernels.runs_of(route.body).advance(route.body, state, piece, 1, room) == (piece, 0)
            done += piece
        for mine, theirs in zip(found, wanted, strict=True):
            assert np.array_equal(mine, theirs[1:])


@pytest.mark.parametrize("name", ["top", "sleigh"])
def test_the_second_correction_leaves_an_error_of_third_order(name: str) -> None:
    """Two corrections of one slope leave residuals that fall by 1000 with a guess ten times as near, one by 100."""
    system, velocity = BODIES[name]
    route = nh.discretize(system, 0.4).route.compiled_route
    assert route is not None
    m = route.encode(np.asarray(system.to_canonical(system.restricted_momentum(velocity))))
    _, state = kernels.runs_of(route.body).start(route.body, m, route.encode_poses(np.asarray(system.frame_pose)))
    root, left = kernels.runs_of(route.body).chart_of(route.body, state), []
    for off in (1e-2, 1e-3):
        guess = root + off * np.array([0.6, -0.8])
        found = np.reshape(corrections(route.body, *m, *guess), (2, 2))
        assert np.array_equal(found[0], kernels.correction(route.body, *m, *guess))
        left.append([np.abs(residual(route.body, *m, *y)).max() for y in guess + np.cumsum(found, axis=0)])
    assert np.log10(left[0][0] / left[1][0]) == pytest.approx(2, abs=0.1)
    assert np.log10(left[0][1] / left[1][1]) == pytest.approx(3, abs=0.1)


@pytest.mark.parametrize("stiffness", [1e-6, 0.3, 40.0, 3000.0])
def test_friction_of_two_momenta_is_an_exponential(stiffness: float) -> None:
    """What friction leaves and what forces add are those of exponentials with 40 digits, also on stiff problems."""
    rng = np.random.default_rng(8)
    for name in ("top", "sleigh"):
        body = nh.discretize(BODIES[name][0], 0.1).route.compiled_route.body  # type: ignore[union-attr]
        K, skew = rng.normal(size=(2, 2)), np.array([[0.0, 0.3], [-0.3, 0.0]])
        C, (b11, b12, b22) = stiffness * (K @ K.T + skew), kernels.inertia(body)
        with mpmath.workdps(40 + int(stiffness)):  # the exponential is below that of its terms
            D = mpmath.matrix(C.tolist()) * mpmath.matrix([[b11, b12], [b12, b22]]) ** -1
            wanted = mpmath.expm(-0.7 * D)
            push = D**-1 * (mpmath.eye(2) - wanted)
        left, pushed = (np.reshape(X, (2, 2)) for X in kernels.friction_flow(body, C.ravel().tolist(), 0.7))
        scale = 1 + 0.7 * stiffness  # of the condition of an exponential
        np.testing.assert_allclose(left, np.array(wanted.tolist(), float), rtol=0, atol=4e-16 * scale)
        np.testing.assert_allclose(pushed, np.array(push.tolist(), float), rtol=2e-15 * scale)
