"""Steps in coordinates by compiled formulas beside the loop in JAX: process time of runs of ready systems, in turns.

Both must end at the same place. The first call is that of a process: it traces and compiles, for each system anew; the
kernels are loaded. Then flows over 20 units of time: Taylor series of the formulas to rounding, beside diffrax with a
relative error of 1e-10, and how far each ends from diffrax with 1e-13.

    python benchmarks/coordinates.py [--steps 20000] [--rounds 7] [--smoke]
"""

import functools
import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from _command import options as command
from _command import small
from _inside import ROWS, advance, flow_by_diffrax, flow_by_series, in_double_precision, loop_in_jax

import nonholo as nh

NAMES = ("particle", "rolling_disk", "knife_edge_on_incline", "snakeboard", "two_wheeled_robot", "non_reversible")
NAMES += ("roller_racer", "driven_sleigh", "chaotic_quartic_oscillator")
STEP, SIGN = 0.002, np.float64(1)


def main() -> None:
    """Print a table."""
    parser = command(__doc__)
    parser.add_argument("--steps", type=int, default=small(20000, 20))
    parser.add_argument("--rounds", type=int, default=small(7, 1))
    options = parser.parse_args()
    print("| system | n | JAX, us a step | compiled | ratio | first call, s |")
    print("| --- | ---: | ---: | ---: | ---: | ---: |")
    for name in small(NAMES, NAMES[:2]):
        ready = getattr(nh.examples, name)()
        system, h = ready.system, np.float64(STEP)
        begin = time.process_time()
        how = {"configuration": ready.configuration, "body_velocity": ready.body_velocity}
        orbit = nh.simulate(nh.discretize(system, STEP), **how, steps=10)
        first = time.process_time() - begin
        q = np.append(ready.configuration, 0.0) if system.is_driven else ready.configuration
        velocity = orbit.body_velocity[0]
        state, widths = (q, velocity, velocity), (len(q), len(velocity), system.constraints)
        loop = functools.partial(in_double_precision, loop_in_jax, system, h)
        table = tuple(np.empty((1, width)) for width in widths)
        by_jax = functools.partial(run_by_jax, loop, state, options.steps)
        compiled = functools.partial(advance, loop, system, h, state, SIGN, options.steps, table)
        times: list[list[float]] = [[], []]
        ends = [run()[1][0] for run in (by_jax, compiled)]
        assert np.abs(ends[0] - ends[1]).max() <= 1e-6 * np.abs(ends[0]).max()
        for _ in range(options.rounds):
            for run, spent in zip((by_jax, compiled), times, strict=True):
                begin = time.process_time()
                run()
                spent.append((time.process_time() - begin) / options.steps * 1e6)
        jax, ours = map(statistics.median, times)
        ratio = statistics.median(a / b for a, b in zip(*times, strict=True))
        cells = f"{jax:.2f} | {ours:.2f} | {ratio:.1f} | {first:.2f}"
        print(f"| {name} | {system.dimension} | {cells} |", flush=True)
    flows(options.rounds)


def run_by_jax(loop: Callable[..., Any], state: Any, steps: int) -> tuple[int, Any]:
    """Take steps by the loop in JAX, which takes a block of them at once; return how many, and the state there."""
    count = 0
    while count < steps:
        good, state, code, _ = loop(state, SIGN, np.int64(min(ROWS, steps - count)))
        assert code == 0
        count += int(good)
    return count, state


def flows(rounds: int) -> None:
    """Print a table of flows."""
    print("| system | diffrax, ms | series, ms | ratio | error of diffrax | of series | first flow, s |")
    print("| --- | ---: | ---: | ---: | ---: | ---: | ---: |")
    times = np.linspace(0.0, small(20.0, 1.0), 201)
    for name in small(NAMES, NAMES[:2]):
        ready = getattr(nh.examples, name)()
        begin = time.process_time()
        orbit = ready.flow(times=times)
        first = time.process_time() - begin
        q = np.append(ready.configuration, 0.0) if ready.system.is_driven else ready.configuration
        start = ready.system, (q, orbit.body_velocity[0]), times
        ways = (
            functools.partial(flow_by_diffrax, *start, (1e-10, 1e-12)),
            functools.partial(flow_by_series, *start, 1e-14),
        )
        exact, spent = flow_by_diffrax(*start, (1e-13, 1e-15))[0], np.empty((rounds, 2))
        errors = [max(np.abs(a - b).max() for a, b in zip(way()[0], exact, strict=True)) for way in ways]
        assert errors[1] < 1e-9
        for row in spent:
            for i, way in enumerate(ways):
                begin = time.process_time()
                way()
                row[i] = (time.process_time() - begin) * 1e3
        (jax, ours), ratio = np.median(spent, axis=0), np.median(spent[:, 0] / spent[:, 1])
        cells = f"{jax:.2f} | {ours:.2f} | {ratio:.1f} | {errors[0]:.1e} | {errors[1]:.1e} | {first:.2f}"
        print(f"| {name} | {cells} |", flush=True)


if __name__ == "__main__":
    main()
