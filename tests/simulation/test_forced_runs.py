"""Stores and orbits of motions under forces, and what does not know of forces."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zarr
from comparisons import assert_same
from refusals import refusals
from simulation.forces import HEAVY, RUB, SLEIGH, SLOPE, TOP

import nonholo as nh

START: dict[str, Any] = {"restricted_velocity": [0.5, -0.3]}
READ = ("momentum", "pose", "energy")


def _brake(time: float, g: np.ndarray, w: np.ndarray) -> np.ndarray:
    del g
    return -time * w


@pytest.mark.parametrize("scheme", ["energy", "variational"])
def test_an_orbit_without_states_has_columns_without_rows(scheme: str) -> None:
    """As after a run whose functions are undefined at its start."""
    forced = nh.Forced(TOP, lambda _: np.nan, lambda *_: np.full(3, np.nan), scheme)
    orbit = nh.simulate(nh.discretize(forced, 0.1), **START, steps=3, throw=False)
    shapes = [getattr(orbit, name).shape for name in ("momentum", "multipliers", "work")]
    assert shapes == [(0, 3), (0, 1), (0,)]


def test_a_stored_function_is_not_run(tmp_path: Path) -> None:
    """A store names neither functions nor anything else than our systems and forces; a function has to be passed."""
    discrete = nh.discretize(nh.Forced(TOP, force=_brake), 0.05)
    orbit, path = nh.simulate(discrete, **START, steps=3), tmp_path / "orbit.zarr"
    nh.save_orbit(orbit, path)
    with pytest.raises(ValueError, match="force is a callable"):
        nh.load_orbit(path)
    assert_same(nh.load_orbit(path, discrete=discrete), orbit, *READ)
    run = tmp_path / "run.zarr"
    assert_same(nh.simulate(discrete, **START, steps=3, store=run), orbit, *READ)
    with pytest.raises(ValueError, match="force is a callable"):
        nh.extend(run, 2)
    assert_same(nh.extend(run, 2, discrete=discrete), nh.simulate(discrete, **START, steps=5), *READ)
    task = nh.EnsembleTask(discrete, steps=3, **START)
    nh.sweep(task, nh.Grid({"time_step": [0.05]}), tmp_path / "sweep.zarr")
    with pytest.raises(ValueError, match="force is a callable"):
        nh.resume(tmp_path / "sweep.zarr")
    pushed = nh.discretize(nh.Forced(SLEIGH, force=np.ones((3, 3))), 0.05)
    nh.save_orbit(nh.simulate(pushed, **START, steps=3), tmp_path / "table.zarr")
    told = json.loads(zarr.open_group(tmp_path / "table.zarr", mode="r").attrs["parameters"])  # type: ignore[arg-type]
    assert told["system"] == {"kind": "ChaplyginSleigh", "parameters": {"mass": 1, "inertia": 1, "a": 0.5, "b": 0.3}}


_FORCED = nh.Forced(TOP, HEAVY, RUB)
_MAP = nh.discretize(_FORCED, 0.1)
_RUN = nh.simulate(_MAP, restricted_velocity=[0.5, -0.3], steps=5)
_PUSHED = nh.discretize(nh.Forced(TOP, force=np.ones((5, 3))), 0.1)
_PAIR = nh.Forced(TOP, force=lambda *state: state[2][:2])
_REFUSED: list[Callable[[], Any]] = [
    lambda: nh.step(_MAP, [0.1, 0.2]),
    lambda: nh.branches(_MAP, momentum=[0.1, 0.2], certify=True),
    lambda: nh.inverse_discrete_legendre(_MAP, np.zeros(3)),
    lambda: nh.fold_distance(_MAP, np.eye(3)),
    lambda: nh.discrete_legendre(_MAP, np.eye(3)),
    lambda: nh.momentum_locus(_MAP),
    lambda: nh.invariant_curve(_MAP, 0.1),
    lambda: nh.critical_energies(_MAP),
    lambda: nh.consistency_defect(_MAP, np.eye(3)),
    lambda: nh.heteroclinic(_MAP, energy=0.1),
    lambda: nh.flow_obstruction(_MAP, 0.1),
    lambda: nh.equilibria(_FORCED),
    lambda: nh.equilibria(_MAP),
    lambda: nh.invariant_measure(_FORCED),
    lambda: nh.conserved_momenta(_FORCED),
    lambda: nh.lyapunov_function(_FORCED),  # type: ignore[arg-type]
    lambda: nh.asymptotics(_RUN),
    lambda: nh.vector_field(_PUSHED.system),
    lambda: nh.ensemble(_PUSHED, restricted_velocity=np.ones((2, 2)), steps=9),
    lambda: nh.ensemble(nh.Forced(TOP, force=np.ones((3, 3))), restricted_velocity=np.ones((2, 2)), times=(0.0, 1.0)),
    lambda: nh.EnsembleTask(_PUSHED, steps=9),
    lambda: nh.EnsembleTask(_MAP, steps=3, reductions=["final_state", "energy_drift"]),
    lambda: nh.plot.phase_portrait(_FORCED),
    lambda: nh.simulate(_MAP, restricted_velocity=[0.5, -0.3], steps=5, branch="nearest"),
    lambda: nh.simulate(_MAP, restricted_velocity=[0.5, -0.3], steps=5, backend="jax"),
    lambda: nh.simulate(_MAP, displacement=np.eye(3), steps=5),
    lambda: nh.discretize(nh.Forced(nh.VeselovaTop(np.diag([1.0, 2.0, 3.0])), HEAVY), 0.1, order=4),
    lambda: nh.discretize(nh.Forced(TOP, HEAVY, scheme="energy"), 0.1, difference="logarithmic"),
    lambda: nh.Forced(TOP, nh.Linear(np.eye(2))),
    lambda: nh.Forced(TOP, nh.Spring([0.1, 0.2], [0.0, 0.0], 1.0)),
    lambda: nh.Forced(TOP, (lambda g: g[0, 0], lambda g: g[1, 1])),
    lambda: nh.Forced(nh.examples.particle().system, lambda q: q[0], scheme="energy"),
    lambda: nh.discretize(_FORCED, 0.1, difference="logarithmic", order=4),
    lambda: nh.flow(_FORCED, restricted_velocity=[0.5, -0.3], times=(0.0, 1.0), method="closed_form"),
    lambda: nh.flow(nh.Forced(TOP, force=np.ones((3, 3))), restricted_velocity=[0.5, -0.3], times=(0.0, 1.0)),
    lambda: nh.Forced(_FORCED, force=RUB),
    lambda: nh.Forced(_FORCED, SLOPE),
    lambda: nh.Forced(3),  # type: ignore[arg-type]
    lambda: nh.Forced(TOP, 3.0),
    lambda: nh.Forced(TOP, SLOPE),
    lambda: nh.Forced(TOP, force=nh.Friction([1.0, 2.0])),
    lambda: nh.Friction([1.0, -2.0, 0.0]),
    lambda: nh.Forced(TOP, force=(RUB, RUB)),
    lambda: nh.Forced(TOP, force=(RUB, np.ones((5, 3)), np.ones((5, 3)))),
    lambda: nh.Forced(TOP, force=(RUB, np.ones((3, 2)))),
    lambda: nh.flow(nh.Forced(TOP, force=(RUB, np.ones((3, 3)))), restricted_velocity=[0.5, -0.3], times=(0.0, 1.0)),
    lambda: nh.Forced(TOP, force=np.ones((3, 2))),
    lambda: nh.Forced(TOP, lambda g: g[0]).potential_energy(np.eye(3)),
    lambda: _PAIR.applied_force(0.0, np.eye(3), np.ones(3)),
]


# Whatever serves free motions alone says so, in place of leaving the forces out.
test_what_does_not_know_of_forces_is_refused = refusals(
    *((ask, r"Force|force|Friction|Gravity") for ask in _REFUSED),
    # the second argument is the potential: friction there is refused with the name of its own argument
    (lambda: nh.Forced(TOP, nh.Friction([1.0, 2.0, 0.0])), r"Friction and other forces as force="),
)
