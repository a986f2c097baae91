"""Noise levels, errors and profiles of least squares: lines through two kinds of numbers, beside their definitions."""

import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy import stats
from scipy.optimize import minimize, root_scalar

from nonholo.analysis.inverse import Fit
from nonholo.analysis.inverse._likelihood import Problem, Search, Solution, bent
from nonholo.analysis.inverse._profile import Minimum, least_squares_at, profile_of

FREE = np.full(2, -np.inf), np.full(2, np.inf)


def _search(y: np.ndarray, few: int, reference: tuple[float, ...], loss: str = "linear") -> tuple[Search, np.ndarray]:
    """Return the fit of a + b t to numbers of which the first few are turns, the rest rates, and its columns."""
    columns = np.stack([np.ones(len(y)), np.linspace(0.0, 1.0, len(y))], axis=1)
    parts = {"turn": slice(0, few), "rate": slice(few, len(y))}
    parts = {kind: part for kind, part in parts.items() if len(y[part])}
    rows = len(y)

    def missed(numbers: np.ndarray, _starts: object, _poses: object, kinds: dict) -> dict:
        none = np.zeros((1, rows, 1, 0))
        result = {
            kind: (kinds[kind] - (columns @ numbers)[None, :, None], -columns[None, :, None], none) for kind in kinds
        }
        return dict(sorted(result.items()))  # as JAX does

    kinds = {kind: np.full((1, rows, 1), np.nan) for kind in parts}
    for kind, part in parts.items():
        kinds[kind][0, part, 0] = y[part]
    problem = Problem(missed, np.zeros((1, 3, 3)), kinds, 2, (1, 0))
    return Search(problem, FREE, lambda _: None, loss, np.array(reference)), columns


def _run(y: np.ndarray, few: int, reference: tuple[float, ...]) -> tuple[Solution, np.ndarray]:
    search, columns = _search(y, few, reference)
    return search.run(np.zeros(2)), columns


def test_a_single_number_of_a_kind_has_no_steps() -> None:
    """One turn of known noise beside forty rates: a fit converges, without a warning of what is not there."""
    search, _ = _search(1.0 + np.random.default_rng(5).normal(scale=0.02, size=41), 1, (0.02, np.nan))
    assert search.outcome_of(search.run(np.zeros(2)), np.ones(2), np.full(2, 0.1)) == "converged"


@pytest.mark.parametrize("guess", [4.0, 5.5, 7.5, 10.0])
def test_swings_out_of_step_are_found(guess: float) -> None:
    """Sixteen swings of a frequency 2 pi that is far from the guess are fitted to their noise."""
    time = np.linspace(0.0, 16.0, 321)
    y = np.sin(2 * np.pi * time) + np.random.default_rng(1).normal(scale=1e-3, size=321)

    def missed(numbers: np.ndarray, _starts: object, _poses: object, kinds: dict) -> dict:
        (w, a), none = numbers, np.zeros((1, len(time), 1, 0))
        slope = -np.stack([a * time * np.cos(w * time), np.sin(w * time)], axis=-1)
        return {"rate": (kinds["rate"] - a * np.sin(w * time)[None, :, None], slope[None, :, None], none)}

    problem = Problem(missed, np.zeros((1, 3, 3)), {"rate": y[None, :, None]}, 2, (1, 0))
    result = Search(problem, FREE, lambda _: None, "linear", np.array([np.nan])).run(np.array([guess, 1.0]))
    np.testing.assert_allclose(result.point, [2 * np.pi, 1.0], atol=2e-4)
    np.testing.assert_allclose(result.noise, 1e-3, rtol=0.1)


def test_levels_have_the_largest_restricted_likelihood() -> None:
    """Seven numbers of one kind and forty of another: levels are where the restricted likelihood is largest."""
    rng, few = np.random.default_rng(5), 7
    y = 1.0 + rng.normal(size=47) * np.where(np.arange(47) < few, 0.02, 0.3)
    result, columns = _run(y, few, (np.nan, np.nan))

    def lack(logarithms: np.ndarray) -> float:
        w = np.repeat(np.exp(-2 * logarithms), [few, 47 - few])
        information = columns.T @ (w[:, None] * columns)
        rest = y - columns @ np.linalg.solve(information, columns.T @ (w * y))
        return float(-np.log(w).sum() + np.linalg.slogdet(information)[1] + w @ rest**2) / 2

    best = minimize(lack, np.log([0.02, 0.3]), method="Nelder-Mead", options={"xatol": 1e-7, "fatol": 1e-12})
    np.testing.assert_allclose(result.noise, np.exp(best.x), rtol=1e-3)  # levels settle to 1e-4
    assert result.is_settled


