"""Compiled runs under forces: the bits of the same steps in plain Python, whole and in pieces."""

import numpy as np
import pytest
from bodies import GENERAL

import nonholo as nh
from nonholo import kernels
from nonholo.systems import AbstractSystem

BODIES: dict[str, tuple[AbstractSystem, list[float]]] = {
    "top": (nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), [0.5, -0.3]),
    "sleigh": (nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.3), [0.5, -0.3]),
    "suslov 4": (GENERAL["suslov 4"][0], [0.3, -0.2, 0.4]),
    "any d on SE(3)": (GENERAL["any d on SE(3)"][0], [0.3, -0.2, 0.4, 0.1]),
}
STEPS = 24


def _forced(system: AbstractSystem, kind: str) -> nh.Forced:
    rng = np.random.default_rng(4)
    n = system.group.size - bool(np.all(system.group.basis[:, -1] == 0))
    heavy, rub = nh.Gravity(rng.normal(size=n), rng.normal(size=n)), nh.Friction(rng.uniform(0, 1, system.group.dim))
    table = rng.normal(size=(STEPS - 3, system.group.dim))
    return nh.Forced(system, heavy, {"weight": None, "friction": rub, "table": table}[kind])


@pytest.mark.parametrize("kind", ["weight", "friction", "table"])
@pytest.mark.parametrize("name", BODIES)
def test_the_loop_has_the_bits_of_plain_python(name: str, kind: str) -> None:
    """The compiled loop, at once and in pieces, gives the bits of a Python loop over the same half impulses."""
    system, velocity = BODIES[name]
    route = nh.discretize(_forced(system, kind), 0.05).route.compiled
    assert route is not None
    m = route.encode(np.asarray(system.to_canonical(system.restricted_momentum(velocity))))
    pose = route.encode_poses(np.asarray(system.frame_pose))
    rows: list[list[np.ndarray]] = []

    def kick(node: int, step: int, m: np.ndarray, pose: np.ndarray) -> np.ndarray:
        del node
        out = np.empty_like(m)
        kernels.kicked(route.body.kick, step, m, pose, out)
        return out

    kernels.run_by_kicks(route.body.body, kick, m, pose, STEPS, lambda _, *row: rows.append([x.copy() for x in row]))
    wanted = [np.array(column) for column in zip(*rows, strict=True)]
    for pieces in ((STEPS,), (1, 7, STEPS - 8)):
        code, state = kernels.start(route.body, m, pose)
        assert code == 0
        assert np.array_equal(kernels.chart_of(route.body, state), wanted[1][0])
        found = tuple(np.empty((STEPS, width)) for width in route.sizes)
        done = 0
        for piece in pieces:
            room = (found[0][done:], found[1][done:], found[2][done:])
            assert kernels.advance(route.body, state, piece, 1, room) == (piece, 0)
            done += piece
        for mine, theirs in zip(found, wanted, strict=True):
            assert np.array_equal(mine, theirs[1:])
