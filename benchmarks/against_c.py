"""The compiled kernels beside hand-written C (`c/steps.c`, built here), in one run, in turns; medians of ratios.

Both sides are checked to end at the same state before anything is timed. "stored" keeps every step with its pose, and
for the library it is the whole `simulate` call, the decoding of the orbit included.

    python benchmarks/against_c.py
"""

import ctypes
import shutil
import statistics
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import nonholo as nh
from nonholo import kernels

STEPS, ROUNDS = 1_000_000, 11
FLAGS = ["-O3", "-march=native", "-ffp-contract=fast", "-fno-math-errno", "-fopenmp-simd", "-shared", "-fPIC"]


def built(name: str = "steps.c", functions: tuple[str, ...] = ("suslov", "sleigh", "wide")) -> ctypes.CDLL:
    """Compile a reference."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        raise SystemExit("against_c needs a C compiler. Install gcc.")
    library = Path(tempfile.mkdtemp()) / "reference.so"
    source = Path(__file__).parent / "c" / name
    subprocess.run([compiler, *FLAGS, str(source), "-o", str(library), "-lm"], check=True)  # noqa: S603
    found = ctypes.CDLL(str(library))
    for function in functions:
        getattr(found, function).restype = ctypes.c_long
    return found


def pointer(array: np.ndarray | None) -> ctypes.c_void_p:
    """Return the address of an array."""
    return ctypes.c_void_p(None if array is None else array.ctypes.data)


def paired(library: Callable[[], None], reference: Callable[[], None], unit: float) -> tuple[float, float, float]:
    """Return median times of both in nanoseconds per unit, run in turns, and the median of their ratios."""
    times = ([], [])
    for _ in range(ROUNDS):
        for run, into in ((library, times[0]), (reference, times[1])):
            begin = time.perf_counter()
            run()
            into.append((time.perf_counter() - begin) / unit * 1e9)
    ratios = [a / b for a, b in zip(*times, strict=True)]
    return statistics.median(times[0]), statistics.median(times[1]), statistics.median(ratios)


def one_orbit(found: ctypes.CDLL, name: str, system: nh.SuslovTop | nh.ChaplyginSleigh, velocity: tuple) -> None:
    """Compare one orbit, stored and not."""
    discrete = nh.discretize(system, 0.01)
    step = discrete.route
    body = np.array(step.body, dtype=np.float64)
    first = step.encode(system.to_canonical(system.restricted_momentum(velocity)))
    momenta, charts, poses = np.empty((STEPS, 2)), np.empty((STEPS, 2)), np.empty((STEPS, 4))
    run = getattr(found, name)
    unit = np.array([1.0, 0.0, 0.0, 0.0])

    def reference(rows: tuple) -> None:
        m, q = first.copy(), unit.copy()
        done = run(pointer(body), pointer(m), pointer(q), ctypes.c_long(STEPS), *map(pointer, rows))
        assert done == STEPS

    def library_stored() -> None:
        nh.simulate(discrete, restricted_velocity=velocity, steps=STEPS)

    def library_bare() -> None:
        _, state = kernels.start(step.body, first, unit)
        empty = np.empty((0, 2)), np.empty((0, 2)), np.empty((0, 4))
        kernels.advance(step.body, state, STEPS, STEPS + 1, empty)

    reference((momenta, charts, poses))
    orbit = nh.simulate(discrete, restricted_velocity=velocity, steps=STEPS)
    scale = np.abs(first).max()
    assert np.allclose(step.encode(orbit.reduced_momentum[1:]), momenta, rtol=0, atol=1e-11 * scale)
    library_bare()
    for case, run_library, rows in (
        ("stored with pose", library_stored, (momenta, charts, poses)),
        ("nothing stored", library_bare, (None, None, None)),
    ):
        ours, theirs, ratio = paired(run_library, lambda rows=rows: reference(rows), STEPS)
        print(f"{name:8} {case:18} {ours:8.1f} ns {theirs:8.1f} ns {ratio:6.2f}")


def many_dimensions(found: ctypes.CDLL, n: int, slides: bool) -> None:
    """Compare tops on SO(n) or sleighs on SE(n), nothing stored."""
    rng, k = np.random.default_rng(n), n - 1
    diagonal, coupling = rng.uniform(1, 2, n), 0.3 * rng.normal(size=k) / np.sqrt(n)
    top = nh.SuslovTop.arrowhead(diagonal, coupling)
    body = nh.MultidimensionalSleigh.arrowhead(1.0, 0.3 * np.eye(1, n)[0], diagonal, coupling) if slides else top
    velocity = rng.normal(size=k)
    velocity = np.append(velocity / np.linalg.norm(velocity), [-1.0] * slides)
    discrete = nh.discretize(body, 0.1)
    step = discrete.route
    first = step.encode(body.restricted_momentum(velocity))
    steps = max(10, 2_000_000 // n)
    b, c = step.body.b, step.body.c
    empty = np.empty((0, k + slides)), np.empty((0, k + slides)), np.empty((0, 0))
    ends = {}

    def reference() -> None:
        m, lost, blade = first[:k].copy(), np.zeros(k), np.array([first[k] if slides else 0.0, 0.0])
        numbers = ctypes.c_double(step.body.mass), ctypes.c_double(step.body.arm), pointer(blade)
        done = found.wide(ctypes.c_long(k), *map(pointer, (b, c, m, lost)), *numbers, ctypes.c_long(steps))
        assert done == steps
        ends["c"] = m

    def library() -> None:
        _, state = kernels.start(step.body, first, np.empty(0))
        done, _ = kernels.advance(step.body, state, steps, steps + 1, empty)
        assert done == steps
        ends["library"] = state[:k]

    reference()
    library()
    assert np.allclose(ends["c"], ends["library"], rtol=0, atol=1e-12 * np.abs(first).max())
    ours, theirs, ratio = paired(library, reference, steps * 1e3)
    print(f"{'SE(n)' if slides else 'SO(n)'}    n = {n:<13} {ours:8.2f} us {theirs:8.2f} us {ratio:6.2f}")


def main() -> None:
    """Print the table."""
    found = built()
    print("case                         library           C  ratio")
    one_orbit(found, "suslov", nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), (0.9, -0.4))
    one_orbit(found, "sleigh", nh.ChaplyginSleigh(1.0, 1.0, 0.5), (1.0, -0.3))
    for slides in (False, True):
        for n in (10, 100, 1_000, 10_000, 100_000, 1_000_000):
            many_dimensions(found, n, slides)


if __name__ == "__main__":
    main()
