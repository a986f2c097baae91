"""Fits of systems in coordinates: recovered numbers, honest intervals, what is not measured, and what is refused."""

import functools
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest
from refusals import refusals
from scipy.stats import chi2

import nonholo as nh
from nonholo.analysis.inverse._measurements import kinds_of

H, STEPS, NOISE = 0.05, 60, 1e-3
TRUTH, GUESS = {"inertia": 0.7, "arm": 0.4}, {"inertia": 1.0, "arm": 0.3}


def body(q, v, p):  # noqa: ANN001, ANN201
    """Return the energy of a robot, whose center of mass is ahead of its axle, and of its wheel."""
    across = jnp.cos(q[2]) * v[1] - jnp.sin(q[2]) * v[0] + p["arm"] * v[2]
    along = jnp.cos(q[2]) * v[0] + jnp.sin(q[2]) * v[1]
    return (along**2 + across**2 + p["inertia"] * v[2] ** 2 + 0.1 * v[3] ** 2) / 2


def rolling(q, p):  # noqa: ANN001, ANN201, ARG001
    """Return the constraints: no slip sideways, and a wheel that rolls."""
    c, s = jnp.cos(q[2]), jnp.sin(q[2])
    return jnp.array([[-s, c, 0.0, 0.0], [c, s, 0.0, -0.1]])


ROBOT = nh.LagrangeDAlembert(
    body, rolling, dimension=4, parameters=TRUTH, coordinates=("x", "y", "theta", "wheel"), heading="theta"
)


def robot(p: dict[str, Any]) -> nh.LagrangeDAlembert:
    """Return a robot of these numbers."""
    return ROBOT.with_parameters(**p)


def recorded(seed: int, *names: str, noise: float = NOISE) -> dict[str, np.ndarray]:
    """Return a noisy record of some coordinates."""
    c, s = np.cos(0.3), np.sin(0.3)
    velocity = (0.8 * c, 0.8 * s, 1.0, 8.0)
    orbit = nh.simulate(nh.discretize(ROBOT, H), configuration=(0.5, -0.2, 0.3, 0), body_velocity=velocity, steps=STEPS)
    rows = orbit.configuration + np.random.default_rng(seed).normal(scale=noise, size=orbit.configuration.shape)
    return {"t": orbit.time} | {name: rows[:, ROBOT.coordinates.index(name)] for name in names}


@pytest.mark.profile("routes", instead="test_noisy_positions_tell_two_numbers")
def test_a_clean_record_is_fitted_closely() -> None:
    """With noise of a millionth the numbers of positions alone are those of the truth, and so is the motion."""
    result = nh.fit(robot, recorded(0, "x", "y", noise=1e-6), GUESS)
    assert {name: pytest.approx(value, abs=1e-4) for name, value in TRUTH.items()} == result.parameters
    assert result.system == robot(result.parameters)
    assert np.abs(result.residuals[0]["position"]).max() <= 5e-6
    assert result.orbit.configuration[0, 2] == pytest.approx(0.3, abs=1e-4)
    assert result.outcome == "converged"


def deviations(result: Any, truth: dict[str, float]) -> np.ndarray:
    """Return the errors of a fit in units of their standard deviations."""
    off = [result.parameters[name] - value for name, value in truth.items()]
    return np.array(off) / np.sqrt(result.covariance.diagonal())


def of_robots(seeds: int) -> np.ndarray:
    """Return those of noisy positions alone."""
    fits = (nh.fit(robot, recorded(seed, "x", "y"), GUESS) for seed in range(seeds))
    return np.array([deviations(result, TRUTH) for result in fits])


def test_noisy_positions_tell_two_numbers() -> None:
    """In four records no error is beyond three deviations, and they are not all small: 8 normal numbers."""
    off = of_robots(4)
    assert np.abs(off).max() <= 3.0
    assert 0.3 <= np.sqrt(np.mean(off**2)) <= 1.7  # 8 numbers: 1 with a deviation of 0.25


@pytest.mark.profile("long", instead="test_noisy_positions_tell_two_numbers")
def test_intervals_hold_in_many_records() -> None:
    """Of 200 records the errors have the deviations that the covariance says: 1 within 0.05."""
    off = of_robots(200)
    assert np.sqrt(np.mean(off**2)) == pytest.approx(1.0, abs=0.15)
    assert np.mean(np.abs(off) <= 3.0) >= 0.98


@pytest.mark.profile("routes", instead="test_noisy_positions_tell_two_numbers")
def test_each_coordinate_has_a_noise_of_its_own() -> None:
    """Positions, headings, beyond half a turn, and a wheel angle are kinds by their names."""
    record = recorded(1, "x", "y", "theta", "wheel")
    record["theta"] = np.angle(np.exp(1j * (record["theta"] + 5 * NOISE * np.sin(7 * np.arange(STEPS + 1)))))
    result = nh.fit(robot, record, GUESS)
    assert list(result.noise) == ["position", "theta", "wheel"]
    assert 0.5 * NOISE <= result.noise["position"] <= 2 * NOISE
    assert 2 * NOISE <= result.noise["theta"] <= 6 * NOISE
    record["heading"] = record.pop("theta")
    assert nh.fit(robot, record, GUESS).parameters == result.parameters


@pytest.mark.profile("routes", instead="test_noisy_positions_tell_two_numbers")
def test_several_trials_have_one_body() -> None:
    """Two records, each with a start of its own, tell more than one."""
    records = [recorded(seed, "x", "y") for seed in (0, 1)]
    alone, both = (nh.fit(robot, arguments, GUESS) for arguments in (records[0], records))
    assert (np.sqrt(both.covariance.diagonal()) < 0.85 * np.sqrt(alone.covariance.diagonal())).all()
    assert len(both.orbit) == 2


