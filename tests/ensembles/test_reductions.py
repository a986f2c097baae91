"""What sweeps keep of each member, against its definition by orbits of single members."""

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray
from bodies import GENERAL
from comparisons import derivatives

import nonholo as nh
from nonholo.discrete import step_jacobians
from nonholo.ensembles import REDUCTIONS
from nonholo.simulation import tangents

J = np.array([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
TOP = nh.discretize(nh.SuslovTop(J, axis=(0.6, 0.0, 0.8)), 0.1)
SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.2, 0.8, 0.5, 0.3), 0.1)
FOLDING = nh.discretize(nh.SuslovTop(J), 1.0)
FOLDS = np.array([1.93257157, -0.68979744])  # ends after more than one step, and less than 400
STARTS = np.array([[0.7, -0.3], [0.1, 0.9], [-0.4, 0.2]])
BOTH = pytest.mark.parametrize("discrete", [TOP, SLEIGH], ids=["top", "sleigh"])


def _reduced(name: str, batch: nh.Ensemble) -> dict[str, np.ndarray]:
    return {key: entry[1] for key, entry in REDUCTIONS[name].function(batch).items()}


def _batch(discrete: nh.Discretization, steps: int = 60, every: int | None = 1, **options: Any) -> nh.Ensemble:
    return nh.ensemble(discrete, steps=steps, save_every=every, **{"restricted_velocity": STARTS, **options})


def _orbit(discrete: nh.Discretization, member: int = 0, steps: int = 60) -> nh.Orbit:
    return nh.simulate(discrete, restricted_velocity=STARTS[member], steps=steps)


def _early(every: int | None) -> nh.Ensemble:
    """Return members of which one rests, one ends early and one does not start."""
    momenta = np.array([[0.0, 0.0], FOLDS, [50.0, -50.0]])
    return nh.ensemble(FOLDING, momentum=momenta, steps=400, save_every=every)


@BOTH
@pytest.mark.parametrize("every", [None, 1, 20])
def test_final_state_is_the_last_one(discrete: nh.Discretization, every: int | None) -> None:
    """The final state is that of `simulate`, to the rounding of 60 products; every step is counted."""
    result = _reduced("final_state", _batch(discrete, every=every))
    for member in range(3):
        orbit = _orbit(discrete, member)
        for name, wanted in (("momentum", orbit.restricted_momentum), ("energy", orbit.energy), ("pose", orbit.pose)):
            assert wanted is not None
            assert np.abs(result[f"final_{name}"][member] - wanted[-1]).max() < 1e-13, name
    assert result["steps_done"].tolist() == [60] * 3


@pytest.mark.parametrize("every", [None, 1])
def test_final_state_of_members_that_end_early(every: int | None) -> None:
    """The final state of a member that ends early is its last good one; of one that does not start it is NaN."""
    result = _reduced("final_state", _early(every))
    whole = nh.simulate(FOLDING, momentum=FOLDS, steps=400, throw=False)
    done = len(whole) - 1
    assert 1 < done < 399
    assert result["steps_done"].tolist() == [400, done, 0]
    assert np.abs(result["final_momentum"][1] - whole.restricted_momentum[-1]).max() < 1e-13
    assert np.isnan(result["final_momentum"][2]).all()
    assert np.isnan(result["final_energy"][2])


@pytest.mark.parametrize("every", [None, 1])
def test_energy_drift_is_the_relative_error(every: int | None) -> None:
    """The drift is the change of energy by its first value: none at rest, some ulps at a fold, NaN without a start."""
    drift = _reduced("energy_drift", _early(every))["energy_drift"]
    orbit = nh.simulate(FOLDING, momentum=FOLDS, steps=400, throw=False)
    wanted = abs(orbit.energy[-1] / orbit.energy[0] - 1)
    assert drift[0] == 0
    assert abs(drift[1] - wanted) < 4e-16
    assert np.isnan(drift[2])


def test_energy_drift_sees_a_drift() -> None:
    """Had all members begun with half the momentum, their energy would be four times what it was."""
    batch = _batch(TOP)
    drift = _reduced("energy_drift", dataclasses.replace(batch, first_momentum=batch.first_momentum / 2))
    assert np.abs(drift["energy_drift"] - 3).max() < 1e-14


@pytest.mark.parametrize(
    ("arm", "h", "steps", "starts"),
    [(0.2, 0.1, 2000, [[1.0, 0.2], [-1.0, -0.3], [0.5, 0.0]]), (0.5, 1.0, 50, [[0.4, -0.9], [9.0, -9.0], [0.1, 0.1]])],
    ids=["full turns", "early ends"],
)
def test_heading_turn_is_that_of_the_orbit(arm: float, h: float, steps: int, starts: Any) -> None:
    """It is the unwrapped heading of the good steps, full turns counted; of one that does not start it is NaN."""
    sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, arm), h)
    batch = nh.ensemble(sleigh, restricted_velocity=starts, steps=steps, save_every=1)
    turn = _reduced("limit_angle", batch)["heading_turn"]
    assert abs(turn[0]) > 2 * np.pi or np.isnan(turn).tolist() == [False, True, False]
    for member in np.flatnonzero(batch.steps_done):
        heading = nh.simulate(sleigh, restricted_velocity=starts[member], steps=steps, throw=False).heading
        assert abs(turn[member] - (heading[-1] - heading[0])) < 1e-12  # sums of 2000 angles


