"""The bits of a motion do not depend on the company in which it runs and is read: one row, many, or an ensemble."""

import functools
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from bodies import tensor

import nonholo as nh
from nonholo.base.numerics import applied
from nonholo.systems import System

DECODED = ("restricted_momentum", "momentum", "body_velocity", "configuration", "pose", "energy")


def top(rng: np.random.Generator) -> System:
    """Return a top by its inertia, with an oblique axis."""
    axis, J = rng.normal(size=3), tensor(3, rng)
    return nh.SuslovTop.from_inertia(np.trace(J) * np.eye(3) - J, axis=axis / np.linalg.norm(axis))


def sleigh(rng: np.random.Generator, b: float) -> System:
    """Return a plane sleigh; b times a random number is its offset across the blade."""
    return nh.ChaplyginSleigh(*np.exp(rng.normal(size=2) / 2), *(rng.normal(size=2) * (1.0, b)))


BODIES: dict[str, Callable[[np.random.Generator], System]] = {
    "sleigh": functools.partial(sleigh, b=0.0),
    "sleigh-b": functools.partial(sleigh, b=1.0),
    "top": lambda rng: nh.SuslovTop(tensor(3, rng)),
    "oblique": top,
}
WIDER: dict[str, Callable[[np.random.Generator], System]] = {
    "SO(5)": lambda rng: nh.SuslovTop(tensor(5, rng)),
    "SE(3)": lambda rng: nh.MultidimensionalSleigh(1.5, rng.normal(size=3), tensor(3, rng)),
    "slanted": lambda rng: nh.LLSystem(nh.SO(3), tensor(3, rng), annihilator=rng.normal(size=(1, 3))),
}


@pytest.mark.parametrize("k", [1, 2, 3, 7, 16, 33, 150])
def test_products_of_a_row_are_those_of_many(k: int) -> None:
    """However many rows there are, of whatever layout, each has the bits that it has alone."""
    rng = np.random.default_rng(k)
    matrix, rows = rng.normal(size=(k + 1, k)), rng.normal(size=(37, k))
    alone = np.concatenate([applied(matrix, row[None]) for row in rows])
    spread = np.zeros((37, 2 * k))
    spread[:, ::2] = rows
    for many in (rows, np.asfortranarray(rows), spread[:, ::2], rows[None], np.repeat(rows, 2, axis=0)[::2]):
        assert np.array_equal(applied(matrix, many).reshape(alone.shape), alone)
    each = np.tile(matrix, (37, 1, 1))
    assert np.array_equal(applied(each, rows), alone)
    assert np.array_equal(applied(np.asfortranarray(matrix), rows), alone)
    assert np.allclose(alone, rows @ matrix.T, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("kind", [*BODIES, *WIDER])
def test_states_are_read_alone_as_in_company(kind: str) -> None:
    """Each state of an orbit or a flow decodes to the same bits alone and among all others."""
    rng = np.random.default_rng(7)
    body = {**BODIES, **WIDER}[kind](rng)
    start: Any = {"restricted_velocity": rng.normal(size=body.rank) / 3}
    flow = nh.flow(body, times=np.linspace(0.0, 2.0, 9), **start)
    for orbit in (nh.simulate(nh.discretize(body, 0.1), steps=8, **start), flow):
        for name in (
            *DECODED,
            "spatial_momentum",
            *(("chart", "displacement") if orbit.is_discrete else ("multipliers",)),
        ):
            alone = np.concatenate([getattr(orbit[k : k + 1], name) for k in range(len(orbit))])
            assert np.array_equal(alone, getattr(orbit, name)), name


def bodies(kind: str, count: int) -> Iterator[tuple[System, np.ndarray]]:
    """Yield bodies, and three momenta along the constraint of each."""
    rng = np.random.default_rng(5)
    for _ in range(count):
        body = {**BODIES, **WIDER}[kind](rng)
        yield body, rng.normal(size=(3, body.rank)) / 5


CASES = [
    *(pytest.param(kind, 6, id=f"{kind}-few") for kind in BODIES),
    *(pytest.param(kind, 96, id=f"{kind}-many") for kind in BODIES),
    *(pytest.param(kind, 6, id=kind) for kind in WIDER),
]


@pytest.mark.profile("problems", keep=["*-few-*"])
@pytest.mark.parametrize("flows", [False, True], ids=["runs", "flows"])
@pytest.mark.parametrize(("kind", "count"), CASES)
def test_an_ensemble_has_the_bits_of_each_run(kind: str, count: int, flows: bool) -> None:
    """Last states after 20 steps, or those of flows, and what is decoded of them, are those from the same momenta."""
    names, times = ("reduced_momentum", "canonical_pose", *DECODED), np.linspace(0.0, 2.0, 3)
    for body, momenta in bodies(kind, count):
        motion, run = (body, {"times": times}) if flows else (nh.discretize(body, 0.1), {"steps": 20})
        batch: Any = nh.ensemble(motion, momentum=momenta, **run)
        for j, momentum in enumerate(momenta):
            alone = (nh.flow if flows else nh.simulate)(motion, momentum=momentum, **run)
            for name in names if flows else ("cayley", *names):
                last = getattr(alone, name)[0 if flows else -1 :]
                assert np.array_equal(getattr(batch, name)[j], last), (body, name)
