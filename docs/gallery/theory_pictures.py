r"""Pictures of the theory pages: the mirror image, a path that meets a fold, the deltoid, a substep, kicks.

Run it to print the numbers that the pages quote and to draw the files of docs/images/theory/.
"""

import io
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL import Image

import nonholo as nh
from nonholo.plot import theme

PICTURES = Path(__file__).parents[1] / "images" / "theory"
SLEIGH = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5, b=0.0), 0.5)
MOMENTUM = np.array([2.35, 1.0])  # of the step with numbers: tan(step angle / 2) is 1/2
TOP = nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 1.0)
SHORT, LONG = np.array([1.1, 0.75]), np.array([-1.3, 1.9])
INSIDE = np.array([0.35, -0.55])  # a point of the deltoid, in units of the inertia J
ARROW: dict[str, Any] = {"arrowstyle": "-|>", "linewidth": 1.8, "shrinkA": 0, "shrinkB": 0}


def mirror() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return F, F' and the odd part of F for the step with numbers."""
    orbit = nh.simulate(SLEIGH, momentum=MOMENTUM, steps=1)
    W = orbit.displacement[0]
    X = SLEIGH.system.group.vee((W - np.linalg.inv(W)) / 2)
    odd = SLEIGH.system.restrict(SLEIGH.system.inertia_operator @ X) / SLEIGH.time_step
    return *orbit.restricted_momentum, odd


def first_folds(count: int) -> np.ndarray:
    """Return the momenta of the first fold on each ray from the identity: the largest root of a cubic."""
    J = np.asarray(TOP.system.mass_tensor)
    B, c = J[:2, :2] + J[2, 2] * np.eye(2), J[:2, 2]
    D = np.linalg.det(B)
    momenta = []
    for angle in np.linspace(0.0, 2 * np.pi, count):
        u, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
        p, s2 = c @ B @ u / D, (c @ across) ** 2 / D
        roots = np.roots([1.0, -p, 2 * s2 - 1, 2 * (c @ u) * (u @ B @ u) / D - p])
        x = max(root.real for root in roots if abs(root.imag) < 1e-9)
        size = 1 / np.hypot(1.0, x)
        momenta.append(2 * (x * size**2 * B @ u + size**2 * (c @ across) * across) / TOP.time_step)
    return np.array(momenta)


def angles(r: np.ndarray) -> tuple[np.ndarray, int | None]:
    """Return the step angles of all real displacements over r, and the index of the principal one among them."""
    result = nh.displacements_over(TOP, r)
    real = np.flatnonzero(result.is_real)
    trace = np.trace(result.displacement[real].real, axis1=1, axis2=2)
    place = None if result.principal is None else int(np.flatnonzero(real == result.principal)[0])
    return np.degrees(np.arccos(np.clip((trace - 1) / 2, -1, 1))), place


def end_of_path(low: float = 0.0, high: float = 1.0) -> float:
    """Return the s at which the principal path over s LONG meets the fold, by bisection."""
    for _ in range(30):
        middle = (low + high) / 2
        low, high = (middle, high) if angles(middle * LONG)[1] is not None else (low, middle)
    return low


def tangents() -> np.ndarray:
    """Return t = tan(step angle / 2) of the three roots over the point inside the deltoid, ascending."""
    horizontal, p_hat = INSIDE
    return np.sort(np.roots([p_hat, -horizontal, 2 + p_hat, -horizontal]).real)


def numbers() -> dict[str, float]:
    """Return what the pages quote."""
    before, after, odd = mirror()
    weights = np.linalg.inv(SLEIGH.system.constrained_inertia)
    return {
        "energy before the step": before @ weights @ before / 2,
        "energy after the step": after @ weights @ after / 2,
        "odd part, first component": odd[0],
        "odd part, second component": odd[1],
        "s at the fold": end_of_path(),
        **{f"angle {k}, degrees": 2 * np.degrees(np.arctan(t)) for k, t in zip((1, 3, 2), tangents(), strict=True)},
    }