def constants(p: dict[str, Any]) -> nh.LagrangeDAlembert:
    """Return a system that has the numbers within."""
    return nh.LagrangeDAlembert(lambda q, v: p["inertia"] * v @ v + 0 * q[0], None, dimension=2)


# Each bad argument says what is missing.
test_bad_fits_are_refused = pytest.mark.profile("routes", cases=["must determine*"])(
    refusals(
        (constants, ("x", "y"), "vary the parameters of one system"),
        (robot, (), "columns of a motion in every trial"),
        (robot, ("x",), "columns of a motion in every trial"),
        (robot, ("wheel",), "must determine all parameters"),
        ask=lambda system_of, columns: nh.fit(system_of, recorded(0, *columns), GUESS),
    )
)


ROD: Any = nh.LagrangeDAlembert(
    lambda q, v, p: v @ v / 2 - p["gravity"] * q[1],
    None,
    holonomic=lambda q, p: jnp.array([q @ q - p["length"] ** 2]),
    dimension=2,
    coordinates=("x", "y"),
    parameters={"gravity": 9.81, "length": 1.2},
)


def rod(p: dict[str, Any]) -> Any:
    """Return a pendulum in Cartesian coordinates of these numbers."""
    return ROD.with_parameters(**p)


def swings(seed: int, noise: float) -> dict[str, np.ndarray]:
    """Return a record of its places."""
    orbit = nh.simulate(nh.discretize(ROD, 0.02), configuration=(0.72, -0.96), body_velocity=(0.8, 0.6), steps=80)
    rows = orbit.configuration + np.random.default_rng(seed).normal(scale=noise, size=(81, 2))
    return {"t": orbit.time, "x": rows[:, 0], "y": rows[:, 1]}


@pytest.mark.profile("routes", instead="test_noisy_positions_tell_two_numbers")
@pytest.mark.parametrize("records", [5, 20])
def test_a_motion_under_holonomic_constraints_is_fitted(records: int) -> None:
    """Numbers of the energy and of the constraint; errors are as large as the fit says, in both alike."""
    guess = {"gravity": 9.0, "length": 1.0}
    result: Any = nh.fit(rod, swings(0, 1e-9), guess)
    assert result.outcome == "converged"
    assert result.parameters == {"gravity": pytest.approx(9.81, abs=1e-6), "length": pytest.approx(1.2, abs=1e-8)}
    assert np.abs(np.linalg.norm(result.orbit.configuration, axis=1) - result.parameters["length"]).max() <= 1e-14
    errors = []
    for seed in range(records):
        noisy = nh.fit(rod, swings(seed, 1e-3), guess)
        off = np.array(list(noisy.parameters.values())) - [9.81, 1.2]
        errors.append(off @ np.linalg.solve(noisy.covariance, off))
    low, high = chi2.ppf([0.005, 0.995], 2 * records)
    assert low < sum(errors) < high


TWISTCAR = {"inertia": 0.1, "center": 0.3, "handle": 0.2}


@functools.cache
def twist() -> Any:
    """Return a motion of the Twistcar."""
    return nh.examples.twistcar(amplitude=0.6, speed=-0.5).simulate(steps=240)


def twistcar(p: dict[str, Any]) -> Any:
    """Return a Twistcar of these numbers."""
    return twist().system.with_parameters(**p)


def misses(seed: int) -> np.ndarray:
    """Return the errors of a fit to noisy poses of the Twistcar in units of their standard deviations."""
    orbit = twist()
    rows = orbit.configuration[:, :3] + np.random.default_rng(seed).normal(scale=1e-3, size=(len(orbit), 3))
    record = {"t": orbit.time} | dict(zip(("x", "y", "theta"), rows.T, strict=True))
    result = nh.fit(twistcar, record, {"inertia": 0.2, "center": 0.2, "handle": 0.25})
    assert result.outcome == "converged"
    return deviations(result, TWISTCAR)


@pytest.mark.profile("routes", instead="test_noisy_positions_tell_two_numbers")
def test_the_twistcar_is_fitted_from_poses() -> None:
    """Inertia, center of mass and length of the handle are within four deviations in each of six records."""
    off = np.array([misses(seed) for seed in range(6)])
    assert np.abs(off).max() <= 4.0
    assert 0.3 <= np.sqrt(np.mean(off**2)) <= 1.7  # 18 numbers: 1 with a deviation of 0.17


@pytest.mark.profile("long", instead="test_noisy_positions_tell_two_numbers")
def test_95_of_100_twistcars_are_within_three_deviations() -> None:
    """All three numbers of a record are within three standard deviations, in 95 of 100 records and more."""
    off = np.array([misses(1000 + seed) for seed in range(100)])
    assert np.count_nonzero((np.abs(off) <= 3.0).all(axis=1)) >= 95
    assert np.sqrt(np.mean(off**2)) == pytest.approx(1.0, abs=0.15)


def test_the_dataset_of_an_orbit_is_a_record() -> None:
    """An orbit and its dataset have the same numbers of each coordinate."""
    orbit = nh.simulate(nh.discretize(ROBOT, H), configuration=(0.5, -0.2, 0.0, 0), momentum=(0.8, 0, 1, 0.8), steps=3)
    names = {name: ((name,),) for name in ROBOT.coordinates}
    (one, _), (two, _) = (kinds_of(names, record, None, 8.0) for record in (orbit, orbit.to_dataset()))
    for k, name in enumerate(names):
        np.testing.assert_array_equal(one[name][0, :, 0], orbit.configuration[:, k])
        np.testing.assert_array_equal(two[name], one[name])
