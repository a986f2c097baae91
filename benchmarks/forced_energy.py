"""Not speed: what rounding makes of T + U in 100,000 steps, for each kind of body, order and step size.

The drift is the largest error of T + U, the slope a line through the errors, a step; both are relative to the largest
T + |U - U_0| of the orbit. Beside them stands the slope of the free map from the same start. A body that has no more
principal displacement ends early, with the outcome that is printed.

    python benchmarks/forced_energy.py [--steps 100000] [--body NAME] [--order 2] [--time-step 0.1] [--smoke]
"""

from typing import Any

import numpy as np
from _command import options, small

import nonholo as nh

RNG = np.random.default_rng(18)
LORENTZ = np.diag([1.0, 1.0, -1.0])
SO21 = nh.MatrixGroup(LORENTZ @ nh.SO(3).basis, form=LORENTZ)
TOP = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
SLEIGH = nh.ChaplyginSleigh(1.0, 1.0, 0.5)
BOOSTED = nh.LLSystem(SO21, np.diag([4.0, 6.0, 9.0]) @ LORENTZ, [[0.3, 0.8, 0.3], [-1.3, 0.9, 0.4]])


def tensor(n: int) -> np.ndarray:
    """Return a mass tensor of n rows."""
    A = RNG.normal(size=(n, n)) / 4
    return A @ A.T + np.diag(np.linspace(0.6, 1.2, n))


def any_rows(group: Any, k: int) -> nh.LLSystem:
    """Return a body with k random rows."""
    return nh.LLSystem(group, tensor(group.size), RNG.normal(size=(k, group.dim)))


def weight(n: int) -> nh.Gravity:
    """Return a weight whose point lies beside all axes."""
    return nh.Gravity(np.linspace(0.2, -0.6, n), np.linspace(0.1, 0.4, n))


def spring(n: int) -> nh.Spring:
    """Return a spring to a point near the origin."""
    return nh.Spring(np.linspace(0.2, 0.4, n), np.linspace(0.5, -0.3, n), 0.5, 0.3)


BODIES: dict[str, tuple[float, nh.Forced]] = {
    "top, weight": (1e-13, nh.Forced(TOP, weight(3))),
    "top, linear": (1e-13, nh.Forced(TOP, nh.Linear(0.3 * RNG.normal(size=(3, 3))))),
    "sleigh, falling": (1e-13, nh.Forced(SLEIGH, nh.Gravity([0.4, 0.0], [0.5, 0.0]))),
    "sleigh, mass behind": (1e-13, nh.Forced(nh.ChaplyginSleigh(1.0, 1.0, -0.3), nh.Gravity([0.2, 0.0], [-0.3, 0.0]))),
    "sleigh, spring": (1e-13, nh.Forced(SLEIGH, spring(2))),
    "top, n = 4": (5e-13, nh.Forced(nh.SuslovTop(tensor(4)), weight(4))),
    "top, n = 6": (5e-13, nh.Forced(nh.SuslovTop(tensor(6)), weight(6))),
    "sleigh on SE(3)": (5e-13, nh.Forced(nh.MultidimensionalSleigh(1.0, [0.3, 0.1, -0.2], tensor(3)), spring(3))),
    "3 rows on SO(4)": (5e-13, nh.Forced(any_rows(nh.SO(4), 3), weight(4))),
    "3 rows on SE(3)": (5e-13, nh.Forced(any_rows(nh.SE(3), 3), spring(3))),
    "2 rows on SO(2, 1)": (5e-13, nh.Forced(BOOSTED, nh.Linear(np.eye(3)))),
    "the same, escaping": (5e-13, nh.Forced(BOOSTED, nh.Linear(0.2 * np.eye(3)))),
}
"""The drift that is asked for at order 2, and the body."""
STAGES = {2: 1, 4: 5, 6: 9, 8: 17}


def errors(system: Any, h: float, order: int, steps: int) -> tuple[nh.Orbit, float, float]:
    """Return an orbit, its drift and its slope."""
    discrete = nh.discretize(system, h, order=order)
    start = np.linspace(0.4, -0.3, discrete.system.rank)
    orbit = nh.simulate(discrete, restricted_velocity=start, steps=steps, save_every=10, throw=False)
    if not len(orbit):
        return orbit, np.nan, np.nan
    energy, U = orbit.energy, np.zeros(len(orbit))
    if isinstance(system, nh.Forced):
        U = system.potential_energy(orbit.configuration)
    scale = (energy - U + np.abs(U - U[0])).max()
    slope = np.polyfit(orbit.step, (energy - energy[0]) / scale, 1)[0] if len(orbit) > 2 else np.nan
    return orbit, float(np.abs(energy - energy[0]).max() / scale), abs(float(slope))


def main() -> None:
    """Print a line for each body, order and step size."""
    parser = options(__doc__)
    parser.add_argument("--steps", type=int, default=small(100_000, 200))
    parser.add_argument("--body", choices=[*BODIES], action="append")
    parser.add_argument("--order", type=int, choices=[*STAGES], action="append")
    parser.add_argument("--time-step", type=float, action="append")
    arguments = parser.parse_args()
    print("| body | order | h | drift | of what is asked | slope | free | steps |\n|---|---|---|---|---|---|---|---|")
    for name in arguments.body or BODIES:
        limit, forced = BODIES[name]
        for order in arguments.order or STAGES:
            for h in arguments.time_step or small((0.01, 0.05, 0.2, 0.5), (0.05,)):
                orbit, drift, slope = errors(forced, h, order, arguments.steps)
                _, _, free = errors(forced.system, h, order, arguments.steps)
                share = drift / (limit * STAGES[order] ** 0.5)
                end = "" if orbit.outcome == nh.Outcome.successful else f", {orbit.outcome}"
                reached = max(10 * len(orbit) - 10, 0)
                row = f"{drift:.1e} | {share:.2f} | {slope:.1e} | {free:.1e} | {reached}{end}"
                print(f"| {name} | {order} | {h} | {row} |", flush=True)


if __name__ == "__main__":
    main()
