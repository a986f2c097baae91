"""Bodies fitted to simulated records with noise: errors in units of the stated ones, gaps, trials, forms of tables."""

from collections.abc import Callable
from pathlib import Path

import jax
import numpy as np
import pytest

import nonholo as nh
from nonholo.analysis.inverse import Fit
from nonholo.base.types import Array

SLEIGH = nh.discretize(nh.ChaplyginSleigh(mass=1.0, inertia=0.7, a=0.4), 0.05)
TENSOR = np.array([[1.2, 0.1, 0.3], [0.1, 1.0, -0.2], [0.3, -0.2, 0.9]])
GUESS = {"inertia": 1.0, "a": 0.3}
TOP = nh.discretize(nh.SuslovTop(TENSOR), 0.05)


def _sleigh(p: dict) -> nh.ChaplyginSleigh:
    return nh.ChaplyginSleigh(mass=1.0, inertia=p["inertia"], a=p["a"])


def _top(p: dict) -> nh.SuslovTop:
    c1, c2, b = p["c"][0], p["c"][1], p["b"]
    rows = [[1.2 + 0 * b, 0.1 + 0 * b, c1], [0.1 + 0 * b, b, c2], [c1, c2, 0.9 + 0 * b]]
    namespace = b.__array_namespace__() if hasattr(b, "__array_namespace__") else np
    return nh.SuslovTop(namespace.stack([namespace.stack([namespace.asarray(x) for x in row]) for row in rows]))


PUSHES = np.c_[np.cos(0.15 * np.arange(60)), 0.3 + 0.8 * np.sin(0.1 * np.arange(60)), np.zeros(60)]


def _driven(p: dict) -> nh.Forced:
    return nh.Forced(nh.ChaplyginSleigh(p["mass"], p["inertia"], p["a"]), force=PUSHES)


def _rubbed(p: dict) -> nh.Forced:
    friction = nh.Friction(p["root"] ** 2 @ np.eye(2, 3))
    return nh.Forced(nh.ChaplyginSleigh(1.0, p["inertia"], p["a"]), force=friction)


def _sleigh_record(seed: int, discrete: nh.Discretization = SLEIGH, noise: float = 1.0) -> dict[str, np.ndarray]:
    orbit, rng = nh.simulate(discrete, restricted_velocity=(1.0, 0.5), steps=60), np.random.default_rng(seed)
    data = np.c_[orbit.position, orbit.heading] + noise * rng.normal(size=(61, 3)) * [1e-2, 1e-2, 5e-3]
    data[rng.random((61, 3)) < 0.1] = np.nan
    return {"t": orbit.time + 3, "x": data[:, 0], "y": data[:, 1], "theta": data[:, 2]}


def _top_record(seed: int, discrete: nh.Discretization = TOP, noise: float = 1.0) -> dict[str, np.ndarray]:
    orbit = nh.simulate(discrete, restricted_velocity=(0.9, -0.7), steps=60)
    rates = orbit.body_velocity + np.random.default_rng(seed).normal(scale=5e-3 * noise, size=(61, 3))
    return {"t": orbit.time, **dict(zip(("omega_x", "omega_y", "omega_z"), rates.T, strict=True))}


def _errors(found: Fit, truth: list[float]) -> np.ndarray:
    values = np.concatenate([np.ravel(x) for x in found.parameters.values()])
    return (values - truth) / np.sqrt(found.covariance.diagonal())


@pytest.mark.profile("problems", instead="test_exact_record_is_fitted_exactly")
def test_sleigh_is_found_within_its_errors() -> None:
    """Of 100 noisy records with gaps at least 95 are fitted within 3 sigma, and 95 % intervals hold the truth."""
    errors = np.array(
        [_errors(nh.fit(_sleigh, _sleigh_record(s), {"inertia": 1.0, "a": 0.3}), [0.7, 0.4]) for s in range(100)]
    )
    assert (np.abs(errors) < 3).all(axis=1).sum() >= 95
    assert 0.89 <= (np.abs(errors) < 1.98).mean() <= 0.99  # two-sided, binomial: 3.5 sigma for 200


