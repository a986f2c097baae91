"""Calls that cost nothing: what a warm call takes, and a first one in a fresh process above the import of NumPy.

Every call returns what its tests check; here they are only timed. With the folder of another commit the warm calls of
both are timed in turns, process after process.

    python benchmarks/calls.py [--rounds 11] [--against FOLDER] [--smoke]
"""

import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from _command import options, small

import nonholo as nh

CALLS = small(30, 1)  # in one round
TOP = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
SLEIGH = nh.ChaplyginSleigh(1.0, 0.75, 0.5)
VELOCITY = (0.4, 0.9, 0.0)
FLOOR = "import numpy"
FIRST = {
    "simulate": "import nonholo as nh\nnh.simulate(nh.discretize(nh.{}, 0.1), body_velocity=(1, 1, 0), steps=100)\n",
    "flow": "import nonholo as nh\nnh.flow(nh.{}, body_velocity=(0.4, 0.9, 0), times=(0, 20))\n",
}
BODIES = {
    "top": "SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])",
    "sleigh": "ChaplyginSleigh(1.0, 0.75, 0.5)",
}


def calls() -> dict[str, Callable[[], Any]]:
    """Return the calls by name."""
    result: dict[str, Callable[[], Any]] = {"SuslovTop(...)": lambda: nh.SuslovTop(np.array(TOP.mass_tensor))}
    result["ChaplyginSleigh(...)"] = lambda: nh.ChaplyginSleigh(1.0, 0.75, 0.5)
    for name, system in (("top", TOP), ("sleigh", SLEIGH)):
        discrete = nh.discretize(system, 0.1)
        orbit = nh.simulate(discrete, body_velocity=VELOCITY, steps=100)
        result[f"discretize, {name}"] = lambda system=system: nh.discretize(system, 0.1)
        result[f"simulate, {name}, 100 steps"] = lambda discrete=discrete: nh.simulate(
            discrete, body_velocity=VELOCITY, steps=100
        )
        result[f"invariants, {name}"] = lambda orbit=orbit: nh.invariants(orbit)
        result[f"flow, {name}, T = 20"] = lambda system=system: nh.flow(
            system, body_velocity=VELOCITY, times=(0.0, 20.0)
        )
    return result


def microseconds(call: Callable[[], Any], rounds: int) -> float:
    """Return the median of rounds of warm calls, in time of the processor."""
    call()
    durations = []
    for _ in range(rounds):
        begun = time.process_time()
        for _ in range(CALLS):
            call()
        durations.append((time.process_time() - begun) / CALLS * 1e6)
    return statistics.median(durations)


def seconds(programs: dict[str, Path], rounds: int) -> dict[str, float]:
    """Return medians of whole processes, in turns."""
    durations: dict[str, list[float]] = {name: [] for name in programs}
    for _ in range(rounds + 1):
        for name, file in programs.items():
            begun = time.perf_counter()
            subprocess.run([sys.executable, str(file)], check=True)  # noqa: S603
            durations[name].append(time.perf_counter() - begun)
    return {name: statistics.median(result[1:]) for name, result in durations.items()}


def warm(rounds: int) -> dict[str, float]:
    """Return the microseconds of the calls by name."""
    return {name: microseconds(call, rounds) for name, call in calls().items()}


def compared(other: str, rounds: int) -> None:
    """Print medians of both commits, and of their ratios."""
    command, result = [sys.executable, __file__, "--rounds", "11", "--json"], []
    for _ in range(rounds):
        pair = []
        for folder in (other, str(Path(nh.__file__).parents[1])):
            environment = {**os.environ, "PYTHONPATH": folder}
            done = subprocess.run(command, check=True, env=environment, capture_output=True)  # noqa: S603
            pair.append(json.loads(done.stdout))
        result.append(pair)
    print("| call | us there | us here | there / here |\n| --- | ---: | ---: | ---: |")
    for name in result[0][0]:
        there, here = ([pair[side][name] for pair in result] for side in (0, 1))
        ratio = statistics.median(a / b for a, b in zip(there, here, strict=True))
        print(f"| {name} | {statistics.median(there):.0f} | {statistics.median(here):.0f} | {ratio:.2f} |")


def main() -> None:
    """Print both tables."""
    parser = options(__doc__)
    parser.add_argument("--rounds", type=int, default=small(11, 1))
    parser.add_argument("--against", default=None, help="folder of another commit")
    parser.add_argument("--json", action="store_true", help="print the figures of warm calls alone")
    arguments = parser.parse_args()
    rounds = arguments.rounds
    if arguments.json:
        print(json.dumps(warm(rounds)))
        return
    if arguments.against is not None:
        compared(arguments.against, rounds)
        return
    print("| call | us |\n| --- | ---: |")
    for name, durations in warm(rounds).items():
        print(f"| {name} | {durations:.0f} |", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        texts = {"NumPy": FLOOR}
        texts |= {f"{what}, {body}": text.format(code) for what, text in FIRST.items() for body, code in BODIES.items()}
        programs = {name: Path(folder, f"{name.replace(' ', '_')}.py") for name in texts}
        for name, file in programs.items():
            file.write_text(texts[name])
        result = seconds(programs, rounds)
    floor = result.pop("NumPy")
    print(f"\n| first call in a process | s above the {floor:.2f} s of NumPy |\n| --- | ---: |")
    for name, durations in result.items():
        print(f"| {name} | {durations - floor:.2f} |")


if __name__ == "__main__":
    main()
