"""Small stores, finished and not, that fuzzers open, damage and resume."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from stopping import stopped_at

import nonholo as nh

ORBIT, RUN, UNFINISHED = "orbit.zarr", "run.zarr", "unfinished.zarr"
SWEEP, SWEEP_UNFINISHED = "sweep.zarr", "unfinished_sweep.zarr"
DISCRETE = nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 0.2)
DESIGN = nh.Grid({"x": [1.0, 2.0, 3.0], "start": [[0.0, 1.0], [2.0, 3.0]]}, rng=1)
_STEPS, _BLOCK = 60, 10
_stops: list[int] = []


def task(block: nh.MemberBlock) -> dict[str, Any]:
    """Return numbers of a few members; stop like Ctrl-C where a test has asked for it."""
    if block.first in _stops:
        raise KeyboardInterrupt
    return {"total": block["x"] + block["start"][:, 0], "noise": (("component",), block.random(3))}


def fill(folder: Path) -> None:
    """Write the stores into a folder."""
    run = {"restricted_velocity": (0.3, 0.2), "steps": _STEPS, "checkpoint_every": _BLOCK}
    nh.save_orbit(nh.simulate(DISCRETE, restricted_velocity=(0.3, 0.2), steps=20), folder / ORBIT)
    nh.simulate(DISCRETE, **run, store=folder / RUN)
    with stopped_at(3):
        nh.simulate(DISCRETE, **run, store=folder / UNFINISHED)
    nh.sweep(task, DESIGN, folder / SWEEP, "synchronous", block=2)
    _stops.append(4)
    with pytest.raises(KeyboardInterrupt):
        nh.sweep(task, DESIGN, folder / SWEEP_UNFINISHED, "synchronous", block=2)
    _stops.clear()


def numbers_of(result: Any) -> dict[str, bytes]:
    """Return all numbers of an orbit or of a sweep, as bytes by name."""
    data = result.to_dataset() if isinstance(result, nh.Orbit) else result
    return {str(name): np.ascontiguousarray(variable.values).tobytes() for name, variable in data.variables.items()}
