"""What random bodies ask of the library of kernels: a program that records their calls, and makes them again elsewhere.

python replay.py record FILE [BODIES]            # run bodies, and keep the arguments of each call
python replay.py bits FILE [THREADS [LIBRARY]]   # the way, and a digest of what each call returns and writes
"""

import concurrent.futures
import functools
import gzip
import hashlib
import importlib
import inspect
import json
import pickle
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np

import nonholo as nh
from nonholo.base import compiled
from nonholo.kernels.lanes import ONE
from nonholo.kernels.taylor._expansion import Room, expansion_of

STEPS = 5
_run: Callable[..., Any] = compiled.Kernel.__call__


def _tensor(group: Any, rng: np.random.Generator) -> np.ndarray:
    from bodies import mass_tensor

    return mass_tensor(group, rng)


def _rows(group: Any, rng: np.random.Generator) -> np.ndarray:
    from bodies import random_rows

    return random_rows(group, int(rng.integers(1, group.dim)), rng)


def _sleigh(rng: np.random.Generator) -> Any:
    return nh.ChaplyginSleigh(*10 ** rng.uniform(-1, 1, 2), *rng.normal(size=2))


def _top(rng: np.random.Generator) -> Any:
    return nh.SuslovTop(_tensor(nh.SO(3), rng))


def _wide_top(rng: np.random.Generator) -> Any:
    return nh.SuslovTop(_tensor(nh.SO(int(rng.integers(4, 7))), rng))


def _mean(rng: np.random.Generator) -> Any:
    n = int(rng.integers(3, 7))
    return nh.MultidimensionalSleigh(10 ** rng.uniform(-1, 1), rng.normal(size=n), _tensor(nh.SO(n), rng))


def _any(rng: np.random.Generator) -> Any:
    group = (nh.SO(4), nh.SE(3), nh.SO(5))[rng.integers(3)]
    return (nh.LLSystem, nh.LRSystem)[rng.integers(2)](group, _tensor(group, rng), _rows(group, rng))


def _simulated(system: Any, velocity: np.ndarray, order: int = 2) -> Any:
    discrete = nh.discretize(system, 0.2, order=order)
    return nh.simulate(discrete, restricted_velocity=velocity, steps=STEPS, throw=False)


def _pushed(system: Any, velocity: np.ndarray) -> Any:
    rub = nh.Friction(np.linspace(0.1, 0.2, system.group.dim))
    return _simulated(nh.Forced(system, None, rub), velocity)


def _flowing(system: Any, velocity: np.ndarray) -> Any:
    return nh.flow(system, restricted_velocity=velocity, times=np.linspace(0, 2, 4)).canonical_pose


def _many(system: Any, velocity: np.ndarray) -> Any:
    velocities = np.multiply.outer(np.linspace(-1, 3, 9), velocity)
    return nh.ensemble(nh.discretize(system, 0.2), restricted_velocity=velocities, steps=STEPS)


_BODIES_OF_RUNS: dict[Callable[..., Any], tuple[Callable[..., Any], ...]] = {
    _simulated: (_sleigh, _top, _wide_top, _mean, _any),
    functools.partial(_simulated, order=4): (_any, _sleigh),
    _pushed: (_top, _sleigh, _mean),
    _flowing: (_top, _sleigh, _any),
    _many: (_top, _sleigh),
}
KINDS = [(make, run) for run, bodies in _BODIES_OF_RUNS.items() for make in bodies]


def _at(address: Callable[[Any], int], kernel: Any, arguments: tuple[Any, ...]) -> tuple[Any, ...]:
    """Return the arguments with another address of the code that expands the equations: it is of this process."""
    names = inspect.signature(kernel).parameters
    return tuple(address(arguments[0]) if name == "expansion" else x for name, x in zip(names, arguments, strict=False))


def recorded(bodies: int) -> list[bytes]:
    """Run bodies of all kinds in turn, and return the calls that the library answers."""
    calls: list[bytes] = []
    reference = compiled.library_of_kernels()

    def call(kernel: Any, *arguments: Any) -> Any:
        key = compiled.key_of(arguments)
        if (
            "f" not in compiled.tokens(key) and reference and reference.entry(kernel, key)
        ):  # addresses are of this process
            calls.append(pickle.dumps((kernel.__module__, kernel.__qualname__, _at(lambda _: 0, kernel, arguments))))
        return _run(kernel, *arguments)

    zeros = {"empty": np.zeros, "empty_like": np.zeros_like}  # what is not written yet differs from process to process
    with mock.patch.multiple(np, **zeros), mock.patch.object(compiled.Kernel, "__call__", call):
        for body in range(bodies):
            rng = np.random.default_rng(body)
            make, run = KINDS[body % len(KINDS)]
            system = make(rng)
            velocity = rng.normal(size=len(system.constraint_subspace))
            run(system, velocity / np.linalg.norm(velocity) * 10 ** rng.uniform(-1, 0.5))
    return calls


def _leaves(value: Any) -> list[np.ndarray]:
    """Return numbers and arrays; all that is no number has one pattern of bits, as processors differ in its sign."""
    if isinstance(value, tuple):
        return [leaf for part in value for leaf in _leaves(part)]
    array = np.array(value if value is not None else [])
    return [np.where(np.isnan(array), np.nan, array) if array.dtype.kind == "f" else array]


def digest(call: bytes) -> str:
    """Make a call again, and return a digest of what it returns and of its arrays."""
    module, name, arguments = pickle.loads(call)  # noqa: S301  # written by `recorded`
    kernel = getattr(importlib.import_module(module), name)
    result = kernel(*_at(lambda equations: expansion_of(equations, ONE), kernel, arguments))
    text = hashlib.sha256()
    left = tuple(x for x in arguments if not isinstance(x, Room))  # the general kernel leaves other numbers in a room
    for leaf in _leaves((result, left)):
        text.update(leaf.tobytes())
    return f"{module}.{name} {text.hexdigest()[:16]}"


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parents[1]))
    task, file, *others = sys.argv[1:]
    if task == "record":
        Path(file).write_bytes(gzip.compress(pickle.dumps(recorded(*map(int, others)))))
    else:
        if others[1:]:
            compiled._kernel.library.place = lambda: Path(others[1])  # pyright: ignore
        calls = pickle.loads(gzip.decompress(Path(file).read_bytes()))  # noqa: S301  # written above
        with concurrent.futures.ThreadPoolExecutor(int(others[0]) if others else 1) as pool:
            sys.stdout.write(json.dumps([compiled.way_of_kernels(), *pool.map(digest, calls)]))
