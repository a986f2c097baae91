"""How often intervals of `nh.fit` hold the truth, for every combination of kinds of numbers that tells the body.

`python tests/analysis/fit_coverage.py` prints the table of docs/how-to/differentiate-and-fit.md: 500 records of each
combination, with seeds 31,000,000 + 1,000 c + r for record r of combination c in the order of `CASES`. These were fixed
before the first run of the table, which has been run once.

Kinds have rates and noise of their own: a camera that sees places at every third step, turns at every seventh, and a
gyroscope at every step that loses a tenth of its numbers.
"""

import sys
from collections.abc import Callable, Iterator
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

import nonholo as nh

SEED = 31_000_000
STEPS, TIME_STEP = 60, 0.05


class Body(NamedTuple):
    """A body and its motion, with columns and noise of each kind."""

    system_of: Callable[[dict], nh.LLSystem]
    truth: dict[str, float]
    guess: dict[str, float]
    velocity: tuple[float, float]
    columns: dict[str, tuple[str, ...]]
    noise: dict[str, float]


def sleigh(p: dict) -> nh.ChaplyginSleigh:
    """Return a sleigh whose inertia may be known."""
    return nh.ChaplyginSleigh(mass=1.0, inertia=p.get("inertia", 0.7), a=p["a"])


def _top(p: dict) -> nh.SuslovTop:
    rows = [[1.2, 0.1, p["c1"]], [0.1, p["b"], p["c2"]], [p["c1"], p["c2"], 0.9]]
    return nh.SuslovTop(jnp.array(rows))


IN_PLANE = {"position": ("x", "y"), "turn": ("theta",), "rate": ("omega",)}
IN_SPACE = {"turn": ("qw", "qx", "qy", "qz"), "rate": ("omega_x", "omega_y", "omega_z")}
EVERY = {"position": 3, "turn": 7, "rate": 1}
SLEIGH = Body(
    sleigh,
    {"inertia": 0.7, "a": 0.4},
    {"inertia": 0.8, "a": 0.35},
    (1.0, 0.5),
    IN_PLANE,
    {"position": 0.004, "turn": 0.002, "rate": 0.02},
)
TURNING = SLEIGH._replace(truth={"a": 0.4}, guess={"a": 0.35})
TOP = Body(
    _top,
    {"c1": 0.3, "c2": -0.2, "b": 1.0},
    {"c1": 0.25, "c2": -0.15, "b": 1.05},
    (0.9, -0.7),
    IN_SPACE,
    {"turn": 0.001, "rate": 0.002},
)
CASES: dict[str, tuple[Body, tuple[str, ...]]] = {
    "sleigh: position": (SLEIGH, ("position",)),
    "sleigh: position, turn": (SLEIGH, ("position", "turn")),
    "sleigh: position, rate": (SLEIGH, ("position", "rate")),
    "sleigh: position, turn, rate": (SLEIGH, ("position", "turn", "rate")),
    "sleigh of known inertia: turn": (TURNING, ("turn",)),
    "sleigh of known inertia: rate": (TURNING, ("rate",)),
    "sleigh of known inertia: turn, rate": (TURNING, ("turn", "rate")),
    "top: turn": (TOP, ("turn",)),
    "top: rate": (TOP, ("rate",)),
    "top: turn, rate": (TOP, ("turn", "rate")),
}


def record_of(name: str, seed: int) -> dict[str, np.ndarray]:
    """Return a record with noise of the kinds of a case."""
    body, kinds = CASES[name]
    rng = np.random.default_rng(seed)
    discrete = nh.discretize(body.system_of(body.truth), TIME_STEP)
    orbit = nh.simulate(discrete, restricted_velocity=body.velocity, steps=STEPS)
    record = {"t": orbit.time}
    for kind in kinds:
        if kind == "rate":
            rows = orbit.body_velocity[:, : len(body.columns[kind])]
        elif kind == "turn" and body.columns is IN_SPACE:
            turned = orbit.configuration @ nh.SO(3).exp(body.noise[kind] * rng.normal(size=(STEPS + 1, 3)))
            rows = nh.SO(3).pose_from_matrix(turned)
        else:
            rows = orbit.position if kind == "position" else orbit.heading[:, None]
        if kind != "turn" or body.columns is IN_PLANE:
            rows = rows + body.noise[kind] * rng.normal(size=rows.shape)
        is_there = np.arange(STEPS + 1) % EVERY[kind] == 0
        is_there &= (rng.random(STEPS + 1) > 0.1) | (kind != "rate")
        rows = np.where(is_there[:, None], rows, np.nan)
        record |= dict(zip(body.columns[kind], rows.T, strict=True))
    return record


def held(name: str, seed: int) -> list[bool]:
    """Return which parameters lie in their intervals of 95 %."""
    body, _ = CASES[name]
    result = nh.fit(body.system_of, record_of(name, seed), body.guess)
    return [bool(low <= body.truth[each] <= high) for each, (low, high) in result.intervals.items()]


def share_held(name: str, records: int, seed: int = SEED) -> np.ndarray:
    """Return the share of records in which each parameter lies in its interval."""
    first = seed + 1000 * list(CASES).index(name)
    return np.mean([held(name, first + r) for r in range(records)], axis=0)


def table(records: int) -> Iterator[str]:
    """Yield the rows of the table of docs, and the share of all of them."""
    everything = []
    for case, (body, _) in CASES.items():
        shares = share_held(case, records)
        everything += [*shares]
        held_each = ", ".join(f"{name} {100 * x:.1f}" for name, x in zip(body.truth, shares, strict=True))
        yield f"| {case} | {held_each} |"
    yield f"All together: {100 * np.mean(everything):.2f} %"


if __name__ == "__main__":
    for line in table(int(sys.argv[1]) if len(sys.argv) > 1 else 500):
        sys.stdout.write(f"{line}\n")
        sys.stdout.flush()