@theme.in_style
def draw_mirror() -> Figure:
    """Draw both momenta in the metric of the energy, with the line between them."""
    figure = Figure(figsize=(5.4, 5.0), layout="constrained")
    axes = figure.subplots()
    before, after, odd = (r / np.sqrt(np.diag(SLEIGH.system.constrained_inertia)) for r in mirror())
    turn = np.linspace(0.0, np.pi / 2, 100)
    axes.plot(*np.linalg.norm(before) * np.array([np.cos(turn), np.sin(turn)]), color=theme.LEVEL)
    axes.plot(*np.outer([0.0, 1.25], odd).T, "--", color=theme.MUTED)
    axes.plot(*np.array([before, after]).T, color=theme.MUTED, linewidth=1.0)
    arrows = [(before, theme.DISCRETE, "$F(W_k)$"), (after, theme.UNSTABLE, "$F(W_{k+1})$"), (odd, theme.INK, "$F_o$")]
    for tip, color, name in arrows:
        axes.annotate("", tip, (0.0, 0.0), arrowprops={"color": color, **ARROW})
        offset = (-26, -2) if name == "$F_o$" else (6, 5)
        axes.annotate(name, tip, offset, textcoords="offset points", color=color)
    axes.annotate("$F_e$", (before + odd) / 2, (6, 2), textcoords="offset points")
    axes.annotate("$-F_e$", (after + odd) / 2, (4, 4), textcoords="offset points")
    axes.text(*(1.25 * odd + (0.05, -0.02)), "line of $F_o$", color=theme.MUTED)
    axes.text(0.12, 2.36, "one energy", color=theme.MUTED)
    axes.set(xlabel=r"$\pi/\sqrt{I}$", ylabel=r"$p_1/\sqrt{m}$", xlim=(0.0, 2.8), ylim=(0.0, 2.6))
    axes.set_aspect("equal")
    return figure


def draw_momenta(axes: Axes) -> None:
    """Draw the first folds, and the segments s r with their ends."""
    end = end_of_path()
    axes.fill(*first_folds(400).T, facecolor="#dbe9f3", edgecolor=theme.DISCRETE)
    axes.annotate("", SHORT, (0.0, 0.0), arrowprops={"color": theme.INK, **ARROW})
    axes.annotate("", LONG, end * LONG, arrowprops={"color": theme.UNSTABLE, "linestyle": "--", **ARROW})
    axes.plot(*np.outer([0.0, end], LONG).T, color=theme.UNSTABLE, linewidth=1.8)
    axes.plot(*(end * LONG), "o", color=theme.UNSTABLE)
    places = [(SHORT, "$r$", theme.INK), (LONG, "$r$", theme.UNSTABLE), (end * LONG, "fold", theme.UNSTABLE)]
    for at, text, color in places:
        axes.annotate(text, at, (7, 3), textcoords="offset points", color=color)
    axes.text(0.0, -1.2, "first folds", ha="center", color=theme.DISCRETE)
    axes.set(title="Momenta", xlabel="$r_1$", ylabel="$r_2$")
    axes.set_aspect("equal", adjustable="datalim")


