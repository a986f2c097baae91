"""Not speed but answers: numbers that others published or compute, beside ours. Prints Markdown.

Published numbers stand in `tests/published.py`, with their sources; nothing is fetched. Exudyn and SymPy are asked
where they are installed. A row whose difference is larger than its rule allows ends the script.

    python benchmarks/foreign.py [--smoke]
"""

import importlib.util
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
from _command import options, small
from _inside import accelerations, in_double_precision, published

import nonholo as nh

X = nh.examples


class Row(NamedTuple):
    """Numbers of others and ours.

    Attributes:
        source: Whose they are.
        what: Which numbers.
        rule: What they allow or how they are computed.
        theirs: Their number, where it is one.
        ours: Our number.
        difference: The largest, and what is allowed.
    """

    source: str
    what: str
    rule: str
    theirs: str
    ours: str
    difference: tuple[float, float]


def meijaard() -> Iterator[Row]:
    """The linear equations of the benchmark bicycle, from Jacobians of the nonlinear ones."""
    source = "Meijaard, Papadopoulos, Ruina, Schwab 2007"
    names, tables = ("M", "C1", "K0", "K2"), (published.M, published.C1, published.K0, published.K2)
    for name, ours, theirs in zip(names, published.linear_equations(), tables, strict=True):
        missed = np.abs(ours - theirs).max() / np.abs(theirs).max()
        yield Row(source, f"matrix {name}", "relative to its largest entry", "14 decimals", "Jacobian", (missed, 1e-12))
    missed = 0.0
    for speed, listed in published.EIGENVALUES.items():
        found = published.spectrum(float(speed))
        missed = max(missed, *(min(abs(complex(x) - y) for y in found) for x in listed))
    yield Row(source, "eigenvalues at 0 to 10 m/s", "table 2", "14 decimals", "Jacobian", (missed, 2e-12))
    for name, theirs in zip(("weave", "capsize"), published.SPEEDS, strict=True):
        ours = _zero(published.growth, theirs - 0.1, theirs + 0.1)
        yield Row(source, f"{name} speed", "m/s", f"{theirs:.12f}", f"{ours:.12f}", (abs(ours - theirs), 1e-11))


def _zero(function: Callable[[float], float], low: float, high: float) -> float:
    from scipy.optimize import brentq

    return float(brentq(function, low, high, xtol=1e-14))


def basu_mandal() -> Iterator[Row]:
    """All accelerations of a bicycle that turns, leans and is steered."""
    _, _, ours, theirs = published.turning_state()
    source = "Basu-Mandal, Chatterjee, Papadopoulos 2007"
    missed = np.abs(ours - theirs).max()
    yield Row(source, "accelerations far from upright", "table 1", "13 digits", "accelerations", (missed, 2e-12))


def iftomm() -> Iterator[Row]:
    """The uncontrolled bicycle of the multibody library, manoeuvre M2: the energy is to stay within 1e-3 percent."""
    seconds = small(20.0, 2.0)
    orbit = X.bicycle().simulate(steps=round(seconds / 0.02), time_step=0.02)
    missed = 100 * np.abs(orbit.energy - orbit.energy[0]).max() / orbit.energy[0]
    theirs = "Exudyn's file: 1,429 steps, 9.153e-4 %"
    rule = f"energy within 1e-3 % for {seconds:g} s"
    yield Row(
        "IFToMM, uncontrolled bicycle M2", rule, "fewest steps", theirs, f"{len(orbit) - 1} steps", (missed, 1e-3)
    )


def turntable() -> Iterator[Row]:
    """Two sevenths, on paper."""
    ready = X.ball_on_turntable()
    orbit = ready.flow(times=np.linspace(0.0, small(20.0, 4.0), 9), rtol=1e-13, atol=1e-13)
    missed = np.abs(orbit.configuration - ready.exact(orbit.time)).max()
    yield Row("closed form", "ball on a turntable", "rate 2/7", "sines", "flow", (missed, 1e-11))


def exudyn() -> Iterator[Row]:
    """The rolling coin of its tests, at its step and at finer ones: x of the contact after half a second."""
    if not _installed("exudyn"):
        return
    from peers.exudyn_coin import contact

    r = 0.01
    coin = {"mass": 1.0, "radius": r, "rolling_inertia": r**2 / 2, "turning_inertia": r**2 / 4, "gravity": 9.81}
    start = {"configuration": (0.0, 0.0, np.pi / 2, np.pi / 180, 0.0), "turning": 10 * np.pi, "rolling": 0.0}
    ours = X.tilting_disk(**coin, **start).flow(times=(0.0, 0.5), rtol=1e-12, atol=1e-14).configuration[-1, 0]
    for step in small((5e-4, 2.5e-4, 1.25e-4), (5e-4, 2.5e-4)):
        theirs = contact(step)
        missed, allowed = abs(theirs - ours), 4.0 * step**2  # of order two, and all of it theirs
        yield Row(
            "Exudyn, rollingCoinTest", "x in m", f"h = {step:g} s", f"{theirs:.9f}", f"{ours:.9f}", (missed, allowed)
        )


def sympy() -> Iterator[Row]:
    """Accelerations of two systems by Kane's method, at random states."""
    if not _installed("sympy"):
        return
    from peers.kane import disk, tractor

    for name, kane, ready in (
        (
            "tilting disk",
            disk,
            X.tilting_disk(mass=1.2, radius=0.7, rolling_inertia=0.3, turning_inertia=0.11, gravity=9.8),
        ),
        ("tractor with a trailer", tractor, X.trailers(hitches=(0.8,))),
    ):
        missed = max(_against(ready.system, kane(), seed) for seed in range(small(20, 3)))
        yield Row("SymPy, KanesMethod", name, "random states", "accelerations", "accelerations", (missed, 1e-11))


def _installed(name: str) -> bool:
    there = importlib.util.find_spec(name) is not None
    if not there:
        print(f"left out: {name} is not installed", flush=True)
    return there


def _against(system: Any, kane: Callable[..., np.ndarray], seed: int) -> float:
    rng = np.random.default_rng(seed)
    q, v = rng.normal(scale=0.5, size=(2, system.dimension))
    A = in_double_precision(_rows, system, q)
    v -= np.linalg.pinv(A) @ A @ v
    ours = in_double_precision(accelerations.acceleration, system, q, v)
    theirs = kane(q, v)
    return float(np.abs(ours - theirs).max() / (1 + np.abs(theirs).max()))


def _rows(system: Any, q: np.ndarray) -> np.ndarray:
    return system.constraint_forms(q)


def main() -> None:
    """Print the table."""
    options(__doc__).parse_args()
    rows = [row for table in (meijaard, basu_mandal, iftomm, turntable, exudyn, sympy) for row in table()]
    print("| whose | what | rule | theirs | ours | difference |\n|---|---|---|---|---|---|")
    for *cells, (missed, allowed) in rows:
        print("|", " | ".join([*cells, f"{missed:.1e}"]), "|")
        assert missed <= allowed, (cells, missed, allowed)


if __name__ == "__main__":
    main()
