"""Live motions that reach every compiled function: a program that prints the bits of each, or what each calls.

python live.py bits [NAME ...]   # a digest of the results of each run
NUMBA_DISABLE_JIT=1 python live.py calls   # the functions that are called
"""

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
    rng, found = np.random.default_rng(2), []
    discrete = nh.discretize(system, STEP, order=order)
    for share in SHARES:
        velocity = rng.normal(size=rank or system.rank)
        velocity *= share * size / np.linalg.norm(velocity)
        orbit = nh.simulate(discrete, restricted_velocity=velocity, steps=STEPS, throw=False)
        found += [orbit.reduced_momentum, orbit.cayley, orbit.pose]
        defect = nh.invariants(orbit).reversal_defect if len(orbit) > 1 else None
        found += [np.array(np.nan if defect is None else defect)]
    return found


def forced(system: Any) -> Arrays:
    """Run single orbits under a weight with friction, and with a force for each step."""
    rng, found = np.random.default_rng(3), []
    n, velocity = system.group.size - system.has_blade, rng.normal(size=system.rank)
    heavy, rub = nh.Gravity(rng.normal(size=n), rng.normal(size=n)), nh.Friction(rng.uniform(0, 1, system.group.dim))
    for force in (rub, rng.normal(size=(STEPS, system.group.dim))):
        discrete = nh.discretize(nh.Forced(system, heavy, force), STEP / 10)
        orbit = nh.simulate(discrete, restricted_velocity=velocity, steps=STEPS, throw=False)
        found += [orbit.reduced_momentum, orbit.cayley, orbit.pose]
    return found


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
    found = []
    forces = _pushed, nh.Friction(np.linspace(0.1, 0.2, system.group.dim)), _drag, _thrust
    for force, scheme in itertools.product(forces, (None, "variational")):
        discrete = nh.discretize(nh.Forced(system, _well, force, scheme), STEP / 10)
        velocity = np.linspace(0.5, -0.3, system.rank)
        orbit = nh.simulate(discrete, restricted_velocity=velocity, steps=STEPS, throw=False)
        found += [orbit.reduced_momentum, orbit.cayley, orbit.pose]
    return found


def nearest(system: Any) -> Arrays:
    """Follow every real value over a momentum, some to the end."""
    discrete, found = nh.discretize(system, STEP), []
    values = nh.displacements_over(discrete, SIZE * np.ones(len(system.constraint_subspace)))
    for W in values.displacement[values.is_real].real:
        orbit = nh.simulate(discrete, displacement=W, steps=STEPS, branch="nearest", throw=False)
        found += [orbit.reduced_momentum, orbit.cayley, orbit.pose]
    return found


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


def flows(system: Any, method: str | None = None) -> Arrays:
    """Return a continuous motion."""
    velocity = np.random.default_rng(4).normal(size=len(system.constraint_subspace))
    orbit = nh.flow(system, restricted_velocity=velocity, times=np.linspace(0.0, 5.0, 6), method=method)
    between = orbit.at(np.linspace(4.9, 0.1, 7))
    return [orbit.reduced_momentum, orbit.canonical_pose, between.reduced_momentum, between.canonical_pose]


def momenta_of_flows(system: Any) -> Arrays:
    """Return the momenta of a continuous motion, without its poses."""
    velocity = np.random.default_rng(4).normal(size=system.rank) / np.sqrt(system.rank)
    orbit = nh.flow(system, restricted_velocity=velocity, times=np.linspace(0.0, 5.0, 6), reconstruct=False)
    return [orbit.reduced_momentum, orbit.at(np.linspace(4.9, 0.1, 7)).reduced_momentum]


