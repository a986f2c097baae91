"""What is read of a stored orbit beside the run that made it: a top and a sleigh, whole calls, time of the processor.

Each quantity must first be what it is by its definition, from the poses, the masses and the momenta of the run. Ratios
are medians of pairs: the first reading over the run of the same round. A second reading must give the same array.
Then a run into a store, beside `zarr` alone that writes the arrays of the store.

    python benchmarks/reading.py [--steps 200000] [--rounds 15] [--smoke]
"""

import statistics
import tempfile
import time
from typing import Any

import numpy as np
import zarr
from _command import SMOKE, options, small

import nonholo as nh

BODIES = {
    "top": (nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), (0.4, 0.9, 0.0)),
    "sleigh": (nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.2), (1.0, -0.6, 0.0)),
}
STEP = 0.1
MOST = {
    **dict.fromkeys(("body_velocity", "energy"), 0.5),
    **dict.fromkeys(("momentum", "restricted_momentum", "position"), 1.0),
    **dict.fromkeys(("configuration", "displacement", "multipliers"), 2.0),
    "tangent": 5.0,
}
"""The readings, and the most that each may take of the time of the run."""
MOST_OF_ZARR = 4.0


def check(orbit: nh.Orbit) -> None:
    """Refuse readings that are not what their definitions say."""
    system, group, S = orbit.system, orbit.system.group, orbit.system.constraint_subspace
    g, p, v = orbit.configuration, orbit.momentum, orbit.body_velocity
    quantities = {
        "displacement": (orbit.displacement[:-1], group.inverse(g[:-1]) @ g[1:]),
        "momentum": (p, nh.discrete_legendre(orbit.motion, orbit.displacement)),
        "restricted_momentum": (orbit.restricted_momentum, p @ S.T),
        "body_velocity": (v, np.linalg.solve(S @ system.inertia_operator @ S.T, S @ p.T).T @ S),
        "energy": (orbit.energy, np.einsum("ki,ij,kj->k", v, system.inertia_operator, v) / 2),
        "multipliers": (
            orbit.multipliers @ system.annihilator,
            p[1:] - group.coadjoint(orbit.displacement[:-1], p[:-1]),
        ),
    }
    if group.is_affine:
        quantities["position"] = (orbit.position, g[:, :2, 2])
    start, e = orbit.restricted_momentum[0], 1e-4 * np.eye(2)
    ahead, back = ([_after(orbit.motion, start + sign * row) for row in e] for sign in (1, -1))
    slopes = np.transpose(np.subtract(ahead, back)) / 2e-4
    if not np.abs(orbit.tangent[0] - slopes).max() <= 1e-7:
        raise RuntimeError(f"tangent of {system}")
    for name, (result, wanted) in quantities.items():
        if not np.abs(result - wanted).max() <= 1e-12 * max(1.0, np.abs(wanted).max()):
            raise RuntimeError(f"{name} of {system}")


def _after(discrete: nh.Discretization, momentum: np.ndarray) -> np.ndarray:
    return nh.simulate(discrete, momentum=momentum, steps=1).restricted_momentum[1]


def seconds(call: Any) -> tuple[float, Any]:
    """Return the time of a call, and its result."""
    begun = time.process_time()
    result = call()
    return time.process_time() - begun, result


def stored(body: str, steps: int, rounds: int) -> float:
    """Return the time of a run into a store over that of `zarr` for the same arrays."""
    system, velocity = BODIES[body]
    discrete, ratios = nh.discretize(system, STEP), []
    for _ in range(rounds + 1):
        with tempfile.TemporaryDirectory() as folder:
            ours, orbit = seconds(
                lambda: nh.simulate(discrete, body_velocity=velocity, steps=steps, store=f"{folder}/a.zarr")
            )
            arrays = {
                name: np.asarray(array[:]) for name, array in zarr.open_group(f"{folder}/a.zarr", mode="r").arrays()
            }
            if not np.array_equal(orbit.energy, arrays["energy"]):
                raise RuntimeError(f"the store of the {body}")

            def write() -> None:
                group = zarr.open_group(f"{folder}/b.zarr", mode="w")
                for name, values in arrays.items():  # noqa: B023
                    group.create_array(name, data=values)

            ratios.append(ours / seconds(write)[0])
    return statistics.median(ratios[1:])


def main() -> None:
    """Print nanoseconds of a state and ratios to the run."""
    parser = options(__doc__)
    parser.add_argument("--steps", type=int, default=small(200_000, 200))
    parser.add_argument("--rounds", type=int, default=small(15, 1))
    parser.add_argument("--stored", type=int, default=small(1_000_000, 200), help="steps of the run into a store")
    arguments = parser.parse_args()
    print("| reading | most | top: ns, of the run | sleigh: ns, of the run |\n| --- | ---: | ---: | ---: |")
    durations: dict[str, dict[str, list[float]]] = {}
    for body, (system, velocity) in BODIES.items():
        discrete = nh.discretize(system, STEP)
        check(nh.simulate(discrete, body_velocity=velocity, steps=100))
        names = [name for name in MOST if name != "position" or system.group.is_affine]
        durations[body] = {name: [] for name in ("run", *names)}
        for _ in range(arguments.rounds + 1):
            run, orbit = seconds(lambda: nh.simulate(discrete, body_velocity=velocity, steps=arguments.steps))  # noqa: B023
            durations[body]["run"].append(run)
            for name in names:
                first, array = seconds(lambda: getattr(orbit, name))  # noqa: B023
                durations[body][name].append(first)
                if getattr(orbit, name) is not array:
                    raise RuntimeError(f"{name} is read twice.")
    too_long = []
    for name in ("run", *MOST):
        texts = []
        for body, columns in durations.items():
            if name not in columns:
                texts.append("-")
                continue
            times, runs = columns[name][1:], columns["run"][1:]
            ratio = statistics.median(first / run for first, run in zip(times, runs, strict=True))
            texts.append(f"{statistics.median(times) / arguments.steps * 1e9:.1f}, {ratio:.2f}")
            too_long += [f"{name} of the {body}: {ratio:.2f}"] if ratio > MOST.get(name, 1.0) else []
        print(f"| {name} | {MOST.get(name, 1.0)} | {' | '.join(texts)} |")
    for body in BODIES:
        ratio = stored(body, arguments.stored, max(1, arguments.rounds // 3))
        print(f"a store of {arguments.stored} steps of the {body}: {ratio:.2f} times zarr alone")
        too_long += [f"the store of the {body}: {ratio:.2f}"] if ratio > MOST_OF_ZARR else []
    if too_long and not SMOKE:
        raise SystemExit("takes too long: " + "; ".join(too_long))


if __name__ == "__main__":
    main()
