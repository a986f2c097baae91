"""Kill runs and sweeps at random times: `python tests/fuzz/kills.py --trials 20 --restarts 10 [--json FILE]`.

This many runs of orbits and of sweeps are killed by SIGKILL, two in five again in the resume, and resumed; others run
in a process namespace of their own, as in a container, which ends with them, and are resumed in another one. The
numbers must be those of a run that nobody disturbed, to the bit, no file may be left behind, and no lock held.
"""

# ruff: noqa: E402
import hashlib
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeAlias

sys.path.insert(0, str(Path(__file__).parents[1]))
import compilers

compilers.use_caches()

import numpy as np
from ensembles import faults
from fuzz.figures import options
from fuzz.marker import turned

import nonholo as nh
from nonholo.io.places import owner_of

Run: TypeAlias = tuple[nh.Discretization, dict[str, Any], list[nh.Event] | None]


def _run(system: Any, time_step: float, *velocity: float, steps: int, save_every: int, events: Any = None) -> Run:
    run = {"body_velocity": velocity, "steps": steps, "save_every": save_every}
    return nh.discretize(system, time_step), run, events


BODY, EAST = nh.RigidBody(np.diag([1.0, 1.5, 2.0, 2.5])), nh.Event(turned, direction=1)
RUNS: dict[str, Run] = {
    "sleigh": _run(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 1e-3, 1.0, 0.3, 0.0, steps=60_000, save_every=2),
    "tumbling body": _run(BODY, 0.1, 1.0, -0.4, 0.9, 0.8, -0.7, 0.9, steps=50_000, save_every=2),
    "events": _run(nh.ChaplyginSleigh(1.0, 1.0, 0.0), 0.1, 4.0, 1.0, 0.0, steps=30_000, save_every=5, events=[EAST]),
}
SWEEPS: dict[str, Any] = {
    "noisy": (faults.noisy, nh.Grid({"x": np.arange(20.0), "y": np.arange(20.0)}, rng=3), 8),
    "tops": (faults.TOPS, nh.RandomDesign(20_000, faults.TOP_DESIGN, rng=4), 500),
}
FAMILIES = {"orbit": tuple(RUNS), "sweep": tuple(SWEEPS)}
_AGAIN = 0.4
_RESTARTS = ("unshare", "--pid", "--fork", "--kill-child", "--mount-proc")


def go_on(family: str, name: str, store: Path) -> None:
    """Begin a run or a sweep, or resume it."""
    if family == "sweep":
        task, design, block = SWEEPS[name]
        nh.sweep(task, design, store, "threads", block=block, workers=2, resume=True)
        return
    discrete, run, events = RUNS[name]
    if store.exists():
        nh.resume(store, events=events)
    else:
        nh.simulate(discrete, **run, events=events, store=store, checkpoint_every=500 * run["save_every"])


def print_of(family: str, store: Path) -> str:
    """Return a hash of all numbers of a finished store."""
    data = nh.load_sweep(store).load() if family == "sweep" else nh.load_orbit(store).to_dataset()
    parts = (str(name).encode() + data[name].values.tobytes() for name in sorted(data.variables, key=str))
    return hashlib.sha256(b"".join(parts)).hexdigest()


def left_behind(folder: Path) -> list[str]:
    """Return what a run that is over must not leave: its lock, and files that were being written."""
    locks = [str(store) for store in folder.glob("*.zarr") if owner_of(store) is not None]
    return locks + [str(path) for pattern in ("*.partial*", "lock*", "*.lock") for path in folder.rglob(pattern)]


def in_a_child(do: Callable[..., Any], *arguments: Any) -> str:
    """Return the text that a function returns in a forked child, which may start threads."""
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        os.write(write, str(do(*arguments)).encode())
        os._exit(0)
    os.close(write)
    with os.fdopen(read) as report:
        text = report.read()
    if os.waitpid(child, 0)[1] != 0:
        raise RuntimeError(f"{do.__name__}{arguments} failed")
    return text


def kill_in_forks(family: str, name: str, store: Path, chance: random.Random, seconds: float) -> int:
    """Kill a run, perhaps its resume too; return how many were killed before they were over."""
    times = 1 + (chance.random() < _AGAIN)
    kills = sum(_killed(family, name, store, chance.uniform(0.0, seconds)) for _ in range(times))
    in_a_child(go_on, family, name, store)
    return kills


def _killed(family: str, name: str, store: Path, seconds: float) -> bool:
    """Continue in a child and kill it after a while; return whether it had not ended before."""
    child = os.fork()
    if child == 0:
        os.setsid()
        go_on(family, name, store)
        os._exit(0)
    time.sleep(seconds)
    os.kill(child, signal.SIGKILL)
    return os.WIFSIGNALED(os.waitpid(child, 0)[1])


