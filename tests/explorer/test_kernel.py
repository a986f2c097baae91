"""The kernels of the page are those of the library: the same steps, refusals and numbers to the last bit."""

import numpy as np
import pytest
from explorer.webassembly import Module

from nonholo import kernels
from nonholo.explorer import kernel
from nonholo.explorer._object import module_of

wasmtime = pytest.importorskip("wasmtime")
_STEPS = 1000


def _top(rng: np.random.Generator) -> kernels.SuslovBody:
    A = rng.normal(size=(2, 2))
    B = A @ A.T + 10.0 ** rng.uniform(-3, 0) * np.eye(2)
    c = rng.normal(size=2) * np.sqrt(np.linalg.eigvalsh(B)[0]) * rng.choice([0.0, 0.1, 0.5])
    return kernels.suslov_body(B, c)


def _sleigh(rng: np.random.Generator) -> kernels.SleighBody:
    mass, inertia = rng.uniform(0.2, 3, 2)
    return kernels.SleighBody(float(mass), float(inertia), float(rng.choice([0.0, -1.0, 1.0]) * rng.uniform(0.05, 1)))


def _native(body: kernels.Body, momentum: np.ndarray, pose: np.ndarray) -> tuple[int, int, np.ndarray]:
    code, state = kernels.start(body, momentum, pose)
    rows = np.empty((_STEPS, 2)), np.empty((_STEPS, 2)), np.empty((_STEPS, 4))
    done = 0
    if code == 0:
        done, code = kernels.advance(body, state, _STEPS, 1, rows)
    return done, code, np.hstack(rows)[:done]


@pytest.mark.parametrize(("kind", "draw"), [("top", _top), ("sleigh", _sleigh)], ids=["top", "sleigh"])
def test_same_bits(kind: str, draw: object) -> None:
    """A million steps and more of random bodies and starts, refused ones and ones that stop among them."""
    rng, module = np.random.default_rng(20), Module(kind, _STEPS)
    pose = np.array([1.0, 0.0, 0.0, 0.0])
    outcomes, steps = set(), 0
    while steps < 1_000_000:
        body, momentum = draw(rng), rng.normal(size=2) * 10.0 ** rng.uniform(-3, 0.5)
        done, code, rows = _native(body, momentum, pose)
        there = module.orbit(tuple(body), momentum, pose)
        assert there[:2] == (done, code)
        assert there[2].tobytes() == rows.tobytes()
        outcomes.add((code, done == 0))
        steps += done
    assert {(0, False), (1, True), (1, False)} <= outcomes


@pytest.mark.parametrize("momentum", [(0.0, 0.0), (np.inf, 1.0), (np.nan, 0.0), (1e300, -1e300), (1e-320, 0.3)])
@pytest.mark.parametrize("kind", ["top", "sleigh"])
def test_nasty_starts(kind: str, momentum: tuple[float, float]) -> None:
    """What is not finite, huge or denormal ends there as it does here."""
    body = (
        kernels.suslov_body(np.diag([1.0, 2.0]), np.array([0.3, 0.1]))
        if kind == "top"
        else kernels.SleighBody(1, 1, 0.5)
    )
    pose = np.array([1.0, 0.0, 0.0, 0.0])
    done, code, rows = _native(body, np.array(momentum), pose)
    there = Module(kind, _STEPS).orbit(tuple(body), np.array(momentum), pose)
    assert there[:2] == (done, code)
    np.testing.assert_array_equal(there[2], rows)


@pytest.mark.parametrize("kind", ["top", "sleigh"])
def test_asks_for_no_function(kind: str) -> None:
    """All arithmetic is the module's own: it imports memory and a stack, and exports `run`."""
    module = wasmtime.Module(wasmtime.Engine(), kernel(kind))
    assert {item.name for item in module.imports} <= {"__linear_memory", "__stack_pointer"}
    assert [item.name for item in module.exports] == ["run"]


def test_refuses_what_needs_a_linker() -> None:
    """An object without a function of its own is no kernel."""
    with pytest.raises(ValueError, match="needs a linker"):
        module_of(b"\0asm\x01\0\0\0")
