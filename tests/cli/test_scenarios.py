"""Every scenario under scenarios/ runs and has the motion its title promises."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import Command, Figures, assert_ends

import nonholo as nh

_FOLDER = Path(__file__).parents[2] / "scenarios"
_FILES = sorted(path for path in _FOLDER.glob("*.toml") if not path.stem.endswith("_sweep"))


@pytest.mark.profile("routes", keep=["suslov*", "*sleigh", "long_run", "tilted_axis", "four_steps"])
@pytest.mark.parametrize("path", _FILES, ids=lambda path: path.stem)
def test_example_runs(path: Path, figures: Figures) -> None:
    """Each example succeeds, with energy kept to rounding where the discretization promises it; not under forces."""
    told = figures(path, *(["--steps", 20] if path.stem == "logarithmic_difference" else []))
    assert told["outcome"] == "successful"
    assert told["energy_drift"] < {"logarithmic_difference": 1e-3, "hanging_top": 1e-3, "twisted_sleigh": 1e-2}.get(
        path.stem, 1e-12
    )
    assert told["constraint_residual"] < 1e-14


def test_balanced_sleigh_moves_on_a_circle(figures: Figures) -> None:
    """The balanced sleigh keeps one distance from one point."""
    position = nh.load_orbit(figures(_FOLDER / "balanced_sleigh.toml")["store"]).position
    x, y = position.T
    center = np.linalg.lstsq(np.column_stack([2 * x, 2 * y, np.ones_like(x)]), x**2 + y**2, rcond=None)[0][:2]
    assert np.ptp(np.linalg.norm(position - center, axis=1)) < 1e-12


def test_hanging_top_comes_to_rest(figures: Figures) -> None:
    """Its center of mass ends below the fixed point, and what it falls short of the lowest energy is small."""
    orbit = nh.load_orbit(figures(_FOLDER / "hanging_top.toml")["store"])
    assert orbit.configuration[-1, 2, 2] > 0.999
    assert 0 < orbit.energy[-1] + 9.81 * 0.3 < 1e-3 * (orbit.energy[0] - orbit.energy[-1])


def test_twisting_drives_a_sleigh(figures: Figures) -> None:
    """From rest it gets under way, always forwards, while it swings about; its energy is the work done on it."""
    orbit = nh.load_orbit(figures(_FOLDER / "twisted_sleigh.toml")["store"])
    turning, speed, _ = orbit.body_velocity.T
    assert (speed[0], speed[1:].min() > 0, speed[300:].min() > 0.8) == (0, True, True)
    assert np.count_nonzero(np.diff(np.sign(turning))) >= 10
    assert orbit.energy[-1] == pytest.approx(orbit.work[-1], rel=5e-3)


def _swept(nonholo: Command, name: str, members: int) -> Any:
    assert_ends(nonholo("sweep", _FOLDER / f"{name}.toml", "--members", members, "-o", "s.zarr", "-q"), 0)
    assert Path("s.png").exists()
    return nh.load_sweep("s.zarr").load()


@pytest.mark.profile("routes", instead="test_deviation_of_one_orbit")
def test_turning_sweep_shows_the_closed_form(nonholo: Command) -> None:
    """The lowest row deviates by h^2 J / (24 (1 + J)^2); below the bound no member is lost, most are above."""
    found = _swept(nonholo, "sleigh_turning_sweep", 400)
    J, h = found["inertia"].values, found["time_step"].values
    row = found["turning_deviation"].values[:, 0] / (h[0] ** 2 * J / (24 * (1 + J) ** 2))
    assert np.abs(row - 1).max() < 0.01  # 0.3 h^2, with h = 0.1
    sleighs = [nh.discretize(nh.ChaplyginSleigh(1.0, inertia, 1.0), 1.0) for inertia in J]
    bound = np.sqrt([2 * nh.single_valued_region(sleigh).principal_energy for sleigh in sleighs])
    lost = found["outcome"].values != 0
    below = h < bound[:, None]
    assert not lost[below].any()
    assert lost[~below].mean() > 0.5


@pytest.mark.profile("problems", instead="test_deviation_of_one_orbit")
def test_random_tops_keep_their_branch_below_the_saddle(nonholo: Command) -> None:
    """No top whose energy is below its saddle loses its branch; of those above twice that, none keeps it."""
    found = _swept(nonholo, "random_tops_sweep", 100)
    tops = [nh.discretize(nh.SuslovTop(J), 1.0) for J in found["mass_tensor"].values]
    momenta = np.stack([found["momentum_0"], found["momentum_1"]], axis=1)
    saddles = [nh.critical_energies(top).saddle for top in tops]
    energies = [float(top.system.constrained_energy(p)) for top, p in zip(tops, momenta, strict=True)]
    part, kept = np.array(energies) / np.array(saddles, dtype=float), found["outcome"].values == 0
    assert kept[part < 1].all()
    assert not kept[part > 2].any()
    assert 10 < (part < 1).sum() < 90
    assert np.nanmax(found["energy_drift"]) < 2e-15