@pytest.mark.parametrize("every", [None, 1, 20])
def test_axis_angle_is_that_of_rotated_velocities(every: int | None) -> None:
    """The angle of a top is that between its first and its last angular velocity in space."""
    angle = _reduced("limit_angle", _batch(TOP, every=every))["axis_angle"]
    for member in range(3):
        orbit = _orbit(TOP, member)
        first, last = (orbit.configuration[at] @ orbit.body_velocity[at] for at in (0, -1))
        cosine = first @ last / np.linalg.norm(first) / np.linalg.norm(last)
        assert abs(np.cos(angle[member]) - cosine) < 1e-13
        assert angle[member] > 0.03


def test_branch_counts_are_those_over_the_first_momentum() -> None:
    """Real values of the map are counted over the first momentum of each member's own body: here one or three."""
    rng = np.random.default_rng(2)
    starts, offsets = rng.normal(size=(60, 2)), rng.uniform(-1, 1, 60)
    sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 1.0)
    batch = nh.ensemble(sleigh, restricted_velocity=starts, steps=1, parameters={"b": offsets})
    counts = _reduced("branch_counts", batch)["real_branches"]
    for count, b, start in zip(counts, offsets, starts, strict=True):
        system = nh.ChaplyginSleigh(1.0, 1.0, 0.5, b)
        values = nh.displacements_over(nh.discretize(system, 1.0), system.constrained_inertia @ start)
        assert count == values.multiplicity[values.is_real].sum()
    assert set(counts) == {1, 3}


@pytest.mark.parametrize(
    ("discrete", "starts"),
    [(TOP, STARTS[:2]), (SLEIGH, STARTS[:2])]
    + [(nh.discretize(GENERAL[name][0], 0.05), GENERAL[name][1][None]) for name in ("suslov 4", "sleigh 3")],
    ids=["top", "sleigh", "suslov 4", "sleigh 3"],
)
def test_lyapunov_is_the_growth_of_differences(discrete: nh.Discretization, starts: np.ndarray) -> None:
    """The exponent is the largest growth of small differences of first momenta over all steps."""
    steps = 12
    batch = nh.ensemble(discrete, restricted_velocity=starts, steps=steps, save_every=1)
    result = _reduced("lyapunov", batch)["lyapunov"]

    def last(momentum: np.ndarray) -> np.ndarray:
        return nh.simulate(discrete, momentum=momentum, steps=steps, reconstruct=False).restricted_momentum[-1]

    for member, exponent in enumerate(result):
        slopes = derivatives(last, batch.restricted_momentum[member, 0], 1e-3)
        wanted = np.log(np.linalg.norm(slopes, 2)) / (steps * discrete.time_step)
        assert abs(exponent - wanted) < 1e-8  # differences: 1e-10 of the slopes, divided by a time of about one


def _assert_tangents(batch: nh.Ensemble) -> None:
    """Compare derivatives of steps in closed form with those by the definition."""
    result = tangents(batch.members, batch.reduced_momentum, batch.cayley)
    for member, done in enumerate(batch.steps_done):
        assert done > 0
        wanted = step_jacobians(batch.members.of(member), batch.orbit(member).displacement)
        assert np.abs(result[member, : done + 1] - wanted).max() < 1e-12 * np.abs(wanted).max()


@pytest.mark.profile("routes", keep=["*-top"])
@BOTH
@pytest.mark.parametrize("size", [0.0, 1e-9, 1.0, 4.0])
def test_tangents_are_derivatives_of_steps(discrete: nh.Discretization, size: float) -> None:
    """A derivative in closed form is that by the definition: at rest, near it and far, whatever the time step."""
    own = {"time_step": np.array([1e-3, 0.1, 0.5])}
    batch = nh.ensemble(discrete, restricted_velocity=size * STARTS, steps=20, save_every=1, parameters=own)
    _assert_tangents(batch)


def test_lyapunov_of_members_that_end_early() -> None:
    """The exponent of a member that ends early is that of its good steps; where there is none it is NaN."""
    exponent = _reduced("lyapunov", _early(1))["lyapunov"]
    done = len(nh.simulate(FOLDING, momentum=FOLDS, steps=400, throw=False)) - 1
    whole = nh.ensemble(FOLDING, momentum=FOLDS[None], steps=done, save_every=1)
    other = _reduced("lyapunov", whole)["lyapunov"][0]  # a sum over other numbers of steps: rounded otherwise
    assert exponent[1] == pytest.approx(other, rel=1e-14)
    assert np.isnan(exponent[2])


