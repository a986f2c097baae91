"""The compiled runs of all bodies, one table for each kind of body."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from nonholo.kernels import _composition, _driver
from nonholo.kernels._composition import ComposedBody
from nonholo.kernels._scalar import Body, Rows
from nonholo.kernels.forced import ForcedBody
from nonholo.kernels.forced import run as forced_run
from nonholo.kernels.general import GeneralBody
from nonholo.kernels.general import run as general_run
from nonholo.kernels.secular import SecularBody
from nonholo.kernels.secular import run as secular_run

PlainBody = Body | GeneralBody | SecularBody
AnyBody = PlainBody | ComposedBody | ForcedBody


class Runs(NamedTuple):
    """The functions of a kind of body, each of which takes the body first.

    Attributes:
        sizes: Gives the numbers of momenta, chart coordinates and pose entries of a state.
        start: Gives the outcome of the first root and the state of a run, from scaled momenta and a pose.
        chart_of: Gives the chart coordinates of the displacement in a state.
        advance: Takes up to `steps` steps into rows of momenta, charts and poses; gives the good ones and the outcome.
        step_each: Takes single steps, see `kernels.step_each`; None where that has no meaning.
    """

    sizes: Callable[[Any], tuple[int, int, int]]
    start: Callable[[Any, np.ndarray, np.ndarray], tuple[int, np.ndarray]]
    chart_of: Callable[[Any, np.ndarray], np.ndarray]
    advance: Callable[..., tuple[int, int]]
    step_each: Callable[..., Rows] | None


def runs_of(body: AnyBody) -> Runs:
    """Return the functions of the kind of a body."""
    return _RUNS.get(type(body), _SCALAR)


def sizes(body: AnyBody) -> tuple[int, int, int]:
    """Return the numbers of momenta, chart coordinates and pose entries of a state."""
    return runs_of(body).sizes(body)


def step_each(
    body: PlainBody, states: tuple[np.ndarray, np.ndarray, np.ndarray | None], guesses: np.ndarray, principal_only: bool
) -> Rows:
    """Take one step from each row of momenta, charts and, for right-invariant constraints, poses as matrices."""
    each = runs_of(body).step_each
    if each is None:
        raise TypeError(f"`step_each` needs a plain body. Got {type(body).__name__}. Use `whole_steps`.")
    momenta, charts, poses = states
    rows = (np.ascontiguousarray(part) for part in (momenta, charts))  # one layout, or each is compiled for two
    return each(body, *rows, poses, np.ascontiguousarray(guesses), principal_only)


def _without_poses(step_each: Callable[..., Rows]) -> Callable[..., Rows]:
    return lambda body, momenta, charts, _, *rest: step_each(body, momenta, charts, *rest)


def _secular_sizes(body: SecularBody) -> tuple[int, int, int]:
    k = len(body.b) + body.slides
    return k, k, (k + 1) ** 2


def _general_sizes(body: GeneralBody) -> tuple[int, int, int]:
    return len(body.directions), len(body.stretch), body.tensor.size


def _general_chart(body: GeneralBody, state: np.ndarray) -> np.ndarray:
    k, m, _ = _general_sizes(body)
    return state[2 * k : 2 * k + m] * body.stretch


def _general_each(
    body: GeneralBody, momenta: np.ndarray, charts: np.ndarray, poses: np.ndarray | None, *rest: Any
) -> Rows:
    matrices = np.zeros((len(momenta), 0)) if poses is None else poses
    return general_run.step_each(body, (momenta, charts, matrices), *rest)


def _composed_chart(body: ComposedBody, state: np.ndarray) -> np.ndarray:
    momenta, coordinates, _ = sizes(body.body)
    return _composition.first_chart(body, state, momenta, coordinates)


def _forced_start(body: ForcedBody, momentum: np.ndarray, pose: np.ndarray) -> tuple[int, np.ndarray]:
    return forced_run.start(body, momentum, pose, sizes(body.body))


def _forced_chart(body: ForcedBody, state: np.ndarray) -> np.ndarray:
    return state[len(state) - sizes(body.body)[1] :]


_EACH, _SECULAR_EACH = _without_poses(_driver.step_each), _without_poses(secular_run.step_each)
_SCALAR = Runs(lambda _: (2, 2, 4), _driver.first_state, _driver.chart_in, _driver.advance, _EACH)
_RUNS: dict[type, Runs] = {
    SecularBody: Runs(_secular_sizes, secular_run.start, secular_run.chart_in, secular_run.advance, _SECULAR_EACH),
    GeneralBody: Runs(_general_sizes, general_run.start, _general_chart, general_run.advance, _general_each),
    ComposedBody: Runs(lambda body: sizes(body.body), _composition.start, _composed_chart, _composition.advance, None),
    ForcedBody: Runs(lambda body: sizes(body.body), _forced_start, _forced_chart, forced_run.advance, None),
}
