"""Certified and numerical branches of random problems: how often they differ, and what a certificate costs.

    python benchmarks/certified_branches.py [problems] [seed]

Momenta lie from well inside to beyond the fold. One problem in four lies on a fold to within a relative distance of
1e-4 to 1e-16: there rounding merges or splits numerical roots, and the certificate decides.
"""

import collections
import sys
import time

import numpy as np

import nonholo as nh
from nonholo.discrete import Branches, Discretization
from nonholo.discrete._branch_equations import frame_of
from nonholo.discrete._certificate import enclosures

KINDS = ("top 3", "sleigh", "top 4", "top 6", "sleigh SE(3)")


def random_body(rng: np.random.Generator, kind: str) -> Discretization:
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


def random_momentum(rng: np.random.Generator, discrete: Discretization) -> tuple[np.ndarray, float]:
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


def disagreement(certified: Branches, found: Branches) -> str:
    """Return in which way numerical branches differ from certified ones; nothing if they agree."""
    if certified.multiplicity.sum() != found.multiplicity.sum():
        return "number of values"
    if (certified.multiplicity * certified.is_real).sum() != (found.multiplicity * found.is_real).sum():
        return "number of real values"
    if len(certified) != len(found):
        return "multiplicity"
    left = list(range(len(found)))
    for W in certified.displacement:
        missed = [np.abs(found.displacement[i] - W).max() / max(1.0, np.abs(W).max()) for i in left]
        if min(missed) > 1e-6:
            return "a displacement"
        left.pop(int(np.argmin(missed)))
    return ""


def main(problems: int = 10_000, seed: int = 0) -> None:
    """Compare and print counts, disagreements and times of the certificate alone."""
    rng = np.random.default_rng(seed)
    counts: collections.Counter[tuple[str, str]] = collections.Counter()
    times: dict[str, list[float]] = {kind: [] for kind in KINDS}
    for i in range(problems):
        kind = KINDS[i % len(KINDS)]
        discrete = random_body(rng, kind)
        r, off = random_momentum(rng, discrete)
        canonical = discrete.system.frame_map @ r
        start = time.perf_counter()
        enclosures(discrete, canonical)
        times[kind].append(time.perf_counter() - start)
        certified = nh.displacements_over(discrete, r, certify=True)
        found = nh.displacements_over(discrete, r)
        outcome = certified.uncertified or disagreement(certified, found) or "agree"
        place = next(
            (f"within {limit:g} of a fold" for limit in (1e-14, 1e-13, 1e-12, 1e-4) if off <= limit), "elsewhere"
        )
        counts[place, outcome] += 1
        if outcome != "agree" and off > 1e-12:
            print(f"problem {i} of seed {seed}, {kind}: {outcome} at distance {off:.1e} of a fold")
    for (place, outcome), count in sorted(counts.items()):
        print(f"{place:24} {outcome:22} {count:6}")
    for kind, taken in times.items():
        print(f"{kind:12} median {1e3 * np.median(taken):.2f} ms, worst {1e3 * max(taken):.2f} ms")
    print(f"all          median {1e3 * np.median([t for taken in times.values() for t in taken]):.2f} ms")


if __name__ == "__main__":
    main(*(int(argument) for argument in sys.argv[1:]))
