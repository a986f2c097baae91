"""Not speed but answers: numbers that others published or compute, beside ours. Prints Markdown.

Published numbers stand in `tests/published.py`, with their sources; nothing is fetched. BicycleParameters, Exudyn, opty
and SymPy are asked where they are installed. A row whose difference is larger than its rule allows ends the script.

    python benchmarks/foreign.py [--smoke]
"""

import importlib.util
import statistics
import time
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
        result = published.spectrum(float(speed))
        missed = max(missed, *(min(abs(complex(x) - y) for y in result) for x in listed))
    yield Row(source, "eigenvalues at 0 to 10 m/s", "table 2", "14 decimals", "Jacobian", (missed, 2e-12))
    speeds = nh.critical_values(_riding, (3.0, 8.0), samples=5)  # in one call
    for name, ours, theirs in zip(("weave", "capsize"), speeds, published.SPEEDS, strict=True):
        yield Row(source, f"{name} speed", "m/s", f"{theirs:.12f}", f"{ours:.12f}", (abs(ours - theirs), 1e-11))


def _riding(speed: float) -> Any:
    ready = X.bicycle(speed=speed, lean_rate=0.0, steer_rate=0.0)
    return nh.linearize(ready.system, configuration=ready.configuration, body_velocity=ready.body_velocity)


def bicycle_parameters() -> Iterator[Row]:
    """The state matrix of lean and steer by the package that designs bicycles, at several speeds."""
    if not _installed("bicycleparameters"):
        return
    from peers.bicycle_parameters import state_matrix

    names = ("lean", "steer", "lean'", "steer'")
    for speed in (0.0, 2.0, 4.0, 5.0, 6.0):
        theirs, ours = state_matrix(speed), _riding(speed)
        states = [ours.names.index(name) for name in names]
        missed = np.abs(ours.matrix[np.ix_(states, states)] - theirs).max() / np.abs(theirs).max()
        rule = f"v = {speed:g} m/s, relative to the largest entry"
        yield Row("BicycleParameters", "state matrix A", rule, "matrices", "linearize", (missed, 1e-14))


def basu_mandal() -> Iterator[Row]:
    """All accelerations of a bicycle that turns, leans and is steered."""
    _, _, ours, theirs = published.turning_state()
    source = "Basu-Mandal, Chatterjee, Papadopoulos 2007"
    missed = np.abs(ours - theirs).max()
    yield Row(source, "accelerations far from upright", "table 1", "13 digits", "accelerations", (missed, 2e-12))


def iftomm() -> Iterator[Row]:
    """The uncontrolled bicycle of the multibody library, manoeuvre M2: the energy is to stay within 1e-3 percent."""
    seconds, steps = small(20.0, 2.0), small(1250, 125)
    orbit = X.bicycle().simulate(steps=steps, time_step=seconds / steps)
    missed = 100 * np.ptp(orbit.energy) / orbit.energy[0]
    rule = f"range of the energy below 1e-3 % for {seconds:g} s"
    theirs, ours = "Exudyn's file: 1,428 steps, 9.153e-4 %", f"{steps:,} steps, {missed:.3e} %"
    yield Row("IFToMM, uncontrolled bicycle", "M2", rule, theirs, ours, (missed, 1e-3))


def iftomm_by_exudyn() -> Iterator[Row]:
    """Its three manoeuvres: axes of both frames over five seconds, beside steps of Exudyn that are halved; M2 timed."""
    if not _installed("exudyn"):
        return
    from peers.exudyn_bicycle import ExudynBicycle

    source, seconds = "IFToMM, by Exudyn", small(5.0, 0.5)
    for name, speed, lean_rate, allowed in (("M1", 4.0, 0.05, 10.0), ("M2", 4.6, 0.5, 40.0), ("M3", 8.0, 0.05, 20.0)):
        ready = X.bicycle(speed=speed, lean_rate=lean_rate)
        for step in (2e-3, 1e-3, 5e-4):
            model = ExudynBicycle(speed, lean_rate, step, seconds, stored=True)
            model.run()
            times, theirs = model.axes()
            missed = np.abs(_axes(ready.flow(times=times, rtol=1e-13).configuration) - theirs).max()
            rule = f"h = {1e3 * step:g} ms, {seconds:g} s"  # of order two, and all of it theirs
            yield Row(source, f"{name}, axes of the frames", rule, "trapezoid", "flow", (missed, allowed * step**2))
    model, fast = (ExudynBicycle(4.6, 0.5, 0.014, 20.0, stored=stored) for stored in (True, False))
    model.run()
    yield _race(fast, model.energy())


def _race(theirs: Any, energy: np.ndarray) -> Row:
    """Return processor times of Exudyn and of the map at the energy error that M2 allows: medians of pairs."""
    ready = X.bicycle()
    discrete = ready.discretize(0.016)
    start: Any = {"configuration": ready.configuration, "body_velocity": ready.body_velocity}
    runs = theirs.run, lambda: nh.simulate(discrete, **start, steps=1250)
    pairs = [[_spent(run) for run in runs] for _ in range(small(16, 4))][1:]
    ratio = statistics.median(a / b for a, b in pairs)
    errors = (100 * np.ptp(each) / each[0] for each in (energy, runs[1]().energy))
    medians = map(statistics.median, zip(*pairs, strict=True))
    slow, fast = (f"{1e3 * spent:.0f} ms, {error:.2e} %" for spent, error in zip(medians, errors, strict=True))
    return Row("IFToMM, by Exudyn", "M2, time", f"ratio {ratio:.1f}, at least 7", slow, fast, (7 / ratio, 1.0))


def _spent(run: Callable[[], Any]) -> float:
    begin = time.process_time()
    run()
    return time.process_time() - begin


def _axes(q: np.ndarray) -> np.ndarray:
    """Return the axes of the rear frame and of the fork as matrices."""
    from peers.exudyn_bicycle import STEERING

    one: Any = nh.SO(3).exp
    x, y, z = np.eye(3)
    frames = [one(theta * z) @ one(lean * x) @ one(pitch * y) for theta, lean, pitch in q[:, 2:5]]
    return np.array([(frame, frame @ one(-steer * STEERING)) for frame, steer in zip(frames, q[:, 5], strict=True)])


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


def opty() -> Iterator[Row]:
    """The effort of its car that parks sideways, to which both converge, with steps of order one and two."""
    if not all(map(_installed, ("opty", "cyipopt", "casadi"))):
        return
    from peers.parking import by_opty, by_steps

    nodes, steps = small(501, 101), small(100, 40)
    theirs, result = by_opty(nodes), by_steps(steps)
    ours = 2.0 * float(result.cost)
    assert result.converged, result.outcome
    rule, missed = f"{nodes} nodes; {steps} steps", abs(ours / theirs - 1)
    yield Row("opty, plot_parallel_park", "effort", rule, f"{theirs:.0f}", f"{ours:.0f}", (missed, small(5e-3, 0.1)))


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
        missed = max(_against(ready.system.plain, kane(), seed) for seed in range(small(20, 3)))
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


TABLES = (meijaard, bicycle_parameters, basu_mandal, iftomm, iftomm_by_exudyn, turntable, exudyn, opty, sympy)


def main() -> None:
    """Print the table."""
    options(__doc__).parse_args()
    rows = [row for table in TABLES for row in table()]
    print("| whose | what | rule | theirs | ours | difference |\n|---|---|---|---|---|---|")
    for *cells, (missed, allowed) in rows:
        print("|", " | ".join([*cells, f"{missed:.1e}"]), "|")
        assert missed <= allowed, (cells, missed, allowed)


if __name__ == "__main__":
    main()
