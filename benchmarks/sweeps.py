"""What sweeps cost beside the bare `ensemble` call, how they scale, what they store, and the memory they take.

Random tops (tensor and velocity of each member) and random sleighs (offset, inertia, velocity). The bare call gets the
same members, already drawn, and a function that keeps the same numbers; it draws and stores nothing. Both run in turns
in one process, after a round that is not counted. Times are the least ones, which others
who use the machine disturb least. "CPU" is the time of all cores that the process used.

    python benchmarks/sweeps.py                                          # all, a few minutes
    python benchmarks/sweeps.py --parts overhead --members 10000000      # one part
    python benchmarks/sweeps.py --smoke
"""

import contextlib
import functools
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numba
import numpy as np
from _command import options, small
from _inside import REDUCTIONS

import nonholo as nh

STEPS, KEPT, PARTS = (
    small(1000, 10),
    ["final_state", "energy_drift"],
    ("overhead", "scaling", "store", "tiny", "memory"),
)
SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.05)
TOP = nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 0.1)
VELOCITY = {"restricted_velocity": nh.Direction(2)}
CASES: dict[str, tuple[Any, dict[str, Any]]] = {
    "top": (TOP, {"mass_tensor": nh.MassTensor(3, 0.5, 2.0), **VELOCITY}),
    "sleigh": (SLEIGH, {"a": nh.Uniform(0.1, 1.0), "inertia": nh.LogUniform(0.1, 10.0), **VELOCITY}),
}
ONE_THREAD = {**os.environ, "OMP_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"}


def design_of(name: str, members: int) -> nh.RandomDesign:
    """Return random members."""
    return nh.RandomDesign(members, CASES[name][1], rng=1)


def swept(name: str, members: int, steps: int = STEPS, reductions: Any = KEPT, **options: Any) -> float:
    """Sweep into a store that is removed afterwards; return its bytes for each member."""
    task = nh.EnsembleTask(CASES[name][0], steps=steps, reductions=reductions)
    with tempfile.TemporaryDirectory() as folder:
        nh.sweep(task, design_of(name, members), f"{folder}/a.zarr", **options)
        return sum(file.stat().st_size for file in Path(folder).rglob("*") if file.is_file()) / members


def reduced(batch: nh.Ensemble) -> dict[str, Any]:
    """Return what the sweep keeps of members."""
    result = {name: entry[1] for reduction in KEPT for name, entry in REDUCTIONS[reduction].function(batch).items()}
    return {**result, "outcome": batch.outcome}


def timed(call: Callable[[], Any]) -> tuple[float, float]:
    """Return how long a call takes: by the clock, and on all cores together."""
    clock, cores = time.perf_counter(), time.process_time()
    call()
    return time.perf_counter() - clock, time.process_time() - cores


