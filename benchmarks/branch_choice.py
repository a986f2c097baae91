"""Which value of the multivalued map a step takes, against plain continuation: counts by outcome.

10,000 random tops and sleighs take a step of up to 40 degrees with `step` and with the compiled run of `simulate`; both
displacements, before and after the step, are compared with a continuation from momentum zero in equal steps. Then
10,000 momenta are grown past the fold of their ray, by a millionth to three times: no such step may succeed.

    python benchmarks/branch_choice.py [problems per family, 2000 by default] [--smoke]
"""

import time
from collections import Counter
from collections.abc import Callable

import numpy as np
from _command import options, small
from _continuation import FAMILIES, Problems, fold_factors, followed, random_problems

import nonholo as nh

SAME = 1e-8  # relative distance of displacements
Step = Callable[[nh.Discretization, np.ndarray], tuple[nh.Outcome, np.ndarray]]


def by_step(discrete: nh.Discretization, r: np.ndarray) -> tuple[nh.Outcome, np.ndarray]:
    """Take a step by its definition in JAX, or in closed form traced by JAX."""
    after = nh.step(discrete, r)
    return nh.Outcome(int(after.outcome)), after.displacement[None]


def by_run(discrete: nh.Discretization, r: np.ndarray) -> tuple[nh.Outcome, np.ndarray]:
    """Take the compiled step."""
    orbit = nh.simulate(discrete, momentum=r, steps=1, throw=False)
    return orbit.outcome, orbit.displacement


def reference(problems: Problems) -> tuple[np.ndarray, np.ndarray]:
    """Return roots by continuation in 100 steps, or in 5000 where these are too long, and which were reached."""
    y, sure = followed(problems)
    if not sure.all():
        y[~sure], sure[~sure] = followed(problems.only(~sure), 5000)
    return y, sure


def within(problems: Problems, step: Step) -> Counter:
    """Count what became of steps that exist."""
    y, sure = reference(problems)
    ahead = problems.following(y)
    y_ahead, sure_ahead = reference(ahead)
    references = np.stack([problems.displacement(y), ahead.displacement(y_ahead)], axis=1)
    counts: Counter = Counter()
    for system, r, W, exists in zip(problems.systems, problems.restricted, references, sure & sure_ahead, strict=True):
        outcome, result = step(nh.discretize(system, 1.0), r)
        if outcome == 0:
            missed = np.abs(result - W[-len(result) :]).max() / np.abs(W).max()
            counts[("right" if missed < SAME else "wrong") if exists else "right or wrong, no reference"] += 1
        else:
            counts[f"{outcome}, though followed" if exists else f"{outcome}, not followed either"] += 1
    return counts


def beyond(problems: Problems, rng: np.random.Generator, step: Step) -> Counter:
    """Count what became of steps from momenta past the fold."""
    grown = problems.times(1 + 10 ** rng.uniform(-6, 0.3, len(problems.r)))
    rows = zip(grown.systems, grown.restricted, strict=True)
    return Counter(str(step(nh.discretize(system, 1.0), r)[0]) for system, r in rows)


def folded(family: str, count: int, rng: np.random.Generator) -> list[Problems]:
    """Draw problems whose ray has a fold, with their momenta at it."""
    result: list[Problems] = []
    while sum(len(part.r) for part in result) < count:
        problems = random_problems(family, count, rng)
        factors = fold_factors(problems)
        met = np.flatnonzero(np.isfinite(factors))[: count - sum(len(part.r) for part in result)]
        chosen = np.isin(np.arange(count), met)
        result.append(problems.only(chosen).times(factors[chosen]))
    return result


def main(count: int) -> None:
    """Print the counts."""
    for name, step in (("step", by_step), ("simulate", by_run)):
        for family in FAMILIES[: small(None, 1)]:
            rng, begun = np.random.default_rng(0), time.perf_counter()
            inside = within(random_problems(family, count, rng), step)
            outside = sum((beyond(part, rng, step) for part in folded(family, count, rng)), Counter())
            print(f"{name:9}{family:9} within {dict(inside)}  beyond {dict(outside)}", end="  ")
            print(f"{time.perf_counter() - begun:.0f} s", flush=True)


if __name__ == "__main__":
    parser = options(__doc__)
    parser.add_argument("problems", type=int, nargs="?", default=small(2000, 5))
    main(parser.parse_args().problems)
