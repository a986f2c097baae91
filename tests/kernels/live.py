"""Live motions that reach every compiled function: a program that prints the bits of each, or what each calls.

python live.py bits [NAME ...]   # a digest of the results of each run
NUMBA_DISABLE_JIT=1 python live.py calls   # the functions that are called
"""

import functools
import hashlib
import itertools
import json
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeAlias

import numba
import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))
from bodies import GENERAL, PAST_PI, mass_tensor, random_rows

import nonholo as nh
from nonholo.kernels.forced import _balanced

Arrays: TypeAlias = list[np.ndarray]

SIZE, STEP = 2.0, 0.5  # of velocities and of the time step: motions that turn far, and some that end
TOP = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
SLEIGH = nh.ChaplyginSleigh(1.0, 1.0, 0.5)
SLOPE = nh.Gravity([1.0, -0.5], [0.5, 0.25])
MEMBERS, STEPS, SHARES, WIDE, LONG = (
    (40, 2, (1.0,), 0.2, (0.8,)) if sys.argv[1:2] == ["calls"] else (4000, 100, (0.1, 0.5, 1.0), SIZE, (0.8, 3.0))
)


def members(system: Any, varied: tuple[str, ...] = ()) -> Arrays:
    """Run an ensemble, with masses or tensors that vary."""
    rng = np.random.default_rng(1)
    velocities, scale = SIZE * rng.normal(size=(MEMBERS, 2)), rng.uniform(1, 2, MEMBERS)
    own = {name: np.multiply.outer(scale, getattr(system, name)) for name in varied}
    batch = nh.ensemble(nh.discretize(system, 1.0), restricted_velocity=velocities, steps=STEPS, parameters=own)
    return [batch.reduced_momentum, batch.cayley, batch.pose, batch.outcome, batch.steps_done]


def orbits(system: Any, order: int = 2, rank: int | None = None, size: float = SIZE) -> Arrays:
    """Run single orbits from starts of several sizes, the first ones to the end, and step each state back."""
    rng, result = np.random.default_rng(2), []
    discrete = nh.discretize(system, STEP, order=order)
    for share in SHARES:
        velocity = rng.normal(size=rank or system.rank)
        velocity *= share * size / np.linalg.norm(velocity)
        orbit = nh.simulate(discrete, restricted_velocity=velocity, steps=STEPS, throw=False)
        result += [orbit.reduced_momentum, orbit.cayley, orbit.pose]
        defect = nh.invariants(orbit).reversal_defect if len(orbit) > 1 else None
        result += [np.array(np.nan if defect is None else defect)]
    return result


def forced(system: Any) -> Arrays:
    """Run single orbits under a weight with friction, and with a force for each step."""
    rng, result = np.random.default_rng(3), []
    n, velocity = system.group.size - system.has_blade, rng.normal(size=system.rank)
    heavy, rub = nh.Gravity(rng.normal(size=n), rng.normal(size=n)), nh.Friction(rng.uniform(0, 1, system.group.dim))
    for force in (rub, rng.normal(size=(STEPS, system.group.dim))):
        discrete = nh.discretize(nh.Forced(system, heavy, force), STEP / 10)
        orbit = nh.simulate(discrete, restricted_velocity=velocity, steps=STEPS, throw=False)
        result += [orbit.reduced_momentum, orbit.cayley, orbit.pose]
    return result


def balanced(system: Any) -> Arrays:
    """Run single orbits under springs, by kicks, and in steps so long that roots are followed, some to their end."""
    n = system.group.size - system.group.is_affine
    heavy, spring = nh.Gravity(np.ones(n), np.ones(n)), nh.Spring(np.ones(n), np.zeros(n), 2.0, 0.3)
    cases = (spring, None, 0.1), (heavy, "variational", 0.05), *itertools.product((heavy, spring), (None,), LONG)
    runs = []
    for potential, scheme, step in cases:
        discrete = nh.discretize(nh.Forced(system, potential, scheme=scheme), step)
        for size in (0.3, 1.5):
            start = {"restricted_velocity": size * np.linspace(1.0, -0.7, system.rank)}
            orbit = nh.simulate(discrete, **start, steps=STEPS, throw=False)
            runs += [orbit.restricted_momentum, orbit.cayley, orbit.canonical_pose]
    return runs


@numba.njit
def _pushed(time: float, g: np.ndarray, w: np.ndarray) -> np.ndarray:
    return (0.3 - 0.1 * time) * g[0, 0] - w * w


@numba.njit
def _drag(time: float, g: np.ndarray, w: np.ndarray) -> np.ndarray:  # noqa: ARG001
    return -1e3 * np.abs(w) * w


