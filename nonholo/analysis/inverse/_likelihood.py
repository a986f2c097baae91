"""Residuals with derivatives as least squares take them; noise levels and covariances by restricted likelihood."""

import dataclasses
import functools
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from nonholo.analysis.inverse._profile import Minimum, least_squares_at
from nonholo.base.types import Array, Float

Shapes = tuple[tuple[str, tuple[int, ...]], ...]


def by_name(shapes: Shapes, numbers: Array) -> dict[str, Array]:
    """Return the parameters in a vector by name, traced ones too."""
    cuts = np.cumsum([0, *(int(np.prod(shape)) for _, shape in shapes)])
    return {name: numbers[i:j].reshape(shape)[()] for (name, shape), i, j in zip(shapes, cuts, cuts[1:], strict=False)}


@dataclasses.dataclass(eq=False)
class Problem:
    """Residuals and derivatives at a point: parameters, then the start of each trial.

    Attributes:
        residuals: Residuals with derivatives, of parameters, starts, poses and kinds.
        poses: Where the changes of pose in the starts begin.
        kinds: The kinds of measurements.
        count: How many parameters there are.
        shape: Of the starts: trials, numbers of each.
        last: The last point with its residuals.
    """

    residuals: Callable[..., Any]
    poses: Float[np.ndarray, "T N N"]
    kinds: dict[str, Float[np.ndarray, "T K _"]]
    count: int
    shape: tuple[int, int]
    last: tuple[np.ndarray, Any] | None = None

    @functools.cached_property
    def there(self) -> dict[str, np.ndarray]:
        """Which residuals belong to measured numbers, of the kinds that have some."""
        masks = {kind: np.isfinite(rows) for kind, rows in self.kinds.items()}
        return {k: x[..., :3] if k == "turn" else x for k, x in masks.items() if x.any()}

    def columns(self, kind: str, rows: Float[np.ndarray, "T K _"]) -> list[np.ndarray]:
        """Return the numbers of each trial and column where a kind is measured, if there are any."""
        there = self.there[kind]
        columns = [rows[t, there[t, :, c], c] for t in range(len(there)) for c in range(there.shape[2])]
        return [each for each in columns if len(each)]

    def at(self, point: np.ndarray) -> dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Return by kind the residuals and both derivatives, computed once for each point."""
        if self.last is None or not np.array_equal(self.last[0], point):
            starts = point[self.count :].reshape(self.shape)
            rows = {kind: self.kinds[kind] for kind in self.there}
            self.last = point.copy(), self.residuals(point[: self.count], starts, self.poses, rows)
        return self.last[1]

    def rows(self, point: np.ndarray) -> np.ndarray:
        """Return the residuals of measured numbers, kind after kind."""
        by_kind = self.at(point)
        return np.concatenate([by_kind[kind][0][there] for kind, there in self.there.items()])

    def slope(self, point: np.ndarray) -> np.ndarray:
        """Return their derivatives: a trial depends on its own start alone."""
        by_kind, parts, (T, width) = self.at(point), [], self.shape
        is_own = np.eye(T, dtype=bool)[:, None, None, :, None]
        for kind, there in self.there.items():
            _, by_numbers, by_starts = by_kind[kind]
            own = np.where(is_own, by_starts[..., None, :], 0.0).reshape(*there.shape, T * width)
            parts.append(np.concatenate([by_numbers, own], axis=-1)[there])
        return np.concatenate(parts)

    def beginning(self, share: float) -> "Problem":
        """Return the problem of the first part of the record."""
        count = next(iter(self.kinds.values())).shape[1]
        is_early = np.arange(count)[:, None] < share * count
        kinds = {kind: np.where(is_early, rows, np.nan) for kind, rows in self.kinds.items()}
        return dataclasses.replace(self, kinds=kinds, last=None)

    @functools.cached_property
    def kind_of(self) -> np.ndarray:
        """The kind of each measured number, as a position in `there`."""
        return np.repeat(np.arange(len(self.there)), [np.count_nonzero(x) for x in self.there.values()])


LOSSES = "linear", "soft_l1"
_NORMAL = {"linear": 1.0, "soft_l1": 0.34432045758120155}
"""Mean square of half the derivative of the loss over normal noise: 1 - sqrt(pi e / 2) erfc(1 / sqrt(2))."""


class Bent(NamedTuple):
    """Rows whose sum of squares is the loss, with their derivative, and half the first and second one of the loss."""

    rows: np.ndarray
    slope: np.ndarray
    first: np.ndarray
    second: np.ndarray


def bent(rows: np.ndarray, loss: str) -> Bent:
    r"""Return residuals in units of the noise, bent by the loss: $z^2$, or $2\sqrt{1 + z^2} - 2$ for "soft_l1"."""
    if loss == "linear":
        return Bent(rows, np.ones_like(rows), rows, np.ones_like(rows))
    h = np.hypot(1.0, rows)
    s = np.sqrt(2 / (1 + h))
    return Bent(rows * s, 1 / (h * s), rows / h, h**-3)


class Estimate(NamedTuple):
    r"""The likelihood at a point, from residuals and their derivatives.

    Attributes:
        levels: The noise levels that follow from the present ones, $\sigma_k^2 = \sum r^2/(n_k - \mathrm{tr} G_k)$.
        counts: Numbers of each kind, $n_k$.
        shares: $G_k = Q_k^TQ_k$, over the rows of a kind, where $J = QR$ in units of the noise; their sum is 1.
        lengths: Of the columns of J.
        triangle: R, of columns of length 1.
        units: In which the growth of the loss is distributed as that of squares is, for each kind.
        cosine: That between the residuals and the nearest direction in which they change: 0 at a minimum. Where the
            residuals are smaller than the noise in sum, the way to the minimum in units of the errors.
    """

    levels: np.ndarray
    counts: np.ndarray
    shares: np.ndarray
    lengths: np.ndarray
    triangle: np.ndarray
    units: np.ndarray
    cosine: float

    @property
    def free(self) -> np.ndarray:
        """Numbers of each kind less those that the fit uses up, the trace of the hat matrix over the kind."""
        return self.counts - np.trace(self.shares, axis1=1, axis2=2)

    def covariance(self, is_estimated: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        r"""Return the covariance of all numbers by Kenward and Roger, that for known noise, and degrees of freedom.

        Levels that are estimated have the information $I_{kl} = \tfrac12(\delta_{kl}(n_k - 2\,\mathrm{tr} G_k) +
        \mathrm{tr} G_kG_l)$ of their logarithms; W is its inverse. The covariance for known noise,
        $C = R^{-1}R^{-T}$, becomes $R^{-1}(1 + 2\sum_k W_{kk}G_k - 2\sum_{kl}W_{kl}G_kG_l)R^{-T}$, and by Satterthwaite
        a number with the shares $d_k$ of its variance v in the kinds has $2v^2/d^TWd$ degrees of freedom.
        """
        G = self.shares
        information = (np.einsum("kab,lab->kl", G, G) + np.diag(self.free - np.trace(G, axis1=1, axis2=2))) / 2
        W, at = np.zeros_like(information), np.ix_(is_estimated, is_estimated)
        W[at] = np.linalg.inv(information[at])
        wider = np.einsum("kk,kab->ab", W, G) - np.einsum("kl,kab,lbc->ac", W, G, G)
        root = np.linalg.inv(self.triangle) / self.lengths[:, None]
        shares = np.einsum("ja,kab,jb->jk", root, G, root)
        with np.errstate(divide="ignore"):
            degrees = 2 * np.sum(root**2, axis=1) ** 2 / np.einsum("jk,kl,jl->j", shares, W, shares)
        return root @ (np.eye(len(root)) + 2 * wider) @ root.T, root @ root.T, degrees


def estimate(problem: Problem, point: np.ndarray, noise: np.ndarray, loss: str) -> Estimate:
    """Return what residuals and derivatives at a point tell; under the robust loss rows count by their efficiency."""
    kind_of, tiny = problem.kind_of, np.finfo(np.float64).tiny
    at = bent(problem.rows(point) / noise[kind_of], loss)
    counts = np.bincount(kind_of)
    efficiency = np.bincount(kind_of, at.second) / counts / np.sqrt(_NORMAL[loss])
    J = problem.slope(point) * (efficiency / noise)[kind_of][:, None]
    lengths = np.linalg.norm(J, axis=0)
    Q, R = np.linalg.qr(J / np.where(lengths > 0, lengths, 1.0))
    shares = np.array([Q[kind_of == k].T @ Q[kind_of == k] for k in range(len(noise))])
    free = np.maximum(counts - np.trace(shares, axis1=1, axis2=2), tiny)
    levels = noise * np.sqrt(np.bincount(kind_of, at.first**2) / _NORMAL[loss] / free)
    left = at.first / efficiency[kind_of]
    units = np.sqrt(efficiency / np.sqrt(_NORMAL[loss]))
    cosine = float(np.linalg.norm(Q.T @ left) / max(np.linalg.norm(left), 1.0))
    return Estimate(levels, counts, shares, lengths, R, units, cosine)


_ROUNDS = 60  # of noise levels that follow from residuals, and residuals from noise levels
_MOST = 100  # places that are looked at in a round before the levels have settled
_COARSE, _FINE = 1e-6, 1e-12  # relative tolerances of the search, before the levels have settled and then
_SETTLED = 1e-4  # relative change of noise levels
_FAR = 10.0  # times its guess, where a parameter that the record does not tell has gone to infinity
_MISSED = 1e-3  # cosine between the residuals and what changes them, where a minimum has not been reached
_DOUBTFUL, _LOST = 2.0, 4.0  # times the noise: residuals that may be none, and that are none
_PART = 0.01  # of the largest number: residuals below it may be those of a good model, without noise
_MEDIAN = 0.6744897501960817  # of the size of normal numbers
_PARTS = 1 / 64, 1 / 32, 1 / 16, 1 / 8, 1 / 4, 1 / 2  # of the record, over which a lost search begins again
_EXACT = 1e-10  # of the largest measured number of a kind: less noise than that is rounding


Ranges = tuple[np.ndarray, np.ndarray]
"""Bounds of parameters, infinite where there are none; between 0 and infinity logarithms are searched."""


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
        """Return the best point with its noise levels; if residuals look like none, from those of parts of the record.

        Over a short time a model with other parameters has not got out of step with the motion.
        """
        solution = self.settle(point)
        if not self._misses(solution.point, _DOUBTFUL):
            return solution
        for problem in map(self.problem.beginning, _PARTS):
            if list(problem.there) == list(self.problem.there) and len(problem.kind_of) > len(point):
                part = self._replace(problem=problem)
                nearer = part.least(point, solution.noise, _COARSE)
                point = point if part._misses(nearer, _DOUBTFUL) else nearer
        again = self.settle(point) if np.isfinite(self.problem.rows(point)).all() else solution
        return solution if self._misses(again.point, _DOUBTFUL) else again

    def settle(self, point: np.ndarray) -> Solution:
        """Return the best point, and the noise levels of the kinds, each from the other until both have settled."""
        is_known, (least, spread) = np.isfinite(self.levels), self._extents()
        noise, tolerance = np.where(is_known, self.levels, np.maximum(spread, least)), _COARSE
        for _ in range(_ROUNDS):
            point = self.least(point, noise, tolerance)
            now = estimate(self.problem, point, noise, self.loss)
            before = noise
            noise = np.where(is_known, self.levels, np.maximum(now.levels, least))
            is_settled = np.abs(noise / before - 1).max() < _SETTLED
            if is_settled and tolerance == _FINE:
                return Solution(point, noise, now, now.cosine < _MISSED or bool((noise <= least).all()))
            tolerance = _FINE if is_settled else _COARSE
        return Solution(point, noise, now, False)

    def _extents(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the least noise of each kind, below which it is rounding, and the spread of what is measured."""
        columns = [self.problem.columns(kind, self.problem.kinds[kind]) for kind in self.problem.there]
        least = [_EXACT * np.abs(np.concatenate(each)).max() or _EXACT for each in columns]
        return np.array(least), np.array([np.concatenate([x - x.mean() for x in each]).std() for each in columns])

    def least(self, point: np.ndarray, noise: np.ndarray, tolerance: float) -> np.ndarray:
        """Return the point where the loss is least under noise levels."""
        scale, starts = noise[self.problem.kind_of], np.zeros(len(point) - self.problem.count)
        low, high = np.append(self.ranges[0], starts - np.inf), np.append(self.ranges[1], starts + np.inf)
        is_log = (low == 0) & np.isposinf(high)  # positive numbers

        def rows(x: np.ndarray) -> np.ndarray:
            here = np.where(is_log, np.exp(x), x)
            return self.rows(here, scale) if self.has_body(here) else np.full(len(scale), np.inf)  # not a step to take

        def slope(x: np.ndarray) -> np.ndarray:
            growth = np.exp(np.where(is_log, x, 0.0))
            return self.slope(np.where(is_log, growth, x), scale) * growth

        with np.errstate(all="ignore"):  # far from a minimum
            begin, ends = np.where(is_log, np.log(point), point), (np.where(is_log, -np.inf, low), high)
            x = least_squares_at(begin, rows, slope, tolerance, _MOST if tolerance == _COARSE else None, ends)
            return np.where(is_log, np.exp(x), x)

    def has_body(self, point: np.ndarray) -> bool:
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
            lambda x: bool(((low < x[:P]) & (x[:P] < high)).all()) and self.has_body(x),
            solution.point,
            *widths,
        )

    def outcome_of(self, solution: Solution, guess: np.ndarray, errors: np.ndarray) -> str:
        """Return in a word what became of a search: see `Fit.outcome`."""
        values = solution.point[: self.problem.count]
        far = (np.abs(values) > _FAR * np.abs(guess)) & (guess != 0) & (errors > 100 * np.abs(values))
        if far.any() or self._misses(solution.point, _LOST):
            return "lost"
        return "converged" if solution.is_settled else "not_converged"

    def _misses(self, point: np.ndarray, times: float) -> bool:
        """Return whether residuals of a kind are many times the noise, which is given or that from sample to sample."""
        return any(self._misses_kind(point, times, kind) for kind in self.problem.there)

    def _misses_kind(self, point: np.ndarray, times: float, kind: str) -> bool:
        there, columns = self.problem.there[kind], self.problem.columns(kind, self.problem.at(point)[kind][0])
        typical, step = _deviation(columns), _deviation([np.diff(column) / np.sqrt(2) for column in columns])
        level = float(self.levels[list(self.problem.there).index(kind)])
        if np.isfinite(level):
            return typical > times * level
        most = 1.0 if kind == "turn" else float(np.abs(self.problem.kinds[kind][there]).max())
        return (typical > times * step and typical > _PART * most) or (kind == "turn" and typical > most)


def _deviation(parts: list[np.ndarray]) -> float:
    """Return the deviation of normal numbers by their median size; infinity of none, such as steps of one sample."""
    sizes = np.abs(np.concatenate(parts))
    return float(np.median(sizes)) / _MEDIAN if len(sizes) else np.inf
