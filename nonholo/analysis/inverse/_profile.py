r"""The likelihood profile of one fitted number: how well the record can be met without its best value."""

import dataclasses
import importlib
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import least_squares, root_scalar
from scipy.special import stdtrit

from nonholo.base.checks import error, number
from nonholo.base.results import result
from nonholo.base.types import Float

_PARTS = 8  # steps in which the level is reached where the profile is a parabola
_FAR = 1e4, 10.0  # times the smaller and the larger of a number and its error, where it has been followed enough
_EDGE = 1e-6  # times the smaller of them, by which the end of the model is known
_SAME = 0.01  # of the squares, in units of the noise: less than that is no better minimum
_ROUNDS = 50  # of a fit from the one before; along a flat ridge it may stop short, where the squares hardly change
_TINY = np.finfo(np.float64).tiny


class Minimum(NamedTuple):
    """A least sum of squares.

    Attributes:
        rows: Residuals at a point, in units of their noise.
        slope: Their derivatives, (rows, numbers).
        has_body: Whether there is a model at a point.
        point: Where the sum is least.
        free: Degrees of freedom of the noise, one number or one for each.
        errors: Standard deviations of the numbers for known noise; None for those of the slope.
        wider: The factor by which they grow as the noise is not known.
    """

    rows: Callable[[np.ndarray], np.ndarray]
    slope: Callable[[np.ndarray], np.ndarray]
    has_body: Callable[[np.ndarray], bool]
    point: Float[np.ndarray, "P"]
    free: Any
    errors: Any = None
    wider: Any = 1.0


@result
class Profile:
    r"""The likelihood profile of a fitted number: $\tau$ over its values, all others fitted again at each.

    Attributes:
        name: Of the number.
        value: The fitted one.
        error: Its standard deviation in the linearized model, in which $\tau$ is (values - value) / error.
        level: The probability of the interval, if the noise is normal and the model right.
        cut: The value of $|\tau|$ at its ends, a quantile of Student's distribution.
        interval: The least and the largest number within the level, infinite where there is none.
        ends: The bound on each side. "level": the profile crosses the level there. "unbounded": it levels off below,
            seen up to ten thousand times the number. "model": there is no motion, or no body, beyond, and
            the profile has not reached the level.
        values: Numbers at which the others were fitted, in order, (K,).
        statistic: $\tau$ at them, negative below the fitted number.
    """

    name: str
    value: float
    error: float
    level: float
    cut: float
    interval: tuple[float, float]
    ends: tuple[str, str]
    values: Float[np.ndarray, "K"] = dataclasses.field(repr=False)
    statistic: Float[np.ndarray, "K"] = dataclasses.field(repr=False)

    def plot(self) -> Any:
        """Draw the profile beside the parabola of the linearized model; return the matplotlib figure."""
        return importlib.import_module("nonholo.plot.motion.fit").fit_profile(self)


class _Place(NamedTuple):
    """A value of the number, the point that is best there, and the positive statistic with its slope."""

    value: float
    point: np.ndarray
    tau: float
    rate: float


def profile_of(minimum: Minimum, at: int, name: str, level: Any) -> Profile:
    """Return the profile of one number of a least sum of squares."""
    level = float(number("Fit.profile(level=...)", level, "Pass a probability."))
    if not 0 < level < 1:
        raise error("Fit.profile(level=...)", "be between 0 and 1", f"{level:g}", "Pass a probability.")
    quantile = stdtrit(minimum.free, (1 + level) / 2) * minimum.wider
    cut, value = float(quantile[at] if np.ndim(quantile) else quantile), float(minimum.point[at])
    rate = float(np.linalg.norm(_along(minimum.slope(minimum.point), at)[0]))
    begin = _Place(value, minimum.point, 0.0, rate)
    search = _Search(minimum, at, name)
    (before, low, why_low), (after, high, why_high) = (search.side(begin, sign * cut) for sign in (-1, 1))
    places = [*before[::-1], begin, *after]
    values, tau = np.array([(x.value, x.tau) for x in places]).T
    tau[: len(before)] *= -1
    width = 1 / rate if minimum.errors is None else float(minimum.errors[at])
    return Profile(name, value, width, level, cut, (low, high), (why_low, why_high), values, tau)


