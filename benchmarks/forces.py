"""Steps with forces beside free ones, in the kernel: process time of runs of a top and a sleigh, in turns.

Functions are compiled, and one is run in Python for comparison; a step calls one four times, or more often where it
depends on the velocity.

A table of zeros must give the free run first. Free runs of an unbalanced body end at an equilibrium, where
one correction solves a step; what moves on under a weight may need two, so there is a balanced top as well.

With --drift, not speed: how the error of T + U grows under weights in a million steps.

    python benchmarks/forces.py [--steps 400000] [--rounds 15] [--drift] [--smoke]
"""

import dataclasses
import itertools
import math
import statistics
import time
from typing import Any

import numba
import numpy as np
from _command import options, small
from _inside import kernels

import nonholo as nh

BODIES = {
    "top": nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]),
    "balanced top": nh.SuslovTop(np.diag([1.0, 1.2, 0.7])),
    "sleigh": nh.ChaplyginSleigh(1.0, 1.0, 0.5),
}


def push(time: float, g: np.ndarray, w: np.ndarray) -> tuple[float, float, float]:
    """Return a force of the time."""
    return 1e-3 * math.sin(time), 0.0 * g[0, 0] * w[0], 0.0


def drag(time: float, g: np.ndarray, w: np.ndarray) -> tuple[float, float, float]:
    """Return a force of the velocity."""
    return -1e-6 * w[0] * abs(w[0]), 0.0 * g[0, 0] * time, -1e-6 * w[2]


def forced(system: Any, steps: int) -> dict[str, nh.Forced]:
    """Return the system under forces of each kind."""
    n = 3 if system.group == nh.SO(3) else 2
    heavy, rub = nh.Gravity([0.1, -0.2, -1.0][:n], [0.1, 0.2, 0.3][:n]), nh.Friction(1e-6 * np.ones(3))
    table = 1e-3 * np.sin(1e-3 * np.arange(steps + 1))[:, None] * np.ones(3)
    return {
        "zeros": nh.Forced(system, force=np.zeros((1, 3))),
        "table": nh.Forced(system, force=table),
        "friction": nh.Forced(system, force=rub),
        "friction and table": nh.Forced(system, force=(rub, table)),
        "weight": nh.Forced(system, heavy),
        "weight and friction": nh.Forced(system, heavy, rub),
        "weight by kicks": nh.Forced(system, heavy, scheme="variational"),
        "spring": nh.Forced(system, nh.Spring([0.1, 0.2, 0.3][:n], [1.0, -0.5, 0.3][:n], 1e-3, 0.2)),
        "function of time": nh.Forced(system, force=numba.njit(push)),
        "of velocity": nh.Forced(system, force=numba.njit(drag)),
        "in Python": nh.Forced(system, force=drag),
    }


TENSOR, DOWN = np.diag([1.0, 1.2, 0.7]), (0.0, 0.0, -1.0)
ASIDE, ON_AXIS = nh.Gravity(DOWN, [0, 0.1, 0.4]), nh.Gravity(DOWN, [0, 0, 0.4])
HEAVY: dict[str, tuple[nh.Forced, tuple[float, ...]]] = {
    "free body": (nh.Forced(nh.RigidBody(TENSOR), ASIDE), (0.3, 0.2, 1.0)),
    "top, weight on its axis": (nh.Forced(nh.SuslovTop(TENSOR), ON_AXIS), (0.3, 0.2, 0.0)),
    "top, weight beside it": (nh.Forced(nh.SuslovTop(TENSOR), ASIDE), (0.3, 0.2, 0.0)),
    "top, coupled": (nh.Forced(BODIES["top"], ASIDE), (0.3, 0.2, 0.0)),
    "knife edge on a slope": (nh.Forced(nh.ChaplyginSleigh(1, 1, 0), nh.Gravity([0.4, 0], [0, 0])), (0.7, 0.2, 0.0)),
    "sleigh on a slope": (nh.Forced(BODIES["sleigh"], nh.Gravity([0.4, 0], [0.5, 0])), (0.7, 0.2, 0.0)),
}


def drift(steps: int) -> None:
    """Print the largest error of T + U in tenths of a run, at two step sizes."""
    for name, (system, velocity) in HEAVY.items():
        for h, scheme in itertools.product((0.05, 0.025), ("variational", "energy")):
            discrete = nh.discretize(dataclasses.replace(system, scheme=scheme), h)
            orbit = nh.simulate(discrete, body_velocity=velocity, steps=steps, save_every=50, throw=False)
            errors = [np.abs(part - orbit.energy[0]).max() for part in np.array_split(orbit.energy, 10)]
            kinetic = orbit.energy - system.potential_energy(orbit.configuration)
            text = " ".join(f"{errors[j]:.2e}" for j in (0, 3, 6, 9))
            done = f"{len(orbit) * 50 - 50} steps, tenths 1 4 7 10: {text}; T to {kinetic.max():.3g}"
            print(f"{name}, {scheme}, h = {h}: {done}")


def main() -> None:
    """Print nanoseconds per step and the ratios to the free step, medians of pairs."""
    parser = options(__doc__)
    parser.add_argument("--steps", type=int, default=small(400_000, 400))
    parser.add_argument("--rounds", type=int, default=small(15, 1))
    parser.add_argument("--drift", action="store_true")
    arguments = parser.parse_args()
    if arguments.drift:
        drift(small(1_000_000, 1000))
        return
    for name, system in BODIES.items():
        for h in (0.1, 0.005):
            routes = {kind: nh.discretize(each, h).route for kind, each in forced(system, arguments.steps).items()}
            routes = {"free": nh.discretize(system, h).route} | routes
            counts = {kind: 200 if route.compiled_route is None else arguments.steps for kind, route in routes.items()}
            durations: dict[str, list[float]] = {kind: [] for kind in routes}
            ends = {}
            for _ in range(arguments.rounds + 1):
                for kind, route in routes.items():
                    body, rows = route.body, tuple(np.empty((arguments.steps, width)) for width in route.sizes)
                    start = route.encode(np.array([0.4, 0.9])), route.encode_poses(np.asarray(system.frame_pose))
                    _, state = kernels.runs_of(body).start(body, *start)
                    begun, count = time.process_time(), counts.get(kind, arguments.steps)
                    done = kernels.runs_of(body).advance(body, state, count, 1, rows)
                    durations[kind].append((time.process_time() - begun) / count * 1e9)
                    if done != (count, 0):
                        raise RuntimeError(f"{name}, {kind}: {done}")
                    ends[kind] = [row[-1].copy() for row in rows]
            rounding = arguments.steps * 2**-53  # of places that are summed, relative
            if not all(np.allclose(b, a, rounding, 1e-9) for a, b in zip(ends["free"], ends["zeros"], strict=True)):
                raise RuntimeError("A table of zeros changes the motion.")
            texts = []
            for kind, times in durations.items():
                ratio = statistics.median(np.array(times[1:]) / np.array(durations["free"][1:]))
                texts.append(f"{kind} {statistics.median(times[1:]):.1f} ({ratio:.2f})")
            print(f"{name}, h = {h}: ns per step " + ", ".join(texts))


if __name__ == "__main__":
    main()