@pytest.mark.profile("routes", instead="test_exact_record_is_fitted_exactly")
@pytest.mark.parametrize(
    ("system_of", "record", "truth", "guess", "noise"),
    [
        pytest.param(
            _top,
            _top_record,
            {"c": np.array([0.3, -0.2]), "b": 1.0},
            {"c": np.array([0.2, -0.1]), "b": 1.1},
            1.0,
            id="top",
        ),
        pytest.param(
            _driven,
            _sleigh_record,
            {"mass": 1.0, "inertia": 0.7, "a": 0.4},
            {"mass": 1.3, "inertia": 1.0, "a": 0.3},
            1.0,
            id="driven",
        ),
        pytest.param(
            _rubbed,
            _sleigh_record,
            {"inertia": 0.7, "a": 0.4, "root": np.array([0.7, 0.6])},
            {"inertia": 1.0, "a": 0.3, "root": np.array([0.5, 0.5])},
            0.1,
            id="friction",
        ),
    ],
)
def test_bodies_are_found_within_their_errors(
    system_of: Callable, record: Callable, truth: dict, guess: dict, noise: float
) -> None:
    """Rates tell a top, known pushes the mass too, slowing down the friction: 95 of 100 in 3 sigma, intervals hold."""
    discrete = nh.discretize(system_of(truth), 0.05)
    values = [float(x) for part in truth.values() for x in np.ravel(part)]
    records = (record(seed, discrete, noise) for seed in range(100))
    errors = np.array([_errors(nh.fit(system_of, each, guess), values) for each in records])
    assert (np.abs(errors) < 3).all(axis=1).sum() >= 95
    assert ((np.abs(errors) < 1.98).mean(axis=0) >= 0.87).all()  # of one parameter, binomial: 3.5 sigma for 100


def test_top_is_found_from_its_gyroscope() -> None:
    """Of 40 noisy records of angular velocities at least 38 are fitted within 3 sigma."""
    guess = {"c": np.array([0.2, -0.1]), "b": 1.1}
    errors = np.array([_errors(nh.fit(_top, _top_record(s), guess), [0.3, -0.2, 1.0]) for s in range(40)])
    assert (np.abs(errors) < 3).all(axis=1).sum() >= 38


def test_exact_record_is_fitted_exactly() -> None:
    """Without noise the body, the start and the orbit are recovered to rounding, from other numbers far away."""
    orbit = nh.simulate(SLEIGH, restricted_velocity=(1.0, 0.5), configuration=nh.SE(2).exp([0.7, 1.0, 2.0]), steps=60)
    record = {"t": orbit.time, "x": orbit.position[:, 0], "y": orbit.position[:, 1], "theta": orbit.heading}
    found = nh.fit(_sleigh, record, {"inertia": 2.0, "a": 0.9})
    np.testing.assert_allclose([*found.parameters.values()], [0.7, 0.4], rtol=1e-10)
    np.testing.assert_allclose(found.orbit.configuration, orbit.configuration, atol=1e-10)


def _mixed_record(seed: int, every: dict[str, int], noise: dict[str, float]) -> dict[str, np.ndarray]:
    """Return a record of the sleigh with kinds at rates of their own: one number in `every` of each kind is there."""
    orbit, rng = nh.simulate(SLEIGH, restricted_velocity=(1.0, 0.5), steps=60), np.random.default_rng(seed)
    columns = {"x": orbit.position[:, 0], "y": orbit.position[:, 1]}
    columns |= {"theta": orbit.heading, "omega": orbit.body_velocity[:, 0]}
    kinds = dict(zip(columns, ("position", "position", "turn", "rate"), strict=True))
    record = {"t": orbit.time}
    for name, column in columns.items():
        measured = np.arange(61) % every[kinds[name]] == 0
        record[name] = np.where(measured, column + noise[kinds[name]] * rng.normal(size=61), np.nan)
    return record


