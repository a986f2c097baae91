"""Many sleighs are parked at once: time per member, how many arrive, and with how much effort.

    python benchmarks/steering.py [--members 1000] [--rounds 3]

Starts are random poses (angles, and places within some units of length) and velocities, goals the pose at the origin,
at rest; 40 steps over 4 units of time, with torque and thrust along the blade. The first call compiles. Seconds of the
processor stand beside those of the clock, which grow with whatever else runs.
"""

import argparse
import statistics
import time

import numpy as np

import nonholo as nh

STEPS, TIME_STEP = 40, 0.1


def main() -> None:
    """Print all figures."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--members", type=int, default=1000)
    options.add_argument("--rounds", type=int, default=3)
    chosen = options.parse_args()
    rng, count = np.random.default_rng(0), chosen.members
    sleigh = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.2), TIME_STEP)
    poses = np.array([nh.SE(2).random(rng) for _ in range(count)])
    start = {"configuration": poses, "restricted_velocity": rng.normal(scale=0.5, size=(count, 2))}
    goal = {"configuration": np.eye(3), "restricted_velocity": (0.0, 0.0)}
    times, used = [], []
    for _ in range(1 + chosen.rounds):
        begun, busy = time.perf_counter(), time.process_time()
        parked = nh.steer(sleigh, start, goal, steps=STEPS)
        times.append(1e3 * (time.perf_counter() - begun) / count)
        used.append(1e3 * (time.process_time() - busy) / count)
    clock, processor = statistics.median(times[1:]), statistics.median(used[1:])
    print(f"{clock:.1f} ms a member ({processor:.1f} ms of the processor), {times[0]:.1f} ms in the first call")
    met = int((parked.missed < 1e-8).sum())
    print(f"{met} of {count} meet pose and velocity to 1e-8, {parked.failures} are not at a minimum")
    print(f"effort: median {np.median(parked.cost):.3f}, largest {parked.cost.max():.1f}")


if __name__ == "__main__":
    main()
