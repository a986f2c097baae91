"""Ensembles of flows: each member is the flow of its start and parameters, whoever runs beside it."""

import numpy as np
import pytest
from bodies import mass_tensor
from comparisons import assert_member, assert_same
from refusals import refusals

import nonholo as nh
from nonholo.systems import AbstractSystem

RNG = np.random.default_rng(8)
TIMES = np.array([0.0, 0.3, 7.0, 20.0])
TOP = nh.SuslovTop.from_inertia(np.diag([3.0, 2.0, 2.5]) + 0.1, (2 / 3, -1 / 3, 2 / 3))
SLEIGH = nh.ChaplyginSleigh(1.0, 0.75, 0.5, 0.3)
SYSTEMS: dict[str, AbstractSystem] = {
    "top": TOP,
    "sleigh": SLEIGH,
    "top on SO(4)": nh.SuslovTop(mass_tensor(nh.SO(4), RNG)),
    "top on SO(7), matrices": nh.SuslovTop(mass_tensor(nh.SO(7), RNG)),
    "general on SE(3)": nh.LLSystem(nh.SE(3), mass_tensor(nh.SE(3), RNG), RNG.normal(size=(3, 6))),
    "right-invariant": nh.VeselovaTop(np.diag([1.0, 2.0, 3.0])),
    "right-invariant in the plane": nh.LRSystem(nh.SE(2), mass_tensor(nh.SE(2), RNG), [[1, 0.2, 0], [0, 1, 0.3]]),
}


TENSORS = {n: np.stack([mass_tensor(nh.SO(n), RNG) for _ in range(7)]) for n in (3, 4)}
OPERATORS = np.stack([A @ A.T + np.eye(6) for A in RNG.normal(size=(7, 6, 6))])
ROWS = RNG.normal(size=(3, 6))
OWN: dict[str, tuple[AbstractSystem, dict[str, np.ndarray]]] = {
    "top": (nh.SuslovTop(TENSORS[3][0]), {"mass_tensor": TENSORS[3]}),
    "top with an axis": (TOP, {"mass_tensor": TENSORS[3]}),
    "sleighs": (SLEIGH, {"mass": RNG.uniform(1, 2, 7), "a": [0.0, *RNG.normal(size=6)], "b": RNG.normal(size=7)}),
    "top on SO(4)": (SYSTEMS["top on SO(4)"], {"mass_tensor": TENSORS[4]}),
    "free bodies": (nh.RigidBody(TENSORS[3][0]), {"mass_tensor": TENSORS[3]}),
    "any tensor": (nh.LLSystem(nh.SO(4), TENSORS[4][0], ROWS), {"mass_tensor": TENSORS[4]}),
    "any operator": (nh.LLSystem(nh.SE(3), None, ROWS, inertia_operator=OPERATORS[0]), {"inertia_operator": OPERATORS}),
    "sleigh on SE(3)": (nh.MultidimensionalSleigh(1.0, np.ones(3), TENSORS[3][0]), {"mass": RNG.uniform(1, 2, 7)}),
    "arrowhead": (nh.SuslovTop.arrowhead(np.arange(1.0, 5.0), np.ones(3)), {"coupling": RNG.normal(size=(7, 3))}),
    "right-invariant": (SYSTEMS["right-invariant"], {"mass_tensor": TENSORS[3]}),
    "sleighs that rub": (nh.Forced(SLEIGH, force=nh.Friction(0.1 * np.eye(3))), {"a": RNG.normal(size=7)}),
}


def _assert_same(member: nh.Orbit, alone: nh.Orbit) -> None:
    names = ("reduced_momentum", "canonical_pose", "turned")
    assert_same(member, alone, *(name for name in names if getattr(alone, name) is not None))