def test_residuals_and_noise_are_those_of_their_kind() -> None:
    """Poses at every tenth sample beside a gyroscope: residuals are measured minus fitted numbers of their own column.

    Where a column has gaps, its residuals have them, and the noise of each kind lies near the true one.
    """
    noise = {"position": 0.01, "turn": 0.002, "rate": 0.05}
    record = _mixed_record(1, {"position": 10, "turn": 5, "rate": 1}, noise)
    found = nh.fit(_sleigh, record, GUESS)
    (residuals,), orbit = found.residuals, found.orbit
    np.testing.assert_allclose(residuals["turn"][:, 0], record["theta"] - orbit.heading, atol=1e-12)
    np.testing.assert_allclose(residuals["rate"][:, 0], record["omega"] - orbit.body_velocity[:, 0], atol=1e-12)
    places = np.stack([record["x"], record["y"]], axis=1)
    np.testing.assert_allclose(residuals["position"], places - orbit.position, atol=1e-12)
    for kind, level in found.noise.items():
        assert noise[kind] / 3 < level < 3 * noise[kind]


@pytest.mark.profile("routes", instead="test_top_is_found_from_its_gyroscope")
def test_trials_share_the_body_and_tables_may_have_any_form(tmp_path: Path) -> None:
    """Two trials tell more than one; a CSV file, a table of pandas and a dictionary are read alike."""
    pandas = pytest.importorskip("pandas")
    one, two = _sleigh_record(1), _sleigh_record(2)
    table = pandas.DataFrame(two)
    one_path = tmp_path / "one.csv"
    pandas.DataFrame(one).to_csv(one_path, index=False)
    guess = {"inertia": 1.0, "a": 0.3}
    both, alone = nh.fit(_sleigh, [one_path, table], guess), nh.fit(_sleigh, one, guess)
    assert len(both.orbit) == len(both.residuals) == 2
    assert (both.covariance.diagonal() < 0.7 * alone.covariance.diagonal()).all()
    np.testing.assert_allclose([*nh.fit(_sleigh, one_path, guess).parameters.values()], [*alone.parameters.values()])


def test_residuals_and_profiles_are_drawn() -> None:
    """A panel for each kind of number, shown in notebooks, residuals in the band for the most part; a profile's curves.

    Where the record is good, the profile is nearly the parabola, and its interval that of the covariance.
    """
    found = nh.fit(_sleigh, _sleigh_record(0), GUESS)
    assert len(repr(found)) < 500  # the residuals are not in it
    figure = found.plot()
    assert figure._repr_png_().startswith(b"\x89PNG")
    assert [len(axes.lines) for axes in figure.axes] == [3, 2]  # a line at zero each
    dots = figure.axes[1].lines[1].get_ydata()
    np.testing.assert_array_equal(dots, found.residuals[0]["turn"][:, 0])
    assert (np.abs(dots[np.isfinite(dots)]) < 2 * found.noise["turn"]).mean() > 0.9
    profile = found.profile("a")
    (low, high), (left, right) = profile.interval, found.intervals["a"]
    np.testing.assert_allclose([low, high], [left, right], atol=0.05 * (high - low))
    assert not np.array_equal([low, high], [left, right])
    assert [line.get_label() for line in profile.plot().axes[0].lines][1:] == ["linearized", "profile"]
    with pytest.raises(ValueError, match="be one of 'inertia', 'a'"):
        found.profile("mass")


