"""The least squares under noise levels that follow from them, over parameters that stay in their bounds."""

from collections.abc import Callable
from typing import Any, NamedTuple, cast

import numpy as np
from scipy.optimize import least_squares

from nonholo.analysis.inverse._likelihood import Estimate, Problem, bent, estimate
from nonholo.analysis.inverse._profile import Minimum

_ROUNDS = 60  # of noise levels that follow from residuals, and residuals from noise levels
_MOST = 100  # places that are looked at in a round before the levels have settled
_COARSE, _FINE = 1e-6, 1e-12  # relative tolerances of the search, before the levels have settled and then
_SETTLED = 1e-4  # relative change of noise levels
_FAR = 10.0  # times its guess, where a parameter that the record does not tell has gone to infinity
_MISSED = 1e-3  # cosine between the residuals and what changes them, where a minimum has not been reached
_LOST = 4.0  # times the noise: residuals that are none
_PART = 0.01  # of the largest number: residuals below it may be those of a good model, without noise
_MEDIAN = 0.6744897501960817  # of the size of normal numbers
_EXACT = 1e-10  # of the largest measured number of a kind: less noise than that is rounding


class Ranges(NamedTuple):
    """Bounds of parameters, infinite where there are none; between 0 and infinity logarithms are searched."""

    low: np.ndarray
    high: np.ndarray

    @property
    def is_logarithmic(self) -> np.ndarray:
        """Which parameters are searched by their logarithm."""
        return (self.low == 0) & np.isposinf(self.high)


class Solution(NamedTuple):
    """The end of a search: a point, noise levels, the likelihood there, and whether both have settled."""

    point: np.ndarray
    noise: np.ndarray
    estimate: Estimate
    is_settled: bool


class Search(NamedTuple):
    """The problem of a search.

    Attributes:
        problem: Residuals with derivatives.
        ranges: Bounds of the parameters.
        system_at: The body at a point, a ValueError where there is none: the search never leaves the bodies.
        loss: Of residuals in units of their noise.
        levels: The noise levels that are given, NaN where they are estimated.
    """

    problem: Problem
    ranges: Ranges
    system_at: Callable[[np.ndarray], Any]
    loss: str
    levels: np.ndarray

    def run(self, point: np.ndarray) -> Solution:
        """Return the best point, and the noise levels of the kinds, each from the other until both have settled."""
        is_known, kinds = np.isfinite(self.levels), self.problem.kinds
        least = [_EXACT * np.abs(kinds[kind][..., :3][there]).max() for kind, there in self.problem.there.items()]
        noise, tolerance = np.where(is_known, self.levels, 1.0), _COARSE
        for _ in range(_ROUNDS):
            point = self.least(point, noise, tolerance)
            now = estimate(self.problem, point, noise, self.loss)
            before, noise = (
                noise,
                np.where(is_known, self.levels, np.maximum(now.levels, [x or _EXACT for x in least])),
            )
            is_settled = np.abs(noise / before - 1).max() < _SETTLED
            if is_settled and tolerance == _FINE:
                return Solution(point, noise, now, now.cosine < _MISSED or bool((noise <= least).all()))
            tolerance = _FINE if is_settled else _COARSE
        return Solution(point, noise, now, False)

    def least(self, point: np.ndarray, noise: np.ndarray, tolerance: float) -> np.ndarray:
        """Return the point where the loss is least under noise levels."""
        scale, (low, high), is_log = noise[self.problem.kind_of], self.ranges, self.ranges.is_logarithmic
        starts = np.zeros(len(point) - self.problem.count)
        is_log = np.concatenate([is_log, starts > 0])
        low, high = np.concatenate([low, starts - np.inf]), np.concatenate([high, starts + np.inf])

        def rows(x: np.ndarray) -> np.ndarray:
            here = np.where(is_log, np.exp(x), x)
            return self.rows(here, scale) if self.exists(here) else np.full(len(scale), np.inf)  # not a step to take

        def slope(x: np.ndarray) -> np.ndarray:
            growth = np.exp(np.where(is_log, x, 0.0))
            return self.slope(np.where(is_log, growth, x), scale) * growth

        with np.errstate(all="ignore"):  # far from a minimum
            result = least_squares(
                rows,
                np.where(is_log, np.log(point), point),
                cast(Any, slope),
                (np.where(is_log, -np.inf, low), high),
                x_scale="jac",
                xtol=tolerance,
                ftol=tolerance,
                gtol=tolerance,
                max_nfev=_MOST if tolerance == _COARSE else None,
            )
            return np.where(is_log, np.exp(result.x), result.x)

    def exists(self, point: np.ndarray) -> bool:
        """Return whether there is a body at a point."""
        try:
            self.system_at(point)
        except ValueError:
            return False
        return True

    def rows(self, point: np.ndarray, scale: np.ndarray) -> np.ndarray:
        """Return rows whose sum of squares is the loss."""
        return bent(self.problem.rows(point) / scale, self.loss).rows

    def slope(self, point: np.ndarray, scale: np.ndarray) -> np.ndarray:
        """Return their derivatives."""
        return self.problem.slope(point) * (bent(self.problem.rows(point) / scale, self.loss).slope / scale)[:, None]

    def minimum(self, solution: Solution, *widths: np.ndarray) -> Minimum:
        """Return what profiles need of the best point, with degrees of freedom, errors, and how they grow."""
        kind_of, P, (low, high) = self.problem.kind_of, self.problem.count, self.ranges
        scale, units = solution.noise[kind_of], solution.estimate.units[kind_of]
        return Minimum(
            lambda x: self.rows(x, scale) * units,
            lambda x: self.slope(x, scale) * units[:, None],
            lambda x: bool(((low < x[:P]) & (x[:P] < high)).all()) and self.exists(x),
            solution.point,
            *widths,
        )


def outcome_of(search: Search, solution: Solution, guess: np.ndarray, errors: np.ndarray) -> str:
    """Return in a word what became of a search: see `Fit.outcome`."""
    problem, values = search.problem, solution.point[: search.problem.count]
    far = (np.abs(values) > _FAR * np.abs(guess)) & (guess != 0) & (errors > 100 * np.abs(values))
    if far.any() or any(_is_lost(search, solution, kind) for kind in problem.there):
        return "lost"
    return "converged" if solution.is_settled else "not_converged"


def _is_lost(search: Search, solution: Solution, kind: str) -> bool:
    """Return whether residuals of a kind are many times the noise, which is given or that from sample to sample."""
    there, rows = search.problem.there[kind], search.problem.at(solution.point)[kind][0]
    columns = [rows[t, there[t, :, c], c] for t in range(len(rows)) for c in range(rows.shape[2])]
    typical, step = (
        float(np.median(np.abs(np.concatenate(parts)))) / _MEDIAN
        for parts in (columns, [np.diff(column) / np.sqrt(2) for column in columns])
    )
    level = float(search.levels[list(search.problem.there).index(kind)])
    if np.isfinite(level):
        return typical > _LOST * level
    most = 1.0 if kind == "turn" else float(np.abs(search.problem.kinds[kind][there]).max())
    return (typical > _LOST * step and typical > _PART * most) or (kind == "turn" and typical > most)
