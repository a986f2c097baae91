"""The compiled runs, whatever the body: the scalar steps of tops and sleighs, or the general one of matrices."""

import numpy as np

from nonholo.kernels import _composition, _driver, _general_run, _secular_run
from nonholo.kernels._composition import ComposedBody
from nonholo.kernels._general import GeneralBody
from nonholo.kernels._interface import Body
from nonholo.kernels._secular import SecularBody

PlainBody = Body | GeneralBody | SecularBody
AnyBody = PlainBody | ComposedBody


def sizes(body: AnyBody) -> tuple[int, int, int]:
    """Return the numbers of momenta, chart coordinates and pose entries of a state."""
    if isinstance(body, ComposedBody):
        return sizes(body.body)
    if isinstance(body, GeneralBody):
        return len(body.directions), len(body.stretch), body.tensor.size
    if isinstance(body, SecularBody):
        k = len(body.b) + body.slides
        return k, k, (k + 1) ** 2
    return 2, 2, 4


def start(body: AnyBody, momentum: np.ndarray, pose: np.ndarray) -> tuple[int, np.ndarray]:
    """Return the outcome of the first root and the state of a run that begins with scaled momenta and a pose."""
    if isinstance(body, ComposedBody):
        return _composition.start(body, momentum, pose)
    if isinstance(body, GeneralBody):
        return _general_run.start(body, np.array(momentum), np.array(pose))
    if isinstance(body, SecularBody):
        return _secular_run.start(body, np.array(momentum), np.array(pose))
    state = np.zeros(_driver.STATE_SIZE)
    return _driver.start(body, momentum, pose, state), state


def chart_of(body: AnyBody, state: np.ndarray) -> np.ndarray:
    """Return the chart coordinates of the displacement in a state."""
    k, m, _ = sizes(body)
    if isinstance(body, ComposedBody):
        return _composition.first_chart(body, state, k, m)
    if isinstance(body, SecularBody):
        return _secular_run.chart_in(body, state)
    chart = state[2 * k : 2 * k + m]
    return chart * body.stretch if isinstance(body, GeneralBody) else chart


def advance(
    body: AnyBody, state: np.ndarray, steps: int, every: int, rows: tuple[np.ndarray, np.ndarray, np.ndarray]
) -> tuple[int, int]:
    """Take up to `steps` steps into rows of momenta, charts and poses; return how many were good and the outcome."""
    if isinstance(body, ComposedBody):
        return _composition.advance(body, state, steps, every, rows)
    if isinstance(body, GeneralBody):
        return _general_run.advance(body, state, steps, every, *rows)
    if isinstance(body, SecularBody):
        return _secular_run.advance(body, state, steps, every, *rows)
    return _driver.advance(body, state, steps, every, *rows)


def step_each(
    body: PlainBody,
    states: tuple[np.ndarray, np.ndarray, np.ndarray | None],
    guesses: np.ndarray,
    principal_only: bool,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Take one step from each row of momenta, charts and, for right-invariant constraints, poses as matrices."""
    momenta, charts, poses = states
    if isinstance(body, GeneralBody):
        carried = np.zeros((len(momenta), 0)) if poses is None else poses
        return _general_run.step_each(body, momenta, charts, carried, guesses, principal_only)
    if isinstance(body, SecularBody):
        return _secular_run.step_each(body, momenta, charts, guesses, principal_only)
    return _driver.step_each(body, momenta, charts, guesses, principal_only)
