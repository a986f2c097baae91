"""Expansions compiled for a structure: the bits of the general kernel, what the library has, and what happens without.

The general kernel is the definition; emitted code does its sums in the same order.
"""

import sys
from pathlib import Path

import numpy as np
import pytest
from bodies import mass_tensor
from problems import EVERY

import nonholo as nh
from nonholo.base.compiled import emission, library_of_kernels, njit, way_of_kernels
from nonholo.continuous import _forced, _series
from nonholo.kernels import Quadratic
from nonholo.kernels._scalar import COMPILED
from nonholo.kernels.lanes import EIGHT, ONE
from nonholo.kernels.taylor import _expansion, _solve
from nonholo.kernels.taylor.emission import code_of
from nonholo.systems import AbstractSystem

RNG = np.random.default_rng(17)
USUAL: dict[str, AbstractSystem] = {
    "top": nh.SuslovTop(mass_tensor(nh.SO(3), RNG)),
    "balanced top": nh.SuslovTop(np.diag([1.0, 2.0, 3.0])),
    "sleigh": nh.ChaplyginSleigh(1.0, 1.0, 0.5),
    "balanced sleigh": nh.ChaplyginSleigh(1.0, 1.0, 0.0),
    "free body": nh.RigidBody(mass_tensor(nh.SO(3), RNG)),
    "free body in its axes": nh.RigidBody(np.diag([1.0, 2.0, 3.0])),
    "top on SO(4)": nh.SuslovTop(mass_tensor(nh.SO(4), RNG)),
    "sleigh in space": nh.MultidimensionalSleigh(2.0, [0.5, 0.25, -0.125], np.diag([1.0, 2.0, 1.5])),
    "free body on SE(3)": nh.RigidBody(mass_tensor(nh.SE(3), RNG), nh.SE(3)),
    "Heisenberg": EVERY["Heisenberg"],
    "Veselova top": nh.VeselovaTop(np.diag([1.0, 2.0, 3.0])),
}
"""What is compiled ahead."""
OTHERS = {
    **{name: body for name, body in EVERY.items() if name not in ("product", "top on SO(7)")},
    "top on SO(10)": nh.SuslovTop(mass_tensor(nh.SO(10), RNG)),
    "heavy top": nh.Forced(USUAL["top"], nh.Gravity([0.0, 0.0, -2.0], [0.2, 0.1, 0.5])),
    "sleigh with friction": nh.Forced(USUAL["sleigh"], nh.Gravity([1.0, -0.5], [0.5, 0.0]), nh.Friction([0.1] * 3)),
    "heavy body on SO(4)": nh.Forced(nh.RigidBody(mass_tensor(nh.SO(4), RNG), nh.SO(4)), nh.Gravity(*np.eye(4)[:2])),
}
BODIES = {**OTHERS, **USUAL}


def cases(systems: dict[str, AbstractSystem]) -> list[tuple[str, tuple[int, ...]]]:
    """Return names of bodies, and how many motions stand side by side: of those with a constraint in space one."""
    return [(name, lanes) for name, body in systems.items() for lanes in (ONE, EIGHT)[: 2 - body.canonical.is_spatial]]


def equations(system: AbstractSystem, lanes: tuple[int, ...]) -> Quadratic:
    """Return the equations of one motion, or of eight with factors of their own."""
    f = _forced.quadratic_under(system.forces) if system.forces else _series.quadratic(system.canonical)
    if lanes == ONE:
        return f._replace(momentum=RNG.normal(size=len(f.velocities))) if len(f.forms) else f
    wide = f._replace(**_solve.one_by_one(f.rows, f.sources))
    own = {"velocities": RNG.normal(size=(len(f.velocities), len(f.velocities) * 8))}
    return wide._replace(**own, factors=RNG.normal(size=(1, f.factors.size * 8)))


def structure_of(f: Quadratic, lanes: tuple[int, ...]) -> str:
    """Return the structure of equations."""
    counts = len(lanes), len(f.velocities), f.forms.size and f.tensor.size
    return _expansion.structure_of(counts, f.rows.ravel(), f.first, f.sources)


@njit(**COMPILED)
def _one(f: Quadratic, expansion: int, state: np.ndarray, room: _expansion.Room) -> None:
    _expansion.expand(f, expansion, state, room, ONE)


@njit(**COMPILED)
def _eight(f: Quadratic, expansion: int, state: np.ndarray, room: _expansion.Room) -> None:
    _expansion.expand(f, expansion, state, room, EIGHT)


