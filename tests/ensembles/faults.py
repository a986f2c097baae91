"""Sweeps to be disturbed, and a program that kills their clients, their workers, or all of it at random moments."""

import os
import signal
import sys
import time
from pathlib import Path
from typing import Any

import dask.threaded  # noqa: F401  # loaded before the first fork
import numpy as np
import xarray
from waiting import wait_for

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


def kill_often(name: str, path: Path, victims: list[str]) -> None:
    """Resume a sweep and kill client, worker or all, again and again; print how often that ended as it has to."""
    chance = np.random.default_rng(len(victims))
    ended = 0
    for victim in victims:
        before = done(path)
        client = os.fork()
        if client == 0:
            _as_client(name, path)
        enough = before + chance.integers(1, 20)
        wait_for(lambda: done(path) >= enough)  # noqa: B023
        time.sleep(chance.uniform(0.0, 0.1))
        ended += _killed(client, victim)
    sys.stdout.write(f"{ended}")


def _as_client(name: str, path: Path) -> None:
    os.setsid()
    try:
        go_on(name, path, "processes")
    except OSError as failure:
        os._exit(3 if "A worker process was killed" in str(failure) else 1)
    os._exit(0)


def _killed(client: int, victim: str) -> bool:
    """Kill, and tell whether the client ended as it has to and nothing of it is left."""
    workers = workers_of(client)
    if victim == "worker":
        os.kill(workers[-1], signal.SIGKILL)
        return os.waitstatus_to_exitcode(os.waitpid(client, 0)[1]) == 3
    (os.killpg if victim == "all" else os.kill)(client, signal.SIGKILL)
    status = os.waitstatus_to_exitcode(os.waitpid(client, 0)[1])
    wait_for(lambda: not any(map(_is_running, workers)))
    return status == -signal.SIGKILL


def workers_of(client: int) -> list[int]:
    """Return the worker processes of a client."""
    children = Path(f"/proc/{client}/task/{client}/children").read_text().split()
    return [int(child) for child in children if b"spawn_main" in Path(f"/proc/{child}/cmdline").read_bytes()]


def _is_running(process: int) -> bool:
    """Tell whether a process runs; one that has ended may wait for its parent to ask."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] not in "ZX"
    except (FileNotFoundError, ProcessLookupError):
        return False
