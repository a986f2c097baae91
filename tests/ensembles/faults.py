"""Sweeps to be disturbed, small ones too, and processes that run them."""

import multiprocessing
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import xarray

import nonholo as nh

TOP = nh.discretize(nh.SuslovTop(np.diag([1.0, 2.0, 3.0])), 0.1)
TOPS = nh.EnsembleTask(TOP, steps=200, reductions=["final_state", "energy_drift"])
TOP_DESIGN = {"mass_tensor": nh.MassTensor(3, 0.5, 2.0), "restricted_velocity": nh.Direction(2, length=2.0)}


def noisy(block: nh.MemberBlock) -> dict[str, Any]:
    """Return numbers that depend on the design and on the random numbers of members, in a while."""
    time.sleep(0.02)
    return {"total": block["x"] + block["y"], "noise": (("component",), block.random(3))}


SWEEPS: dict[str, tuple[Any, Any, int]] = {
    "noisy": (noisy, nh.Grid({"x": np.arange(60.0), "y": np.arange(40.0)}, rng=3), 8),
    "tops": (TOPS, nh.RandomDesign(100_000, TOP_DESIGN, rng=4), 500),
}


def go_on(name: str, path: Path, scheduler: str = "threads") -> xarray.Dataset:
    """Begin a sweep, or resume it."""
    task, design, block = SWEEPS[name]
    return nh.sweep(task, design, path, scheduler, block=block, workers=2, resume=True)


def done(path: Path) -> int:
    """Return how many blocks are finished."""
    return len(list((path / "run" / "blocks").glob("*.json")))


def is_running(process: int) -> bool:
    """Tell whether a process runs; one that has ended may wait for its parent to ask."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] not in "ZX"
    except (FileNotFoundError, ProcessLookupError):
        return False


# a small sweep that takes some milliseconds
DESIGN = nh.Grid({"x": [1.0, 2.0, 3.0], "start": [[0.0, 1.0], [2.0, 3.0]]}, rng=1)


def simple(block: nh.MemberBlock) -> dict[str, Any]:
    """Return numbers that depend on the design and on the random numbers of members."""
    return {"total": block["x"] + block["start"][:, 0], "noise": (("component",), block.random(3))}


def dying(block: nh.MemberBlock) -> dict[str, Any]:
    """Return the same numbers, but kill the worker that has the last member."""
    if 5 in block.index and multiprocessing.parent_process() is not None:
        os.kill(os.getpid(), signal.SIGKILL)
    return simple(block)


def swept(path: Path, **options: Any) -> xarray.Dataset:
    """Run the sweep, in this thread unless stated otherwise."""
    return nh.sweep(simple, DESIGN, path, **{"scheduler": "synchronous", "block": 2, **options}).load()


def resumed(path: Path, **options: Any) -> xarray.Dataset:
    """Resume the sweep."""
    return nh.resume(path, task=simple, **{"scheduler": "synchronous", **options}).load()


def same(one: xarray.Dataset, other: xarray.Dataset) -> bool:
    """Compare every bit."""
    return one.variables.keys() == other.variables.keys() and all(
        one[name].dims == other[name].dims
        and one[name].dtype == other[name].dtype
        and one[name].values.tobytes() == other[name].values.tobytes()
        for name in one.variables
    )


# a test run in the background ignores Ctrl-C, and so would all that it starts
HEED_CTRL_C = (
    "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); "
    "signal.signal(signal.SIGHUP, signal.SIG_DFL)"  # children of a shell or of nohup may ignore them
)


def python(code: str, **options: Any) -> subprocess.Popen[str]:
    """Start a process that knows the names of this file."""
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[1])}
    program = f"{HEED_CTRL_C}\nfrom ensembles.faults import *\n{code}"
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    command = [sys.executable, "-W", "error::RuntimeWarning", "-c", program]  # such as that of a damaged store
    return subprocess.Popen(command, env=environment, **pipes, **options)  # noqa: S603
