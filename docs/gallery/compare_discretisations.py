r"""Three differences and four constraints on one body: which keep energy, which run back, which are of order two.

A free body in space whose reference point may only move along body axis 1: the velocity (w, v) has v = v_1 e_1. Here
exp d, the skew variety, its Cayley image and the naive constraint v_2 = v_3 = 0 are four different sets. Run it to
print the table of docs/how-to/choose-a-discretisation.md and to draw its picture; that takes some minutes.
"""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import nonholo as nh

TIME_STEP = 0.2
VELOCITY = np.array([0.2, 0.25, 0.9, 1.0])  # w_1, w_2, w_3, v_1
DIFFERENCES = ("matrix", "logarithmic", "Cayley")
CONSTRAINTS = ("skew", "exponential", "Cayley", "naive")
PATHS = ("skew", "naive")
PUBLISHED = {"log W with exp d, consistent": "logarithmic", "W - I with exp d, not": "matrix"}
TOP_VELOCITY = np.array([0.9, -0.4])
FINER = (1, 2, 4, 8)
FLOOR = 1e-17
FIRST_LOOPS = 100  # steps whose paths are drawn
MUTED = "#c3c8d0"
COLORS = {"skew": "#0072b2", "exponential": "#009e73", "Cayley": "#cc79a7", "naive": "#d55e00"}
TITLES = {
    "matrix": "matrix: $l((W - I)/h)$",
    "logarithmic": r"logarithmic: $l(\log W/h)$",
    "Cayley": "user's $l_d$: Cayley vector of $W$",
}
LOOK: Any = {"font.size": 11, "axes.spines.top": False, "axes.spines.right": False, "legend.frameon": False}
PICTURE = Path(__file__).parents[1] / "images" / "gallery" / "compare_discretisations.png"


class Figures(NamedTuple):
    """What was measured of one discretization.

    Attributes:
        energy: Relative energy errors along the run.
        reversal: Distance by which a run back misses its start; NaN where the inverse displacement is refused.
        order: Slope of the momentum error against the time step.
    """

    energy: np.ndarray
    reversal: float
    order: float


def body() -> nh.LLSystem:
    """Return the body on SE(3): three different moments, center of mass beside the reference point."""
    center = np.array([0.0, 0.3, 0.2])
    tensor = np.diag([0.5, 0.7, 1.0, 1.0])
    tensor[:3, :3] += np.outer(center, center)
    tensor[:3, 3] = tensor[3, :3] = center
    return nh.LLSystem(nh.SE(3), tensor, nh.reference_point_subspace(3, [[1.0, 0.0, 0.0]]))


def top() -> nh.SuslovTop:
    """Return the Suslov top of the published comparison, with a body of our own."""
    return nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])


def _cayley_coordinates(system: nh.LLSystem, W: Any) -> Any:
    """Return the vector x with W = cayley(x), of a NumPy or a JAX matrix."""
    xp = W.__array_namespace__()
    eye = xp.eye(W.shape[-1])
    return 2 * system.group.vee(xp.linalg.solve((W + eye).T, (W - eye).T).T)


def difference(name: str, system: nh.LLSystem) -> str | Callable[[Any], Any]:
    """Return a difference by its name; "Cayley" is a callable as a user would write it, l at the Cayley vector."""
    inertia = np.asarray(system.inertia_operator)

    def of_cayley(W: Any) -> Any:
        x = _cayley_coordinates(system, W)
        return x @ inertia @ x / (2 * TIME_STEP)

    return of_cayley if name == "Cayley" else name


def constraint(name: str, system: nh.LLSystem) -> str | tuple[Callable[[Any], Any], ...]:
    """Return a constraint by its name; "Cayley" are functions f_j as a user would write them."""
    if name != "Cayley":
        return name
    return tuple(lambda W, row=row: row @ _cayley_coordinates(system, W) for row in np.asarray(system.annihilator))


def discretized(first: str, second: str) -> nh.Discretization:
    """Return the body with a difference and a constraint."""
    system = body()
    return nh.discretize(system, TIME_STEP, difference(first, system), constraint(second, system))


def reversal(discrete: nh.Discretization, steps: int = 20) -> float:
    """Run forward, invert the last displacement, run back: return by how much the first displacement is missed."""
    inverse = discrete.system.group.inverse
    W = nh.simulate(discrete, restricted_velocity=VELOCITY, steps=steps).displacement
    try:
        back = nh.simulate(discrete, displacement=inverse(W[-1]), steps=steps).displacement
    except ValueError:  # the inverse does not lie on the variety
        return float("nan")
    return float(np.abs(back[-1] - inverse(W[0])).max())


def momentum_errors(
    discrete: nh.Discretization, velocity: np.ndarray, steps: int, finer: tuple[int, ...] = (1, 2, 4)
) -> np.ndarray:
    """Return errors of the momentum after steps * TIME_STEP for time steps TIME_STEP / n.

    The map depends on time step and velocity through their product: a slower start is the finer step, and nothing is
    compiled again.
    """
    end = [0.0, steps * float(discrete.time_step)]
    exact = nh.flow(discrete.system, restricted_velocity=velocity, times=end, rtol=1e-12, atol=1e-13)
    runs = (
        nh.simulate(discrete, restricted_velocity=velocity / n, steps=n * steps, save_every=n * steps) for n in finer
    )
    result = [n * run.restricted_momentum[-1] for n, run in zip(finer, runs, strict=True)]
    return np.abs(np.array(result) - exact.restricted_momentum[-1]).max(axis=1)