class _Search(NamedTuple):
    """The settings of a search for the profile of one number."""

    minimum: Minimum
    at: int
    name: str

    def side(self, begin: _Place, cut: float) -> tuple[list[_Place], float, str]:
        """Follow the profile to the side of a signed cut, until it is reached or nothing is there.

        Return places outwards, the end of the interval, and what bounds it.
        """
        sign, cut, here, places = np.sign(cut), abs(cut), begin, []
        small, large = sorted((abs(begin.value) or 1 / begin.rate, 1 / begin.rate))
        step, growth = min(cut / begin.rate, small) / _PARTS, 2.0
        while step > _EDGE * small:
            there = self.best(here, here.value + sign * step)
            if there is None:
                step, growth = step / 2, 1.0
                continue
            places.append(there)
            if there.tau >= cut:
                return places, self.crossing((here, there), cut), "level"
            if abs(there.value - begin.value) > _FAR[0] * small + _FAR[1] * large:
                return places, float(sign * np.inf), "unbounded"
            step = float(np.clip(cut / _PARTS / max(there.rate, _TINY), step / 2, growth * step))
            here, growth = there, 2.0
        return places, float(here.value), "model"

    def crossing(self, between: tuple[_Place, _Place], cut: float) -> float:
        """Return where the statistic of a profile has a value."""
        here, there = between

        def above(value: float) -> float:
            place = self.best(here, value)
            return (2 * cut if place is None else place.tau) - cut  # none: as outside

        bracket = here.value, there.value
        return float(root_scalar(above, bracket=bracket, xtol=1e-9 * abs(bracket[1] - bracket[0]), rtol=1e-12).root)

    def best(self, near: _Place, value: float) -> _Place | None:
        """Return the place of a value, from one nearby; none where there is no model."""
        minimum, at = self.minimum, self.at
        slope, others = minimum.slope(near.point), np.arange(len(near.point)) != at
        step = value - near.value
        starts = [near.point + step * _along(slope, at)[1], near.point + step * ~others]  # along, or plainly
        starts = [x for x in starts if self.has_motion(x)]
        if not starts:
            return None
        point = min(starts, key=lambda x: float(np.sum(minimum.rows(x) ** 2)))

        def whole(x: np.ndarray) -> np.ndarray:
            return np.insert(x, at, value)

        functions = (lambda x: minimum.rows(whole(x))), (lambda x: minimum.slope(whole(x))[:, others])
        point = whole(least_squares_at(point[others], *functions, 1e-10, _ROUNDS))
        if not self.has_motion(point):
            return None
        rows = minimum.rows(point)
        square = float(rows @ rows - np.sum(minimum.rows(minimum.point) ** 2))
        if square < -_SAME:
            got = f"less at {self.name} = {value:.6g}"
            raise error("Fit.profile(...)", "begin at the least sum of squares", got, "Fit again from a guess near it.")
        tau = max(square, 0.0) ** 0.5
        rate = abs(float(rows @ minimum.slope(point)[:, at])) / tau if square > _SAME else near.rate
        return _Place(value, point, tau, rate)

    def has_motion(self, point: np.ndarray) -> bool:
        """Return whether there is a motion at a point."""
        return self.minimum.has_body(point) and bool(np.isfinite(self.minimum.rows(point)).all())


def least_squares_at(
    begin: np.ndarray, rows: Any, slope: Any, tolerance: float, most: int | None, ends: Any = (-np.inf, np.inf)
) -> np.ndarray:
    """Return where a sum of squares is least, from a begin on, by the derivatives of its rows.

    Numbers are searched in units of their errors, in which SciPy's tolerances of steps and gradients make sense.
    """
    lengths = np.linalg.norm(slope(begin), axis=0)
    unit = np.exp2(-np.round(np.log2(np.where(np.isfinite(lengths) & (lengths > 0), lengths, 1.0))))  # no rounding
    options: Any = {"x_scale": "jac", "max_nfev": most, **dict.fromkeys(("ftol", "xtol", "gtol"), tolerance)}
    options |= {"jac": lambda x: slope(x * unit) * unit, "bounds": tuple(end / unit for end in ends)}
    return least_squares(lambda x: rows(x * unit), begin / unit, **options).x * unit


def _along(slope: np.ndarray, at: int) -> tuple[np.ndarray, np.ndarray]:
    """Return how rows change with one number if the others follow to first order, and how these do."""
    sizes = np.linalg.norm(slope, axis=0)
    rest = np.delete(slope / np.where(sizes > 0, sizes, 1.0), at, axis=1)
    others = np.linalg.lstsq(rest, -slope[:, at])[0] / np.delete(np.where(sizes > 0, sizes, 1.0), at)
    follow = np.insert(others, at, 1.0)
    return slope @ follow, follow
