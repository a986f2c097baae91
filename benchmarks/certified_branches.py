"""Certified and numerical branches of random problems: how often they differ, and what a certificate costs.

    python benchmarks/certified_branches.py [problems] [seed] [--smoke]

Momenta lie from well inside to beyond the fold. One problem in four lies on a fold to within a relative distance of
1e-4 to 1e-16: there rounding merges or splits numerical roots, and the certificate decides. Certified counts are
compared with FLINT's isolation of the exact polynomials too, which shares no proof with ours.

The count is how many values there are, which are real, with which multiplicities; the certificate adds enclosures of
the matrices. Both are timed once, as they come: by the clock, which also sees what else the machine does, and in
processor time. What took more than a millisecond by the clock is repeated alone at the end, in four
rounds of five.
"""

import collections
import gc
import time
from collections.abc import Callable

import numpy as np
from _command import options, small
from _inside import Branches, Located, enclosures, frame_of, locate, problem_of

import nonholo as nh

KINDS = ("top 3", "sleigh", "top 4", "top 6", "sleigh SE(3)")
LIMIT = 1e-3  # seconds


def random_body(rng: np.random.Generator, kind: str) -> nh.Discretization:
    """Return a random body with a random time step."""
    h = float(rng.uniform(0.05, 1.0))
    if kind == "sleigh":
        return nh.discretize(nh.ChaplyginSleigh(*rng.uniform(0.2, 3.0, 2), *rng.normal(0, 0.6, 2)), h)
    n = 3 if kind == "sleigh SE(3)" else int(kind[-1])
    spread = rng.normal(size=(n, n)) / np.sqrt(n)
    J = spread @ spread.T + np.diag(rng.uniform(0.02, 0.5, n))
    if kind == "sleigh SE(3)":
        return nh.discretize(nh.MultidimensionalSleigh(float(rng.uniform(0.2, 3)), rng.normal(0, 0.6, 3), J), h)
    return nh.discretize(nh.SuslovTop(J), h)


def random_momentum(rng: np.random.Generator, discrete: nh.Discretization) -> tuple[np.ndarray, float]:
    """Return restricted momenta from inside to beyond the fold, and their distance from it where it is known."""
    frame = frame_of("random_momentum", discrete)
    direction, length = rng.normal(size=len(frame.stiffness)), rng.normal()
    direction /= np.linalg.norm(direction)

    def point(angle: float) -> np.ndarray:
        x = np.append(np.cos(angle), np.sin(angle) * direction)
        return x if frame.length is None else np.append(x, length * np.sin(angle))

    def momentum(x: np.ndarray) -> np.ndarray:
        system = discrete.system
        W = system.frame @ frame.increment(x) @ system.group.inverse(system.frame) + system.group.identity
        return system.restrict(nh.discrete_legendre(discrete, W))

    def orientation(angle: float) -> float:
        return float(np.linalg.det(nothing.slope(point(angle))))

    nothing = frame.equations(np.zeros(len(discrete.system.constraint_subspace)))
    inner, outer = 0.0, float(rng.uniform(0.05, np.pi / 2))
    if rng.random() < 3 / 4 or orientation(inner) * orientation(outer) > 0:
        return momentum(point(outer)) * rng.choice([1.0, 1.0, 1.6]), np.inf
    for _ in range(50):
        middle = (inner + outer) / 2
        inner, outer = (middle, outer) if orientation(middle) * orientation(inner) > 0 else (inner, middle)
    off = 10 ** rng.uniform(-16, -4)
    return momentum(point(inner)) * (1 + rng.choice([-1, 1]) * off), off


def disagreement(certified: Branches, branches: Branches) -> str:
    """Return in which way numerical branches differ from certified ones; nothing if they agree."""
    if certified.multiplicity.sum() != branches.multiplicity.sum():
        return "number of values"
    if (certified.multiplicity * certified.is_real).sum() != (branches.multiplicity * branches.is_real).sum():
        return "number of real values"
    if len(certified) != len(branches):
        return "multiplicity"
    left = list(range(len(branches)))
    for W in certified.displacement:
        missed = [np.abs(branches.displacement[i] - W).max() / max(1.0, np.abs(W).max()) for i in left]
        if min(missed) > 1e-6:
            return "a displacement"
        left.pop(int(np.argmin(missed)))
    return ""


def count(discrete: nh.Discretization, canonical: np.ndarray) -> list[Located]:
    """Count the values over canonical restricted momenta."""
    return locate(problem_of(discrete.system.canonical.normal_form, float(discrete.time_step), canonical))