@pytest.mark.profile("problems", instead="test_profile_of_a_line_is_its_parabola")
def test_profiles_hold_more_often_than_the_covariance() -> None:
    """Of 100 records that know friction by the inertia, profiles of 95 % hold the inertia at least 88 times.

    Intervals of the covariance hold it less often. Sides without bound come with their reason.
    """
    truth, guess = {"inertia": 0.7, "a": 0.4, "root": np.array([0.7, 0.6])}, {"inertia": 1.0, "a": 0.3}
    discrete, rows = nh.discretize(_rubbed(truth), 0.05), []
    for seed in range(100):
        found = nh.fit(_rubbed, _sleigh_record(seed, discrete), {**guess, "root": np.array([0.5, 0.5])})
        profile, (low, high) = found.profile("inertia"), found.intervals["inertia"]
        assert np.isinf(profile.interval[1]) == (profile.ends[1] == "unbounded")
        rows.append((profile.interval[0] <= 0.7 <= profile.interval[1], low <= 0.7 <= high))
    by_profile, by_covariance = np.sum(rows, axis=0)
    assert by_profile >= 88  # binomial: 3.2 sigma for 100
    assert by_covariance < by_profile


@pytest.mark.profile("routes", instead="test_top_is_found_from_its_gyroscope")
def test_poses_of_a_top_are_read_as_quaternions() -> None:
    """The CSV columns of an orbit in space, without noise, give the body back."""
    orbit = nh.simulate(TOP, restricted_velocity=(0.9, -0.7), configuration=nh.SO(3).exp([0.3, 0.2, 0.1]), steps=60)
    record = {"t": orbit.time, **dict(zip(("qw", "qx", "qy", "qz"), orbit.pose.T, strict=True))}
    found = nh.fit(_top, record, {"c": np.array([0.2, -0.1]), "b": 1.1})
    np.testing.assert_allclose(found.parameters["c"], [0.3, -0.2], rtol=1e-9)


def test_lists_of_traced_numbers_are_refused() -> None:
    """A nested list around a parameter is no array for NumPy: the message says how to make one."""

    def weight(b: Array) -> Array:
        return nh.SuslovTop([[b, 0.0, 0.1], [0.0, 1.0, 0.2], [0.1, 0.2, 0.9]]).mass_tensor.sum()

    with pytest.raises(ValueError, match=r"put them together with jax\.numpy\.array"):
        jax.grad(weight)(1.2)


def test_unit_of_mass_is_refused() -> None:
    """A free motion does not know its unit of mass: parameters that scale together are named."""

    def heavy(p: dict) -> nh.ChaplyginSleigh:
        return nh.ChaplyginSleigh(mass=p["mass"], inertia=p["inertia"], a=0.4)

    with pytest.raises(ValueError, match="Got none of mass, inertia alone"):
        nh.fit(heavy, _sleigh_record(0), {"mass": 1.1, "inertia": 0.8})


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"guess": {}}, "name the parameters"),
        ({"system_of": lambda _: 3}, "left-invariant"),
        ({"system_of": 3}, "be a function"),
        ({"measurements": {"x": np.zeros(3)}}, "have a column `t`"),
        ({"measurements": {"t": np.zeros(3)}}, "after the one before"),
        ({"measurements": {"t": np.arange(3.0), "z": np.zeros(3)}}, "columns of a motion in"),
        ({"measurements": {"t": np.array([0.0, 0.05, 0.13]), "omega": np.ones(3)}}, "whole number of time steps"),
        ({"measurements": {"t": np.array([0.0, 0.05, 0.1]), "omega": np.ones(3)}}, "more than the unknowns"),
        ({"measurements": []}, "at least one trial"),
        ({"measurements": 5}, "be tables of numbers"),
        ({"time_step": -1.0}, "be positive"),
    ],
)
def test_bad_arguments_are_refused(change: dict, words: str) -> None:
    """What cannot be fitted is named before any work."""
    with pytest.raises(ValueError, match=words):
        nh.fit(
            **{"system_of": _sleigh, "measurements": _sleigh_record(0), "guess": {"inertia": 1.0, "a": 0.3}} | change
        )