def test_errors_of_one_kind_are_those_of_the_usual_line() -> None:
    """Of one kind covariance and degrees of freedom are those of linregress of scipy: nothing is added twice."""
    y = 0.5 * np.linspace(0.0, 1.0, 12) + np.random.default_rng(2).normal(size=12)
    result, columns = _run(y, 0, (np.nan,))
    covariance, plain, degrees = result.estimate.covariance(np.array([True]))
    line = stats.linregress(columns[:, 1], y)
    np.testing.assert_allclose(np.sqrt(covariance.diagonal()), [line.intercept_stderr, line.stderr], rtol=1e-6)
    np.testing.assert_allclose(covariance, plain, rtol=1e-9)
    np.testing.assert_allclose(degrees, 10.0)


def test_known_noise_is_as_sure_as_normal() -> None:
    """With all levels given errors are those of weighted squares, with infinite degrees of freedom."""
    y = np.random.default_rng(3).normal(size=20)
    result, columns = _run(y, 7, (0.1, 2.0))
    covariance, _, degrees = result.estimate.covariance(np.array([False, False]))
    w = np.repeat([100.0, 0.25], [7, 13])
    np.testing.assert_allclose(covariance, np.linalg.inv(columns.T @ (w[:, None] * columns)), rtol=1e-9)
    assert (degrees == np.inf).all()


@pytest.mark.profile("problems", instead="test_levels_have_the_largest_restricted_likelihood")
def test_few_numbers_of_a_kind_have_few_degrees() -> None:
    """Of 2,000 lines with five numbers of the sure kind Student's intervals hold 95 %, normal ones fewer.

    The standard deviation of the share is 0.5 %: 1.6 % are three.
    """
    rng, truth = np.random.default_rng(11), np.array([1.0, 0.5])
    coverage = []
    for _ in range(2000):
        noise = np.where(np.arange(25) < 5, 0.05, 0.3) * rng.normal(size=25)
        search, _ = _search(1.0 + 0.5 * np.linspace(0.0, 1.0, 25) + noise, 5, (np.nan, np.nan))
        result = search.run(truth)
        covariance, _, degrees = result.estimate.covariance(np.array([True, True]))
        off = np.abs(result.point - truth) / np.sqrt(covariance.diagonal())
        coverage.append([off < stats.t.ppf(0.975, degrees), off < stats.norm.ppf(0.975)])
    by_student, by_normal = np.mean(coverage, axis=0)
    np.testing.assert_allclose(by_student, 0.95, atol=0.016)
    assert (by_normal < by_student).all()
    assert by_normal[0] < 0.93


@pytest.mark.parametrize("loss", ["linear", "soft_l1"])
def test_bent_rows_have_the_loss_and_its_derivatives(loss: str) -> None:
    """Squares of bent rows are the loss as scipy has it; all three derivatives are those of differences."""
    z = np.linspace(-5.0, 5.0, 21) + 0.01
    value = z**2 if loss == "linear" else 2 * (np.sqrt(1 + z**2) - 1)
    at, step = bent(z, loss), 1e-5
    np.testing.assert_allclose(at.rows**2, value, rtol=1e-9)
    after, before = bent(z + step, loss), bent(z - step, loss)
    np.testing.assert_allclose(at.slope, (after.rows - before.rows) / (2 * step), rtol=1e-8)
    np.testing.assert_allclose(at.first, (after.rows**2 - before.rows**2) / (4 * step), rtol=1e-7)
    np.testing.assert_allclose(at.second, (after.first - before.first) / (2 * step), rtol=1e-7)


TIMES = np.linspace(0.2, 3.0, 15)
NOISE = 0.1 * np.random.default_rng(0).normal(size=15)


def _line(slope: float, exists: Callable[[np.ndarray], bool] = np.all) -> tuple[Minimum, np.ndarray]:
    """Return the least squares of a line, a + b t, in units of the noise estimated from it, and the data."""
    columns, y = np.stack([np.ones(15), TIMES], axis=1), 1.0 + slope * TIMES + NOISE
    point, (square,), _, _ = np.linalg.lstsq(columns, y)
    s = np.sqrt(square / 13)
    return Minimum(lambda p: (y - columns @ p) / s, lambda _: -columns / s, exists, point, 13), y


def _scaled(shape: Callable, slope: Callable, rate: float) -> tuple[Minimum, Callable[[float], float]]:
    """Return the least squares of c f(k t), numbers k and c, and in closed form their profile over k."""
    y = 2.0 * shape(rate * TIMES) + NOISE

    def square(k: float) -> float:
        f = shape(k * TIMES)
        return float(y @ y - (f @ y) ** 2 / (f @ f))

    ks = np.geomspace(rate / 5, 5 * rate, 4001)
    k = ks[np.argmin([square(k) for k in ks])]
    k = float(root_scalar(lambda k: square(k * 1.0001) - square(k / 1.0001), bracket=(k * 0.99, k * 1.01)).root)
    f = shape(k * TIMES)
    s = np.sqrt(square(k) / 13)

    def derivatives(p: np.ndarray) -> np.ndarray:
        return -np.stack([p[1] * TIMES * slope(p[0] * TIMES), shape(p[0] * TIMES)], axis=1) / s

    point = np.array([k, f @ y / (f @ f)])
    minimum = Minimum(lambda p: (y - p[1] * shape(p[0] * TIMES)) / s, derivatives, np.all, point, 13)
    return minimum, lambda x: (square(x) - square(k)) / s**2