def miscounted(result: list[Located]) -> bool:
    """Return whether FLINT isolates other numbers of real and of all roots."""

    def differs(x: Located) -> bool:
        roots = x.factor.complex_roots()
        ours = [mu.imag == 0 for mu in x.balls]
        return sum(z.imag == 0 for z, _ in roots) != sum(ours) or len(roots) != 2 * len(ours) - sum(ours)

    return any(differs(x) for x in result)


def timed(task: Callable[..., object], *arguments: object) -> tuple[float, float]:
    """Return the seconds of one call, by the clock and of processor time."""
    start, busy = time.perf_counter(), time.thread_time()
    task(*arguments)
    return time.perf_counter() - start, time.thread_time() - busy


def alone(task: Callable[..., object], problems: list[tuple]) -> np.ndarray:
    """Return the least seconds of each call without garbage collection, in rounds since the machine has other work."""
    gc.collect()
    gc.disable()
    try:
        rounds = [[min(timed(task, *x)[0] for _ in range(5)) for x in problems] for _ in range(4)]
    finally:
        gc.enable()
    return np.min(rounds, axis=0)


def report(name: str, task: Callable[..., object], problems: list[tuple], durations: list[tuple[float, float]]) -> None:
    """Print median, tail and worst time, and what is left of the slow ones when they are repeated alone."""
    clock, busy = np.array(durations).T
    repeated = alone(task, [problem for problem, seconds in zip(problems, clock, strict=True) if seconds > LIMIT])
    median, tail, worst = 1e3 * np.quantile(clock, [0.5, 0.99, 1.0])
    print(f"{name:12} median {median:.2f} ms, 99 % {tail:.2f}, worst {worst:.2f}", end="; ")
    print(f"above 1 ms {len(repeated)} of {len(clock)}, in processor time {(busy > LIMIT).sum()}", end=", ")
    print(f"alone {(repeated > LIMIT).sum()}, worst alone {1e3 * max(repeated, default=0):.2f} ms")


def place_of(off: float) -> str:
    """Return how close to a fold a problem lies, in words."""
    return next((f"within {limit:g} of a fold" for limit in (1e-14, 1e-13, 1e-12, 1e-4) if off <= limit), "elsewhere")


def main(problems: int = 10_000, seed: int = 0) -> None:
    """Compare, and print outcomes and times."""
    rng = np.random.default_rng(seed)
    outcomes: collections.Counter[tuple[str, str]] = collections.Counter()
    posed: dict[str, list[tuple]] = {kind: [] for kind in KINDS}
    seconds: dict[tuple[str, str], list[tuple[float, float]]] = collections.defaultdict(list)
    wrong = 0
    for i in range(problems):
        kind = KINDS[i % len(KINDS)]
        discrete = random_body(rng, kind)
        r, off = random_momentum(rng, discrete)
        problem = discrete, discrete.system.to_canonical(r)
        posed[kind].append(problem)
        seconds["count", kind].append(timed(count, *problem))
        seconds["certificate", kind].append(timed(enclosures, *problem))
        wrong += miscounted(count(*problem))
        certified = nh.displacements_over(discrete, r, certify=True)
        result = nh.displacements_over(discrete, r)
        outcome = certified.uncertified or disagreement(certified, result) or "agree"
        outcomes[place_of(off), outcome] += 1
        if outcome != "agree" and off > 1e-12:
            print(f"problem {i} of seed {seed}, {kind}: {outcome} at distance {off:.1e} of a fold")
    for (place, outcome), number in sorted(outcomes.items()):
        print(f"{place:24} {outcome:22} {number:6}")
    print(f"{wrong} of {problems} certified counts differ from FLINT's")
    for name, task in (("count", count), ("certificate", enclosures)):
        print(f"{name}:")
        for kind in KINDS:
            report(kind, task, posed[kind], seconds[name, kind])
        clock, busy = np.array([x for kind in KINDS for x in seconds[name, kind]]).T
        print(f"all          median {1e3 * np.median(clock):.2f} ms", end="; ")
        print(f"above 1 ms {np.mean(clock > LIMIT):.1%}, in processor time {np.mean(busy > LIMIT):.1%}")


if __name__ == "__main__":
    parser = options(__doc__)
    parser.add_argument("problems", type=int, nargs="?", default=small(10_000, 20))
    parser.add_argument("seed", type=int, nargs="?", default=0)
    given = parser.parse_args()
    main(given.problems, given.seed)
