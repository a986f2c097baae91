"""Ensembles beside vectorized C (`c/ensemble.c`, built here), in one run, in turns; medians of ratios.

Both sides are checked to end at the same states before anything is timed. "kernel" is the compiled loop, "call" the
whole `ensemble` with its checks; each runs in one thread and in all threads, and beside it C in as many, on equal parts
of the members. C is built with contracted operations (FMA) and strictly, as in `against_c.py`. Then ten million members
are reduced block by block, and the peak of the memory is shown beside that of their starts; last comes the cost of the
reduction "lyapunov", beside the plain run of the same members.

    python benchmarks/ensemble.py [--smoke]
"""

import ctypes
import functools
import itertools
import os
import resource
import time
from concurrent.futures import ThreadPoolExecutor

import numba
import numpy as np
from _command import options, small
from _inside import REDUCTIONS, kernels
from against_c import HEADER, built, paired, pointer
from against_c import compare as beside

import nonholo as nh

THREADS = numba.config.NUMBA_NUM_THREADS
MEMBERS, STEPS, TIME_STEP = small(100_000 - 100_000 % 32, 64), small(200, 10), 0.05
UNIT = MEMBERS * STEPS
SYSTEMS = {
    "top": nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]),
    "sleigh": nh.ChaplyginSleigh(1.0, 1.0, 0.5),
}


def kernel_rows(posed: bool) -> kernels.MemberRows:
    """Return rows for the last states."""
    shapes = (1, 2), (1, 2), (int(posed), 4)
    states = (np.empty((MEMBERS, *shape)) for shape in shapes)
    return kernels.MemberRows(*states, *np.zeros((2, MEMBERS), dtype=np.int64))


def compare(both: tuple, name: str, posed: bool) -> None:
    """Print nanoseconds per step and member of the kernel, the call in one thread and in all threads, and of C."""
    discrete = nh.discretize(SYSTEMS[name], TIME_STEP)
    velocities = np.random.default_rng(0).normal(size=(MEMBERS, 2))
    step = discrete.route
    body = np.array(step.body, dtype=np.float64)
    first = step.encode(velocities @ discrete.system.constrained_inertia)
    unit, rows = np.tile((1.0, 0.0, 0.0, 0.0), (MEMBERS, 1)), kernel_rows(posed)
    axes = kernels.MemberAxes(np.ones((1, 13)), False, 0)
    m, q = first.copy(), unit.copy()

    def part_of_c(result: ctypes.CDLL, part: slice) -> int:
        m[part], q[part] = first[part], unit[part]
        last, count = pointer(q[part] if posed else None), ctypes.c_long(part.stop - part.start)
        return getattr(result, name)(pointer(body), pointer(m[part]), last, count, ctypes.c_long(STEPS))

    def reference(result: ctypes.CDLL, pool: ThreadPoolExecutor) -> None:
        assert not any(pool.map(functools.partial(part_of_c, result), parts(pool._max_workers)))

    def kernel(part: slice) -> None:
        own = kernels.MemberRows(*(array[part] for array in rows))
        kernels.advance_members(
            step.body, None, axes, first[part], unit[part], STEPS, 0, own, np.zeros(1, dtype=np.bool_)
        )

    def call() -> nh.Ensemble:
        return nh.ensemble(discrete, restricted_velocity=velocities, steps=STEPS, reconstruct=posed)

    part_of_c(both[0], slice(0, MEMBERS))
    kernel(slice(0, MEMBERS))
    scale = np.abs(first).max()
    assert np.abs(m - rows.momenta[:, 0]).max() < 1e-13 * scale
    assert not posed or np.abs(q - rows.poses[:, 0]).max() < 1e-11
    assert np.abs(step.encode(call().reduced_momentum[:, 0]) - m).max() < 1e-13 * scale
    for threads in dict.fromkeys((1, THREADS)):
        numba.config.NUMBA_NUM_THREADS = threads
        with ThreadPoolExecutor(threads) as pool:
            references = tuple(functools.partial(reference, result, pool) for result in both)
            case = f"{name}{', pose' if posed else ''}, {threads} on each side"
            beside(f"kernel {case}", lambda pool=pool: [*pool.map(kernel, parts(pool._max_workers))], references, UNIT)
            beside(f"call {case}", call, references, UNIT)


