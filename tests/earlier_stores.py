"""Stores of before routes had names: what they hold, and the program that wrote them.

PYTHONPATH=CHECKOUT python tests/earlier_stores.py FOLDER writes `stores.tar.xz` and `expected.json` with the version of
that checkout: finished stores, stores of runs that stop after two of three blocks, and digests of the same runs without
a stop. LAPACK may round otherwise on other machines, so a digest of what it makes of fixed matrices is kept too.
"""

import hashlib
import json
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
from bodies import mass_tensor, random_rows

import nonholo as nh
from nonholo.io import Stream
from nonholo.systems import AbstractSystem

STEPS, MORE, EVERY, BLOCK, ORDER_4 = 12, 5, 1, 4, " of order 4"
ARRAYS = ("time", "reduced_momentum", "cayley", "canonical_pose")


def _systems() -> dict[str, AbstractSystem]:
    rng = np.random.default_rng(5)
    space, rotations, motions = (mass_tensor(group, rng) for group in (nh.SO(3), nh.SO(4), nh.SE(3)))
    turned = nh.SO(4).adjoint(nh.SO(4).exp(rng.normal(size=6)))
    return {
        "suslov top": nh.SuslovTop(space, axis=(0.6, 0.0, 0.8)),
        "plane sleigh": nh.ChaplyginSleigh(1.3, 0.7, 0.5, b=0.3),
        "top on SO(4)": nh.SuslovTop(rotations),
        "sleigh on SE(3)": nh.MultidimensionalSleigh(1.3, [0.3, 0.2, -0.1], np.diag([0.5, 0.7, 0.4]) + 0.1),
        "any d on SE(3)": nh.LLSystem(nh.SE(3), motions, random_rows(nh.SE(3), 4, rng)),
        "LLSystem that is a top": nh.LLSystem(nh.SO(3), space, annihilator=[[0.6, 0.0, 0.8]]),
        "LLSystem that is a top on SO(4)": nh.LLSystem(
            nh.SO(4), rotations, nh.SuslovTop(rotations).constraint_subspace @ turned.T
        ),
        "LLSystem that is a plane sleigh": nh.LLSystem.from_inertia(
            1.3, 0.7, [0.5, 0.3], nh.SE(2), annihilator=[[0.0, 0.6, 0.8]]
        ),
        "veselova": nh.VeselovaTop(space),
        "free body": nh.RigidBody(rotations),
    }


def motions() -> dict[str, nh.Discretization]:
    """Return the discretized systems of the stores by the names of the stores."""
    systems = _systems()
    found = {name: nh.discretize(system, 0.1) for name, system in systems.items()}
    composed = ("suslov top", "LLSystem that is a top")
    return found | {name + ORDER_4: nh.discretize(systems[name], 0.1, order=4) for name in composed}


def start(discrete: nh.Discretization) -> np.ndarray:
    """Return the velocity, in rows of the constraint subspace, with which a run starts."""
    return 0.9 * np.random.default_rng(discrete.system.rank).normal(size=discrete.system.rank)


def sweep_of(discrete: nh.Discretization) -> tuple[nh.EnsembleTask, nh.Grid]:
    """Return a sweep over the time step, four members in two blocks."""
    task = nh.EnsembleTask(discrete, steps=STEPS, restricted_velocity=start(discrete))
    return task, nh.Grid({"time_step": [0.05, 0.1, 0.15, 0.2]})


def run(discrete: nh.Discretization, store: Path | None = None, steps: int = STEPS) -> nh.Orbit:
    """Run from the start, into a store if there is one."""
    blocks: dict[str, Any] = {} if store is None else {"store": store, "checkpoint_every": BLOCK}
    return nh.simulate(discrete, restricted_velocity=start(discrete), steps=steps, **blocks)


def digest(*arrays: np.ndarray) -> str:
    """Return a digest of the bits of arrays."""
    text = hashlib.sha256()
    for array in arrays:
        text.update(np.ascontiguousarray(array).tobytes())
    return text.hexdigest()


def digest_of(orbit: nh.Orbit) -> str:
    """Return a digest of the compact states of an orbit."""
    return digest(*(getattr(orbit, name) for name in ARRAYS))


def rounding_of_lapack() -> str:
    """Return a digest of what the linear algebra of this machine makes of fixed matrices."""
    rng, found = np.random.default_rng(0), []
    for n in (2, 3, 4, 6):
        A = rng.normal(size=(n, n))
        found += [*np.linalg.eigh(A + A.T), np.linalg.inv(A), np.linalg.pinv(A[:-1]), A @ A.T, np.linalg.qr(A)[0]]
        found += [np.linalg.solve(A, A[0]), np.linalg.svd(A)[1]]
    return digest(*found)


@contextmanager
def stopping(owner: type, name: str, when: Callable[[Any], bool]) -> Iterator[None]:
    """Interrupt what runs inside where a method is called with such a first argument."""
    whole = getattr(owner, name)

    def interrupted(self: Any, first: Any, *rest: Any) -> Any:
        if when(first):
            raise KeyboardInterrupt
        return whole(self, first, *rest)

    with mock.patch.object(owner, name, interrupted):
        try:
            yield
        except KeyboardInterrupt:
            return
    raise AssertionError("it was not stopped")


def _stored_orbits(folder: Path) -> dict[str, Any]:
    expected = {}
    for name, discrete in motions().items():
        orbit, longer = run(discrete, folder / f"{name}.zarr"), run(discrete, steps=STEPS + MORE)
        with stopping(Stream, "write", lambda block: block == 2):
            run(discrete, folder / f"{name}, stopped.zarr")
        expected[name] = {
            "digest": digest_of(orbit),
            "longer": digest_of(longer),
            "momentum": longer.reduced_momentum[-1].tolist(),
            "pose": longer.canonical_pose[-1].tolist(),
        }
    return expected


def _stored_sweeps(folder: Path) -> dict[str, Any]:
    expected = {}
    for name in ("suslov top", "LLSystem that is a top"):
        store = folder / f"{name}, sweep.zarr"
        with nh.sweep(*sweep_of(motions()[name]), store, block=2) as found:
            numbers = [found[key].values for key in ("final_momentum", "final_pose")]
        expected[name] = {"digest": digest(*numbers), "final_momentum": numbers[0].tolist()}
        with stopping(nh.EnsembleTask, "__call__", lambda members: members.first == 2):
            nh.sweep(*sweep_of(motions()[name]), folder / f"{name}, stopped sweep.zarr", "synchronous", block=2)
    return expected


if __name__ == "__main__":
    target = Path(sys.argv[1])
    with tempfile.TemporaryDirectory() as scratch:
        stores = Path(scratch) / "stores"
        stores.mkdir()
        made = {"lapack": rounding_of_lapack(), "orbits": _stored_orbits(stores), "sweeps": _stored_sweeps(stores)}
        shutil.make_archive(str(target / "stores"), "xztar", stores)
    (target / "expected.json").write_text(json.dumps(made) + "\n")
