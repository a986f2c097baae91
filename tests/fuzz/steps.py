"""Fuzz steps of all systems: `python tests/fuzz/steps.py --steps 1000000 --seed 0 [--json FILE]`.

Bodies and starts of all sizes run in ensembles. Every step is checked by the residual of its equation and by where its
displacement lies. One step of one member in four, drawn at random, and every step that was refused are checked by a
continuation that is written apart (`fuzz.following`): whether it comes to the same root, and whether it meets a fold.
"""

# ruff: noqa: E402
import collections
import dataclasses
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))
import compilers

compilers.use_caches()

import numpy as np
from bodies import mass_tensor, random_rows
from fuzz.figures import counted, options, report
from fuzz.following import SHARP, Equations, distance, followed, newton

import nonholo as nh

_STEPS, _MEMBERS = 40, 50
_RESIDUAL = 1e-9  # of the sum of the sizes of what is summed; what is no root misses by the order of one
_AGREED, _DIFFERENT = 1e-6, 1e-3  # relative distance of roots; between them nothing is decided
_NEAR = 1e-6  # a path whose fold is so near s = 1 decides nothing,
_FOLDING = 1e-2  # nor one that ends where the determinant is so small, relative to that at rest


def _tensor(n: int, rng: np.random.Generator) -> np.ndarray:
    """Draw a mass tensor of any size, often with very unequal directions."""
    J = mass_tensor(nh.SO(n), rng)
    stretch = 10.0 ** (rng.choice([0.0, rng.uniform(0, 8)]) * rng.uniform(-1, 0, n))
    return J * stretch * stretch[:, None]


def _sleigh(rng: np.random.Generator) -> Any:
    mass, inertia = 10.0 ** rng.uniform(-1, 1, 2) * 10.0 ** rng.choice([0, rng.uniform(-8, 8)])
    return nh.ChaplyginSleigh(mass, inertia, rng.normal() * rng.choice([0, 1]), rng.normal())


def _motion(n: int) -> Callable[[np.random.Generator], Any]:
    return lambda rng: nh.MultidimensionalSleigh(rng.uniform(0.3, 2), rng.normal(size=n), _tensor(n, rng))


def _any(group: Any) -> Callable[[np.random.Generator], Any]:
    def draw(rng: np.random.Generator) -> Any:
        rows = random_rows(group, int(rng.integers(1, group.dim)), rng)
        return nh.LLSystem(group, mass_tensor(group, rng), rows)

    return draw


FAMILIES: dict[str, Callable[[np.random.Generator], Any]] = {
    **{f"top {n}": lambda rng, n=n: nh.SuslovTop(_tensor(n, rng)) for n in (3, 4, 5, 6, 7)},
    "sleigh": _sleigh,
    **{f"sleigh {n}": _motion(n) for n in (3, 4, 5)},
    **{f"any d on {group!r}": _any(group) for group in (*map(nh.SO, (4, 5, 6, 7)), *map(nh.SE, (3, 4, 5)))},
    "free on SO(4)": lambda rng: nh.RigidBody(mass_tensor(nh.SO(4), rng)),
}


@dataclasses.dataclass(frozen=True)
class Case:
    """A body with its members' steps: displacements (M, K, N, N), momenta along d that were asked for (M, k)."""

    equations: Equations
    time_step: float
    size: float
    batch: nh.Ensemble
    first: np.ndarray

    @property
    def done(self) -> np.ndarray:
        """The steps of each member, -1 for those that could not begin."""
        begun = np.isfinite(self.batch.displacement[:, 0]).all((1, 2))
        return np.where(begun, np.asarray(self.batch.steps_done), -1)


def equations_of(system: Any) -> tuple[Equations, float]:
    """Return the equations of a system, and the size by which its tensor was divided."""
    J = system.homogeneous_mass_tensor
    size = float(np.abs(J).max())
    return Equations(system.group.basis, J / size, system.constraint_subspace, system.annihilator), size


def draw(family: str, rng: np.random.Generator) -> Case:
    """Draw a body of any units, and starts from rest to beyond the folds, many of them near one."""
    system = FAMILIES[family](rng)
    h = 10.0 ** rng.uniform(-3, 0.5)
    equations, size = equations_of(system)
    sizes, x = 10.0 ** rng.uniform(-6, 0.7, (_MEMBERS, 1)), rng.normal(size=(_MEMBERS, system.rank))
    turns = sizes * (x / np.linalg.norm(x, axis=1, keepdims=True))
    r = h * system.restricted_momentum(turns / h) / size
    path = followed(equations, r[::5])  # one in five members is brought near its fold, where it has one
    near = np.where(path.folded, path.s * (1 - 10.0 ** rng.uniform(-16, -1, len(path.s))), 1.0)
    turns[::5] *= near[:, None]
    r[::5] *= near[:, None]
    units = 10.0 ** rng.choice([0.0, rng.uniform(-100, 100)])
    discrete = nh.discretize(_in_units(system, units), h)
    batch = nh.ensemble(discrete, steps=_STEPS, restricted_velocity=turns / h, save_every=1)
    return Case(equations, h, size * units, batch, r)


def _in_units(system: Any, units: float) -> Any:
    """Return the same body in other units of mass."""
    names = [name for name in ("mass", "inertia", "mass_tensor") if hasattr(system, name)]
    masses = {name: units * getattr(system, name) for name in names}
    if hasattr(system, "given_inertia"):
        return nh.LLSystem(system.group, masses["mass_tensor"], system.constraint_subspace)
    return dataclasses.replace(system, **masses)