def members_of_flows(system: Any) -> Arrays:
    """Return the continuous motions of an ensemble."""
    velocities = SIZE * np.random.default_rng(7).normal(size=(MEMBERS // 4, 2))
    batch = nh.ensemble(system, restricted_velocity=velocities, times=np.linspace(0.0, 5.0, 3))
    return [batch.reduced_momentum, batch.canonical_pose]


def in_coordinates() -> Arrays:
    """Run a snakeboard to the end of its motion, and a driven sleigh."""
    found = []
    for ready in (nh.examples.snakeboard(), nh.examples.driven_sleigh()):
        how = {"configuration": ready.configuration, "body_velocity": ready.body_velocity}
        orbit = nh.simulate(nh.discretize(ready.system, 0.1), **how, steps=MEMBERS, throw=False)
        found += [orbit.configuration, orbit.momentum, orbit.multipliers, orbit.energy]
    return found


def body(group: Any, k: int, seed: int) -> nh.LLSystem:
    """Return a body with a random constraint."""
    rng = np.random.default_rng(seed)
    return nh.LLSystem(group, mass_tensor(group, rng), random_rows(group, k, rng))


def sleigh(n: int) -> nh.MultidimensionalSleigh:
    """Return a sleigh in n dimensions."""
    rng = np.random.default_rng(n)
    return nh.MultidimensionalSleigh(1.3, 0.4 * rng.normal(size=n) / np.sqrt(n), mass_tensor(nh.SO(n), rng))


RUNS: dict[str, Callable[[], Arrays]] = {
    "sleighs": lambda: members(SLEIGH),
    "own sleighs": lambda: members(SLEIGH, ("mass", "inertia")),
    "tops": lambda: members(TOP),
    "sleighs of an oblique blade": lambda: members(
        nh.LLSystem(nh.SE(2), np.diag([0.6, 0.7, 1.0]), annihilator=[[0.2, -0.6, 0.8]])
    ),
    "tops of an oblique axis": lambda: members(nh.LLSystem(nh.SO(3), TOP.mass_tensor, annihilator=[[1.0, 2.0, 2.0]])),
    "own tops": lambda: members(TOP, ("mass_tensor",)),
    "top": lambda: orbits(TOP),
    "sleigh": lambda: orbits(SLEIGH),
    "top of order 4": lambda: orbits(TOP, 4),
    "sleigh of order 4": lambda: orbits(SLEIGH, 4),
    "top on SO(5)": lambda: orbits(nh.SuslovTop(mass_tensor(nh.SO(5), np.random.default_rng(5)))),
    "top on SO(30)": lambda: orbits(nh.SuslovTop(mass_tensor(nh.SO(30), np.random.default_rng(30)))),
    "sleigh on SE(4)": lambda: orbits(sleigh(4)),
    "sleigh on SE(30)": lambda: orbits(sleigh(30)),
    "top on SO(5) of order 4": lambda: orbits(nh.SuslovTop(mass_tensor(nh.SO(5), np.random.default_rng(5))), 4),
    "sleigh on SE(4) of order 4": lambda: orbits(sleigh(4), 4),
    "any d on SO(4)": lambda: orbits(GENERAL["any d on SO(4)"][0]),
    "any d on SE(3)": lambda: orbits(GENERAL["any d on SE(3)"][0]),
    "slowly on SE(3)": lambda: orbits(GENERAL["any d on SE(3)"][0], size=0.1),
    "any d on SO(4) of order 4": lambda: orbits(GENERAL["any d on SO(4)"][0], 4),
    "right-invariant on SE(3)": lambda: orbits(GENERAL["right-invariant on SE(3)"][0]),
    "any d on SO(8)": lambda: orbits(body(nh.SO(8), 4, 8), size=WIDE),
    "any d on SO(5)": lambda: orbits(body(nh.SO(5), 3, 5), size=WIDE),
    "nearest values of a top": lambda: nearest(TOP),
    "nearest values of a sleigh": lambda: nearest(SLEIGH),
    "a top past angle pi": lambda: past_pi(),
    "what is read of a top": lambda: read(TOP),
    "what is read of a sleigh": lambda: read(nh.ChaplyginSleigh(2.0, 0.7, -0.5, 0.3)),
    "flow of a top": lambda: flows(TOP),
    "flow of a sleigh": lambda: flows(SLEIGH),
    "momenta of a sleigh on SE(200)": lambda: momenta_of_flows(
        nh.MultidimensionalSleigh.arrowhead(1.3, np.linspace(0.4, 0, 200), np.linspace(1, 2, 200), np.full(199, 0.01))
    ),
    "flows of tops": lambda: members_of_flows(TOP),
    "flows of sleighs": lambda: members_of_flows(SLEIGH),
    "top under springs and kicks": lambda: balanced(TOP),
    "sleigh under springs and kicks": lambda: balanced(SLEIGH),
    "heavy free body": lambda: forced(nh.RigidBody(np.diag([1.0, 1.2, 0.7]))),
    "flow of a heavy top": lambda: flows(nh.Forced(TOP, nh.Gravity([0.1, -0.2, -2.0], [0.2, 0.1, 0.5]))),
    "flow of a sleigh on a slope": lambda: flows(nh.Forced(SLEIGH, SLOPE, nh.Friction([0.1, 0.3, 0.2]))),
    "flows of sleighs on a slope": lambda: members_of_flows(nh.Forced(SLEIGH, SLOPE, nh.Friction([0.1, 0.3, 0.2]))),
    "right-invariant flow on SE(3)": lambda: flows(GENERAL["right-invariant on SE(3)"][0]),
    "pose of a top in closed form": lambda: flows(TOP, "closed_form"),
    "top with forces": lambda: forced(TOP),
    "sleigh with forces": lambda: forced(SLEIGH),
    "top on SO(4) with forces": lambda: forced(nh.SuslovTop(mass_tensor(nh.SO(4), np.random.default_rng(4)))),
    "any d on SO(4) with forces": lambda: forced(GENERAL["any d on SO(4)"][0]),
    "top under functions": lambda: driven(TOP),
    "sleigh under functions": lambda: driven(SLEIGH),
    "top on SO(4) under functions": lambda: driven(nh.SuslovTop(mass_tensor(nh.SO(4), np.random.default_rng(4)))),
    "in coordinates": in_coordinates,
    "a fold on SO(4)": lambda: orbits(GENERAL["any d on SO(4)"][0], size=20.0),
    "a fold of a top on SO(5)": lambda: orbits(
        nh.SuslovTop(mass_tensor(nh.SO(5), np.random.default_rng(5))), size=20.0
    ),
}


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