def parts(count: int) -> list[slice]:
    """Return equal parts of the members, whole blocks of 32."""
    ends = [MEMBERS // 32 * i // count * 32 for i in range(count + 1)]
    return [slice(*pair) for pair in itertools.pairwise(ends)]


def largest_exponent(block: nh.Ensemble) -> np.ndarray:
    """Return the exponents of a block."""
    return REDUCTIONS["lyapunov"].function(block)["lyapunov"][1]


def tangents(name: str, members: int = small(400, 2), steps: int = small(1000, 10)) -> None:
    """Print what "lyapunov" takes beside the plain run of the same members, which keeps their last states."""
    discrete, rng = nh.discretize(SYSTEMS[name], TIME_STEP), np.random.default_rng(2)
    arguments = {"restricted_velocity": rng.normal(size=(members, 2)), "steps": steps}
    plain = functools.partial(nh.ensemble, discrete, **arguments)
    reduced = functools.partial(nh.ensemble, discrete, **arguments, save_every=1, reduce=largest_exponent)
    reduced(), plain()
    slow, fast, ratio = paired(reduced, (plain,), members, 11)
    print(f"{name:7} lyapunov {1e6 * slow:8.1f} us a member of {steps} steps, plain {1e6 * fast:8.1f} us {ratio:6.1f}")


def gain(name: str) -> None:
    """Print how much faster all threads are than one; best times, since others may be using the machine."""
    discrete = nh.discretize(SYSTEMS[name], TIME_STEP)
    velocities = np.random.default_rng(0).normal(size=(MEMBERS, 2))
    best = {1: np.inf, THREADS: np.inf}
    for threads in 4 * list(best):
        numba.config.NUMBA_NUM_THREADS = threads
        begin = time.perf_counter()
        nh.ensemble(discrete, restricted_velocity=velocities, steps=10 * STEPS)
        best[threads] = min(best[threads], time.perf_counter() - begin)
    print(f"{name:7} {THREADS} threads: {best[1] / best[THREADS]:.2f} times one; load average {os.getloadavg()[0]:.1f}")


def energy_and_heading(block: nh.Ensemble) -> dict[str, np.ndarray]:
    """Return two numbers for each member of a block."""
    return {"energy": block.energy[:, -1], "heading": block.heading[:, -1]}


def many(members: int, steps: int) -> None:
    """Reduce many members, and print what memory it took."""
    discrete = nh.discretize(SYSTEMS["sleigh"], TIME_STEP)
    velocities = np.random.default_rng(1).normal(size=(members, 2))
    before = peak()
    begin = time.perf_counter()
    result = nh.ensemble(discrete, restricted_velocity=velocities, steps=steps, reduce=energy_and_heading)
    took = time.perf_counter() - begin
    for member in (0, members // 2, members - 1):
        orbit = nh.simulate(discrete, restricted_velocity=velocities[member], steps=steps)
        assert abs(result["energy"][member] - orbit.energy[-1]) < 1e-14 * orbit.energy[0]
        assert abs(result["heading"][member] - orbit.heading[-1]) < 1e-13
    arguments = velocities.nbytes / 2**20
    print(f"{members:,} members x {steps} steps with reduce: {took:.1f} s, all threads, checks included")
    print(f"starts {arguments:.0f} MiB; peak {before:.0f} MiB before the call, {peak():.0f} MiB after it")


def peak() -> float:
    """Return the largest resident memory so far, in MiB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def main() -> None:
    """Print the table."""
    parser = options(__doc__)
    parser.add_argument("--members", type=int, default=small(10_000_000, 1000), help="of the reduced ensemble")
    chosen = parser.parse_args()
    both = tuple(built("ensemble.c", ("top", "sleigh"), strict=strict) for strict in (False, True))
    print(HEADER)
    for name in SYSTEMS:
        for posed in (True, False):
            compare(both, name, posed)
        gain(name)
    many(chosen.members, 10)
    for name in SYSTEMS:
        tangents(name)


if __name__ == "__main__":
    main()
