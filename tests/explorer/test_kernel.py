"""The kernels of the page are those of the library: the same steps, refusals and numbers to the last bit."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from explorer.webassembly import Module

import nonholo as nh
from nonholo import kernels
from nonholo.base.compiled.wasm import module_of
from nonholo.explorer import kernel
from nonholo.explorer._explore import KINDS

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


def _top4(rng: np.random.Generator) -> kernels.SecularBody:
    """A top on SO(4), balanced or round, flat or eccentric ones among them."""
    b = rng.uniform(0.5, 3, 3) if rng.random() < 0.7 else 10.0 ** rng.uniform(-3, 0, 3)
    b[: rng.integers(1, 4)] = b[0]
    c = rng.normal(size=3) * np.sqrt(b.min()) * rng.choice([0.0, 1e-9, 0.1, 0.5, 1.0])
    return kernels.secular_top(b, c * rng.integers(0, 2, 3))


def _turns(rng: np.random.Generator) -> np.ndarray:
    """Return the rows of a random rotation, or of a turn by quarters."""
    turn = np.linalg.qr(rng.normal(size=(4, 4)))[0] if rng.random() < 0.8 else np.eye(4)[rng.permutation(4)]
    return turn.ravel()


def _native(body: kernels.AnyBody, momentum: np.ndarray, pose: np.ndarray) -> tuple[int, int, np.ndarray]:
    code, state = kernels.runs_of(body).start(body, momentum, pose)
    rows = tuple(np.empty((_STEPS, size)) for size in kernels.sizes(body))
    done = 0
    if code == 0:
        done, code = kernels.runs_of(body).advance(body, state, _STEPS, 1, rows)
    return done, code, np.hstack(rows)[:done]


def _outcome(module: Module, body: kernels.AnyBody, flat: tuple, momentum: np.ndarray, pose: np.ndarray) -> list[int]:
    """Return the outcome and how many steps were good, of a run that has the same bits in the module."""
    done, code, rows = _native(body, momentum, pose)
    there = module.orbit(flat, momentum, pose)
    assert there[:2] == (done, code)
    np.testing.assert_array_equal(there[2], rows)
    return [code, done]


DRAWN = {"top": _top, "sleigh": _sleigh, "top4": _top4}


@pytest.mark.parametrize("kind", DRAWN)
def test_same_bits(kind: str) -> None:
    """A million steps and more of random bodies and starts, refused ones and ones that stop among them."""
    rng, module = np.random.default_rng(20), Module(kind, _STEPS)
    outcomes, steps, pose = set(), 0, np.array([1.0, 0.0, 0.0, 0.0])
    while steps < 1_000_000:
        body = DRAWN[kind](rng)
        momentum = rng.normal(size=2) * 10.0 ** rng.uniform(-3, 0.5)
        if kind == "top4":  # many leave the ball of certain roots
            momentum = rng.normal(size=3) * np.sqrt(body.b) * 10.0 ** rng.uniform(-2, 0.3) * rng.integers(0, 2, 3)
            pose = _turns(rng)
        code, done = _outcome(module, body, _flat(body), momentum, pose)
        outcomes.add((code, done == 0))
        steps += done
    assert {(0, False), (1, True), (1, False)} | ({(2, True)} if kind == "top4" else set()) <= outcomes


def _flat(body: kernels.AnyBody) -> tuple:
    """Return the numbers of a body as a module takes them."""
    return (*body.b, *body.c, body.least) if isinstance(body, kernels.SecularBody) else tuple(body)


_ROWS = {"forced_top": np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]), "forced_sleigh": np.eye(3)[:2]}


def _forced(kind: str, rng: np.random.Generator, forces: str) -> tuple[kernels.ForcedBody, list[float], np.ndarray]:
    """Return a body under forces as Python makes it, and from the same numbers as the module takes it; a momentum."""
    n, h = 3 if kind == "forced_top" else 2, float(10 ** rng.uniform(-2.5, -1))
    F, x, c = rng.normal(size=n), rng.normal(size=n), rng.uniform(0, 2, 3) * 10.0 ** rng.uniform(-2, 2)
    table = rng.normal(size=(rng.integers(1, 400), 3))
    if kind == "forced_top":
        J = np.eye(3) + rng.uniform(-0.4, 0.4, (3, 3))
        system, share = nh.SuslovTop(J + J.T), 0.5
        lever = [x[2], 0.0, -x[0], 0.0, x[2], -x[1]]
        C = [c[1], 0.0, 0.0, c[0]]
    else:
        system, share = nh.ChaplyginSleigh(*rng.uniform(0.2, 3, 2), rng.uniform(-1, 1)), 1.0
        lever = [-x[1], x[0], 0.0, 1.0, 0.0, 0.0]
        C = [c[0], 0.0, 0.0, c[1]]
    has = [name in forces for name in ("weight", "friction", "table")]
    acting = (nh.Friction(c),) * has[1] + (table,) * has[2]
    force = acting if len(acting) > 1 else acting[0] if acting else None
    route = nh.discretize(nh.Forced(system, nh.Gravity(F, x) if has[0] else None, force), h).route.compiled_route
    assert route is not None
    free = getattr(route.body, "body", route.body)
    none = kernels.Pull(np.zeros(0), np.zeros((2, 0)), np.zeros((0, 0)), np.zeros((1, 2)))
    body = route.body if any(has) else kernels.ForcedBody(free, none)
    rows = np.vstack([table[: len(table) if has[2] else 0] @ _ROWS[kind].T, np.zeros(2)]).ravel()
    weight = [*np.resize([*F, 0.0], 3), *lever] if has[0] else [0.0] * 9
    about = [n if has[0] else 0, has[1], h / 2, h * share, *C, *weight, len(rows) // 2, *rows]
    return body, [*np.pad(free, (0, 8 - len(free))), *about], rng.normal(size=2) * 10.0 ** rng.uniform(-3, 0.5)


@pytest.mark.profile("routes", keep=["*-20000"])
@pytest.mark.parametrize("steps", [20_000, 1_000_000])
@pytest.mark.parametrize("kind", list(_ROWS))
def test_same_bits_under_forces(kind: str, steps: int) -> None:
    """Weights, friction and tables: steps of random bodies and starts, refused ones and ones that stop among them."""
    rng, module = np.random.default_rng(21), Module(kind, _STEPS)
    outcomes, done_here = set(), 0
    while done_here < steps:
        forces = rng.choice(["weight", "friction", "weight and friction", "table", "weight, friction, table", "none"])
        body, flat, momentum = _forced(kind, rng, forces)
        code, done = _outcome(module, body, tuple(flat), momentum, np.array([0.8, 0.6, 0.0, 0.0]))
        outcomes.add((code, done == 0))
        done_here += done
    assert (0, False) in outcomes
    assert steps < 1_000_000 or {(1, True), (1, False)} <= outcomes


def test_same_bits_of_the_flow() -> None:
    """A million momenta of the continuous motion of random tops on SO(4), at times far apart and close together."""
    rng, module, count = np.random.default_rng(23), Module("flow4", 2 * _STEPS), 2 * _STEPS
    for turn in range(500):
        f = kernels.Arrowhead(10.0 ** rng.uniform(-1, 1, 3), rng.normal(size=3) * rng.choice([0.0, 0.1, 1.0]))
        node, times = np.zeros((2, 4)), np.cumsum(rng.uniform(0, 10.0 ** rng.uniform(-4, 0), count))
        node[0, :3] = rng.normal(size=3) * rng.integers(0, 2, 3)
        times = times if turn % 2 else -times
        here, _ = kernels.solve_arrowhead(f, node, times, times[-1], 1e-14 / 64)
        there = module.flow(f, node, times, times[-1])
        assert len(here) == count
        assert there.tobytes() == here.tobytes()


@pytest.mark.parametrize("value", [np.inf, np.nan, 1e300, 1e-320])
def test_nasty_flows(value: float) -> None:
    """What is not finite, huge or denormal ends there as it does here."""
    f, node, times = kernels.Arrowhead(np.ones(3), np.array([1.0, 0.5, 0.0])), np.zeros((2, 4)), np.linspace(0, 1, 50)
    node[0, :3] = value, 1.0, 0.0
    here, _ = kernels.solve_arrowhead(f, node, times, 1.0, 1e-14 / 64)
    np.testing.assert_array_equal(Module("flow4", 50).flow(f, node, times, 1.0), here)


PLAIN: dict[str, kernels.AnyBody] = {
    "top": kernels.suslov_body(np.diag([1.0, 2.0]), np.array([0.3, 0.1])),
    "sleigh": kernels.SleighBody(1, 1, 0.5),
    "top4": kernels.secular_top(np.array([1.0, 2.0, 3.0]), np.array([0.3, 0.1, 0.0])),
}


@pytest.mark.parametrize("momentum", [(0.0, 0.0), (np.inf, 1.0), (np.nan, 0.0), (1e300, -1e300), (1e-320, 0.3)])
@pytest.mark.parametrize("kind", PLAIN)
def test_nasty_starts(kind: str, momentum: tuple[float, float]) -> None:
    """What is not finite, huge or denormal ends there as it does here."""
    body = PLAIN[kind]
    rank, _, size = kernels.sizes(body)
    start, pose = np.resize(momentum, rank), np.eye(4)[0] if size == 4 else np.eye(4).ravel()
    _outcome(Module(kind, _STEPS), body, _flat(body), start, pose)


@pytest.mark.parametrize("kind", list(KINDS))
def test_asks_for_no_function(kind: str) -> None:
    """All arithmetic is the module's own: it imports memory and a stack, and exports `run`."""
    module = wasmtime.Module(wasmtime.Engine(), kernel(kind))
    assert {item.name for item in module.imports} <= {"__linear_memory", "__stack_pointer"}
    assert [item.name for item in module.exports] == ["run"]


@pytest.mark.profile("routes", instead="test_asks_for_no_function")
@pytest.mark.parametrize("processor", ["generic", "znver1", "skylake-avx512"])
def test_compiles_on_every_processor(processor: str, tmp_path: Path) -> None:
    """What numba merges for the processor that compiles, stores of exceptions among it, asks for no linker."""
    about = {"NUMBA_CPU_NAME": processor, "NUMBA_CPU_FEATURES": "", "NUMBA_CACHE_DIR": str(tmp_path)}
    environment = os.environ | about | {"NONHOLO_KERNELS": "numba"}
    program = "import sys; from nonholo.base.compiled import wasm; sys.stdout.buffer.write(wasm.module('top4'))"
    content = subprocess.check_output([sys.executable, "-c", program], env=environment)  # noqa: S603
    assert [item.name for item in wasmtime.Module(wasmtime.Engine(), content).exports] == ["run"]


def test_refuses_what_needs_a_linker() -> None:
    """An object without a function of its own is no kernel."""
    with pytest.raises(ValueError, match="needs a linker"):
        module_of(b"\0asm\x01\0\0\0")
