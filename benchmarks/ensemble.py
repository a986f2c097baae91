"""Ensembles beside vectorized C (`c/ensemble.c`, built here), in one run, in turns; medians of ratios.

Both sides are checked to end at the same states before anything is timed. "kernel" is the compiled loop in one thread,
"call" the whole `ensemble` with its checks, in one thread and in all threads; the C code runs in one. Then ten million
members are reduced block by block, and the peak of the memory is shown beside that of their starts.

    python benchmarks/ensemble.py
"""

import argparse
import ctypes
import os
import resource
import time

import numba
import numpy as np
from against_c import built, paired, pointer

import nonholo as nh
from nonholo import kernels

THREADS = numba.config.NUMBA_NUM_THREADS
MEMBERS, STEPS, TIME_STEP = 100_000 - 100_000 % 32, 200, 0.05
SYSTEMS = {
    "top": nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]),
    "sleigh": nh.ChaplyginSleigh(1.0, 1.0, 0.5),
}


def kernel_rows(posed: bool) -> kernels.MemberRows:
    """Return rows for the last states."""
    shapes = (1, 2), (1, 2), (int(posed), 4)
    states = (np.empty((MEMBERS, *shape)) for shape in shapes)
    return kernels.MemberRows(*states, *np.zeros((2, MEMBERS), dtype=np.int64))


def compare(found: ctypes.CDLL, name: str, posed: bool) -> None:
    """Print nanoseconds per step and member of the kernel, the call in one thread and in all threads, and of C."""
    discrete = nh.discretize(SYSTEMS[name], TIME_STEP)
    velocities = np.random.default_rng(0).normal(size=(MEMBERS, 2))
    step, run = discrete.route, getattr(found, name)
    body = np.array(step.body, dtype=np.float64)
    first = step.encode(velocities @ discrete.system.constrained_inertia)
    unit, rows = np.tile((1.0, 0.0, 0.0, 0.0), (MEMBERS, 1)), kernel_rows(posed)
    m, q = first.copy(), unit.copy()

    def reference() -> None:
        m[:], q[:] = first, unit
        last = pointer(q if posed else None)
        uncertain = run(pointer(body), pointer(m), last, ctypes.c_long(MEMBERS), ctypes.c_long(STEPS))
        assert uncertain == 0

    def kernel() -> None:
        kernels.advance_members(step.body, None, first, unit, STEPS, 0, rows, np.zeros(1, dtype=np.bool_))

    def call() -> nh.Ensemble:
        return nh.ensemble(discrete, restricted_velocity=velocities, steps=STEPS, reconstruct=posed)

    reference()
    kernel()
    scale = np.abs(first).max()
    assert np.abs(m - rows.momenta[:, 0]).max() < 1e-13 * scale
    assert not posed or np.abs(q - rows.poses[:, 0]).max() < 1e-11
    assert np.abs(step.encode(call().reduced_momentum[:, 0]) - m).max() < 1e-13 * scale
    for label, threads, ours in (("kernel", 1, kernel), ("call", 1, call), ("call", THREADS, call)):
        numba.config.NUMBA_NUM_THREADS = threads
        fast, slow, ratio = paired(ours, reference, MEMBERS * STEPS)
        case = f"{name:7} {'pose' if posed else 'no pose':8} {label:7} {threads} thread{'s' if threads > 1 else ''}"
        print(f"{case:36} {fast:7.2f} ns {slow:7.2f} ns {ratio:6.2f}")


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
    found = nh.ensemble(discrete, restricted_velocity=velocities, steps=steps, reduce=energy_and_heading)
    took = time.perf_counter() - begin
    for member in (0, members // 2, members - 1):
        orbit = nh.simulate(discrete, restricted_velocity=velocities[member], steps=steps)
        assert abs(found["energy"][member] - orbit.energy[-1]) < 1e-14 * orbit.energy[0]
        assert abs(found["heading"][member] - orbit.heading[-1]) < 1e-13
    given = velocities.nbytes / 2**20
    print(f"{members:,} members x {steps} steps with reduce: {took:.1f} s, all threads, checks included")
    print(f"starts {given:.0f} MiB; peak {before:.0f} MiB before the call, {peak():.0f} MiB after it")


def peak() -> float:
    """Return the largest resident memory so far, in MiB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--members", type=int, default=10_000_000, help="of the reduced ensemble")
    chosen = parser.parse_args()
    found = built("ensemble.c", ("top", "sleigh"))
    print("case                                 library           C  ratio")
    for name in SYSTEMS:
        for posed in (True, False):
            compare(found, name, posed)
        gain(name)
    many(chosen.members, 10)


if __name__ == "__main__":
    main()