@pytest.mark.profile("routes", cases=["general*-False", "top on SO(7)*", "* plane-True"])
@pytest.mark.parametrize("backward", [False, True])
@pytest.mark.parametrize("name", SYSTEMS)
def test_members_are_flows(name: str, backward: bool) -> None:
    """More members than lanes, at rest and fast, have the bits of flows alone, from any poses and without them."""
    system, times = SYSTEMS[name], TIMES[::-1] if backward else TIMES
    w = np.random.default_rng(1).normal(size=(19, system.rank)) * np.geomspace(1e-3, 3.0, 19)[:, None]
    w[4] = 0.0
    poses = system.group.exp(np.random.default_rng(9).normal(size=(19, system.group.dim)))
    batch = nh.ensemble(system, restricted_velocity=w, configuration=poses, times=times)
    bare = nh.ensemble(system, restricted_velocity=w[:3], times=times, reconstruct=False)
    assert (batch.outcome == nh.Outcome.successful).all()
    assert bare.canonical_pose is bare.pose is None
    for member, (start, pose) in enumerate(zip(w, poses, strict=True)):
        alone = nh.flow(system, restricted_velocity=start, configuration=pose, times=times)
        _assert_same(batch.orbit(member), alone)
        assert_member(batch, member, alone, "configuration", "momentum", "body_velocity")
        assert batch.first_energy[member] == pytest.approx(alone.energy[0], rel=1e-14)
        if member < 3:
            without = nh.flow(system, restricted_velocity=start, times=times, reconstruct=False)
            assert not bare.orbit(member).has_poses
            _assert_same(bare.orbit(member), without)
    few = nh.ensemble(system, restricted_velocity=w[7:9], configuration=poses[7:9], times=times)
    assert np.array_equal(few.reduced_momentum, batch.reduced_momentum[7:9])
    assert np.array_equal(few.canonical_pose, batch.canonical_pose[7:9])


@pytest.mark.parametrize("name", OWN)
def test_members_with_their_own_parameters(name: str) -> None:
    """Inertias, frames and equations, made for all members in one go, give the bits of flows alone."""
    system, own = OWN[name]
    w = RNG.normal(size=(7, system.rank))
    batch = nh.ensemble(system, restricted_velocity=w, times=(0.0, 2.0), parameters=own)
    for member, velocity in enumerate(w):
        body = batch.members.of(member).system
        assert all(np.array_equal(getattr(body.inside, field), values[member]) for field, values in own.items())
        alone = nh.flow(body, restricted_velocity=velocity, times=(0.0, 2.0))
        _assert_same(batch.orbit(member), alone)
        wanted = alone.energy if system.is_forced else alone.energy[0]
        assert np.abs(batch.energy[member] / wanted - 1).max() < 1e-14
        if name == "sleighs":
            assert np.abs(batch.heading[member] - alone.heading).max() < 1e-12


def test_a_member_that_cannot_go_on_has_no_later_states() -> None:
    """The others are not disturbed."""
    w = [[0.4, 0.9], [1e140, 2e140], [0.3, -0.2]]
    batch = nh.ensemble(TOP, restricted_velocity=w, times=(0.0, 1e-141, 1.0))
    assert batch.outcome.tolist() == [nh.Outcome.successful, nh.Outcome.not_converged, nh.Outcome.successful]
    assert batch.steps_done.tolist() == [2, 1, 2]
    assert np.isnan(batch.reduced_momentum[1, 2]).all()
    assert np.isfinite(batch.reduced_momentum[::2]).all()
    assert len(batch.orbit(1)) == 2
    with pytest.raises(ValueError, match="discrete orbit"):
        _ = batch.displacement


# Before any work, by name.
test_refused_arguments = refusals(
    ({"steps": np.array([5, 6])}, r"ensemble\(steps=...\)` must be left out for a flow"),
    ({"steps": 5}, r"ensemble\(steps=...\)` must be left out for a flow"),
    ({"save_every": 1}, r"ensemble\(save_every=...\)` must be left out"),
    ({"backend": "jax"}, r"ensemble\(backend=...\)` must be left out"),
    ({"events": [nh.cusp]}, r"ensemble\(events=...\)` must be left out"),
    ({"branch": "nearest"}, r"ensemble\(branch=...\)` must be left out"),
    ({"times": None}, r"flow\(times=...\)"),
    ({"times": (1.0, 1.0)}, r"flow\(times=...\)"),
    ({"rtol": 1e-16}, r"flow\(rtol=...\)"),
    ({"parameters": {"time_step": [0.1, 0.2]}}, "A flow has no time step"),
    ({"parameters": {"mass": [1.0, 2.0, 3.0]}}, "one value for each member"),
    ({"parameters": {"mass": [1.0, -2.0]}}, "This is member 1"),
    ({"reduce": 3}, "be a function"),
    ({"restricted_velocity": None, "momentum": [[1.0, 1.0, 0.5], [0.0, 0.0, 1.0]]}, "belong to admissible velocities"),
    ({"restricted_velocity": np.ones((10**6, 2)), "times": np.arange(1e6)}, r"ensemble\(times=...\)"),
    ({"discrete": nh.discretize(SLEIGH, 0.1)}, r"ensemble\(times=...\)` must be left out for a discretization"),
    ({"discrete": nh.discretize(SLEIGH, 0.1), "times": None}, r"ensemble\(steps=...\)"),
    ask=lambda x: nh.ensemble(**{"discrete": SLEIGH, "restricted_velocity": np.ones((2, 2)), "times": (0.0, 1.0)} | x),
)