@numba.njit
def _thrust(time: float, g: np.ndarray, w: np.ndarray) -> np.ndarray:  # noqa: ARG001
    return 1e2 * np.abs(w) * w


@numba.njit
def _well(g: np.ndarray) -> float:
    return 0.2 * g[0, 1] * g[0, 1] + 0.1 * g[1, 2]


def driven(system: Any) -> Arrays:
    """Run single orbits under functions that are compiled, where compilation is not turned off."""
    result = []
    forces = _pushed, nh.Friction(np.linspace(0.1, 0.2, system.group.dim)), _drag, _thrust
    for force, scheme in itertools.product(forces, (None, "variational")):
        discrete = nh.discretize(nh.Forced(system, _well, force, scheme), STEP / 10)
        velocity = np.linspace(0.5, -0.3, system.rank)
        orbit = nh.simulate(discrete, restricted_velocity=velocity, steps=STEPS, throw=False)
        result += [orbit.reduced_momentum, orbit.cayley, orbit.pose]
    return result


def nearest(system: Any) -> Arrays:
    """Follow every real value over a momentum, some to the end."""
    discrete, result = nh.discretize(system, STEP), []
    values = nh.displacements_over(discrete, SIZE * np.ones(len(system.constraint_subspace)))
    for W in values.displacement[values.is_real].real:
        orbit = nh.simulate(discrete, displacement=W, steps=STEPS, branch="nearest", throw=False)
        result += [orbit.reduced_momentum, orbit.cayley, orbit.pose]
    return result


def read(system: Any) -> Arrays:
    """Return what is read of a motion."""
    names = ["body_velocity", "energy", "momentum", "configuration", "displacement", "multipliers", "tangent"]
    names += ["position"] if system.has_blade else []
    orbit = nh.simulate(nh.discretize(system, STEP), restricted_velocity=(0.4, -0.7), steps=STEPS)
    return [getattr(orbit, name) for name in names]


def past_pi() -> Arrays:
    """Return a step whose principal path passes angle pi, where all unknowns are followed."""
    discrete = nh.discretize(nh.SuslovTop(PAST_PI), 1.0)
    orbit = nh.simulate(discrete, momentum=(-1.718, -1.87, 1.66), steps=1, throw=False)
    return [orbit.reduced_momentum, orbit.cayley]


def flows(system: Any, method: str | None = None, *, reconstruct: bool = True) -> Arrays:
    """Return a continuous motion, and states between, with poses or without."""
    velocity = np.random.default_rng(4).normal(size=system.rank) / np.sqrt(system.rank)
    how: dict[str, Any] = {"times": np.linspace(0.0, 5.0, 6), "method": method, "reconstruct": reconstruct}
    orbit = nh.flow(system, restricted_velocity=velocity, **how)
    both = orbit, orbit.at(np.linspace(4.9, 0.1, 7))
    return [x for each in both for x in (each.reduced_momentum, each.canonical_pose) if x is not None]


