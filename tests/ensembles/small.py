"""A small sweep that takes some milliseconds, and what disturbs it or compares it."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import xarray

import nonholo as nh

DESIGN = nh.Grid({"x": [1.0, 2.0, 3.0], "start": [[0.0, 1.0], [2.0, 3.0]]}, rng=1)


def simple(block: nh.MemberBlock) -> dict[str, Any]:
    """Return numbers that depend on the design and on the random numbers of members."""
    return {"total": block["x"] + block["start"][:, 0], "noise": (("component",), block.random(3))}


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
    """Start a process that knows the sweeps to be disturbed."""
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[1])}
    program = f"{HEED_CTRL_C}\nfrom ensembles.faults import *\n{code}"
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    command = [sys.executable, "-W", "error::RuntimeWarning", "-c", program]  # such as that of a damaged store
    return subprocess.Popen(command, env=environment, **pipes, **options)  # noqa: S603
