"""A long run into a store: resumed equals undisturbed bit by bit, and bounded memory.

The first part runs 1e7 steps twice, once undisturbed and once killed again and again at random moments, and compares
the orbits. The second runs 1e8 steps, one in a hundred kept, and reports the largest memory of its process.

    python benchmarks/long_run.py
    python benchmarks/long_run.py --steps 1e6 --thinned-steps 1e7
    python benchmarks/long_run.py --smoke
"""

import random
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from _command import options, small

import nonholo as nh

BODIES = {
    "top": nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]),
    "sleigh": nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5),
}
VELOCITIES = {"top": (0.4, 0.9, 0.0), "sleigh": (1.0, 0.3, 0.0)}
KILLS = small(10, 1)
KEPT_OF_LONG = 10
KEPT_OF_THINNED = 100
NAMES = ("time", "reduced_momentum", "cayley", "canonical_pose")


def begin(body: str, steps: int, every: int, store: Path) -> nh.Orbit:
    """Run into a new store."""
    discrete = nh.discretize(BODIES[body], 1e-3)
    return nh.simulate(discrete, body_velocity=VELOCITIES[body], steps=steps, save_every=every, store=store)


def killed_and_resumed(body: str, steps: int, store: Path) -> int:
    """Run in processes of which the first ten are killed at random moments while they write; return how many were."""
    chance, kills = random.Random(0), 0  # noqa: S311
    while True:
        what = ["resume", str(store)] if store.exists() else ["begin", body, str(steps), str(KEPT_OF_LONG), str(store)]
        process = subprocess.Popen([sys.executable, __file__, "--child", *what, *small([], ["--smoke"])])  # noqa: S603
        while kills < KILLS and process.poll() is None and not is_held(store, process.pid):
            time.sleep(0.01)
        try:
            process.wait(timeout=chance.uniform(0.0, 0.3) if kills < KILLS else None)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            kills += 1
            continue
        if process.returncode:
            raise SystemExit(process.returncode)
        return kills


def is_held(store: Path, pid: int) -> bool:
    """Tell whether a process has begun to write a store."""
    lock = store / "run" / "lock.json"
    return lock.exists() and f'"pid": {pid},' in lock.read_text()


def child(what: str, *arguments: str) -> None:
    """Do one part of a run, and print the largest memory of this process in MiB."""
    if what == "resume":
        nh.resume(arguments[0])
        return
    body, steps, every, store = arguments
    orbit = begin(body, int(steps), int(every), Path(store))
    print(f"{len(orbit)} states, {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MiB at most")


def main() -> None:
    """Run both parts for both bodies."""
    parser = options(__doc__)
    parser.add_argument("--steps", type=float, default=small(1e7, 1e5))
    parser.add_argument("--thinned-steps", type=float, default=small(1e8, 1e5))
    parser.add_argument("--child", nargs="+")
    arguments = parser.parse_args()
    if arguments.child:
        child(*arguments.child)
        return
    with tempfile.TemporaryDirectory() as folder:
        for body in BODIES:
            part = Path(folder) / body
            whole = begin(body, int(arguments.steps), KEPT_OF_LONG, part.with_suffix(".whole.zarr"))
            kills = killed_and_resumed(body, int(arguments.steps), part.with_suffix(".killed.zarr"))
            again = nh.load_orbit(part.with_suffix(".killed.zarr"))
            equal = all(np.array_equal(getattr(whole, name), getattr(again, name)) for name in NAMES)
            print(f"{body}: {arguments.steps:g} steps, {kills} kills, resumed == undisturbed: {equal}", flush=True)
            assert equal
            started, store = time.perf_counter(), part.with_suffix(".thinned.zarr")
            what = ["begin", body, str(int(arguments.thinned_steps)), str(KEPT_OF_THINNED), str(store)]
            subprocess.run([sys.executable, __file__, "--child", *what], check=True)  # noqa: S603
            size = sum(file.stat().st_size for file in store.rglob("*") if file.is_file())
            seconds = time.perf_counter() - started
            print(
                f"{body}: {arguments.thinned_steps:g} steps, {seconds:.1f} s, store of {size / 2**20:.0f} MiB",
                flush=True,
            )


if __name__ == "__main__":
    main()
