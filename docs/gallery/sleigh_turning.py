r"""How far the discrete sleigh turns in total, over 62,500 bodies and time steps: the sweep of scenarios/, with theory.

Along the flow a sleigh turns by $\pi\sqrt{1 + J/(ma^2)}$. Run it to draw the picture of docs/how-to/run-a-sweep.md and
to print what its text quotes; that takes a minute. J is in units of ma^2 throughout.
"""

import sys
import tempfile
import tomllib
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import nonholo as nh

EXAMPLE = Path(__file__).parents[2] / "scenarios" / "sleigh_turning_sweep.toml"
PICTURE = Path(__file__).parents[1] / "images" / "gallery" / "sleigh_turning.png"
COLORS = ("#1a1a1a", "#d55e00", "#0072b2")
LOOK: Any = {"font.size": 11, "axes.spines.top": False, "axes.spines.right": False, "legend.frameon": False}


def swept(side: int) -> xarray.Dataset:
    """Run the example on a square grid."""
    scenario = tomllib.loads(EXAMPLE.read_text())
    ranges = scenario["design"]["values"]
    axes = {name.partition(".")[2]: np.geomspace(of["from"], of["to"], side) for name, of in ranges.items()}
    discrete = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 1.0), 1.0)
    start = scenario["start"]["restricted_velocity"]
    reductions = scenario["keep"]["reductions"]
    steps = scenario["run"]["steps"]
    task = nh.EnsembleTask(discrete, steps=steps, restricted_velocity=start, reductions=reductions, reconstruct=False)
    with tempfile.TemporaryDirectory() as folder:
        return nh.sweep(task, nh.Grid(axes), f"{folder}/turns.zarr").load()


def bound(J: np.ndarray) -> np.ndarray:
    """Return the step h u/a below which all momenta of the energy u^2/2 have a principal value.

    From there on a part of it has no principal value.
    """
    sleighs = [nh.discretize(nh.ChaplyginSleigh(1.0, inertia, 1.0), 1.0) for inertia in J]
    return np.sqrt([2 * nh.single_valued_region(sleigh).principal_energy for sleigh in sleighs])


def leading(J: np.ndarray) -> np.ndarray:
    """Return the missing part of the turn over (h u/a)^2, for small steps."""
    return J / (24 * (1 + J) ** 2)


def lost(results: xarray.Dataset) -> tuple[float, float]:
    """Return which part of the members is lost below the bound, and above it."""
    ended = results["outcome"].values != 0
    below = results["time_step"].values < bound(results["inertia"].values)[:, None]
    return float(ended[below].mean()), float(ended[~below].mean())


def draw(results: xarray.Dataset) -> Figure:
    """Draw the map with both curves, and three of its rows beside the leading term."""
    with matplotlib.rc_context(LOOK):
        figure = Figure(figsize=(13.0, 5.4), layout="constrained")
        left, right = figure.subplots(1, 2, width_ratios=(1.35, 1.0))
        _draw_map(left, results)
        _draw_rows(right, results)
    return figure


def _draw_map(axes: Axes, results: xarray.Dataset) -> None:
    nh.plot.sweep_map(results, "turning_deviation", x="inertia", y="time_step", axes=axes)
    J = results["inertia"].values
    axes.plot(J, bound(J), color="#d55e00", lw=1.6, label="none is lost below")
    axes.set(xlabel=r"$J/(ma^2)$", ylabel=r"$hu/a$", title="")
    axes.set_title("Part of the flow's turn that is missing", loc="left", pad=26)
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2)


def _draw_rows(axes: Axes, results: xarray.Dataset) -> None:
    J = results["inertia"].values
    axes.loglog(J, leading(J), color="#c3c8d0", lw=5, label=r"$J/(24\,(1 + J)^2)$, in units of $ma^2$")
    for step, color in zip((0.2, 1.0, 1.9), COLORS, strict=True):
        row = results.sel(time_step=step, method="nearest")
        h = row["time_step"].values.item()
        axes.loglog(J, row["turning_deviation"] / h**2, color=color, lw=1.3, label=f"$hu/a = {h:.2g}$")
    axes.set(xlabel=r"$J/(ma^2)$", title="")
    axes.set_title(r"... divided by $(hu/a)^2$", loc="left")
    axes.legend(loc="lower center")


if __name__ == "__main__":
    result = swept(250)
    sys.stdout.write(
        f"{result['outcome'].size} members; lost: {lost(result)[0]:.2%} below, {lost(result)[1]:.1%} above\n"
    )
    draw(result).savefig(PICTURE, dpi=110)
