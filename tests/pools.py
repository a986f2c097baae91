"""Runs in forked processes: a program that prints what a pool gives of runs of which one folds, and what JAX says.

python pools.py POOL BODY  # "executor" or "pool", "sleigh" or "top"
python pools.py jax sleigh       # used by the parent, then by its forked child
"""

import concurrent.futures
import multiprocessing
import os
import sys
import warnings

import numpy as np

import nonholo as nh

SLEIGH = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5), 0.5)
TOP = nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 0.5)
DISCRETE = {"sleigh": SLEIGH, "top": TOP}[sys.argv[2]]
VELOCITIES = ((0.1, 0.1), (3.0, -200.0), (0.2, 0.2))  # the second one folds


def run(velocity: tuple[float, float]) -> nh.Orbit:
    """Return a run."""
    return nh.simulate(DISCRETE, restricted_velocity=velocity, steps=5)


def energy(orbit: nh.Orbit) -> float:
    """Return the energy at the end of a run."""
    return float(orbit.energy[-1])


def by_executor() -> None:
    """Print each result, or the error in its place."""
    with concurrent.futures.ProcessPoolExecutor(2, multiprocessing.get_context("fork")) as pool:
        futures = [pool.submit(run, velocity) for velocity in VELOCITIES]
        print(*(repr(each.exception()) if each.exception() else energy(each.result()) for each in futures), sep="\n")  # noqa: T201


def by_pool() -> None:
    """Print the error that a map raises, then what the pool still does."""
    with multiprocessing.get_context("fork").Pool(2) as pool:
        try:
            pool.map(run, VELOCITIES)
        except nh.OutcomeError as failure:
            print(repr(failure))  # noqa: T201
        print(*map(energy, pool.map(run, VELOCITIES[::2])), sep="\n")  # noqa: T201


def by_jax() -> None:
    """Print what a child says that was forked after JAX was used, and that its compiled runs continue."""
    warnings.simplefilter("ignore")  # JAX warns of the fork
    nh.step(SLEIGH, np.array([0.1, 0.1]))
    child = os.fork()
    if child:
        sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
    try:
        nh.step(SLEIGH, np.array([0.1, 0.1]))
    except RuntimeError as failure:
        print(failure, energy(run(VELOCITIES[0])), sep="\n", flush=True)  # noqa: T201
    os._exit(0)


if __name__ == "__main__":
    run(VELOCITIES[0])  # compiles before the first fork
    {"executor": by_executor, "pool": by_pool, "jax": by_jax}[sys.argv[1]]()
