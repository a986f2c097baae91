"""Derivatives of orbits: a gradient beside the compiled orbit in JAX, a first gradient, memory of long ones.

    python benchmarks/derivatives.py [--rounds 15] [--long 1000000] [--smoke]

Orbit and gradient are timed in turns, medians are printed. Memory is the highest of a fresh process, most of it that
of libraries and of the compiler; beside the default compiler the one without fusion emitters, where JAX has the option.
"""

import resource
import statistics
import subprocess
import sys
import time
from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
from _command import options, small

import nonholo as nh

LEAN = {"xla_cpu_use_fusion_emitters": False}
TENSOR = np.array([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
FOUR = np.diag([1.0, 2.0, 1.5, 1.0]) + 0.1
MIXED = [[1.0, 0, 1, 0.75, -0.5, 0.75], [0, 1.0, 0, 0.5, 0.25, -1], [1, 1, 0, 1, 0.5, -0.75]]
BODIES: dict[str, tuple[Callable, np.ndarray]] = {
    "top": (nh.SuslovTop, TENSOR),
    "sleigh": (lambda x: nh.ChaplyginSleigh(*x), np.array([1.5, 0.7, 0.4, 0.2])),
    "top, n = 4": (nh.SuslovTop, FOUR),
    "three directions of SE(3)": (lambda x: nh.LLSystem(nh.SE(3), x, constraint_subspace=MIXED), FOUR),
}


def end_of(name: str, steps: int, save_every: int) -> tuple[Callable, tuple]:
    """Return a number that the end of an orbit has, as a function of body and start, and where to take it."""
    build, numbers = BODIES[name]
    velocity = np.linspace(0.3, 0.5, build(numbers).rank)

    def end(numbers: jax.Array, velocity: jax.Array) -> jax.Array:
        discrete = nh.discretize(build(numbers), 0.05)
        orbit = nh.rollout(discrete, restricted_velocity=velocity, steps=steps, save_every=save_every)
        return jnp.sum(orbit.restricted_momentum[-1]) + jnp.sum(jnp.sin(orbit.configuration[-1]))

    return end, (numbers, velocity)


def compare(name: str, rounds: int) -> None:
    """Print a first gradient, and an orbit of 1000 steps beside its gradient."""
    end, at = end_of(name, 1000, 1)
    gradient, orbit = jax.jit(jax.grad(end, argnums=(0, 1))), jax.jit(end)
    used, began = time.process_time(), time.perf_counter()
    jax.block_until_ready(gradient(*at))
    used, began = time.process_time() - used, time.perf_counter() - began
    jax.block_until_ready(orbit(*at))
    times: list[list[float]] = [[], []]
    for _ in range(rounds):
        for function, row in zip((orbit, gradient), times, strict=True):
            start = time.perf_counter()
            jax.block_until_ready(function(*at))
            row.append(time.perf_counter() - start)
    one, other = (1e3 * statistics.median(row) for row in times)
    ratio = statistics.median(b / a for a, b in zip(*times, strict=True))
    first = f"first gradient {began:.1f} s ({used:.1f} s of the processor)"
    print(f"{name}: orbit {one:.2f} ms, gradient {other:.2f} ms, {ratio:.1f} times; {first}", flush=True)


def long_gradient(steps: int, options: dict[str, bool]) -> None:
    """Print the time of a gradient of a top and what memory its process has used at most, in MB."""
    end, at = end_of("top", steps, steps)
    began = time.perf_counter()
    result = jax.block_until_ready(jax.jit(jax.grad(end, argnums=(0, 1)), compiler_options=options)(*at))
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(time.perf_counter() - began, peak, float(jnp.abs(result[1]).max()))


def main() -> None:
    """Print all figures."""
    parser = options(__doc__)
    parser.add_argument("--rounds", type=int, default=small(15, 1))
    parser.add_argument("--long", type=int, default=small(1_000_000, 2000))
    parser.add_argument("--only", type=int)
    parser.add_argument("--lean", action="store_true")
    chosen = parser.parse_args()
    with jax.enable_x64(True):
        if chosen.only:
            long_gradient(chosen.only, LEAN if chosen.lean else {})
            return
        for name in small(list(BODIES), ["top"]):
            compare(name, chosen.rounds)
    for lean in small(([], ["--lean"]), ([],)):
        for steps in (1000, chosen.long):
            command = [sys.executable, __file__, "--only", str(steps), *lean]
            seconds, peak, size = map(float, subprocess.check_output(command, text=True).split())  # noqa: S603
            how = f"gradient of {steps} steps of a top {' '.join(lean)}"
            print(f"{how}: {seconds:.1f} s, {peak:.0f} MB, size {size:.3g}", flush=True)


if __name__ == "__main__":
    main()
