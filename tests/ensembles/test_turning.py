"""How far the discrete sleigh turns in total, as sweeps keep it, against the closed form of the flow."""

from pathlib import Path

import numpy as np
import pytest
import xarray

import nonholo as nh

START = 1e-8
"""First rate of turning: the turn before the start is missing, START sqrt(I) / pi of the whole."""


def _turns(path: Path, design: nh.Grid, steps: int, start: float = START) -> xarray.Dataset:
    """Return turns of sleighs with mass 1, a = 1 and speed 1 that start next to the repelling equilibrium."""
    discrete = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 1.0), 0.1)
    options = {"reductions": ["turning_deviation", "limit_angle"], "reconstruct": False}
    task = nh.EnsembleTask(discrete, steps=steps, restricted_velocity=(start, -1.0), **options)
    return nh.sweep(task, design, path / "turns.zarr").load()


@pytest.mark.parametrize("time_step", [0.2, 1.5])
def test_deviation_of_one_orbit(time_step: float, tmp_path: Path) -> None:
    """The reduction is the one of `asymptotics`, which follows an orbit of `simulate` to both ends."""
    found = _turns(tmp_path, nh.Grid({"inertia": [0.7], "time_step": [time_step]}), 1500)
    discrete = nh.discretize(nh.ChaplyginSleigh(1.0, 0.7, 1.0), time_step)
    orbit = nh.simulate(discrete, restricted_velocity=(START, -1.0), steps=10)
    discrete_turn, turn = (nh.asymptotics(of).heading_turn for of in (orbit, discrete.system))
    assert discrete_turn is not None
    assert turn is not None
    assert abs(found["turning_deviation"].values.item() - (1 - discrete_turn / turn)) < 2 * START
    assert abs(found["heading_turn"].values.item() - discrete_turn) < 10 * START


def test_every_discrete_sleigh_turns_less(tmp_path: Path) -> None:
    """No member turns as far as its flow, in whichever sense it turns: the deviation is positive."""
    design = nh.Grid({"inertia": np.geomspace(0.1, 10, 12), "time_step": np.linspace(0.3, 4, 12)})
    found = _turns(tmp_path, design, 1500)
    good = found["outcome"].values == 0
    assert 50 < good.sum() < good.size
    assert (found["turning_deviation"].values[good] > 0).all()
    assert np.isnan(found["turning_deviation"].values[~good]).all()


def test_turn_of_each_step() -> None:
    """On the ellipse of its energy, by the angle phi, a step turns by 2 arctan(L tan(d phi / 2)), L^2 = 1 + J/(m a^2).

    As L > 1 this is less than L d phi, which is what the flow turns; the sum of d phi over all steps is pi.
    """
    m, J, a, h = 1.3, 0.7, 0.6, 0.8
    orbit = nh.simulate(nh.discretize(nh.ChaplyginSleigh(m, J, a), h), restricted_velocity=(0.01, -0.5), steps=40)
    pi, p1 = orbit.reduced_momentum.T
    phi = np.arctan2(p1 / np.sqrt(m), pi / np.sqrt(J + m * a * a))
    turn = 2 * np.arctan(np.sqrt(1 + J / (m * a * a)) * np.tan(np.diff(phi) / 2))
    assert np.abs(np.diff(orbit.heading) - turn).max() < 1e-14
    assert np.ptp(orbit.heading) > 3


def test_balanced_sleigh_has_no_deviation(tmp_path: Path) -> None:
    """A balanced sleigh turns forever, so its deviation is not defined."""
    discrete = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 1.0), 0.1)
    options = {"steps": 20, "restricted_velocity": (0.5, -1.0), "reductions": "turning_deviation"}
    found = nh.sweep(nh.EnsembleTask(discrete, **options), nh.Grid({"a": [0.0, 1.0]}), tmp_path / "s.zarr")
    assert np.isnan(found["turning_deviation"].values).tolist() == [True, False]


def test_turning_of_a_top_is_refused(tmp_path: Path) -> None:
    """Only plane sleighs have a total turn."""
    top = nh.discretize(nh.SuslovTop(np.diag([1.0, 2.0, 3.0])), 0.1)
    task = nh.EnsembleTask(top, steps=5, restricted_velocity=(0.5, 0.1), reductions="turning_deviation")
    with pytest.raises(ValueError, match="must have a plane sleigh"):
        nh.sweep(task, nh.Grid({"time_step": [0.1]}), tmp_path / "s.zarr")


def test_lost_sleighs_are_sound_chunks(tmp_path: Path) -> None:
    """A block of members that have no number is on disk like any other: the result is loaded, and nothing repaired."""
    task = nh.EnsembleTask(
        nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 1.0), 6.0),
        steps=10,
        restricted_velocity=(START, -1.0),
        reductions=["turning_deviation", "energy_drift"],
    )
    nh.sweep(task, nh.Grid({"time_step": [0.5, 6.0]}), tmp_path / "lost.zarr", block=1)
    assert np.isnan(nh.load_sweep(tmp_path / "lost.zarr")["turning_deviation"].values).tolist() == [False, True]
    assert nh.load_sweep(tmp_path / "lost.zarr").equals(nh.resume(tmp_path / "lost.zarr"))
