"""What is too much is refused before work, and nothing is left behind."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import nonholo as nh

TOP = nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 0.1)
SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
WIDE = nh.discretize(nh.SuslovTop.arrowhead(np.arange(1.0, 101.0), np.full(99, 0.1)), 0.1)
START: dict[str, Any] = {"restricted_velocity": (0.1, 0.2)}


def _sums(block: nh.MemberBlock) -> dict[str, np.ndarray]:
    return {"twice": 2 * block["x"]}


def _random(members: int) -> nh.RandomDesign:
    return nh.RandomDesign(members, {"x": nh.Uniform(0.0, 1.0)})


TOO_MUCH: dict[str, tuple[Callable[[], Any], str]] = {
    "states": (lambda: nh.simulate(TOP, steps=10**12, **START), "fit into memory. Got about 72 TB of"),
    "steps": (lambda: nh.simulate(TOP, steps=10**30, **START), "be at most 9007199254740992"),
    "years": (lambda: nh.simulate(TOP, steps=10**13, save_every=10**12, branch="nearest", **START), "within a year"),
    "disk": (
        lambda: nh.simulate(TOP, steps=10**15, store="a.zarr", **START),
        "fit on the disk. Got about 72 PB",
    ),
    "members of a sweep": (lambda: nh.sweep(_sums, _random(10**15), "a.zarr"), "fit on the disk. Got about 21 PB"),
    "members of a sweep, years": (
        lambda: nh.sweep(_sums, _random(9 * 10**15), "a.zarr"),
        "sweep(design=...)` must be done within a year",
    ),
    "steps of a sweep": (
        lambda: nh.sweep(nh.EnsembleTask(SLEIGH, steps=10**13, **START), nh.Grid({"a": np.ones(10**5)}), "a.zarr"),
        "EnsembleTask(steps=...)` must be done within a year",
    ),
    "block of a sweep": (
        lambda: nh.sweep(_sums, _random(10**12), "a.zarr", block=10**12),
        "sweep(block=...)` must fit into memory",
    ),
    "files of a sweep": (lambda: nh.sweep(_sums, _random(10**11), "a.zarr", block=1), "fit on the disk"),
    "poses": (
        lambda: nh.simulate(WIDE, steps=10**7, restricted_velocity=np.full(99, 0.01)),
        "simulate(reconstruct=...)` must fit into memory",
    ),
    "poses of members that are reduced": (
        lambda: nh.ensemble(
            WIDE, steps=10**9, save_every=1, restricted_velocity=np.full((2, 99), 0.01), reduce=lambda _: {}
        ),
        "ensemble(reconstruct=...)` must fit into memory",
    ),
    "direction": (lambda: nh.Direction(10**14), "Direction(size=...)` must fit into memory"),
    "mass tensor": (lambda: nh.MassTensor(10**7, 1.0, 2.0), "MassTensor(n=...)` must fit into memory"),
    "plane": (
        lambda: nh.reference_point_subspace(10**3, np.eye(10**3)[:1]),
        "reference_point_subspace(n=...)` must fit into memory",
    ),
    "depth": (lambda: nh.branch_tree(SLEIGH, np.eye(3), 10**12), "branch_tree(depth=...)"),
    "checkpoint": (
        lambda: nh.simulate(TOP, steps=10**6, store="a.zarr", checkpoint_every=10**14, **START),
        "checkpoint_every=...)` must fit into memory",
    ),
    "block": (lambda: nh.iterate(TOP, steps=10**13, block_steps=10**12, **START), "fit into memory"),
    "members": (
        lambda: nh.ensemble(TOP, steps=10**8, save_every=1, restricted_velocity=np.full((1000, 2), 0.1)),
        "ensemble(steps=...)` must fit into memory",
    ),
    "identity": (lambda: nh.SO(10**6).identity, "SO(1000000).identity` must fit into memory. Got about 8 TB"),
    "basis": (lambda: nh.SuslovTop(np.eye(400)).inertia_operator, "fit into memory"),
    "mesh": (lambda: nh.momentum_locus(TOP, 10**6), "resolution=...)` must fit into memory"),
    "curve": (lambda: nh.invariant_curve(TOP, 0.01, 10**12), "resolution=...)` must fit into memory"),
    "samples": (lambda: nh.flow_obstruction(SLEIGH, 0.1, samples=10**11), "samples=...)` must fit into memory"),
}


def _kinetic(_: Any, v: Any) -> Any:
    return v @ v / 2


PARTICLES = {
    "in coordinates": (lambda: nh.LagrangeDAlembert(_kinetic, None, dimension=2), (1.0, 0.0)),
    "on a group": (
        lambda: nh.GroupLagrangeDAlembert(nh.SO(3), nh.mass_tensor_lagrangian(nh.SO(3), np.eye(3)), None),
        (1.0, 0.0, 0.0),
    ),
}


@pytest.mark.parametrize("name", PARTICLES)
@pytest.mark.parametrize(("steps", "every", "told"), [(10**12, 1, "fit into memory"), (10**15, 10**14, "a year")])
def test_runs_by_the_discrete_principle_are_bounded(name: str, steps: int, every: int, told: str) -> None:
    """The states of a run in coordinates or on any group are held in memory, and take their time."""
    system, start = PARTICLES[name]
    discrete = system().discretize(0.1)
    with pytest.raises(ValueError, match=rf"simulate\(steps=...\)` must .*{told}"):
        discrete.simulate(configuration=None, body_velocity=start, steps=steps, save_every=every)


@pytest.mark.parametrize("name", TOO_MUCH)
def test_too_much_is_refused(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The refusal names the figure and the limit, and there is nothing at the path."""
    monkeypatch.chdir(tmp_path)
    call, told = TOO_MUCH[name]
    with pytest.raises(ValueError, match=re.escape(told)):
        call()
    assert not list(tmp_path.iterdir())


def test_a_run_that_an_event_stops_may_be_long() -> None:
    """How many states a run keeps that an event stops is not known before."""
    event = nh.Event(lambda orbit: orbit.time - 0.55, stop=True)
    assert len(nh.simulate(TOP, steps=10**12, events=[event], **START)) == 6


def test_frames_that_fill_the_memory_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Frames are held until the last one is drawn."""
    orbit = nh.simulate(SLEIGH, steps=50, **START)
    monkeypatch.setattr("nonholo.base.limits.memory_limit", lambda: 1e6)
    with pytest.raises(ValueError, match=r"animate\(frames=...\)` must fit into memory. Got about .* MB of 1 MB"):
        nh.plot.animate(orbit, tmp_path / "a.gif", frames=40)
    assert not list(tmp_path.iterdir())


def test_times_that_fill_the_memory_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """A flow holds its states."""
    monkeypatch.setattr("nonholo.base.limits.memory_limit", lambda: 1e6)
    with pytest.raises(ValueError, match=r"flow\(times=...\)` must fit into memory"):
        nh.flow(SLEIGH.system, times=np.arange(10.0**5), **START)
