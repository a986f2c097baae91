"""A private Dask cluster on loopback, sweeps for it, and their client as a process that can be killed."""

import contextlib
import json
import os
import pathlib
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
from waiting import wait_for

import nonholo as nh

HERE = pathlib.Path(__file__).parents[1]
DESIGN = nh.RandomDesign(240, {"x": nh.Uniform(0.0, 1.0)}, rng=5)
BLOCK = 4


class Cluster:
    """A scheduler and its workers, processes of this environment that talk over TCP on 127.0.0.1."""

    def __init__(self, folder: pathlib.Path) -> None:
        self.folder, self.workers = folder, []
        file = folder / "scheduler.json"
        options = ["--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--dashboard-address", "127.0.0.1:0"]
        self.scheduler = self._started("scheduler", *options, "--idle-timeout", "120", "--scheduler-file", str(file))
        wait_for(lambda: _is_written(file))
        self.address: str = json.loads(file.read_text())["address"]

    def add_worker(self, *, nanny: bool = False, path: pathlib.Path = HERE) -> None:
        """Start a worker of one thread that imports from a folder."""
        options = ["--host", "127.0.0.1", "--nthreads", "1", "--no-dashboard", "--dashboard-address", "127.0.0.1:0"]
        options += ["--death-timeout", "60"]  # none outlives a killed test run for long
        places = ["--local-directory", str(self.folder), "--nanny" if nanny else "--no-nanny"]
        self.workers.append(self._started("worker", self.address, *options, *places, path=path))

    def kill(self) -> None:
        """Kill the scheduler and all workers."""
        for process in (*self.workers, self.scheduler):
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()

    def _started(self, *command: str, path: pathlib.Path = HERE) -> subprocess.Popen[bytes]:
        log = (self.folder / f"{command[0]}-{len(self.workers)}.log").open("wb")
        with log:
            return subprocess.Popen(  # noqa: S603
                [sys.executable, "-m", "dask", *command],
                env=environment(path),
                cwd=self.folder,
                stdout=log,
                stderr=log,
                start_new_session=True,
            )


def _is_written(file: pathlib.Path) -> bool:
    """Tell whether a JSON file is there and whole: the scheduler opens it before it writes."""
    try:
        return "address" in json.loads(file.read_text())
    except (FileNotFoundError, json.JSONDecodeError):
        return False


@contextlib.contextmanager
def cluster(folder: pathlib.Path, workers: int = 2, **options: Any) -> Iterator[Cluster]:
    """Run a cluster; no process of it is left."""
    folder.mkdir(exist_ok=True)
    machines = Cluster(folder)
    try:
        for _ in range(workers):
            machines.add_worker(**options)
        yield machines
    finally:
        machines.kill()


def environment(path: pathlib.Path) -> dict[str, str]:
    """Return the environment of a process that imports from a folder and uses one thread for each task."""
    return {**os.environ, "PYTHONPATH": str(path), "OMP_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"}


def slow(block: nh.MemberBlock) -> dict[str, np.ndarray]:
    """Return random numbers of members, for some fifty blocks in a second."""
    time.sleep(0.02)
    return {"sum": block["x"] + block.random(1)[:, 0], "index": block.index}


def begin(address: str, store: pathlib.Path) -> subprocess.Popen[bytes]:
    """Start a client that runs the sweep of `slow`, in a process of its own."""
    return subprocess.Popen([sys.executable, __file__, address, str(store)], env=environment(HERE))  # noqa: S603


def done(store: pathlib.Path) -> list[str]:
    """Return who wrote each finished block."""
    marks = (store / "run" / "blocks").glob("*.json")
    return [json.loads(mark.read_text().partition(" ")[2])["about"]["writer"] for mark in marks]


if __name__ == "__main__":
    from ensembles.cluster import slow as importable

    nh.sweep(importable, DESIGN, sys.argv[2], sys.argv[1], block=BLOCK)