def judge(case: Case, rng: np.random.Generator) -> collections.Counter[str]:
    """Check a case; return how many of its steps and refusals are what."""
    counts: collections.Counter[str] = collections.Counter()
    done, W = case.done, case.batch.displacement
    _check_every_step(case, counts)
    begun = np.flatnonzero(done >= 0)[::4]
    chosen = rng.integers(0, done[begun] + 1)
    targets = np.where(chosen[:, None] == 0, case.first[begun], _asked(case, begun, np.maximum(chosen, 1)))
    _check_roots(case.equations, W[begun, chosen], targets, counts)
    ended = np.flatnonzero(np.asarray(case.batch.outcome) != 0)
    last = np.where(done[ended, None] < 0, case.first[ended], _asked(case, ended, np.maximum(done[ended], 0) + 1))
    _check_refusals(case.equations, last, np.asarray(case.batch.outcome)[ended], counts)
    return counts


def _asked(case: Case, members: np.ndarray, steps: np.ndarray) -> np.ndarray:
    """Return the momenta along d that displacements of some steps must have, by those before them."""
    before = case.batch.displacement[members, steps - 1]
    return case.equations.momentum(np.nan_to_num(before), "right")


def _check_every_step(case: Case, counts: collections.Counter[str]) -> None:
    done, W = case.done, case.batch.displacement
    there = np.arange(_STEPS + 1) <= done[:, None]
    sound = np.isfinite(W).all((2, 3))
    counts["steps"] += int(np.maximum(done, 0).sum())
    counts["not finite, though successful"] += int((there & ~sound).sum())
    V = np.where(sound[..., None, None], W, np.eye(W.shape[-1]))
    e = case.equations
    gap = np.abs(e.momentum(V[:, 1:]) - e.momentum(V[:, :-1], "right")).max(-1)
    scale = e.scale(V[:, 1:]) + e.scale(V[:, :-1])
    across = np.abs(e.off_the_variety(V)).max(-1, initial=0.0)[:, 1:]
    size = np.abs(V).max((-1, -2))[:, 1:]
    solved = (gap <= _RESIDUAL * scale) & (across <= _RESIDUAL * size)
    counts["solve the equation"] += int((solved & there[:, 1:]).sum())
    counts["wrong: not solved"] += int((~solved & there[:, 1:]).sum())


def _check_roots(equations: Equations, W: np.ndarray, r: np.ndarray, counts: collections.Counter[str]) -> None:
    """Compare roots with those of the continuation; Newton's method takes off the rounding that is large near folds."""
    path = followed(equations, r)
    root, last = newton(equations, W, r)
    sharp, apart = last <= SHARP, distance(path.roots, root)
    same = path.whole & (apart <= _AGREED)
    other = path.whole & sharp & (apart > _DIFFERENT)
    beyond = path.folded & (path.s < 1 - _NEAR)
    counts["sampled"] += len(W)
    counts["the root of the continuation"] += int(same.sum())
    counts["wrong: another root"] += int(other.sum())
    counts["wrong: beyond a fold"] += int(beyond.sum())
    counts["undecided"] += int((~same & ~other & ~beyond).sum())


def _check_refusals(
    equations: Equations, r: np.ndarray, outcomes: np.ndarray, counts: collections.Counter[str]
) -> None:
    path = followed(equations, r)
    regular = path.whole & (path.slopes > _FOLDING)
    counts["refused"] += len(r)
    counts["refused at a fold"] += int(path.folded.sum())
    counts["refused, undecided"] += int((~path.folded & ~regular).sum())
    for outcome in outcomes[regular]:
        counts[f"refused though regular: {nh.Outcome(int(outcome))}"] += 1


def figures(steps: int, seed: int, families: tuple[str, ...] = tuple(FAMILIES)) -> dict[str, Any]:
    """Run and check this many steps, shared by the families; return the counts of each and what was wrong."""
    rows: dict[str, dict[str, int]] = {}
    broken = []
    for at, family in enumerate(families):
        counts: collections.Counter[str] = collections.Counter()
        number = 0
        while counts["steps"] < steps / len(families):
            case = draw(family, np.random.default_rng([seed, at, number]))
            result = judge(case, np.random.default_rng([seed, number]))
            if any(result[name] for name in result if name.startswith(("wrong", "not finite", "refused though"))):
                broken.append({"family": family, "case": [seed, at, number], "counts": dict(result)})
            counts += result
            number += 1
        rows[family] = dict(counts)
    total = sum((collections.Counter(row) for row in rows.values()), collections.Counter())
    return {"all": dict(total), "families": rows, "broken": broken}


def lines(result: dict[str, Any]) -> list[str]:
    """Return figures for people."""
    return counted({**result["families"], "all": result["all"]}) + [f"broken: {row}" for row in result["broken"]]


def main() -> int:
    """Run, check, print the figures."""
    arguments = options(__doc__, steps=1_000_000).parse_args()
    result = report(arguments, lambda: figures(arguments.steps, arguments.seed), lines)
    return int(any(name.startswith(("wrong", "not finite")) for name in result["all"]))


if __name__ == "__main__":
    sys.exit(main())
