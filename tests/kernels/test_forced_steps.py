"""Compiled runs under forces: the bits of the same steps in plain Python, whole and in pieces."""

import mpmath
import numpy as np
import pytest

import nonholo as nh
from nonholo import kernels
from nonholo.kernels._scalar import corrections, residual
from nonholo.kernels.forced._kick import to_body, turn_weight
from nonholo.systems import AbstractSystem

BODIES: dict[str, tuple[AbstractSystem, list[float]]] = {
    "top": (nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), [0.5, -0.3]),
    "sleigh": (nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.3), [0.5, -0.3]),
}


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
        result = np.reshape(corrections(route.body, *m, *guess), (2, 2))
        assert np.array_equal(result[0], kernels.correction(route.body, *m, *guess))
        left.append([np.abs(residual(route.body, *m, *y)).max() for y in guess + np.cumsum(result, axis=0)])
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