def kill_by_restart(family: str, name: str, store: Path, chance: random.Random, seconds: float) -> int:
    """Kill the namespace of a run once it has begun, and resume in another one; return 1 if that was before its end."""
    command = [*_RESTARTS, sys.executable, __file__, "--go-on", family, name, str(store)]
    running = subprocess.Popen(command)  # noqa: S603
    while not store.exists() and running.poll() is None:
        time.sleep(0.01)
    time.sleep(chance.uniform(0.0, 0.5 * seconds))
    running.kill()
    was = running.wait() == -signal.SIGKILL
    subprocess.run(command, check=True)  # noqa: S603
    return int(was)


def can_restart() -> bool:
    """Tell whether process namespaces may be made here."""
    if shutil.which("unshare") is None:
        return False
    return subprocess.run([*_RESTARTS, "true"], capture_output=True, check=False).returncode == 0  # noqa: S603


def figures(family: str, count: int, seed: int, restarts: bool = False, names: tuple[str, ...] = ()) -> dict[str, Any]:
    """Kill this many runs of a family; return how many were, and what of them is wrong."""
    chance, wrong, kills = random.Random(seed), [], 0  # noqa: S311
    kill = kill_by_restart if restarts else kill_in_forks
    with tempfile.TemporaryDirectory(prefix="fuzz-") as home:
        timed = {name: _undisturbed(family, name, Path(home)) for name in names or FAMILIES[family]}
        undisturbed, seconds = ({name: pair[at] for name, pair in timed.items()} for at in (0, 1))
        runs = 0
        while kills < count and runs < 4 * count + 20:  # one that is over before it is killed does not count
            name = list(undisturbed)[runs % len(undisturbed)]
            expected = undisturbed[name]
            folder = Path(home) / f"trial {runs}"
            folder.mkdir()
            killed_so = kill(family, name, folder / "run.zarr", chance, 0.7 * seconds[name])
            seconds[name] *= 1.0 if killed_so else 0.5  # it was timed when other processes were more busy
            kills, runs = kills + bool(killed_so), runs + 1
            same = in_a_child(print_of, family, folder / "run.zarr") == expected
            rest = left_behind(folder)
            if not same or rest:
                wrong.append({"run": f"{family}, {name}, {runs}", "same": same, "left": rest})
            shutil.rmtree(folder)
    return {"runs": runs, "killed": kills, "wrong": wrong}


def _undisturbed(family: str, name: str, home: Path) -> tuple[str, float]:
    """Return the hash of a run that nobody disturbs, and the seconds that it takes once all is compiled.

    That is done before the first fork, in one thread.
    """
    if family == "orbit":
        discrete, run, events = RUNS[name]
        nh.simulate(discrete, **run | {"steps": 100}, events=events)
    elif name == "tops":
        faults.TOPS(nh.MemberBlock(0, 1, 0, SWEEPS[name][1].values(0, 1)))
    begin = time.monotonic()
    in_a_child(go_on, family, name, home / f"{name}.zarr")
    seconds = time.monotonic() - begin
    return in_a_child(print_of, family, home / f"{name}.zarr"), seconds


def all_figures(trials: int, restarts: int, seed: int, only: str | None = None) -> dict[str, Any]:
    """Return the figures of all kinds of kills."""
    chosen = {family: tuple(x for x in names if only in (None, x)) for family, names in FAMILIES.items()}
    result = {family: figures(family, trials, seed, names=names) for family, names in chosen.items() if names}
    if not restarts:
        return result
    if not can_restart():
        return {**result, "restarts": "skipped: process namespaces may not be made here"}
    halves = (restarts + 1) // 2, restarts // 2
    shares = zip(FAMILIES, halves, strict=True)
    return result | {f"{family}, restarted": figures(family, half, seed, True) for family, half in shares}


def main() -> int:
    """Kill, resume, compare, print the figures."""
    parser = options(__doc__, trials=20, restarts=10)
    parser.add_argument("--only", help="the name of one run or sweep")
    parser.add_argument("--go-on", nargs=3, metavar=("FAMILY", "NAME", "STORE"), help="what is killed")
    arguments = parser.parse_args()
    if arguments.go_on:
        family, name, store = arguments.go_on
        go_on(family, name, Path(store))
        return 0
    result = all_figures(arguments.trials, arguments.restarts, arguments.seed, arguments.only)
    for name, row in result.items():
        sys.stdout.write(f"{name}: {row}\n")
    if arguments.json:
        arguments.json.write_text(json.dumps(result, indent=1))
    return int(any(isinstance(row, dict) and row["wrong"] for row in result.values()))


if __name__ == "__main__":
    sys.exit(main())
