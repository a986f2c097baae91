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
START: dict[str, Any] = {"restricted_velocity": (0.1, 0.2)}
TOO_MUCH: dict[str, tuple[Callable[[], Any], str]] = {
    "states": (lambda: nh.simulate(TOP, steps=10**12, **START), "fit into memory. Got about 72 TB of"),
    "steps": (lambda: nh.simulate(TOP, steps=10**30, **START), "be at most 9007199254740992"),
    "years": (lambda: nh.simulate(TOP, steps=10**13, save_every=10**12, branch="nearest", **START), "within a year"),
    "disk": (
        lambda: nh.simulate(TOP, steps=10**15, store="a.zarr", **START),
        "fit on the disk. Got about 72 PB",
    ),
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