@pytest.mark.parametrize("exponent", [-40, 40])
def test_search_does_not_depend_on_the_units_of_numbers(exponent: int) -> None:
    """The size and the rate of a decay are found bit by bit alike in units that are powers of two."""
    t, units = np.linspace(0.0, 3.0, 7), 2.0 ** np.array([exponent, -exponent])

    def decay(x: np.ndarray) -> np.ndarray:
        return x[0] * np.exp(-x[1] * t)

    def slope(x: np.ndarray) -> np.ndarray:
        return np.exp(-x[1] * t)[:, None] * np.stack([np.ones(7), -x[0] * t], axis=1)

    def least(unit: np.ndarray) -> np.ndarray:
        rows, slopes = (lambda x: decay(x / unit) - decay(np.array([2.0, 0.7]))), (lambda x: slope(x / unit) / unit)
        return least_squares_at(np.array([0.3, 3.0]) * unit, rows, slopes, 1e-6, None) / unit

    np.testing.assert_array_equal(least(units), least(np.ones(2)))
    np.testing.assert_allclose(least(units), [2.0, 0.7], rtol=1e-6)


@pytest.mark.parametrize("level", [0.5, 0.95, 0.999])
def test_profile_of_a_line_is_its_parabola(level: float) -> None:
    """Of a linear model the interval is Student's, by the error of linregress of scipy, and the profile is straight."""
    minimum, y = _line(0.5)
    line: Any = stats.linregress(TIMES, y)
    profile = profile_of(minimum, 1, "b", level)
    half = stats.t.ppf((1 + level) / 2, 13) * line.stderr
    np.testing.assert_allclose(profile.interval, [line.slope - half, line.slope + half], rtol=1e-8)
    straight = (profile.values - line.slope) / line.stderr
    np.testing.assert_allclose(profile.statistic, straight, atol=1e-7)  # a root of rounding near the minimum
    assert profile.ends == ("level", "level")


def test_profile_of_a_decay_is_that_in_closed_form() -> None:
    """Of c exp(-k t) the ends over k solve the equation in which c is eliminated, and lie lopsided about k."""
    minimum, square = _scaled(lambda x: np.exp(-x), lambda x: -np.exp(-x), 1.5)
    profile = profile_of(minimum, 0, "k", 0.99)
    np.testing.assert_allclose([square(end) for end in profile.interval], profile.cut**2, rtol=1e-6)
    np.testing.assert_allclose([square(k) for k in profile.values], profile.statistic**2, atol=1e-6)
    below, above = np.abs(np.array(profile.interval) - profile.value)
    assert above > 1.01 * below


def test_side_that_levels_off_is_without_bound() -> None:
    """A saturation that is over bounds its rate from below alone: above, the statistic stays below the level."""
    minimum, square = _scaled(lambda x: 1 - np.exp(-x), lambda x: np.exp(-x), 12.0)
    profile = profile_of(minimum, 0, "k", 0.95)
    assert profile.interval[1] == np.inf
    assert profile.ends == ("level", "unbounded")
    np.testing.assert_allclose(square(profile.interval[0]), profile.cut**2, rtol=1e-6)
    np.testing.assert_allclose(profile.statistic[-1] ** 2, square(1e9), rtol=1e-6)


def test_side_may_end_with_the_model() -> None:
    """A slope that must be positive is bounded by zero where the level lies beyond."""
    minimum, _ = _line(0.1, lambda p: bool(p[1] > 0))
    profile = profile_of(minimum, 1, "b", 0.95)
    assert profile.ends == ("model", "level")
    assert 0 < profile.interval[0] < 1e-6


def test_fit_is_kept_without_its_functions() -> None:
    """What is pickled, of a lambda too, has all but the profile, which says so."""
    minimum, _ = _line(0.5)
    result = Fit({"a": 1.0, "b": 0.5}, np.eye(2), None, None, (), {}, "converged", np.full(2, 13.0), 13, minimum)
    result = pickle.loads(pickle.dumps(result))  # noqa: S301
    assert result.parameters == {"a": 1.0, "b": 0.5}
    with pytest.raises(ValueError, match="Fit again"):
        result.profile("b")


def test_better_minimum_is_said() -> None:
    """A fit that is not at its minimum is refused, with a value where the squares are less."""
    minimum, _ = _line(0.5)
    with pytest.raises(ValueError, match="less at b = "):
        profile_of(minimum._replace(point=minimum.point - [0.0, 0.2]), 1, "b", 0.95)


@pytest.mark.parametrize("level", [0.0, 1.0, 95, float("nan"), "much"])
def test_levels_are_probabilities(level: object) -> None:
    """What is no probability is refused."""
    with pytest.raises(ValueError, match=r"profile\(level=\.\.\.\)"):
        profile_of(_line(0.5)[0], 1, "b", level)
