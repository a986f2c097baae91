"""The compiled kernels beside hand-written C (`c/steps.c`, built here), in one run, in turns; medians of ratios.

Both sides are checked to end at the same state before anything is timed, and run in one thread. C is built twice: free
to contract a product and a sum to one operation (FMA), and strict, with the arithmetic of the library. "stored" keeps
every step with its pose; a call is the whole `simulate`, the decoding of the orbit included. "kept rows" are there
before the run; "new rows" are asked for in each run, as a call that returns an orbit has to.

    python benchmarks/against_c.py [--smoke]
"""

import ctypes
import functools
import shutil
import statistics
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from _command import leave_out, options, small
from _inside import kernels

import nonholo as nh

STEPS, ROUNDS, MANY = small((1_000_000, 15, 1_000_000), (2_000, 1, 1_000))
FLAGS = ["-O3", "-march=native", "-fno-math-errno", "-fopenmp-simd", "-shared", "-fPIC"]
HEADER = f"{'case':36} {'library':>11} {'C':>11}  ratio {'strict C':>11}  ratio"


def built(
    name: str = "steps.c", functions: tuple[str, ...] = ("suslov", "sleigh", "wide"), *, strict: bool = False
) -> ctypes.CDLL:
    """Compile a reference, with contracted operations or strictly."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        leave_out("no C compiler. Install gcc.")
    library = Path(tempfile.mkdtemp()) / "reference.so"
    source = Path(__file__).parent / "c" / name
    contract = f"-ffp-contract={'off' if strict else 'fast'}"
    subprocess.run([compiler, *FLAGS, contract, str(source), "-o", str(library), "-lm"], check=True)  # noqa: S603
    result = ctypes.CDLL(str(library))
    for function in functions:
        getattr(result, function).restype = ctypes.c_long
    return result


def pointer(array: np.ndarray | None) -> ctypes.c_void_p:
    """Return the address of an array."""
    return ctypes.c_void_p(None if array is None else array.ctypes.data)


def paired(library: Callable[[], None], references: tuple[Callable[[], None], ...], unit: float, rounds: int) -> list:
    """Return the median time of each, in turns, in seconds per unit, and with each reference the median ratio to it."""
    runs = (library, *references)
    times: list[list[float]] = [[] for _ in runs]
    for _ in range(rounds):
        for run, into in zip(runs, times, strict=True):
            begin = time.perf_counter()
            run()
            into.append((time.perf_counter() - begin) / unit)
    result = [statistics.median(times[0])]
    for each in times[1:]:
        result += [statistics.median(each), statistics.median(a / b for a, b in zip(times[0], each, strict=True))]
    return result


def compare(
    case: str,
    library: Callable[[], None],
    references: tuple[Callable[[], None], ...],
    unit: float,
    rounds: int = ROUNDS,
) -> None:
    """Print a row: the library, C and strict C in nanoseconds, and the ratios to both."""
    ours, *beside = paired(library, references, unit, rounds)
    cells = [f"{1e9 * c:8.1f} ns {ratio:6.2f}" for c, ratio in zip(beside[::2], beside[1::2], strict=True)]
    print(f"{case:36} {1e9 * ours:8.1f} ns {' '.join(cells)}", flush=True)


def one_orbit(both: tuple, name: str, system: nh.SuslovTop | nh.ChaplyginSleigh, velocity: tuple) -> None:
    """Compare one orbit, stored and not."""
    discrete = nh.discretize(system, 0.01)
    step = discrete.route
    body = np.array(step.body, dtype=np.float64)
    first = step.encode(system.to_canonical(system.restricted_momentum(velocity)))
    unit, values = np.array([1.0, 0.0, 0.0, 0.0]), new_rows(STEPS)

    def reference(code: ctypes.CDLL, rows: Callable[[], tuple]) -> Callable[[], None]:
        def run() -> None:
            m, q, into = first.copy(), unit.copy(), rows()
            done = getattr(code, name)(*map(pointer, (body, m, q)), ctypes.c_long(STEPS), *map(pointer, into))
            assert done == STEPS

        return run

    def kernel(rows: tuple, every: int) -> None:
        _, state = kernels.runs_of(step.body).start(step.body, first, unit)
        kernels.runs_of(step.body).advance(step.body, state, STEPS, every, rows)

    def call() -> nh.Orbit:
        return nh.simulate(discrete, restricted_velocity=velocity, steps=STEPS)

    kernel(values, 1)
    momenta = values[0].copy()
    reference(both[0], lambda: values)()
    scale = np.abs(first).max()
    for result in (step.encode(call().reduced_momentum[1:]), momenta):
        assert np.allclose(result, values[0], rtol=0, atol=1e-11 * scale)
    for case, library, rows in (
        ("nothing stored", lambda: kernel(new_rows(0), STEPS + 1), lambda: (None, None, None)),
        ("stored, kept rows", lambda: kernel(values, 1), lambda: values),
        ("stored, new rows", lambda: kernel(new_rows(STEPS), 1), lambda: new_rows(STEPS)),
        ("stored: call, C: kept rows", call, lambda: values),
        ("stored: call, C: new rows", call, lambda: new_rows(STEPS)),
    ):
        compare(f"{name} {case}", library, tuple(reference(code, rows) for code in both), STEPS)


def new_rows(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return rows of momenta, charts and poses."""
    return np.empty((count, 2)), np.empty((count, 2)), np.empty((count, 4))


def many_dimensions(both: tuple, n: int, slides: bool) -> None:
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
    steps = max(30, 2 * STEPS // n)
    b, c = step.body.b, step.body.c
    empty = np.empty((0, k + slides)), np.empty((0, k + slides)), np.empty((0, 0))
    ends = {}

    def reference(code: ctypes.CDLL) -> None:
        m, lost, blade = first[:k].copy(), np.zeros(k), np.array([first[k] if slides else 0.0, 0.0])
        numbers = ctypes.c_double(step.body.mass), ctypes.c_double(step.body.arm), pointer(blade)
        done = code.wide(ctypes.c_long(k), *map(pointer, (b, c, m, lost)), *numbers, ctypes.c_long(steps))
        assert done == steps
        ends["c"] = m

    def library() -> None:
        _, state = kernels.runs_of(step.body).start(step.body, first, np.empty(0))
        done, _ = kernels.runs_of(step.body).advance(step.body, state, steps, steps + 1, empty)
        assert done == steps
        ends["library"] = state[:k]

    library()
    for code in both:
        reference(code)
        assert np.allclose(ends["c"], ends["library"], rtol=0, atol=1e-12 * np.abs(first).max())
    case = f"{'SE(n)' if slides else 'SO(n)'} n = {n}"
    runs = tuple(functools.partial(reference, code) for code in both)
    compare(case, library, runs, steps, ROUNDS if n < MANY else 5)


def main() -> None:
    """Print the table."""
    options(__doc__).parse_args()
    both = built(), built(strict=True)
    print(HEADER)
    one_orbit(both, "suslov", nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), (0.9, -0.4))
    one_orbit(both, "sleigh", nh.ChaplyginSleigh(1.0, 1.0, 0.5), (1.0, -0.3))
    for slides in (False, True):
        for n in (n for n in (4, 10, 30, 100, 1_000, 10_000, 100_000, 1_000_000) if n <= MANY):
            many_dimensions(both, n, slides)


if __name__ == "__main__":
    main()