def measured(first: str, second: str, steps: int = 250) -> Figures:
    """Measure one discretization of the body."""
    discrete = discretized(first, second)
    energy = nh.simulate(discrete, restricted_velocity=VELOCITY, steps=steps).energy
    errors = momentum_errors(discrete, VELOCITY, 10)
    return Figures(energy / energy[0] - 1, reversal(discrete), float(np.log2(errors[-2] / errors[-1])))


def tracks(steps: int = 300) -> dict[str, nh.Orbit]:
    """Return the orbits with the matrix difference whose paths are drawn, and the continuous one."""
    result = {
        name: nh.simulate(discretized("matrix", name), restricted_velocity=VELOCITY, steps=steps) for name in PATHS
    }
    times = np.linspace(0.0, steps * TIME_STEP, 10 * steps + 1)
    return result | {"flow": nh.flow(body(), restricted_velocity=VELOCITY, times=times)}


def published(steps: int = 10) -> dict[str, np.ndarray]:
    """Return momentum errors of the Suslov top on exp d: the difference that is consistent with it, and the other."""
    result = {}
    for label, name in PUBLISHED.items():
        discrete = nh.discretize(top(), TIME_STEP, name, "exponential")
        result[label] = momentum_errors(discrete, TOP_VELOCITY, steps, FINER)
    return result


def published_drift(steps: int = 250) -> dict[str, float]:
    """Return the ranges of the relative energy errors of the same two."""
    result = {}
    for label, name in PUBLISHED.items():
        discrete = nh.discretize(top(), TIME_STEP, name, "exponential")
        energy = nh.simulate(discrete, restricted_velocity=TOP_VELOCITY, steps=steps).energy
        result[label] = float(np.ptp(energy / energy[0]))
    return result


def row(first: str, second: str, figures: Figures) -> str:
    """Return one line of the table."""
    back = "refused" if np.isnan(figures.reversal) else f"{figures.reversal:.0e}"
    return f"| {first} | {second} | {np.ptp(figures.energy):.1e} | {back} | {figures.order:.2f} |"


def draw(
    table: dict[tuple[str, str], Figures],
    orbits: dict[str, nh.Orbit],
    errors: dict[str, np.ndarray],
    drifts: dict[str, float],
) -> Figure:
    """Draw energy errors, paths, a phase portrait and the published comparison."""
    with matplotlib.rc_context(LOOK):
        figure = Figure(figsize=(13.5, 7.6), layout="constrained")
        axes = figure.subplots(2, 3)
        for panel, first in zip(axes[0], DIFFERENCES, strict=True):
            _draw_energy(panel, first, {name: table[first, name].energy for name in CONSTRAINTS})
        axes[0, 0].legend(loc="center", bbox_to_anchor=(0.5, 0.4), ncols=2, title="constraint")
        until = FIRST_LOOPS * TIME_STEP
        _draw_paths(axes[1, 0], {name: orbit.position[orbit.time <= until, :2] for name, orbit in orbits.items()})
        _draw_phases(axes[1, 1], {name: orbit.restricted_momentum[:, :2] for name, orbit in orbits.items()})
        _draw_published(axes[1, 2], errors, drifts)
    return figure


def _draw_energy(axes: Axes, first: str, energies: dict[str, np.ndarray]) -> None:
    for name, energy in energies.items():
        time = TIME_STEP * np.arange(1, len(energy))
        axes.semilogy(time, np.maximum(np.abs(energy[1:]), FLOOR), color=COLORS[name], label=name)
    axes.set(title=TITLES[first], xlabel="time", ylabel="relative energy error", ylim=(FLOOR / 2, 3.0))


def _draw_paths(axes: Axes, paths: dict[str, np.ndarray]) -> None:
    axes.plot(*paths["flow"].T, color=MUTED, lw=2.5, label="continuous")
    for name in PATHS:
        axes.plot(*paths[name].T, ".-", color=COLORS[name], ms=4.5, lw=0.7, label=f"matrix, {name}")
    axes.set(title="path of the reference point", xlabel="x", ylabel="y")
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(loc="upper left", fontsize=10)


def _draw_phases(axes: Axes, momenta: dict[str, np.ndarray]) -> None:
    axes.plot(*momenta["flow"].T, color=MUTED, lw=3.5)
    for name in PATHS:
        axes.plot(*momenta[name].T, ".", color=COLORS[name], ms=4)
    axes.set(title="phase portrait", xlabel="$r_1$, momentum about axis 1", ylabel="$r_2$, about axis 2")


def _draw_published(axes: Axes, errors: dict[str, np.ndarray], drifts: dict[str, float]) -> None:
    steps = TIME_STEP / np.array(FINER)
    for (label, result), color, mark in zip(errors.items(), ("#0072b2", "#e69f00"), "os", strict=True):
        axes.loglog(steps, result, f"{mark}-", color=color, label=f"{label}\nenergy within {drifts[label]:.0e}")
    axes.loglog(steps, 0.15 * errors[label][0] * (steps / steps[0]) ** 2, "--", color="#6b7078", label="slope 2")
    axes.set(title="Suslov top, after arXiv:1605.02666", xlabel="time step", ylabel="momentum error at t = 2")
    axes.set_xticks(steps, [f"{step:g}" for step in steps])
    axes.minorticks_off()
    axes.legend(loc="upper left", fontsize=10)


if __name__ == "__main__":
    measurements = {(first, second): measured(first, second) for first in DIFFERENCES for second in CONSTRAINTS}
    for names, figures in measurements.items():
        sys.stdout.write(row(*names, figures) + "\n")
    PICTURE.parent.mkdir(parents=True, exist_ok=True)
    draw(measurements, tracks(), published(), published_drift()).savefig(PICTURE, dpi=110)
