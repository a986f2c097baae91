"""Profiles of least squares whose profile is known: straight lines, models that are linear but for one number."""

import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy import stats
from scipy.optimize import root_scalar

from nonholo.analysis.inverse import Fit
from nonholo.analysis.inverse._profile import Minimum, profile_of

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
    found = Fit({"a": 1.0, "b": 0.5}, np.eye(2), None, None, (), {}, "converged", np.full(2, 13.0), 13, minimum)
    found = pickle.loads(pickle.dumps(found))  # noqa: S301
    assert found.parameters == {"a": 1.0, "b": 0.5}
    with pytest.raises(ValueError, match="Fit again"):
        found.profile("b")


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
