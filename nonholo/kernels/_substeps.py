"""Functions of bodies for a substep of a composition: a root over given momenta, the push and the move at that root.

The same pieces for every body, chosen by its type; numba chooses when it compiles. Tops in space and sleighs in the
plane have loops of their own, in `_composition` and `forced`, where no function is called.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from nonholo.base.compiled import njit, overload
from nonholo.kernels._driver import _solve
from nonholo.kernels._interface import Body, increment, move
from nonholo.kernels._scalar import COMPILED
from nonholo.kernels._small import assign
from nonholo.kernels.general import GeneralBody, Workspace, increments, workspace
from nonholo.kernels.general import root as general_root
from nonholo.kernels.general import run as general_run
from nonholo.kernels.secular import SecularBody, certain_radius, level_of, room_for_sums, term
from nonholo.kernels.secular import run as secular_run


@njit(**COMPILED)
def _two_prepared(p: Body, m: np.ndarray, weights: np.ndarray) -> np.ndarray:
    return np.empty(0)


@njit(**COMPILED)
def _two_charted(p: Body, m: np.ndarray, root: np.ndarray, chart: np.ndarray) -> None:
    assign(chart, root)


@njit(**COMPILED)
def _two_solved(
    p: Body, w: np.ndarray, stage: int, m: np.ndarray, guess: np.ndarray, pose: np.ndarray, root: np.ndarray
) -> int:
    code, root[0], root[1] = _solve(p, m[0], m[1], guess[0], guess[1])
    return code


@njit(**COMPILED)
def _two_pushed(p: Body, w: np.ndarray, m: np.ndarray, root: np.ndarray, change: np.ndarray, pose: np.ndarray) -> None:
    change[0], change[1] = increment(p, m[0], m[1], root[0], root[1])
    pose[0], pose[1], pose[2], pose[3] = move(p, root[0], root[1], pose[0], pose[1], pose[2], pose[3])


@njit(**COMPILED)
def _secular_prepared(p: SecularBody, m: np.ndarray, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the certain radius of each stage, and room for y and for sums."""
    certain, k = np.empty(len(weights)), len(p.b)
    for i in range(len(weights)):
        scaled = weights[i] * m
        certain[i] = certain_radius(p, level_of(p, scaled[:k], scaled[-1] if p.slides else 0.0))
    return certain, np.empty(k), room_for_sums()


@njit(**COMPILED)
def _secular_solved(
    p: SecularBody,
    w: tuple[np.ndarray, np.ndarray, np.ndarray],
    stage: int,
    m: np.ndarray,
    guess: np.ndarray,
    pose: np.ndarray,
    root: np.ndarray,
) -> int:
    code, root[0], root[1] = secular_run.solve(p, m, w[0][stage], guess[0], guess[1], w[2])
    return code


@njit(**COMPILED)
def _secular_pushed(
    p: SecularBody,
    w: tuple[np.ndarray, np.ndarray, np.ndarray],
    m: np.ndarray,
    root: np.ndarray,
    change: np.ndarray,
    pose: np.ndarray,
) -> None:
    y, nu, tau, k, lever = w[1], root[0], root[1], len(p.b), p.mass * p.arm * p.arm
    secular_run.coordinates(p, m, nu, tau, y)
    for i in range(k):
        change[i] = term(p.c[i], y[i], nu, tau, lever)
    if p.slides:
        change[k] = 2 * p.mass * p.arm * tau / (1 + tau)
    if len(pose):
        secular_run.move(p, m[-1], nu, tau, y, pose)


@njit(**COMPILED)
def _secular_charted(p: SecularBody, m: np.ndarray, root: np.ndarray, chart: np.ndarray) -> None:
    secular_run.chart_of(p, m, root[0], root[1], chart)


@njit()
def _general_prepared(p: GeneralBody, m: np.ndarray, weights: np.ndarray) -> Workspace:
    return workspace(p)


@njit()
def _general_solved(
    p: GeneralBody, w: Workspace, stage: int, m: np.ndarray, guess: np.ndarray, pose: np.ndarray, root: np.ndarray
) -> int:
    g = pose.reshape(w.X.shape)
    general_run.see_pose(p, w, g)
    assign(root, guess)
    code = general_root.solve(p, w, m, root)
    return 5 if general_run.overflowed(p, g) else code


@njit()
def _general_pushed(
    p: GeneralBody, w: Workspace, m: np.ndarray, root: np.ndarray, change: np.ndarray, pose: np.ndarray
) -> None:
    """Push and move at the root whose displacement is in the workspace."""
    change[:] = 0.0
    if not p.spatial:
        increments(p, w, change)
    general_run.move(p, w, pose.reshape(w.X.shape))


@njit()
def _general_charted(p: GeneralBody, m: np.ndarray, root: np.ndarray, chart: np.ndarray) -> None:
    assign(chart, root * p.stretch)


def chosen(secular: Callable[..., Any], general: Callable[..., Any], two: Any = None) -> Callable[..., Any]:
    """Return the function that calls the piece for the type of its first argument, for numba and for plain Python."""
    table: dict[type, Any] = {SecularBody: secular, GeneralBody: general}

    def piece(p: Any, *rest: Any) -> Any:
        return table.get(type(p), two)(p, *rest)

    def choose(p: Any, *_: Any) -> Any:
        return table.get(p.instance_class, two).py_func  # a call of the compiled one would be optimized once more

    overload(piece, jit_options=COMPILED, strict=False)(choose)
    return piece


prepared = chosen(_secular_prepared, _general_prepared, _two_prepared)
"""(p, m, weights): what the other pieces need beside the body."""
solved = chosen(_secular_solved, _general_solved, _two_solved)
"""(p, w, stage, m, guess, pose, root): write the principal root over m; return the outcome."""
pushed = chosen(_secular_pushed, _general_pushed, _two_pushed)
"""(p, w, m, root, change, pose): write the change of m, right after `solved`; move the pose."""
charted = chosen(_secular_charted, _general_charted, _two_charted)
"""(p, m, root, chart): write the chart coordinates of a root."""


def at_rest(body: Body | SecularBody | GeneralBody) -> np.ndarray:
    """Return the unknowns at the identity."""
    return _AT_REST.get(type(body), lambda _: np.zeros(2))(body)


_AT_REST: dict[type, Callable[[Any], np.ndarray]] = {
    SecularBody: lambda body: np.array((body.mass * body.arm * body.arm, 0.0)),
    GeneralBody: lambda body: np.zeros(len(body.stretch)),
}