@theme.in_style
def draw_fold(resolution: int = 90) -> Figure:
    """Draw a segment that reaches its momentum and one that meets a fold; beside it the angles along the second."""
    figure = Figure(figsize=(9.6, 4.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    draw_momenta(left)
    end = end_of_path()
    for s in np.append(np.linspace(0.02, 1.0, resolution), end - np.geomspace(1e-4, 2e-2, 8)):
        result, principal = angles(s * LONG)
        for place, angle in enumerate(result):
            look: dict[str, Any] = {"color": theme.UNSTABLE, "markerfacecolor": "white"}
            if place == principal:
                look = {"color": theme.STABLE}
            right.plot(s, angle, "o", markersize=3.5, **look)
    right.axvline(end, color=theme.MUTED, linestyle=":")
    right.plot([], [], "o", color=theme.STABLE, label="principal")
    right.plot([], [], "o", color=theme.UNSTABLE, markerfacecolor="white", label="other real")
    right.set(title="Step angles along $s\\,r$", xlabel="$s$", ylabel="degrees", xlim=(0.0, 1.0), ylim=(0.0, 185.0))
    right.legend(loc="lower right")
    return figure


@theme.in_style
def draw_deltoid() -> Figure:
    """Draw the deltoid, a point inside with its three tangents, and the segment from momentum zero."""
    figure = Figure(figsize=(6.0, 5.2), layout="constrained")
    axes = figure.subplots()
    half = np.linspace(-np.pi / 2, np.pi / 2, 400)
    axes.fill(*curve(np.tan(half)), facecolor="#dbe9f3", edgecolor=theme.DISCRETE, linewidth=1.6)
    start = np.array([0.0, 0.5])
    axes.annotate("", INSIDE, start, arrowprops={"color": theme.INK, **ARROW})
    axes.annotate("zero momentum", start, (8, 2), textcoords="offset points")
    for t, name in zip(tangents(), ("1", "3", "2"), strict=True):
        touch, phi = np.array(curve(t)), np.arctan(t)
        way = np.array([np.sin(phi), np.cos(phi)])
        sizes = [(touch - INSIDE) @ way, 0.0]
        ends = INSIDE + np.outer([min(sizes) - 0.35, max(sizes) + 0.35], way)
        color = theme.STABLE if name == "3" else theme.UNSTABLE
        axes.plot(*ends.T, color=color, linewidth=1.2)
        axes.plot(*touch, "o", color=color, markerfacecolor=color if name == "3" else "white", zorder=5)
        label = rf"$\Delta_{name}$: {2 * np.degrees(phi):.0f}°"
        offset = (-58, -16) if name == "1" else (8, -12)
        axes.annotate(label, touch, offset, textcoords="offset points", color=color)
    axes.plot(*INSIDE, "D", color=theme.DISCRETE, zorder=6)
    axes.set(xlabel=r"$h\pi/J$", ylabel=r"$\hat p/J$", ylim=(-2.2, 0.8))
    axes.set_aspect("equal")
    return figure


def curve(t: Any) -> tuple[Any, Any]:
    """Return the point of the deltoid of J = 1 that the line of t touches."""
    return 4 * t**3 / (1 + t**2) ** 2, -2 * (1 - t**2) / (1 + t**2) ** 2


@theme.in_style
def draw_substep() -> Figure:
    """Draw the square of a substep: scale, take the step of length h, scale back."""
    figure = Figure(figsize=(5.6, 2.6), layout="constrained")
    axes = figure.subplots()
    corners = {(0.0, 1.0): "$r$", (1.0, 1.0): r"$r^+$", (0.0, 0.0): r"$\gamma\,r$", (1.0, 0.0): r"$\gamma\,r^+$"}
    for place, name in corners.items():
        axes.text(*place, name, ha="center", va="center", fontsize=15)
    sides = [
        ((0.1, 1.0), (0.9, 1.0), (0.5, 1.09), r"$\Phi_{\gamma h}$, pose $g \to gW$"),
        ((0.1, 0.0), (0.9, 0.0), (0.5, -0.16), r"$\Phi_h$, with the same $W$"),
        ((0.0, 0.86), (0.0, 0.15), (-0.08, 0.5), r"$\gamma\,\cdot$"),
        ((1.0, 0.15), (1.0, 0.86), (1.09, 0.5), r"$\cdot/\gamma$"),
    ]
    for tail, tip, place, name in sides:
        axes.annotate("", tip, tail, arrowprops={"color": theme.DISCRETE, **ARROW})
        axes.text(*place, name, ha="center", va="center")
    axes.set(xlim=(-0.25, 1.25), ylim=(-0.3, 1.25))
    axes.set_axis_off()
    return figure


def draw_kicks(steps: int = 1_000_000) -> Figure:
    """Draw the largest error of T + U up to each time, of kicks and of balanced half impulses."""
    figure = Figure(figsize=(6.4, 3.0), layout="constrained")
    axes, tensor = figure.subplots(), np.diag([1.0, 1.2, 0.7])
    heavy = {
        "weight beside the axis": (nh.SuslovTop(tensor), nh.Gravity([0, 0, -1], [0, 0.1, 0.4]), (0.3, 0.2, 0.0), "-"),
        "knife edge on a slope": (nh.ChaplyginSleigh(1, 1, 0), nh.Gravity([0.4, 0], [0, 0]), (0.7, 0.2, 0.0), "--"),
    }
    for name, (system, weight, velocity, line) in heavy.items():
        for scheme, color in (("variational", theme.CONTINUOUS), ("energy", theme.DISCRETE)):
            discrete = nh.discretize(nh.Forced(system, weight, scheme=scheme), 0.05)
            orbit = nh.simulate(discrete, body_velocity=velocity, steps=steps, save_every=max(1, steps // 10_000))
            error = np.maximum.accumulate(np.abs(orbit.energy - orbit.energy[0]))[1:]
            axes.loglog(orbit.step[1:], error, line, color=color, label=f"{scheme}, {name}")
    axes.set(xlabel="steps", ylabel="largest error of T + U", ylim=(1e-16, 1.0))
    axes.legend(fontsize="small", loc="center right", bbox_to_anchor=(1.0, 0.47))
    return figure


DRAWN: dict[str, Callable[[], Figure]] = {
    "mirror": draw_mirror,
    "fold": draw_fold,
    "deltoid": draw_deltoid,
    "substep": draw_substep,
    "kicks": draw_kicks,
}

if __name__ == "__main__":
    sys.stdout.writelines(f"{name}: {value:.8g}\n" for name, value in numbers().items())
    for name, draw in DRAWN.items():
        page = io.BytesIO()
        draw().savefig(page, dpi=100)
        picture = Image.open(page).convert("RGB").quantize(128, Image.Quantize.MAXCOVERAGE, kmeans=2)
        picture.save(PICTURES / f"{name}.png", optimize=True)