def members_of_flows(system: Any) -> Arrays:
    """Return the continuous motions of an ensemble."""
    velocities = SIZE * np.random.default_rng(7).normal(size=(MEMBERS // 4, 2))
    batch = nh.ensemble(system, restricted_velocity=velocities, times=np.linspace(0.0, 5.0, 3))
    return [batch.reduced_momentum, batch.canonical_pose]


def in_coordinates() -> Arrays:
    """Run a snakeboard to the end of its motion, and a driven sleigh."""
    result = []
    for ready in (nh.examples.snakeboard(), nh.examples.driven_sleigh()):
        how = {"configuration": ready.configuration, "body_velocity": ready.body_velocity}
        orbit = nh.simulate(nh.discretize(ready.system, 0.1), **how, steps=MEMBERS, throw=False)
        result += [orbit.configuration, orbit.momentum, orbit.multipliers, orbit.energy]
    return result


def body(group: Any, k: int, seed: int) -> nh.LLSystem:
    """Return a body with a random constraint."""
    rng = np.random.default_rng(seed)
    return nh.LLSystem(group, mass_tensor(group, rng), random_rows(group, k, rng))


def top(n: int) -> nh.SuslovTop:
    """Return a top in n dimensions."""
    return nh.SuslovTop(mass_tensor(nh.SO(n), np.random.default_rng(n)))


def sleigh(n: int) -> nh.MultidimensionalSleigh:
    """Return a sleigh in n dimensions."""
    rng = np.random.default_rng(n)
    return nh.MultidimensionalSleigh(1.3, 0.4 * rng.normal(size=n) / np.sqrt(n), mass_tensor(nh.SO(n), rng))


ANY, SPACE, TURNED = (GENERAL[kind][0] for kind in ("any d on SO(4)", "any d on SE(3)", "right-invariant on SE(3)"))
HANGING = nh.Forced(TOP, nh.Gravity([0.1, -0.2, -2.0], [0.2, 0.1, 0.5]))
SLIDING = nh.Forced(SLEIGH, SLOPE, nh.Friction([0.1, 0.3, 0.2]))
OBLIQUE_BLADE = nh.LLSystem(nh.SE(2), np.diag([0.6, 0.7, 1.0]), annihilator=[[0.2, -0.6, 0.8]])
OBLIQUE_TOP = nh.LLSystem(nh.SO(3), TOP.mass_tensor, annihilator=[[1.0, 2.0, 2.0]])
WIDE_SLEIGH = nh.MultidimensionalSleigh.arrowhead(
    1.3, np.linspace(0.4, 0, 200), np.linspace(1, 2, 200), np.full(199, 0.01)
)
_order_4 = functools.partial(orbits, order=4)
MOTIONS: dict[str, list[Callable[[], Arrays]]] = {
    "members": [functools.partial(members, each) for each in (SLEIGH, TOP, OBLIQUE_BLADE, OBLIQUE_TOP)],
    "members of their own": [lambda: members(SLEIGH, ("mass", "inertia")), lambda: members(TOP, ("mass_tensor",))],
    "orbits": [functools.partial(orbits, each) for each in (TOP, SLEIGH, top(5), top(30), sleigh(4), sleigh(30))],
    "orbits by matrices": [functools.partial(orbits, each) for each in (ANY, SPACE, TURNED)],
    "orbits of order 4": [functools.partial(_order_4, each) for each in (TOP, SLEIGH, top(5), sleigh(4), ANY)],
    "slow orbits": [functools.partial(orbits, SPACE, size=0.1)],
    "orbits of many rows": [functools.partial(orbits, body(nh.SO(n), k, n), size=WIDE) for n, k in ((8, 4), (5, 3))],
    "folds": [functools.partial(orbits, each, size=20.0) for each in (ANY, top(5))],
    "past pi": [past_pi],
    "nearest values": [functools.partial(nearest, each) for each in (TOP, SLEIGH)],
    "what is read": [functools.partial(read, each) for each in (TOP, nh.ChaplyginSleigh(2.0, 0.7, -0.5, 0.3))],
    "flows": [functools.partial(flows, each) for each in (TOP, SLEIGH, HANGING, SLIDING, TURNED)],
    "flows in closed form": [functools.partial(flows, TOP, "closed_form")],
    "momenta of flows": [functools.partial(flows, WIDE_SLEIGH, reconstruct=False)],
    "members of flows": [functools.partial(members_of_flows, each) for each in (TOP, SLEIGH, SLIDING)],
    "springs and kicks": [functools.partial(balanced, each) for each in (TOP, SLEIGH)],
    "forces": [
        functools.partial(forced, each) for each in (TOP, SLEIGH, top(4), ANY, nh.RigidBody(np.diag([1.0, 1.2, 0.7])))
    ],
    "functions": [functools.partial(driven, each) for each in (TOP, SLEIGH, top(4))],
    "coordinates": [in_coordinates],
}
RUNS = {f"{name} {k}": run for name, runs in MOTIONS.items() for k, run in enumerate(runs)}


def digest(arrays: Arrays) -> str:
    """Return a digest of the bits of arrays."""
    text = hashlib.sha256()
    for array in arrays:
        text.update(np.ascontiguousarray(array).tobytes())
    return text.hexdigest()


def called() -> list[str]:
    """Run everything as plain Python and return the places of the functions that were called."""
    places = set()
    _balanced._PIECES, _balanced._SMALLEST = 40, 1e-3  # paths that are lost are given up sooner, by the same functions

    def note(frame: Any, event: str, _: Any) -> None:
        if event == "call" and "nonholo" in frame.f_code.co_filename:
            places.add(f"{frame.f_code.co_filename}:{frame.f_code.co_name}")

    threading.setprofile(note)  # ensembles run in threads
    sys.setprofile(note)
    for run in RUNS.values():
        run()
    sys.setprofile(None)
    return sorted(places)


if __name__ == "__main__":
    if sys.argv[1] == "calls":
        sys.stdout.write(json.dumps(called()))
    else:
        names = sys.argv[2:] or RUNS
        sys.stdout.write(json.dumps({name: digest(RUNS[name]()) for name in names}))