def overhead(names: list[str], members: int, rounds: int, threads: int) -> None:
    """Print times of a sweep in threads and of the bare call for the same members."""
    print(f"\n{members:,} members x {STEPS} steps, threads: {threads}, load {os.getloadavg()[0]:.1f}")
    numba.config.NUMBA_NUM_THREADS = threads
    for name in names:
        discrete = CASES[name][0]
        rows = drawn(name, members)
        start = rows.pop("restricted_velocity")
        run: dict[str, Any] = {"restricted_velocity": start, "parameters": rows, "steps": STEPS}

        def bare(discrete: Any = discrete, run: Any = run) -> None:
            nh.ensemble(discrete, reduce=reduced, **run)

        first = timed(lambda name=name: swept(name, small(1000, 10)))[0]
        timed(lambda name=name: swept(name, members // 100, workers=threads))
        sweep = functools.partial(swept, name, members, workers=threads)
        pairs = [(timed(sweep), timed(bare)) for _ in range(rounds)]
        for unit, at in (("clock", 0), ("CPU", 1)):
            ours, theirs = ([pair[side][at] for pair in pairs] for side in (0, 1))
            ratios = sorted(one / other for one, other in zip(ours, theirs, strict=True))
            report = f"median of {rounds} pairs {statistics.median(ratios):.2f} ({ratios[0]:.2f} to {ratios[-1]:.2f})"
            least = f"sweep {min(ours):7.2f} s   bare {min(theirs):7.2f} s   ratio {min(ours) / min(theirs):.2f}"
            print(f"{name:7} {unit:6} {least}   {report}")
        print(f"{name:7} not counted: the first sweep, of 1000 members, with imports and compilation {first:.2f} s")


def scaling(members: int, rounds: int) -> None:
    """Print members per second by scheduler and workers, in turns."""
    block = max(1, members // 32)
    with cluster(2) as address:
        ways: dict[str, dict[str, Any]] = {
            "1 thread": {"workers": 1},
            "2 threads": {"workers": 2},
            "1 process": {"scheduler": "processes", "workers": 1},
            "2 processes": {"scheduler": "processes", "workers": 2},
            "2 workers over TCP": {"scheduler": address},
        }
        result: dict[str, list[float]] = {way: [] for way in ways}
        for turn in range(rounds + 1):
            for way, options in ways.items():
                took = timed(lambda options=options: swept("top", members, block=block, **options))[0]
                if turn:
                    result[way].append(took)
    print(f"\ntops, {members:,} members x {STEPS} steps in 32 blocks, load {os.getloadavg()[0]:.1f}, {rounds} rounds")
    base = result["1 thread"]
    for way, times in result.items():
        gain = statistics.median(one / took for one, took in zip(base, times, strict=True))
        rate = members / statistics.median(times)
        print(f"{way:20} {statistics.median(times):7.2f} s {rate:10,.0f} members/s  {gain:.2f} times one thread")


def store(members: int) -> None:
    """Print bytes of a member by what is kept of it, the values of the design included."""
    print(f"\nbytes of a member in the store, {members:,} members")
    for name in CASES:
        for reduction in ("final_state", "energy_drift", "limit_angle"):
            print(f"{name:7} {reduction:14} {swept(name, members, 100, [reduction]):6.0f}")


def nothing(block: nh.MemberBlock) -> Any:
    """Return what the design drew."""
    return block["x"]


def tiny(blocks: int) -> None:
    """Print what a block costs beside its work: drawing, writing two chunks and a mark, scheduling."""
    design = nh.RandomDesign(blocks, {"x": nh.Uniform(0.0, 1.0)})
    print(f"\n{blocks:,} blocks of one member, three chunks and a mark each, load {os.getloadavg()[0]:.1f}")
    with cluster(2) as address:
        ways = {"threads": {}, "processes": {"scheduler": "processes"}, "2 workers over TCP": {"scheduler": address}}
        for way, options in ways.items():
            with tempfile.TemporaryDirectory() as folder:
                took = timed(
                    lambda options=options, at=folder: nh.sweep(nothing, design, f"{at}/a", block=1, **options)
                )
            print(f"{way:20} {took[0] / blocks * 1e3:.2f} ms a block")


def memory(names: list[str], members: int, steps: int) -> None:
    """Print the largest memory of processes that sweep, or call `ensemble` with a reduction, and nothing else."""
    print(f"\nlargest memory, {members:,} members x {steps} steps")
    for name in names:
        for what in small(("import", "sweep", "rows", "bare"), ("import", "bare")):
            command = [
                sys.executable,
                __file__,
                "--child",
                name,
                what,
                str(members),
                str(steps),
                *small([], ["--smoke"]),
            ]
            print(subprocess.run(command, check=True, capture_output=True, text=True).stdout, end="", flush=True)  # noqa: S603


def drawn(name: str, members: int) -> dict[str, Any]:
    """Return the values of members, drawn piece by piece, which takes no more memory than they do."""
    design, piece = design_of(name, members), 1 << 16
    rows = {kind: np.empty((members, *shape)) for kind, shape in design.drawn.items()}
    for begin in range(0, members, piece):
        for kind, values in design.values(begin, min(piece, members - begin)).items():
            rows[kind][begin : begin + piece] = values
    return rows


def child(name: str, what: str, members: int, steps: int) -> None:
    """Do one thing, and print the largest memory of this process."""
    swept(name, small(1000, 10), steps)
    if what == "sweep":
        swept(name, members, steps)
    elif what != "import":
        rows = drawn(name, members)
        start = rows.pop("restricted_velocity")
        if what == "bare":
            nh.ensemble(CASES[name][0], restricted_velocity=start, parameters=rows, steps=steps, reduce=reduced)
    print(f"{name:7} {what:7} {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:6.0f} MiB")


@contextlib.contextmanager
def cluster(workers: int) -> Iterator[str]:
    """Run a Dask scheduler and workers of one thread on loopback; give its address."""
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        file = Path(folder) / "scheduler.json"
        quiet = ["--host", "127.0.0.1", "--no-dashboard", "--dashboard-address", "127.0.0.1:0"]

        def start(*command: str) -> None:
            log = stack.enter_context((Path(folder) / "log").open("ab"))
            whole = [sys.executable, "-m", "dask", *command, *quiet]
            process = subprocess.Popen(whole, cwd=folder, env=ONE_THREAD, stdout=log, stderr=log)  # noqa: S603
            stack.callback(process.wait)
            stack.callback(process.terminate)

        start("scheduler", "--port", "0", "--scheduler-file", str(file))
        while not file.exists():
            time.sleep(0.1)
        address = json.loads(file.read_text())["address"]
        for _ in range(workers):
            start("worker", address, "--nthreads", "1", "--no-nanny", "--local-directory", folder)
        yield address


def main() -> None:
    """Print the parts that are asked for."""
    parser = options(__doc__)
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=PARTS)
    parser.add_argument(
        "--members", type=int, default=small(1_000_000, 200), help="of overhead; half as many of scaling"
    )
    parser.add_argument("--rounds", type=int, default=small(5, 1))
    parser.add_argument(
        "--cases", nargs="+", choices=CASES, default=list(CASES)[: small(None, 1)], help="of overhead and memory"
    )
    parser.add_argument("--threads", type=int, default=os.cpu_count(), help="of overhead")
    parser.add_argument("--blocks", type=int, default=small(10_000, 4), help="of tiny")
    parser.add_argument("--child", nargs=4)
    arguments = parser.parse_args()
    if arguments.child:
        child(arguments.child[0], arguments.child[1], int(arguments.child[2]), int(arguments.child[3]))
        return
    calls: dict[str, Callable[[], None]] = {
        "overhead": lambda: overhead(arguments.cases, arguments.members, arguments.rounds, arguments.threads),
        "scaling": lambda: scaling(arguments.members // 2, arguments.rounds),
        "store": lambda: store(small(1 << 16, 64)),
        "tiny": lambda: tiny(arguments.blocks),
        "memory": lambda: memory(arguments.cases, small(10_000_000, 200), 10),
    }
    for part in arguments.parts:
        calls[part]()


if __name__ == "__main__":
    main()