def _bits(
    f: Quadratic, lanes: tuple[int, ...], expansion: int, state: np.ndarray, order: int, *, by_python: bool = False
) -> np.ndarray:
    """Return the bits of all coefficients but those of the last velocities, which nobody needs."""
    room, L = _expansion.make_room(f, order, lanes), len(lanes)
    if by_python:
        _expansion.expand(f, expansion, state, room, lanes)
    else:
        (_one if L == 1 else _eight)(f, expansion, state, room)
    room.series[order, : len(f.velocities) * L] = 0.0
    return room.series.view(np.int64)


def assert_same_bits(f: Quadratic, lanes: tuple[int, ...], state: np.ndarray, *orders: int, **how: bool) -> None:
    """Compare the emitted expansion of a state with that of the general kernel."""
    expansion = emission.compile_text(code_of(structure_of(f, lanes), "expansion"), "expansion")
    for order in orders:
        general, emitted = (_bits(f, lanes, code, state, order, **how) for code in (0, expansion))
        assert np.array_equal(general, emitted)


@pytest.mark.profile("routes", keep=["top-*", "top on SO(4)*"])
@pytest.mark.parametrize(("name", "lanes"), cases(BODIES), ids=lambda x: x if isinstance(x, str) else str(len(x)))
def test_emitted_code_has_the_bits_of_the_general_kernel(name: str, lanes: tuple[int, ...]) -> None:
    """At random states, with zeros of both signs, tiny and huge numbers, and at any order."""
    f = equations(BODIES[name], lanes)
    for scale in (1.0, 1e-200, 1e30):
        state = scale * RNG.normal(size=(2, (len(f.blocks) + 1) * len(lanes)))
        state[0, :: RNG.integers(2, 5)] *= -0.0
        assert_same_bits(f, lanes, state, 1, 2, 3, 8, 29, 30)


@pytest.mark.profile("routes", keep=["?"])
@pytest.mark.parametrize("seed", range(20))
def test_emitted_code_of_random_structures(seed: int) -> None:
    """Rows in any order, components with many terms or none, velocities in several vectors."""
    rng = np.random.default_rng(seed)
    k, size = (int(rng.integers(low, high)) for low, high in ((1, 12), (12, 40)))
    counts = rng.integers(0, 6, size)
    terms, before, products = int(counts.sum()), k + size, rng.integers(1, 30)
    rows = np.stack([rng.integers(0, k, products), rng.integers(0, -(-before // 8), products)])
    result = rng.integers(0, 8 * products + k, terms)
    f = _series.quadratic(USUAL["top"].canonical)._replace(
        velocities=rng.normal(size=(k, k)), rows=rows, first=np.append(0, np.cumsum(counts)), sources=result,
        factors=rng.normal(size=(1, terms)), blocks=np.zeros(size, dtype=np.int64),
    )  # fmt: skip
    assert_same_bits(f, ONE, rng.normal(size=(2, size + 1)), 20)


def test_usual_bodies_are_in_the_library() -> None:
    """Their expansions for one motion and for eight are listed, and there; the address is that of the library."""
    lines = (Path(_expansion.__file__).parents[1] / "ahead.txt").read_text(encoding="utf-8").splitlines()
    usual = [(equations(USUAL[name], lanes), lanes) for name, lanes in cases(USUAL)]
    wanted = {f"{_expansion.EMITTER} {structure_of(*case)}" for case in usual}
    assert {line for line in lines if line.startswith(_expansion.EMITTER)} == wanted
    if way_of_kernels() == "library":
        library = library_of_kernels()
        assert library is not None
        addresses = [library.address(_expansion.EMITTER, structure_of(*case)) for case in usual]
        assert addresses == [_expansion.expansion_of(*case) for case in usual]
        assert all(addresses)
    library = library_of_kernels()
    assert library is None or library.address(_expansion.EMITTER, "1,1,0;;0;") == 0


def test_python_calls_compiled_code_too() -> None:
    """The function at an address is the same for plain Python."""
    f = equations(USUAL["top"], ONE)
    assert_same_bits(f, ONE, RNG.normal(size=(2, len(f.blocks) + 1)), 12, by_python=True)


def test_without_the_extra_the_general_kernel_does_the_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    """A structure that is not in the library has no expansion of its own where llvmlite is missing: the same bits."""
    system = OTHERS["sleigh 5"]
    velocity = np.cos(np.arange(system.rank))
    flows = [nh.flow(system, restricted_velocity=velocity, times=(0.0, 3.0)).configuration]
    monkeypatch.setitem(sys.modules, "nonholo.kernels.taylor.emission", None)
    _expansion.address_of.cache_clear()
    flows.append(nh.flow(system, restricted_velocity=velocity, times=(0.0, 3.0)).configuration)
    assert _expansion.expansion_of(equations(system, ONE), ONE) == 0
    _expansion.address_of.cache_clear()
    assert np.array_equal(flows[0], flows[1])
