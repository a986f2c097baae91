"""Stored runs that are killed at random moments and resumed, in processes of their own."""

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

import nonholo as nh
from nonholo.io.orbits import Standing, standing


def east(orbit: nh.Orbit) -> np.ndarray:
    """Zero where the sleigh looks along the first axis, or back."""
    return np.sin(orbit.heading)


RUNS: dict[str, tuple[nh.Discretization, dict[str, Any], list[nh.Event] | None]] = {
    "short sleigh": (
        nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 1e-3),
        {"body_velocity": (1.0, 0.3, 0.0), "steps": 120_000, "save_every": 2},
        None,
    ),
    "sleigh": (
        nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 1e-3),
        {"body_velocity": (1.0, 0.3, 0.0), "steps": 300_000, "save_every": 2},
        None,
    ),
    "tumbling body": (
        nh.discretize(nh.RigidBody(np.diag([1.0, 1.5, 2.0, 2.5])), 0.1),
        {"body_velocity": (1.0, -0.4, 0.9, 0.8, -0.7, 0.9), "steps": 100_000, "save_every": 2},
        None,
    ),
    "events": (
        nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.0), 0.1),
        {"body_velocity": (4.0, 1.0, 0.0), "steps": 150_000, "save_every": 5},
        [nh.Event(east, direction=1)],
    ),
}


def leave_killed(name: str, store: Path, kills: int) -> Standing:
    """Kill a run and resume it, again and again; return how far it has come when it is killed for the last time."""
    arguments = [sys.executable, __file__, name, str(store), str(kills)]
    done = subprocess.run(arguments, stdout=subprocess.PIPE, text=True, check=True)  # noqa: S603
    assert int(done.stdout) == kills, "the run was over before the last kill: it has to be longer"
    found = standing(store)
    assert found is not None
    return found


def _go_on(name: str, store: Path) -> None:
    discrete, run, events = RUNS[name]
    if store.exists():
        nh.resume(store, events=events)
    else:
        nh.simulate(discrete, **run, events=events, store=store, checkpoint_every=500 * run["save_every"])


def _kill_often(name: str, store: Path, kills: int) -> int:
    """Return how many were killed; after some blocks or at the beginning, on slow machines as on fast ones."""
    chance, killed = random.Random(7), 0  # noqa: S311
    discrete, run, events = RUNS[name]
    nh.simulate(discrete, **run | {"steps": 100}, events=events)  # compiled before the first fork

    def done() -> int:
        return len(list((store / "run" / "blocks").glob("*.json")))

    for _ in range(kills):
        enough, ended = done() + chance.choice([0, 1, 2, 5, 12]), 0
        child = os.fork()
        if child == 0:
            _go_on(name, store)
            os._exit(0)
        while done() < enough and not ended:
            time.sleep(0.002)
            ended, _ = os.waitpid(child, os.WNOHANG)
        time.sleep(chance.uniform(0, 0.02))
        if not ended:
            os.kill(child, signal.SIGKILL)
            killed += os.WIFSIGNALED(os.waitpid(child, 0)[1])
    return killed


if __name__ == "__main__":
    sys.stdout.write(f"{_kill_often(sys.argv[1], Path(sys.argv[2]), int(sys.argv[3]))}")