@pytest.mark.parametrize(
    ("name", "discrete"),
    [
        ("limit_angle", nh.discretize(SLEIGH.system, 0.1, order=4)),
        ("limit_angle", nh.discretize(GENERAL["sleigh 3"][0], 0.05)),
        ("lyapunov", nh.discretize(SLEIGH.system, 0.1, order=4)),
        ("lyapunov", nh.discretize(SLEIGH.system, 0.1, difference="logarithmic")),
        ("lyapunov", nh.discretize(GENERAL["any d on SO(4)"][0], 0.05)),
        ("lyapunov", nh.discretize(GENERAL["veselova 3"][0], 0.05)),
        ("branch_counts", nh.discretize(SLEIGH.system, 0.1, order=4)),
        ("turning_deviation", TOP),
    ],
    ids=["angle, order 4", "angle, n = 3", "order 4", "logarithmic", "no pair", "in space", "counts", "top"],
)
def test_reductions_without_a_meaning_are_refused(name: str, discrete: nh.Discretization) -> None:
    """A reduction that has no meaning for a system, or no formula, is refused whatever the states are."""
    batch = _batch(SLEIGH, steps=2)
    other = dataclasses.replace(batch, members=dataclasses.replace(batch.members, discrete=discrete))
    with pytest.raises(ValueError, match=r"must (have|be)"):
        REDUCTIONS[name].function(other)


def test_without_poses() -> None:
    """There is no final one, nor the angle of a top; that of a sleigh is."""
    bare = _batch(TOP, reconstruct=False)
    assert "final_pose" not in _reduced("final_state", bare)
    with pytest.raises(ValueError, match="must have poses"):
        _reduced("limit_angle", bare)
    with_poses, without = (_batch(SLEIGH, reconstruct=posed) for posed in (True, False))
    assert np.array_equal(*(_reduced("limit_angle", batch)["heading_turn"] for batch in (with_poses, without)))


@pytest.mark.parametrize("family", [SLEIGH, TOP], ids=["sleigh", "top"])
def test_bodies_by_matrices_are_reduced_as_their_families(family: nh.Discretization) -> None:
    """The numbers that are kept of a top or a sleigh do not depend on its class, nor on the rows of its constraint."""
    system = family.system
    rows = np.array([[1.0, 0.5], [-0.3, 2.0]]) @ system.constraint_subspace
    same = nh.discretize(nh.LLSystem(system.group, system.homogeneous_mass_tensor, rows), family.time_step)
    tensors = np.asarray(system.homogeneous_mass_tensor) * np.array([1.0, 1.3])[:, None, None]
    bodies = {"mass": [1.2, 1.2 * 1.3], "inertia": [0.8, 0.8 * 1.3]} if family is SLEIGH else {"mass_tensor": tensors}
    run = {"body_velocity": STARTS[:2] @ system.constraint_subspace, "steps": 60, "save_every": 1}
    of_family = nh.ensemble(family, **run, parameters=bodies)
    by_matrices = nh.ensemble(same, **run, parameters={"mass_tensor": tensors})
    for name in ("limit_angle", *(["turning_deviation"] if family is SLEIGH else [])):
        for quantity, wanted in _reduced(name, of_family).items():
            np.testing.assert_allclose(_reduced(name, by_matrices)[quantity], wanted, 1e-11, err_msg=quantity)
    _assert_tangents(by_matrices)


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
    result = _turns(tmp_path, nh.Grid({"inertia": [0.7], "time_step": [time_step]}), 1500)
    discrete = nh.discretize(nh.ChaplyginSleigh(1.0, 0.7, 1.0), time_step)
    orbit = nh.simulate(discrete, restricted_velocity=(START, -1.0), steps=10)
    discrete_turn, turn = (nh.asymptotics(of).heading_turn for of in (orbit, discrete.system))
    assert discrete_turn is not None
    assert turn is not None
    assert abs(result["turning_deviation"].values.item() - (1 - discrete_turn / turn)) < 2 * START
    assert abs(result["heading_turn"].values.item() - discrete_turn) < 10 * START


def test_every_discrete_sleigh_turns_less(tmp_path: Path) -> None:
    """No member turns as far as its flow, in whichever sense it turns: the deviation is positive."""
    design = nh.Grid({"inertia": np.geomspace(0.1, 10, 12), "time_step": np.linspace(0.3, 4, 12)})
    result = _turns(tmp_path, design, 1500)
    good = result["outcome"].values == 0
    assert 50 < good.sum() < good.size
    assert (result["turning_deviation"].values[good] > 0).all()
    assert np.isnan(result["turning_deviation"].values[~good]).all()


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


@pytest.mark.parametrize("design", [{"a": [1.0, 0.0]}, {"time_step": [0.5, 6.0]}], ids=["balanced", "lost"])
def test_sleighs_without_a_deviation(design: dict[str, list[float]], tmp_path: Path) -> None:
    """A balanced sleigh turns forever, so it has none; a block without a number is on disk like any other."""
    discrete, store = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 1.0), 0.1), tmp_path / "s.zarr"
    options = {"restricted_velocity": (START, -1.0), "reductions": ["turning_deviation", "energy_drift"]}
    nh.sweep(nh.EnsembleTask(discrete, steps=10, **options), nh.Grid(design), store, block=1)
    assert np.isnan(nh.load_sweep(store)["turning_deviation"].values).tolist() == [False, True]
    assert nh.load_sweep(store).equals(nh.resume(store))
