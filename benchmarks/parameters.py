"""Ensembles of a system in coordinates with a mass for each member beside the same with one: process time, in turns.

The third column has the mass within the function, as a constant. What a member alone ends with is checked to the bit.
Then the first run of a system, which compiles it, beside that of the same one with another mass.

    python benchmarks/parameters.py [--members 1000] [--rounds 9] [--smoke]
"""

import statistics
import time
from collections.abc import Callable
from typing import Any

import jax.numpy as jnp
import numpy as np
from _command import options as command
from _command import small

import nonholo as nh

STEP = 0.05
START = {"configuration": (0.0, 0.0, 0.0), "body_velocity": (1.0, 0.1, 1.0)}


def sleigh(q: Any, v: Any, p: Any) -> Any:
    """Return the Lagrangian of a sleigh on a wavy ground."""
    return (p["mass"] * (v[0] ** 2 + v[1] ** 2) + 0.3 * v[2] ** 2) / 2 - 0.2 * jnp.sin(q[0])


def blade(q: Any, _: Any) -> Any:
    """Return the constraint of its blade."""
    return jnp.array([[-jnp.sin(q[2]), jnp.cos(q[2]), -0.1]])


def spent(run: Callable[[], Any]) -> float:
    """Return the process time of a run in milliseconds."""
    begin = time.process_time()
    run()
    return (time.process_time() - begin) * 1e3


def main() -> None:
    """Print two tables."""
    parser = command(__doc__)
    parser.add_argument("--members", type=int, default=small(1000, 5))
    parser.add_argument("--rounds", type=int, default=small(9, 1))
    options = parser.parse_args()
    system = nh.LagrangeDAlembert(sleigh, blade, dimension=3, parameters={"mass": 1.0})
    fixed = nh.LagrangeDAlembert(lambda q, v: sleigh(q, v, {"mass": 1.0}), lambda q: blade(q, None), dimension=3)
    first = [spent(lambda s=s: nh.simulate(nh.discretize(s, STEP), **START, steps=100)) for s in (system, fixed)]
    other = spent(lambda: nh.simulate(nh.discretize(system.with_parameters(mass=2.0), STEP), **START, steps=100))
    masses = np.linspace(0.5, 2.0, options.members)
    maps, starts = [nh.discretize(s, STEP) for s in (system, fixed)], np.tile(START["body_velocity"], (len(masses), 1))
    print(
        f"first run {first[0]:.0f} ms, another mass {other:.1f} ms; with a constant {first[1]:.0f} ms, each mass anew"
    )
    print("\n| steps | one mass, ms | a mass each | ratio | a constant |\n| ---: | ---: | ---: | ---: | ---: |")
    for steps in small((100, 2000), (10,)):
        run = {"configuration": START["configuration"], "body_velocity": starts, "steps": steps}
        many = nh.ensemble(maps[0], **run, parameters={"mass": masses})
        alone = nh.simulate(nh.discretize(system.with_parameters(mass=masses[3]), STEP), **START, steps=steps)
        assert np.array_equal(many.configuration[3, -1], alone.configuration[-1])
        kinds = [
            lambda run=run: nh.ensemble(maps[0], **run),
            lambda run=run: nh.ensemble(maps[0], **run, parameters={"mass": masses}),
            lambda run=run: nh.ensemble(maps[1], **run),
        ]
        times = np.array([[spent(kind) for kind in kinds] for _ in range(options.rounds)])
        ratio = statistics.median(times[:, 1] / times[:, 0])
        one, each, constant = np.median(times, axis=0)
        print(f"| {steps} | {one:.0f} | {each:.0f} | {ratio:.2f} | {constant:.0f} |", flush=True)


if __name__ == "__main__":
    main()
